"""What a link at the end of a wall costs and saves, by headings along the loops."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from facing_loops import S, loops_of, place
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.geometry.loops.facing import facing
from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.wall_ends import BEYOND, wall_ends
from v3dcad.model import Floats

NEAR = 1e-4


def heading(loops: Loops, loop: int, along: float) -> Floats:
    """The unit vector of a loop around a place on it."""
    from_, to = (
        shapely.get_coordinates(place(loops, loop, along + step))[0]
        for step in (-NEAR / 2, NEAR / 2)
    )
    return np.asarray((to - from_) / np.hypot(*(to - from_)))


def changes(*headings: Floats) -> float:
    return sum(float(np.hypot(*step)) for step in np.diff(headings, axis=0))


@settings(max_examples=10, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(2, 30))
def test_costs_are_the_changes_of_heading_with_a_link_less_those_without(
    seed: int, count: int
) -> None:
    loops = loops_of(seed, count)
    measured = loops.measured()
    found = facing(loops, measured, S)
    ends = wall_ends(measured, found, S)
    corners = shapely.MultiPoint(loops.points)
    for (one, other), (low, high), beyond, shift, cost in zip(
        found.loops, found.along, found.beyond, ends.shift, ends.cost, strict=True
    ):
        if high - low < 10 * NEAR:
            continue
        middle = (low + high) / 2
        facing_ends = (
            (one, low, shift[0], middle, other, beyond - low, shift[1], beyond - middle),
            (other, beyond - high, shift[3], beyond - middle, one, high, shift[2], middle),
        )
        for total, end in zip(cost, facing_ends, strict=True):
            come, arrives, back, on_come, go, leaves, on, on_go = end
            joined = back != 0 or on != 0
            if joined:  # Both go on to a corner, if they do not end there.
                for loop, at in ((come, arrives + back), (go, leaves + on)):
                    assert place(loops, loop, at).distance(corners) < 1e-6
            assert -BEYOND * S <= back < 1e-9
            assert -1e-9 < on <= BEYOND * S
            from_, to = place(loops, come, arrives + back), place(loops, go, leaves + on)
            link = shapely.get_coordinates(to)[0] - shapely.get_coordinates(from_)[0]
            link /= np.hypot(*link)
            before = heading(loops, come, arrives + back - NEAR)
            after = heading(loops, go, leaves + on + NEAR)
            without = changes(before, heading(loops, come, on_come))
            without += changes(heading(loops, go, on_go), after)
            assert total == pytest.approx(changes(before, link, after) - without, abs=1e-3)


def test_a_link_beside_a_straight_wall_saves_two_right_angles() -> None:
    """Two cells that stand on a third: the nozzle goes straight on, past the end of their wall."""
    cells = [shapely.box(0, 0, 4, 4), shapely.box(4, 0, 8, 4), shapely.box(0, -4, 8, 0)]
    lines = [
        shapely.get_coordinates(cell.buffer(-S / 2, join_style="mitre").exterior)[:-1]
        for cell in cells
    ]
    loops = Loops.of(
        [line if shapely.LinearRing(line).is_ccw else line[::-1] for line in lines], [0, 1, 2]
    )
    found = facing(loops, loops.measured(), S)
    (between,) = np.nonzero((found.loops == [0, 1]).all(axis=1))[0]
    cost = wall_ends(loops.measured(), found, S).cost
    assert cost[between] == pytest.approx(-2 * np.sqrt(2), abs=1e-9)
    # Over the third cell, at the end of either other wall, it turns off as it did before.
    assert np.delete(cost, between, axis=0).max(axis=1) == pytest.approx([0, 0], abs=1e-9)
