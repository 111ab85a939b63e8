"""Compile all that numba compiles, so that no later start has to wait for it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from v3dcad.errors import MissingKernelError
from v3dcad.formats.gcode.reader import read_gcode
from v3dcad.parts import part_from
from v3dcad.pipeline import Structure, fill


def warm_up() -> None:
    """Go every way that is compiled with two little parts; quick where numba's cache has it all.

    The engine is compiled as it is loaded, the rest where it is first called. Raises
    `MissingKernelError` where there is no kernel, with all compiled that can do without.
    """
    for _ in warming_up():
        pass


def warming_up() -> Iterator[str]:
    """The same in steps, each named after it is done, in the order in which people need them.

    First what a preview needs, then a report, then G-code and graded foams.
    """
    hollow = _hollow_tetrahedron()
    structures, missing = [], None
    try:
        from v3dcad.kernel.warm_up_part import trial_part

        structures.append(_filled(trial_part()))
    except MissingKernelError as error:
        missing = error
    structures.append(_filled(hollow))
    yield "layers"
    for structure in structures:
        structure.report()
    yield "report"
    for structure in structures:
        with TemporaryDirectory() as folder:
            gcode = Path(folder) / "a.gcode"
            structure.write_gcode(gcode)
            read_gcode(gcode)
        yield "G-code"
    fill(part_from(hollow, repair=True), cell_size="1 + 0.1 * x", layer_height=2.0)
    yield "graded foam"
    if missing is not None:
        raise missing


def _hollow_tetrahedron() -> tuple[np.ndarray, np.ndarray]:
    """A tetrahedron with a hollow, and with a side missing: vertices (8, 3), mm; triangles."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    sides = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    vertices = np.concatenate([4 * corners, corners + 0.5])
    return vertices, np.concatenate([sides[1:], sides[:, ::-1] + len(corners)])


def _filled(source: object) -> Structure:
    structure = fill(part_from(source, repair=True), cell_size=1.0, layer_height=0.4)
    for layer in structure.layers:
        structure.part.exact(layer)
    return structure
