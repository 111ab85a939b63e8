"""Sites from a density function."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import KDTree

from v3dcad import SettingError, density

RECTANGLE = np.array([[-20.0, -10.0], [20.0, 10.0]])


def test_as_many_as_the_integral_and_where_it_is() -> None:
    graded = density(lambda x, y: 0.5 if x < 0 else 0.125)
    sites = graded.scatter(RECTANGLE, random_seed=1)
    assert len(sites) == 250
    left = np.count_nonzero(sites[:, 0] < 0)
    assert left == pytest.approx(200, abs=15)
    assert (sites >= RECTANGLE[0]).all()
    assert (sites <= RECTANGLE[1]).all()
    assert np.array_equal(sites, graded.scatter(RECTANGLE, random_seed=1))
    # Spread evenly: far fewer close pairs than in a scatter by chance.
    apart = KDTree(sites[sites[:, 0] < 0]).query(sites[sites[:, 0] < 0], k=2)[0][:, 1]
    assert apart.min() > 0.35 / np.sqrt(0.5)


@pytest.mark.parametrize("value", [-1.0, float("nan"), 0.0, 1e9])
def test_densities_that_cannot_be(value: float) -> None:
    with pytest.raises(SettingError, match=r"density"):
        density(lambda x, y: value).scatter(RECTANGLE, random_seed=0)
