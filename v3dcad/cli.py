"""The command line: reads options, shows progress, prints tables; computes nothing itself."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from v3dcad.errors import SettingError, V3dcadError
from v3dcad.options import taken, with_options
from v3dcad.settings import FillSettings, PrintSettings

if TYPE_CHECKING:
    from v3dcad.model import Layer
    from v3dcad.pipeline import Structure

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)

OUTPUTS = ("gcode", "ont", "step", "png", "report")
"""What `fill` writes, in this order: the one that may refuse the part comes first."""

ENDINGS = {"report": "json"}

OutputFile = Annotated[Path | None, typer.Option(metavar="FILE", help="Write just this file.")]


def main() -> None:
    """Run the command line; errors become one line on stderr and exit code 2."""
    try:
        app()
    except V3dcadError as error:
        print(f"v3dcad: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("v3dcad: stopped", file=sys.stderr)
        sys.exit(130)


@app.callback()
def _app() -> None:
    """Fill a part with a 3D Voronoi structure that prints without support."""


@app.command()
@with_options(FillSettings, PrintSettings)
def fill(
    part: Annotated[Path, typer.Argument(metavar="PART", help="STEP, STL, BREP or .ont file.")],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for all five files.")
    ] = None,
    sites_file: Annotated[
        Path | None,
        typer.Option(metavar="CSV", help="Sites as x,y in mm, bed coordinates; not scattered."),
    ] = None,
    ont: OutputFile = None,
    gcode: OutputFile = None,
    step: OutputFile = None,
    png: OutputFile = None,
    report: OutputFile = None,
    **settings: Any,
) -> None:
    """Fill PART and write .ont, G-code, STEP, a picture and a report."""
    named = {"ont": ont, "gcode": gcode, "step": step, "png": png, "report": report}
    files = _files(part, out, named)
    from v3dcad.pipeline import fill as fill_part

    chosen = taken(FillSettings, settings)
    printing = taken(PrintSettings, settings)
    with _Progress() as progress:
        progress.start("reading and cutting the part")
        structure = fill_part(part, **_given(part, chosen, sites_file))
        watched = replace(structure, layers=progress.watch(structure.layers))
        for kind, file in files.items():
            progress.start(f"writing {file}")
            if kind == "gcode":
                watched.write_gcode(file, printing)
            else:
                getattr(watched, f"write_{kind}")(file)
        progress.start("counting")
        summary = watched.report()
    _print_summary(structure, summary, files)


def _given(part: Path, chosen: FillSettings, sites_file: Path | None) -> dict[str, Any]:
    """The settings to pass on: for an `.ont` file only what differs from the defaults."""
    given = {name: getattr(chosen, name) for name in FillSettings.__dataclass_fields__}
    if part.suffix.lower() == ".ont":
        defaults = FillSettings()
        given = {name: value for name, value in given.items() if value != getattr(defaults, name)}
    if sites_file is not None:
        from v3dcad.formats.sites_csv import read_sites

        given["sites"] = read_sites(sites_file)
    return given


def _files(part: Path, out: Path | None, named: dict[str, Path | None]) -> dict[str, Path]:
    files: dict[str, Path] = {}
    for kind in OUTPUTS:
        file = named[kind]
        if file is None and out is not None:
            file = out / f"{part.stem}.{ENDINGS.get(kind, kind)}"
        if file is not None:
            files[kind] = file
    if not files:
        raise SettingError("out", "nothing to write: give --out DIR, or a file such as --gcode F")
    for kind, file in files.items():
        if file.resolve() == part.resolve():
            raise SettingError(kind, f"{file}: would overwrite the part itself; name another file")
    return files


def _print_summary(structure: Structure, summary: dict[str, Any], files: dict[str, Path]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(show_header=False, box=None, pad_edge=False)
    width, depth, height = summary["size_mm"]
    rows = {
        "part": f"{summary['part']}, {width:.6g} × {depth:.6g} × {height:.6g} mm",
        "layers": f"{summary['layers']}",
        "cells": f"{summary['cells']}",
        "walls": f"{summary['walls']}",
        "wall length": f"{summary['wall_length_mm'] / 1000:.3f} m",
    }
    for name, value in rows.items():
        table.add_row(name, value)
    for file in files.values():
        table.add_row("written", f"{file} ({file.stat().st_size:,} bytes)")
    for finding in structure.findings(files):
        table.add_row("note", finding)
    Console(soft_wrap=True, highlight=False).print(table)


@app.command()
def info(file: Annotated[Path, typer.Argument(help="STEP, STL, BREP or .ont file.")]) -> None:
    """Tell what a part or an .ont file holds."""
    from v3dcad.pipeline import describe

    for name, value in describe(file).items():
        typer.echo(f"{name:<14}{value}")


class _Progress:
    """A bar on a terminal, nothing in a pipe."""

    def __enter__(self) -> _Progress:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        console = Console(stderr=True)
        self.bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TimeElapsedColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self.task = self.bar.add_task("", total=None)
        self.bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.bar.stop()

    def start(self, what: str) -> None:
        """Begin a step of the work whose length is not known yet."""
        self.bar.reset(self.task, total=None, description=what)

    def watch(self, layers: Sequence[Layer]) -> Sequence[Layer]:
        """The same layers; going through them moves the bar."""
        return _Watched(layers, self)


class _Watched(Sequence["Layer"]):
    def __init__(self, layers: Sequence[Layer], progress: _Progress) -> None:
        self.layers = layers
        self.progress = progress

    def __len__(self) -> int:
        return len(self.layers)

    def __getitem__(self, index: Any) -> Any:
        return self.layers[index]

    def __iter__(self) -> Iterator[Layer]:
        bar, task = self.progress.bar, self.progress.task
        bar.update(task, total=len(self.layers), completed=0)
        for layer in self.layers:
            yield layer
            bar.advance(task)
