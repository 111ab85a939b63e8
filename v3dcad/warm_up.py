"""What numba compiles: module by module, in the order of need, so that processes can share it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module

SURFACES = (
    "v3dcad.geometry.mesh.section",
    "v3dcad.geometry.surface.splines",
    "v3dcad.geometry.surface.curves",
    "v3dcad.geometry.surface.surfaces",
    "v3dcad.geometry.surface.conics",
    "v3dcad.geometry.surface.mesh",
    "v3dcad.geometry.surface.critical_points",
    "v3dcad.geometry.surface.refinement",
    "v3dcad.geometry.surface.section",
    "v3dcad.geometry.surface.level_curves",
)
"""What sections take;"""

CELLS = (
    *SURFACES,
    "v3dcad.structure.foam.random",
    "v3dcad.structure.foam.tile",
    "v3dcad.geometry.power_diagram.event_queue",
    "v3dcad.geometry.power_diagram.grid",
    "v3dcad.geometry.power_diagram.predicates",
    "v3dcad.geometry.power_diagram.triangle_mesh",
    "v3dcad.geometry.power_diagram.regular_triangulation",
    "v3dcad.geometry.power_diagram.kinetic_triangulation",
    "v3dcad.geometry.clipping.interior",
    "v3dcad.geometry.clipping.ring_walk",
    "v3dcad.geometry.clipping.winding_numbers",
    "v3dcad.geometry.clipping.update",
    "v3dcad.geometry.clipping.planar_graph",
    "v3dcad.geometry.clipping.ring_validity",
    "v3dcad.structure.sweep.layer_loop",
)
"""with the cells in them;"""

PRINT = (
    *CELLS,
    "v3dcad.toolpath.euler",
    "v3dcad.geometry.loops.loops",
    "v3dcad.geometry.loops.segments",
    "v3dcad.geometry.loops.facing",
    "v3dcad.geometry.loops.power_cells",
    "v3dcad.geometry.loops.convex_cells",
    "v3dcad.geometry.loops.region",
    "v3dcad.geometry.loops.strips",
    "v3dcad.geometry.loops.ribs",
    "v3dcad.geometry.loops.curves",
    "v3dcad.geometry.loops.wall_ends",
    "v3dcad.geometry.loops.links",
    "v3dcad.geometry.loops.union_find",
    "v3dcad.geometry.loops.joining",
    "v3dcad.geometry.loops.corners",
    "v3dcad.geometry.loops.own_room",
    "v3dcad.geometry.loops.coverage",
    "v3dcad.geometry.print_time",
    "v3dcad.formats.gcode.lines",
    "v3dcad.geometry.loops.reach",
    "v3dcad.toolpath.spans",
    "v3dcad.toolpath.bridged_walls",
    "v3dcad.geometry.voronoi.bins",
    "v3dcad.geometry.voronoi.reach",
    "v3dcad.geometry.voronoi.steepest",
    "v3dcad.geometry.voronoi.cutting",
    "v3dcad.structure.wall_distance",
)
"""with G-code and a report;"""

ALL = (
    *PRINT,
    "v3dcad.geometry.surface.gaps",
    "v3dcad.geometry.surface.wall_ends",
    "v3dcad.geometry.mesh.bodies",
    "v3dcad.geometry.mesh.holes",
    "v3dcad.geometry.mesh.distance",
    "v3dcad.geometry.voronoi.neighbours",
    "v3dcad.geometry.voronoi.wall",
    "v3dcad.geometry.voronoi.walls",
    "v3dcad.structure.foam.size_grid",
    "v3dcad.structure.foam.darts",
    "v3dcad.structure.foam.energy",
    "v3dcad.structure.foam.fire",
    "v3dcad.structure.foam.cluster",
)
"""and with what only some parts and settings need: all modules with compiled functions."""

FIRST_BYTE = ord("0")
"""That stands for the first of some modules: none of them gets a control character."""


def warm_up(modules: Sequence[str] = ALL) -> None:
    """Compile all functions of modules that Python calls; quick where numba's cache has them."""
    from v3dcad.geometry.compiled.options import called_by_python, compile_now

    for name in modules:
        for function in vars(import_module(name)).values():
            if called_by_python(function):
                compile_now(function)


def share(modules: Sequence[str]) -> int:
    """A pipe that holds a byte for each of some modules, the last first; its end to read from."""
    taken, given = os.pipe()
    os.write(given, bytes(FIRST_BYTE + number for number in reversed(range(len(modules)))))
    os.close(given)
    return taken


def warm_up_shared(modules: Sequence[str]) -> None:
    """Compile what is left of some modules in a pipe on stdin, from which others take as well.

    Ends when the process that started this one has.
    """
    parent = os.getppid()
    while os.getppid() == parent and (byte := os.read(0, 1)):
        warm_up([modules[byte[0] - FIRST_BYTE]])
