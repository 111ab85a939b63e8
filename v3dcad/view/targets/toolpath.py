"""The target that shows how a layer is printed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.model import EXTRUDE, INNER_PERIMETER, PERIMETER, Floats, Layer, Toolpath
from v3dcad.view.targets.shown import Labels, Lines, Marks, Preview


def toolpath(layer: Layer, toolpaths: Iterable[Toolpath]) -> Preview:
    """The way of the nozzle on a layer: travel, beads, perimeters, and where perimeters begin.

    Reads the toolpaths, ascending, up to the layer's own; the end of the one below is where the way
    begins. Raises `SettingError` where there is none of that layer.
    """
    before = np.empty((0, 3))
    for one in toolpaths:
        if len(one.points) and one.layer[0] == layer.index:
            return _shown(layer, one, before)
        before = one.points[-1:] if len(one.points) else before
    raise SettingError("layer", f"layer {layer.index}: nothing is printed on it")


def _shown(layer: Layer, one: Toolpath, before: Floats) -> Preview:
    points = np.concatenate([before, one.points])
    steps = len(points) - 1
    kind, feature, volume = one.kind[-steps:], one.feature[-steps:], one.volume[-steps:]
    pairs = np.column_stack([np.arange(steps), np.arange(1, steps + 1)])
    lengths = np.linalg.norm(points[1:] - points[:-1], axis=1)
    extruding = kind == EXTRUDE
    around = extruding & np.isin(feature, (PERIMETER, INNER_PERIMETER))
    travel = ~extruding & (lengths > 0)
    begins = extruding & (feature == PERIMETER) & ~np.append(False, extruding[:-1])
    return Preview(
        target="toolpath",
        title=f"toolpath of layer {layer.index}, {layer.z:g} mm above the bed: "
        f"{lengths[extruding].sum() / 1000:.2f} m of beads, {volume.sum():.0f} mm³",
        lines=(
            Lines.of("travel", points, pairs[travel]),
            Lines.of("bead", points, pairs[extruding & ~around]),
            Lines.of("perimeter", points, pairs[around]),
        ),
        marks=(Marks("seam", points[:-1][begins]),),
        labels=Labels.none(),
        cells=layer.diagram.sites(),
    )
