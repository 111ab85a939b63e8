"""A small part with every case that sectioning distinguishes."""

from __future__ import annotations

from OCP.BRep import BRep_Builder
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopoDS import TopoDS, TopoDS_Compound

from v3dcad.geometry.surface.gaps import MIN_GAP
from v3dcad.kernel.shapes import EDGE, compound, subshapes


def trial_part() -> TopoDS_Compound:
    """An upright ring with gaps at its edges, none of whose sections is made of arcs; and a ball,
    which has poles.
    """
    upright = gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0))
    ring = BRepPrimAPI_MakeTorus(upright, 3, 1).Shape()
    for edge in subshapes(ring, EDGE):
        BRep_Builder().UpdateEdge(TopoDS.Edge_s(edge), 2 * MIN_GAP)
    return compound([ring, BRepPrimAPI_MakeSphere(gp_Pnt(6, 0, 0), 2).Shape()])
