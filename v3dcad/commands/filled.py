"""A part read and filled as the options of a command want it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from v3dcad.commands.estimate import estimated, tell
from v3dcad.commands.part_options import part_of
from v3dcad.commands.progress import Progress

if TYPE_CHECKING:
    from v3dcad.pipeline import Structure
    from v3dcad.settings import PrintSettings

SitesFile = Annotated[
    Path | None,
    typer.Option(metavar="CSV", help="Sites as x,y,z in mm, or x,y for columns; bed coordinates."),
]
Verify = Annotated[bool, typer.Option(help="Compare what an .ont file makes with its check sum.")]


def filled(
    part: Path,
    settings: dict[str, Any],
    printing: PrintSettings,
    progress: Progress,
    *,
    sites_file: Path | None,
    verify: bool,
    gcode: Path | None = None,
    **options: Any,
) -> Structure:
    """The part in a file, filled by settings for a way to print it; the engine has been loaded.

    `options` are those of `part_of`. What takes long is told before it begins, and refused where
    there is no room for it, nor for the file `gcode`.
    """
    from v3dcad.limits import check_cells
    from v3dcad.pipeline import fill
    from v3dcad.recipes import known_settings

    if sites_file is not None:
        from v3dcad.formats.sites_csv import read_sites
        from v3dcad.parts import check_readable

        check_readable(sites_file)
        settings = {**settings, "sites": read_sites(sites_file)}
    progress.start("reading and cutting the part")
    source = part_of(part, **options)
    if source is not None and sites_file is None:
        known = known_settings(settings)
        if gcode is not None:
            check_cells(known.cell_size, source.bounds, printing)
        expected = estimated(source.bounds, known)
        if expected is not None:
            progress.pause()
            tell(expected, gcode)
            progress.go_on()
    return fill(
        source or part, verify=verify, progress=progress.step, printing=printing, **settings
    )
