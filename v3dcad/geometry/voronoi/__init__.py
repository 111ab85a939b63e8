"""The Voronoi diagram of sites in space, on arrays: numbers in, numbers out.

    bins        sites in a grid of boxes, periodic or not: who is near
    neighbours  the nearest sites of each
    wall        the wall between two sites: their bisector plane cut by other bisectors
    reach       how far the cells around a place reach: which pairs can share a wall at all
    steepest    the steepest wall of a set of sites, decided with whole numbers
    walls       all walls in a box, each as a polygon
    cutting     the walls of whole cells
    cells       the cells as polyhedra: walls, struts and joints in common
    measures    volumes, centroids, extents and sections of cells
    periodic    sites of a periodic box, with their copies around it

Everything is in one space with the plain distance. A foam's sites live in the stretched space,
where heights are divided by the stretch. Sites are (n, 3) arrays of floats that hold exact values:
whole numbers of grid steps up to 2⁵², or any length.
"""
