"""Solids as bytes and back: OCCT's own binary format, every double to the last bit."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
from OCP.BinTools import BinTools, BinTools_FormatVersion
from OCP.TopoDS import TopoDS_Shape

from v3dcad.errors import KernelError
from v3dcad.kernel.part import SolidPart, solid_part
from v3dcad.kernel.shapes import FACE, subshapes
from v3dcad.model import Brep, Part

APART = 1e-3
"""mm; largest difference between stated bounds and those that OCCT finds, which its versions may
round differently."""


def brep_of(part: Part) -> Brep:
    """The solids of a part, without triangles; the very bytes that it was read from, if it was.

    (OCCT normalises directions as it reads, so that what it would write again can differ in a
    last bit.) `KernelError` for a part that has no solids.
    """
    if not isinstance(part, SolidPart):
        raise KernelError(f"{part.name}: is not a B-rep")
    if part.stored is not None:
        return part.stored
    for face in subshapes(part.shape, FACE):
        face.Checked(False)  # a flag that meshing clears; the bytes must not depend on it
    stream = io.BytesIO()
    version = BinTools_FormatVersion.BinTools_FormatVersion_CURRENT
    BinTools.Write_s(part.shape, stream, False, False, version)
    return Brep(stream.getvalue(), part.bounds)


def part_in(brep: Brep, name: str) -> SolidPart:
    """The part in what `brep_of` made.

    Its bounds are the stated ones to the last bit, whatever this version of OCCT would find, so
    that sites are scattered in the very same rectangle. Raises `KernelError` where the bytes are
    no solid, or its bounds are others.
    """
    shape = TopoDS_Shape()
    try:
        BinTools.Read_s(shape, io.BytesIO(brep.data))
    except Exception as error:  # whatever OCCT throws
        raise KernelError(f"{name}: OCCT cannot read its B-rep ({error})") from error
    if shape.IsNull():
        raise KernelError(f"{name}: OCCT cannot read its B-rep")
    part = solid_part(shape, name, name)
    if not np.allclose(part.bounds, brep.bounds, rtol=0, atol=APART):
        raise KernelError(f"{name}: its B-rep does not lie within the bounds that the file states")
    return replace(part, bounds=brep.bounds, stored=brep)
