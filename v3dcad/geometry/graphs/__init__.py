"""Graphs: minimum spanning trees, and trails along all edges."""
