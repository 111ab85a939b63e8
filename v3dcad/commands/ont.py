"""Commands about `.ont` files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from v3dcad.commands.compiling import load_engine
from v3dcad.commands.outputs import check_outputs
from v3dcad.commands.rows import print_rows
from v3dcad.warm_up import CELLS

ont_app = typer.Typer(name="ont", help="Check and convert .ont files.", no_args_is_help=True)

File = Annotated[Path, typer.Argument(help="An .ont file.")]


@ont_app.command()
def info(file: File) -> None:
    """Tell what an .ont file holds."""
    from v3dcad.recipes import describe_ont

    print_rows(describe_ont(file).items())


@ont_app.command()
def check(file: File) -> None:
    """Make the structure again and compare it with the file's check sum."""
    load_engine(CELLS)
    from v3dcad.ont import check as checked

    print_rows(checked(file).items())


@ont_app.command()
def convert(
    file: File,
    out: Annotated[Path, typer.Argument(metavar="OUT", help="The file to write.")],
    boundary: Annotated[
        str, typer.Option(metavar="exact|stl", help="The part: exact, or stl as in the thesis.")
    ] = "exact",
    verify: Annotated[bool, typer.Option(help="Compare with the check sum first.")] = True,
) -> None:
    """Write an .ont file with its boundary in another form."""
    check_outputs(file, {"ont": out})
    load_engine(CELLS)
    from v3dcad.exports import written_line
    from v3dcad.ont import convert as converted

    converted(file, out, boundary, verify=verify)
    print_rows([("written", written_line(out))], [out])
