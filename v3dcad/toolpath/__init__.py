"""From a layer's diagram to the nozzle's way: graph, route, beads."""
