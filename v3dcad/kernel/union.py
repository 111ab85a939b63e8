"""Solids that meet: which of them overlap, by how much, and all of them as one body."""

from __future__ import annotations

from functools import cache, lru_cache

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BRepBndLib import BRepBndLib
from OCP.TopoDS import TopoDS_Shape

from v3dcad.errors import KernelError
from v3dcad.geometry.mesh.bodies import Pairs
from v3dcad.geometry.section_union import meeting
from v3dcad.kernel.booleans import common, fused
from v3dcad.kernel.shapes import SOLID, subshapes, volume

NEGLIGIBLE = 1e-9
"""Share of the lesser solid's volume: what two solids share below it comes of rounding."""

LOSS = 1e-6
"""By which share OCCT's union may miss the volume that it must have."""


@lru_cache(maxsize=4)
def solids_meet(shape: TopoDS_Shape) -> bool:
    """Whether the boxes of two of a shape's solids touch or overlap."""
    return bool(_meeting_boxes(list(subshapes(shape, SOLID))))


def _meeting_boxes(solids: list[TopoDS_Shape]) -> list[tuple[int, int]]:
    if len(solids) < 2:
        return []
    boxes = np.empty((len(solids), 2, 3))
    for number, solid in enumerate(solids):
        box = Bnd_Box()
        BRepBndLib.Add_s(solid, box, False)
        boxes[number] = box.CornerMin().Coord(), box.CornerMax().Coord()
    return [(i, j) for i, j in meeting(boxes[:, 0], boxes[:, 1]).tolist()]


def overlaps(shape: TopoDS_Shape) -> tuple[Pairs, float]:
    """The pairs of a shape's solids that overlap, and by how much the sum of the solids' volumes
    exceeds that of their union, mm³. `KernelError` where OCCT cannot tell.
    """
    solids = list(subshapes(shape, SOLID))
    volume_of = cache(lambda number: volume(solids[number]))  # each as slow as a boolean
    pairs: Pairs = []
    for i, j in _meeting_boxes(solids):
        shared = volume(common([solids[i]], [solids[j]]))
        if shared > 0 and shared > NEGLIGIBLE * min(volume_of(i), volume_of(j)):
            pairs.append((i, j, shared))
    excess = 0.0
    for number, solid in enumerate(solids):
        before = [(i, shared) for i, j, shared in pairs if j == number]
        if len(before) > 1:
            excess += volume(common([solid], [solids[i] for i, _ in before]))
        else:
            excess += sum(shared for _, shared in before)
    return pairs, excess


def one_body(shape: TopoDS_Shape) -> TopoDS_Shape:
    """A shape's solids united where they meet; the shape itself where none do.

    `KernelError` where OCCT cannot unite them.
    """
    if not solids_meet(shape):
        return shape
    solids = list(subshapes(shape, SOLID))
    whole = fused(solids[:1], solids[1:])
    expected = volume(shape) - overlaps(shape)[1]
    if not abs(volume(whole) - expected) <= LOSS * expected:
        raise KernelError(
            f"OCCT's union of the part's {len(solids)} solids has {volume(whole):.6g} mm³ instead "
            f"of {expected:.6g}: unite them where the part was made"
        )
    return whole
