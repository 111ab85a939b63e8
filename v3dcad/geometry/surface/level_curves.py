"""From crossings to rings: exact conics sampled, other level lines followed by Newton's method."""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstFloatStack,
    ConstIntArray,
    ConstIntRows,
    FloatRows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ALLOCATING, ENTRY, INTERNAL, compiled
from v3dcad.geometry.mesh.section import SNAP, is_thin
from v3dcad.geometry.surface.conics import CIRCLE_ARC, ELLIPSE_ARC, STRAIGHT_LINE, conic_at
from v3dcad.geometry.surface.surfaces import surface_at

CurvePoint = tuple[float, float, float, float]
"""A point of a level line on a surface: x, y, u, v."""

MAX_HALVINGS = 10
"""Of the stretch between two mesh edges."""


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
def _direction(x: float, y: float, a: float, b: float, c: float, d: float, ratio: float) -> float:
    """The angle of a point on an ellipse, in the circle that the ellipse is squeezed from."""
    x, y = x - a, y - b
    return np.arctan2((y * c - x * d) / ratio, x * c + y * d)


@compiled(INTERNAL)
def _crossing(
    triangles: ConstIntRows,
    corners: ConstFloatStack,
    sides: ConstIntRows,
    edge_nodes: ConstIntRows,
    triangle: int,
    points: ConstFloatRows,
    shares: ConstFloatArray,
    edges: ConstIntArray,
    crossing: int,
) -> CurvePoint:
    """A crossing on one of a triangle's sides: x, y, and its parameters on the surface."""
    edge, share = edges[crossing], shares[crossing]
    u, v = corners[triangle, 0, 0], corners[triangle, 0, 1]
    for k in range(3):
        if sides[triangle, k] == edge:
            if triangles[triangle, k] != edge_nodes[edge, 0]:
                share = 1 - share
            after = (k + 1) % 3
            u = (1 - share) * corners[triangle, k, 0] + share * corners[triangle, after, 0]
            v = (1 - share) * corners[triangle, k, 1] + share * corners[triangle, after, 1]
            break
    return points[crossing, 0], points[crossing, 1], u, v


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
        u_along = s[1][0] * chord_x + s[1][1] * chord_y
        v_along = s[2][0] * chord_x + s[2][1] * chord_y
        determinant = s[1][2] * v_along - s[2][2] * u_along
        if determinant == 0.0:
            break
        u -= (rise * v_along - s[2][2] * along) / determinant
        v -= (s[1][2] * along - u_along * rise) / determinant
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


@compiled(ENTRY)
def trace(
    coefficients: ConstFloatArray,
    surfaces: ConstIntArray,
    triangles: ConstIntRows,
    corners: ConstFloatStack,
    faces: ConstIntArray,
    sides: ConstIntRows,
    edge_nodes: ConstIntRows,
    edge_curves: ConstIntArray,
    points: ConstFloatRows,
    shares: ConstFloatArray,
    edges: ConstIntArray,
    crossed: ConstIntArray,
    starts: ConstIntArray,
    heights: ConstFloatArray,
    tolerance: float,
) -> tuple[FloatRows, IntArray, IntRows, FloatRows]:
    """Rings to the chord tolerance, with their runs.

    Returns points (q, 2), where each ring starts (r + 1,), runs as (ring, start, stop, curve,
    face), and their parameters (m, 5).
    """
    out = np.empty((2 * len(points) + 64, 2))
    written = 0
    new_starts = np.zeros(len(starts), np.int64)
    runs = np.empty((len(points) + 16, 5), np.int64)
    numbers = np.zeros((len(points) + 16, 5))
    made = 0
    for ring in range(len(starts) - 1):
        begin, length = starts[ring], starts[ring + 1] - starts[ring]
        height = heights[ring]
        # Begin where the face changes, or else on an edge of the B-rep, if there is one.
        turn, alone = 0, True
        for k in range(length):
            if faces[crossed[begin + k]] != faces[crossed[begin + (k - 1) % length]]:
                turn, alone = k, False
                break
            if alone and edge_curves[edges[begin + k]] >= 0:
                turn, alone = k, False
        base, first_run = written, made
        k = 0
        while k < length:
            here = begin + (turn + k) % length
            face = faces[crossed[here]]
            stop = k + 1
            while stop < length and faces[crossed[begin + (turn + stop) % length]] == face:
                stop += 1
            surface = surfaces[face]
            curve, a, b, c, d, ratio = conic_at(
                coefficients, surface, height, points[here, 0], points[here, 1]
            )
            run_start = written
            if curve == STRAIGHT_LINE:
                last = begin + (turn + stop) % length
                if points[here, 0] != points[last, 0] or points[here, 1] != points[last, 1]:
                    out = _with_room(out, written, 1)
                    out[written, 0], out[written, 1] = points[here, 0], points[here, 1]
                    written += 1
            elif curve in (CIRCLE_ARC, ELLIPSE_ARC):
                angle = before = _direction(points[here, 0], points[here, 1], a, b, c, d, ratio)
                swept = 0.0
                for j in range(k + 1, stop + 1):
                    other = begin + (turn + j) % length
                    after = _direction(points[other, 0], points[other, 1], a, b, c, d, ratio)
                    way = after - before
                    if way > np.pi:  # the next point is less than half a turn away
                        way -= 2 * np.pi
                    elif way <= -np.pi:
                        way += 2 * np.pi
                    swept += way
                    before = after
                major = np.hypot(c, d)
                step = 2 * np.arccos(max(1 - tolerance / major, 0.5)) if major > 0 else np.pi
                pieces = int(np.ceil(abs(swept) / step))
                out = _with_room(out, written, pieces)
                for j in range(pieces):
                    if j == 0 and not alone:
                        out[written, 0], out[written, 1] = points[here, 0], points[here, 1]
                    else:
                        cosine = np.cos(angle + swept * j / pieces)
                        sine = np.sin(angle + swept * j / pieces) * ratio
                        out[written, 0] = a + cosine * c - sine * d
                        out[written, 1] = b + cosine * d + sine * c
                    written += 1
            else:
                for j in range(k, stop):
                    one = begin + (turn + j) % length
                    other = begin + (turn + j + 1) % length
                    if points[one, 0] == points[other, 0] and points[one, 1] == points[other, 1]:
                        continue
                    out = _with_room(out, written, 2**MAX_HALVINGS)
                    mesh = triangles, corners, sides, edge_nodes
                    start = _crossing(*mesh, crossed[one], points, shares, edges, one)
                    end = _crossing(*mesh, crossed[one], points, shares, edges, other)
                    written = _follow(coefficients, surface, height, start, end, tolerance, out, written)
            if written > run_start:
                runs[made, 0] = ring
                runs[made, 1] = run_start - base
                runs[made, 2] = written - base
                runs[made, 3] = curve
                runs[made, 4] = face
                numbers[made, 0], numbers[made, 1], numbers[made, 2] = a, b, c
                numbers[made, 3], numbers[made, 4] = d, ratio
                made += 1
            k = stop
        if is_thin(out[base:written], SNAP):
            written, made = base, first_run
        new_starts[ring + 1] = written
    return out[:written].copy(), new_starts, runs[:made], numbers[:made]
