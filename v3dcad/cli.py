"""The command line: the app its commands hang on, and what becomes of errors."""

from __future__ import annotations

import gc
import signal
import sys
import threading
from typing import Annotated, Any, NoReturn

import typer

from v3dcad.commands import fill, gcode, ont, ports, print_port, printer, setup, view
from v3dcad.commands import slice as slicing
from v3dcad.errors import V3dcadError
from v3dcad.version import VERSION

FEW = 50_000
"""New objects after which Python looks for cycles that nobody needs. Modules and arrays leave few:
with its own 700 that takes a twelfth of a fill."""

AGAIN = 0.05
"""Seconds after which a signal that was swallowed comes once more."""

app = typer.Typer(
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _tell_version(asked: bool) -> None:
    if asked:
        typer.echo(f"v3dcad {VERSION}")
        raise typer.Exit


@app.callback()
def _app(
    version: Annotated[
        bool,
        typer.Option("--version", help="Show the version.", is_eager=True, callback=_tell_version),
    ] = False,
) -> None:
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
    """Run the command line; errors become one line on stderr and exit code 2, Ctrl-C code 130.

    SIGTERM and SIGHUP end it as Ctrl-C does, so that no half-written file is left.
    """
    gc.set_threshold(FEW)
    usual = {
        "SIGINT": signal.default_int_handler,
        "SIGTERM": signal.SIG_DFL,
        "SIGHUP": signal.SIG_DFL,
    }
    for name, handler in usual.items():
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == handler:
            signal.signal(number, _end)
    try:
        sys.exit(app(prog_name="v3dcad", standalone_mode=False))
    except V3dcadError as error:
        _fail(error.message)
    except typer.TyperException as error:
        if not error.format_message():  # help was shown in its place
            sys.exit(2)
        _fail(_usage(error))
    except typer.Abort:
        sys.exit(1)
    except KeyboardInterrupt:  # before typer listens, which ends with the same number
        sys.exit(128 + signal.SIGINT)
    except MemoryError:
        _fail("not enough memory for this: take larger cells, or layers farther apart")


def _end(number: int, _: object) -> NoReturn:
    # What a signal leaves half made may fail to be taken apart, as in the compiler: Python would
    # tell of that. And what ends the command is itself swallowed where it comes in a destructor or
    # in one of the compiler's callbacks: then the signal comes once more, when that is over.
    def ignored(unraisable: sys.UnraisableHookArgs) -> None:
        if isinstance(unraisable.exc_value, (KeyboardInterrupt, SystemExit)):
            again = threading.Timer(AGAIN, signal.raise_signal, (number,))
            again.daemon = True
            again.start()

    sys.unraisablehook = ignored
    if number == signal.SIGINT:
        raise KeyboardInterrupt
    sys.exit(128 + number)


def _fail(message: str) -> NoReturn:
    print(f"v3dcad: {message}", file=sys.stderr)
    sys.exit(2)


def _usage(error: Any) -> str:
    """A mistake in the words of a command, in one line that says what may have been meant."""
    if near := getattr(error, "possibilities", None):
        return f"no such option: {error.option_name}; did you mean {near[0]}?"
    words = " ".join(error.format_message().split()).rstrip(".").replace(". Did", "; did")
    words = words[:1].lower() + words[1:]
    if words.endswith("?"):
        return words
    command = error.ctx.command_path if getattr(error, "ctx", None) else "v3dcad"
    return f"{words}; see {command} --help"
