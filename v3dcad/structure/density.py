"""Sites as dense as a function says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.model import Floats

SAMPLES = 200
"""Along each side of the rectangle, where the function is looked at."""

CANDIDATES = 10
MOST = 100_000


@dataclass(frozen=True, slots=True)
class density:  # noqa: N801 - a verb where it is used: sites=density(lambda x, y: ...)
    """How many cells there are to be in a mm², as a function of x and y (mm, bed coordinates).

    In bed coordinates the middle of the part's base rectangle is (0, 0).
    """

    function: Callable[[float, float], float]

    def scatter(self, rectangle: Floats, random_seed: int) -> Floats:
        """Sites (n, 2), mm, in a rectangle [[x0, y0], [x1, y1]], n the function's integral.

        Mitchell's best candidate, as `scatter_sites` does it, with distances counted in local
        cell widths: of ten random places, as likely as the density there, each new site takes the
        one farthest from all others. Raises `SettingError` for a density that is negative, not
        finite, or that asks for no site or more than `MOST`.
        """
        low, size = rectangle[0], rectangle[1] - rectangle[0]
        middles = (np.arange(SAMPLES) + 0.5) / SAMPLES
        around = self._at(
            low + np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2) * size
        )
        wanted = float(around.mean() * size.prod())
        if not 0.5 <= wanted <= MOST:
            raise SettingError(
                "sites",
                f"this density asks for {wanted:.3g} sites on {size[0]:g} × {size[1]:g} mm; give "
                f"cells per mm² that make 1 to {MOST}",
            )
        random = np.random.default_rng(random_seed)
        count, most = round(wanted), float(around.max()) * 1.01
        sites = np.empty((count, 2))
        for done in range(count):
            places, here = self._candidates(low, size, most, random)
            apart = np.hypot(*(places[:, None] - sites[:done]).transpose(2, 0, 1))
            nearest = apart.min(axis=1, initial=np.inf) * np.sqrt(here)
            sites[done] = places[np.argmax(nearest)]
        return sites

    def _candidates(
        self, low: Floats, size: Floats, most: float, random: np.random.Generator
    ) -> tuple[Floats, Floats]:
        """Random places (CANDIDATES, 2), as likely as the density, and the density there."""
        kept: list[Floats] = []
        found = 0
        while found < CANDIDATES:
            places = low + random.random((2 * CANDIDATES, 2)) * size
            here = self._at(places)
            taken = random.random(len(here)) * most < here
            kept.append(np.column_stack([places, here])[taken])
            found += int(taken.sum())
        rows = np.concatenate(kept)[:CANDIDATES]
        return rows[:, :2], rows[:, 2]

    def _at(self, places: Floats) -> Floats:
        values = np.array([self.function(x, y) for x, y in places.tolist()], np.float64)
        wrong = ~((values >= 0) & (values < np.inf))
        if wrong.any():
            (x, y), value = places[wrong][0], values[wrong][0]
            raise SettingError(
                "sites", f"the density at ({x:.4g}, {y:.4g}) is {value:g}; give 0 or more per mm²"
            )
        return values
