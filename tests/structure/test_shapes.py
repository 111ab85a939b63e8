"""Foams in parts of awkward shapes: thin, in pieces, on tips, smaller than a cell."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.structure.test_fill import laws, same
from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Floats

pytestmark = pytest.mark.slow

SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def scaled(x: float, y: float, to_x: float = 0.0, to_y: float = 0.0) -> Floats:
    return SQUARE * [x, y] + np.array([to_x, to_y])


def tip(share: float) -> tuple[Floats, ...]:
    return (scaled(0.02 + 12 * share, 0.02 + 12 * share),)


def islands(share: float) -> tuple[Floats, ...]:
    """One above the other, they touch nowhere and come and go."""
    rings = (scaled(3, 3), scaled(1, 8, 9, 2), scaled(4, 0.3, -8, -9), scaled(2, 2, 0, 11))
    return rings[int(4 * share) % 4 :]


def bridge(share: float) -> tuple[Floats, ...]:
    """Two feet and what joins them."""
    return (scaled(2, 9, -10), scaled(2, 9, 10)) if share < 0.6 else (scaled(12, 9),)


SHAPES = {
    "blade": lambda _: (scaled(15, 0.05),),
    "leaning blade": lambda share: (scaled(12, 0.1, 0, 9 * share),),
    "needle": lambda _: (scaled(0.3, 0.3) + 5,),
    "tip": tip,
    "spire": lambda share: tip(1 - share),
    "islands": islands,
    "bridge": bridge,
    "tube": lambda _: (scaled(9, 9), scaled(8.9, 8.9)[::-1]),
}


@given(
    st.sampled_from(sorted(SHAPES)),
    st.floats(2.5, 14.0),
    st.sampled_from([20.0, 45.0, 80.0, 90.0]),
    st.integers(0, 2**63 - 1),
    st.floats(0.5, 60),
)
@settings(max_examples=25)
def test_foams_of_any_part_obey_the_laws(
    name: str, size: float, limit: float, seed: int, height: float
) -> None:
    """Cells of any size that fits, also where they are larger than a section, or all of it."""
    shares = np.linspace(0, 1, 13)
    sections = [Section(height * share, SHAPES[name](share)) for share in shares]
    chosen = FillSettings(
        cell_size=size, max_overhang=limit, random_seed=seed, layer_height=height / 12
    )
    box = np.array([[-15.0, -15], [15, 15]])
    filling = fill_sections(sections, None, chosen, box)
    layers = list(filling.layers)
    for layer in layers[::6]:
        laws(layer, 1e-8)
        same(layer, filling.layers[layer.index])
    count = sum(len(layer.diagram.sites()) for layer in layers)
    assert count >= len(layers)


@given(st.floats(1e-4, 30), st.sampled_from([(1, 1, 1), (1, 20, 1), (1, 1, 60), (9, 9, 0.2)]))
def test_automatic_foams_of_parts_of_any_size(
    scale: float, size: tuple[float, float, float]
) -> None:
    width, depth, height = np.array(size) * scale
    sections = [Section(z, (scaled(width, depth),)) for z in np.linspace(0, height, 5)]
    filling = fill_sections(sections, None, FillSettings(layer_height=height / 4))
    for layer in filling.layers:
        area = layer.diagram.areas(len(filling.sites)).sum()
        assert area == pytest.approx(4 * width * depth, rel=1e-9)
        same(layer, filling.layers[layer.index])


@pytest.mark.parametrize("stretch", ["auto", "columns"])
def test_a_section_has_as_many_cells_as_the_cell_size_says(stretch: str) -> None:
    sections = [Section(0.5 * k, (scaled(40, 40),)) for k in range(40)]
    filling = fill_sections(
        sections, None, FillSettings(cell_size=2.0, stretch=stretch, layer_height=0.5)
    )
    inside = [
        np.count_nonzero((np.abs(middles(layer.diagram)) < 32).all(axis=1))
        for layer in filling.layers
    ]
    assert np.mean(inside) == pytest.approx(32**2, rel=0.03)


def middles(diagram) -> Floats:  # type: ignore[no-untyped-def]
    return np.array([np.concatenate(rings).mean(axis=0) for rings in diagram.cells().values()])


@pytest.mark.parametrize("chosen", [{}, {"stretch": "columns"}, {"max_overhang": 90.0}])
def test_another_seed_gives_other_cells(chosen: dict[str, object]) -> None:
    sections = [Section(0.5 * k, (scaled(9, 9),)) for k in range(8)]
    places = [
        fill_sections(sections, None, FillSettings(random_seed=seed, **chosen)).sites
        for seed in (0, 0, 1)
    ]
    np.testing.assert_array_equal(places[0], places[1])
    assert places[0].shape != places[2].shape or (places[0] != places[2]).any()


def test_columns_are_the_same_on_all_layers() -> None:
    sections = [Section(0.5 * k, (scaled(9, 9),)) for k in range(40)]
    filling = fill_sections(sections, None, FillSettings(stretch="columns"))
    first = filling.layers[0]
    for layer in filling.layers:
        np.testing.assert_array_equal(layer.diagram.vertices, first.diagram.vertices)
    assert len(first.diagram.sites()) > 20
