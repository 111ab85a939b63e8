from __future__ import annotations

import numpy as np
import pytest
from diagrams import disc, square

from v3dcad.model import Floats
from v3dcad.toolpath.seam import Seams

L_SHAPE = np.array([[0.0, 0], [30, 0], [30, 10], [10, 10], [10, 30], [0, 30]])
ROUND = disc(10, points=90).rings[0]


def seams_of(how: str, rings: list[Floats]) -> Floats:
    """(l, 2) where each layer's line begins."""
    seams = Seams(how)
    found = []
    for ring in rings:
        seams.rise()
        found.append(ring[seams.corner(ring)])
    return np.array(found)


def test_rear_is_the_rearmost_corner_and_of_two_the_one_farther_right() -> None:
    assert seams_of("rear", [L_SHAPE, np.roll(L_SHAPE, 2, axis=0)]).tolist() == [[10, 30]] * 2


@pytest.mark.parametrize("first", [0, 17, 60])
def test_aligned_seams_lie_above_each_other_whatever_point_a_ring_begins_with(first: int) -> None:
    rings = [np.roll(ROUND * (1 - 0.01 * k), first * k, axis=0) for k in range(30)]
    places = seams_of("aligned", rings)
    angle = np.unwrap(np.arctan2(places[:, 1], places[:, 0]))
    assert np.ptp(angle) < 0.1


def test_aligned_begins_in_the_sharpest_corner() -> None:
    house = np.array([[-10.0, 0], [10, 0], [10, 10], [0, 30], [-10, 10]])
    assert seams_of("aligned", [house]).tolist() == [[0, 30]]


def test_each_of_several_lines_keeps_its_own_seam() -> None:
    seams = Seams("aligned")
    places = []
    for _ in range(3):
        seams.rise()
        rings = [square(5).rings[0], square(5).rings[0] + [40.0, 0]]
        places.append([ring[seams.corner(ring)].tolist() for ring in rings])
    assert places[0] == places[1] == places[2]
    assert places[0][0] != places[0][1]


def test_scattered_seams_go_round() -> None:
    places = seams_of("scattered", [ROUND] * 20)
    angle = np.sort(np.arctan2(places[:, 1], places[:, 0]))
    gaps = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    assert gaps.max() < 4 * 2 * np.pi / 20
    again = seams_of("scattered", [ROUND] * 20)
    assert np.array_equal(places, again)
