"""The same in CadQuery (`pip install 'v3dcad[cadquery]'`): `python cadquery_parts.py`."""

import cadquery as cq

import v3dcad.adapters.cadquery  # noqa: F401 - gives Workplane its voronoiFill
from v3dcad import density

plate = cq.Workplane().box(60, 30, 20).edges("|Z").fillet(4)
light = plate.voronoiFill("solid", thickness=1.2, skin=1.5, sites=16, layer_height=0.4, offset=0.1)
cells = plate.voronoiFill(
    "cells", sites=density(lambda x, y: 0.02 + 0.0005 * x), layer_height=0.4, offset=0.05
)
assembly = (
    cq.Assembly().add(light, name="light").add(cells, name="cells", loc=cq.Location((0, 50, 0)))
)
assembly.export("cadquery_parts.step")
print(cells.size(), "cells,", round(light.val().Volume()), "mm³ of walls")
