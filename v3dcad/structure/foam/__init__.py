"""The foam: sites in space whose Voronoi cells print without support.

    random      random numbers that are the same on every machine
    darts       sites scattered at random, none too near another
    energy      how far walls lean too much, and which way sites must move
    fire        one step downhill
    cluster     the walls that lean too much in one place, solved apart
    relaxing    sites moved until no wall leans too much
    tile        the shipped sites, which repeat without end
    make_tile   the program that made them: `python -m v3dcad.structure.foam.make_tile`
    size_grid   a field of sizes on a grid, no steeper than cells can follow
    graded      sites for cells as large as a field says, certified
    choice      which sites a part is filled with: what the settings say, or those that are given
    uniform     the shipped sites in reach of a part
    explicit    sites that a user gives
    sites       the sites of a structure as whole numbers, and what they weigh on a layer
    space       walls and struts in space, and the steepest wall

Sites live in the stretched space: heights divided by the stretch s, so that the metric is the plain
distance. A wall between two sites leans from the vertical by the angle with tangent s-fold less
than |Δz| / |Δxy|; it prints without support up to θ where |Δz| ≤ τ · |Δxy|, τ = s · tan θ.
"""
