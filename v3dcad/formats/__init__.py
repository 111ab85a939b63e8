"""Text and bytes to values and back; opens no port, imports no kernel.

gcode      G-code: written and read, machine profiles, templates
mesh       STL, OBJ and 3MF
ont        `.ont` files
content    what a file holds whose ending says something else
numbers    numbers as text, to the last bit
sites_csv  sites as rows of x,y,z or x,y
curve_step curves as STEP, written as text
"""
