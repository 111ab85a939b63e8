"""The command that shows a filled part."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from v3dcad.commands.compiling import load_engine
from v3dcad.commands.part_options import AsBrep, PartFile, Repair, Rotate, Up, part_of
from v3dcad.commands.print_options import Profile, print_settings
from v3dcad.commands.progress import Progress
from v3dcad.commands.rows import print_rows
from v3dcad.errors import SettingError
from v3dcad.options import given, with_options
from v3dcad.settings import FillSettings, PrintSettings

PictureFile = Annotated[Path | None, typer.Option(metavar="FILE", help="Write a picture here.")]


@with_options(FillSettings, PrintSettings)
def view(
    part: PartFile,
    target: Annotated[
        str,
        typer.Option(
            metavar="full|layer|cell|neighbours|neighbour|tree|cut|sizes|overhang|toolpath",
            help="What to show.",
        ),
    ] = "full",
    layer: Annotated[
        int | None, typer.Option(help="The layer, counted from 0. Default: the middle.")
    ] = None,
    cell: Annotated[int | None, typer.Option(help="The cell, by its site's number.")] = None,
    neighbour: Annotated[int | None, typer.Option(help="The cell beside it.")] = None,
    png: PictureFile = None,
    svg: PictureFile = None,
    ids: Annotated[bool, typer.Option("--ids", help="Write each cell's number.")] = False,
    profile: Profile = None,
    verify: Annotated[
        bool, typer.Option(help="Compare what an .ont file makes with its check sum.")
    ] = True,
    rotate: Rotate = None,
    up: Up = None,
    repair: Repair = False,
    as_brep: AsBrep = False,
    **settings: Any,
) -> None:
    """Draw PART, filled: the whole, a layer, a cell, a cut, sizes, overhang or the toolpath."""
    from v3dcad.view.targets.declared import TARGETS

    files = {kind: file for kind, file in (("png", png), ("svg", svg)) if file is not None}
    if not files:
        raise SettingError("png", "nothing to draw: give --png FILE or --svg FILE")
    for kind, file in files.items():
        if file.resolve() == part.resolve():
            message = f"{file}: would overwrite the part itself; name another place"
            raise SettingError(kind, message)
    if target not in TARGETS:
        raise SettingError("target", f"--target {target}: give {', '.join(TARGETS)}")
    chosen = given(FillSettings, settings)
    printing = print_settings(profile, settings)
    load_engine()
    from v3dcad.files import written_beside
    from v3dcad.pipeline import fill

    with Progress() as progress:
        progress.start("reading and cutting the part")
        source = part_of(part, rotate, up, repair, as_brep) or part
        structure = fill(source, verify=verify, progress=progress.step, **chosen)
        for kind, file in files.items():
            progress.start(f"drawing {file}")
            with written_beside(file) as beside:
                beside.write_bytes(
                    structure.picture(
                        target, layer, cell, neighbour, kind=kind, ids=ids, printing=printing
                    )
                )
    print_rows(("written", f"{file} ({file.stat().st_size:,} bytes)") for file in files.values())
