"""Exact horizontal sections of B-rep solids."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor

from OCP.TopoDS import TopoDS_Shape

from v3dcad.geometry.surface.mesh import SurfaceMesh
from v3dcad.geometry.surface.section import CHORD_TOLERANCE, section_surface
from v3dcad.kernel.mesh import surface_mesh
from v3dcad.model import Floats, Section


def section_solids(
    part: TopoDS_Shape | SurfaceMesh,
    heights: Floats,
    chord_tolerance: float = CHORD_TOLERANCE,
    executor: Executor | None = None,
) -> Iterator[Section]:
    """Sections of a shape's solids at ascending heights (k,), mm, as they are computed.

    A shape that is sectioned more than once is better prepared once, by `surface_mesh`. With an
    executor (threads, processes, or a cluster's), several planes are computed at a time, with the
    same results; a prepared part consists of numbers only, so that it can be sent to a process.
    Raises as `surface_mesh` and `section_surface` do.
    """
    mesh = part if isinstance(part, SurfaceMesh) else surface_mesh(part)
    return section_surface(mesh, heights, chord_tolerance, executor)
