"""Options of how a part is read and put on the bed, for all commands that take one."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from v3dcad.errors import SettingError
from v3dcad.settings import UNITS, option

if TYPE_CHECKING:
    from v3dcad.model import Part

PartFile = Annotated[
    Path, typer.Argument(metavar="PART", help="STEP, STL, 3MF, OBJ, BREP or .ont file.")
]
Rotate = Annotated[
    str | None,
    typer.Option(metavar="X,Y,Z", help="Turn the part about x, then y, then z (°)."),
]
Up = Annotated[
    str | None,
    typer.Option(
        metavar="FACE|x|y|z", help="The plane face (by number, from 0) or axis to point upwards."
    ),
]
Repair = Annotated[bool, typer.Option("--repair", help="Close the holes of a mesh.")]
AsBrep = Annotated[bool, typer.Option("--as-brep", help="Make a B-rep with plane faces of a mesh.")]

Unit = Annotated[
    str | None,
    typer.Option(
        metavar="|".join(UNITS), help="What the numbers of a file without a unit are counted in."
    ),
]
Scale = Annotated[
    float | None, typer.Option(metavar="NUMBER", help="How many times as large the part is made.")
]


def part_of(
    file: Path,
    rotate: str | None = None,
    up: str | None = None,
    repair: bool = False,
    as_brep: bool = False,
    unit: str | None = None,
    scale: float | None = None,
) -> Part | None:
    """The part in a file as the options want it; None for an `.ont`, which takes none of them."""
    from v3dcad.parts import ONT, part_from
    from v3dcad.slicing import place_on_bed

    if file.suffix.lower() in ONT:
        options: dict[str, object] = {"rotate": rotate, "up": up, "repair": repair}
        options |= {"as_brep": as_brep, "unit": unit, "scale": scale}
        for name in (name for name, value in options.items() if value not in (None, False)):
            message = f"{option(name)}: an .ont file holds its part as it was filled"
            raise SettingError(name, message)
        return None
    size = 1.0 if scale is None else scale
    part = part_from(file, repair=repair, as_brep=as_brep, unit=unit, scale=size)
    if rotate is None and up is None:
        return part
    return place_on_bed(part, rotate=_angles(rotate), up=up)


def _angles(text: str | None) -> tuple[float, ...]:
    if text is None:
        return (0.0, 0.0, 0.0)
    try:
        angles = tuple(float(word) for word in text.split(","))
    except ValueError:
        angles = ()
    if len(angles) != 3 or not all(map(math.isfinite, angles)):
        message = f"--rotate {text}: give three angles in degrees, such as 90,0,0"
        raise SettingError("rotate", message)
    return angles
