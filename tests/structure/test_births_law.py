"""Births by the law that docs and issue state, worked out from qhull's diagrams, layer by layer."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from scipy.optimize import linprog

from tests import oracle
from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Floats, Ints, Layer
from v3dcad.structure.fill import Filling
from v3dcad.structure.growth import PACE
from v3dcad.structure.overhang import overhang
from v3dcad.structure.sites import scatter_sites

pytestmark = pytest.mark.slow

BESIDE = 1e-3
"""mm; newborns from outside stand up to 62 grid steps inside the rectangle's sides."""

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

    Also where a wall leaves the section, the middle of its sites moved along it out to the base
    rectangle, if a cell there would begin outside of that: one at a time, with the weight at which
    its cell touches the rectangle, ahead of the site there or of the two between which it does.
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
        parents, sizes = oracle.holes(self.sites, weights, area)
        lifted = (self.sites**2).sum(axis=1) - weights
        between = self.sites[parents].mean(axis=1)
        centred = (between**2).sum(axis=1) - lifted[parents].mean(axis=1)
        fast = self.growth[parents].sum(axis=1) // 3 + PACE / 8

        self.box = filling.box[[0, 2]]
        low, high = self.box
        couples, places = leaving(area, pairs, edges, self.sites, low, high)
        outside = np.array([not self.begins_inside(place, weights) for place in places], bool)
        sides = np.stack([self.sites[couples[:, 0]], self.sites[couples[:, 1]], places], axis=1)
        others = 2 * shapely.area(shapely.polygons(sides))
        rim = np.linspace(0, 1, 4001)[:, None]
        rim = np.concatenate([low + rim * (high - low) * e for e in np.eye(2)])
        rim = np.concatenate([rim, low + high - rim])
        power = ((rim[:, None] - self.sites) ** 2).sum(axis=2) - weights
        touching = ((rim - places[:, None]) ** 2).sum(axis=2) - power.min(axis=1)
        paces = [
            self.pace(place, rim[at], power[at])
            for place, at in zip(places, touching.argmin(axis=1), strict=True)
        ]

        self.from_outside = np.arange(len(parents) + len(couples)) >= len(parents)
        self.in_place = np.concatenate([np.ones(len(parents), bool), outside])
        self.parents = np.concatenate([parents, np.pad(couples, ((0, 0), (0, 1)), mode="edge")])
        self.sizes = np.concatenate([sizes, others])
        self.places = np.concatenate([between, places])
        self.fast = np.concatenate([fast, np.floor(paces) + PACE / 8])
        self.weights = np.concatenate([centred, touching.min(axis=1)])

    def begins_inside(self, place: Floats, weights: Floats) -> bool:
        """Whether the place's cell begins in the base rectangle as its weight grows: at the x for
        which the largest of |x − place|² − |x − p|² + w, which are linear in x, is least.
        """
        lifted = (self.sites**2).sum(axis=1) - weights
        rows = np.column_stack([2 * (self.sites - place), -np.ones(len(lifted))])
        found = linprog([0, 0, 1], rows, lifted - place @ place, bounds=(None, None))
        low, high = self.box
        return bool(found.success and ((low <= found.x[:2]) & (found.x[:2] <= high)).all())

    def pace(self, place: Floats, at: Floats, power: Floats) -> float:
        """The growth at which the cell of a place outside would go on to touch the rectangle."""
        i, j = np.argsort(power)[:2]
        on_side = ~np.isclose(at, self.box).any(axis=0)
        if on_side.sum() == 0:  # a corner
            return float(self.growth[i])
        (along,) = np.nonzero(on_side)[0]
        near = (place - self.sites[i])[along] / (self.sites[j] - self.sites[i])[along]
        return float(self.growth[i] + np.clip(near, 0, 1) * (self.growth[j] - self.growth[i]))

    def room(self, others: Floats, growth: Floats) -> Floats:
        """(holes,) mm by which each hole's newborn is farther from others than it must be."""
        apart = np.hypot(*(self.places[:, None] - others).transpose(2, 0, 1))
        must = self.reach * np.abs(self.fast[:, None] - growth)
        return np.asarray((apart - must).min(axis=1, initial=np.inf))


def leaving(
    area: shapely.Geometry, pairs: Ints, edges: Floats, sites: Floats, low: Floats, high: Floats
) -> tuple[Ints, Floats]:
    """The pairs (k, 2) of whose walls `edges` (m, 2, 2) a part ends at a contour, and where the
    middle of each pair gets to the rectangle's sides that way (k, 2), mm.
    """
    couples, places = [], []
    for pair, edge in zip(pairs, edges, strict=True):
        inside = shapely.get_parts(shapely.intersection(area, shapely.linestrings(edge)))
        for part in inside[~shapely.is_empty(inside)]:
            for way in (1, -1):
                here, there = shapely.get_coordinates(part)[[0, -1]][::way]
                if np.hypot(*(there - edge).T).min() < 1e-6:
                    continue
                middle, across = sites[pair].mean(axis=0), sites[pair[1]] - sites[pair[0]]
                along = np.array([-across[1], across[0]])
                along *= np.sign((there - here) @ along)
                with np.errstate(divide="ignore"):
                    reaches = (np.where(along > 0, high, low) - middle) / along
                couples.append(pair)
                places.append(middle + max(0.0, reaches.min()) * along)
    return np.reshape(couples, (-1, 2)).astype(np.int64), np.reshape(places, (-1, 2))


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
    births = full = freed = came_in = 0
    for layer in layers[1:]:
        below = Below(filling, layer, present, full_cell)
        newborn = layer.state.sites[present:]
        growth = np.rint(layer.state.growth[present:] / filling.growth_step)
        apart = np.hypot(*(newborn[:, None] - below.places).transpose(2, 0, 1))
        chosen = apart.argmin(axis=1)
        off = np.where(below.from_outside, BESIDE, 1e-5)
        assert (apart.min(axis=1, initial=np.inf) < off[chosen]).all()
        assert (growth == below.fast[chosen]).all()
        weights = layer.state.weights[present:]
        outer = below.from_outside[chosen]
        assert outer.sum() < 2, "one at a time"
        np.testing.assert_allclose(weights[~outer], below.weights[chosen][~outer], atol=1e-4)
        # Sampled along the rectangle, where the least may be missed by a bit.
        assert (np.abs(below.weights[chosen] - weights - 0.1)[outer] <= 0.15).all()
        came_in += outer.sum()
        seen = below.room(below.sites[below.inside], below.growth[below.inside])
        assert (seen >= -off)[chosen].all(), "walls would lean too much"
        assert len(newborn) <= below.wanted

        room = below.room(below.sites[below.anywhere], below.growth[below.anywhere])
        room = np.minimum(room, below.room(newborn, growth))
        names = [tuple(sorted(parents)) for parents in below.parents.tolist()]
        freed += sum(names[hole] in crammed for hole in chosen)
        kin = below.parents[chosen][:, None]
        common = (below.parents[:, None, :, None] == kin).sum(axis=(2, 3))
        between = np.nonzero(~outer)[0]
        assert (common[chosen][between][:, between] < 2).sum() == len(between) * (len(between) - 1)
        ready = (room > off) & ((common < 2) | outer | below.from_outside[:, None]).all(axis=1)
        ready &= below.in_place
        ready[chosen] = False
        if outer.any():
            ready &= ~below.from_outside
        least = below.sizes[chosen].min(initial=np.inf) if len(newborn) == below.wanted else -np.inf
        sizes = below.sizes - 10 * np.where(below.from_outside, BESIDE, 0)
        least += 10 * BESIDE if outer.any() else 1e-9
        assert sizes[ready].max(initial=-np.inf) <= least, f"layer {layer.index}"
        without = {name for name, some, much in zip(names, room, off, strict=True) if some <= much}
        crammed = (crammed & set(names)) | without
        present = len(layer.state.sites)
        births += len(newborn)
        full += below.wanted == len(newborn) > 0
    assert births > 10
    assert full > 2
    assert came_in > 0
    assert freed > 0 or limit == 20.0, "in no hole did a neighbour's death make room"


@pytest.mark.parametrize(("count", "seed"), [(50, 0), (50, 3), (200, 1)])
def test_cells_stay_even_on_a_tall_pole(count: int, seed: int) -> None:
    """Up to six times its width: as many cells as at its foot, and none of them a giant."""
    sites = scatter_sites(np.array([[0.0, 0], [30, 30]]), count, seed)
    sections = [Section(0.3 * k, (SQUARE,)) for k in range(600)]
    filling = fill_sections(sections, sites, FillSettings(layer_height=0.3))
    assert len(filling.births) > 1.5 * count
    for layer in filling.layers:
        assert layer.area_per_cell < 1.1 * 900 / count
        if layer.index % 20 == 0:
            areas = layer.diagram.areas(len(layer.state.sites))
            assert areas.max() < 12 * 900 / count
            assert (areas**2).sum() / areas.sum() < 3 * 900 / count, "of the cell around a point"


TURN = np.linspace(0, 2 * np.pi, 64, endpoint=False)
SHAPES = {
    "disc": 10 + 10 * np.column_stack([np.cos(TURN), np.sin(TURN)]),
    "angle": np.array([[0.0, 0], [20, 0], [20, 6], [6, 6], [6, 20], [0, 20]]),
    "bar": np.array([[0.0, 0], [40, 0], [40, 8], [0, 8]]),
}


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_cells_stay_as_many_on_poles_of_any_shape(name: str) -> None:
    """Without newborns from outside the bar and the angle had a quarter of them left at the top."""
    ring = SHAPES[name]
    sites = scatter_sites(np.stack([ring.min(axis=0), ring.max(axis=0)]), 60, 0)
    sections = [Section(0.2 * k, (ring,)) for k in range(1200)]
    filling = fill_sections(sections, sites, FillSettings(layer_height=0.2))
    first, *others = (layer.area_per_cell for layer in filling.layers)
    assert max(others) < 1.15 * first
    assert filling.history.tracks.leaps, "none came in from outside"
    slack = filling.facets(240.0).slack.max()
    assert slack < 1e-6, "corners that should be one: newborns were in the rectangle at their birth"
    for z in (100.03, 200.07):
        diagram = filling.at(z)
        _, segments = filling.walls.slice(z)
        length = np.hypot(*(segments[:, 0] - segments[:, 1]).T).sum()
        assert length == pytest.approx(diagram.lengths()[diagram.inner()].sum(), rel=1e-9)


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
