"""A block with small cells on the left and large ones on the right: `python graded_block.py`."""

from build123d import Box

import v3dcad
from v3dcad import density

block = Box(60, 30, 20)
graded = v3dcad.fill(
    block, sites=density(lambda x, y: 0.08 if x < -10 else 0.01), layer_height=0.4, offset=0.05
)
graded.write_step("graded_block.step", "cells")
graded.write_svg("graded_block.svg", layer=0)

rows = [(x, y) for x in (-25, -15, -5, 5, 15, 25) for y in (-10, 0, 10)]
regular = v3dcad.fill(block, sites=rows, layer_height=0.4, offset=0.05)
regular.write_step("regular_block.step", "faces")
print(len(graded.sites), "graded and", len(regular.sites), "regular sites")
