import numpy as np
import pytest
from numba import njit
from scipy.spatial import KDTree

from tests.geometry.voronoi import oracle
from v3dcad.geometry.compiled.options import ENTRY
from v3dcad.geometry.voronoi.periodic import with_copies
from v3dcad.structure.foam.darts import poisson_disk
from v3dcad.structure.foam.energy import ACTIVE, DISTANCE, PUSH, WEIGHT, add_gradients
from v3dcad.structure.foam.relaxing import check_all, periodic_foam

pytestmark = pytest.mark.slow

BOX = np.array([6.0, 5.5, 6.5])
LEAN = 0.6


@njit(**{**ENTRY, "cache": False})
def gradients_of(foam, lean, slack):
    add_gradients(foam, lean, slack)


def energy(places):
    """The energy by qhull's walls, summed over pairs in a periodic box of sites of radius 1."""
    around = with_copies(places, BOX, 3.0)
    total = 0.0
    for pair, corners in oracle.walls(around).items():
        share = sum(site < len(places) for site in pair) / 2
        x, y, z = around[pair[1]] - around[pair[0]]
        violation = LEAN * abs(z) - np.hypot(x, y)
        if share and violation > 0:
            sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
            total += share * WEIGHT * violation * sides.sum()
    tree = KDTree(places, boxsize=BOX)
    distances = tree.sparse_distance_matrix(tree, DISTANCE, output_type="coo_matrix").data
    near = distances[distances > 0] / DISTANCE
    return total + PUSH * ((1 - near) ** 2).sum() / 2


@pytest.mark.parametrize("seed", range(5))
def test_the_gradient_is_that_of_the_energy(seed):
    places = poisson_disk(BOX, 0.9, seed)
    count = len(places)
    foam, _ = periodic_foam(places, np.ones(count), BOX, 0)
    check_all(foam, LEAN, 0.0)
    foam.counts[:] = 0
    foam.counts[ACTIVE] = count
    foam.active[:] = True
    foam.active_rows[:] = np.arange(count)
    gradients_of(foam, LEAN, 0.0)
    assert np.linalg.norm(foam.gradients) > 10
    # All sites moved together change nothing.
    np.testing.assert_allclose(foam.gradients.sum(axis=0), 0, atol=1e-9)
    rng = np.random.default_rng(seed)
    for _ in range(5):
        way = rng.normal(size=places.shape) * 1e-7
        change = energy(places + way) - energy(places - way)
        assert change == pytest.approx(2 * (foam.gradients * way).sum(), rel=1e-3)
