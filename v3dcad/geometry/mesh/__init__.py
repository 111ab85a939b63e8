"""Triangle meshes: sections by planes, checks, separate bodies, holes, booleans."""
