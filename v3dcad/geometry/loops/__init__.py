"""Closed lines half a bead inside cells, and how they are joined to one.

loops        closed lines in one array; points that are too near to others left out
power_cells  the convex cells of weighted sites, drawn in
segments     segments in a grid of squares: which are near each other
convex_cells how segments and places lie to a convex cell
region       convex cells cut by an area's contours
strips       strips along parallel lines, and how loops pass them
ribs         how far walls grow into the cells beside them; loops round them
facing       where two loops face each other
reach        which stretches of segments lie far from all others
own_room     how far from a place of a bead its own room goes
coverage     what room each bead has to itself
links        which walls have links, and where, from layer to layer
wall_ends    what a link at either end of a wall costs in changes of direction
joining      which loops are linked, and where: a spanning forest of those that face each other
curves       loops cut at links and joined crosswise
corners      corners cut off, at links and of cells
"""
