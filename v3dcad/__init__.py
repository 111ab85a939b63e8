"""v3dcad: fill a part with a 3D Voronoi structure that prints without support.

The names below are loaded when they are first used, so that `import v3dcad` is quick and
loads neither the geometry kernel nor numba.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from v3dcad.version import VERSION

if TYPE_CHECKING:
    from v3dcad.errors import (
        FormatError,
        GeometryError,
        KernelError,
        MissingKernelError,
        SettingError,
        V3dcadError,
    )
    from v3dcad.formats.gcode.machine_profile import print_settings
    from v3dcad.model import Recipe, Section
    from v3dcad.nearness import distance_to, near_faces
    from v3dcad.parts import part_from
    from v3dcad.pipeline import Structure, build, fill
    from v3dcad.recipes import read_ont
    from v3dcad.settings import FillSettings, PrintSettings
    from v3dcad.slicing import Sections, place_on_bed, section
    from v3dcad.structure.fill import fill_sections

__version__ = VERSION

_HOME = {
    "FillSettings": "settings",
    "FormatError": "errors",
    "GeometryError": "errors",
    "KernelError": "errors",
    "MissingKernelError": "errors",
    "PrintSettings": "settings",
    "Recipe": "model",
    "Section": "model",
    "Sections": "slicing",
    "SettingError": "errors",
    "Structure": "pipeline",
    "V3dcadError": "errors",
    "build": "pipeline",
    "distance_to": "nearness",
    "fill": "pipeline",
    "fill_sections": "structure.fill",
    "near_faces": "nearness",
    "part_from": "parts",
    "place_on_bed": "slicing",
    "print_settings": "formats.gcode.machine_profile",
    "section": "slicing",
    "read_ont": "recipes",
}

__all__ = [
    "FillSettings",
    "FormatError",
    "GeometryError",
    "KernelError",
    "MissingKernelError",
    "PrintSettings",
    "Recipe",
    "Section",
    "Sections",
    "SettingError",
    "Structure",
    "V3dcadError",
    "build",
    "distance_to",
    "fill",
    "fill_sections",
    "near_faces",
    "part_from",
    "place_on_bed",
    "print_settings",
    "read_ont",
    "section",
]


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'v3dcad' has no attribute {name!r}")
    return getattr(import_module(f"v3dcad.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__
