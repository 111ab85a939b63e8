"""Commands for printers by name, and the one that sends a file to one."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from v3dcad.commands.progress import Progress
from v3dcad.commands.rows import print_rows
from v3dcad.errors import SettingError
from v3dcad.options import given, with_options
from v3dcad.printer.settings import HostSettings

if TYPE_CHECKING:
    from v3dcad.printer.fit import Machine
    from v3dcad.printer.http_link import Address

printer_app = typer.Typer(
    name="printer", help="Name printers that have a print server.", no_args_is_help=True
)

Name = Annotated[str, typer.Argument(metavar="NAME", help="The printer's name.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]


@printer_app.command()
@with_options(HostSettings)
def add(name: Name, **settings: Any) -> None:
    """Name a printer. Its key is asked for, or read from standard input; never an option."""
    from v3dcad.printer import address_book

    chosen = given(HostSettings, settings)
    for needed in ("kind", "url"):
        if needed not in chosen:
            raise SettingError(needed, f"--{needed} is missing; see v3dcad printer add --help")
    new = HostSettings(**chosen)
    if not re.fullmatch(r"https?://[^@?#\s]+", new.url):
        raise SettingError(
            "url", "--url: write http://HOST or https://HOST, without user, password, ? and #"
        )
    _machine(new)
    secret = _secret("password" if new.user else "key")
    file = address_book.add(name, new)
    where = address_book.set_key(name, secret)
    rows = [("printer", f"{name}, {new.kind} at {new.url}"), ("written", str(file))]
    print_rows([*rows, ("key", f"in {where}" if secret else "none")])


@printer_app.command("list")
def list_printers(as_json: AsJson = False) -> None:
    """List the named printers; keys are not shown."""
    from v3dcad.printer.address_book import printers

    known = printers()
    if as_json:
        rows = [{"name": name, **asdict(settings)} for name, settings in known.items()]
        typer.echo(json.dumps(rows, indent=1))
    elif known:
        print_rows((name, f"{one.kind} at {one.url}") for name, one in known.items())
    else:
        typer.echo("no printers yet; v3dcad printer add names one")


@printer_app.command("test")
def ask_printer(name: Name, as_json: AsJson = False) -> None:
    """Ask a printer's server for version and state; says what is wrong otherwise."""
    from v3dcad.printer.hosts.kinds import host_of
    from v3dcad.printer.http_link import carry

    settings, address = _known(name)
    state = carry(host_of(settings.kind).state(), address)
    if as_json:
        found = {"version": state.version, "state": state.state, "ready": state.ready}
        typer.echo(json.dumps({"name": name, **found}))
        return
    ready = "ready" if state.ready else "not ready to print"
    print_rows([("printer", name), ("server", state.version), ("state", f"{state.state}; {ready}")])


@printer_app.command()
def remove(name: Name) -> None:
    """Forget a printer and its key."""
    from v3dcad.printer.address_book import remove as forget

    forget(name)
    print_rows([("removed", name)])


def send(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="G-code of any slicer.")],
    to: Annotated[
        str | None, typer.Option(metavar="NAME", help="The printer; v3dcad printer list.")
    ] = None,
    profile: Annotated[
        str | None,
        typer.Option(metavar="NAME|TOML", help="A profile that names the printer."),
    ] = None,
    start: Annotated[
        bool, typer.Option("--start", help="Start the print, if the printer is ready.")
    ] = False,
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace a file of the same name without asking.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Upload FILE to a named printer. Nothing is printed unless --start is given."""
    from v3dcad.commands.gcode_check import checked
    from v3dcad.printer.hosts.kinds import host_of
    from v3dcad.printer.sending import Sending

    name = to or _named_by(profile)
    settings, address = _known(name)
    program, _ = checked(file, _machine(settings, profile))
    with Progress() as progress:
        bar = progress.count(f"sending {file.name}", program.size)
        sending = Sending(host_of(settings.kind), address, file, program.sha256, bar)
        sending.check(start=start)
        if sending.exists() and not replace:
            progress.pause()
            _ask_to_replace(file.name, name)
            progress.go_on()
        where = sending.send(start=start)
    state = "printing" if start else "not started"
    if as_json:
        typer.echo(json.dumps({"printer": name, "file": where, "started": start}))
    else:
        print_rows([("sent", f"{file} to {name}"), ("lies at", where), ("state", state)])


def _known(name: str) -> tuple[HostSettings, Address]:
    from v3dcad.printer.address_book import key, printer
    from v3dcad.printer.http_link import Address

    settings = printer(name)
    return settings, Address(settings.url, key(name), settings.user)


def _named_by(profile: str | None) -> str:
    from v3dcad.formats.gcode.machine_profile import read_profile

    if profile is None:
        raise SettingError("to", "no printer: give --to NAME; v3dcad printer list shows them")
    name = read_profile(profile).get("printer", "")
    if not name:
        raise SettingError("profile", f'{profile} names no printer; write printer = "NAME" in it')
    return str(name)


def _secret(what: str) -> str:
    """The key, typed unseen or piped in; "" where a server needs none."""
    if sys.stdin.isatty():
        import getpass

        return getpass.getpass(f"{what} (Enter for none): ").strip()
    return sys.stdin.readline().strip()


def _machine(settings: HostSettings, profile: str | None = None) -> Machine:
    """What a printer can do: bed and height of a profile, its own first, and its own limits."""
    from v3dcad.commands.gcode_check import machine_of

    return replace(
        machine_of(settings.profile or profile),
        nozzle=settings.nozzle or None,
        hottest_nozzle=settings.hottest_nozzle or None,
        hottest_bed=settings.hottest_bed or None,
    )


def _ask_to_replace(name: str, printer: str) -> None:
    if not sys.stdin.isatty():
        raise SettingError("replace", f"{name} is on {printer} already; --replace replaces it")
    typer.confirm(f"{name} is on {printer} already. Replace it?", abort=True, err=True)
