"""Regions whose rings touch in points, each other and themselves, in every way."""

from __future__ import annotations

import numpy as np


def region(random, size, apart=False):
    """The rings of some triangles of a grid from 0 to `size`, the region on their left.

    At corners where the region touches itself, rings go on at random, or so that they keep apart.
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
                if apart and len(ring) > 1:
                    ways.sort(key=lambda way: _turn(*ring[-2:], way))
                ring.append(ways.pop(-1 if apart else random.integers(len(ways))))
                if ring[-1] == first:
                    break
            rings.append(np.array(ring[:-1], np.float64) / 2)
    return rings


def _turn(before, here, after):
    """By which angle a way turns to the left."""
    into, out = (complex(b[0] - a[0], b[1] - a[1]) for a, b in ((before, here), (here, after)))
    return np.angle(out / into)
