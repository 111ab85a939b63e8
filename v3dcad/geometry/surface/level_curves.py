"""From crossings to rings: exact conics sampled, other level lines followed by Newton's method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstFloatArray, FloatRows, IntArray, IntRows
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ALLOCATING, ENTRY, INLINED, INTERNAL, compiled
from v3dcad.geometry.mesh.section import SNAP, Crossings, is_thin
from v3dcad.geometry.surface.conics import NO_CONIC, STRAIGHT_LINE, Conic, conic_at
from v3dcad.geometry.surface.mesh import MeshArrays, project
from v3dcad.geometry.surface.surfaces import step_to_line, surface_at

CurvePoint = tuple[float, float, float, float]
"""A point of a level line on a surface: x, y, u, v."""

MAX_HALVINGS = 10
"""Of the stretch between two mesh edges."""


class CurveRings(NamedTuple):
    """Rings of points, and on which curve of which face each stretch of them lies."""

    points: FloatRows
    """(q, 2) mm"""
    starts: IntArray
    """(r + 1,) where each ring begins"""
    runs: IntRows
    """(m, 5) stretches of rings: ring, start, stop, kind of conic, face"""
    parameters: FloatRows
    """(m, 5) of the conic of each run: the fields of `Conic` after its kind"""


class _Stretch(NamedTuple):
    """Crossings `first` … `last` of a ring, all on one face; `whole` where they are all of it.

    The ring has `length` crossings from index `begin` on, and is counted from its crossing `turn`.
    """

    begin: int
    length: int
    turn: int
    first: int
    last: int
    whole: bool


@compiled(INLINED)
def _index(stretch: _Stretch, k: int) -> int:
    """The index of a ring's crossing k."""
    return stretch.begin + (stretch.turn + k) % stretch.length


@linked(ALLOCATING)
def _with_room(out: FloatRows, written: int, more: int) -> FloatRows:
    """The array, or its content in a greater one if it has no room for more rows."""
    if written + more <= len(out):
        return out
    grown = np.empty((2 * (written + more), 2))
    for row in range(written):
        grown[row, 0], grown[row, 1] = out[row, 0], out[row, 1]
    return grown


@compiled(INTERNAL)
def _direction(conic: Conic, x: float, y: float) -> float:
    """The angle of a point on an ellipse, in the circle that the ellipse is squeezed from."""
    x, y = x - conic.x, y - conic.y
    c, d = conic.major_x, conic.major_y
    return np.arctan2((y * c - x * d) / conic.ratio, x * c + y * d)


@compiled(INTERNAL)
def _crossing(
    mesh: MeshArrays, crossings: Crossings, shares: ConstFloatArray, triangle: int, crossing: int
) -> CurvePoint:
    """A crossing on one of a triangle's sides: x, y, and its parameters on the surface."""
    edge, share = crossings.edges[crossing], shares[crossing]
    corners = mesh.corners[triangle]
    u, v = corners[0, 0], corners[0, 1]
    for k in range(3):
        if mesh.sides[triangle, k] == edge:
            if mesh.triangles[triangle, k] != mesh.edge_nodes[edge, 0]:
                share = 1 - share
            after = (k + 1) % 3
            u = (1 - share) * corners[k, 0] + share * corners[after, 0]
            v = (1 - share) * corners[k, 1] + share * corners[after, 1]
            break
    return crossings.points[crossing, 0], crossings.points[crossing, 1], u, v


@compiled(INTERNAL)
def _between(
    coefficients: ConstFloatArray,
    surface: int,
    height: float,
    one: CurvePoint,
    other: CurvePoint,
) -> tuple[bool, float, float, float, float]:
    """The point of the level line half way between two of its points: Newton's method on
    z(u, v) = height and (x, y) on the perpendicular bisector.
    """
    chord_x, chord_y = other[0] - one[0], other[1] - one[1]
    middle_x, middle_y = (one[0] + other[0]) / 2, (one[1] + other[1]) / 2
    length = np.hypot(chord_x, chord_y)
    u, v = (one[2] + other[2]) / 2, (one[3] + other[3]) / 2
    if length == 0.0:
        return False, middle_x, middle_y, u, v
    settled = False
    for _ in range(12):
        s = surface_at(coefficients, surface, u, v)
        rise = s[0][2] - height
        along = (s[0][0] - middle_x) * chord_x + (s[0][1] - middle_y) * chord_y
        if settled:
            near = np.hypot(s[0][0] - middle_x, s[0][1] - middle_y) < length
            return near, s[0][0], s[0][1], u, v
        # One more step squares an error as small as this: down to rounding.
        settled = abs(rise) < 1e-9 and abs(along) < 1e-6 * length * length
        solvable, u_step, v_step = step_to_line(s, rise, along, chord_x, chord_y)
        if not solvable:
            break
        u -= u_step
        v -= v_step
    return False, middle_x, middle_y, u, v


@linked(ALLOCATING)
def _follow(
    coefficients: ConstFloatArray,
    surface: int,
    height: float,
    one: CurvePoint,
    other: CurvePoint,
    tolerance: float,
    out: FloatRows,
    written: int,
) -> int:
    """Write the first point and what is needed between it and the other, which is not written.

    Both are x, y and parameters u, v.
    """
    depth = 0
    ends = np.empty((MAX_HALVINGS + 2, 4))
    halvings = np.zeros(MAX_HALVINGS + 2, np.int64)
    ends[0, 0], ends[0, 1], ends[0, 2], ends[0, 3] = other
    here = one
    while depth >= 0:
        there = ends[depth, 0], ends[depth, 1], ends[depth, 2], ends[depth, 3]
        halved = False
        if halvings[depth] < MAX_HALVINGS:
            solved, x, y, u, v = _between(coefficients, surface, height, here, there)
            if solved:
                chord_x, chord_y = there[0] - here[0], there[1] - here[1]
                away = (x - here[0]) * chord_y - (y - here[1]) * chord_x
                if abs(away) > tolerance * np.hypot(chord_x, chord_y):
                    halvings[depth] += 1
                    depth += 1
                    halvings[depth] = halvings[depth - 1]
                    ends[depth, 0], ends[depth, 1], ends[depth, 2], ends[depth, 3] = x, y, u, v
                    halved = True
        if not halved:
            out[written, 0], out[written, 1] = here[0], here[1]
            written += 1
            here = there
            depth -= 1
    return written


@linked(ALLOCATING)
def _add_line(
    out: FloatRows, written: int, points: FloatRows, stretch: _Stretch
) -> tuple[FloatRows, int]:
    """Write the first point of a straight stretch; returns the points and their number."""
    here, last = _index(stretch, stretch.first), _index(stretch, stretch.last)
    if points[here, 0] != points[last, 0] or points[here, 1] != points[last, 1]:
        out = _with_room(out, written, 1)
        out[written, 0], out[written, 1] = points[here, 0], points[here, 1]
        written += 1
    return out, written


@linked(ALLOCATING)
def _add_conic(
    out: FloatRows,
    written: int,
    points: FloatRows,
    stretch: _Stretch,
    conic: Conic,
    tolerance: float,
) -> tuple[FloatRows, int]:
    """Write points of a circle or ellipse, their chords within the tolerance, without the last.

    Returns the points and their number.
    """
    here = _index(stretch, stretch.first)
    angle = before = _direction(conic, points[here, 0], points[here, 1])
    swept = 0.0
    for k in range(stretch.first + 1, stretch.last + 1):
        other = _index(stretch, k)
        after = _direction(conic, points[other, 0], points[other, 1])
        way = after - before
        if way > np.pi:  # the next point is less than half a turn away
            way -= 2 * np.pi
        elif way <= -np.pi:
            way += 2 * np.pi
        swept += way
        before = after
    a, b, c, d = conic.x, conic.y, conic.major_x, conic.major_y
    major = np.hypot(c, d)
    step = 2 * np.arccos(max(1 - tolerance / major, 0.5)) if major > 0 else np.pi
    pieces = int(np.ceil(abs(swept) / step))
    out = _with_room(out, written, pieces)
    for k in range(pieces):
        if k == 0 and not stretch.whole:
            out[written, 0], out[written, 1] = points[here, 0], points[here, 1]
        else:
            cosine = np.cos(angle + swept * k / pieces)
            sine = np.sin(angle + swept * k / pieces) * conic.ratio
            out[written, 0] = a + cosine * c - sine * d
            out[written, 1] = b + cosine * d + sine * c
        written += 1
    return out, written


@linked(ALLOCATING)
def _passed(
    mesh: MeshArrays,
    crossings: Crossings,
    shares: ConstFloatArray,
    stretch: _Stretch,
    height: float,
    way: int,
) -> tuple[int, CurvePoint]:
    """The crossing that a stretch goes to from its first one (`way` 1), or comes from to its last
    (−1), and that end's true parameters.

    A stretch ends on an edge of the B-rep. Where this bows into the face, mesh edges may lie beyond
    it: the crossings there are none of the face, and are passed over. In the parameters such an
    end lies beyond the mesh edge, as seen from the triangle between them.
    """
    k, stop = (stretch.first, stretch.last) if way > 0 else (stretch.last, stretch.first)
    here = _index(stretch, k)
    triangle = crossings.triangles[here if way > 0 else _index(stretch, k - 1)]
    end = _crossing(mesh, crossings, shares, triangle, here)
    k += way
    if mesh.edge_curves[crossings.edges[here]] < 0 or k == stop:
        return k, end
    surface = mesh.surfaces[mesh.faces[triangle]]
    point = np.empty(3)
    point[0], point[1], point[2] = end[0], end[1], height
    u, v = project(mesh.coefficients, surface, point, end[2], end[3])
    while k != stop and mesh.edge_curves[crossings.edges[_index(stretch, k)]] < 0:
        triangle = crossings.triangles[_index(stretch, k - 1 if way > 0 else k)]
        side = 0
        while side < 2 and mesh.sides[triangle, side] != crossings.edges[_index(stretch, k)]:
            side += 1
        a, b = mesh.corners[triangle, side], mesh.corners[triangle, (side + 1) % 3]
        c = mesh.corners[triangle, (side + 2) % 3]
        own = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        aside = (b[0] - a[0]) * (v - a[1]) - (b[1] - a[1]) * (u - a[0])
        if not own * aside < 0.0:
            break
        k += way
    return k, (end[0], end[1], u, v)


@linked(ALLOCATING)
def _add_level_curve(
    out: FloatRows,
    written: int,
    mesh: MeshArrays,
    crossings: Crossings,
    shares: ConstFloatArray,
    stretch: _Stretch,
    height: float,
    tolerance: float,
) -> tuple[FloatRows, int]:
    """Write points of a level curve on a surface, without the last; returns them and their number.

    Newton's method finds them between crossings, until chords are within the tolerance.
    """
    points, crossed = crossings.points, crossings.triangles
    surface = mesh.surfaces[mesh.faces[crossed[_index(stretch, stretch.first)]]]
    second, first_point = _passed(mesh, crossings, shares, stretch, height, 1)
    before_last, last_point = _passed(mesh, crossings, shares, stretch, height, -1)
    k = stretch.first
    while k < stretch.last:
        after = second if k == stretch.first else k + 1
        if after > before_last:
            after = stretch.last
        one, other = _index(stretch, k), _index(stretch, after)
        skips = after > k + 1
        k = after
        if points[one, 0] == points[other, 0] and points[one, 1] == points[other, 1]:
            continue
        out = _with_room(out, written, 2**MAX_HALVINGS)
        if skips:
            before = _index(stretch, after - 1)
            start = _crossing(mesh, crossings, shares, crossed[one], one)
            end = _crossing(mesh, crossings, shares, crossed[before], other)
            start = first_point if one == _index(stretch, stretch.first) else start
            end = last_point if after == stretch.last else end
        else:
            start = _crossing(mesh, crossings, shares, crossed[one], one)
            end = _crossing(mesh, crossings, shares, crossed[one], other)
        written = _follow(mesh.coefficients, surface, height, start, end, tolerance, out, written)
    return out, written


@compiled(INTERNAL)
def _beginning(mesh: MeshArrays, crossings: Crossings, begin: int, length: int) -> tuple[int, bool]:
    """Where to begin a ring: at a change of face, or else on an edge of the B-rep, if there is one.

    Returns the number of the crossing in the ring, and whether the ring is free of both.
    """
    turn, free = 0, True
    for k in range(length):
        face = mesh.faces[crossings.triangles[begin + k]]
        if face != mesh.faces[crossings.triangles[begin + (k - 1) % length]]:
            return k, False
        if free and mesh.edge_curves[crossings.edges[begin + k]] >= 0:
            turn, free = k, False
    return turn, free


@compiled(ENTRY)
def trace(
    mesh: MeshArrays,
    crossings: Crossings,
    shares: ConstFloatArray,
    heights: ConstFloatArray,
    tolerance: float,
) -> CurveRings:
    """Rings of a section to the chord tolerance (mm), with the curves that they lie on.

    `crossings` lie on the true curves of the mesh's edges, at shares (p,) of their ways; the
    rings at heights (r,), mm. A ring without area is left without points.
    """
    points, crossed, starts = crossings.points, crossings.triangles, crossings.starts
    coefficients, surfaces, faces = mesh.coefficients, mesh.surfaces, mesh.faces
    out = np.empty((2 * len(points) + 64, 2))
    written = 0
    new_starts = np.zeros(len(starts), np.int64)
    runs = np.empty((len(points) + 16, 5), np.int64)
    parameters = np.zeros((len(points) + 16, 5))
    made = 0
    for ring in range(len(starts) - 1):
        begin, length = starts[ring], starts[ring + 1] - starts[ring]
        height = heights[ring]
        turn, free = _beginning(mesh, crossings, begin, length)
        base, first_run = written, made
        k = 0
        while k < length:
            here = begin + (turn + k) % length
            face = faces[crossed[here]]
            stop = k + 1
            while stop < length and faces[crossed[begin + (turn + stop) % length]] == face:
                stop += 1
            stretch = _Stretch(begin, length, turn, k, stop, free)
            conic = conic_at(coefficients, surfaces[face], height, points[here, 0], points[here, 1])
            run_start = written
            if conic.kind == STRAIGHT_LINE:
                out, written = _add_line(out, written, points, stretch)
            elif conic.kind == NO_CONIC:
                out, written = _add_level_curve(
                    out, written, mesh, crossings, shares, stretch, height, tolerance
                )
            else:
                out, written = _add_conic(out, written, points, stretch, conic, tolerance)
            if written > run_start:
                runs[made, 0], runs[made, 1], runs[made, 2] = ring, run_start - base, written - base
                runs[made, 3], runs[made, 4] = conic.kind, face
                parameters[made, 0], parameters[made, 1] = conic.x, conic.y
                parameters[made, 2], parameters[made, 3] = conic.major_x, conic.major_y
                parameters[made, 4] = conic.ratio
                made += 1
            k = stop
        if is_thin(out[base:written], SNAP):
            written, made = base, first_run
        new_starts[ring + 1] = written
    return CurveRings(out[:written].copy(), new_starts, runs[:made], parameters[:made])
