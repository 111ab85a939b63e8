"""Numbers in, numbers out: plane geometry on numpy arrays; knows no layer, part or file.

exact → flips → triangulation → kinetics → cut → tree: the power-diagram engine, compiled by numba,
on the integer points of grid; polygon: do rings cross?
"""

from pathlib import Path

from v3dcad.geometry.compiled.cache import forget_stale
from v3dcad.geometry.compiled.speed import hasten_compiling

hasten_compiling("v3dcad")
forget_stale(Path(__file__).parents[1])
