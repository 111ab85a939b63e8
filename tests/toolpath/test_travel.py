from __future__ import annotations

import numpy as np
import pytest
import shapely
from diagrams import disc, square
from scipy.sparse.csgraph import dijkstra

from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Section
from v3dcad.toolpath.travel import Traveller


def length(start: Floats, way: Floats) -> float:
    return float(np.hypot(*np.diff(np.vstack([start, way]), axis=0).T).sum())


def test_a_clear_way_is_straight() -> None:
    way = Traveller(section_area(square(10)), 0.2).way(np.array([-9.0, -9]), np.array([9.0, 3]))
    assert way.tolist() == [[9, 3]]


def test_around_a_square_hole() -> None:
    area = section_area(square(10, hole=5))
    start, stop = np.array([-8.0, 0]), np.array([8.0, 0])
    way = Traveller(area, 0.2).way(start, stop)
    assert area.covers(shapely.LineString(np.vstack([start, way])))
    least = 2 * np.hypot(3, 5) + 10
    assert least < length(start, way) < least + 1


def test_around_a_round_hole_with_many_points() -> None:
    area = section_area(Section(0.0, (square(20).rings[0], disc(10, points=720).rings[0][::-1])))
    start, stop = np.array([-15.0, 0]), np.array([15.0, 0.0])
    way = Traveller(area, 0.2).way(start, stop)
    assert area.covers(shapely.LineString(np.vstack([start, way])))
    tangent = np.sqrt(15**2 - 10**2)
    least = 2 * tangent + 10 * (np.pi - 2 * np.arccos(10 / 15))
    assert least < length(start, way) < 1.03 * least


@pytest.mark.parametrize("stop", [(30.0, 0.0), (0.0, 0.0)])
def test_straight_where_there_is_no_way(stop: tuple[float, float]) -> None:
    island = Section(
        0.0, (square(10, hole=5).rings[0], square(10, hole=5).rings[1], square(2).rings[0])
    )
    way = Traveller(section_area(island), 0.2).way(np.array([-8.0, 0]), np.array(stop))
    assert way.tolist() == [list(stop)]


def test_the_way_is_the_shortest_there_is() -> None:
    """Against Dijkstra's over all pairs of corners that see each other."""
    holes = [shapely.box(x, y, x + 3, y + 5) for x in range(2, 40, 5) for y in range(2, 40, 7)]
    area = shapely.box(0, 0, 45, 45) - shapely.union_all(holes)
    start, stop = np.array([0.5, 1.0]), np.array([43.0, 44.5])
    way = Traveller(area, 0.2).way(start, stop)
    drawn_in = shapely.box(0, 0, 45, 45) - shapely.union_all(
        [hole.buffer(0.2, join_style="mitre") for hole in holes]
    )
    corners = np.unique(shapely.get_coordinates(drawn_in), axis=0)
    points = np.vstack([start, stop, corners])
    lines = np.stack(
        [points[:, None].repeat(len(points), 1), points[None].repeat(len(points), 0)], 2
    )
    seen = shapely.covers(area, shapely.linestrings(lines))
    lengths = np.where(seen, np.hypot(*np.moveaxis(lines[:, :, 1] - lines[:, :, 0], 2, 0)), 0)
    assert area.covers(shapely.LineString(np.vstack([start, way])))
    assert length(start, way) == pytest.approx(dijkstra(lengths, indices=0)[1], abs=1e-9)
