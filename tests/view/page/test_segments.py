"""The page's arrays against the layers, the walls in space and the struts in space."""

from __future__ import annotations

import numpy as np
import pytest

import v3dcad
from v3dcad.view.page.content import _told
from v3dcad.view.page.segments import UPRIGHT, Arrays, LayerArrays, fractions, layer_arrays

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def arrays(structure: v3dcad.Structure) -> Arrays:
    return layer_arrays([LayerArrays.of(one) for one in structure.layers], structure.part.bounds)


def places(arrays: Arrays, structure: v3dcad.Structure) -> np.ndarray:
    low, high = structure.part.bounds[:, :2]
    return low + arrays["vertices"] / 65535 * (high - low)


def test_every_edge_is_there_once(arrays: Arrays, structure: v3dcad.Structure) -> None:
    found = places(arrays, structure)
    for k, layer in enumerate(structure.layers):
        inner = layer.diagram.inner()
        base = arrays["vertices_from"][k]
        for name, chosen in (("walls", inner), ("contours", ~inner)):
            rows = slice(arrays[f"{name}_from"][k], arrays[f"{name}_from"][k + 1])
            ends = found[base + arrays[name][rows]]
            wanted = layer.diagram.vertices[layer.diagram.edges[chosen]]
            assert np.abs(ends - wanted).max() < 1e-3
        rows = slice(arrays["walls_from"][k], arrays["walls_from"][k + 1])
        assert np.array_equal(arrays["wall_sites"][rows], layer.diagram.edge_sites[inner])


def test_struts_lie_on_the_struts_in_space(arrays: Arrays, structure: v3dcad.Structure) -> None:
    found, axes = places(arrays, structure), structure.strut_axes
    start, stop = axes.ends[:, 0], axes.ends[:, 1]
    along = (stop - start) / np.linalg.norm(stop - start, axis=1)[:, None]
    z, count = arrays["z"].astype(float), 0
    for k in range(len(z) - 1):
        rows = slice(arrays["struts_from"][k], arrays["struts_from"][k + 1])
        for lower, upper in arrays["struts"][rows].tolist():
            for layer, vertex in ((k, lower), (k + 1, upper)):
                point = np.array([*found[arrays["vertices_from"][layer] + vertex], z[layer]])
                way = point - start
                aside = np.linalg.norm(
                    way - (way * along).sum(axis=1)[:, None] * along, axis=1
                )  # fmt: skip
                assert aside.min() < 2e-3
            count += 1
    assert count > 100
    assert arrays["struts_from"][-1] == arrays["struts_from"][-2], "above the last there is none"


def test_walls_lean_towards_where_they_are_on_the_layer_above(
    structure: v3dcad.Structure,
) -> None:
    """A strip of a wall, as high as a layer and leaning so, reaches the wall's next slice."""
    layer, rise = structure.layers[5], 1e-3
    told = LayerArrays.of(layer).told
    above = structure.at(layer.z + rise)
    lines = {tuple(pair): k for k, pair in enumerate(above.edge_sites.tolist())}
    checked = 0
    for pair, ends, lean in zip(
        told["wall_sites"].tolist(), told["walls"], told["wall_leans"].astype(int), strict=True
    ):
        if tuple(pair) not in lines:
            continue
        start, stop = layer.diagram.vertices[ends]
        left = np.array([start[1] - stop[1], stop[0] - start[0]]) / np.linalg.norm(stop - start)
        moved = start + left * np.tan(np.radians(lean - UPRIGHT)) * rise
        first, second = above.vertices[above.edges[lines[tuple(pair)]]]
        across = np.array([first[1] - second[1], second[0] - first[0]])
        aside = (moved - first) @ across / np.linalg.norm(across)
        assert abs(aside) < 0.03 * rise
        checked += 1
    assert checked > 20


def test_volumes_add_up_to_the_sections(structure: v3dcad.Structure) -> None:
    every, volumes = _told(structure.layers, 2.0)
    sides = np.array([layer.diagram.areas(len(volumes)).sum() for layer in structure.layers])
    assert len(every) == len(structure.layers)
    assert volumes.sum() == pytest.approx(2.0 * sides.sum())
    assert volumes.min() >= 0


def test_fractions_are_true_to_a_thousandth() -> None:
    box = np.array([[-50.0, 3.0], [50.0, 3.0]])
    points = np.column_stack([np.random.default_rng(1).uniform(-50, 50, 100), np.full(100, 3.0)])
    found = box[0] + fractions(points, box) / 65535 * (box[1] - box[0])
    assert np.abs(found - points).max() < 1e-3
