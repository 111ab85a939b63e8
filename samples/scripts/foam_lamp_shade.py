"""A lamp shade of struts between two cones: `python foam_lamp_shade.py`."""

from build123d import Cone, Pos

import v3dcad

shade = Pos(0, 0, 40) * (Cone(60, 35, 80) - Cone(54, 29, 80))
structure = v3dcad.fill(shade, cell_size=10, layer_height=0.4, random_seed=3)
structure.write_3mf("lamp_shade_beams.3mf", "beams", diameter=1.6)
structure.write_stl("lamp_shade.stl", "solid", thickness=1.2)
print(len(structure.facets().struts()), "struts")
