"""The page's toolpath against the toolpath."""

from __future__ import annotations

import numpy as np
import pytest

import v3dcad
from v3dcad.geometry.arcs import lengths
from v3dcad.geometry.print_time import step_seconds
from v3dcad.model import EXTRUDE, PERIMETER, TRAVEL, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.trace import trace
from v3dcad.view.page.motion import (
    BEAD,
    PERIMETER_BEAD,
    SEAM,
    TRAVELLED,
    UNSEEN,
    motion,
    motion_arrays,
)

pytestmark = pytest.mark.slow

SETTINGS = PrintSettings()


def arc(turns: list[float]) -> Toolpath:
    """A travel to (2, 0), then arcs about the origin by so many radians."""
    angles = np.cumsum([0.0, *turns])
    count = len(angles)
    return Toolpath(
        points=2 * np.column_stack([np.cos(angles), np.sin(angles), np.full(count, 0.1)]),
        kind=np.array([TRAVEL] + [EXTRUDE] * len(turns), np.int8),
        volume=np.zeros(count),
        speed=np.full(count, 30.0),
        layer=np.zeros(count, np.int64),
        feature=np.array([0] + [PERIMETER] * len(turns), np.int8),
        centre=np.array([[np.nan, np.nan]] + [[0.0, 0.0]] * len(turns)),
    )


@pytest.mark.parametrize("turns", [[1.2], [-3.0, 0.5], [0.01], [np.pi / 2] * 4])
def test_arcs_become_chords_of_their_circle(turns: list[float]) -> None:
    path, before = arc(turns), np.zeros(3)
    found = motion(path, before, SETTINGS)
    chords = np.linalg.norm(np.diff(found.points[1:], axis=0), axis=1)
    assert np.hypot(*found.points[1:, :2].T) == pytest.approx(2.0)
    whole = lengths(path.points[:-1], path.points[1:], path.centre[1:]).sum()
    assert chords.sum() == pytest.approx(whole, rel=1e-3)
    assert found.points[-1] == pytest.approx(path.points[-1])
    assert found.seconds.sum() == pytest.approx(step_seconds(path, before, SETTINGS).sum())
    assert found.roles[:3].tolist() == [UNSEEN, TRAVELLED, SEAM]
    assert (found.roles[3:] == PERIMETER_BEAD).all(), "an arc begins once"


def test_a_structure_s_toolpath_keeps_lengths_and_times(structure: v3dcad.Structure) -> None:
    paths = list(trace(structure.layers, SETTINGS))
    before, motions = paths[0].points[0], []
    for path in paths:
        start = np.vstack([before, path.points[:-1]])
        length = lengths(start, path.points, path.centre)
        found = motion(path, before, SETTINGS)
        drawn = np.linalg.norm(np.diff(found.points, axis=0), axis=1)
        beads = np.isin(found.roles[1:], (BEAD, PERIMETER_BEAD, SEAM))
        assert drawn[beads].sum() == pytest.approx(length[path.kind == EXTRUDE].sum(), rel=1e-3)
        assert found.seconds.sum() == pytest.approx(step_seconds(path, before, SETTINGS).sum())
        motions.append(found)
        before = path.points[-1]
    arrays = motion_arrays(motions)
    box = arrays["path_box"].astype(float)
    places = box[0] + arrays["path"] / 65535 * (box[1] - box[0])
    wanted = np.concatenate([one.points for one in motions])
    assert np.abs(places - wanted).max() < 2e-3
    assert arrays["path_from"][-1] == len(wanted)
