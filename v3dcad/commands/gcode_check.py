"""A G-code file looked through before it goes to a printer."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from v3dcad.errors import LocalPrinterError

if TYPE_CHECKING:
    from v3dcad.formats.gcode.reader import Summary
    from v3dcad.printer.fit import Machine
    from v3dcad.printer.program import Program


def checked(file: Path, machine: Machine) -> tuple[Program, Summary]:
    """What is in a file; `LocalPrinterError` if it does not fit the machine."""
    from v3dcad.formats.gcode.reader import read_gcode
    from v3dcad.printer.fit import misfit
    from v3dcad.printer.program import read_program

    program = read_program(file)
    summary = read_gcode(file)
    if wrong := misfit(machine, summary.least, summary.greatest, program.needs):
        raise LocalPrinterError(f"{file} does not fit the printer: {wrong}")
    return program, summary


def machine_of(profile: str | None) -> Machine:
    """The machine of a profile; without one it can be anything."""
    from v3dcad.formats.gcode.machine_profile import read_profile
    from v3dcad.printer.fit import Machine
    from v3dcad.settings import PrintSettings

    return Machine.of(PrintSettings(**read_profile(profile))) if profile else Machine()
