"""The structure: sites, and the layers that they make of a part's sections.

fill                     sections filled: the layers, and the foam that they are slices of
foam/                    sites in space, their walls and struts
sweep/                   the plane on its way up through the sites
thesis/, loft            the thesis's own method, and its linear interpolation
sites, growth            sites scattered in a plane; which of the thesis's sites grow, and how much
walls, wall_distance     walls and struts as values; how far points lie from walls
overhang, properties     the certificate of overhang; volume, mass and inertia
placement                where the part is placed on the bed, and at which heights it is cut
lazy_layers              layers that are made when they are asked for
checksum                 by what a structure is known
"""
