"""Graphs: minimum spanning trees, from scratch and kept up to date, and trails along all edges."""
