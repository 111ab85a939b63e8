"""Cells under roofs are as fine as is asked, and only there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import v3dcad
from v3dcad.fields.roofs import SPAN, finer_under, roofs
from v3dcad.model import Diagram, Floats, Mesh
from v3dcad.structure.foam.size_grid import SLOPE

pytestmark = pytest.mark.slow


def wedge(rise: float) -> Mesh:
    """A box 10 × 10 × 5 whose top rises by so much along x."""
    tall = 5 + 10 * rise
    base = np.array([[0.0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]])
    top = base + np.array([[0, 0, 5], [0, 0, tall], [0, 0, tall], [0, 0, 5]])
    faces = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        faces += [[a, b, b + 4], [a, b + 4, a + 4]]
    return Mesh(np.concatenate([base, top]), np.array(faces))


def widest(diagram: Diagram) -> float:
    """The greatest distance of two corners of a cell, mm."""
    cells = [np.concatenate(rings) for rings in diagram.cells().values()]
    return max(float(np.hypot(*(p[:, None] - p[None]).transpose(2, 0, 1)).max()) for p in cells)


@pytest.mark.parametrize(("degrees", "found"), [(0, 2), (20, 2), (30, 0)])
def test_roofs_look_up_and_are_flat(degrees: float, found: int) -> None:
    above = roofs(wedge(np.tan(np.radians(degrees))))
    assert above.triangles.tolist() == [[4, 5, 6], [4, 6, 7]][:found]


def test_sizes_grow_away_from_a_roof_and_stay_as_given_without_one() -> None:
    def sizes(places: Floats) -> Floats:
        return np.full(len(places), 3.0)

    places = np.array([[5.0, 5, 5], [5, 5, 4], [5, 5, 0]])
    made = finer_under(sizes, wedge(0), 4.8, SLOPE)(places)
    assert made == pytest.approx([4.8 / SPAN, 4.8 / SPAN + SLOPE, 3.0], abs=0.01)
    assert finer_under(sizes, wedge(1), 4.8, SLOPE) is sizes


def test_no_cell_under_a_roof_is_wider_than_asked(tmp_path: Path) -> None:
    from build123d import Box

    part = Box(20, 20, 12)
    made = v3dcad.fill(part, cell_size=7.0, roof_size=5.0)
    assert widest(made.layers[-5].diagram) <= 5.0
    assert widest(made.layers[len(made.layers) // 4].diagram) > 5.0
    assert made.overhang(0.45).wall_tilt.max() <= 45
    made.write_ont(tmp_path / "a.ont")
    assert v3dcad.fill(tmp_path / "a.ont").checksum() == made.checksum()
    even = v3dcad.fill(part, cell_size=2.0, roof_size=5.0)
    assert even.graded is None
    with pytest.raises(v3dcad.SettingError, match=r"roof_size 5\.0: sites are given"):
        v3dcad.fill(part, roof_size=5.0, stretch=2, sites=[(0, 0, 0), (5, 5, 5)])
