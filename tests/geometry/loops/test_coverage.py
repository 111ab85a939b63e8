"""The room that beads have, against shapely's union of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from v3dcad.geometry.loops.coverage import covered
from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import Floats

W = 0.4


def shares(*lines: Floats) -> tuple[Floats, Floats]:
    """The share of each bead of some strokes, and the length of each."""
    start = np.concatenate([line[:-1] for line in lines])
    stop = np.concatenate([line[1:] for line in lines])
    stroke = np.repeat(np.arange(len(lines)), [len(line) - 1 for line in lines])
    return covered(Segments.of(start, stop, W), stroke, W), np.hypot(*(stop - start).T)


def area(*lines: Floats) -> float:
    """What beads with flat ends cover."""
    beads = [shapely.LineString(line).buffer(W / 2, cap_style="flat") for line in lines]
    return float(shapely.union_all(beads).area)


def arm(degrees: float, reach: float = 10.0) -> Floats:
    angle = math.radians(degrees)
    return np.array([[0.0, 0], [reach * math.cos(angle), reach * math.sin(angle)]])


@pytest.mark.parametrize("angles", [[90, 210, 330], [0, 100, 220], [0, 90, 180, 270]])
def test_beads_that_meet_share_the_room_at_their_junction(angles: list[float]) -> None:
    lines = [arm(angle) for angle in angles]
    share, length = shares(*lines)
    assert (share * length).sum() * W == pytest.approx(area(*lines), rel=2e-3)


@pytest.mark.parametrize("apart", [0.1, 0.2, 0.39, 0.4, 3.0])
def test_parallel_beads_have_half_of_what_lies_between(apart: float) -> None:
    low = np.array([[0.0, 0], [20, 0]])
    share, _ = shares(low, low[::-1] + np.array([0, apart]))
    assert share == pytest.approx((W / 2 + min(apart, W) / 2) / W, abs=0.03)


def test_round_beads_side_by_side_share_room_as_straight_ones_do() -> None:
    """Short pieces, each of them near to another for a moment only."""
    angle = np.linspace(0, 2 * np.pi, 120)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    share, _ = shares(5 * ring, (5 + 0.9 * W) * ring[::-1])
    assert share == pytest.approx(0.95, abs=0.02)


def test_a_bend_to_the_left_is_even_and_one_to_the_right_is_less() -> None:
    left = np.array([[0.0, 0], [5, 0], [5, 5]])
    share, length = shares(left)
    assert share == pytest.approx(1.0)
    right = left * [1, -1]
    share, length = shares(right)
    rounded = shapely.LineString(right).buffer(W / 2, cap_style="flat", quad_segs=64).area
    assert (share * length).sum() * W == pytest.approx(rounded, rel=1e-4)


def test_a_circle_of_short_beads_is_full() -> None:
    angle = np.linspace(0, 2 * np.pi, 400)
    share, _ = shares(np.column_stack([np.cos(angle), np.sin(angle)]))
    assert share.min() > 0.99


def test_no_beads_and_beads_without_length() -> None:
    none = np.empty((0, 2))
    assert not len(covered(Segments.of(none, none, W), np.empty(0, np.int64), W))
    share, _ = shares(np.zeros((2, 2)), np.array([[3.0, 0], [4, 0]]))
    assert np.isfinite(share).all()
