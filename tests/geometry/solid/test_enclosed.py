"""Which walls and cells of a foam lie inside a surface, by closed forms and by scipy."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from trimesh.creation import annulus, box, icosphere, torus

from tests.geometry.voronoi import oracle
from v3dcad.geometry.solid.enclosed import (
    INSIDE,
    NEAR,
    OUTSIDE,
    cell_walls,
    sides_of,
    volumes_and_middles,
    whole_cells,
    winding_numbers,
)
from v3dcad.geometry.solid.facets import Facets, welded_facets
from v3dcad.geometry.voronoi.walls import walls_in_box
from v3dcad.model import Floats, Mesh

LOW, HIGH = np.full(3, -12.0), np.full(3, 12.0)
MARGIN = 0.1


def scattered(count: int, seed: int) -> Floats:
    return np.random.default_rng(seed).uniform(1.3 * LOW, 1.3 * HIGH, (count, 3))


def foam(places: Floats) -> Facets:
    return welded_facets(*walls_in_box(places, LOW, HIGH))


def surface(*bodies: trimesh.Trimesh) -> Mesh:
    whole = trimesh.util.concatenate(bodies)
    return Mesh(np.array(whole.vertices), np.array(whole.faces, np.int64))


def hollow(body: trimesh.Trimesh) -> trimesh.Trimesh:
    """The same surface turned inside out."""
    body.invert()
    return body


def corners_of(walls: Facets, wall: int) -> Floats:
    return walls.points[walls.corners[walls.starts[wall] : walls.starts[wall + 1]]]


@settings(max_examples=5)
@given(st.integers(0, 10**6))
def test_walls_in_and_outside_of_a_ball(seed: int) -> None:
    """A polygon lies in a ball where its corners do; outside where its nearest point does."""
    walls = foam(scattered(400, seed))
    ball = icosphere(subdivisions=4, radius=9.0)
    inner = float(np.linalg.norm(ball.triangles_center, axis=1).min())
    sides = sides_of(walls, surface(ball), MARGIN)
    for wall, side in enumerate(sides):
        corners = corners_of(walls, wall)
        farthest = np.linalg.norm(corners, axis=1).max()
        # Points of the wall: combinations of its corners.
        weights = np.random.default_rng(wall).dirichlet(np.full(len(corners), 0.5), 60)
        nearest = np.linalg.norm(np.vstack([corners, weights @ corners]), axis=1).min()
        if side == INSIDE:
            assert farthest < 9.0 - MARGIN / 2
        if side == OUTSIDE:
            assert nearest > inner + MARGIN / 2
        if farthest < inner - 3 * MARGIN:
            assert side == INSIDE


PARTS = {
    "box": (
        lambda: box((21.0, 14.0, 9.0)),
        lambda x, y, z, r: (abs(x) < 10.5) & (abs(y) < 7) & (abs(z) < 4.5),
    ),
    "pipe": (
        lambda: annulus(5.0, 10.0, 16.0, sections=48),
        lambda x, y, z, r: (r > 5) & (r < 10) & (abs(z) < 8),
    ),
    "torus": (
        lambda: torus(8.0, 3.0, major_sections=64, minor_sections=32),
        lambda x, y, z, r: np.hypot(r - 8, z) < 3,
    ),
    "void": (
        lambda: trimesh.util.concatenate([box((18.0, 18.0, 18.0)), hollow(icosphere(3, 5.0))]),
        lambda x, y, z, r: (
            (np.maximum(np.maximum(abs(x), abs(y)), abs(z)) < 9) & (np.hypot(r, z) > 5)
        ),
    ),
}


@pytest.mark.parametrize("name", PARTS)
def test_whole_cells_lie_inside(name: str) -> None:
    part, contains = PARTS[name][0](), PARTS[name][1]
    places = scattered(4000, 3)
    walls, skin = foam(places), surface(part)
    sides = sides_of(walls, skin, MARGIN)
    assert set(np.unique(sides)) == {INSIDE, NEAR, OUTSIDE}
    cells = whole_cells(walls, sides == INSIDE, skin)
    assert len(cells.sites) > 20
    volumes, middles = volumes_and_middles(walls, cells)
    assert volumes == pytest.approx(oracle.volumes(places, cells.sites), rel=1e-9)
    nearest = np.linalg.norm(middles[:, None] - places, axis=2).argmin(axis=1)
    assert nearest.tolist() == cells.sites.tolist()
    samples = np.vstack([corners_of(walls, wall) for wall in np.unique(cells.walls)])
    assert contains(*samples.T, np.hypot(*samples[:, :2].T)).all()
    # And no more cells are left to be cut than come near the surface.
    every = cell_walls(walls)
    for cell in np.flatnonzero(~np.isin(every.sites, cells.sites)):
        own = every.walls[every.starts[cell] : every.starts[cell + 1]]
        assert (sides[own] != INSIDE).any()


def test_a_void_within_one_cell_makes_it_no_whole_one() -> None:
    places = scattered(300, 5)
    walls, block = foam(places), box((20.0, 20.0, 20.0))
    cells = whole_cells(walls, sides_of(walls, surface(block), MARGIN) == INSIDE, surface(block))
    volumes, middles = volumes_and_middles(walls, cells)
    largest = int(np.argmax(volumes))
    for inside, at in ((True, middles[largest]), (False, np.array([10.6, 0, 0]))):
        void = icosphere(2, 0.3)
        void.apply_translation(at)
        skin = surface(block, hollow(void))
        sides = sides_of(walls, skin, MARGIN)
        left = whole_cells(walls, sides == INSIDE, skin)
        lost = np.setdiff1d(cells.sites, left.sites).tolist()
        assert lost == ([int(cells.sites[largest])] if inside else [])


def test_open_cells_are_not_whole() -> None:
    """Where the box around the foam cuts them, though the surface is far outside."""
    walls = foam(scattered(400, 7))
    far = surface(box((90.0, 90.0, 90.0)))
    sides = sides_of(walls, far, MARGIN)
    assert (sides == INSIDE).all()
    cells = whole_cells(walls, sides == INSIDE, far)
    assert 0 < len(cells.sites) < len(cell_walls(walls).sites)
    for cell in range(len(cells.sites)):
        own = cells.walls[cells.starts[cell] : cells.starts[cell + 1]]
        corners = np.vstack([corners_of(walls, wall) for wall in own])
        assert (corners > LOW + 1e-9).all()
        assert (corners < HIGH - 1e-9).all()


def test_winding_numbers_of_nested_surfaces() -> None:
    skin = surface(box((8.0, 8.0, 8.0)), hollow(box((4.0, 4.0, 4.0))), box((2.0, 2.0, 2.0)))
    points = np.array([[0.1, 0.2, 0.3], [1.5, 0.1, 0], [3.0, 0.5, 0.2], [5.0, 0, 0.1]])
    assert winding_numbers(points, skin) == pytest.approx([1, 0, 1, 0], abs=1e-12)
