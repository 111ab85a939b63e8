"""Recipes (`.ont` files) and the parts in them: read, changed, told; nothing is built here."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.formats.mesh.stl import welded
from v3dcad.model import Brep, Mesh, Part, Recipe
from v3dcad.parts import MeshPart, check_readable, part_from
from v3dcad.settings import FillSettings

BOUNDARIES = ("stl", "exact")
"""How an `.ont` file may hold the part: as the thesis does, or to the last bit and small."""


def boundary_form(boundary: str | None, part: Part) -> str:
    """The form that was asked for, or else the usual one: B-reps exactly, triangles as STL.

    `SettingError` where there is no such form.
    """
    if boundary is None:
        return "stl" if isinstance(part, MeshPart) else "exact"
    if boundary not in BOUNDARIES:
        raise SettingError("boundary", f"--boundary {boundary}: give stl or exact")
    return boundary


def boundary_of(part: Part) -> Mesh | Brep:
    """A part as a recipe holds it, exactly."""
    if isinstance(part, MeshPart):
        return welded(part.surface.vertices[part.surface.triangles], part.name)
    from v3dcad.kernel.brep_bytes import brep_of

    return brep_of(part)


def part_of(recipe: Recipe) -> Part:
    """The part in a recipe; `KernelError` where its B-rep cannot be read."""
    if isinstance(recipe.boundary, Mesh):
        return MeshPart(recipe.name, recipe.boundary)
    from v3dcad.kernel.brep_bytes import part_in

    return part_in(recipe.boundary, recipe.name)


def read_ont(path: str | Path) -> Recipe:
    """The recipe in an `.ont` file; `FormatError` with line and section where it is damaged."""
    from v3dcad.formats.ont import document as ont

    check_readable(Path(path))
    return ont.read_ont(Path(path))


def known_settings(chosen: dict[str, Any]) -> FillSettings:
    """The settings of a call; `SettingError` for a name that is none."""
    for name in chosen:
        if name not in FillSettings.__dataclass_fields__:
            raise SettingError(name, f"there is no setting {name!r}")
    return FillSettings(**chosen)


def changed(recipe: Recipe, sites: Any, settings: dict[str, Any]) -> Recipe:
    """The recipe of another structure, which has no check sum yet.

    Another random seed, or a number of sites, scatters them anew; places (n, 2) take their place.
    """
    kept = recipe.sites
    if isinstance(sites, int):
        kept, settings = None, {**settings, "sites": sites}
    elif sites is not None:
        flat = np.asarray(sites, dtype=np.float64).reshape(-1, 2)
        kept = np.column_stack([flat, np.zeros(len(flat))])
        settings = {**settings, "sites": len(flat)}
    elif "random_seed" in settings:
        kept = None
    before = {name: getattr(recipe.settings, name) for name in FillSettings.__dataclass_fields__}
    return replace(
        recipe, settings=known_settings({**before, **settings}), sites=kept, checksum=None
    )


def told(recipe: Recipe) -> dict[str, str]:
    """What a recipe says besides its part, as lines to show."""
    usual = FillSettings()
    others = {
        name.replace("_", " "): f"{getattr(recipe.settings, name)}"
        for name in FillSettings.__dataclass_fields__
        if name not in ("offset", "layer_height", "sites")
        and getattr(recipe.settings, name) != getattr(usual, name)
    }
    scattered = "scattered again from the random seed" if recipe.sites is None else "listed"
    return {
        "kind": ".ont",
        "written by": recipe.software or "another program, in the thesis's form",
        "boundary": "triangles" if isinstance(recipe.boundary, Mesh) else "B-rep",
        "offset": f"{float(recipe.settings.offset):g} mm² a layer",
        "layer height": f"{recipe.settings.layer_height:g} mm",
        "sites": f"{recipe.settings.sites}, {scattered}",
        **others,
        "check sum": "none" if recipe.checksum is None else f"{recipe.checksum.sha256[:16]}…",
    }


def describe(path: Path) -> dict[str, str]:
    """What a part or an `.ont` file holds, as lines to show."""
    if path.suffix.lower() == ".ont":
        recipe = read_ont(path)
        part, held = part_of(recipe), told(recipe)
    else:
        part = part_from(path)
        held = {"kind": "triangles" if isinstance(part, MeshPart) else "B-rep"}
    low, high = part.bounds
    corners = [", ".join(f"{value:.6g}" for value in corner) for corner in (low, high)]
    return {
        "name": part.name,
        **held,
        "size": " × ".join(f"{value:.6g}" for value in high - low) + " mm",
        "from, to": f"({corners[0]}), ({corners[1]}) mm",
        **part.contents(),
        **{f"note {k}": finding for k, finding in enumerate(part.findings, start=1)},
    }
