"""Colours: seen on white and on dark, and told apart, by colour-blind eyes too."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest

from v3dcad.model import Floats
from v3dcad.view.colours import COLOURS, RAMP, ramp, rgb

TOGETHER = [
    {"contour", "wall", "context"},
    {"cell", "neighbour", "context"},
    {"tree", "context"},
    {"perimeter", "bead", "travel"},
]
"""The roles that one preview shows at most; test_targets.py holds previews to them."""

# Machado, Oliveira and Fernandes: A physiologically-based model for simulation of color vision
# deficiency, IEEE TVCG 15 (2009), 1291-1298: their matrices of severity 1, for linear sRGB.
EYES = {
    "normal": np.eye(3),
    "protanope": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranope": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanope": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
TO_XYZ = np.array(  # IEC 61966-2-1
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
)


def linear(colour: str) -> Floats:
    """Linear sRGB, 0 … 1."""
    return of_display(np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255)


def of_display(coded: Floats) -> Floats:
    """Linear sRGB of sRGB, both 0 … 1."""
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def lab(rgb: Floats) -> Floats:
    """CIELAB of linear sRGB, of the white of sRGB."""
    share = TO_XYZ @ rgb / TO_XYZ.sum(axis=1)
    x, y, z = np.where(share > (6 / 29) ** 3, np.cbrt(share), share * (29 / 6) ** 2 / 3 + 4 / 29)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def contrast(one: str, other: str) -> float:
    """The contrast ratio of WCAG 2, 1 … 21."""
    return contrast_of(linear(one), linear(other))


def contrast_of(one: Floats, other: Floats) -> float:
    """The same of linear sRGB."""
    dark, light = sorted(float(TO_XYZ[1] @ colour) for colour in (one, other))
    return (light + 0.05) / (dark + 0.05)


def test_the_measures_are_those_of_the_standards() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)
    np.testing.assert_allclose(lab(linear("#ff0000")), [53.24, 80.09, 67.20], atol=0.03)
    for matrix in EYES.values():  # grey is the same grey to every eye
        np.testing.assert_allclose(np.sum(matrix, axis=1), 1, atol=2e-6)


@pytest.mark.parametrize("background", ["#ffffff", "#222222"])
def test_colours_stand_out(background: str) -> None:
    for role, colour in COLOURS.items():
        assert contrast(colour, background) >= 3, role


@pytest.mark.parametrize("eyes", EYES)
def test_what_is_shown_together_is_told_apart(eyes: str) -> None:
    """Ten times the difference that is just seen in CIELAB, 2.3 (Mahy and others, 1994)."""
    seen = {
        role: lab(np.clip(EYES[eyes] @ linear(colour), 0, 1)) for role, colour in COLOURS.items()
    }
    for roles in TOGETHER:
        for one, other in combinations(sorted(roles), 2):
            assert np.linalg.norm(seen[one] - seen[other]) > 23, (one, other)


def test_a_ramp_begins_and_ends_with_its_colours() -> None:
    np.testing.assert_array_equal(ramp(np.array([0, 0.5, 1])), [rgb(colour) for colour in RAMP])


@pytest.mark.parametrize("background", ["#ffffff", "#222222"])
def test_all_of_a_ramp_stands_out(background: str) -> None:
    for colour in ramp(np.linspace(0, 1, 101)):
        assert contrast_of(of_display(colour), linear(background)) >= 3


@pytest.mark.parametrize("eyes", EYES)
def test_along_a_ramp_colours_change_evenly(eyes: str) -> None:
    """From one fifth to the next the change is seen, and none is a jump."""
    seen = [
        lab(np.clip(EYES[eyes] @ of_display(colour), 0, 1)) for colour in ramp(np.linspace(0, 1, 6))
    ]
    steps = [float(np.linalg.norm(one - other)) for one, other in pairwise(seen)]
    assert min(steps) > 2.3
    assert max(steps) < 40
