from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagrams import WIDE, stack

from v3dcad.geometry.print_time import step_seconds
from v3dcad.model import EXTRUDE, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.report import LayerReport, findings
from v3dcad.toolpath.trace import trace

FAST = {"print_speed": 90.0, "perimeter_speed": 40.0, "first_layer_speed": 60.0}


def traced(**settings: Any) -> tuple[list[Toolpath], list[LayerReport], PrintSettings]:
    options = PrintSettings(**{**WIDE, **FAST, **settings})
    reports: list[LayerReport] = []
    return list(trace(stack(4), options, reports.append)), reports, options


def seconds(path: Toolpath, settings: PrintSettings, below: Toolpath | None) -> float:
    before = path.points[0] if below is None else below.points[-1]
    return float(step_seconds(path, before, settings).sum())


def test_short_layers_take_the_least_time() -> None:
    paths, reports, options = traced(minimum_layer_time=30.0, slowest_speed=1.0)
    plain, _, _ = traced()
    below = None
    for path, quick, report in zip(paths, plain, reports, strict=True):
        assert seconds(quick, options, below) < 29
        assert seconds(path, options, below) == pytest.approx(30.0, rel=5e-3)
        assert seconds(path, options, below) >= 30.0
        assert report.seconds == pytest.approx(seconds(path, options, below))
        below = path
        # Nothing else changes, and only what was faster than the new speed got slower.
        assert np.array_equal(path.points, quick.points)
        assert np.array_equal(path.volume, quick.volume)
        extruding = path.kind == EXTRUDE
        assert np.array_equal(path.speed[~extruding], quick.speed[~extruding])
        slowed = path.speed < quick.speed
        assert np.ptp(path.speed[slowed]) == 0
        assert (quick.speed[extruding & ~slowed] <= path.speed[slowed].max()).all()
    assert findings(reports) == findings(traced()[1])


def test_layers_that_take_long_enough_stay_as_they_are() -> None:
    for path, quick in zip(traced(minimum_layer_time=1.0)[0], traced()[0], strict=True):
        assert path.speed.tobytes() == quick.speed.tobytes()


def test_no_layer_is_slower_than_the_slowest_speed_and_the_user_is_told() -> None:
    paths, reports, _ = traced(minimum_layer_time=1000.0, slowest_speed=7.0)
    for path, report in zip(paths, reports, strict=True):
        assert (path.speed[path.kind == EXTRUDE] == 7.0).all()
        assert report.hurried
    assert findings(reports)[-1].startswith("--minimum-layer-time is more than 4 layers")
