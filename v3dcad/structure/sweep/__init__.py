"""The way up through the layers, one plane after the other.

sites          sites as whole numbers, and when each may have a cell
ring_arrays    the rings of many sections as long arrays
layer_loop     the compiled loop: from rings to diagrams
kinetic_sweep  what surrounds the loop: room, and blocks of time
one_layer      one power diagram at a time, for layers with a history
"""
