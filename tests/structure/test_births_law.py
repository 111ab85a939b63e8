"""Births by the law that docs and issue state, worked out from qhull's diagrams, layer by layer."""

from __future__ import annotations

import numpy as np
import pytest

from tests import oracle
from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Floats, Layer
from v3dcad.structure.fill import Filling
from v3dcad.structure.growth import PACE
from v3dcad.structure.overhang import overhang
from v3dcad.structure.sites import scatter_sites

SQUARE = np.array([[0.0, 0], [30, 0], [30, 30], [0, 30]])
HOLE = np.array([[12.0, 12], [12, 17], [18, 18], [17, 12]])


def structure(count: int, seed: int, limit: float, rings: tuple[Floats, ...]) -> Filling:
    sites = scatter_sites(np.array([[0.0, 0], [30, 30]]), count, seed)
    sections = [Section(0.5 * k, rings) for k in range(90)]
    filling = fill_sections(sections, sites, FillSettings(max_overhang=limit, layer_height=0.5))
    assert isinstance(filling, Filling)
    return filling


class Below:
    """A layer as it would be without its newborns, and what the law says of them.

    As many as bring area per cell back to `full_cell`, mm²; where the triangle of three sites is
    largest; at its centroid, by an eighth of the offset faster than their mean; so far from other
    cells' sites that no wall leans beyond the limit; not beside another newborn. The power function
    that a newborn begins with is the mean of the three.
    """

    def __init__(self, filling: Filling, layer: Layer, present: int, full_cell: float) -> None:
        state, section, step = layer.state, layer.section, filling.growth_step
        self.sites, weights = state.sites[:present], state.weights[:present]
        self.growth = np.rint(state.growth[:present] / step)
        self.reach = step / (2 * np.tan(np.radians(filling.settings.max_overhang)))
        area = oracle.area_of(section)
        pairs, edges = oracle.power_edges(present, *oracle.power_diagram(self.sites, weights))
        self.inside = np.unique(oracle.cut_edges(area, pairs, edges)[0])
        self.anywhere = np.unique(pairs)
        self.wanted = max(0, int(np.ceil(area.area / full_cell - 1e-9)) - len(self.inside))
        self.parents, self.sizes = oracle.holes(self.sites, weights, area)
        self.places = self.sites[self.parents].mean(axis=1)
        self.fast = self.growth[self.parents].sum(axis=1) // 3 + PACE / 8
        lifted = (self.sites**2).sum(axis=1) - weights
        self.weights = (self.places**2).sum(axis=1) - lifted[self.parents].mean(axis=1)

    def room(self, others: Floats, growth: Floats) -> Floats:
        """(holes,) mm by which each hole's newborn is farther from others than it must be."""
        apart = np.hypot(*(self.places[:, None] - others).transpose(2, 0, 1))
        must = self.reach * np.abs(self.fast[:, None] - growth)
        return np.asarray((apart - must).min(axis=1, initial=np.inf))


@pytest.mark.parametrize(
    ("count", "seed", "limit", "rings"),
    [(40, 1, 45.0, (SQUARE,)), (70, 2, 45.0, (SQUARE, HOLE)), (25, 3, 20.0, (SQUARE, HOLE))],
)
def test_births_are_those_of_the_law(
    count: int, seed: int, limit: float, rings: tuple[Floats, ...]
) -> None:
    """Whatever happened before: a hole once without room counts again when there is some."""
    filling = structure(count, seed, limit, rings)
    layers = list(filling.layers)
    present, full_cell = count, layers[0].area_per_cell
    crammed: set[tuple[int, ...]] = set()
    births = full = freed = 0
    for layer in layers[1:]:
        below = Below(filling, layer, present, full_cell)
        newborn = layer.state.sites[present:]
        growth = np.rint(layer.state.growth[present:] / filling.growth_step)
        apart = np.hypot(*(newborn[:, None] - below.places).transpose(2, 0, 1))
        chosen = apart.argmin(axis=1)
        assert apart.min(axis=1, initial=0 if not len(newborn) else np.inf).max(initial=0) < 1e-5
        assert (growth == below.fast[chosen]).all()
        weights = layer.state.weights[present:]
        np.testing.assert_allclose(weights, below.weights[chosen], rtol=0, atol=1e-4)
        seen = below.room(below.sites[below.inside], below.growth[below.inside])
        assert seen[chosen].min(initial=0) >= -1e-5, "walls would lean too much"
        assert len(newborn) <= below.wanted

        room = below.room(below.sites[below.anywhere], below.growth[below.anywhere])
        room = np.minimum(room, below.room(newborn, growth))
        names = [tuple(sorted(parents)) for parents in below.parents.tolist()]
        freed += sum(names[hole] in crammed for hole in chosen)
        kin = below.parents[chosen][:, None]
        common = (below.parents[:, None, :, None] == kin).sum(axis=(2, 3))
        assert (common[chosen] < 2).sum() == len(chosen) * (len(chosen) - 1)
        ready = (room > 1e-5) & (common < 2).all(axis=1)
        least = below.sizes[chosen].min(initial=np.inf) if len(newborn) == below.wanted else -np.inf
        assert below.sizes[ready].max(initial=-np.inf) <= least + 1e-9, f"layer {layer.index}"
        without = {name for name, some in zip(names, room, strict=True) if some <= 1e-5}
        crammed = (crammed & set(names)) | without
        present = len(layer.state.sites)
        births += len(newborn)
        full += below.wanted == len(newborn) > 0
    assert births > 10
    assert full > 2
    assert freed > 0 or limit == 20.0, "in no hole did a neighbour's death make room"


@pytest.mark.parametrize(("count", "seed"), [(50, 0), (50, 3), (200, 1)])
def test_cells_stay_even_on_a_tall_pole(count: int, seed: int) -> None:
    """Up to six times its width: as many cells as at its foot, and none of them a giant."""
    sites = scatter_sites(np.array([[0.0, 0], [30, 30]]), count, seed)
    sections = [Section(0.3 * k, (SQUARE,)) for k in range(600)]
    filling = fill_sections(sections, sites, FillSettings(layer_height=0.3))
    assert len(filling.births) > 2 * count
    for layer in filling.layers:
        assert layer.area_per_cell < 1.1 * 900 / count
        if layer.index % 20 == 0:
            areas = layer.diagram.areas(len(layer.state.sites))
            assert areas.max() < 12 * 900 / count
            assert (areas**2).sum() / areas.sum() < 3 * 900 / count, "of the cell around a point"


@pytest.mark.parametrize("limit", [15.0, 45.0, 70.0])
def test_no_wall_leans_beyond_the_limit_with_births(limit: float) -> None:
    filling = structure(40, 4, limit, (SQUARE,))
    tilts = overhang(filling.layers, 0.8).wall_tilt
    assert len(filling.births) > 5
    assert tilts.max() <= limit + 1e-6
    assert filling.walls.tilts.max() <= limit + 1e-6


def test_without_insertion_nobody_is_born() -> None:
    sites = scatter_sites(np.array([[0.0, 0], [30, 30]]), 40, 1)
    sections = [Section(0.5 * k, (SQUARE,)) for k in range(90)]
    settings = FillSettings(layer_height=0.5, insertion=False)
    filling = fill_sections(sections, sites, settings)
    assert len(filling.births) == 0
    assert all(len(layer.state.sites) == 40 for layer in filling.layers)
