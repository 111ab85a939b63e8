"""What the nozzle extrudes without stopping."""

from __future__ import annotations

from typing import NamedTuple

from v3dcad.model import Bytes, Floats


class Stroke(NamedTuple):
    """One stroke of the nozzle: `points` (k + 1, 2), mm, and for each of the k steps

    its feature (RETRACED where nothing is extruded), how many mm of full bead are laid, and
    the centre (k, 2) where it is an arc (else NaN).
    """

    points: Floats
    feature: Bytes
    laid: Floats
    centre: Floats
