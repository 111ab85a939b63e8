"""Solids from walls and struts: facets with shared corners, convex cells, bar meshes."""
