"""The structure in space: its walls as plane polygons, its struts as straight axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from v3dcad.model import Floats, Ints, Value


@dataclass(frozen=True, eq=False, slots=True)
class StrutAxes(Value):
    """Straight lines where three cells meet."""

    sites: Ints
    """(s, 3) the sites around each, ascending; of more than three the lowest"""
    ends: Floats
    """(s, 2, 3) mm, the lower end first"""

    def tilts(self) -> Floats:
        """(s,) angle from the vertical, degrees."""
        dx, dy, dz = (self.ends[:, 1] - self.ends[:, 0]).T
        return np.asarray(np.degrees(np.arctan2(np.hypot(dx, dy), dz)))


@dataclass(frozen=True, eq=False, slots=True)
class Walls(Value):
    """The walls between two cells as plane convex polygons, one for each pair."""

    sites: Ints
    """(f, 2) i < j"""
    points: Floats
    """(p, 3) mm, polygon after polygon; counter-clockwise seen from site j"""
    starts: Ints
    """(f + 1,) where each polygon begins in `points`"""
    tilts: Floats
    """(f,) angle from the vertical, degrees: tan = |Δz| / (s² · |Δxy|) for a stretch s"""

    def slice(self, z: float) -> tuple[Ints, Floats]:
        """The walls at a height z: which (k,), and their segments (k, 2, 2), mm."""
        facet = np.repeat(np.arange(len(self.tilts)), np.diff(self.starts))
        following = np.arange(1, len(self.points) + 1)
        following[self.starts[1:] - 1] = self.starts[:-1]
        below, above = self.points, self.points[following]
        crossing = np.nonzero((below[:, 2] <= z) != (above[:, 2] <= z))[0]
        below, above = below[crossing], above[crossing]
        share = (z - below[:, 2]) / (above[:, 2] - below[:, 2])
        at = below[:, :2] + share[:, None] * (above[:, :2] - below[:, :2])
        return facet[crossing[::2]], at.reshape(-1, 2, 2)
