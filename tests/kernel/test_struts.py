"""Bars cut to a part: OCCT's result against the same cut made with meshes."""

from __future__ import annotations

import numpy as np
import pytest
from build123d import Box, Sphere
from occt import is_valid, volume_of
from OCP.TopoDS import TopoDS_Shape

from v3dcad.errors import KernelError
from v3dcad.kernel.booleans import common
from v3dcad.kernel.shapes import compound
from v3dcad.kernel.struts import bars, cut_bars

POINTS, STRUT = np.array([[0.0, 0, 0], [0, 0, 12]]), np.array([[0, 1]])


def test_bars_cut_in_closed_form() -> None:
    """Of a bar from the middle of a ball through its surface the ball at the far end is gone."""
    made = bars(POINTS, STRUT, 2.0)
    whole = Sphere(8).wrapped
    cut = cut_bars(made, whole)
    assert len(cut) == 2
    assert all(map(is_valid, cut))
    height = np.sqrt(8**2 - 1)  # where the bar meets the sphere; above it stands a cap
    cap = np.pi * (8 - height) ** 2 * (8 - (8 - height) / 3)
    expected = np.pi * height + cap + 4 / 3 * np.pi
    assert volume_of(compound(cut)) == pytest.approx(expected, rel=1e-6)


def test_a_lost_bar_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    made = bars(POINTS, STRUT, 2.0)
    block = Box(20, 20, 20).wrapped
    assert len(cut_bars(made, block)) == 2

    def lossy(some: list[TopoDS_Shape], others: list[TopoDS_Shape]) -> TopoDS_Shape:
        return compound([]) if some[0].IsSame(made[1]) else common(some, others)

    monkeypatch.setattr("v3dcad.kernel.struts.common", lossy)
    with pytest.raises(KernelError, match=r"leaves 0 mm³ of a strut, .* write_stl\(.*cut=True\)"):
        cut_bars(made, block)
