"""Files of triangles: STL, binary and ASCII, OBJ, 3MF."""
