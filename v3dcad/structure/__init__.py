"""The method: sites, and the layers they make of a part's sections.

fill                     sections filled: the layers, and the structure that they are slices of
sweep/                   the way up through the layers
foam/                    sites in space whose cells print without support
thesis/, loft            the thesis's own method, and its linear interpolation
sites, growth            sites scattered in a rectangle; which of the thesis's grow, by how much
walls, wall_distance     walls and struts in space, and how far points lie from walls
overhang, properties     the certificate of overhang; volume, mass and inertia
placement                where the part stands on the bed, and at which heights it is cut
lazy_layers              layers made when they are asked for
checksum                 by what a structure is known
"""
