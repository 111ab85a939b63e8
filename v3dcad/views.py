"""How a structure is shown: previews, pictures, and what a notebook shows of it.

matplotlib is loaded when a picture is drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from v3dcad.errors import SettingError
from v3dcad.files import written_beside
from v3dcad.model import Layer, Part, Placement, size_words
from v3dcad.settings import PrintSettings
from v3dcad.view.targets.preview import preview
from v3dcad.view.targets.shown import Preview

if TYPE_CHECKING:
    from v3dcad.report import Print

IN_SPACE = ("full", "overhang")
"""Targets that a picture shows in space; the others lie in a plane."""

PICTURES = {".png": "png", ".svg": "svg"}
"""Kinds of pictures, by how their files' names end."""


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
        return self._shown(self.placement, target, layer, cell, neighbour, printing)

    def _shown(
        self,
        placement: Placement,
        target: str,
        layer: int,
        cell: int | None,
        neighbour: int | None,
        printing: PrintSettings | None,
    ) -> Preview:
        from v3dcad.toolpath.beads import trace

        toolpaths = trace(self.layers, printing or PrintSettings())  # nothing is traced yet
        return preview(target, self.layers, placement, layer, cell, neighbour, toolpaths)

    def picture(
        self,
        target: str = "full",
        layer: int | None = None,
        cell: int | None = None,
        neighbour: int | None = None,
        *,
        kind: str = "png",
        ids: bool = False,
        printing: PrintSettings | None = None,
        printed: Print | None = None,
    ) -> bytes:
        """A picture of a target as the bytes of a file, PNG or SVG (`kind`), bed coordinates.

        `layer` is by default the one in the middle; with `ids` cells have the numbers of their
        sites. The whole structure and its overhang are seen in space, a quarter cut away, and what
        `write_gcode` told (`printed`) comes into the title. Of very many layers only some are
        drawn, and the title says so. Raises `SettingError` for what is not there, and for another
        `kind`.
        """
        if kind not in PICTURES.values():
            raise SettingError("kind", f"--kind {kind}: give {' or '.join(PICTURES.values())}")
        from v3dcad.view.figures import part_picture, plane_picture
        from v3dcad.view.picture import choose
        from v3dcad.view.targets.sizes import size_distribution

        name = self.part.name
        if target in IN_SPACE:
            chosen = choose(self.layers)
            facts = self._facts(chosen.cells, printed)
            if chosen.thinned:
                facts += f"; one in {chosen.step} of {len(self.layers)} layers is drawn"
            tilts = target == "overhang"
            return part_picture(chosen.layers, self.part.mesh(), name, facts, kind, tilts=tilts)
        index = len(self.layers) // 2 if layer is None else layer
        shown = self._shown(Placement.none(), target, index, cell, neighbour, printing)
        distribution = size_distribution(self.layers) if target == "sizes" else None
        return plane_picture(shown, name, kind, ids=ids, distribution=distribution)

    def write_picture(
        self,
        path: str | Path,
        target: str = "full",
        layer: int | None = None,
        cell: int | None = None,
        neighbour: int | None = None,
        *,
        ids: bool = False,
        printing: PrintSettings | None = None,
    ) -> None:
        """Write a picture of a target; `path` ends in .png or .svg, the rest is as in `picture`.

        The foam within an SVG of the whole structure, or of its overhang, is a painted image.
        """
        path = Path(path)
        kind = PICTURES.get(path.suffix.lower())
        if kind is None:
            raise SettingError("path", f"{path}: not a kind of picture; give .png or .svg")
        with written_beside(path) as beside:
            beside.write_bytes(
                self.picture(target, layer, cell, neighbour, kind=kind, ids=ids, printing=printing)
            )

    def write_png(self, path: str | Path, printed: Print | None = None) -> None:
        """Draw the part translucent, its walls, and a quarter cut away, as PNG.

        The title tells size and cells, and mass and time of what `write_gcode` told (`printed`).
        """
        with written_beside(Path(path)) as beside:
            beside.write_bytes(self.picture(printed=printed))

    def thumbnail(self, pixels: int = 220) -> bytes:
        """The same without words, as the bytes of a small PNG."""
        from v3dcad.view.figures import part_picture
        from v3dcad.view.picture import choose

        return part_picture(choose(self.layers).layers, self.part.mesh(), pixels=pixels)

    def _repr_png_(self) -> bytes:
        """How a notebook shows it."""
        return self.picture()

    def _facts(self, cells: int, printed: Print | None) -> str:
        """What the title of a picture tells of the structure."""
        facts = [size_words(self.part), f"{cells:,} cells"]
        if printed is not None:
            from v3dcad.report import hours_text

            facts += [f"{printed.totals.mass_g:.1f} g", hours_text(printed.totals.time_s)]
        return ", ".join(facts)
