"""The kinds of print servers, by the name that `--kind` takes."""

from __future__ import annotations

from v3dcad.printer.hosts.moonraker import Moonraker
from v3dcad.printer.hosts.octoprint import OctoPrint
from v3dcad.printer.hosts.prusalink import PrusaLink
from v3dcad.printer.hosts.requests import Host

KINDS: dict[str, type[OctoPrint] | type[Moonraker] | type[PrusaLink]] = {
    "octoprint": OctoPrint,
    "moonraker": Moonraker,
    "prusalink": PrusaLink,
}


def host_of(kind: str) -> Host:
    """A host of a kind."""
    return KINDS[kind]()
