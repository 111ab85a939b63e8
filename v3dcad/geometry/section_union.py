"""The union of a section's contours: its material is what they wind around at all.

Bodies that touch, overlap or lie inside one another, and one that passes through itself, have
contours that cross, or wind around some area twice. Their union by non-zero winding is found on
polylines, which GEOS nodes on a grid (Hobby, "Practical segment intersection with finite precision
output", 1999): so that none of it depends on rounding. What is exact stays so:

* where contours meet, both first get a corner, which lies on both of their true curves. So curves
  that coincide have the same chords, and cancel out;
* corners keep their coordinates, and each stretch of the result the curve that it comes from.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from v3dcad.geometry.clipping.ring_validity import winding_fault
from v3dcad.model import CurveRun, Floats, Ints, Section

GRID = 1e-8
"""mm: the grid on which polylines are noded."""

TOUCH = 1e-6
"""mm: a corner this close to another contour lies on it; bodies this close touch."""

SHALLOW = 1e-3
"""Sine of the least angle at which curves are taken to cross in one point."""

LINE, CIRCLE, ELLIPSE, POINTS = range(4)
KINDS = {"line": LINE, "circle": CIRCLE, "ellipse": ELLIPSE, "points": POINTS}

Node = tuple[int, int]
"""A corner as it lies on the grid: steps in x and y."""


def united(sections: Sequence[Section], chord_tolerance: float, bodies_meet: bool) -> list[Section]:
    """The sections, those whose contours cross or wind around an area twice united.

    Where `bodies_meet` those are united too whose contours only touch; all others stay as they are.
    `chord_tolerance` (mm) is how far chords lie from curves.
    """
    chosen = {k for k, section in enumerate(sections) if bodies_meet and len(section.rings) > 1}
    chosen |= set(faulty(sections))
    return [
        union(section, chord_tolerance, bodies_meet) if k in chosen else section
        for k, section in enumerate(sections)
    ]


def faulty(sections: Sequence[Section]) -> list[int]:
    """Which sections have contours that wind around some area neither 0 times nor once."""
    rings = [ring for section in sections for ring in section.rings]
    if not rings:
        return []
    corners = np.ascontiguousarray(np.concatenate(rings))
    starts = np.cumsum([0, *map(len, rings)])
    layers = np.cumsum([0, *(len(section.rings) for section in sections)])
    found: list[int] = []
    begin = 0
    while begin < len(sections):
        layer = winding_fault(corners, starts, layers[begin:])[0]
        if layer < 0:
            break
        found.append(begin + layer)
        begin = found[-1] + 1
    return found


def meeting(low: Floats, high: Floats) -> Ints:
    """The pairs (p, 2), i < j, of boxes with corners low and high (b, 3), mm, that meet."""
    tree = shapely.STRtree(shapely.box(*(low[:, :2] - TOUCH).T, *high[:, :2].T))
    one, other = tree.query(tree.geometries, predicate="intersects")
    above = (low[one, 2] - TOUCH <= high[other, 2]) & (low[other, 2] - TOUCH <= high[one, 2])
    kept = above & (one < other)
    pairs = np.column_stack([one[kept], other[kept]])
    return np.asarray(pairs[np.lexsort(pairs.T[::-1])], np.int64)


class _Chords(NamedTuple):
    """The chords of all rings, ring after ring."""

    start: Floats
    """(s, 2) mm"""
    stop: Floats
    """(s, 2) mm"""
    ring: Ints
    """(s,)"""
    run: Ints
    """(s,) the run that each lies on, or one of its own below 0"""
    kind: Ints
    """(s,) LINE, CIRCLE, ELLIPSE or POINTS"""
    curve: Floats
    """(s, 5) parameters of the run, and zeros"""

    def of(self, rows: Ints) -> _Chords:
        """Some of them."""
        return _Chords(*(column[rows] for column in self))  # type: ignore[arg-type]


def _chords(section: Section) -> _Chords:
    lengths = np.array([len(ring) for ring in section.rings])
    first = np.cumsum(lengths) - lengths
    start = np.concatenate(section.rings)
    stop = np.concatenate([np.roll(ring, -1, axis=0) for ring in section.rings])
    count = len(start)
    run, kind, curve = -1 - np.arange(count), np.full(count, LINE), np.zeros((count, 5))
    for number, (ring, begin, end, name, _, parameters) in enumerate(section.runs):
        rows = slice(first[ring] + begin, first[ring] + end)
        run[rows], kind[rows] = number, KINDS[name]
        curve[rows, : len(parameters)] = parameters
    return _Chords(start, stop, np.repeat(np.arange(len(lengths)), lengths), run, kind, curve)


def _aside(points: Floats, chords: _Chords) -> tuple[Floats, Floats]:
    """How far points (p, 2) lie from the curves of chords (p,), mm, and the curves' normals (p, 2).

    The distance of an ellipse is right to first order: as near to it as the points are.
    """
    way = chords.stop - chords.start
    normal = np.column_stack([-way[:, 1], way[:, 0]]) / np.hypot(*way.T)[:, None]
    aside = np.sum((points - chords.start) * normal, axis=1)
    arm = points - chords.curve[:, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        round_ = chords.kind == CIRCLE
        length = np.hypot(*arm.T)
        aside = np.where(round_, length - chords.curve[:, 2], aside)
        normal = np.where(round_[:, None], arm / length[:, None], normal)
        oval = chords.kind == ELLIPSE
        major = np.hypot(*chords.curve[:, 2:4].T)
        along = chords.curve[:, 2:4] / major[:, None]
        across = np.column_stack([-along[:, 1], along[:, 0]])
        u, v = np.sum(arm * along, axis=1), np.sum(arm * across, axis=1)
        minor = major * chords.curve[:, 4]
        level = np.hypot(u / major, v / minor)
        slope = (u / major**2 / level)[:, None] * along + (v / minor**2 / level)[:, None] * across
        steep = np.hypot(*slope.T)
        aside = np.where(oval, (level - 1) / steep, aside)
        normal = np.where(oval[:, None], slope / steep[:, None], normal)
    return aside, normal


def _share(points: Floats, chords: _Chords) -> Floats:
    """How far along chords (p,) points (p, 2) lie: 0 at the start, 1 at the end."""
    way = chords.stop - chords.start
    share: Floats = np.sum((points - chords.start) * way, axis=1) / np.sum(way * way, axis=1)
    return share


def _near(points: Floats, others: Floats) -> NDArray[np.bool_]:
    return np.asarray(np.hypot(*(points - others).T) < TOUCH)


def _with_common_corners(chords: _Chords, tolerance: float) -> tuple[Floats, Ints]:
    """The rings with a corner more wherever they meet: points (q, 2), and whose chord (q,) each
    one begins a piece of.
    """
    low, high = np.minimum(chords.start, chords.stop), np.maximum(chords.start, chords.stop)
    reach = 2 * (tolerance + TOUCH)
    tree = shapely.STRtree(shapely.box(*(low - reach).T, *high.T))
    one, other = tree.query(tree.geometries)
    apart = chords.run[one] != chords.run[other]
    one, other = one[apart], other[apart]
    # A corner that lies on another chord's curve becomes a corner there.
    target, point = chords.of(other), chords.start[one]
    aside, _ = _aside(point, target)
    share = _share(point, target)
    on = np.abs(aside) <= np.where(target.kind == POINTS, tolerance + TOUCH, TOUCH)
    on &= (share > 0) & (share < 1) & ~_near(point, target.start) & ~_near(point, target.stop)
    found = [(other[on], share[on], point[on])]
    # Where chords cross, so do their curves: both get a corner there.
    pairs = one < other
    a, b = chords.of(one[pairs]), chords.of(other[pairs])
    point, crossing = _crossing(a, b, tolerance)
    for chord, at in zip(one[pairs][crossing], point[crossing], strict=True):
        found.append(_placed(chords, int(chord), at))
    for chord, at in zip(other[pairs][crossing], point[crossing], strict=True):
        found.append(_placed(chords, int(chord), at))
    count = len(chords.start)
    owner = np.concatenate([np.arange(count), *(rows for rows, _, _ in found)])
    along = np.concatenate([np.zeros(count), *(shares for _, shares, _ in found)])
    points = np.concatenate([chords.start, *(corners for _, _, corners in found)])
    order = np.lexsort((points[:, 1], points[:, 0], along, owner))
    return points[order], owner[order]


def _crossing(a: _Chords, b: _Chords, tolerance: float) -> tuple[Floats, NDArray[np.bool_]]:
    """Where the curves of chords (p,) cross in pairs: points (p, 2), and which of them do.

    Newton's method on both curves, from where the chords cross.
    """
    way, over, gap = a.stop - a.start, b.stop - b.start, b.start - a.start
    turn = way[:, 0] * over[:, 1] - way[:, 1] * over[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (gap[:, 0] * over[:, 1] - gap[:, 1] * over[:, 0]) / turn
        back = (gap[:, 0] * way[:, 1] - gap[:, 1] * way[:, 0]) / turn
        crosses = (share > 0) & (share < 1) & (back > 0) & (back < 1)
        point = a.start + share[:, None] * way
        first = point
        for _ in range(6):
            f, p = _aside(point, a)
            g, q = _aside(point, b)
            turn = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
            step_x, step_y = g * p[:, 1] - f * q[:, 1], f * q[:, 0] - g * p[:, 0]
            point = point + np.column_stack([step_x, step_y]) / turn[:, None]
        crosses &= np.abs(turn) > SHALLOW
        crosses &= np.hypot(*(point - first).T) <= 4 * (tolerance + TOUCH) / np.abs(turn)
    for end in (a.start, a.stop, b.start, b.stop):
        crosses &= ~_near(point, end)
    return point, crosses


def _placed(chords: _Chords, chord: int, point: Floats) -> tuple[Ints, Floats, Floats]:
    """The chord of the same run that is nearest to a point (2,) on its curve, and how far along."""
    rows = np.flatnonzero(chords.run == chords.run[chord])
    run, points = chords.of(rows), np.broadcast_to(point, (len(rows), 2))
    share = np.clip(_share(points, run), 0, 1)
    foot = run.start + share[:, None] * (run.stop - run.start)
    nearest = [int(np.argmin(np.hypot(*(foot - point).T)))]
    return rows[nearest], share[nearest], points[nearest]


def union(section: Section, tolerance: float, touching: bool = True) -> Section:
    """The section bounded by what its rings wind around; itself where that is no other.

    Rings whose boxes lie apart have nothing to do with each other. So each group of rings is united
    by itself: those that wind around an area twice and, where `touching`, those of which one
    touches another. Rings of the union no wider than the chord tolerance lie between curves that
    touch: they are left out.
    """
    groups = _groups(section)
    chosen = set(faulty(groups))
    if touching:
        chosen |= {k for k, group in enumerate(groups) if _rings_touch(group, tolerance)}
    if not chosen:
        return section
    return _together(
        _united(group, tolerance) if k in chosen else group for k, group in enumerate(groups)
    )


def _groups(section: Section) -> list[Section]:
    """A section in pieces: rings are together whose boxes meet, or are linked by others that do."""
    low = np.array([ring.min(axis=0) for ring in section.rings])
    high = np.array([ring.max(axis=0) for ring in section.rings])
    tree = shapely.STRtree(shapely.box(*(low - TOUCH).T, *high.T))
    one, other = tree.query(tree.geometries, predicate="intersects")
    links = coo_array((np.ones(len(one)), (one, other)), shape=(len(low), len(low)))
    count, group = connected_components(links, directed=False)
    if count == 1:
        return [section]
    rings = [np.flatnonzero(group == k).tolist() for k in range(count)]
    place = {ring: number for some in rings for number, ring in enumerate(some)}
    runs: list[list[CurveRun]] = [[] for _ in rings]
    for run in section.runs:
        runs[group[run.ring]].append(run._replace(ring=place[run.ring]))
    return [
        Section(section.z, tuple(section.rings[ring] for ring in some), tuple(own))
        for some, own in zip(rings, runs, strict=True)
    ]


def _together(pieces: Iterable[Section]) -> Section:
    """One section of the rings of all pieces, which lie at one height."""
    rings: list[Floats] = []
    runs: list[CurveRun] = []
    for piece in pieces:
        runs += [run._replace(ring=run.ring + len(rings)) for run in piece.runs]
        rings += piece.rings
    return Section(piece.z, tuple(rings), tuple(runs))


def _rings_touch(section: Section, tolerance: float) -> bool:
    """Whether one of a section's rings comes so near another that their curves may touch."""
    rings = np.array([shapely.linearrings(ring) for ring in section.rings])
    one, other = shapely.STRtree(rings).query(
        rings, predicate="dwithin", distance=2 * (tolerance + TOUCH)
    )
    return bool(np.any(one != other))


def _united(section: Section, tolerance: float) -> Section:
    """The union of a section whose rings all have to do with each other."""
    chords = _chords(section)
    moving = np.any(chords.start != chords.stop, axis=1)
    chords = chords.of(np.flatnonzero(moving))
    corners, owner = _with_common_corners(chords, tolerance)
    nodes = np.rint(corners / GRID).astype(np.int64)
    ring = chords.ring[owner]
    last = np.flatnonzero(np.append(np.diff(ring), 1))
    follower = np.arange(1, len(nodes) + 1)
    follower[last] = np.append(0, last[:-1] + 1)
    moving = np.any(nodes != nodes[follower], axis=1)
    start, stop, owner = nodes[moving], nodes[follower][moving], owner[moving]
    sources: dict[tuple[Node, Node], int] = {}
    for a, b, chord in zip(start.tolist(), stop.tolist(), owner.tolist(), strict=True):
        sources.setdefault((tuple(a), tuple(b)), chord)
    loops = _boundary(np.asarray(start * GRID), np.asarray(stop * GRID))
    sides = {side for loop in loops for side in _sides(loop)}
    if len(sources) == len(start) and sides == sources.keys():
        return section
    exact = dict(zip(map(tuple, nodes.tolist()), corners.tolist(), strict=True))
    lines = shapely.STRtree(shapely.linestrings(np.stack([start, stop], axis=1) * GRID))
    rings: list[Floats] = []
    runs: list[CurveRun] = []
    for loop in loops:
        of = [_source(side, sources, lines, owner) for side in _sides(loop)]
        points = np.array([exact.get(node, (node[0] * GRID, node[1] * GRID)) for node in loop])
        if _is_thin(points, max(tolerance, TOUCH)):
            continue
        own = chords.run[of]
        first = next((k for k in range(len(own)) if own[k] != own[k - 1]), 0)
        if section.runs:
            runs += list(_runs(len(rings), np.roll(own, -first), section.runs))
        rings.append(np.roll(points, -first, axis=0))
    return Section(section.z, tuple(rings), tuple(runs))


def _boundary(start: Floats, stop: Floats) -> list[list[Node]]:
    """The boundary of what closed rings of sides (s, 2) → (s, 2), mm, on the grid, wind around:
    loops of nodes with the material on their left.
    """
    noded = shapely.union_all(shapely.linestrings(np.stack([start, stop], axis=1)), grid_size=GRID)
    faces = shapely.get_parts(shapely.polygonize([noded]))
    inside = _winding(shapely.get_coordinates(shapely.point_on_surface(faces)), start, stop) != 0
    loops = []
    for area in shapely.get_parts(shapely.coverage_union_all(faces[inside])):
        for number, line in enumerate(shapely.get_rings(area)):
            corners = shapely.get_coordinates(line)[:-1]
            x, y = (corners - corners[0]).T
            left = x @ np.roll(y, -1) > y @ np.roll(x, -1)
            steps = np.rint((corners if left == (number == 0) else corners[::-1]) / GRID)
            least = int(np.lexsort(steps.T)[0])
            loops.append([(int(x), int(y)) for x, y in np.roll(steps, -least, axis=0)])
    return loops


def _winding(points: Floats, start: Floats, stop: Floats) -> Ints:
    """(p,) how often closed rings of sides (s, 2) → (s, 2) wind around points (p, 2)."""
    numbers = np.zeros(len(points), np.int64)
    for number, (x, y) in enumerate(points.tolist()):
        upward = (start[:, 1] <= y) & (stop[:, 1] > y)
        downward = (stop[:, 1] <= y) & (start[:, 1] > y)
        across = upward | downward
        a, b = start[across], stop[across]
        left = (b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])
        rises = upward[across]
        numbers[number] = np.count_nonzero(rises & (left > 0)) - np.count_nonzero(
            ~rises & (left < 0)
        )
    return numbers


def _sides(loop: list[Node]) -> Iterator[tuple[Node, Node]]:
    return zip(loop, loop[1:] + loop[:1], strict=True)


def _source(
    side: tuple[Node, Node],
    sources: dict[tuple[Node, Node], int],
    lines: shapely.STRtree,
    owner: Ints,
) -> int:
    """The chord that a side of the union comes from, either way round."""
    found = sources.get(side, sources.get(side[::-1]))
    if found is None:  # a piece of one that is crossed where no curves are known to cross
        middle = (np.array(side[0]) + np.array(side[1])) / 2 * GRID
        found = int(owner[lines.nearest(shapely.points(middle))])
    return found


def _runs(ring: int, own: Ints, runs: tuple[CurveRun, ...]) -> Iterator[CurveRun]:
    """The runs of a ring whose chords (k,) lie on the runs `own`, and which begins with one."""
    begin = np.flatnonzero(np.diff(own, prepend=-1))
    for start, stop in zip(begin.tolist(), [*begin[1:].tolist(), len(own)], strict=True):
        yield runs[own[start]]._replace(ring=ring, start=start, stop=stop)


def _is_thin(ring: Floats, width: float) -> bool:
    """Whether the area of a ring (k, 2), mm, is that of a line of a width, or less."""
    x, y = (ring - ring[0]).T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    return area <= width * float(np.hypot(*(np.roll(ring, -1, axis=0) - ring).T).sum()) / 2
