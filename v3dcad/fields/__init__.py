"""Cell sizes that differ from place to place: functions of x, y, z in the source's coordinates.

expression  a text such as "min(8, 2 + 0.3 * faces(4))" as a field
sources     what an expression can name: distances, tables, images, stresses
distance    how far places are from the part's surface, or from some of its faces
table       values at points, from a CSV or VTK file
image       the grey of an image
stress      the von Mises stress in a result of a finite-element analysis
scattered   values at points, interpolated
"""
