"""The method: sites, their growth, and the layers they make of a part's sections.

fill                     sections filled: the layers, and the structure that they are slices of
sweep/                   the way up through the layers
thesis/, loft            the thesis's own method, and its linear interpolation
sites, density, growth   where sites stand, which of them grow, and by how much
births, holes, rim,      new cells: when, where,
spacing                  and how far from others
walls, wall_distance     walls and struts in space, and how far points lie from walls
overhang, properties     the certificate of overhang; volume, mass and inertia
placement                where the part stands on the bed, and at which heights it is cut
lazy_layers, memory      layers made when they are asked for, in memory that is used again
checksum                 by what a structure is known
"""
