"""A lamp shade that opens upward, by a function of the place: `python graded_lamp.py`."""

import numpy as np
from build123d import Cone, Pos

import v3dcad


def size(x, y, z):
    """7 mm at the base, 13 mm at the top, with a finer ring that winds around once."""
    turn = np.arctan2(y, x) / (2 * np.pi) + 0.5
    away = np.abs(z - 60 * turn)
    return np.minimum(7 + z / 10, 5 + away / 4)


shade = Pos(0, 0, 30) * (Cone(45, 28, 60) - Cone(38, 21, 60))
structure = v3dcad.fill(shade, cell_size=size, layer_height=0.4)
structure.write_3mf("graded_lamp.3mf", "beams", diameter=1.4)
print(len(structure.facets().struts()), "struts")
