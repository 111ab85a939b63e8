"""Make the sample parts beside this script with build123d: `python samples/parts.py`.

A cone and a truncated pyramid as in the thesis, a bracket with fillets and holes, a part of two
islands, a wedge with a gap at its sharp edge, and the pyramid again as STL.
"""

import math
import os
from pathlib import Path

os.environ.setdefault("SOURCE_DATE_EPOCH", "0")

from build123d import (
    Axis,
    Box,
    Compound,
    Cone,
    Cylinder,
    Part,
    Plane,
    Polyline,
    Pos,
    Rectangle,
    Rot,
    Spline,
    export_step,
    export_stl,
    extrude,
    fillet,
    make_face,
)
from OCP.BRep import BRep_Builder, BRep_Tool

HERE = Path(__file__).parent


def cone() -> Part:
    """The thesis's cone: diameters 40 and 30 mm, 30 mm high."""
    return Cone(20, 15, 30)


def pyramid() -> Part:
    """The thesis's truncated pyramid: 67 × 67 mm, 50 mm high, 10° draft."""
    return extrude(Plane.XY * Rectangle(67, 67), 50, taper=10)


def bracket() -> Part:
    """An angle bracket with a rounded inner corner, round edges and four screw holes."""
    foot = Pos(0, 0, 4) * Box(60, 40, 8)
    wall = Pos(-26, 0, 24) * Box(8, 40, 48)
    body = foot + wall
    inner = body.edges().filter_by(Axis.Y).sort_by_distance((-22, 0, 8))[0]
    body = fillet(inner, 10)
    upright = body.edges().filter_by(Axis.Z)
    body = fillet([edge for edge in upright if edge.center().X > 25], 8)
    for y in (-11, 11):
        body -= Pos(16, y, 4) * Cylinder(3.2, 8)
        body -= Pos(-26, y, 38) * Rot(0, 90, 0) * Cylinder(3.2, 8)
    return body


def islands() -> Compound:
    """A column and a block with a shaft, apart from each other: two solids."""
    column = Pos(-18, 0, 10) * Cylinder(10, 20)
    block = Pos(16, 0, 10) * Box(24, 24, 20) - Pos(16, 0, 10) * Cylinder(6, 20)
    return Compound(children=[column, block])


def wedge() -> Part:
    """A wedge of 42° whose sharp edge bends off both faces, by 0.1 mm at half its height.

    A section's ring then crosses itself, in a loop of up to 7.2 times the gap of 0.036 mm.
    """
    half = math.radians(21)
    tip = Polyline((0, 0), (20, -20 * math.tan(half)), (20, 20 * math.tan(half)), close=True)
    body = extrude(Plane.XY * make_face(tip), 10)
    (edge,) = (edge for edge in body.edges().filter_by(Axis.Z) if abs(edge.center().X) < 1e-6)
    first = edge.start_point()
    bent = Spline(first, (-0.1, 0, 5), edge.end_point())
    curve = BRep_Tool.Curve_s(bent.wrapped, 0.0, 1.0)
    builder = BRep_Builder()
    builder.UpdateEdge(edge.wrapped, curve, 0.04)
    builder.Range(edge.wrapped, curve.FirstParameter(), curve.LastParameter())
    return body


if __name__ == "__main__":
    for make in (cone, pyramid, bracket, islands, wedge):
        export_step(make(), HERE / f"{make.__name__}.step")
    export_stl(pyramid(), HERE / "pyramid.stl", tolerance=0.01, ascii_format=True)
