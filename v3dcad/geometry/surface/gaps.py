"""Sections where there are gaps between a part's faces and their edges.

A file may store its edges with a tolerance far above what sections are computed to. Where a run
reaches such an edge, its end lies off the face, and the runs on either side may meet before they
reach the edge, or turn back on themselves just before it. What is repaired:

* a straight run lies on its face's exact line, with a step to the edge at either end, instead of
  leaning from edge to edge all along;
* a loop no longer than `MAX_LOOP_GAPS` gaps is cut off where the ring crosses itself, or turns
  back on itself: there the two faces truly meet;
* a ring that is nowhere wider than a gap is the gap itself, and is left out.

Rings that touch no such face stay as they are.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntRows,
    FloatRows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ALLOCATING, ENTRY, INTERNAL, compiled
from v3dcad.geometry.mesh.section import SNAP, is_thin
from v3dcad.geometry.surface.conics import STRAIGHT_LINE
from v3dcad.geometry.surface.level_curves import CurveRings
from v3dcad.geometry.surface.mesh import MeshArrays
from v3dcad.geometry.surface.surfaces import PLANE

MIN_GAP = 1e-3
"""mm: edges that may lie farther off their face than this leave a gap."""

MAX_LOOP_GAPS = 8
"""Longest loop that is cut off, as a multiple of the gap. An edge that lies one gap off its face
lets the runs beside it overshoot by as much, there and back, and by more where they meet at a flat
angle."""


@compiled(INTERNAL)
def _feet(
    coefficients: ConstFloatArray,
    surface: int,
    height: float,
    x: float,
    y: float,
    far_x: float,
    far_y: float,
) -> tuple[float, float, float, float]:
    """The nearest points to two points, on the line that z = height cuts from a plane, or from a
    lying cylinder on their side of its axis: x, y, and x, y.
    """
    a, b, rise = (
        coefficients[surface + 1],
        coefficients[surface + 2],
        height - coefficients[surface + 3],
    )
    e, f, g = coefficients[surface + 10], coefficients[surface + 11], coefficients[surface + 12]
    level = max(np.hypot(e, f), 1e-300)
    if int(coefficients[surface]) == PLANE:
        across_x, across_y = e / level, f / level
        aside = -g * rise / level
    else:
        across_x, across_y = -f / level, e / level
        aside = np.sqrt(max(coefficients[surface + 13] ** 2 - rise * rise, 0.0))
        if ((x + far_x) / 2 - a) * across_x + ((y + far_y) / 2 - b) * across_y < 0.0:
            aside = -aside
    step = aside - (x - a) * across_x - (y - b) * across_y
    far_step = aside - (far_x - a) * across_x - (far_y - b) * across_y
    return (
        x + step * across_x,
        y + step * across_y,
        far_x + far_step * across_x,
        far_y + far_step * across_y,
    )


@compiled(ALLOCATING)
def _stepped(
    mesh: MeshArrays, ring: ConstFloatRows, runs: ConstIntRows, height: float
) -> tuple[FloatRows, IntArray]:
    """The points of a ring with its straight runs moved onto their faces' lines.

    Returns points (p, 2), mm, and the owner (p,) of the segment from each: twice the run's number
    in the ring, and one more for a step between an edge and the line.
    """
    count = len(ring)
    path = np.empty((count + 2 * len(runs), 2))
    owner = np.empty(len(path), np.int64)
    written = 0
    for run in range(len(runs)):
        start, stop, face = runs[run, 1], runs[run, 2], runs[run, 4]
        for k in range(start, stop):
            path[written, 0], path[written, 1], owner[written] = ring[k, 0], ring[k, 1], 2 * run
            written += 1
        if runs[run, 3] != STRAIGHT_LINE or mesh.gaps[face] == 0.0:
            continue
        x, y, far_x, far_y = (
            ring[start, 0],
            ring[start, 1],
            ring[stop % count, 0],
            ring[stop % count, 1],
        )
        foot_x, foot_y, far_foot_x, far_foot_y = _feet(
            mesh.coefficients, mesh.surfaces[face], height, x, y, far_x, far_y
        )
        step = np.hypot(foot_x - x, foot_y - y)
        far_step = np.hypot(far_foot_x - far_x, far_foot_y - far_y)
        ahead = (far_x - x) * (far_foot_x - foot_x) + (far_y - y) * (far_foot_y - foot_y)
        # Where a face is so flat that its line is far off the edge, the run stays as it is.
        if max(step, far_step) > MAX_LOOP_GAPS * mesh.gaps[face] or ahead <= 0.0:
            continue
        if step > SNAP:
            owner[written - 1] = 2 * run + 1
            path[written, 0], path[written, 1], owner[written] = foot_x, foot_y, 2 * run
            written += 1
        if far_step > SNAP:
            path[written, 0], path[written, 1] = far_foot_x, far_foot_y
            owner[written] = 2 * run + 1
            written += 1
    return path[:written], owner[:written]


@linked(INTERNAL)
def _length(path: FloatRows, one: int, other: int) -> float:
    return np.hypot(path[other, 0] - path[one, 0], path[other, 1] - path[one, 1])


@compiled(INTERNAL)
def _first_crossing(path: FloatRows, last: int, reach: float) -> tuple[int, float, float]:
    """The first segment of a path that its segment to point `last` crosses, and where, if the
    loop between them is no longer than `reach`; −1 for none.
    """
    found, at_x, at_y, passed = -1, 0.0, 0.0, 0.0
    x, y = path[last - 1, 0], path[last - 1, 1]
    way_x, way_y = path[last, 0] - x, path[last, 1] - y
    for k in range(last - 3, -1, -1):
        passed += _length(path, k + 1, k + 2)
        if passed > reach:
            break
        from_x, from_y = path[k, 0] - x, path[k, 1] - y
        step_x, step_y = path[k + 1, 0] - path[k, 0], path[k + 1, 1] - path[k, 1]
        turn = way_x * step_y - way_y * step_x
        if turn == 0.0:
            continue
        share = (from_x * step_y - from_y * step_x) / turn
        back = (from_x * way_y - from_y * way_x) / turn
        if min(share, back, 1 - share, 1 - back) < 0.0:
            continue
        ends = share * np.hypot(way_x, way_y) + (1 - back) * np.hypot(step_x, step_y)
        if passed + ends <= reach:
            found, at_x, at_y = k, x + share * way_x, y + share * way_y
    return found, at_x, at_y


@linked(INTERNAL)
def _turns_back(path: FloatRows, last: int, reach: float) -> bool:
    """Whether a path comes back to point `last` the way it went to the one before."""
    x, y = path[last - 1, 0], path[last - 1, 1]
    from_x, from_y = path[last - 2, 0] - x, path[last - 2, 1] - y
    to_x, to_y = path[last, 0] - x, path[last, 1] - y
    shorter, longer = np.hypot(from_x, from_y), np.hypot(to_x, to_y)
    shorter, longer = min(shorter, longer), max(shorter, longer)
    if 2 * shorter > reach or from_x * to_x + from_y * to_y <= 0.0:
        return False
    return abs(from_x * to_y - from_y * to_x) <= SNAP * longer


@compiled(ALLOCATING)
def _without_loops(
    path: FloatRows, owner: IntArray, reach: float
) -> tuple[FloatRows, IntArray, bool]:
    """A ring (k, 2) with its loops no longer than `reach` cut off where it crosses itself.

    `owner` (k,) is the owner of the segment from each point. Returns both and whether anything
    was cut off.
    """
    count = len(path)
    longest, most = 0, -1.0
    for k in range(count):
        length = _length(path, k, (k + 1) % count)
        if length > most:
            longest, most = k, length
    # The walk begins and ends in the middle of the longest segment, where no short loop is.
    after = (longest + 1) % count
    x, y = (path[longest, 0] + path[after, 0]) / 2, (path[longest, 1] + path[after, 1]) / 2
    kept = np.empty((count + 2, 2))
    whose = np.empty(count + 2, np.int64)
    kept[0, 0], kept[0, 1], whose[0] = x, y, owner[longest]
    top, cut = 1, False
    for k in range(1, count + 2):
        here = (longest + k) % count
        if k <= count:
            kept[top, 0], kept[top, 1] = path[here, 0], path[here, 1]
        else:
            kept[top, 0], kept[top, 1] = x, y
        while top >= 2 and _turns_back(kept, top, reach):
            if _length(kept, top - 1, top) > _length(kept, top - 2, top - 1):
                whose[top - 2] = whose[top - 1]
            top -= 1
            kept[top, 0], kept[top, 1] = kept[top + 1, 0], kept[top + 1, 1]
            cut = True
        crossed, at_x, at_y = _first_crossing(kept, top, reach)
        if crossed >= 0:
            # The crossing replaces the loop; the segment that crossed goes on from there.
            goal_x, goal_y, way_on = kept[top, 0], kept[top, 1], whose[top - 1]
            top = crossed + 2
            kept[top - 1, 0], kept[top - 1, 1], whose[top - 1] = at_x, at_y, way_on
            if _length(kept, top - 2, top - 1) == 0.0:
                top -= 1
                whose[top - 1] = way_on
            if at_x == goal_x and at_y == goal_y:
                top -= 1
            kept[top, 0], kept[top, 1] = goal_x, goal_y
            cut = True
        whose[top] = owner[here]
        top += 1
    return kept[1 : top - 1], whose[1 : top - 1], cut


@linked(INTERNAL)
def _copy_run(
    runs: ConstIntRows,
    parameters: ConstFloatRows,
    source: int,
    new_runs: IntRows,
    new_parameters: FloatRows,
    made: int,
) -> None:
    for column in range(runs.shape[1]):
        new_runs[made, column] = runs[source, column]
    for column in range(parameters.shape[1]):
        new_parameters[made, column] = parameters[source, column]


@compiled(ENTRY)
def repaired(mesh: MeshArrays, rings: CurveRings, heights: ConstFloatArray) -> CurveRings:
    """The rings, which lie at heights (r,), mm, repaired where faces of the mesh have gaps."""
    points, starts, runs, parameters = rings
    gaps = mesh.gaps
    room = len(points) + 2 * len(runs)
    out = np.empty((room, 2))
    new_starts = np.zeros(len(starts), np.int64)
    new_runs = np.empty((room, 5), np.int64)
    new_parameters = np.empty((room, parameters.shape[1]))
    written = made = run = 0
    for ring in range(len(starts) - 1):
        path = points[starts[ring] : starts[ring + 1]]
        first_run, gap = run, 0.0
        while run < len(runs) and runs[run, 0] == ring:
            gap = max(gap, gaps[runs[run, 4]])
            run += 1
        count, changed = len(path), False
        if gap > 0.0:
            own_runs = runs[first_run:run]
            stepped, owner = _stepped(mesh, path, own_runs, heights[ring])
            whole, owner, cut = _without_loops(stepped, owner, MAX_LOOP_GAPS * gap)
            if is_thin(whole, gap):
                count = 0
            elif cut or len(stepped) > count:
                path, count, changed = whole, len(whole), True
        turn = 0
        if changed:
            while turn < count - 1 and owner[turn] == owner[turn - 1]:
                turn += 1
        for k in range(count):
            here = (turn + k) % count
            out[written + k, 0], out[written + k, 1] = path[here, 0], path[here, 1]
            if changed and (k == 0 or owner[here] != owner[here - 1]):
                _copy_run(
                    runs, parameters, first_run + owner[here] // 2, new_runs, new_parameters, made
                )
                new_runs[made, 1] = k
                made += 1
            if changed:
                new_runs[made - 1, 2] = k + 1
        if count and not changed:
            for source in range(first_run, run):
                _copy_run(runs, parameters, source, new_runs, new_parameters, made)
                made += 1
        written += count
        new_starts[ring + 1] = written
    return CurveRings(
        out[:written].copy(), new_starts, new_runs[:made].copy(), new_parameters[:made].copy()
    )
