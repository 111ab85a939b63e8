"""Settings that nozzle, hot end, machine and cells do not allow."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from v3dcad.errors import SettingError
from v3dcad.formats.gcode.machine_profile import print_settings, profile_names
from v3dcad.limits import check_cells, check_limits
from v3dcad.settings import FillSettings, PrintSettings


def refused(filling: dict[str, Any], printing: dict[str, Any]) -> SettingError:
    with pytest.raises(SettingError) as caught:
        check_limits(FillSettings(**filling), PrintSettings(**printing))
    assert "\n" not in caught.value.message
    return caught.value


@pytest.mark.parametrize("name", profile_names())
@pytest.mark.parametrize("layer_height", [0.1, 0.2, 0.3])
def test_every_profile_fits_itself(name: str, layer_height: float) -> None:
    check_limits(FillSettings(layer_height=layer_height), print_settings(name))


@pytest.mark.parametrize(
    ("filling", "printing", "name", "said"),
    [
        ({}, {"bead_width": 1.01}, "bead_width", "a nozzle of 0.4 mm lays beads of 0.24 to 1 mm"),
        ({}, {"bead_width": 0.23}, "bead_width", "or the --nozzle-diameter"),
        ({"layer_height": 0.41}, {}, "layer_height", "--layer-height 0.41: layers do not bond"),
        ({"layer_height": 0.31}, {"bead_width": 0.3}, "layer_height", "give at most 0.3"),
        ({}, {"first_layer_height": 0.5}, "first_layer_height", "give at most 0.4"),
        ({}, {"travel_speed": 501.0}, "travel_speed", "more than the 500 mm/s of the machine"),
        ({}, {"print_speed": 90.0, "most_speed": 80.0}, "print_speed", "or the --most-speed"),
        ({}, {"print_speed": 200.0}, "print_speed", "take 16.3 mm³/s, and the hot end melts 15;"),
        ({}, {"bridge_speed": 90.0, "bridge_flow": 210.0}, "bridge_speed", "give at most 87 mm/s"),
        ({}, {"first_layer_speed": 190.0}, "first_layer_speed", "or the --most-flow"),
    ],
)
def test_what_does_not_fit_is_said_with_what_would(
    filling: dict[str, Any], printing: dict[str, Any], name: str, said: str
) -> None:
    error = refused(filling, printing)
    assert error.name == name
    assert said in error.message


def test_what_is_said_to_fit_fits() -> None:
    check_limits(FillSettings(layer_height=0.4), PrintSettings())
    check_limits(FillSettings(), PrintSettings(print_speed=183.0, solid_speed=183.0))
    check_limits(FillSettings(), PrintSettings(bead_width=0.24))
    check_limits(FillSettings(), PrintSettings(nozzle_diameter=0.8, bead_width=0.8))


def test_cells_of_many_sizes_are_refused_where_all_are_too_small() -> None:
    printing = PrintSettings(bead_width=0.8, nozzle_diameter=0.8)
    bounds = np.array([[0.0, 0, 0], [20, 30, 5]])
    check_cells(1.6, bounds, printing)
    check_cells("auto", bounds, printing)
    with pytest.raises(SettingError, match=r"cell_size 1.5: cells smaller than two beads .* 1.6"):
        check_cells(1.5, bounds, printing)
    small = bounds / 25
    check_cells(1.2, small, printing)  # as wide as the part
    with pytest.raises(SettingError, match=r"give at least 1\.2"):
        check_cells(1.1, small, printing)
