"""Run by FreeCAD's own Python: reads a STEP file and says what is in it.

The file's path is in STEP_FILE, that of the JSON to write in REPORT_FILE: FreeCAD would open
arguments by itself.
"""

import json
import os

import FreeCAD
import Import

document = FreeCAD.newDocument("read")
# With links FreeCAD 0.20 crashes on more than one shape where it has no window.
Import.insert(os.environ["STEP_FILE"], document.Name, useLinkGroup=False)
found = []
for item in document.Objects:
    shape = item.Shape
    box = shape.optimalBoundingBox(False)
    found.append(
        {
            "label": item.Label,
            "type": shape.ShapeType,
            "valid": shape.isValid(),
            "edges": len(shape.Edges),
            "length": sum(edge.Length for edge in shape.Edges),
            "solids": len(shape.Solids),
            "volume": sum(solid.Volume for solid in shape.Solids),
            "area": shape.Area,
            "low": [box.XMin, box.YMin, box.ZMin],
            "high": [box.XMax, box.YMax, box.ZMax],
        }
    )
with open(os.environ["REPORT_FILE"], "w", encoding="utf-8") as report:
    json.dump({"version": FreeCAD.Version()[:3], "objects": found}, report)
