# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Voronoi 3D: the FreeCAD workbench of v3dcad.

The workbench is a face. It computes nothing itself: v3dcad runs in its own environment, as a child
process (`backend.py`), and is never imported here. From a window inwards:

- `init.py`, `init_gui.py`: what FreeCAD loads first: file types, toolbar, menu, preferences
- `commands.py`, `forms.py`, `taskpanel.py`, `show_panel.py`, `print_panel.py`: what a user presses
- `features.py`, `properties.py`, `restore.py`, `view_provider.py`, `lines.py`: the object
- `source.py`, `backend.py`, `environment.py`, `printing.py`: the way to v3dcad and to printers
"""
