"""What is kept from one request to the next: one part, its sections, one structure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from v3dcad.model import Floats, Part
from v3dcad.parts import BREP, STL, part_from
from v3dcad.pipeline import SectionedPart, Structure, fill_sectioned, sectioned
from v3dcad.settings import FillSettings, PrintSettings, SectionSettings
from v3dcad.watched import Watched

T = TypeVar("T")

Stage = Callable[[str, int, int], None]
"""Tells the name of a stage, how much of it is done, and of how much."""


class Latest:
    """The last thing that was made, and what it was made of; the one before is let go first."""

    def __init__(self) -> None:
        self._of: object = None
        self._made: Any = None

    def get(self, of: object, make: Callable[[], T]) -> T:
        """What was made last if it was made of the same; else it is made now."""
        if self._made is None or self._of != of:
            self._of = self._made = None
            self._made = make()
            self._of = of
        made: T = self._made
        return made


class Kept:
    """The part, sections and structures of the last requests, by what they were asked for."""

    def __init__(self) -> None:
        self._part, self._sections, self._structure = Latest(), Latest(), Latest()
        self._whole = Latest()

    def structure(
        self,
        source: str,
        settings: FillSettings,
        sites: Floats | None,
        printing: PrintSettings,
        stage: Stage,
    ) -> Structure:
        """The structure of the part in a file, whose layers are computed when asked for."""
        asked = _key(source, settings, sites, printing)

        def make() -> Structure:
            found = self._sectioned(source, settings, stage)
            return fill_sectioned(found, settings, sites, stage, printing)

        return self._structure.get(asked, make)

    def whole(
        self,
        source: str,
        settings: FillSettings,
        sites: Floats | None,
        printing: PrintSettings,
        stage: Stage,
    ) -> Structure:
        """The same with all layers in memory."""

        def make() -> Structure:
            structure = self.structure(source, settings, sites, printing, stage)
            layers = structure.layers
            watched = Watched(layers, lambda done: stage("filling", done, len(layers)))
            return replace(structure, layers=tuple(watched))

        return self._whole.get(_key(source, settings, sites, printing), make)

    def _sectioned(self, source: str, settings: FillSettings, stage: Stage) -> SectionedPart:
        cut_by = (*(getattr(settings, name) for name in SectionSettings.__dataclass_fields__),)

        def make() -> SectionedPart:
            part = self._part.get(source, lambda: _read(source, stage))
            stage("cutting the part", 0, 0)
            return sectioned(part, settings)

        return self._sections.get((source, cut_by, settings.section_above(), settings.lofts), make)


def _key(
    source: str, settings: FillSettings, sites: Floats | None, printing: PrintSettings
) -> object:
    places = None if sites is None else (sites.shape, sites.tobytes())
    return source, settings, places, printing if settings.wish() else None


def _read(source: str, stage: Stage) -> Part:
    stage("reading the part", 0, 0)
    # FreeCAD counts in mm, which the kinds of files that it gives do not state.
    gives = Path(source).suffix.lower() in (*BREP, *STL)
    return part_from(source, unit="mm" if gives else None)
