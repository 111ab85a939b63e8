"""Power diagrams on integer points, as regular triangulations, and how they change with time.

predicates            orientation and the power test, exact and without ties
grid                  the integer grid over a part's base rectangle
ending                why a compiled loop returned to Python
triangle_mesh         triangles in arrays: points join, edges flip, points become hidden
regular_triangulation all points at once
event_queue           when the power tests of edges fail
kinetic_triangulation the triangulation kept regular while time passes and points enter
"""
