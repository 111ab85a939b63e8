"""Distances from triangles are those that OCCT finds."""

from __future__ import annotations

import numpy as np
import pytest
from occt import distance_to
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
from OCP.gp import gp_Pnt

from v3dcad.geometry.mesh.distance import distances, triangle_tree
from v3dcad.model import Floats


def occt_distance(place: Floats, corners: Floats) -> float:
    """From the nearest of some triangles (t, 3, 3)."""

    def face(triangle: Floats) -> object:
        polygon = BRepBuilderAPI_MakePolygon(*(gp_Pnt(*p) for p in triangle.tolist()), True)
        return BRepBuilderAPI_MakeFace(polygon.Wire()).Face()

    return min(distance_to(place, face(triangle)) for triangle in corners)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 13])
def test_random_triangles(count: int) -> None:
    random = np.random.default_rng(count)
    corners = random.normal(size=(count, 3, 3)) * [9, 3, 1]
    places = random.normal(size=(12, 3)) * 9
    found = distances(triangle_tree(corners), places)
    wanted = [occt_distance(place, corners) for place in places]
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)


def test_slivers_and_points() -> None:
    """Of a triangle without area the sides are left, of one without length a point."""
    random = np.random.default_rng(1)
    corners = random.normal(size=(30, 3, 3))
    corners[:10, 2] = corners[:10, :2].mean(axis=1) + random.normal(size=(10, 3)) * 1e-13
    corners[10:20, 2] = corners[10:20, 1]
    corners[20:] = corners[20:, :1]
    places = random.normal(size=(40, 3)) * 2
    start, along = corners[:, 0], corners[:, 1] - corners[:, 0]
    away = places[:, None] - start
    squares = (along**2).sum(axis=1)
    share = np.divide((away * along).sum(axis=2), squares, where=squares > 0, out=0 * away[..., 0])
    rest = away - np.clip(share, 0, 1)[..., None] * along
    for one in range(len(corners)):
        found = distances(triangle_tree(corners[one : one + 1]), places)
        np.testing.assert_allclose(found, np.linalg.norm(rest[:, one], axis=1), atol=1e-12)
    found = distances(triangle_tree(corners), places)
    np.testing.assert_allclose(found, np.linalg.norm(rest, axis=2).min(axis=1), atol=1e-12)


def test_the_order_of_triangles_does_not_matter() -> None:
    random = np.random.default_rng(2)
    corners = random.normal(size=(500, 3, 3)) * 0.1 + random.normal(size=(500, 1, 3))
    places = random.normal(size=(200, 3)) * 2
    found = distances(triangle_tree(corners), places)
    shuffled = distances(triangle_tree(random.permutation(corners)), places)
    one_by_one = [distances(triangle_tree(corners[k : k + 1]), places) for k in range(500)]
    np.testing.assert_array_equal(found, shuffled)
    np.testing.assert_array_equal(found, np.min(one_by_one, axis=0))
