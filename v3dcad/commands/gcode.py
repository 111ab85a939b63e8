"""Commands about G-code files of any slicer."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Annotated

import typer

from v3dcad.commands.compiling import tell_of_compiling
from v3dcad.commands.rows import print_rows

gcode_app = typer.Typer(name="gcode", help="Look at G-code files.", no_args_is_help=True)
nc_app = typer.Typer(
    name="nc", help="Take over and adjust G-code of other programs.", no_args_is_help=True
)


@gcode_app.callback()
def _gcode() -> None: ...


@gcode_app.command()
def info(
    file: Annotated[Path, typer.Argument(help="G-code of any slicer.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Tell bounds, lengths, time, filament and layers of a G-code file."""
    tell_of_compiling()
    from v3dcad.formats.gcode.reader import read_gcode
    from v3dcad.parts import check_readable

    check_readable(file)
    summary = dataclasses.asdict(read_gcode(file))
    if as_json:
        typer.echo(json.dumps(summary, indent=1))
        return
    print_rows(
        (name, f"{value:.6g}" if isinstance(value, float) else value)
        for name, value in summary.items()
    )


@nc_app.command()
def template(
    example: Annotated[Path, typer.Argument(help="A file sliced for the printer.")],
    out: Annotated[
        Path | None, typer.Option(metavar="TOML", help="Profile to write; beside the example.")
    ] = None,
) -> None:
    """Make a machine profile of an example file's header and footer (thesis, Algorithm 12)."""
    from v3dcad.files import written_beside
    from v3dcad.formats.gcode.template import read_template, template_profile
    from v3dcad.parts import check_readable

    check_readable(example)
    found = read_template(example)
    target = out or example.with_suffix(".toml")
    with written_beside(target) as beside:
        beside.write_text(template_profile(found, example.name), encoding="utf-8")
    print_rows([("written", target), ("note", found.finding())])


@nc_app.command()
def adjust(
    source: Annotated[Path, typer.Argument(metavar="IN", help="The file to adjust.")],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="The file to write.")],
    retraction: Annotated[float, typer.Option(help="Filament to name as retracted (mm).")] = 1.0,
) -> None:
    """Take out large Z hops and still moves (thesis, Algorithm 13)."""
    from v3dcad.files import written_beside
    from v3dcad.formats.gcode.path_adjustment import Adjusted
    from v3dcad.formats.gcode.path_adjustment import adjust as adjusted
    from v3dcad.parts import check_readable

    check_readable(source)
    counted = Adjusted()
    with (
        source.open(encoding="latin-1") as lines,
        written_beside(target) as beside,
        beside.open("w", encoding="latin-1", newline="\n") as stream,
    ):
        for line in adjusted((line.rstrip("\r\n") for line in lines), retraction, counted):
            stream.write(line + "\n")
    print_rows(
        [
            ("written", target),
            ("hops", counted.hops),
            ("retractions", counted.retractions),
            ("still moves", counted.still),
        ]
    )
