"""The same block as a foam, as columns, and as columns where we want them:
`python foam_and_columns.py`.
"""

from build123d import Box

import v3dcad

block = Box(60, 30, 20)
foam = v3dcad.fill(block, cell_size=10, layer_height=0.4)
foam.write_step("foam.step", "cells")
foam.write_svg("foam.svg", layer=25)

columns = v3dcad.fill(block, cell_size=10, stretch="columns", layer_height=0.4)
columns.write_step("columns.step", "faces")

rows = [(x, y) for x in (-25, -15, -5, 5, 15, 25) for y in (-10, 0, 10)]
regular = v3dcad.fill(block, sites=rows, layer_height=0.4)
regular.write_step("regular_columns.step", "faces")
for name, filled in (("foam", foam), ("columns", columns), ("regular columns", regular)):
    told = filled.report()
    print(f"{name}: {told['cells']} cells, {told['wall_length_mm'] / 1000:.1f} m of walls")
