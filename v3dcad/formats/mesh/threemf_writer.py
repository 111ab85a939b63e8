"""3MF by lib3mf: meshes, and beam lattices with the mesh that other viewers show instead."""

from __future__ import annotations

import uuid
from pathlib import Path
from typing import Any

import numpy as np
from lib3mf import Lib3MF

from v3dcad.errors import FormatError
from v3dcad.model import Floats, Ints, Mesh

WRAPPER = Lib3MF.Wrapper()

MIN_LENGTH = 1e-4
"""mm; readers join the ends of beams shorter than this."""


def write_mesh(path: Path, mesh: Mesh, name: str) -> None:
    """Write a closed mesh, mm, as the one item of a 3MF file; the same mesh, the same bytes."""
    model = _model()
    item = _object(model, mesh, name, "mesh")
    _finish(model, item, path)


def write_beams(
    path: Path, points: Floats, beams: Ints, radius: float, name: str, fallback: Mesh | None
) -> None:
    """Write beams (b, 2) between points (v, 3), mm, as a beam lattice of one radius, mm.

    `fallback` is a mesh of the same bars, for readers that do not know beams. Raises `FormatError`
    where the file cannot be written.
    """
    model = _model()
    # The fallback of an object has to come before it in the file.
    shown = _object(model, fallback, f"{name} as a mesh", "fallback") if fallback else None
    item = _object(model, Mesh(points, np.empty((0, 3), np.int64)), name, "beams")
    lattice = item.BeamLattice()
    lattice.SetMinLength(MIN_LENGTH)
    lattice.SetBeams(_records(Lib3MF.Beam, _BEAM, Indices=beams, Radii=radius))
    if shown is not None:
        lattice.SetRepresentation(shown.GetResourceID())
    _finish(model, item, path)


_POSITION = np.dtype([("Coordinates", "<f4", 3)])
_TRIANGLE = np.dtype([("Indices", "<u4", 3)])
_BEAM = np.dtype([("Indices", "<u4", 2), ("Radii", "<f8", 2), ("CapModes", "<i4", 2)])
"""Laid out as lib3mf's records; cap mode 0 is a sphere."""


def _records(kind: Any, layout: np.dtype[Any], **columns: Any) -> Any:
    """Columns as an array of lib3mf's records."""
    count = max(len(column) for column in columns.values() if np.ndim(column))
    rows = np.zeros(count, layout)
    for column, values in columns.items():
        rows[column] = values
    return (kind * count).from_buffer(rows) if count else []


def _model() -> Any:
    model = WRAPPER.CreateModel()
    model.SetUnit(Lib3MF.ModelUnit.MilliMeter)
    return model


def _object(model: Any, mesh: Mesh, name: str, role: str) -> Any:
    item = model.AddMeshObject()
    item.SetName(name)
    item.SetGeometry(
        _records(Lib3MF.Position, _POSITION, Coordinates=mesh.vertices),
        _records(Lib3MF.Triangle, _TRIANGLE, Indices=mesh.triangles),
    )
    item.SetUUID(_identity(role, name))
    return item


def _finish(model: Any, item: Any, path: Path) -> None:
    built = model.AddBuildItem(item, WRAPPER.GetIdentityTransform())
    built.SetUUID(_identity("item", item.GetName()))
    model.SetBuildUUID(_identity("build", item.GetName()))
    try:
        model.QueryWriter("3mf").WriteToFile(str(path))
    except Lib3MF.ELib3MFException as error:
        raise FormatError(f"lib3mf cannot write it ({error})", path=str(path)) from error


def _identity(*words: str) -> str:
    """A UUID that depends on nothing but the words: lib3mf would draw one at random."""
    return str(uuid.uuid5(uuid.NAMESPACE_URL, "/".join(("v3dcad", *words))))
