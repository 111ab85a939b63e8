"""Cells under roofs are so narrow that no skin spans far, and only there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

import v3dcad
from v3dcad.fields.roofs import REST, Roofs
from v3dcad.model import Floats, Mesh
from v3dcad.settings import PrintSettings

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


def longest_skin(structure: v3dcad.Structure) -> float:
    """The longest span of a bridge over cells, mm, by the certificate of a print without ribs."""
    found = structure.printed_overhang(PrintSettings(skin_span="off"))
    bridges = found.kinds.index("bridges")
    return float(found.span[found.over_cells[:, bridges], bridges].max(initial=0.0))


@pytest.mark.parametrize(("degrees", "found"), [(0, 2), (20, 2), (30, 0)])
def test_roofs_look_up_and_are_flat(degrees: float, found: int) -> None:
    roofs = Roofs.of(wedge(np.tan(np.radians(degrees))), 5.0)
    triangles = [] if roofs is None else roofs.surface.triangles.tolist()
    assert triangles == [[4, 5, 6], [4, 6, 7]][:found]


def test_sizes_grow_away_from_a_roof_up_to_those_given() -> None:
    def sizes(places: Floats) -> Floats:
        return np.full(len(places), 3.0)

    roofs = Roofs.of(wedge(0), 2.0)
    assert roofs is not None
    places = np.array([[5.0, 5, 5], [5, 5, 4], [5, 5, 0]])
    hexagon = np.sqrt(np.sqrt(3) / 2) * 2.0
    made = roofs.finer(sizes, 0.3, stretch=2.0)(places)
    assert made == pytest.approx([hexagon, hexagon + 0.15, hexagon + 0.75])
    assert roofs.finer(lambda at: np.ones(len(at)), 0.3, 2.0)(places).tolist() == [1, 1, 1]


@pytest.mark.parametrize("rise", [0.0, 0.4])
def test_sites_lie_under_the_roof_in_equal_hexagons(rise: float) -> None:
    roofs = Roofs.of(wedge(rise), 1.5)
    assert roofs is not None
    found = roofs.sites()
    sites = found[np.unique(np.round(found[:, :2], 9), axis=0, return_index=True)[1]]
    flat = KDTree(sites[:, :2])
    apart, _ = flat.query(sites[:, :2], k=2)
    np.testing.assert_allclose(apart[:, 1], 1.5)
    corners = np.random.default_rng(0).uniform(0, 10, (1000, 2))
    assert flat.query(corners)[0].max() <= 1.5 / np.sqrt(3) + 1e-9
    over = 5 + rise * np.clip(sites[:, 0], 0, 10)
    np.testing.assert_allclose(sites[:, 2], over - REST)


def test_no_skin_spans_more_than_asked(tmp_path: Path) -> None:
    from build123d import Box, Pos

    part = Box(24, 20, 10) + Pos(-6, 0, 12.5) * Box(12, 20, 15)
    made = v3dcad.fill(part, cell_size=8.0, roof_size=5.0)
    assert longest_skin(made) <= 5.05
    assert longest_skin(v3dcad.fill(part, cell_size=8.0, roof_size=3.5)) <= 3.55
    assert longest_skin(v3dcad.fill(part, cell_size=8.0)) > 6
    assert made.overhang(0.45).wall_tilt.max() <= 45
    assert made.graded is not None
    assert made.graded.finer < 0.05  # sizes grow no faster than cells can
    made.write_ont(tmp_path / "a.ont")
    assert v3dcad.fill(tmp_path / "a.ont").checksum() == made.checksum()


def test_small_cells_and_parts_without_a_roof_stay_as_they_are(tmp_path: Path) -> None:
    from build123d import Box, Cone

    for part, size in ((Box(12, 12, 6), 3.0), (Cone(12, 0, 20), 6.0)):
        even = v3dcad.fill(part, cell_size=size, roof_size=5.0)
        assert even.graded is None
        assert even.recipe().sites is None
        assert even.checksum() == v3dcad.fill(part, cell_size=size).checksum()
    assert longest_skin(v3dcad.fill(Box(24, 24, 6), cell_size=3.0)) <= 5
    even.write_ont(tmp_path / "a.ont")
    assert v3dcad.fill(tmp_path / "a.ont").checksum() == even.checksum()


def test_what_goes_with_no_roof_size() -> None:
    from build123d import Box

    part = Box(20, 20, 10)
    with pytest.raises(v3dcad.SettingError, match=r"roof_size 5\.0: sites are given"):
        v3dcad.fill(part, roof_size=5.0, stretch=2, sites=[(0, 0, 0), (5, 5, 5)])
    with pytest.raises(v3dcad.SettingError, match="columns: cells of many sizes need a number"):
        v3dcad.fill(part, roof_size=5.0, stretch="columns")
    with pytest.raises(v3dcad.SettingError, match="more than 10,000,000"):
        v3dcad.fill(part, roof_size=0.001)
