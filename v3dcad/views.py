"""How a structure is shown: previews, pictures, and what a notebook shows of it.

matplotlib is loaded when a picture is drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from v3dcad.model import Layer, Part, Placement
from v3dcad.settings import PrintSettings
from v3dcad.view.targets.preview import preview
from v3dcad.view.targets.shown import Preview


class Views(Protocol):
    """The visible side of a structure: what it must have, and how it then is shown."""

    __slots__ = ()

    part: Part
    placement: Placement
    layers: Sequence[Layer]

    def preview(
        self,
        target: str,
        layer: int = 0,
        cell: int | None = None,
        neighbour: int | None = None,
        printing: PrintSettings | None = None,
    ) -> Preview:
        """What a target of `view.targets.declared` shows, where the source lies.

        `layer` is an index, `cell` and `neighbour` are site numbers; `printing` says how the
        target "toolpath" is printed. Raises `SettingError` for what is not there.
        """
        from v3dcad.toolpath.beads import trace

        toolpaths = trace(self.layers, printing or PrintSettings())  # nothing is traced yet
        return preview(target, self.layers, self.placement, layer, cell, neighbour, toolpaths)
