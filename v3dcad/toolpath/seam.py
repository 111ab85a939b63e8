"""Where an outermost perimeter begins and ends: its seam."""

from __future__ import annotations

import math

import numpy as np

from v3dcad.model import Floats

GOLDEN = (math.sqrt(5) - 1) / 2
NEAR = 2.0
"""mm: seams this close to one on the layer below lie above it."""
STEP = 1e6
"""Heights of corners that differ by less than 1 / `STEP` mm are the same."""


class Seams:
    """Chooses seams, layer by layer; keeps those of the layer below.

    `how` is "aligned" (above the seam below; else in the sharpest corner), "rear" (the rearmost
    corner) or "scattered" (somewhere else on each layer, by the golden ratio).
    """

    def __init__(self, how: str) -> None:
        self.how = how
        self._layer = 0
        self._below: list[Floats] = []
        self._here: list[Floats] = []

    def rise(self) -> None:
        """Go on to the next layer."""
        self._layer += 1
        self._below, self._here = self._here or self._below, []

    def corner(self, points: Floats) -> int:
        """Which of a closed line's points (k, 2), mm, it begins at."""
        found = self._corner(points)
        self._here.append(points[found])
        return found

    def _corner(self, points: Floats) -> int:
        if self.how == "scattered":
            steps = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
            along = self._layer * GOLDEN % 1.0 * steps.sum()
            return int(np.searchsorted(np.cumsum(steps) - steps, along) % len(points))
        if self.how == "aligned" and self._below:
            apart = np.hypot(*(points[:, None] - np.array(self._below)[None]).transpose(2, 0, 1))
            nearest = int(apart.min(axis=1).argmin())
            if apart[nearest].min() < NEAR:
                return nearest
        turn = np.zeros(len(points)) if self.how == "rear" else np.rint(10 * _turns(points))
        return int(np.lexsort((points[:, 0], np.rint(points[:, 1] * STEP), turn))[-1])


def _turns(points: Floats) -> Floats:
    """By which angle, radians, a closed line (k, 2) turns at each point; either way."""
    arriving = points - np.roll(points, 1, axis=0)
    leaving = np.roll(points, -1, axis=0) - points
    cross = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0]
    return np.asarray(np.abs(np.arctan2(cross, (arriving * leaving).sum(axis=1))))
