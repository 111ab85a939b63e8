# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Many lines as one node of the scene graph, which FreeCAD draws at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from pivy import coin

WALLS = (0.85, 0.30, 0.05)
"""Readable on FreeCAD 1.1's white and on 0.20's blue background."""


class Lines:
    """A node that shows lines, empty at first."""

    def __init__(self, colour: tuple[float, float, float] = WALLS, width: float = 2.0) -> None:
        self.node = coin.SoSeparator()
        light = coin.SoLightModel()
        light.model = coin.SoLightModel.BASE_COLOR
        base = coin.SoBaseColor()
        base.rgb.setValue(*colour)
        style = coin.SoDrawStyle()
        style.lineWidth = width
        unpickable = coin.SoPickStyle()
        unpickable.style = coin.SoPickStyle.UNPICKABLE
        self._points = coin.SoCoordinate3()
        self._lines = coin.SoIndexedLineSet()
        for node in (light, base, style, unpickable, self._points, self._lines):
            self.node.addChild(node)

    def show(self, points: Any, pairs: Any) -> None:
        """Show points (n, 3), mm, joined in pairs (m, 2)."""
        index = np.full((len(pairs), 3), -1, np.int32)
        index[:, :2] = pairs
        self._points.point.setNum(len(points))
        self._lines.coordIndex.setNum(index.size)
        if len(pairs):
            self._points.point.setValues(0, len(points), np.ascontiguousarray(points, np.float32))
            self._lines.coordIndex.setValues(0, index.size, index.ravel())

    def show_file(self, path: str) -> None:
        """Show the lines of an `.npz` file of the worker."""
        with np.load(path) as arrays:
            self.show(arrays["points"], arrays["pairs"])

    def clear(self) -> None:
        """Show nothing."""
        self.show(np.empty((0, 3), np.float32), np.empty((0, 2), np.int32))


def labels_node(labels: list[list[Any]]) -> Any:
    """Texts that face the viewer: [text, x, y, z] each."""
    group = coin.SoSeparator()
    colour = coin.SoBaseColor()
    colour.rgb.setValue(0.1, 0.1, 0.1)
    font = coin.SoFont()
    font.size = 15
    group.addChild(colour)
    group.addChild(font)
    for text, x, y, z in labels:
        place = coin.SoTranslation()
        place.translation.setValue(x, y, z)
        word = coin.SoText2()
        word.string = str(text)
        word.justification = coin.SoText2.CENTER
        one = coin.SoSeparator()
        one.addChild(place)
        one.addChild(word)
        group.addChild(one)
    return group


def rgb(colour: Any) -> tuple[float, float, float]:
    """A colour as three shares, from "#rrggbb" or from three shares."""
    if isinstance(colour, str):
        word = colour.lstrip("#")
        red, green, blue = (int(word[k : k + 2], 16) / 255 for k in (0, 2, 4))
        return red, green, blue
    red, green, blue = colour[:3]
    return float(red), float(green), float(blue)
