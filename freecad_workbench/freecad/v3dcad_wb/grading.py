# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Cells whose size differs from place to place: what a fill says of it, as v3dcad takes it.

`CellSizeFrom` names the way: an expression; fine near faces; fine where a result of the FEM
workbench has much stress. v3dcad is given an expression each time, faces and stress as files.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import Part

from .backend import WorkerError
from .properties import GROUP, WAYS
from .qt import tr
from .source import keep, seen_from

EXPRESSION, FACES, STRESS = WAYS

SAG, TURN = 0.05, 0.3
"""mm and radians: how far triangles may be from a face."""

PROPERTIES = (
    ("String", "CellSizeExpression", "", EXPRESSION, "Cell size, mm, as an expression of x, y, z."),
    ("LinkSubList", "NearFaces", [], FACES, "Faces that cells are fine near to."),
    ("Length", "CoarseFrom", 20.0, FACES, "Distance from these faces where cells are coarse."),
    ("Link", "StressResult", None, STRESS, "Result of the FEM workbench: cells are fine where its "
     "von Mises stress is high."),
    ("Float", "LowStress", 0.0, STRESS, "Stress in MPa where cells are coarse."),
    ("Float", "HighStress", 0.0, STRESS, "Stress in MPa where cells are fine; 0 for the largest."),
    ("Length", "FineSize", 3.0, "", "Size of fine cells."),
    ("Length", "CoarseSize", 8.0, "", "Size of coarse cells."),
)  # fmt: skip
"""Type, name, default, the way that it belongs to, help."""

NAMES = tuple(name for _, name, *_ in PROPERTIES)


@dataclass
class Sizes:
    """What the properties say, or the fields of a panel."""

    way: str
    values: dict[str, Any]
    """by the properties' names, in mm and MPa; faces as pairs of an object and names"""


def add(obj: Any) -> None:
    """Give a fill the properties that it lacks."""
    for kind, name, default, _, text in PROPERTIES:
        if name not in obj.PropertiesList:
            obj.addProperty(f"App::Property{kind}", name, GROUP, tr(text))
            if default:
                setattr(obj, name, default)
    show(obj)


def show(obj: Any) -> None:
    """Show the properties of the chosen way alone."""
    for _, name, _, way, _ in PROPERTIES:
        shown = obj.Method == "foam" and is_used(way, obj.CellSizeFrom)
        obj.setEditorMode(name, 0 if shown else 2)


def is_used(way: str, chosen: str) -> bool:
    """Whether a value that belongs to a way, or to faces and stress, counts for the chosen one."""
    return way == chosen if way else chosen in (FACES, STRESS)


def way_of(name: str) -> str:
    """The way that is meant by who sets a property; "" where none is."""
    return next((way for _, known, _, way, _ in PROPERTIES if known == name), "")


def sizes_of(obj: Any) -> Sizes:
    """What a fill's properties say."""
    values = {name: getattr(obj, name) for name in NAMES}
    return Sizes(
        obj.CellSizeFrom, {name: getattr(one, "Value", one) for name, one in values.items()}
    )


def set_sizes(obj: Any, sizes: Sizes) -> None:
    """Set the properties that count for the way."""
    for _, name, _, way, _ in PROPERTIES:
        if is_used(way, sizes.way):
            setattr(obj, name, sizes.values[name])


def expression_of(sizes: Sizes, target: Any, folder: Path) -> str:
    """The cell size as v3dcad takes it, in a target's frame; files are written to a folder.

    Raises `WorkerError` where something is not chosen yet, or has no stress.
    """
    values = sizes.values
    if sizes.way == EXPRESSION:
        if not values["CellSizeExpression"].strip():
            raise WorkerError(tr("Write the cell size as an expression, such as 3 + 0.1 * z."))
        return str(values["CellSizeExpression"])
    fine, coarse = values["FineSize"], values["CoarseSize"]
    if sizes.way == FACES:
        path, far = _faces_file(values["NearFaces"], target, folder), values["CoarseFrom"]
        if far <= 0:
            raise WorkerError(tr("Give the distance where cells are coarse, more than 0."))
        return f"ramp(distance({path!r}), 0, {far!r}, {fine!r}, {coarse!r})"
    path, largest = _stress_file(values["StressResult"], target, folder)
    low, high = values["LowStress"], values["HighStress"] or largest
    if high <= low:
        raise WorkerError(tr("Give a high stress that is above the low one."))
    return f"ramp(table({path!r}), {low!r}, {high!r}, {coarse!r}, {fine!r})"


def results_in(document: Any) -> list[Any]:
    """The objects of a document that have a stress."""
    return [obj for obj in document.Objects if "vonMises" in obj.PropertiesList]


def _faces_file(chosen: list[Any], target: Any, folder: Path) -> str:
    """The chosen faces as triangles."""
    import MeshPart

    faces = []
    for obj, names in chosen:
        shape = Part.getShape(obj).copy()
        shape.Placement = seen_from(target, obj)
        numbers = [name.split(".")[-1] for name in names]
        faces += [shape.getElement(name) for name in numbers if name.startswith("Face")]
    if not faces:
        raise WorkerError(tr("Select faces in the view, then press “Take the selected faces”."))
    mesh = MeshPart.meshFromShape(
        Shape=Part.makeCompound(faces), LinearDeflection=SAG, AngularDeflection=TURN
    )
    return keep(folder, "faces.stl", lambda path: mesh.write(path, "STL"))


def _stress_file(result: Any, target: Any, folder: Path) -> tuple[str, float]:
    """The nodes of a result with their stress, as a table; and the largest stress, MPa."""
    if result is None:
        raise WorkerError(tr("Choose a result of the FEM workbench."))
    stress, mesh = list(getattr(result, "vonMises", [])), getattr(result, "Mesh", None)
    if not stress or mesh is None or len(result.NodeNumbers) != len(stress):
        raise WorkerError(tr("{label} has no von Mises stress.").format(label=result.Label))
    move, nodes = seen_from(target, mesh), mesh.FemMesh.Nodes
    # The nodes lie where the mesh object puts them.
    move = move.multiply(mesh.Placement.inverse()) if hasattr(mesh, "Placement") else move
    rows = []
    for number, value in zip(result.NodeNumbers, stress):  # noqa: B905, Python of old FreeCADs
        at = move.multVec(nodes[number])
        rows.append(f"{at.x!r},{at.y!r},{at.z!r},{float(value)!r}\n")

    def write(path: str) -> None:
        Path(path).write_text("".join(rows), encoding="utf-8")

    return keep(folder, "stress.csv", write), max(stress)
