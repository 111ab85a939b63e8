"""v3dcad: fill a part with a 3D Voronoi structure that prints without support."""
