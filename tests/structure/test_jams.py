"""A triangulation built afresh on the way up changes nothing that can be seen."""

from typing import Any

import numpy as np
import pytest

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Layer
from v3dcad.structure import course
from v3dcad.structure.layers import DONE, JAMMED, LAYERS, STATUS, Rings, Run, run

SQUARE = np.array([[0.0, 0], [40, 0], [40, 40], [0, 40]])
SITES = np.random.default_rng(3).random((40, 2)) * 40
JAMS = (7, 8, 30)


def filled(widening: float, insertion: bool) -> Any:
    sections = [
        Section(0.4 * k, (SQUARE * (1 + widening * k) - 20 * k * widening,)) for k in range(60)
    ]
    return fill_sections(
        sections,
        SITES,
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

    def jamming(*given: Any) -> Run:
        """The compiled loop, which now and then says that it is jammed before a layer."""
        nonlocal made
        rings, times = next(k for k in given if isinstance(k, Rings)), given[8]
        stops = [
            jam - made for jam in JAMS if jam not in jammed and made <= jam < made + len(times)
        ]
        some = min(stops, default=len(times))
        short = rings._replace(layers=rings.layers[: some + 1])
        found = run(*given[:7], short, times[:some], *given[9:])
        made += int(found.outcome[LAYERS])
        if stops and found.outcome[STATUS] == DONE:
            found.outcome[STATUS] = JAMMED
            jammed.append(made)
        return found

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


def area(walls: Any) -> float:
    """Of all facets, by Newell's sum."""
    total = 0.0
    for start, stop in zip(walls.starts[:-1], walls.starts[1:], strict=True):
        polygon = walls.points[start:stop] - walls.points[start]
        total += np.linalg.norm(np.cross(polygon, np.roll(polygon, -1, axis=0)).sum(axis=0)) / 2
    return total
