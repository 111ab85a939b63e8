"""Numbers in, numbers out: geometry on numpy arrays; knows no layer, part or file.

compiled                  the one door to numba
power_diagram, clipping   power diagrams of points, and what lies inside a section's rings
voronoi                   the walls of sites in space
graphs                    spanning trees, trails
loops                     loops inside cells, joined to one closed curve
surface, mesh             sections of true surfaces and of triangles
solid                     facets, convex cells, bars
arcs, section_area, print_time
                          arcs in polylines, sections as shapely areas, how long moves take
"""

from pathlib import Path

from v3dcad.geometry.compiled.cache import settle_caches
from v3dcad.geometry.compiled.speed import hasten_compiling

hasten_compiling("v3dcad")
settle_caches(Path(__file__).parents[1])
