"""Winding numbers of a diagram's vertices, found from those around: they fit, or are refused."""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.clipping.winding_numbers import UNKNOWN, wind
from v3dcad.geometry.compiled.arrays import Int32Array, Int32Rows
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.power_diagram.grid import STEPS
from v3dcad.geometry.power_diagram.regular_triangulation import triangulation
from v3dcad.geometry.power_diagram.triangle_mesh import ABSENT, ACROSS, SENTINELS, Triangulation


@compiled({**ENTRY, "cache": False})
def fit(
    mesh: Triangulation, inside: Int32Array, gain: Int32Rows, listed: Int32Array, count: int
) -> bool:
    """`wind`, which only compiled code calls."""
    return wind(mesh, inside, gain, listed, count)


MESH = triangulation(np.random.default_rng(1).integers(0, STEPS, (20, 2)), np.zeros(20, np.int64))
LIVE = np.flatnonzero(MESH.triangles[: MESH.counts.triangles, 0] != ABSENT).astype(np.int32)
OUTERMOST = int(MESH.triangle_of[0])
INNER = int(LIVE[(MESH.triangles[LIVE, :3] >= SENTINELS).all(axis=1)][0])


def wound(known: int, unknown: list[int], edge: int = -1) -> tuple[bool, list[int]]:
    """Whether the winding numbers of some triangles fit where all others' are `known`, and what
    they are; along an edge they gain 1.
    """
    inside = np.full(len(MESH.triangles), known, np.int32)
    inside[unknown] = UNKNOWN
    gain = np.zeros((3 * len(MESH.triangles), 2), np.int32)
    if edge >= 0:
        gain[edge, 0] = 1
    fits = fit(MESH, inside, gain, np.array(unknown, np.int32), len(unknown))
    return fits, inside[unknown].tolist()


def test_they_come_from_those_around() -> None:
    assert wound(0, [INNER]) == (True, [0])
    assert wound(0, [INNER, OUTERMOST]) == (True, [0, 0])


def test_all_may_fit_and_be_one_too_many() -> None:
    """Those that are known may be out of date; the outermost is never inside."""
    assert not wound(1, [OUTERMOST])[0]
    assert not wound(1, [INNER, OUTERMOST])[0]


def test_without_any_that_is_known_none_is_found() -> None:
    fits, found = wound(0, LIVE.tolist())
    assert not fits
    assert set(found) == {UNKNOWN}


def test_a_gain_along_one_edge_fits_nowhere() -> None:
    """Around each of its ends they would have to come back to what they were."""
    triangle = INNER
    edges = [3 * triangle + i for i in range(3) if MESH.triangles[triangle, ACROSS + i] > triangle]
    assert edges
    for edge in edges:
        assert not wound(0, [triangle], edge)[0]
