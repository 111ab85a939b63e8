"""The vertical cut against the walls in space, sliced by the plane, and against the part."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from tests.diagrams import square
from tests.structure.test_fill import foam, stack
from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Floats
from v3dcad.structure.fill import Filling
from v3dcad.structure.walls import Walls
from v3dcad.view.vertical_cut import VerticalCut, vertical_cut

pytestmark = pytest.mark.slow

STEP = 0.4
HALF, HOLE, HEIGHT = 10.0, 3.0, 12.0
LEVELS = np.arange(31) * STEP
SITES = np.random.default_rng(8).uniform([-12, -12, -4], [12, 12, 16], (120, 3))


def filling(sections: list[Section], **settings: object) -> Filling:
    made = fill_sections(sections, None, FillSettings(layer_height=STEP, cell_size=4, **settings))
    assert isinstance(made, Filling)
    return made


HOLED = filling([square(HALF, z, HOLE) for z in LEVELS])
PYRAMID = filling([square(HALF - z / 2, z) for z in LEVELS])
COLUMNS = filling([square(HALF, z) for z in LEVELS], stretch="columns")
GIVEN = foam([square(HALF, z) for z in LEVELS], SITES, layer_height=STEP)
FILLINGS = {"holed": HOLED, "pyramid": PYRAMID, "columns": COLUMNS, "given": GIVEN}


def sliced(walls: Walls, y: float) -> list[tuple[Floats, Floats]]:
    """The straight lines in which walls cross a vertical plane: (x, z) of their ends, lower first.

    Each side of each polygon is asked by itself on which sides of the plane its ends lie.
    """
    found = []
    for start, stop in zip(walls.starts[:-1], walls.starts[1:], strict=True):
        corners = walls.points[start:stop]
        ends = []
        for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if (one[1] - y) * (other[1] - y) < 0:
                at = one + (y - one[1]) / (other[1] - one[1]) * (other - one)
                ends.append(at[[0, 2]])
        if len(ends) == 2 and ends[0][1] != ends[1][1]:
            low, high = sorted(ends, key=lambda at: at[1])
            found.append((low, high))
    return found


def in_part(name: str, x: float, y: float, z: float) -> float:
    """How far inside the part a point lies at its height, mm; below 0 outside."""
    reach = max(abs(x), abs(y))
    half = HALF - z / 2 if name == "pyramid" else HALF
    return min(half - reach, reach - HOLE) if name == "holed" else half - reach


def lines_of(cut: VerticalCut, pairs: np.ndarray) -> Floats:
    """(m, 2, 2) x and z of the ends of lines, the lower first."""
    return cut.points[pairs][:, :, [0, 2]]


@pytest.mark.parametrize("y", [0.0, 1.234, -7.3, 4.0])
@pytest.mark.parametrize("name", FILLINGS)
def test_walls_are_where_the_plane_cuts_those_in_space(name: str, y: float) -> None:
    """A wall that passes two layers inside the part is drawn between them, and no other."""
    layers = list(FILLINGS[name].layers)
    cut = vertical_cut(iter(layers), y)
    found = {tuple(np.round(line.ravel(), 3).tolist()): line for line in lines_of(cut, cut.walls)}
    assert len(found) == len(cut.walls) > 40
    near = 1e-4
    sure: list[Floats] = []
    perhaps: list[Floats] = []
    for low, high in sliced(FILLINGS[name].walls, y):
        for below, above in pairwise(layers):
            zs = np.array([below.z, above.z])
            if zs[0] < low[1] - near or zs[1] > high[1] + near:
                continue
            x = low[0] + (zs - low[1]) / (high[1] - low[1]) * (high[0] - low[0])
            inside = min(in_part(name, x[k], y, zs[k]) for k in range(2))
            if inside > -near:
                clear = inside > near and zs[0] > low[1] + near and zs[1] < high[1] - near
                (sure if clear else perhaps).append(np.column_stack([x, zs]))
    every = lines_of(cut, cut.walls).reshape(-1, 4)
    for line in sure:
        assert np.abs(every - line.ravel()).max(axis=1).min() < 1e-5
    possible = np.reshape([*sure, *perhaps], (-1, 4))
    for line in every:
        assert np.abs(possible - line).max(axis=1).min() < 1e-5
    assert len(sure) > 0.8 * len(every)
    assert (cut.points[:, 1] == y).all()


@pytest.mark.parametrize(
    ("name", "y", "edges"),
    [
        ("holed", 0.0, [(-HALF, 0), (-HOLE, 0), (HOLE, 0), (HALF, 0)]),
        ("holed", 5.0, [(-HALF, 0), (HALF, 0)]),
        ("pyramid", 0.0, [(-HALF, 0.5), (HALF, -0.5)]),
    ],
)
def test_contours_are_the_outline_of_the_part(
    name: str, y: float, edges: list[tuple[float, float]]
) -> None:
    cut = vertical_cut(FILLINGS[name].layers, y)
    found = lines_of(cut, cut.contours)
    assert len(found) == len(edges) * (len(LEVELS) - 1)
    expected = [
        [[x + slope * z, z], [x + slope * (z + STEP), z + STEP]]
        for z in LEVELS[:-1]
        for x, slope in edges
    ]
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_by_default_it_goes_through_the_middle_of_the_bed() -> None:
    for one, other in zip(vertical_cut(HOLED.layers), vertical_cut(HOLED.layers, 0.0), strict=True):
        np.testing.assert_array_equal(one, other)


def test_contours_end_where_a_tower_does() -> None:
    towers = (square(2.0).rings[0] - [5, 0], square(2.0).rings[0] + [5, 0])
    sections = [*stack(towers, 3, 1.0), Section(3.0, towers[:1]), Section(4.0, towers[:1])]
    cut = vertical_cut(foam(sections, SITES, layer_height=1.0).layers)
    found = lines_of(cut, cut.contours)
    of_both = [(x, z) for z in (0, 1) for x in (-7, -3, 3, 7)]
    of_one = [(x, 3) for x in (-7, -3)]
    np.testing.assert_allclose(found[:, 0], [*of_both, *of_one], atol=1e-9)


def test_beside_the_part_there_is_nothing() -> None:
    cut = vertical_cut(HOLED.layers, 50.0)
    assert len(cut.points) + len(cut.walls) + len(cut.contours) == 0
