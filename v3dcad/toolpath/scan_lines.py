"""Parallel lines across a layer: what of them lies in areas, over walls, and free of both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from v3dcad.model import Floats, Ints


@dataclass(frozen=True)
class ScanLines:
    """Parallel lines across an area, put end to end on one axis.

    There, what lies in an area or over a wall is intervals: (n, 2) mm, begin and end.
    """

    turn: Floats
    """(2, 2): points times this have the lines' direction as x"""
    first: float
    """mm: y of the first line"""
    step: float
    """mm, between lines"""
    count: int
    left: float
    """mm: x where all lines begin"""
    length: float
    """mm, of each line"""

    @classmethod
    def across(cls, area: shapely.Geometry, angle: float, spacing: float, most: int) -> ScanLines:
        """Lines about `spacing` mm apart, but at most `most`, at an angle in degrees."""
        cosine, sine = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        turn = np.array([[cosine, -sine], [sine, cosine]])
        (left, low), (right, high) = (
            extreme(shapely.get_coordinates(area) @ turn, axis=0) for extreme in (np.min, np.max)
        )
        count = int(np.clip(round((high - low) / spacing), 1, most))
        step = (high - low) / count
        margin = 2 * spacing
        return cls(turn, low + step / 2, step, count, left - margin, right - left + 2 * margin)

    def inside(self, area: shapely.Geometry) -> Floats:
        """What lies inside an area: between every second crossing of its rings and the next."""
        points, ring = shapely.get_coordinates(
            shapely.get_rings(shapely.get_parts(area)), return_index=True
        )
        ends = np.stack([points[:-1], points[1:]], axis=1)[ring[1:] == ring[:-1]]
        line, x, _ = self._crossings(ends @ self.turn)
        return np.sort(self._at(line, x)).reshape(-1, 2)

    def over(self, walls: Floats, reach: float) -> Floats:
        """What lies within `reach` mm of walls, (n, 2, 2) mm, that the lines cross."""
        ends = walls @ self.turn
        line, x, wall = self._crossings(ends)
        across = np.abs(ends[wall, 1] - ends[wall, 0])
        # A slanting wall is passed for longer, but not for longer than it is.
        half = reach * np.hypot(*across.T) / np.maximum(across[:, 1], 1e-12)
        low, high = ends[wall, :, 0].min(axis=1) - reach, ends[wall, :, 0].max(axis=1) + reach
        return np.stack(
            [self._at(line, np.maximum(x - half, low)), self._at(line, np.minimum(x + half, high))],
            axis=1,
        )

    def _crossings(self, ends: Floats) -> tuple[Ints, Floats, Ints]:
        """Where segments cross lines: the line, x, and the segment."""
        (low, high) = (extreme(ends[:, :, 1], axis=1) for extreme in (np.min, np.max))
        begin, end = (
            np.clip(np.ceil((y - self.first) / self.step), 0, self.count).astype(np.int64)
            for y in (low, high)
        )
        times = end - begin
        segment = np.repeat(np.arange(len(ends)), times)
        line = np.arange(len(segment)) + (begin - np.cumsum(times) + times)[segment]
        (x, y), (other_x, other_y) = ends[segment].transpose(1, 2, 0)
        share = (self.first + line * self.step - y) / (other_y - y)
        return line, x + share * (other_x - x), segment

    def _at(self, line: Ints, x: Floats) -> Floats:
        """Places on the axis."""
        return np.asarray(line * self.length + np.clip(x - self.left, 0, self.length))


def gaps(inside: Floats, held: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Lengths of what is `inside` (n, 2) and not `held` (m, 2), (k,), and which have a free end.

    All are intervals of one axis. A gap has a free end where it ends with what is inside.
    """
    places = np.concatenate([inside.ravel(), held.ravel()])
    order = np.argsort(places, kind="stable")
    places = places[order]
    of_held = order >= inside.size
    change = np.where(order % 2, -1, 1)
    covered, depth = (np.cumsum(np.where(which, change, 0)) for which in (~of_held, of_held))
    gap = np.flatnonzero((covered > 0) & (depth == 0))
    return places[gap + 1] - places[gap], ~(of_held[gap] & of_held[gap + 1])
