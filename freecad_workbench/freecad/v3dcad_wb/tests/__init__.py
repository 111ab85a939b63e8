# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Tests that run inside FreeCAD; `tests/workbench/` of the project starts them."""
