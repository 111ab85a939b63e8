"""The plane on its way up through the sites: sections to diagrams.

sites          sites as the engine takes them: whole numbers, and when each may have a cell
ring_arrays    the rings of many sections as long arrays
layer_loop     the compiled loop: from rings to diagrams
kinetic_sweep  what surrounds the loop: blocks of heights, room, faults
one_layer      one power diagram at a time, for layers with a history
"""
