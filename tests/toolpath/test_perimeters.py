from __future__ import annotations

import pytest
import shapely

from v3dcad.toolpath.perimeters import inset


@pytest.mark.parametrize("distance", [0.2035398163397453, -0.2035398163397453])
def test_corners_that_differ_in_the_last_bit_are_as_one(distance: float) -> None:
    """GEOS divides by zero there, and cuts the corner off."""
    low, right = 0.8334680815641983, 4.217104900337144
    twice = [(-3.91761922901924, low), (-3.9176192290192398, low - 1.2e-16)]
    rest = [(right, 6.4882402333962235), (-3.91761922901924, 5.141484393519729)]
    found = inset(shapely.Polygon([*twice, *rest]), distance)
    once = inset(shapely.Polygon([twice[0], *rest]), distance)
    assert found.is_valid
    assert found.symmetric_difference(once).area < 1e-9


def test_what_is_as_small_as_rounding_stays_out_of_the_way() -> None:
    speck = shapely.Polygon([(20, 0), (20 + 1e-12, 0), (20, 1e-12)])
    found = inset(shapely.MultiPolygon([speck, shapely.box(0, 0, 4, 4)]), 0.5)
    assert found.equals(shapely.box(0.5, 0.5, 3.5, 3.5))
