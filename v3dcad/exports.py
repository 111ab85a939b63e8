"""Writing one file of a structure, whatever its kind, and what a print takes, in words."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from v3dcad.errors import SettingError
from v3dcad.files import is_stream
from v3dcad.settings import ExportSettings

if TYPE_CHECKING:
    from v3dcad.pipeline import Structure
    from v3dcad.report import Print

KINDS = {
    "gcode": (".gcode",),
    "ont": (".ont",),
    "step": (".step", ".stp"),
    "png": (".png",),
    "stl": (".stl",),
    "threemf": (".3mf",),
    "brep": (".brep", ".brp"),
    "svg": (".svg",),
}
"""Kinds of files, and how their names end."""

NO_SOLID = (
    "the STL holds walls without thickness, which are no solid: as solid, struts or beads it is one"
)

UNWRITTEN = (".jpg", ".jpeg", ".gif", ".webp", ".tif", ".tiff", ".bmp", ".pdf")
"""How pictures end that are not written."""


def kind_of(file: Path) -> str:
    """The kind of a file by its ending; `SettingError` for one that is not written."""
    ending = file.suffix.lower()
    for kind, endings in KINDS.items():
        if ending in endings:
            return kind
    known = ", ".join(ending for endings in KINDS.values() for ending in endings)
    raise SettingError("to", f"{file}: not a kind of file that is written; give {known}")


def export(
    structure: Structure,
    kind: str,
    file: Path,
    how: ExportSettings,
    bead_width: float,
    printed: Print | None = None,
) -> None:
    """Write one file of a kind that is not G-code, which tells more than that it was written.

    What it told (`printed`) comes into the picture's title.
    """
    if kind == "ont":
        structure.write_ont(file, None if how.boundary == "auto" else how.boundary)
    elif kind == "png":
        structure.write_picture(file, kind="png", printed=printed)
    elif kind == "svg":
        structure.write_svg(file, how.svg_layer)
    elif kind == "stl":
        sizes = how.sizes(how.stl_as, bead_width)
        structure.write_stl(file, how.stl_as, ascii=how.stl_ascii, **sizes)
        if how.stl_as == "walls":
            warnings.warn(NO_SOLID, stacklevel=2)
    elif kind == "threemf":
        structure.write_3mf(file, how.threemf_as, **how.sizes(how.threemf_as, bead_width))
    else:
        write = structure.write_step if kind == "step" else structure.write_brep
        write(file, how.step_as, **how.sizes(how.step_as, bead_width))


def written_line(file: Path) -> str:
    """A written file and its size; a device or pipe has none."""
    if is_stream(file):
        return f"{file}"
    return f"{file} ({file.stat().st_size:,} bytes)"


def print_lines(printed: dict[str, Any]) -> dict[str, str]:
    """What a print takes (see `Structure.report`), as lines to show."""
    from v3dcad.report import hours_text

    return {
        "print time": f"{hours_text(printed['time_s'])}, without heating",
        "filament": f"{printed['filament_mm'] / 1000:.2f} m, {printed['mass_g']:.1f} g",
        "spans": printed["spans"],
    }
