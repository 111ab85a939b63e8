"""Compile all that numba compiles, so that no later start has to wait for it."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from v3dcad.formats.gcode.reader import read_gcode
from v3dcad.parts import part_from
from v3dcad.pipeline import fill


def warm_up() -> None:
    """Go every way that is compiled with two little parts; quick where numba's cache has it all.

    The engine is compiled as it is loaded, the rest where it is first called. Raises
    `MissingKernelError` where there is no kernel, with all compiled that can do without.
    """
    # A tetrahedron with a hollow, and with a side missing.
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    sides = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    vertices = np.concatenate([4 * corners, corners + 0.5])
    hollow = vertices, np.concatenate([sides[1:], sides[:, ::-1] + len(corners)])
    _make(hollow)
    fill(part_from(hollow, repair=True), cell_size="1 + 0.1 * x", layer_height=2.0)
    from v3dcad.kernel.warm_up_part import trial_part

    _make(trial_part())


def _make(source: object) -> None:
    structure = fill(part_from(source, repair=True), cell_size=1.0, layer_height=0.4)
    structure.report()
    with TemporaryDirectory() as folder:
        gcode = Path(folder) / "a.gcode"
        structure.write_gcode(gcode)
        read_gcode(gcode)
    for layer in structure.layers:
        structure.part.exact(layer)
