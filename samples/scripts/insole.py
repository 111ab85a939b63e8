"""An insole that is firm where a foot presses: `python insole.py`.

The map of pressure is a picture, here drawn by a formula: heel, ball and big toe are white. Any
picture does, such as that of a measuring plate.
"""

import numpy as np
from build123d import Plane, Spline, extrude, make_face
from PIL import Image

import v3dcad

LENGTH, WIDTH = 120.0, 44.0
outline = [(0, -12), (30, -16), (70, -19), (100, -20), (118, -8), (116, 10), (95, 20), (60, 13)]
insole = extrude(Plane.XY * make_face(Spline([*outline, (25, 14), (0, 10)], periodic=True)), 8)

x, y = np.meshgrid(np.linspace(0, LENGTH, 240), np.linspace(WIDTH / 2, -WIDTH / 2, 88))
pressure = sum(
    strength * np.exp(-((x - at) ** 2 + (y - side) ** 2) / reach**2)
    for at, side, reach, strength in ((18, -1, 16, 1.0), (86, 2, 20, 0.9), (108, 4, 8, 0.8))
)
Image.fromarray((255 * np.clip(pressure, 0, 1)).astype(np.uint8)).save("pressure.png")

size = "ramp(image('pressure.png'), 0, 1, 9, 4)"  # mm: 9 where black, 4 where white
structure = v3dcad.fill(insole, cell_size=size, layer_height=0.5)
structure.write_ont("insole.ont")
structure.write_svg("insole.svg", layer=8)
structure.write_3mf("insole.3mf", "beams", diameter=1.2)
low, high = structure.graded.made
print(f"cells of {low:.1f} to {high:.1f} mm")
