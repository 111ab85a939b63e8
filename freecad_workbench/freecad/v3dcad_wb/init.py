# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""What FreeCAD loads at its start, with and without a window: file types, and mending of fills."""

import FreeCAD
from freecad.v3dcad_wb import restore

EXCHANGE = "freecad.v3dcad_wb.exchange"

FreeCAD.addImportType("Voronoi foam (*.ont)", EXCHANGE)
FreeCAD.addExportType("Voronoi foam (*.ont)", EXCHANGE)
FreeCAD.addExportType("Voronoi foam as G-code (*.gcode)", EXCHANGE)
FreeCAD.addExportType("Voronoi foam as 3MF (*.3mf)", EXCHANGE)
restore.watch()
