"""Cells of many sizes from end to end: faces of scripts, files, `.ont`, the report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from build123d import Axis, Box, Cylinder, GeomType, Pos, Vertex

import v3dcad
from v3dcad.errors import SettingError
from v3dcad.parts import part_from

pytestmark = pytest.mark.slow

PLATE = Pos(100, 20, -5) * (Box(30, 24, 12) - Cylinder(4, 12))
"""Far from the origin: fields are where the source lies."""


def places(count: int = 60) -> np.ndarray:
    low, high = np.array(part_from(PLATE).bounds)
    return np.random.default_rng(0).uniform(low, high, (count, 3))


def sites_inside(structure: v3dcad.Structure) -> np.ndarray:
    """The sites in the part's box, where the source lies."""
    sites = structure.placement.to_source(structure.sites)
    low, high = np.array(part_from(PLATE).bounds)
    return sites[((sites >= low) & (sites <= high)).all(axis=1)]


def test_distances_from_faces_are_those_of_the_kernel() -> None:
    holes = PLATE.faces().filter_by(GeomType.CYLINDER)
    top = PLATE.faces().sort_by(Axis.Z)[-1]
    for faces in (top, holes, [top, [*holes]], (top.wrapped,)):
        flat = [top, *holes] if isinstance(faces, list) and faces is not holes else faces
        known = flat if isinstance(flat, list) else [top]
        wanted = [min(face.distance_to(Vertex(*at)) for face in known) for at in places()]
        found = v3dcad.distance_to(faces)(*places().T)
        np.testing.assert_allclose(found, wanted, atol=0.05)


def test_a_size_near_faces() -> None:
    holes = PLATE.faces().filter_by(GeomType.CYLINDER)
    away = np.hypot(places()[:, 0] - 100, places()[:, 1] - 20) - 4
    share = np.clip(np.abs(away) / 6, 0, 1)
    size = v3dcad.near_faces(holes, size=2, far=5, within=6)
    np.testing.assert_allclose(size(*places().T), 2 + 3 * share, atol=0.05)
    soft = v3dcad.near_faces(holes, size=2, far=5, within=6, smooth=True)
    wanted = 2 + 3 * share**2 * (3 - 2 * share)
    np.testing.assert_allclose(soft(*places().T), wanted, atol=0.1)


@pytest.mark.parametrize(
    ("faces", "told"),
    [
        ([], "no face to be near to"),
        (PLATE.edges()[0], "no face to be near to"),
        (7, "int is no face"),
        (["a"], "str is no face"),
    ],
)
def test_what_is_no_face_is_refused(faces: object, told: str) -> None:
    with pytest.raises(SettingError, match=told):
        v3dcad.near_faces(faces, size=2, far=5, within=6)


@pytest.mark.parametrize("wrong", ["size", "far", "within"])
def test_sizes_near_faces_have_to_be_above_0(wrong: str) -> None:
    sizes: dict[str, Any] = {"size": 2.0, "far": 5.0, "within": 6.0, wrong: 0.0}
    with pytest.raises(SettingError, match=f"{wrong} 0.0: give a number above 0 mm"):
        v3dcad.near_faces(PLATE.faces(), **sizes)


def test_a_fill_near_faces_lists_its_sites_in_ont(tmp_path: Path) -> None:
    holes = PLATE.faces().filter_by(GeomType.CYLINDER)
    size = v3dcad.near_faces(holes, size=2, far=6, within=10)
    filled = v3dcad.fill(PLATE, cell_size=size, layer_height=2)
    away = np.hypot(*(sites_inside(filled)[:, :2] - (100, 20)).T)
    near, far = (away > 4) & (away < 6), (away > 12) & (away < 14)
    # Rings of the same width: as many cells a mm³ as their sizes say.
    ratio = near.sum() / (6**2 - 4**2) / (far.sum() / (14**2 - 12**2))
    assert ratio > 3
    told = filled.report()["graded"]
    assert told["asked_mm"] == pytest.approx([2, 6], abs=0.1)
    filled.write_ont(tmp_path / "a.ont")
    assert v3dcad.fill(tmp_path / "a.ont").checksum() == filled.checksum()
    for name in ("random_seed", "roof_size"):
        with pytest.raises(SettingError, match=f"{name}: the file lists its sites") as raised:
            v3dcad.fill(tmp_path / "a.ont", **{name: 1})
        assert raised.value.name == name
    other = v3dcad.fill(tmp_path / "a.ont", random_seed=1, cell_size="3 + 0.1 * (z + 11)")
    assert other.graded is not None
