"""How a structure is shown in a browser and in a notebook: a page that turns, cuts and tells."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol

from v3dcad.files import written_beside
from v3dcad.model import Layer, Part, Placement, Toolpath, size_words
from v3dcad.settings import FillSettings, PrintSettings
from v3dcad.view.page.first import WHOLE, First
from v3dcad.view.targets.declared import target_of
from v3dcad.view.targets.preview import preview

NOTEBOOK_SEGMENTS = 150_000
"""The most that a page in a notebook holds: 2.5 MB, of which an empty page has 1.1."""


class Pages(Protocol):
    """The side of a structure that a browser shows: what it must have, and its page."""

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

    def page(
        self,
        printing: PrintSettings | None = None,
        first: First = WHOLE,
        *,
        most: int | None = None,
        live: int = 0,
    ) -> str:
        """The structure as one HTML file to look at in a browser, bed coordinates.

        With print settings it shows the toolpath too. Where it has more than `most` segments (by
        default as many as a browser draws fluently), only some layers are shown, and the page says
        so. `first` is what it shows when it is opened; `live` is its number where a server tells it
        of later ones. Raises `SettingError` for a target, layer, cell or neighbour that is not
        there.
        """
        from v3dcad.view.page.content import MOST_SEGMENTS, page

        target, layer, cell, neighbour = first
        if target_of(target).asks:
            index = len(self.layers) // 2 if layer is None else layer
            preview(
                "layer" if target == "toolpath" else target,
                self.layers,
                self.placement,
                index,
                cell,
                neighbour,
            )
        span = self.settings.layer_span()
        facts = {
            "size": size_words(self.part),
            "layers": f"{len(self.layers)} of {span[0]:g} mm",
            "method": self.settings.method,
        }
        return page(
            self.part.name,
            self.layers,
            span,
            self.part.mesh(),
            facts,
            () if printing is None else self.toolpaths(printing),
            printing,
            first,
            most=MOST_SEGMENTS if most is None else most,
            live=live,
        )

    def write_html(
        self, path: str | Path, printing: PrintSettings | None = None, first: First = WHOLE
    ) -> None:
        """Write `page()` as a file, with the toolpath of the print settings (or the usual ones)."""
        with written_beside(Path(path)) as beside:
            text = self.page(printing or PrintSettings(), first)
            beside.write_text(text, encoding="utf-8", newline="\n")

    def _repr_html_(self) -> str:
        """How a notebook shows it: the page in a frame, small enough to be kept in the notebook."""
        from v3dcad.view.page.document import framed

        return framed(self.page(most=NOTEBOOK_SEGMENTS))
