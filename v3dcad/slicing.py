"""A part on the bed and its sections: what stands before any structure, useful by itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

import numpy as np

from v3dcad.arguments import place
from v3dcad.errors import SettingError
from v3dcad.files import written_beside
from v3dcad.model import Floats, Part, Placement, Section, part_words
from v3dcad.parts import part_from
from v3dcad.settings import SectionSettings
from v3dcad.structure.placement import layer_heights, on_bed, turned, upward
from v3dcad.words import counted

BATCH = 256
"""Sections computed at a time when all are gone through."""


def place_on_bed(
    part: Any,
    *,
    rotate: Sequence[float] = (0.0, 0.0, 0.0),
    up: int | str | None = None,
    base_clearance: float = 0.0,
) -> Part:
    """A part, turned and put on the middle of the bed; its `placement` tells how it came there.

    `part` is anything that `fill` takes, but for `.ont` files. `up` turns it first: "x", "y" or
    "z" is the axis that is to point upwards, a number the plane face (or triangle) whose outward
    normal is to. `rotate` turns it then about x, y and z, in this order, by degrees. The base
    lies `base_clearance` mm below z = 0. A part that lies there already is not moved at all.
    Raises `SettingError` for what cannot be turned to, and as `part_from` does.
    """
    SectionSettings(base_clearance=base_clearance)  # checks it
    found = part_from(part)
    turn = Placement.none() if up is None else upward(_direction(found, up))
    found = found.placed(turn.then(turned(rotate)))
    return found.placed(on_bed(found.bounds, base_clearance))


def _direction(part: Part, up: int | str) -> Floats:
    if isinstance(up, str) and up in ("x", "y", "z"):
        return np.array([float(axis == up) for axis in "xyz"])
    if isinstance(up, str):
        if not up.isdecimal():
            raise SettingError("up", f"--up {up}: give x, y, z or the number of a face")
        up = int(up)
    return part.normal(up)


@dataclass(frozen=True, eq=False, slots=True)
class Sections(Sequence[Section]):
    """The sections of a part, computed as they are asked for; to be gone through at will."""

    part: Part
    """as placed on the bed"""
    heights: Floats
    """(k,) mm, ascending"""
    chord_tolerance: float
    executor: Executor | None = None

    def __repr__(self) -> str:
        return f"<{counted(len(self), 'section')} of {part_words(self.part)}>"

    def __len__(self) -> int:
        return len(self.heights)

    @overload
    def __getitem__(self, index: int) -> Section: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Section]: ...
    def __getitem__(self, index: int | slice) -> Section | Sequence[Section]:
        if isinstance(index, slice):
            return Sections(self.part, self.heights[index], self.chord_tolerance, self.executor)
        chosen = place("section", index, len(self), "sections", from_end=True)
        return self._cut(self.heights[[chosen]])[0]

    def __iter__(self) -> Iterator[Section]:
        batch = BATCH if self.executor is None else len(self)
        for first in range(0, len(self), max(batch, 1)):
            yield from self._cut(self.heights[first : first + batch])

    def _cut(self, heights: Floats) -> Sequence[Section]:
        return self.part.sections(heights, self.chord_tolerance, self.executor)

    def write_step(self, path: str | Path) -> None:
        """Write the sections where the source lies as STEP, one named compound of wires each."""
        write_sections_step(self, path, self.part)

    def write_svg(self, path: str | Path) -> None:
        """Write the sections as SVG, one group each."""
        write_sections_svg(self, path)


def section(
    part: Any,
    *,
    layer_height: float = SectionSettings().layer_height,
    chord_tolerance: float = SectionSettings().chord_tolerance,
    base_clearance: float = SectionSettings().base_clearance,
    executor: Executor | None = None,
) -> Sections:
    """The sections of a part on the bed, `layer_height` (mm) apart, from its base on.

    `part` is anything that `fill` takes, but for `.ont` files. Rings lie within
    `chord_tolerance` (mm) of the true surface, and say which of their stretches are exact lines,
    circles and ellipses. With an executor (threads, processes, a cluster's) several are computed
    at a time. Raises `SettingError` where settings do not fit the part, and as `part_from` does.
    """
    settings = SectionSettings(
        layer_height=layer_height, chord_tolerance=chord_tolerance, base_clearance=base_clearance
    )
    placed = place_on_bed(part, base_clearance=base_clearance)
    heights = layer_heights(float(placed.bounds[1, 2]), settings.layer_height)
    return Sections(placed, heights, settings.chord_tolerance, executor)


def write_sections_step(sections: Sequence[Section], path: str | Path, part: Part) -> None:
    """Write sections of a placed part, lines and conics exact, where its source lies."""
    from v3dcad.kernel.section_wires import section_wires
    from v3dcad.kernel.shapes import compound
    from v3dcad.kernel.step import Named, write_step

    shapes = (
        Named(f"section {k} z {cut.z:g}", compound(section_wires(cut, part.placement)))
        for k, cut in enumerate(sections)
    )
    with written_beside(Path(path)) as beside:
        write_step(shapes, beside, part.name)


def write_sections_svg(sections: Sequence[Section], path: str | Path) -> None:
    """Write sections as SVG, one group each."""
    from v3dcad.svg import sections_svg

    with (
        written_beside(Path(path)) as beside,
        beside.open("w", encoding="utf-8", newline="\n") as stream,
    ):
        stream.writelines(sections_svg(sections))
