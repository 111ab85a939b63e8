"""The way up through the layers, one plane after the other.

growing_sites  sites whose weights grow, in whole numbers and in mm
ring_arrays    the rings of many sections as long arrays
layer_loop     the compiled loop: from rings to diagrams
kinetic_sweep  what surrounds the loop: room, births, epochs, the vertices' paths
one_layer      one power diagram at a time, for layers with a history
"""
