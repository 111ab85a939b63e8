"""Neither a triangulation built afresh on the way up nor a want of room can be seen afterwards."""

from typing import Any

import numpy as np
import pytest

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.model import Floats, Layer
from v3dcad.structure.sweep import kinetic_sweep as course
from v3dcad.structure.sweep.layer_loop import run, walks

SQUARE = np.array([[0.0, 0], [40, 0], [40, 40], [0, 40]])
SITES = np.random.default_rng(3).random((40, 2)) * 40
JAMS = (7, 8, 30)


LATTICE = np.stack(np.meshgrid(*[np.linspace(2, 38, 6)] * 2), axis=-1).reshape(-1, 2)
"""Two holes between each four, of which only one may have a newborn."""


def filled(widening: float, insertion: bool, sites: Floats = SITES) -> Any:
    sections = [
        Section(0.4 * k, (SQUARE * (1 + widening * k) - 20 * k * widening,)) for k in range(60)
    ]
    return fill_sections(
        sections,
        sites,
        FillSettings(layer_height=0.4, offset=4.0, max_overhang=90.0, insertion=insertion),
    )


def lines(layer: Layer) -> set[tuple[Any, ...]]:
    """The layer's edges with their cells, however they are numbered."""
    ends = np.round(layer.diagram.vertices[layer.diagram.edges], 7) + 0.0
    return {
        (*sorted(map(tuple, edge)), *cells)
        for edge, cells in zip(
            ends.tolist(), np.sort(layer.diagram.edge_sites).tolist(), strict=True
        )
    }


@pytest.mark.parametrize(("widening", "insertion"), [(0.0, True), (0.01, True), (0.0, False)])
def test_a_jam_does_not_show(
    widening: float, insertion: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = filled(widening, insertion)
    layers, facets = list(expected.layers), expected.walls
    assert (len(expected.births) > 3) == insertion
    jammed: list[int] = []
    made = 0

    def jamming(*given: Any) -> None:
        """The compiled loop, which now and then says that it is jammed before a layer."""
        nonlocal made
        times, found = given[9], given[11]
        stops = [
            jam - made for jam in JAMS if jam not in jammed and made <= jam < made + len(times)
        ]
        some = min(stops, default=len(times))
        run(*given[:9], times[:some], *given[10:])
        made += int(found.outcome.layers)
        if stops and found.outcome.ending == Ending.DONE:
            found.outcome.ending = Ending.NO_FLIP
            jammed.append(made)

    monkeypatch.setattr(course, "run", jamming)
    filling = filled(widening, insertion)
    found = list(filling.layers)
    assert jammed == list(JAMS)
    for before, after in zip(layers, found, strict=True):
        assert lines(after) == lines(before)
        assert after.area_per_cell == before.area_per_cell
        tree = {tuple(sorted(pair)) for pair in after.tree.tolist()}
        assert tree == {tuple(sorted(pair)) for pair in before.tree.tolist()}
    np.testing.assert_array_equal(filling.births, expected.births)
    # Struts and facets are cut in two where the jams are, and no more.
    assert area(filling.walls) == pytest.approx(area(facets), rel=1e-9)


@pytest.mark.parametrize("sites", [SITES, LATTICE], ids=["scattered", "lattice"])
@pytest.mark.parametrize(("widening", "insertion"), [(0.0, True), (0.01, True), (0.0, False)])
def test_a_want_of_room_does_not_show(
    sites: Floats, widening: float, insertion: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = filled(widening, insertion, sites)
    layers = list(expected.layers)
    ended: list[int] = []

    def noting(*given: Any) -> None:
        run(*given)
        ended.append(int(given[11].outcome.ending))

    monkeypatch.setattr(course, "run", noting)
    monkeypatch.setattr(course, "walks", lambda crossings, *rest: walks(crossings // 64, *rest))
    monkeypatch.setattr(course.Course, "_usual_rows", lambda *_: 1)
    filling = filled(widening, insertion, sites)
    for before, after in zip(layers, filling.layers, strict=True):
        assert lines(after) == lines(before)
        assert after.area_per_cell == before.area_per_cell
        tree = {tuple(sorted(pair)) for pair in after.tree.tolist()}
        assert tree == {tuple(sorted(pair)) for pair in before.tree.tolist()}
    np.testing.assert_array_equal(filling.births, expected.births)
    assert ended.count(Ending.CROSSINGS_FULL) >= 2
    assert ended.count(Ending.OUTPUT_FULL) > len(layers) / 2


def area(walls: Any) -> float:
    """Of all facets, by Newell's sum."""
    total = 0.0
    for start, stop in zip(walls.starts[:-1], walls.starts[1:], strict=True):
        polygon = walls.points[start:stop] - walls.points[start]
        total += np.linalg.norm(np.cross(polygon, np.roll(polygon, -1, axis=0)).sum(axis=0)) / 2
    return total
