"""What a preview is made of: lines, areas and marks with their colours, numbers of sites."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from v3dcad.model import Floats, Ints, Placement, Value
from v3dcad.view.colours import COLOURS, ramp

STEPS = 8
"""Into how many steps `Preview.stepped` divides a scale."""


@dataclass(frozen=True, eq=False, slots=True)
class Lines(Value):
    """Lines of one role. Their colour is the role's, unless they have values."""

    role: str
    """a key of `COLOURS`"""
    points: Floats
    """(n, 3) mm"""
    pairs: Ints
    """(m, 2) which points each line joins"""
    values: Floats | None = None
    """(m,) on the preview's scale"""

    @property
    def colour(self) -> str:
        """The role's colour, as #rrggbb."""
        return COLOURS[self.role]

    @classmethod
    def of(cls, role: str, points: Floats, pairs: Ints) -> Lines:
        """Lines between some of the points; of these, only those that lines end in are kept."""
        used, places = np.unique(pairs, return_inverse=True)
        return cls(role, points[used], places.reshape(-1, 2))


@dataclass(frozen=True, eq=False, slots=True)
class Areas(Value):
    """Cells of a layer, filled; their colours say their values on the preview's scale."""

    sites: Ints
    """(c,)"""
    values: Floats
    """(c,)"""
    points: Floats
    """(n, 3) mm, ring after ring, open; the cell lies on their left, seen from above"""
    starts: Ints
    """(r + 1,) where each ring begins in `points`"""
    of: Ints
    """(r,) the row in `sites` of the cell that each ring bounds; the even-odd rule fills it"""


@dataclass(frozen=True, eq=False, slots=True)
class Marks(Value):
    """Points of one role."""

    role: str
    """a key of `COLOURS`"""
    points: Floats
    """(k, 3) mm"""

    @property
    def colour(self) -> str:
        """The role's colour, as #rrggbb."""
        return COLOURS[self.role]


@dataclass(frozen=True, eq=False, slots=True)
class Labels(Value):
    """The numbers of sites, to be written at points."""

    sites: Ints
    """(k,)"""
    points: Floats
    """(k, 3) mm"""

    @classmethod
    def none(cls) -> Labels:
        """No numbers."""
        return cls(np.empty(0, np.int64), np.empty((0, 3)))


@dataclass(frozen=True, slots=True)
class Scale:
    """What values mean, and the least and greatest of them; `ramp` gives their colours."""

    name: str
    unit: str
    low: float
    high: float

    def shares(self, values: Floats) -> Floats:
        """(n,) which share of the way from least to greatest values (n,) are; 0 where all are
        the same.
        """
        span = self.high - self.low
        return np.asarray((values - self.low) / span if span > 0 else np.zeros_like(values))

    @classmethod
    def of(cls, name: str, unit: str, values: Floats) -> Scale:
        """The scale from the least to the greatest of values; of none, from 0 to 0."""
        low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)
        return cls(name, unit, low, high)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Preview(Value):
    """What is shown of a structure, where its source lies."""

    target: str
    title: str
    lines: tuple[Lines, ...]
    """what is most important comes last, to be drawn over the others"""
    labels: Labels
    cells: Ints
    """(c,) the sites that have a cell on the layer that is shown; none where it shows no layer by
    itself"""
    areas: Areas | None = None
    """to be drawn below the lines"""
    marks: tuple[Marks, ...] = ()
    """to be drawn over the lines"""
    scale: Scale | None = None
    """of the values of lines and areas"""

    @property
    def legend(self) -> dict[str, str]:
        """The colour of each role that is shown; what has values is explained by the scale."""
        plain = {one.role: one.colour for one in self.lines if one.values is None}
        return plain | {one.role: one.colour for one in self.marks}

    def at_source(self, placement: Placement) -> Preview:
        """The same, moved from the bed to where the source lies."""

        def moved(points: Floats) -> Floats:
            return placement.to_source(points)

        areas = self.areas
        return replace(
            self,
            lines=tuple(replace(one, points=moved(one.points)) for one in self.lines),
            marks=tuple(replace(one, points=moved(one.points)) for one in self.marks),
            labels=replace(self.labels, points=moved(self.labels.points)),
            areas=areas and replace(areas, points=moved(areas.points)),
        )

    def stepped(self) -> list[tuple[str, str, Floats, Ints]]:
        """All as lines of one colour each, for a host that knows nothing else.

        Gives name, colour (#rrggbb), points (n, 3) and pairs (m, 2); a scale is divided into
        `STEPS`, and areas are shown by their outlines, marks by points that are joined to
        themselves.
        """
        found = []
        if self.areas is not None:
            found += self._steps(*_outlines(self.areas))
        for one in self.lines:
            if one.values is None:
                found.append((one.role, one.colour, one.points, one.pairs))
            else:
                found += self._steps(one.points, one.pairs, one.values)
        for mark in self.marks:
            itself = np.repeat(np.arange(len(mark.points)), 2).reshape(-1, 2)
            found.append((mark.role, mark.colour, mark.points, itself))
        return found

    def _steps(
        self, points: Floats, pairs: Ints, values: Floats
    ) -> list[tuple[str, str, Floats, Ints]]:
        assert self.scale is not None
        scale = self.scale
        step = np.minimum((scale.shares(values) * STEPS).astype(np.int64), STEPS - 1)
        found = []
        for number in np.unique(step).tolist():
            used, places = np.unique(pairs[step == number], return_inverse=True)
            low, high = (
                scale.low + (number + more) / STEPS * (scale.high - scale.low) for more in (0, 1)
            )
            red, green, blue = np.rint(255 * ramp(np.array([number / (STEPS - 1)]))[0]).astype(int)
            name = f"{scale.name} {low:.3g} … {high:.3g} {scale.unit}"
            colour = f"#{red:02x}{green:02x}{blue:02x}"
            found.append((name, colour, points[used], places.reshape(-1, 2)))
        return found


def _outlines(areas: Areas) -> tuple[Floats, Ints, Floats]:
    """The rings of areas as lines: points (n, 3), pairs (n, 2), and the value of each (n,)."""
    following = np.arange(1, len(areas.points) + 1)
    following[areas.starts[1:] - 1] = areas.starts[:-1]
    pairs = np.column_stack([np.arange(len(following)), following])
    return areas.points, pairs, np.repeat(areas.values[areas.of], np.diff(areas.starts))
