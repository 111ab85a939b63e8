"""How a structure is shown: previews, pictures, and what a notebook shows of it.

matplotlib is loaded when a picture is drawn.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from v3dcad.errors import SettingError
from v3dcad.files import written_beside
from v3dcad.model import Layer, Part, Placement, Toolpath, size_words
from v3dcad.settings import FillSettings, PrintSettings
from v3dcad.view.targets.preview import preview
from v3dcad.view.targets.shown import Preview
from v3dcad.words import counted

if TYPE_CHECKING:
    from v3dcad.report import Print

IN_SPACE = ("full", "overhang")
"""Targets that a picture shows in space; the others lie in a plane."""

PICTURES = {".png": "png", ".svg": "svg"}
"""Kinds of pictures, by how their files' names end."""

THUMBNAIL_WALLS = 20_000
"""Of so many edges the walls of a thumbnail are painted: in its few pixels more look the same."""


class Views(Protocol):
    """The visible side of a structure: what it must have, and how it then is shown."""

    __slots__ = ()

    part: Part
    placement: Placement
    layers: Sequence[Layer]

    @property
    @abstractmethod
    def settings(self) -> FillSettings:
        """What it was filled with."""

    @abstractmethod
    def toolpaths(self, printing: PrintSettings | None = None) -> Iterator[Toolpath]:
        """The nozzle's way on each layer."""

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
        toolpaths = self.toolpaths(printing)  # none is traced yet
        span = self.settings.layer_span()
        return preview(target, self.layers, placement, layer, cell, neighbour, toolpaths, span)

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
        if target in IN_SPACE:
            return self._in_space(kind, target, printed)
        from v3dcad.view.figures import plane_picture
        from v3dcad.view.targets.sizes import size_distribution

        index = len(self.layers) // 2 if layer is None else layer
        shown = self._shown(Placement.none(), target, index, cell, neighbour, printing)
        distribution = size_distribution(self.layers) if target == "sizes" else None
        return plane_picture(shown, self.part.name, kind, ids=ids, distribution=distribution)

    def _in_space(self, kind: str, target: str, printed: Print | None) -> bytes:
        from v3dcad.view.figures import part_picture
        from v3dcad.view.picture import choose

        chosen = choose(self.layers)
        facts = self._facts(chosen.cells, printed)
        if chosen.thinned:
            facts += f"; one in {chosen.step} of {len(self.layers)} layers is drawn"
        return part_picture(
            chosen.layers,
            self.part.mesh(),
            self.settings.layer_span()[1],
            self.part.name,
            facts,
            kind,
            tilts=target == "overhang",
        )

    def write_picture(
        self,
        path: str | Path,
        target: str = "full",
        layer: int | None = None,
        cell: int | None = None,
        neighbour: int | None = None,
        *,
        kind: str | None = None,
        ids: bool = False,
        printing: PrintSettings | None = None,
        printed: Print | None = None,
    ) -> None:
        """Write a picture of a target as in `picture`; its `kind` is by default how `path` ends.

        The foam within an SVG of the whole structure, or of its overhang, is a painted image.
        """
        path = Path(path)
        kind = kind or PICTURES.get(path.suffix.lower())
        if kind is None:
            raise SettingError("path", f"{path}: not a kind of picture; give .png or .svg")
        with written_beside(path) as beside:
            beside.write_bytes(
                self.picture(
                    target, layer, cell, neighbour,
                    kind=kind, ids=ids, printing=printing, printed=printed,
                )
            )  # fmt: skip

    def thumbnail(self, pixels: int = 220) -> bytes:
        """The picture of the whole structure without words, as the bytes of a small PNG."""
        from v3dcad.view.figures import part_picture
        from v3dcad.view.picture import choose

        layers = choose(self.layers, THUMBNAIL_WALLS).layers
        base = self.settings.layer_span()[1]
        return part_picture(layers, self.part.mesh(), base, pixels=pixels)

    def _facts(self, cells: int, printed: Print | None) -> str:
        """What the title of a picture tells of the structure."""
        facts = [size_words(self.part), counted(cells, "cell")]
        if printed is not None:
            from v3dcad.report import hours_text

            facts += [f"{printed.totals.mass_g:.1f} g", hours_text(printed.totals.time_s)]
        return ", ".join(facts)
