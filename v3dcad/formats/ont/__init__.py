"""`.ont` files: the recipe that makes a structure again.

document    the file as sections of keys and rows
sections    each section to values and back
settings    settings by their names
armor       bytes as lines of text
mesh_codec  triangles in few bytes
"""
