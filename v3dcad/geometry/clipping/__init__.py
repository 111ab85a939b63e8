"""A power diagram clipped by a section's rings, and kept up to date from layer to layer.

ring_validity    whether rings bound a section: none crosses another
ring_walk        rings walked through the diagram: which edges they cross, and where
winding_numbers  how often the rings wind round each vertex of the diagram
interior         the vertices and whole edges that lie inside
update           what has to be clipped again after flips and on new rings
planar_graph     the clipped diagram written as vertices and edges
"""
