# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""What is filled: any object with a volume, written to a file for the worker."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import FreeCAD as App
import Part

from .backend import WorkerError
from .qt import tr


def why_not(source: Any) -> str | None:
    """Why an object cannot be filled, in words; None if it can."""
    if source is None:
        return tr("The source was deleted: choose another one in the property Source.")
    label = source.Label
    mesh = getattr(source, "Mesh", None)
    if mesh is not None:
        if mesh.CountFacets and mesh.isSolid():
            return None
        return tr(
            "{label} is an open mesh. Close it first: workbench Mesh, Meshes → Fill holes."
        ).format(label=label)
    shape = Part.getShape(source)
    if shape.isNull():
        return tr("{label} has no shape.").format(label=label)
    if not shape.Solids:
        return tr(
            "{label} encloses no volume: choose a solid, a body or a closed mesh. "
            "A sketch has to be padded first."
        ).format(label=label)
    return None


def can_be_filled(source: Any) -> bool:
    """Whether an object may be chosen for a fill."""
    if not hasattr(source, "Mesh") and not hasattr(source, "getGlobalPlacement"):
        return False
    return why_not(source) is None


def frame_of(obj: Any) -> App.Placement:
    """The frame that an object's own placement is given in: its App::Part's, or the document's."""
    return obj.getGlobalPlacement().multiply(obj.Placement.inverse())


def write_source(source: Any, target: Any, folder: Path) -> str:
    """Write the source as `target`'s frame sees it; the path, named after what the file holds.

    So the same shape has the same name, and the worker keeps its sections. A shape that was written
    last is not written again, since each fill asks for it several times. Raises `WorkerError` where
    there is nothing to fill.
    """
    if why := why_not(source):
        raise WorkerError(why)
    placement = seen_from(target, source)
    mesh = getattr(source, "Mesh", None)
    if mesh is not None:
        copy = mesh.copy()
        copy.Placement = placement
        return keep(folder, "source.stl", lambda path: copy.write(path, "STL"))
    shape = Part.getShape(source)
    if path := _last.path_of(shape, placement, folder):
        return path
    copy = shape.copy()
    copy.Placement = placement
    path = keep(folder, "source.brep", copy.exportBrep)
    _last.shape, _last.placement, _last.path = shape, placement, path
    return path


class Written:
    """The shape that was written last."""

    shape: Any = None
    placement: Any = None
    path = ""

    def path_of(self, shape: Any, placement: Any, folder: Path) -> str | None:
        """Its path in a folder, if it is this very shape, at this place."""
        same = self.shape is not None and self.shape.isPartner(shape)
        lies = same and self.placement.toMatrix().A == placement.toMatrix().A
        found = lies and Path(self.path).parent == folder and Path(self.path).is_file()
        return self.path if found else None


_last = Written()


def seen_from(target: Any, obj: Any) -> App.Placement:
    """Where an object lies in the frame of a target, or in the document's if there is none."""
    frame = frame_of(target).inverse() if target is not None else App.Placement()
    # A FEM mesh of FreeCAD 0.20 cannot tell its global placement; it lies in no container.
    tells = hasattr(obj, "getGlobalPlacement")
    return frame.multiply(obj.getGlobalPlacement() if tells else obj.Placement)


def keep(folder: Path, name: str, write: Callable[[str], Any]) -> str:
    """Write a file for the worker; the path, named after what the file holds.

    Raises `WorkerError` where it cannot be written.
    """
    beside = folder / f"writing-{name}"
    try:
        write(str(beside))
        digest = hashlib.sha256(beside.read_bytes()).hexdigest()[:20]
        path = folder / f"{beside.stem.removeprefix('writing-')}-{digest}{beside.suffix}"
        beside.replace(path)
    except (OSError, RuntimeError, Part.OCCError) as error:
        message = tr("the source could not be written ({why}); is the disk full?")
        raise WorkerError(message.format(why=error)) from error
    return str(path)
