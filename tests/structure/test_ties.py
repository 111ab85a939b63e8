"""Sites that tie: lattices, whose cells meet in more than four, lie one above the other, and open
and close on a layer. Neither history nor order nor company shows.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.structure.test_fill import SIDE, SQUARE, laws, same, with_few
from v3dcad.model import Floats, Section

pytestmark = pytest.mark.slow

CUBIC = np.zeros((1, 3))
CENTRED = np.array([[0, 0, 0], [2, 2, 2.0]])
FACES = np.array([[0, 0, 0], [0, 2, 2], [2, 0, 2], [2, 2, 0.0]])
HEXAGONS = np.array([[0, 0, 0], [2, 1, 0.0]])


def lattice(cell: Floats, side: float = 4.0) -> Floats:
    """A lattice of cubes with cube axes upright, over the square and beyond."""
    along = np.arange(-side, SIDE + side + 1, side)
    corners = np.stack(np.meshgrid(along, along, np.arange(-side, 25, side)), axis=-1)
    return (corners.reshape(-1, 1, 3) + cell * side / 4).reshape(-1, 3)


RING = np.stack([8 + 5 * np.cos(np.arange(12)), 8 + 5 * np.sin(np.arange(12))], axis=-1)
LATTICES = {
    "cubic": lattice(CUBIC),
    "body-centred": lattice(CENTRED),
    "face-centred": lattice(FACES),
    "hexagonal": lattice(HEXAGONS),
    "one above the other": np.array([[5.0, 5, 2 * k] for k in range(9)] + [[11.0, 9, 3]]),
    "around": np.array([[x, y, z] for x in (4, 12) for y in (4, 12) for z in (0.0, 4, 8)]),
    "collinear": np.array([[2.0 * k, 2.0 * k, 2.0 * k] for k in range(9)]),
    "octahedra": np.concatenate([8 + 4 * np.eye(3), 8 - 4 * np.eye(3)]),
}
names = pytest.mark.parametrize("name", LATTICES)
few = pytest.mark.parametrize("few", [0, 1000])


def sections(height: float = 0.5, layers: int = 40) -> list[Section]:
    return [Section(height * k, (SQUARE,)) for k in range(layers)]


@names
@few
def test_layers_of_lattices_obey_the_laws(name: str, few: int) -> None:
    """On their planes of symmetry too, where cells end in a face, an edge or a corner."""
    filling = with_few(few, sections(1.0, 20), LATTICES[name], layer_height=1.0)
    for layer in filling.layers:
        same(layer, filling.layers[layer.index])
        if few == 0 and layer.index % 3 == 0:  # otherwise all sites are there, and oracles slow
            laws(layer)


@names
@given(st.integers(0, 10**6), st.sampled_from([0, 1000]))
def test_the_order_of_tied_sites_shows_in_no_area(name: str, seed: int, few: int) -> None:
    """Between the planes on which cells open and close. Four cells may meet in a point, so that
    pairs differ; what each has does not.
    """
    sites = LATTICES[name]
    order = np.random.default_rng(seed).permutation(len(sites))
    heights = [Section(0.31 + 0.7 * k, (SQUARE,)) for k in range(20)]
    one, other = (with_few(few, heights, given) for given in (sites, sites[order]))
    for layer, permuted in zip(one.layers, other.layers, strict=True):
        count = len(sites)
        np.testing.assert_allclose(
            layer.diagram.areas(count)[order], permuted.diagram.areas(count), atol=1e-9
        )


@names
def test_company_does_not_show(name: str) -> None:
    """The mesh may hold sites that have no cell near, and points that others hide."""
    always, by_reach = (with_few(few, sections(), LATTICES[name]) for few in (1000, 0))
    for layer, other in zip(always.layers, by_reach.layers, strict=True):
        same(layer, other) if always._block == by_reach._block else np.testing.assert_allclose(
            layer.diagram.areas(len(LATTICES[name])),
            other.diagram.areas(len(LATTICES[name])),
            atol=1e-9,
        )


def test_cells_of_a_cubic_lattice_are_cubes() -> None:
    sites = LATTICES["cubic"]
    for layer in with_few(0, sections(), sites).layers:
        areas = layer.diagram.areas(len(sites))
        high = np.unique(sites[areas > 1e-9, 2])
        assert len(high) == 1
        assert abs(high[0] - layer.z) <= 2
        assert np.sort(areas)[-9:] == pytest.approx(16)
        if (layer.z + 2) % 4 == 0:  # between two: the first has it
            assert high[0] == layer.z - 2
