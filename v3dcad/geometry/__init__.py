"""Numbers in, numbers out: plane geometry on numpy arrays; knows no layer, part or file.

exact → triangulation → kinetics → clip → tree: the power-diagram engine, compiled by numba, on the
integer points of grid; cells: a diagram's rings on demand; polygon: do rings cross?
"""
