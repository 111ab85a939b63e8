"""Text and bytes to values and back; opens no port, imports no kernel.

gcode         toolpaths written: gcode_moves makes words of steps, gcode_lines text of words,
              gcode_blocks what stands before and after
gcode_read    what a G-code file does
profile       machine profiles
nc_template   header and footer of an example file (Algorithm 12)
nc_adjust     the thesis's path adjustment (Algorithm 13)
ont  stl  sites_csv   structures, meshes, sites
"""
