"""Walls that end on curved faces end on the very surface, and stay on their lines."""

from __future__ import annotations

import numpy as np
import pytest
from occt import is_valid
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_VERTEX
from OCP.TopoDS import TopoDS

import v3dcad
from tests.kernel import shapes
from v3dcad.geometry.surface.wall_ends import MAX_END_SHIFT
from v3dcad.kernel.shapes import FACE, compound, subshapes
from v3dcad.kernel.wires import layer_wires
from v3dcad.model import Diagram, Placement

SHAPES = {
    "tilted torus": lambda: shapes.torus(20, 7, along=(0.3, 0.2, 1)),
    "loft": shapes.loft,
}


def slant(diagram: Diagram, vertex: int) -> float:
    """The sine of the angle between the wall that ends at a vertex and the contour there."""
    ends, inner = diagram.vertices[diagram.edges], diagram.inner()
    beside = (diagram.edges == vertex).any(axis=1)
    wall, contour = (np.diff(ends[beside & some], axis=1)[0, 0] for some in (inner, ~inner))
    turn = wall[0] * contour[1] - wall[1] * contour[0]
    return float(abs(turn) / np.hypot(*wall) / np.hypot(*contour))


@pytest.mark.parametrize("name", SHAPES)
def test_walls_end_on_the_true_surface(name: str):
    structure = v3dcad.fill(SHAPES[name](), layer_height=2.3, cell_size=10, chord_tolerance=0.02)
    skin = compound(subshapes(structure.part.shape, FACE))
    off_before, ends, stayed = 0.0, 0, 0
    for layer in list(structure.layers)[1:]:
        exact = structure.part.exact(layer)
        old, new = layer.diagram.vertices, exact.diagram.vertices
        inner = layer.diagram.edges[layer.diagram.inner()]
        shift = np.hypot(*(new - old).T)
        moved = np.flatnonzero(shift > 0)
        assert np.all(shift < 0.1)
        outline = layer.diagram.edges[~layer.diagram.inner()]
        for k in np.intersect1d(inner, outline):
            off = away(new[k], layer.z, skin)
            off_before = max(off_before, away(old[k], layer.z, skin))
            ends += 1
            if off > 1e-9:  # its wall runs along the surface: it would have to go too far
                assert shift[k] == 0
                assert off > MAX_END_SHIFT / 2 * slant(layer.diagram, k)
                stayed += 1
        # Along the wall: what moved lies on the line of the wall that ends there.
        for a, b in inner.tolist():
            for end, other in ((a, b), (b, a)):
                if shift[end] > 0 and np.hypot(*(old[end] - old[other])) > 1e-3:
                    way = (old[end] - old[other]) / np.hypot(*(old[end] - old[other]))
                    step = new[end] - old[end]
                    assert abs(way[0] * step[1] - way[1] * step[0]) < 1e-9
        # Ends are points of the rings, whose runs cover them as before.
        corners = {tuple(point) for ring in exact.section.rings for point in ring.tolist()}
        assert all(tuple(new[k].tolist()) in corners for k in moved)
        covered = sum(run.stop - run.start for run in exact.section.runs)
        assert covered == sum(map(len, exact.section.rings))
        # And so do the wires.
        wires = layer_wires(exact, Placement.none())
        assert is_valid(wires)
        made = [BRep_Tool.Pnt_s(TopoDS.Vertex_s(v)) for v in subshapes(wires, TopAbs_VERTEX)]
        places = np.array([(p.X(), p.Y()) for p in made])
        for k in moved:
            assert np.hypot(*(places - new[k]).T).min() < 2e-7
    assert ends > 100
    assert stayed < 0.03 * ends
    assert off_before > 1e-4


def away(point, z: float, skin) -> float:
    vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point.tolist(), z)).Vertex()
    return BRepExtrema_DistShapeShape(vertex, skin).Value()


def test_layers_on_exact_curves_stay_as_they_are(samples):
    structure = v3dcad.fill(samples / "cone.step", layer_height=10)
    for layer in structure.layers:
        assert structure.part.exact(layer) is layer
