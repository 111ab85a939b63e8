"""What previews show, against the layers, the power of points, scipy and shapely."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np
import pytest
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree
from scipy.spatial import Voronoi

from tests.structure.test_fill import SECTIONS, foam, stack
from tests.view.test_colours import TOGETHER
from v3dcad import FillSettings, PrintSettings, fill_sections
from v3dcad.errors import SettingError
from v3dcad.model import Floats, Layer, Placement
from v3dcad.structure.placement import turned
from v3dcad.toolpath.report import LayerReport
from v3dcad.toolpath.trace import trace
from v3dcad.view.colours import COLOURS
from v3dcad.view.targets.declared import TARGETS
from v3dcad.view.targets.one_layer import _inside
from v3dcad.view.targets.preview import preview
from v3dcad.view.targets.shown import Preview
from v3dcad.view.targets.sizes import QUANTILES, size_distribution
from v3dcad.view.targets.whole import all_edges, full, layer_step, overhang
from v3dcad.words import counted

pytestmark = pytest.mark.slow

SITES = np.random.default_rng(4).uniform([0, 0, -3], [16, 16, 9], (30, 3))
FEW = np.array([[2.0, 2, 1], [14, 12, 2], [10.5, 4, 3]])
STRUCTURES: dict[str, Sequence[Layer]] = {
    name: list(foam(stack(rings, 6, 1.0), FEW if "one cell" in name else SITES).layers)
    for name, rings in SECTIONS.items()
}
STRUCTURES["few in islands"] = list(foam(stack(SECTIONS["islands"], 6, 1.0), FEW).layers)
STRUCTURES["few in a notch"] = list(foam(stack(SECTIONS["notched"], 6, 1.0), FEW).layers)
THESIS = FillSettings(method="thesis", sites=25, layer_height=1.0)
STRUCTURES["thesis"] = list(fill_sections(stack(SECTIONS["hole"], 6, 1.0), None, THESIS).layers)
STILL = Placement.none()
PRINTING = PrintSettings(bead_width=0.3, first_layer_height=1.0)
PRINTED = list(trace(STRUCTURES["hole"], PRINTING))
names = pytest.mark.parametrize("name", STRUCTURES)


def by_role(shown: Preview, *roles: str) -> Floats:
    """(m, 2, 3) the ends of all lines of some roles."""
    return np.concatenate(
        [one.points[one.pairs] for one in shown.lines if not roles or one.role in roles]
    )


def in_order(lines: Floats) -> Floats:
    """Lines in an order that does not depend on which end comes first."""
    return np.array(sorted(sorted(ends) for ends in lines.tolist())).reshape(-1, 2, 3)


def drawn(layer: Layer, which: Any = slice(None)) -> Floats:
    """(m, 2, 3) edges of a layer's diagram."""
    flat = layer.diagram.vertices[layer.diagram.edges[which]]
    return np.concatenate([flat, np.full((*flat.shape[:2], 1), layer.z)], axis=2)


def areas(lines: Floats) -> list[shapely.Polygon]:
    """The areas that lines divide the plane into."""
    return list(shapely.get_parts(shapely.polygonize(shapely.linestrings(lines[:, :, :2]))))


def cells_of(layer: Layer) -> dict[int, shapely.Geometry]:
    """Each cell's area, by asking which site has the least power at a point of each area."""
    sites, weights = layer.state.sites[:, :2], layer.state.weights
    section = reduce(shapely.symmetric_difference, map(shapely.Polygon, layer.section.rings))
    pieces: dict[int, list[shapely.Polygon]] = {}
    for area in areas(drawn(layer)):
        x, y = shapely.get_coordinates(shapely.point_on_surface(area))[0]
        if section.contains(shapely.Point(x, y)):
            owner = int(np.argmin(np.hypot(*(sites - (x, y)).T) ** 2 - weights))
            pieces.setdefault(owner, []).append(area)
    return {owner: shapely.union_all(found) for owner, found in pieces.items()}


def neighbours_of(cells: dict[int, shapely.Geometry], cell: int) -> list[int]:
    """The cells that share a stretch of outline with a cell."""
    here = cells[cell]
    shared = {
        other: shapely.length(shapely.intersection(here.boundary, there.boundary))
        for other, there in cells.items()
        if other != cell
    }
    return sorted(other for other, length in shared.items() if length > 1e-6)


def same_area(one: shapely.Geometry, other: shapely.Geometry) -> bool:
    return float(shapely.area(shapely.symmetric_difference(one, other))) < 1e-9


@names
def test_full_shows_each_edge_of_each_layer_once(name: str) -> None:
    layers = STRUCTURES[name]
    shown = preview("full", layers, STILL)
    inner = [drawn(layer, layer.diagram.inner()) for layer in layers]
    outer = [drawn(layer, ~layer.diagram.inner()) for layer in layers]
    for role, expected in (("wall", inner), ("contour", outer)):
        np.testing.assert_array_equal(
            in_order(by_role(shown, role)), in_order(np.concatenate(expected))
        )
    assert len(np.unique(in_order(by_role(shown)), axis=0)) == len(by_role(shown)) > 0
    edges = all_edges(iter(layers), STILL)
    for layer in layers:
        of = edges.layer == layer.index
        np.testing.assert_array_equal(edges.points[edges.pairs[of]], drawn(layer))
        np.testing.assert_array_equal(edges.sites[of], layer.diagram.edge_sites)
    assert not len(shown.labels.sites) + len(shown.cells)


@names
@pytest.mark.parametrize("index", [0, 3, 5])
def test_a_layer_shows_its_cells_with_their_numbers_inside(name: str, index: int) -> None:
    layer = STRUCTURES[name][index]
    shown = preview("layer", STRUCTURES[name], STILL, index)
    np.testing.assert_array_equal(
        in_order(by_role(shown)), in_order(drawn(layer))
    )  # fmt: skip
    cells = cells_of(layer)
    assert shown.labels.sites.tolist() == shown.cells.tolist() == sorted(cells)
    for site, (x, y, z) in zip(shown.labels.sites.tolist(), shown.labels.points, strict=True):
        assert z == layer.z
        assert shapely.contains_properly(cells[site], shapely.Point(x, y))


@names
def test_the_lines_of_a_cell_close_around_it(name: str) -> None:
    layer = STRUCTURES[name][3]
    for cell, area in cells_of(layer).items():
        shown = preview("cell", STRUCTURES[name], STILL, 3, cell)
        lines = by_role(shown, "cell")
        _, ends = np.unique(lines.reshape(-1, 3), axis=0, return_counts=True)
        assert (ends % 2 == 0).all()
        assert same_area(shapely.union_all(areas(lines)), without_holes(area))
        assert shown.labels.sites.tolist() == [cell]
        assert str(cell) in shown.title


def without_holes(area: shapely.Geometry) -> shapely.Geometry:
    """What lines enclose: polygonize takes the holes of a ring, too."""
    pieces = shapely.get_parts(area)
    return shapely.union_all(shapely.polygons(shapely.get_exterior_ring(pieces)))


@names
def test_neighbours_are_those_that_share_a_stretch_of_outline(name: str) -> None:
    layers = STRUCTURES[name]
    cells = cells_of(layers[3])
    contours = drawn(layers[3], ~layers[3].diagram.inner())
    for cell in cells:
        beside = neighbours_of(cells, cell)
        shown = preview("neighbours", layers, STILL, 3, cell)
        assert shown.labels.sites.tolist() == sorted([cell, *beside])
        assert f"{counted(len(beside), 'neighbour')} of cell {cell}" in shown.title
        np.testing.assert_array_equal(in_order(by_role(shown, "context")), in_order(contours))
        both = [beside, *([one] for one in beside)]
        targets = ["neighbours", *("neighbour" for _ in beside)]
        for target, others in zip(targets, both, strict=True):
            shown = preview(target, layers, STILL, 3, cell, others[0] if others else None)
            assert shown.labels.sites.tolist() == sorted([cell, *others])
            lines = by_role(shown, "cell", "neighbour")
            assert len(np.unique(in_order(lines), axis=0)) == len(lines)
            outlines = shapely.union_all([cells[one].boundary for one in (cell, *others)])
            found = shapely.union_all(shapely.linestrings(lines[:, :, :2]))
            assert shapely.hausdorff_distance(found, outlines) < 1e-9
            own = shapely.union_all(shapely.linestrings(by_role(shown, "cell")[:, :, :2]))
            assert shapely.hausdorff_distance(own, cells[cell].boundary) < 1e-9


@names
def test_the_tree_is_a_minimum_spanning_tree(name: str) -> None:
    for layer in STRUCTURES[name]:
        shown = preview("tree", STRUCTURES[name], STILL, layer.index)
        sites, pairs = layer.state.sites[:, :2], layer.diagram.neighbours
        lengths = np.hypot(*(sites[pairs[:, 0]] - sites[pairs[:, 1]]).T)
        graph = coo_array((lengths, pairs.T), shape=(len(sites), len(sites)))
        least = minimum_spanning_tree(graph.tocsr())
        lines = by_role(shown, "tree")
        assert len(lines) == least.nnz
        assert np.linalg.norm(lines[:, 0] - lines[:, 1], axis=1).sum() == pytest.approx(least.sum())
        assert (lines[:, :, 2] == layer.z).all()
        ends = np.array([np.flatnonzero((sites == at).all(axis=1))[0]
                         for at in lines[:, :, :2].reshape(-1, 2)], int).reshape(-1, 2)  # fmt: skip
        assert set(map(tuple, np.sort(ends).tolist())) <= set(map(tuple, pairs.tolist()))
        tree = coo_array((np.ones(len(ends)), ends.T), shape=graph.shape)
        ours, theirs = (connected_components(one, directed=False)[0] for one in (tree, graph))
        assert ours == theirs
        np.testing.assert_array_equal(in_order(by_role(shown, "context")), in_order(drawn(layer)))


@pytest.mark.parametrize("target", TARGETS)
def test_a_preview_lies_where_the_source_lies(target: str) -> None:
    layers, placement = STRUCTURES["hole"], turned((30.0, 20.0, 10.0))
    cell, neighbour = layers[2].diagram.neighbours[0].tolist()
    shown, bed = (
        preview(target, layers, p, 2, cell, neighbour, PRINTED) for p in (placement, STILL)
    )
    for here, there in zip(shown.lines, bed.lines, strict=True):
        np.testing.assert_allclose(placement.to_bed(here.points), there.points, atol=1e-12)
        np.testing.assert_array_equal(here.pairs, there.pairs)
        np.testing.assert_array_equal(np.unique(here.pairs), np.arange(len(here.points)))
    np.testing.assert_allclose(placement.to_bed(shown.labels.points), bed.labels.points, atol=1e-12)
    plain = [
        one.role for one in (*shown.lines, *shown.marks) if getattr(one, "values", None) is None
    ]
    assert shown.legend == {role: COLOURS[role] for role in plain}
    assert any({one.role for one in shown.lines} <= roles for roles in TOGETHER)


class Counted(Sequence[Layer]):
    """Layers that count how often one is computed."""

    def __init__(self, layers: Sequence[Layer]) -> None:
        self.layers, self.computed = layers, 0

    def __len__(self) -> int:
        return len(self.layers)

    def __getitem__(self, index: Any) -> Any:
        self.computed += 1
        return self.layers[index]


@pytest.mark.parametrize("target", [name for name in TARGETS if "layer" in TARGETS[name].asks])
def test_only_the_layer_that_is_shown_is_computed(target: str) -> None:
    layers = Counted(STRUCTURES["hole"])
    cell, neighbour = layers.layers[2].diagram.neighbours[0].tolist()
    preview(target, layers, STILL, 2, cell, neighbour, PRINTED)
    assert layers.computed == 1


@names
def test_sizes_are_those_of_squares_as_large_as_the_cells(name: str) -> None:
    for layer in STRUCTURES[name]:
        cells = cells_of(layer)
        shown = preview("sizes", STRUCTURES[name], STILL, layer.index)
        areas = shown.areas
        assert areas is not None
        assert shown.scale is not None
        assert areas.sites.tolist() == sorted(cells)
        expected = np.sqrt([cells[site].area for site in areas.sites.tolist()])
        np.testing.assert_allclose(areas.values, expected, rtol=1e-9)
        assert (shown.scale.low, shown.scale.high) == (areas.values.min(), areas.values.max())
        rings = np.split(areas.points, areas.starts[1:-1])
        for row, site in enumerate(areas.sites.tolist()):
            own = [ring for ring, of in zip(rings, areas.of, strict=True) if of == row]
            filled = reduce(shapely.symmetric_difference, (shapely.Polygon(r[:, :2]) for r in own))
            assert same_area(filled, cells[site])
            assert (np.concatenate(own)[:, 2] == layer.z).all()
        np.testing.assert_array_equal(in_order(by_role(shown, "context")), in_order(drawn(layer)))


@names
def test_sizes_over_height_are_those_of_cells_that_no_contour_cuts(name: str) -> None:
    found = size_distribution(iter(STRUCTURES[name]))
    for row, layer in enumerate(STRUCTURES[name]):
        outline = shapely.union_all(shapely.linestrings(drawn(layer, ~layer.diagram.inner())))
        whole = [
            cell.area
            for cell in cells_of(layer).values()
            if shapely.length(shapely.intersection(cell.boundary, outline)) == 0
        ]
        assert found.z[row] == layer.z
        assert found.cells[row] == len(whole)
        expected = np.quantile(whole, QUANTILES) if whole else np.full(len(QUANTILES), np.nan)
        np.testing.assert_allclose(found.areas[row], expected, rtol=1e-9)
        np.testing.assert_allclose(found.sizes[row] ** 2, expected, rtol=1e-9)
    assert found.cells.any() or "few" in name or "one cell" in name


def test_tilts_are_those_of_the_walls_in_space() -> None:
    """Against the normals of Qhull's ridges, in the space where heights are as they are."""
    sites, stretch = SITES, 1.7
    settings = FillSettings(layer_height=1.0, stretch=stretch, max_overhang=90)
    layers = fill_sections(stack(SECTIONS["square"], 6, 1.0), sites, settings).layers
    places = sites / [1, 1, stretch]
    ridges = {}
    found = Voronoi(places)
    for pair, corners in zip(found.ridge_points.tolist(), found.ridge_vertices, strict=True):
        if -1 not in corners:
            a, b, c = found.vertices[corners[:3]] * [1, 1, stretch]
            normal = np.cross(b - a, c - a)
            tilt = np.degrees(np.arctan2(abs(normal[2]), np.hypot(*normal[:2])))
            ridges[tuple(sorted(pair))] = tilt
    snapped = layers[0].state.sites
    order = [int(np.argmin(np.linalg.norm(sites - site, axis=1))) for site in snapped]
    shown = overhang(layers)
    walls = next(one for one in shown.lines if one.values is not None)
    edges = all_edges(layers, STILL)
    inner = edges.sites[:, 0] >= 0
    assert np.isnan(edges.tilts[~inner]).all()
    np.testing.assert_array_equal(walls.values, edges.tilts[inner])
    checked = 0
    for (i, j), tilt in zip(edges.sites[inner].tolist(), edges.tilts[inner], strict=True):
        pair = tuple(sorted((order[i], order[j])))
        if pair in ridges:
            assert tilt == pytest.approx(ridges[pair], abs=1e-3)
            checked += 1
    assert checked > 0.5 * len(edges.tilts[inner]) > 50
    assert shown.scale is not None
    assert shown.scale.high == walls.values.max() > 20
    assert f"up to {shown.scale.high:.1f}°" in shown.title


def test_a_toolpath_is_shown_as_it_is_reported() -> None:
    reports: list[LayerReport] = []
    toolpaths = list(trace(STRUCTURES["hole"], PRINTING, reports.append))
    for report, printed in zip(reports, toolpaths, strict=True):
        shown = preview("toolpath", STRUCTURES["hole"], STILL, report.layer, toolpaths=toolpaths)
        beads, travel = by_role(shown, "bead", "perimeter"), by_role(shown, "travel")
        assert np.linalg.norm(beads[:, 0] - beads[:, 1], axis=1).sum() == pytest.approx(
            report.extruded
        )
        flat = np.linalg.norm((travel[:, 0] - travel[:, 1])[:, :2], axis=1).sum()
        # How the nozzle comes to the first point is not shown.
        assert flat == pytest.approx(report.travelled) or report.layer == 0
        assert f"{printed.volume.sum():.0f} mm³" in shown.title
        (seams,) = shown.marks
        corners = {tuple(at) for at in by_role(shown, "perimeter").reshape(-1, 3).tolist()}
        assert len(seams.points) > 0
        assert {tuple(at) for at in seams.points.tolist()} <= corners
    with pytest.raises(SettingError, match="layer 2: nothing is printed on it"):
        preview("toolpath", STRUCTURES["hole"], STILL, 2, toolpaths=toolpaths[3:])


def test_very_many_lines_are_thinned_by_layers_and_that_is_said() -> None:
    layers = STRUCTURES["hole"]
    lines = sum(len(layer.diagram.edges) for layer in layers)
    assert layer_step(layers) == layer_step([]) == 1
    for made in (full, overhang):
        whole, thinned = made(layers), made(layers, most=lines // 2)
        assert "6 layers" in whole.title
        assert "one in 3 of 6 layers" in thinned.title or "one in 2 of 6" in thinned.title
        heights = np.unique(by_role(thinned)[:, :, 2]).tolist()
        assert heights == [layer.z for layer in layers][:: layer_step(layers, lines // 2)]
        assert len(by_role(thinned)) <= lines // 2 + len(layers[0].diagram.edges)


@pytest.mark.parametrize("target", TARGETS)
def test_in_steps_everything_has_one_colour_and_nothing_is_lost(target: str) -> None:
    layers = STRUCTURES["hole"]
    cell, neighbour = layers[2].diagram.neighbours[0].tolist()
    shown = preview(target, layers, STILL, 2, cell, neighbour, PRINTED)
    steps = shown.stepped()
    lines = np.concatenate([points[pairs] for _, _, points, pairs in steps])
    marks = sum(len(mark.points) for mark in shown.marks)
    outlines = 0 if shown.areas is None else len(shown.areas.points)
    assert len(lines) == len(by_role(shown)) + marks + outlines
    names = [name for name, *_ in steps]
    assert len(set(names)) == len(names)
    for name, colour, points, pairs in steps:
        assert re.fullmatch("#[0-9a-f]{6}", colour)
        if name in COLOURS:
            assert colour == COLOURS[name]
            continue
        assert shown.scale is not None
        low, high = map(float, re.findall(r"[\d.]+", name))
        of = {tuple(sorted(map(tuple, ends))) for ends in points[pairs].tolist()}
        for one in (one for one in shown.lines if one.values is not None):
            for ends, value in zip(one.points[one.pairs].tolist(), one.values, strict=True):
                if tuple(sorted(map(tuple, ends))) in of:
                    assert low * 0.99 - 0.01 <= value <= high * 1.01 + 0.01


def test_a_cell_without_area_is_labelled_where_it_is() -> None:
    np.testing.assert_array_equal(_inside([np.array([[1.0, 2], [3, 4]])]), [1, 2])
    np.testing.assert_array_equal(_inside([np.array([[1.0, 2], [1, 2], [1, 2]])]), [1, 2])


CELLS = STRUCTURES["hole"][2].diagram.sites().tolist()
CELL = CELLS[0]
BESIDE = STRUCTURES["hole"][2].diagram.neighbours.tolist()
APART = next(one for one in CELLS[1:] if [CELL, one] not in BESIDE)


@pytest.mark.parametrize(
    ("asked", "setting", "says"),
    [
        (("moon",), "target", "target moon: give full, layer, cell, neighbours, neighbour, tree"),
        (("layer", -1), "layer", "layer -1: the layers are 0 to 5"),
        (("tree", 6), "layer", "layer 6: the layers are 0 to 5"),
        (("cell", 2), "cell", "no cell is chosen: the cells of layer 2 are "),
        (("cell", 2, -1), "cell", "cell -1: the cells of layer 2 are "),
        (("neighbours", 2, 999), "cell", f"cell 999: the cells of layer 2 are {CELL}, "),
        (
            ("neighbour", 2, CELL),
            "neighbour",
            f"no neighbour is chosen: the neighbours of cell {CELL} on",
        ),
        (("neighbour", 2, CELL, CELL), "neighbour", f"neighbour {CELL}: the neighbours of cell"),
        (("neighbour", 2, CELL, APART), "neighbour", f"neighbour {APART}: the neighbours of cell"),
    ],
)
def test_what_is_not_there_is_told_with_what_is(asked: Any, setting: str, says: str) -> None:
    target, *which = asked
    with pytest.raises(SettingError) as caught:
        preview(target, STRUCTURES["hole"], STILL, *which)
    assert caught.value.name == setting
    assert says in str(caught.value)
    assert len(str(caught.value)) < 200


def test_a_cell_alone_has_no_neighbours() -> None:
    layers = STRUCTURES["in one cell"]
    (cell,) = layers[0].diagram.sites().tolist()
    assert len(by_role(preview("neighbours", layers, STILL, 0, cell), "neighbour")) == 0
    with pytest.raises(SettingError, match=f"the neighbours of cell {cell} on layer 0 are none"):
        preview("neighbour", layers, STILL, 0, cell, cell + 1)


def test_many_cells_are_told_by_their_first() -> None:
    layers = STRUCTURES["hole"]
    with pytest.raises(SettingError, match=rf" {CELLS[11]} and {len(CELLS) - 12} more$"):
        preview("cell", layers, STILL, 2, -1)
    few = STRUCTURES["few in islands"]
    cells = few[2].diagram.sites().tolist()
    with pytest.raises(SettingError, match=f" are {', '.join(map(str, cells))}$"):
        preview("cell", few, STILL, 2, -1)


def test_a_cut_shows_where_the_part_begins_and_ends() -> None:
    layers = STRUCTURES["hole"]
    span = 0.4, -0.1
    for some in (layers, layers[:1]):
        ends = [
            drawn(layer, ~layer.diagram.inner()) + np.array([0, 0, above])
            for layer, above in ((some[0], -0.1), (some[-1], 0.3))
        ]
        shown = preview("cut", some, STILL, span=span)
        expected = in_order(np.concatenate(ends))
        np.testing.assert_allclose(in_order(by_role(shown, "context")), expected, atol=1e-12)
