"""Compiled code frees all arrays that it makes, although most of it counts no references."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.slow

COUNT = """
import gc
from numba.core.runtime import _nrt_python, rtsys

_nrt_python.memsys_enable_stats()
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopoDS import TopoDS

from v3dcad.formats.gcode.reader import read_gcode
from v3dcad.geometry.surface.gaps import MIN_GAP
from v3dcad.kernel.shapes import EDGE, compound, subshapes
from v3dcad.parts import part_from
from v3dcad.pipeline import fill


def make(source):
    structure = fill(part_from(source, repair=True), cell_size=1.0, layer_height=0.4)
    structure.report()
    with TemporaryDirectory() as folder:
        gcode = Path(folder) / "a.gcode"
        structure.write_gcode(gcode)
        read_gcode(gcode)
    for layer in structure.layers:
        structure.part.exact(layer)


# A tetrahedron with a hollow, and with a side missing.
corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
sides = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
vertices = np.concatenate([4 * corners, corners + 0.5])
hollow = vertices, np.concatenate([sides[1:], sides[:, ::-1] + len(corners)])
make(hollow)
fill(part_from(hollow, repair=True), cell_size="1 + 0.1 * x", layer_height=2.0)
# An upright ring with gaps at its edges; and a ball, which has poles.
ring = BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), 3, 1).Shape()
for edge in subshapes(ring, EDGE):
    BRep_Builder().UpdateEdge(TopoDS.Edge_s(edge), 2 * MIN_GAP)
make(compound([ring, BRepPrimAPI_MakeSphere(gp_Pnt(6, 0, 0), 2).Shape()]))
gc.collect()
count = rtsys.get_allocation_stats()
print(count.alloc, count.free, count.mi_alloc, count.mi_free)
"""


def test_what_is_allocated_is_freed() -> None:
    """In nearly all that is compiled: a reference too many keeps an array, one too few crashes."""
    found = subprocess.run(
        [sys.executable, "-c", COUNT], capture_output=True, text=True, check=True
    )
    allocated, freed, arrays, arrays_freed = map(int, found.stdout.split())
    assert allocated > 1000
    assert (freed, arrays_freed) == (allocated, arrays)
