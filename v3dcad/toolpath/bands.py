"""Bands between the lines that ribs lie on: what of them a skin takes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from v3dcad.model import Floats, Ints


class Bands(NamedTuple):
    """Stretches of bands: band k lies between y = k · pitch and y = (k + 1) · pitch."""

    pitch: float
    """mm"""
    band: Ints
    """(n,)"""
    ends: Floats
    """(n, 2) mm: x of begin and end"""

    def area(self) -> shapely.Geometry:
        """What they cover."""
        low, high = self.band * self.pitch, (self.band + 1) * self.pitch
        return shapely.union_all(shapely.box(self.ends[:, 0], low, self.ends[:, 1], high))


NO_BANDS = Bands(1.0, np.empty(0, np.int64), np.empty((0, 2)))


def bands(area: shapely.Geometry, pitch: float) -> Bands:
    """Which stretches of bands, `pitch` mm wide, the connected pieces of an area in them take."""
    if area.is_empty:
        return NO_BANDS
    left, low, right, high = shapely.bounds(area).tolist()
    number = np.arange(np.floor(low / pitch), np.ceil(high / pitch)).astype(np.int64)
    within = shapely.box(left, number * pitch, right, (number + 1) * pitch)
    pieces, of = shapely.get_parts(shapely.intersection(area, within), return_index=True)
    solid = shapely.area(pieces) > 0
    bounds = shapely.bounds(pieces[solid]).reshape(-1, 4)
    return Bands(pitch, number[of[solid]], np.ascontiguousarray(bounds[:, ::2]))
