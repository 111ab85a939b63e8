"""The command line: the app its commands hang on, and what becomes of errors."""

from __future__ import annotations

import sys

import typer

from v3dcad.commands import fill, gcode, ont, ports, print_port, printer, setup, view
from v3dcad.commands import slice as slicing
from v3dcad.errors import V3dcadError

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback()
def _app() -> None:
    """Fill a part with a 3D Voronoi structure that prints without support."""


app.command()(fill.fill)
app.command()(fill.info)
app.command()(view.view)
app.command("slice")(slicing.slice_part)
app.command("print")(print_port.print_file)
app.command()(ports.ports)
app.command()(ports.console)
app.command()(printer.send)
app.command()(setup.warm_up)
app.add_typer(ont.ont_app)
app.add_typer(gcode.gcode_app)
app.add_typer(gcode.nc_app)
app.add_typer(printer.printer_app)


def main() -> None:
    """Run the command line; errors become one line on stderr and exit code 2, Ctrl-C code 130."""
    try:
        app()
    except V3dcadError as error:
        print(f"v3dcad: {error}", file=sys.stderr)
        sys.exit(2)
