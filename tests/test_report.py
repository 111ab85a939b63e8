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
from v3dcad.report import certificate_line

pytestmark = pytest.mark.slow

BEAD = 0.8

LOW, HIGH = 10.0, 12.0


@pytest.fixture(scope="module")
def structure() -> v3dcad.Structure:
    """A block that widens from 20 to 24 mm over 12 mm of height, filled with a steep limit."""
    corners = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    rings = [np.column_stack([half * corners, np.full(4, z)]) for half, z in ((LOW, 0), (HIGH, 12))]
    sides = [
        triangle
        for k in range(4)
        for triangle in ([k, (k + 1) % 4, 4 + (k + 1) % 4], [k, 4 + (k + 1) % 4, 4 + k])
    ]
    triangles = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], *sides]
    return v3dcad.fill(
        (np.concatenate(rings), np.array(triangles)), sites=25, layer_height=0.5, max_overhang=75.0
    )


@pytest.fixture(scope="module")
def told(structure: v3dcad.Structure) -> dict[str, Any]:
    return structure.report(v3dcad.PrintSettings(bead_width=BEAD))


def walls(layer: Layer) -> tuple[Floats, list[shapely.Geometry]]:
    """Pairs of sites and the walls between them, but for those shorter than newborns' are."""
    state, area = layer.state, oracle.area_of(layer.section)
    diagram = oracle.power_diagram(state.sites, state.weights)
    pairs, edges = oracle.power_edges(len(state.sites), *diagram)
    pairs, lines = oracle.cut_edges(area, pairs, edges)
    kept = shapely.length(lines) > 1e-6
    return pairs[kept], lines[kept]


def test_births_are_the_sites_that_were_not_there_before(
    structure: v3dcad.Structure, told: dict[str, Any]
) -> None:
    expected = [
        {"layer": layer.index, "site": site}
        for below, layer in pairwise(structure.layers)
        for site in range(len(below.state.sites), len(layer.state.sites))
    ]
    assert len(expected) > 5
    assert told["births"] == expected


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
        shift = np.abs(state.growth[one] - state.growth[other]) * 0.5
        apart = np.hypot(*(state.sites[one] - state.sites[other]).T)
        tilt = np.degrees(np.arctan2(shift, 2 * apart * 0.5))
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
