"""Text and bytes to values and back; opens no port, imports no kernel.

gcode      toolpaths and machine profiles
mesh       triangles: STL, OBJ, 3MF
ont        recipes of structures
svg        layers and sections as drawings
sites_csv  sites
numbers    numbers as text
"""
