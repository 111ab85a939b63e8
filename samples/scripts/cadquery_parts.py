"""The same in CadQuery (`pip install 'v3dcad[cadquery]'`): `python cadquery_parts.py`."""

import cadquery as cq

import v3dcad.adapters.cadquery  # noqa: F401 - gives Workplane its voronoiFill

plate = cq.Workplane().box(60, 30, 20).edges("|Z").fillet(4)
light = plate.voronoiFill("solid", thickness=1.2, skin=1.5, cell_size=10, layer_height=0.4)
cells = plate.voronoiFill("cells", cell_size=12, layer_height=0.4)
assembly = (
    cq.Assembly().add(light, name="light").add(cells, name="cells", loc=cq.Location((0, 50, 0)))
)
assembly.export("cadquery_parts.step")
print(cells.size(), "cells,", round(light.val().Volume()), "mm³ of walls")
