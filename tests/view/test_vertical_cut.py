"""The vertical cut against the walls in space, sliced by the plane, and against the part."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

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


def lines_of(cut: VerticalCut, pairs: np.ndarray) -> Floats:
    """(m, 2, 2) x and z of the ends of lines, the lower first."""
    return cut.points[pairs][:, :, [0, 2]]


@pytest.mark.parametrize("y", [0.0, 1.234, -7.3, 4.0])
@pytest.mark.parametrize("name", FILLINGS)
def test_walls_are_where_the_plane_cuts_those_in_space(name: str, y: float) -> None:
    """Every line is a piece of a wall's, and nearly all of the walls in the part are drawn."""
    cut = vertical_cut(iter(FILLINGS[name].layers), y)
    every = shapely.linestrings(lines_of(cut, cut.walls))
    straight = [np.array([low, high]) for low, high in sliced(FILLINGS[name].walls, y)]
    walls = shapely.intersection(shapely.linestrings(straight), outline(name, y))
    there = shapely.union_all(walls)
    beyond = shapely.length(shapely.difference(every, there.buffer(1e-4)))
    assert len(every) > 40
    assert beyond.max() < STEP / 2  # only because of cells that lie between two layers
    assert beyond.sum() < 0.005 * shapely.length(every).sum()
    missed = shapely.length(shapely.difference(there, shapely.union_all(every).buffer(1e-4)))
    assert missed < 0.01 * shapely.length(there)
    assert (cut.points[:, 1] == y).all()


def outline(name: str, y: float) -> shapely.Geometry:
    """The part in the plane, from its first section to its last: x and z."""
    top = LEVELS[-1]
    narrow = HALF - top / 2 if name == "pyramid" else HALF
    part = shapely.polygons([(-HALF, 0), (HALF, 0), (narrow, top), (-narrow, top)])
    if name == "pyramid":
        part = part.intersection(shapely.box(-HALF, 0, HALF, 2 * (HALF - abs(y))))
    hole = shapely.box(-HOLE, -1, HOLE, top + 1)
    return part.difference(hole) if name == "holed" and abs(y) < HOLE else part


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
    both, one = (-7.0, -3.0, 3.0, 7.0), (-7.0, -3.0)
    levels = {(0, 1): both, (1, 2): both, (2, 2.5): both, (2.5, 3): one, (3, 4): one}
    expected = [[[x, z] for z in ends] for ends, places in levels.items() for x in places]
    shelf = [[3.0, 2.5], [7.0, 2.5]]
    drawn = np.array(sorted(found.round(9).tolist()))
    np.testing.assert_allclose(drawn, sorted([*expected, shelf]), atol=1e-9)


def test_beside_the_part_there_is_nothing() -> None:
    cut = vertical_cut(HOLED.layers, 50.0)
    assert len(cut.points) + len(cut.walls) + len(cut.contours) == 0


@pytest.mark.parametrize("name", ["holed", "pyramid"])
def test_layers_are_drawn_from_their_lower_to_their_upper_ends(name: str) -> None:
    """From the middle of the first layer down, from that of the last one up, as all goes on."""
    layers = [layer for layer in FILLINGS[name].layers if 0 < layer.index < 30]
    whole = vertical_cut(FILLINGS[name].layers)
    cut = vertical_cut(layers, span=(2 * STEP, -STEP))
    for drawn, expected in ((cut.walls, whole.walls), (cut.contours, whole.contours)):
        one, other = (
            shapely.union_all(shapely.linestrings(lines_of(of, pairs)))
            for of, pairs in ((cut, drawn), (whole, expected))
        )
        assert shapely.hausdorff_distance(one, other) < 0.3
        assert shapely.length(shapely.difference(other, one.buffer(1e-4))) < 0.02 * one.length
    heights = cut.points[:, 2]
    assert heights.min() == pytest.approx(LEVELS[0], abs=1e-9)
    assert heights.max() == pytest.approx(LEVELS[-1], abs=1e-9)
