"""Regions whose rings touch in points, each other and themselves, in every way."""

from __future__ import annotations

import numpy as np


def region(random, size):
    """The rings of some triangles of a grid from 0 to `size`, the region on their left.

    At corners where the region touches itself, rings go on at random.
    """
    filled = random.random((size, size, 4)) < random.uniform(0.2, 0.9)
    filled[random.integers(size), random.integers(size)] = True
    # Each square is four triangles about its middle; in steps of half a square.
    sides = set()
    around = [(0, 0), (2, 0), (2, 2), (0, 2)]
    for column, row, quarter in np.argwhere(filled).tolist():
        corners = [around[quarter], around[(quarter + 1) % 4], (1, 1)]
        corners = [(2 * column + x, 2 * row + y) for x, y in corners]
        for k in range(3):
            side = corners[k], corners[(k + 1) % 3]
            if side[::-1] in sides:
                sides.remove(side[::-1])
            else:
                sides.add(side)
    onward = {}
    for begin, end in sorted(sides):
        onward.setdefault(begin, []).append(end)
    rings = []
    for first in sorted(onward):
        while onward[first]:
            ring = [first]
            while True:
                ways = onward[ring[-1]]
                ring.append(ways.pop(random.integers(len(ways))))
                if ring[-1] == first:
                    break
            rings.append(np.array(ring[:-1], np.float64) / 2)
    return rings
