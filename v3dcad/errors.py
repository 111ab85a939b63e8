"""The errors v3dcad raises. Every message says what, where, and what to do.

V3dcadError
├── SettingError          a setting or argument outside its range (knows its name)
│   └── OutOfRangeError       a number of a layer, face … that is not there; an IndexError too
├── GeometryError         input geometry that cannot be computed with (knows layer and site)
├── FormatError           a file that cannot be read (knows path, line and section)
├── KernelError           OCCT refused a shape
│   └── MissingKernelError    OCP cannot be imported
└── PrinterError
    ├── LocalPrinterError     our side: port, settings, protocol misuse
    └── RemotePrinterError    the printer's side: what it answered, or did not

The command line turns each into one line on stderr and exit code 2. Messages are written once,
with options of the command line: `--layer-height`. From Python they name arguments.
"""

from __future__ import annotations

import re

OPTION = re.compile(r"(?<![\w-])--(no-)?([a-z][a-z0-9]*(?:-[a-z0-9]+)*)")


def with_arguments(text: str) -> str:
    """A text that names options of the command line, with the arguments of Python instead.

    `--layer-height` becomes `layer_height`, `--no-verify` becomes `verify=False`.
    """

    def argument(found: re.Match[str]) -> str:
        return found[2].replace("-", "_") + ("=False" if found[1] else "")

    return OPTION.sub(argument, text)


class V3dcadError(Exception):
    """Base of all errors that v3dcad raises on purpose.

    `str()` says it with the arguments of Python, `message` with the options of the command line:
    that is what another error's message is made of, if it goes on with this one's.
    """

    def __init__(self, message: str) -> None:
        self.message = message
        super().__init__(message)

    def __str__(self) -> str:
        return with_arguments(self.message)


class SettingError(V3dcadError):
    """A setting that is outside its range, or does not fit the part."""

    def __init__(self, name: str, message: str) -> None:
        self.name = name
        super().__init__(message)


class OutOfRangeError(SettingError, IndexError):
    """A number of a layer, section or face beyond those that there are.

    An `IndexError` as well, by which Python ends its walk through a sequence.
    """


class GeometryError(V3dcadError):
    """Sites, sections or a part that cannot be computed with."""

    def __init__(self, message: str, *, layer: int | None = None, site: int | None = None) -> None:
        self.layer = layer
        self.site = site
        where = [
            f"{word} {number}"
            for word, number in (("layer", layer), ("site", site))
            if number is not None
        ]
        super().__init__(f"{', '.join(where)}: {message}" if where else message)


class FormatError(V3dcadError):
    """A file whose content cannot be read; carries where it went wrong."""

    def __init__(
        self, message: str, *, path: str, line: int | None = None, section: str | None = None
    ) -> None:
        self.path = path
        self.line = line
        self.section = section
        where = path
        if line is not None:
            where += f", line {line}"
        if section is not None:
            where += f", section [{section}]"
        super().__init__(f"{where}: {message}")


class KernelError(V3dcadError):
    """The geometry kernel (OCCT) could not do what was asked of a shape."""


class MissingKernelError(KernelError):
    """OCP, the Python binding of OCCT, cannot be imported on this machine."""


class PrinterError(V3dcadError):
    """Printing over a serial port went wrong."""


class LocalPrinterError(PrinterError):
    """The fault is on this side of the cable."""


class RemotePrinterError(PrinterError):
    """The fault is on the printer's side of the cable."""
