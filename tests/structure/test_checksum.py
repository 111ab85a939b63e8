from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Checksum, Floats
from v3dcad.structure.checksum import thesis_checksum
from v3dcad.structure.thesis.sites import PlaneSites

SQUARE = np.array([[0.0, 0], [40, 0], [40, 40], [0, 40]])


def sections(count: int = 12, height: float = 0.5) -> list[Section]:
    return [Section(k * height, ((SQUARE - 20) * (1 - k / 40) + 20,)) for k in range(count)]


def checksum(
    sites: Floats | None = None, parts: Sequence[Section] = tuple(sections()), **settings: object
) -> Checksum:
    chosen = FillSettings(**{"layer_height": 0.5, "max_overhang": 90.0, **settings})
    filling = fill_sections(parts, sites, chosen)
    return filling.checksum(filling.layers)


SITES = np.random.default_rng(5).uniform([0, 0, -5], [40, 40, 10], (60, 3))
GIVEN = {"sites": SITES, "stretch": 1.5}
UNIFORM = {"cell_size": 8.0}


@pytest.mark.parametrize("settings", [GIVEN, UNIFORM])
def test_it_counts_layers_cells_and_walls(settings: dict[str, object]) -> None:
    found = checksum(**settings)
    chosen = {name: value for name, value in settings.items() if name != "sites"}
    filling = fill_sections(
        sections(),
        settings.get("sites"),
        FillSettings(max_overhang=90.0, layer_height=0.5, **chosen),
    )
    assert found.layers == 12
    assert found.cells == len(filling.sites)
    assert found.walls == sum(len(layer.diagram.neighbours) for layer in filling.layers)
    # Layers by themselves have the same.
    alone = (filling.layers[index] for index in range(12))
    assert found.differences(filling.checksum(alone)) == []


@pytest.mark.parametrize(
    ("settings", "change", "says"),
    [
        (GIVEN, {"stretch": 1.5001}, "other sites"),
        (GIVEN, {"parts": sections(11)}, "11 layers instead of 12"),
        (GIVEN, {"parts": sections(height=0.51)}, "other weights"),
        (GIVEN, {"sites": SITES + np.eye(60, 3)}, "other sites"),
        (GIVEN, {"sites": SITES[::-1]}, "other sites"),
        (UNIFORM, {"random_seed": 1}, "other sites"),
        (UNIFORM, {"cell_size": 8.001}, "other weights"),
        (UNIFORM, {"stretch": 1.01}, "other weights"),
    ],
)
def test_another_structure_has_another(
    settings: dict[str, object], change: dict[str, object], says: str
) -> None:
    differences = checksum(**{**settings, **change}).differences(checksum(**settings))
    assert says in differences


def test_other_neighbours_make_another() -> None:
    filling = fill_sections(sections(), None, FillSettings(layer_height=0.5))
    layers = list(filling.layers)
    pairs = layers[4].diagram.neighbours.copy()
    pairs[0] = [pairs[0, 0], pairs[0, 1] + 1]
    changed = replace(layers[4], diagram=replace(layers[4].diagram, neighbours=pairs))
    other = filling.checksum([*layers[:4], changed, *layers[5:]])
    assert other.differences(filling.checksum(layers)) == ["other topology"]


def test_points_on_the_boundary_take_no_part() -> None:
    """Sections with chords of other lengths and last bits, as another kernel may make them."""
    divided = []
    for section in sections():
        ring = section.rings[0]
        middle = (ring + np.roll(ring, -1, axis=0)) / 2
        divided.append(Section(section.z, (np.stack([ring, middle], axis=1).reshape(-1, 2),)))
    assert checksum(**GIVEN, parts=divided) == checksum(**GIVEN)
    assert checksum(**UNIFORM, parts=divided) == checksum(**UNIFORM)


def test_the_order_of_the_thesiss_sites_does_not_matter() -> None:
    settings = FillSettings(method="thesis", insertion=False, layer_height=0.5)
    filling = fill_sections(sections(), None, settings)
    layers = list(filling.layers)
    order = np.random.default_rng(2).permutation(len(layers[0].state.weights))
    permuted = []
    for layer in layers:
        state = layer.state
        rows = PlaneSites(
            filling.grid, state.flat[order], state.weights[order], state.growth[order]
        )
        pairs = np.sort(np.argsort(order)[layer.diagram.neighbours], axis=1)
        diagram = replace(layer.diagram, neighbours=pairs)
        permuted.append(replace(layer, state=rows, diagram=diagram))
    assert thesis_checksum(permuted, filling.grid) == filling.checksum(layers)
