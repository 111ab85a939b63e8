"""From a layer's diagram to the nozzle's way.

graph       what is extruded, as a graph: edges once, junctions by id
perimeters  a section's area, its insets, its arcs
trim        cell edges cut off at the innermost perimeter
route       one bead a wall: closed strokes (euler); tree_route: the thesis's order
stroke      what is extruded without a stop
cell_loops, joined_route  two beads a wall: every cell a loop, and one closed stroke a region
first_layer what lies on the bed: brim, and whether a part stands safely
skins       where a layer is solid
division    what of a section is foam, skins, bridges, and what is over foam
bands       what that takes of the bands between lines of ribs
ribs        walls that grow into cells, to hold up what is over foam
bridging    which way skins over air and over cells are laid
solid       areas covered with parallel beads
seam        where outermost perimeters begin
plan        which strokes a layer has, in which order
travel      ways inside the part
cooling     short layers printed slower
bead        the cross-section of a bead
bridged_walls  walls that hang, laid as bridges
beads       strokes laid as beads, with travels between them
trace       `trace`: layers to toolpaths
overlapped  the next layer planned while the last one is measured
plastic     how much plastic layers take, from some of them
overhang    what of the beads has nothing under it, layer by layer
certificate the same for a whole print, as arrays and in words
report      what a layer's printing comes to
"""
