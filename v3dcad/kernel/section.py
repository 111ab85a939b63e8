"""Exact horizontal sections of B-rep solids."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor

import numpy as np
from OCP.TopoDS import TopoDS_Shape

from v3dcad.geometry.surface_mesh import SurfaceMesh
from v3dcad.geometry.surface_section import CHORD_TOLERANCE, section_surface
from v3dcad.kernel.mesh import surface_mesh
from v3dcad.model import Floats, Section

SHARE = 16
"""Planes given to an executor at a time."""


def section_solids(
    part: TopoDS_Shape | SurfaceMesh,
    heights: Floats,
    chord_tolerance: float = CHORD_TOLERANCE,
    executor: Executor | None = None,
) -> Iterator[Section]:
    """Sections of a shape's solids at ascending heights (k,), mm, as they are computed.

    A shape that is sectioned more than once is better prepared once, by `surface_mesh`. With an
    executor (threads, processes, or a cluster's), several planes are computed at a time; a
    prepared part is all numbers and travels by itself. Results are the same without. Raises as
    `surface_mesh` and `section_surface` do.
    """
    mesh = part if isinstance(part, SurfaceMesh) else surface_mesh(part)
    if executor is None:
        yield from section_surface(mesh, heights, chord_tolerance)
        return
    shares = np.split(heights, np.arange(SHARE, len(heights), SHARE))
    waiting = [executor.submit(_sections, mesh, share, chord_tolerance) for share in shares]
    for share in waiting:
        yield from share.result()


def _sections(mesh: SurfaceMesh, heights: Floats, chord_tolerance: float) -> list[Section]:
    return list(section_surface(mesh, heights, chord_tolerance))
