"""The structure in space: its walls as planar facets, its struts as straight axes.

With weights linear in z, adding z² to every power function makes the stack of layers one power
diagram in space. So what lies between two cells is a planar facet, bounded by the struts that the
vertices at its two ends run along; the layers are its slices. All of it is in the kinetic log.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from v3dcad.model import Floats, Ints, Value


@dataclass(frozen=True, eq=False, slots=True)
class StrutAxes(Value):
    """Straight lines where three cells meet."""

    sites: Ints
    """(s, 3) the sites around each, counter-clockwise from above"""
    ends: Floats
    """(s, 2, 3) mm, the lower end first"""

    def tilts(self) -> Floats:
        """(s,) angle from the vertical, degrees."""
        dx, dy, dz = (self.ends[:, 1] - self.ends[:, 0]).T
        return np.asarray(np.degrees(np.arctan2(np.hypot(dx, dy), dz)))


@dataclass(frozen=True, eq=False, slots=True)
class Walls(Value):
    """Planar facets between two cells, as polygons."""

    sites: Ints
    """(f, 2) i < j"""
    points: Floats
    """(p, 3) mm, polygon after polygon; counter-clockwise as seen from site i"""
    starts: Ints
    """(f + 1,) where each polygon begins in `points`"""
    tilts: Floats
    """(f,) angle from the vertical, degrees: tan = |difference of growth| / (2 · distance)"""

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


@dataclass(frozen=True, eq=False, slots=True)
class Tracks(Value):
    """How the vertices of a structure move from height to height: the kinetic log, in mm."""

    corners: Ints
    """(t, 3) the sites around each vertex, counter-clockwise; negative: far outside"""
    spans: Floats
    """(t, 2) z at which it begins and ends"""
    ends: Floats
    """(t, 2, 2) x, y there"""
    leaps: tuple[float, ...]
    """z at which those outside the base rectangle leap"""


def joined(pieces: Sequence[Tracks]) -> Tracks:
    """One log of several, each from where the one before ends.

    A vertex between the same three sites in both goes on, unless a far corner takes part: between
    them these have moved (`epochs.py`).
    """
    if len(pieces) == 1:
        return pieces[0]
    corners = np.concatenate([piece.corners for piece in pieces])
    spans = np.concatenate([piece.spans for piece in pieces])
    ends = np.concatenate([piece.ends for piece in pieces])
    order = np.lexsort((spans[:, 0], *corners.T))
    corners, spans, ends = corners[order], spans[order], ends[order]
    goes_on = (corners[1:] == corners[:-1]).all(axis=1) & (spans[1:, 0] == spans[:-1, 1])
    goes_on &= (corners[1:] >= 0).all(axis=1)
    begins, stops = np.append(True, ~goes_on), np.append(~goes_on, True)
    return Tracks(
        corners[begins],
        np.column_stack([spans[begins, 0], spans[stops, 1]]),
        np.stack([ends[begins, 0], ends[stops, 1]], axis=1),
        (
            *pieces[-1].leaps,
            *(float(piece.spans.max()) for piece in pieces[:-1] if len(piece.spans)),
        ),
    )


def strut_axes(tracks: Tracks, box: Floats) -> StrutAxes:
    """The struts inside a box (low, high) (2, 2), mm: segments cut by its four sides."""
    sound = (tracks.corners >= 0).all(axis=1)
    ends = np.dstack([tracks.ends, tracks.spans[:, :, None]])[sound]
    along = ends[:, 1] - ends[:, 0]
    enter, leave = np.zeros(len(ends)), np.ones(len(ends))
    for axis in range(2):
        with np.errstate(divide="ignore", invalid="ignore"):
            to_low = (box[0, axis] - ends[:, 0, axis]) / along[:, axis]
            to_high = (box[1, axis] - ends[:, 0, axis]) / along[:, axis]
        still = along[:, axis] == 0
        inside = (ends[:, 0, axis] >= box[0, axis]) & (ends[:, 0, axis] <= box[1, axis])
        first, last = np.minimum(to_low, to_high), np.maximum(to_low, to_high)
        enter = np.maximum(enter, np.where(still, np.where(inside, 0.0, 2.0), first))
        leave = np.minimum(leave, np.where(still, 1.0, last))
    kept = enter < leave
    begin, along = ends[kept, 0], along[kept]
    cut = np.stack([begin + enter[kept, None] * along, begin + leave[kept, None] * along], axis=1)
    return StrutAxes(tracks.corners[sound][kept], cut)


def walls(tracks: Tracks, places: Floats, growth: Floats, box: Floats) -> Walls:
    """The facets inside a box (low, high) (2, 2), mm.

    `places` (n, 2), mm, and `growth` (n,), mm² per mm, are all sites'.
    """
    chains = _chains(tracks)
    sites, points, starts = _polygons(tracks, chains)
    for axis in range(2):
        for sense, bound in ((1.0, box[0, axis]), (-1.0, box[1, axis])):
            sites, points, starts = _cut(sites, points, starts, sense * (points[:, axis] - bound))
    i, j = sites.T
    apart = np.hypot(*(places[i] - places[j]).T)
    tilts = np.degrees(np.arctan2(np.abs(growth[i] - growth[j]), 2 * apart))
    return Walls(sites, points, starts, tilts)


def _chains(tracks: Tracks) -> Ints:
    """(c, 4) for each side of each facet the tracks that bound it, upwards.

    Columns: smaller and larger site, 1 for the left end of i → j's wall (seen from i) and 0 for
    the right one, and the track. Sorted by these and by height.
    """
    corners = tracks.corners
    begin = np.concatenate([corners[:, 0], corners[:, 1], corners[:, 2]])
    end = np.concatenate([corners[:, 1], corners[:, 2], corners[:, 0]])
    track = np.tile(np.arange(len(corners)), 3)
    sound = (begin >= 0) & (end >= 0)
    begin, end, track = begin[sound], end[sound], track[sound]
    left = (begin < end).astype(np.int64)
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    order = np.lexsort((tracks.spans[track, 0], left, high, low))
    return np.column_stack([low, high, left, track])[order]


def _polygons(tracks: Tracks, chains: Ints) -> tuple[Ints, Floats, Ints]:
    """The facets' sites, points and starts: up along one chain and down along the other.

    A pair of sites that meet again after they had parted (around a newborn) has several facets.
    """
    if not len(chains):
        return np.empty((0, 2), np.int64), np.empty((0, 3)), np.zeros(1, np.int64)
    track, left = chains[:, 3], chains[:, 2]
    begins, ends = tracks.spans[track].T
    same = (chains[1:, :3] == chains[:-1, :3]).all(axis=1)
    first = np.concatenate([[True], ~(same & (begins[1:] == ends[:-1]))])
    piece = np.cumsum(first) - 1
    # Pieces of the two sides belong together where sites and lower end agree.
    head = np.nonzero(first)[0]
    match = np.lexsort((left[head], begins[head], chains[head, 1], chains[head, 0]))
    facet_of_piece = np.empty(len(head), np.int64)
    facet_of_piece[match] = np.arange(len(head)) // 2
    facet = facet_of_piece[piece]
    # The right chain upwards from its lowest point, then the left one downwards. Each track begins
    # where the one below ends, but for the leaps.
    lower = np.nonzero(first | np.isin(begins, tracks.leaps))[0]
    rows = np.concatenate([lower, np.arange(len(chains))])
    upper = np.concatenate([np.zeros(len(lower), np.int64), np.ones(len(chains), np.int64)])
    z = np.where(upper == 1, ends[rows], begins[rows])
    x, y = tracks.ends[track[rows], upper].T
    upwards = 2 * rows + upper
    order = np.lexsort((np.where(left[rows] == 1, -upwards, upwards), left[rows], facet[rows]))
    points = np.column_stack([x, y, z])[order]
    starts = np.searchsorted(facet[rows][order], np.arange(len(head) // 2 + 1))
    sites = np.empty((len(head) // 2, 2), np.int64)
    sites[facet_of_piece] = chains[head, :2]
    return sites, points, starts


def _cut(sites: Ints, points: Floats, starts: Ints, height: Floats) -> tuple[Ints, Floats, Ints]:
    """The polygons' parts where `height` (p,), linear in space, is not negative.

    Sutherland and Hodgman, "Reentrant polygon clipping", Comm. ACM 1974, on all at once.
    """
    facet = np.repeat(np.arange(len(sites)), np.diff(starts))
    following = np.arange(1, len(points) + 1)
    following[starts[1:] - 1] = starts[:-1]
    inside = height >= 0
    crosses = inside != inside[following]
    share = np.zeros(len(points))
    share[crosses] = height[crosses] / (height[crosses] - height[following[crosses]])
    crossing = points + share[:, None] * (points[following] - points)
    kept = np.concatenate([np.nonzero(inside)[0] * 2, np.nonzero(crosses)[0] * 2 + 1])
    kept.sort()
    is_crossing: NDArray[np.bool_] = kept % 2 == 1
    points = np.where(is_crossing[:, None], crossing[kept // 2], points[kept // 2])
    counts = np.bincount(facet[kept // 2], minlength=len(sites))
    left = counts > 0
    return sites[left], points, np.concatenate([[0], np.cumsum(counts[left])])
