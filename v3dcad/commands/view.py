"""The command that shows a filled part."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from v3dcad.commands.compiling import load_engine
from v3dcad.commands.filled import SitesFile, Verify, filled
from v3dcad.commands.outputs import check_outputs
from v3dcad.commands.part_options import (
    AsBrep,
    PartFile,
    Repair,
    Rotate,
    Scale,
    Unit,
    Up,
)
from v3dcad.commands.print_options import Profile, print_settings
from v3dcad.commands.progress import Progress
from v3dcad.commands.rows import print_rows
from v3dcad.commands.show_page import page_place, serve_file, show_file
from v3dcad.errors import SettingError
from v3dcad.options import given, with_options
from v3dcad.settings import FillSettings, PrintSettings
from v3dcad.warm_up import CELLS

if TYPE_CHECKING:
    from v3dcad.pipeline import Structure

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
    ids: Annotated[
        bool, typer.Option("--ids", help="Write each cell's number into pictures.")
    ] = False,
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the page for the browser here.")
    ] = None,
    no_open: Annotated[
        bool, typer.Option("--no-open", help="Do not open the page in the browser.")
    ] = False,
    serve: Annotated[
        bool, typer.Option("--serve", help="Follow PART: load the page again when it is written.")
    ] = False,
    sites_file: SitesFile = None,
    profile: Profile = None,
    verify: Verify = True,
    rotate: Rotate = None,
    up: Up = None,
    repair: Repair = False,
    as_brep: AsBrep = False,
    unit: Unit = None,
    scale: Scale = None,
    **settings: Any,
) -> None:
    """Show PART, filled: a page in the browser, or pictures of what a target shows."""
    from v3dcad.view.targets.declared import target_of

    files = {
        kind: file
        for kind, file in (("png", png), ("svg", svg), ("html", html))
        if file is not None
    }
    if serve and files:
        kind = next(iter(files))
        raise SettingError(kind, f"--serve keeps the page in memory; leave out --{kind}")
    check_outputs(part, files)
    target_of(target)
    chosen = given(FillSettings, settings)
    printing = print_settings(profile, settings)
    load_engine(CELLS)
    from v3dcad.exports import written_line
    from v3dcad.view.page.first import First

    def structure_of(progress: Progress) -> Structure:
        structure = filled(
            part, chosen, printing, progress, sites_file=sites_file, verify=verify,
            rotate=rotate, up=up, repair=repair, as_brep=as_brep, unit=unit, scale=scale,
        )  # fmt: skip
        return replace(structure, layers=progress.watch(structure.layers))

    first = First(target, layer, cell, neighbour)
    if serve:

        def make(number: int) -> str:
            with Progress(f"drawing {part.name}") as progress:
                return structure_of(progress).page(printing, first, live=number)

        serve_file(part, make, not no_open)
        return
    if not files:
        files["html"] = page_place(part)
    with Progress(f"drawing {part.name}", 1 + len(files)) as progress:
        structure = structure_of(progress)
        for kind, file in files.items():
            progress.start(f"drawing {file}")
            if kind == "html":
                structure.write_html(file, printing, first)
                continue
            structure.write_picture(
                file, target, layer, cell, neighbour, kind=kind, ids=ids, printing=printing
            )
    print_rows(
        [
            *(("written", written_line(file)) for file in files.values()),
            *(("note", finding) for finding in structure.findings()),
        ],
        files.values(),
    )
    if "html" in files:
        show_file(files["html"], not no_open)
