"""The report's numbers, worked out again by qhull and GEOS from sites and weights."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely

import v3dcad
from tests import oracle
from v3dcad.model import Floats, Layer
from v3dcad.report import certificate_line, foam_lines

pytestmark = pytest.mark.slow

BEAD = 0.8

LOW, HIGH = 10.0, 12.0


def widening(**settings: Any) -> v3dcad.Structure:
    """A block that widens from 20 to 24 mm over 12 mm of height, filled."""
    corners = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    rings = [np.column_stack([half * corners, np.full(4, z)]) for half, z in ((LOW, 0), (HIGH, 12))]
    sides = [
        triangle
        for k in range(4)
        for triangle in ([k, (k + 1) % 4, 4 + (k + 1) % 4], [k, 4 + (k + 1) % 4, 4 + k])
    ]
    triangles = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], *sides]
    return v3dcad.fill((np.concatenate(rings), np.array(triangles)), layer_height=0.5, **settings)


@pytest.fixture(scope="module")
def structure() -> v3dcad.Structure:
    """Walls that lean so much that some lie farther than half a bead from those below."""
    random = np.random.default_rng(2)
    sites = random.uniform([-15, -15, -4], [15, 15, 16], (90, 3))
    return widening(sites=sites, stretch=1.0, max_overhang=90)


@pytest.fixture(scope="module")
def told(structure: v3dcad.Structure) -> dict[str, Any]:
    return structure.report(v3dcad.PrintSettings(bead_width=BEAD))


def walls(layer: Layer) -> tuple[Floats, list[shapely.Geometry]]:
    """Pairs of sites and the walls between them."""
    state, area = layer.state, oracle.area_of(layer.section)
    corners, vertices, across = oracle.power_diagram(state.sites[:, :2], state.weights)
    pairs, edges = oracle.power_edges(len(state.sites), corners, vertices, across)
    pairs, lines = oracle.cut_edges(area, pairs, edges)[:2]
    kept = shapely.length(lines) > 1e-6
    return pairs[kept], lines[kept]


def test_lengths_and_tilts(structure: v3dcad.Structure, told: dict[str, Any]) -> None:
    largest = 0.0
    for layer, row in zip(structure.layers, told["by_layer"], strict=True):
        pairs, lines = walls(layer)
        area = oracle.area_of(layer.section)
        assert row["wall_length_mm"] == pytest.approx(shapely.length(lines).sum(), rel=1e-5)
        assert row["contour_length_mm"] == pytest.approx(area.length)
        assert row["area_per_cell_mm2"] == pytest.approx(area.area / row["cells"])
        one, other = pairs.T
        state = layer.state
        apart = state.sites[one] - state.sites[other]
        tilt = np.degrees(np.arctan2(np.abs(apart[:, 2]), np.hypot(*apart[:, :2].T)))
        assert row["wall_tilt"] >= tilt.max() - 1e-9
        largest = max(largest, tilt.max())
    assert told["overhang"]["largest_wall_tilt_deg"] == pytest.approx(largest, abs=0.5)
    struts = max(row["strut_tilt"] for row in told["by_layer"])
    assert told["overhang"]["largest_strut_tilt_deg"] == struts > largest
    assert told["wall_length_mm"] == pytest.approx(
        sum(row["wall_length_mm"] for row in told["by_layer"])
    )


def test_what_lies_over_nothing(structure: v3dcad.Structure, told: dict[str, Any]) -> None:
    farthest = unsupported = outside = 0.0
    for below, layer in pairwise(structure.layers):
        area = oracle.area_of(below.section)
        material = shapely.union_all([*walls(below)[1], area.boundary])
        shapely.prepare(material)
        lines = shapely.union_all(walls(layer)[1])
        outside += lines.difference(area).length
        over = lines.intersection(area)
        points = shapely.points(shapely.get_coordinates(over.segmentize(0.02)))
        farthest = max(farthest, shapely.distance(material, points).max())
        unsupported += over.difference(material.buffer(BEAD / 2, quad_segs=64)).length
    certificate = told["overhang"]
    assert farthest > BEAD / 2
    assert farthest <= certificate["largest_distance_mm"] <= 1.02 * farthest + 0.01
    assert certificate["unsupported_wall_mm"] == pytest.approx(unsupported, rel=1e-3)
    assert outside > 10
    assert certificate["walls_outside_section_below_mm"] == pytest.approx(outside, rel=1e-3)
    assert certificate["bead_width_mm"] == BEAD


@pytest.fixture(scope="module")
def foam() -> v3dcad.Structure:
    return widening(cell_size=3.0)


def test_cells_in_the_part(foam: v3dcad.Structure) -> None:
    """Those of any layer, each once, by the oracle's walls and the sites that have one."""
    told = foam.report()
    seen: set[int] = set()
    for layer, row in zip(foam.layers, told["by_layer"], strict=True):
        here = set(np.unique(walls(layer)[0]).tolist())
        assert row["cells"] == pytest.approx(len(here), abs=1), "one may be a sliver"
        seen |= here
    assert told["cells"] == pytest.approx(len(seen), abs=2)
    assert told["most_cells_in_a_layer"] == max(row["cells"] for row in told["by_layer"])
    assert told["most_cells_in_a_layer"] < told["cells"] < told["foam"]["sites"]


def test_cell_size_as_made() -> None:
    """Of a part of many cells it is the size asked for; counting cut cells it would be less."""
    box = np.array([[-30.0, -30, 0], [30, 30, 9]])
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    triangles = np.array([row for a, b, c, d in sides for row in ((a, b, c), (a, c, d))])
    part = (box[0] + corners * (box[1] - box[0]), triangles)
    for settings in ({}, {"stretch": "columns"}, {"max_overhang": 30}):
        foam = v3dcad.fill(part, layer_height=1.0, cell_size=3.0, **settings).report()["foam"]
        assert foam["cell_size_asked_mm"] == 3
        assert foam["cell_size_made_mm"] == pytest.approx(3, rel=0.04)


def test_how_tall_cells_are(foam: v3dcad.Structure) -> None:
    """By scipy's Voronoi cells in the stretched space."""
    from scipy.spatial import Voronoi

    stretch = foam.settings.stretch
    assert isinstance(stretch, float)
    cells = np.unique(np.concatenate([layer.diagram.sites() for layer in foam.layers]))
    diagram = Voronoi(foam.sites / [1, 1, stretch])
    ratios = []
    for site in cells:
        size = np.ptp(diagram.vertices[diagram.regions[diagram.point_region[site]]], axis=0)
        ratios.append(stretch * size[2] / size[:2].mean())
    told = foam.report()["foam"]["height_by_width"]
    assert told == pytest.approx(np.mean(ratios), rel=1e-6)
    assert 1.2 < told < 1.4


def test_the_steepest_wall(structure: v3dcad.Structure, foam: v3dcad.Structure) -> None:
    """By scipy's ridges, of those that meet the part's box; none is missed."""
    for made in (structure, foam):
        told = made.report()["foam"]["steepest_wall"]
        stretch = float(made.settings.stretch)
        space = made.filling.space(0.0, float(made.part.bounds[1, 2])).walls()
        assert told["tilt_deg"] == pytest.approx(space.tilts.max(), abs=1e-9)
        i, j = told["sites"]
        apart = np.abs(made.sites[i] - made.sites[j])
        lean = np.degrees(np.arctan2(apart[2] / stretch**2, np.hypot(*apart[:2])))
        assert told["tilt_deg"] == pytest.approx(lean, abs=1e-6)
    assert told["tilt_deg"] < 45


def test_columns_have_no_height_and_upright_walls() -> None:
    told = widening(cell_size=3.0, stretch="columns").report()["foam"]
    assert told["height_by_width"] is None
    assert told["steepest_wall"] == {"tilt_deg": 0.0, "sites": []}
    assert foam_lines(told)["steepest"] == "every wall is upright"


def test_a_foam_in_two_lines() -> None:
    told = {
        "sites": 9,
        "cell_size_asked_mm": 6.0,
        "cell_size_made_mm": 5.9876,
        "height_by_width": 1.294,
        "steepest_wall": {"tilt_deg": 44.871, "sites": [3, 17]},
    }
    assert foam_lines(told) == {
        "cell size": "6 mm asked, 5.988 mm made, cells 1.29 times as tall as wide",
        "steepest": "wall between sites 3 and 17, 44.87° (certified)",
    }
    given = told | {"cell_size_asked_mm": None, "height_by_width": None}
    assert foam_lines(given)["cell size"] == "5.988 mm made"
    assert "cell size" not in foam_lines(given | {"cell_size_made_mm": None})


def test_the_certificate_in_one_line(told: dict[str, Any]) -> None:
    line = certificate_line(told["overhang"])
    assert "\n" not in line
    for name, form in (
        ("largest_wall_tilt_deg", "walls lean up to {:.1f}°"),
        ("largest_strut_tilt_deg", "struts up to {:.1f}°"),
        ("largest_distance_mm", "rest within {:.3f} mm"),
        ("unsupported_wall_mm", "{:.1f} mm of wall lie farther than half a bead"),
        ("walls_outside_section_below_mm", "{:.1f} mm over the part's own overhang"),
    ):
        assert form.format(told["overhang"][name]) in line
    sound = dict.fromkeys(told["overhang"], 0.0) | {"largest_distance_mm": 0.2}
    assert certificate_line(sound) == (
        "walls lean up to 0.0°, and rest within 0.200 mm: every wall lies within half a bead of "
        "what is below"
    )
