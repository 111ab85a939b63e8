"""Rings of line segments: is any area wound otherwise than a section's material is?

Rings bound a section where they wind once around all that they wind around at all. A sweep
decides that, over horizontal slabs from the height of one corner to that of the next. In a slab
every segment goes from the bottom to the top, so that their order and the winding numbers between
them tell all: no way of crossing, touching or lying on each other is a case of its own.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstFloatRows, ConstIntArray, FloatRows, IntArray
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled

THIN = 1e-10
"""An area thinner than this, relative to the extent of its layer's rings, comes of rounding."""

LOW, HIGH, FOOT, HEAD, GAIN, BELOW, ABOVE = range(7)
"""Columns of a segment: the heights of its ends and their x, what the winding number gains from
its left to its right, and its x at the bottom and at the top of a slab."""


@linked(INTERNAL)
def _fault_in(
    corners: ConstFloatRows,
    starts: ConstIntArray,
    rings_from: int,
    rings_to: int,
    segments: FloatRows,
    order: IntArray,
) -> tuple[int, float, float]:
    """Where one layer's rings wind neither 0 times nor once: the layer's first corner, x, y; or −1
    and no place. There must be room for its `segments` (k, 7) and their `order` (k,).
    """
    first = starts[rings_from]
    count = starts[rings_to] - first
    left = low = np.inf
    right = high = -np.inf
    for ring in range(rings_from, rings_to):
        before = starts[ring + 1] - 1
        for corner in range(starts[ring], starts[ring + 1]):
            foot, head, gain = before, corner, -1.0
            if corners[before, 1] > corners[corner, 1]:
                foot, head, gain = corner, before, 1.0
            segment, order[corner - first] = segments[corner - first], corner - first
            segment[LOW], segment[FOOT] = corners[foot, 1], corners[foot, 0]
            segment[HIGH], segment[HEAD] = corners[head, 1], corners[head, 0]
            segment[GAIN] = gain
            left, right = min(left, segment[FOOT]), max(right, segment[FOOT])
            low, high = min(low, segment[LOW]), max(high, segment[HIGH])
            before = corner
    thin = THIN * max(right - left, high - low)
    gap = count // 2
    while gap > 0:  # Shell's sort, by the lower ends
        for place in range(gap, count):
            moved = order[place]
            while place >= gap and segments[order[place - gap], LOW] > segments[moved, LOW]:
                order[place] = order[place - gap]
                place -= gap
            order[place] = moved
        gap = 1 if gap == 2 else gap * 5 // 11
    # Those across the slab are order[:active], left to right; those above it order[waiting:].
    bottom, active, waiting = -np.inf, 0, 0
    while active > 0 or waiting < count:
        while waiting < count and not segments[order[waiting], LOW] > bottom:
            order[active] = order[waiting]
            segments[order[active], ABOVE] = segments[order[active], FOOT]
            active, waiting = active + 1, waiting + 1
        top = segments[order[waiting], LOW] if waiting < count else np.inf
        crossing = 0
        for place in range(active):
            segment = segments[order[place]]
            if segment[HIGH] > bottom:
                top = min(top, segment[HIGH])
                order[crossing] = order[place]
                crossing += 1
        active = crossing
        for place in range(active):
            moved = order[place]
            segment = segments[moved]
            share = (top - segment[LOW]) / (segment[HIGH] - segment[LOW])
            segment[BELOW] = segment[ABOVE]
            segment[ABOVE] = segment[FOOT] + share * (segment[HEAD] - segment[FOOT])
            while place > 0:
                other = segments[order[place - 1]]
                if not other[BELOW] + other[ABOVE] > segment[BELOW] + segment[ABOVE]:
                    break
                order[place] = order[place - 1]
                place -= 1
            order[place] = moved
        height, winding = top - bottom, 0.0
        for place in range(active - 1):
            segment, other = segments[order[place]], segments[order[place + 1]]
            winding += segment[GAIN]
            below, above = other[BELOW] - segment[BELOW], other[ABOVE] - segment[ABOVE]
            wide = abs(below) + abs(above)
            if winding == 0.0 or winding == 1.0:  # then only a change of order is a fault
                wide = max(-below, 0.0) + max(-above, 0.0)
            long = height + wide + abs(segment[ABOVE] - segment[BELOW])
            if wide * height > 2 * thin * long:
                share = below / (below - above) if below * above < 0.0 else 0.5
                x = segment[BELOW] + share * (segment[ABOVE] - segment[BELOW])
                x += (below + share * (above - below)) / 2
                return first, x, bottom + share * height
        bottom = top
    return -1, 0.0, 0.0


@compiled(ENTRY)
def winding_fault(
    corners: ConstFloatRows, starts: ConstIntArray, layers: ConstIntArray
) -> tuple[int, float, float]:
    """The first layer whose rings wind around some area neither 0 times nor once, and where: x, y;
    or −1 and no place.

    Closed rings: layer l has rings layers[l] … layers[l + 1], and ring k is corners (r, 2) from
    starts[k] to starts[k + 1].
    """
    most = 0
    for layer in range(len(layers) - 1):
        most = max(most, starts[layers[layer + 1]] - starts[layers[layer]])
    segments, order = np.empty((most, 7)), np.empty(most, np.int64)
    for layer in range(len(layers) - 1):
        first, count = starts[layers[layer]], starts[layers[layer + 1]] - starts[layers[layer]]
        if layer > 0 and count == first - starts[layers[layer - 1]]:
            same = True
            for corner in range(first, first + count):
                for k in range(2):
                    same = same and corners[corner, k] == corners[corner - count, k]
            if same:  # as on the layer before
                continue
        found, x, y = _fault_in(corners, starts, layers[layer], layers[layer + 1], segments, order)
        if found >= 0:
            return layer, x, y
    return -1, 0.0, 0.0
