from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Checksum, Floats
from v3dcad.structure.checksum import structure_checksum

SQUARE = np.array([[0.0, 0], [40, 0], [40, 40], [0, 40]])


def sections(count: int = 12, height: float = 0.5) -> list[Section]:
    """Ever larger squares, so that cells are born."""
    return [Section(k * height, ((SQUARE - 20) * (1 + k / 12) + 20,)) for k in range(count)]


def checksum(
    sites: Floats, parts: Sequence[Section] = tuple(sections()), **settings: object
) -> Checksum:
    chosen = FillSettings(**{"layer_height": 0.5, "offset": 0.4, **settings})
    filling = fill_sections(parts, sites, chosen)
    return structure_checksum(filling.layers, filling.grid)


SITES = np.random.default_rng(5).uniform(0, 40, (30, 2))


def test_it_counts_layers_births_and_walls() -> None:
    found = checksum(SITES)
    settings = FillSettings(layer_height=0.5, offset=0.4)
    layers = list(fill_sections(sections(), SITES, settings).layers)
    assert found.layers == 12
    assert found.walls == sum(len(layer.diagram.neighbours) for layer in layers)
    assert found.births == len(layers[-1].state.sites) - 30 > 0


@given(st.permutations(range(30)))
def test_the_order_of_the_sites_does_not_matter(order: list[int]) -> None:
    assert checksum(SITES[order]) == checksum(SITES)


@given(st.permutations(range(36)))
def test_nor_does_it_where_all_neighbours_are_as_far_apart(order: list[int]) -> None:
    row, column = np.divmod(np.arange(36), 6)
    lattice = np.column_stack([1 + 1.5 * column + 0.75 * (row % 2), 1 + 1.3125 * row])
    assert checksum(lattice[order]) == checksum(lattice)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"offset": 0.41}, ["other weights"]),
        ({"parts": sections(11)}, ["11 layers instead of 12"]),
        ({"parts": sections(height=0.51)}, ["other weights"]),
        ({"sites": SITES + np.eye(30, 2)}, ["other sites"]),
        ({"insertion": False}, ["0 births instead of"]),
    ],
)
def test_another_structure_has_another(change: dict[str, object], says: list[str]) -> None:
    differences = checksum(**{"sites": SITES, **change}).differences(checksum(SITES))
    for start in says:
        assert any(difference.startswith(start) for difference in differences), differences


def test_other_neighbours_make_another() -> None:
    filling = fill_sections(sections(), SITES, FillSettings(layer_height=0.5, offset=0.4))
    layers = list(filling.layers)
    pairs = layers[4].diagram.neighbours.copy()
    pairs[0] = [pairs[0, 0], (pairs[0, 1] + 1) % 30]
    changed = replace(layers[4], diagram=replace(layers[4].diagram, neighbours=pairs))
    other = structure_checksum([*layers[:4], changed, *layers[5:]], filling.grid)
    differences = other.differences(structure_checksum(layers, filling.grid))
    assert differences == ["other topology"]


def test_points_on_the_boundary_take_no_part() -> None:
    """Sections with chords of other lengths and last bits, as another kernel may make them."""
    divided = []
    for section in sections():
        ring = section.rings[0]
        middle = (ring + np.roll(ring, -1, axis=0)) / 2
        divided.append(Section(section.z, (np.stack([ring, middle], axis=1).reshape(-1, 2),)))
    assert checksum(SITES, divided) == checksum(SITES)
