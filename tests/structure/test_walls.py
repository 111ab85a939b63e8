"""The structure in space: walls and struts against layers, against scipy, and by their own laws."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Voronoi

from tests.structure.test_fill import SQUARE, foam, stack
from tests.structure.test_slice_law import pole, snapped
from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Floats
from v3dcad.structure.fill import Filling

pytestmark = pytest.mark.slow

FOAM = pole(20, 16, 24, layers=31, cell_size=4, random_seed=3)
STEEP = pole(20, 16, 24, layers=31, cell_size=4, random_seed=3, max_overhang=25.0)
COLUMNS = pole(20, 16, 24, layers=31, cell_size=4, stretch="columns")
SITES = np.random.default_rng(5).uniform([-4, -4, -5], [24, 20, 30], (150, 3))
RECTANGLE = np.array([[0.0, 0], [20, 0], [20, 16], [0, 16]])
GIVEN = foam(stack((RECTANGLE,), 31, 0.8), SITES, stretch=1.6, layer_height=0.8)
FILLINGS = {"foam": FOAM, "steep": STEEP, "columns": COLUMNS, "given": GIVEN}
names = pytest.mark.parametrize("name", FILLINGS)


@names
def test_walls_sliced_are_the_layers_edges(name: str) -> None:
    filling = FILLINGS[name]
    walls = filling.walls
    assert len(walls.tilts) == len(np.unique(walls.sites, axis=0)) > 50
    for z in [*(layer.z for layer in list(filling.layers)[1:-1:9]), 0.123, 3.3456789]:
        z = snapped(filling, z)
        which, segments = walls.slice(z)
        diagram = filling.at(z)
        inner = diagram.inner() & (diagram.lengths() > 1e-8)
        ends = diagram.vertices[diagram.edges[inner]]
        edges = dict(zip(map(tuple, diagram.edge_sites[inner].tolist()), ends, strict=True))
        long = np.hypot(*(segments[:, 0] - segments[:, 1]).T) > 1e-8
        pairs = list(map(tuple, walls.sites[which[long]].tolist()))
        assert set(pairs) == set(edges)
        for pair, segment in zip(pairs, segments[long], strict=True):
            here = edges[pair]
            assert min(np.abs(segment - here).max(), np.abs(segment - here[::-1]).max()) < 1e-8


@names
def test_a_wall_lies_midway_between_its_sites_and_leans_as_they_say(name: str) -> None:
    filling = FILLINGS[name]
    walls, squeezed = filling.walls, np.array([1, 1, 1 / filling.foam.stretch])
    if name != "given":
        assert walls.tilts.max() <= filling.settings.max_overhang + 1e-9
    for wall, (i, j) in enumerate(walls.sites.tolist()):
        corners = walls.points[walls.starts[wall] : walls.starts[wall + 1]]
        p, q = filling.sites[[i, j]] * squeezed
        to_p, to_q = (((corners * squeezed - site) ** 2).sum(axis=1) for site in (p, q))
        np.testing.assert_allclose(to_p, to_q, atol=1e-7)
        area = np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(axis=0)
        if np.linalg.norm(area) > 1e-4:  # counter-clockwise seen from j, as steep as it is sampled
            assert area @ (filling.sites[j] - filling.sites[i]) > 0
            tilt = np.degrees(np.arctan2(abs(area[2]), np.hypot(*area[:2])))
            assert walls.tilts[wall] == pytest.approx(tilt, abs=1e-3)


@names
def test_walls_end_at_the_base_rectangle_and_at_the_first_and_last_layer(name: str) -> None:
    filling = FILLINGS[name]
    low, high = np.append(filling.box[0], 0.0), np.append(filling.box[2], filling.layers[-1].z)
    points = filling.walls.points
    np.testing.assert_allclose(points.min(axis=0), low, atol=1e-9)
    np.testing.assert_allclose(points.max(axis=0), high, atol=1e-9)
    facets = filling.facets(np.array([low, [*high[:2], high[2] + 0.5]]))
    assert facets.points[:, 2].max() == pytest.approx(high[2] + 0.5)
    below = set(map(tuple, filling.walls.sites.tolist()))
    assert len(below - set(map(tuple, facets.sites.tolist()))) < 0.02 * len(below)  # but slivers


@names
def test_three_cells_meet_along_a_strut(name: str) -> None:
    filling = FILLINGS[name]
    axes, squeezed = filling.strut_axes, np.array([1, 1, 1 / filling.foam.stretch])
    assert len(axes.sites) > 20
    assert (axes.ends[:, 1, 2] >= axes.ends[:, 0, 2]).all()
    assert (np.diff(axes.sites) > 0).all()
    ends, sites = axes.ends * squeezed, filling.sites[axes.sites] * squeezed
    away = ((ends[:, :, None] - sites[:, None]) ** 2).sum(axis=3)
    np.testing.assert_allclose(away, away[:, :, :1].repeat(3, axis=2), atol=1e-3)
    z = snapped(filling, 11.3)
    low, high = axes.ends[:, :, 2].T
    crossing = {tuple(three) for three in axes.sites[(low < z - 1e-4) & (high > z + 1e-4)].tolist()}
    assert crossing == corners_of(filling, z)


def corners_of(filling: Filling, z: float) -> set[tuple[int, ...]]:
    """The sites around each vertex of the slice at z where three cells meet."""
    diagram = filling.at(z)
    around: dict[int, set[int]] = {}
    for ends, sites in zip(diagram.edges.tolist(), diagram.edge_sites.tolist(), strict=True):
        for vertex in ends:
            around.setdefault(vertex, set()).update(sites)
    return {
        tuple(sorted(sites)) for sites in around.values() if len(sites) == 3 and -1 not in sites
    }


@pytest.mark.parametrize("name", ["foam", "steep", "given"])
def test_cells_have_the_volumes_of_scipys(name: str) -> None:
    filling = FILLINGS[name]
    stretch, top = filling.foam.stretch, filling.layers[-1].z
    diagram = Voronoi(filling.sites / [1, 1, stretch])
    low, high = np.append(filling.box[0], 0.0), np.append(filling.box[2], top)
    facets = filling.facets(np.array([low, high]))
    corners = facets.points[facets.corners]
    middles = np.add.reduceat(corners, facets.starts[:-1]) / np.diff(facets.starts)[:, None]
    swept = (facets.vectors() * middles).sum(axis=1) / 3
    volumes = np.zeros(len(filling.sites))
    np.add.at(volumes, facets.sites[:, 0], swept)
    np.add.at(volumes, facets.sites[:, 1], -swept)
    whole = 0
    for site, region in enumerate(diagram.point_region):
        names = diagram.regions[region]
        if -1 in names:
            continue
        points = diagram.vertices[names] * [1, 1, stretch]
        if ((points > low) & (points < high)).all():
            whole += 1
            assert volumes[site] == pytest.approx(ConvexHull(points).volume, rel=1e-4)
    assert whole >= 3


def test_one_layer_has_no_walls_in_space() -> None:
    filling = fill_sections([Section(0.0, (SQUARE,))], None, FillSettings())
    assert isinstance(filling, Filling)
    assert len(filling.walls.tilts) == len(filling.strut_axes.sites) == 0
    box = np.array([np.append(filling.box[0], 0.0), np.append(filling.box[2], 0.2)])
    assert len(filling.facets(box)) > 10


def test_thousands_of_tall_columns_have_walls() -> None:
    """They are near each other sideways, however tall they are."""
    filling = pole(50, 50, 500, layers=3, cell_size=0.8, stretch="columns")
    assert len(filling.sites) > 4096
    walls = filling.walls
    assert not walls.tilts.any()
    length = np.hypot(*walls_at(filling).T).sum()
    diagram = filling.at(250.0)
    assert length == pytest.approx(diagram.lengths()[diagram.inner()].sum())


def walls_at(filling: Filling) -> Floats:
    segments = filling.walls.slice(250.0)[1]
    return np.asarray(segments[:, 1] - segments[:, 0])
