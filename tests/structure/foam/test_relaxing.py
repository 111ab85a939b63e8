from math import sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.errors import GeometryError
from v3dcad.geometry.voronoi.periodic import with_copies
from v3dcad.geometry.voronoi.steepest import steepest_wall
from v3dcad.structure.foam.darts import poisson_disk
from v3dcad.structure.foam.relaxing import relax

BITS = 14
"""Sites are rounded to so many bits of their radius."""


def steepest(places, box):
    """τ of the steepest wall of sites in a periodic box, rounded to whole numbers."""
    sites = np.rint(places * (1 << BITS))
    size = np.rint(box * (1 << BITS))
    around = with_copies(np.mod(sites, size), size, 3.0 * (1 << BITS))
    return steepest_wall(around.astype(np.int64), np.zeros(3, np.int64), size.astype(np.int64))


@settings(max_examples=8)
@given(st.integers(0, 10**6), st.sampled_from([2.0, 1.67, 1.5, sqrt(2)]))
def test_no_wall_leans_over_tau(random_seed, tau):
    box = np.array([6.0, 6.5, 5.5])
    places = poisson_disk(box, 1.0, random_seed)
    assert steepest(places, box).tau > 2
    relaxed = relax(places, np.ones(len(places)), box, tau, slack=0.001, random_seed=random_seed)
    assert relaxed.shape == places.shape
    assert steepest(relaxed, box).tau <= tau


def test_sites_keep_the_distances_of_their_radii():
    """Of a field of radii, coarse in the middle of the box: as many times the radius everywhere."""
    box = np.full(3, 8.0)
    candidates = poisson_disk(box, 0.5, 3)
    radii = 0.5 + 0.5 * np.sin(np.pi * candidates[:, 0] / 8) ** 2
    kept: list[int] = []
    for site in range(len(candidates)):
        offsets = np.abs(candidates[kept] - candidates[site])
        distances = np.linalg.norm(np.minimum(offsets, box - offsets), axis=1)
        if not (distances < np.minimum(radii[kept], radii[site])).any():
            kept.append(site)
    relaxed = relax(candidates[kept], radii[kept], box, 1.67, slack=0.001)
    assert steepest(relaxed, box).tau <= 1.67
    moved = np.abs(relaxed - candidates[kept])
    moved = np.linalg.norm(np.minimum(moved, box - moved), axis=1)
    assert np.median(moved / radii[kept]) < 0.3


def test_same_sites_twice():
    box = np.full(3, 6.0)
    places = poisson_disk(box, 1.0, 0)
    first, again = (relax(places, np.ones(len(places)), box, 1.35) for _ in range(2))
    assert first.tobytes() == again.tobytes()


def test_what_no_foam_reaches_is_an_error():
    """τ below 1 / √2 is beyond any foam."""
    box = np.full(3, 5.0)
    places = poisson_disk(box, 1.0, 0)
    with pytest.raises(GeometryError, match=r"τ = 0\.6") as caught:
        relax(places, np.ones(len(places)), box, 0.6, stages=(), effort=30)
    assert caught.value.site is not None


def test_a_box_that_is_too_small_is_an_error():
    places = np.array([[0.0, 0, 0], [1.5, 1.5, 1.5]])
    with pytest.raises(GeometryError, match="4 radii"):
        relax(places, np.ones(2), np.array([9.0, 9.0, 3.0]), 2.0)
