"""Whether rings bound a section is decided by winding numbers, which GEOS's faces tell too."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests.oracle import faces, windings
from tests.regions import region
from v3dcad.errors import GeometryError
from v3dcad.geometry.clipping.ring_validity import winding_fault
from v3dcad.model import Section
from v3dcad.settings import FillSettings
from v3dcad.structure.fill import fill_sections

SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
SMALL = SQUARE / 2 + 1
ASIDE = np.array([2.0, 0])


def fault(rings):
    starts = np.cumsum([0, *map(len, rings)])
    layer, x, y = winding_fault(np.concatenate(rings), starts, np.array([0, len(rings)]))
    return None if layer < 0 else (x, y)


def wrongly_wound(rings):
    """The faces between rings around which they wind neither 0 times nor once."""
    between = faces(rings)
    inside = shapely.get_coordinates(shapely.point_on_surface(between))
    return between[~np.isin(windings(rings, inside), (0, 1))] if len(between) else between


@st.composite
def any_rings(draw):
    """Rings on a coarse grid, which cross, touch and overlap in every way; some bound a region."""
    random = np.random.default_rng(draw(st.integers(0, 10**6)))
    kind = draw(st.sampled_from(["loose", "region", "region changed"]))
    if kind == "loose":
        counts = draw(st.lists(st.integers(3, 6), min_size=1, max_size=3))
        return [random.integers(0, 5, (count, 2)).astype(float) for count in counts]
    rings = region(random, 5)
    if kind == "region changed":
        which = random.integers(len(rings))
        change = draw(st.sampled_from(["reversed", "twice", "moved", "corner"]))
        if change == "reversed":
            rings[which] = rings[which][::-1]
        elif change == "twice":
            rings.append(rings[which])
        elif change == "moved":
            rings[which] = rings[which] + random.integers(-1, 2, 2)
        else:
            ring = rings[which].copy()
            ring[random.integers(len(ring))] += random.integers(-1, 2, 2)
            rings[which] = ring
    return rings


def crossings(rings):
    """Where two segments cross in the insides of both."""
    ends = np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings])
    lines = shapely.linestrings(ends)
    i, j = np.triu_indices(len(lines), 1)
    crossed = shapely.crosses(lines[i], lines[j])
    return shapely.intersection(lines[i[crossed]], lines[j[crossed]])


@given(any_rings(), st.floats(0, 6.3), st.sampled_from([1e-6, 1.0, 1e3]))
def test_a_fault_is_where_rings_wind_neither_0_times_nor_once(rings, angle, scale):
    """Or cross, though nothing need be wrong where a spike of no area crosses."""
    wrong = wrongly_wound(rings)
    around = shapely.union_all([*wrong, *crossings(rings)])
    turn = scale * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    for way in np.eye(2), turn, -np.eye(2):
        found = fault([np.ascontiguousarray(ring @ way + 0.1 * scale) for ring in rings])
        if len(wrong):
            assert found is not None
        if found is not None:
            x, y = (np.array(found) - 0.1 * scale) @ np.linalg.inv(way)
            assert shapely.distance(around, shapely.Point(x, y)) < 1e-6


@given(st.integers(0, 10**6), st.sampled_from([0, 1e-13, 1e-12]), st.floats(0, 6.3))
def test_rounding_is_no_fault(seed, share, angle):
    """Nor are points where rings touch, corners that come twice and spikes that go to and fro."""
    random = np.random.default_rng(seed)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    rings = []
    for ring in region(random, 6):
        points = np.repeat(ring, random.integers(1, 3, len(ring)), axis=0)
        place = random.integers(len(points))
        spike = [points[place], points[place] + random.uniform(-0.2, 0.2, 2)]
        points = np.insert(points, [place, place], spike, axis=0)
        rings.append(points @ turn + random.uniform(-6, 6, points.shape) * share)
    assert fault(rings) is None


@pytest.mark.parametrize(
    "rings",
    [
        pytest.param([[[0, 0], [4, 4], [4, 0], [0, 4]]], id="bow-tie"),
        pytest.param([[[0, 0], [2, 2], [0, 4], [4, 4], [2, 2], [4, 0]]], id="crossing in a corner"),
        pytest.param([SQUARE[::-1]], id="clockwise"),
        pytest.param([SQUARE, SQUARE], id="twice"),
        pytest.param([SQUARE, SMALL], id="hole counter-clockwise"),
        pytest.param([SQUARE, SMALL[::-1] + 8], id="hole outside"),
        pytest.param([SQUARE, SQUARE + ASIDE], id="overlapping along a side"),
        pytest.param([SQUARE, SMALL[::-1] + ASIDE], id="hole across"),
        pytest.param([SQUARE, SMALL[::-1], SMALL[::-1] + 0.5], id="holes overlapping"),
    ],
)
def test_faulty_sections_are_named_whatever_the_sites(rings):
    rings = tuple(np.array(ring, np.float64) for ring in rings)
    wrong = shapely.union_all(wrongly_wound(rings))
    sections = [Section(0.0, (SQUARE,)), Section(1.0, rings)]
    told = set()
    for seed in range(6):
        sites = np.random.default_rng(seed).uniform(-1, 9, (2 + 3 * seed, 2))
        with pytest.raises(GeometryError, match=r"layer 1: its rings .* near \(.*\) mm") as caught:
            list(fill_sections(sections, sites, FillSettings()).layers)
        told.add(str(caught.value))
    assert len(told) == 1
    x, y = (float(number) for number in told.pop().split("(")[1].split(")")[0].split(","))
    assert shapely.distance(wrong, shapely.Point(x, y)) < 1e-5
