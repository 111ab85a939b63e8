"""How a print, or the talk with a print server, can end. Every end has a name."""

from __future__ import annotations

from enum import StrEnum

from v3dcad.errors import RemotePrinterError


class End(StrEnum):
    """The names of a print's ends, as messages and `--json` give them."""

    FINISHED = "finished"
    CANCELLED = "cancelled"
    HALTED = "printer halted"
    LOST = "connection lost"
    NO_ANSWER = "no answer"
    FILE = "file changed"


class PrintError(RemotePrinterError):
    """The print ended otherwise than it should have; `end` names how, `reason` says more."""

    def __init__(self, end: End, reason: str) -> None:
        self.end = end
        self.reason = reason
        super().__init__(f"{end}: {reason}")


class HostFault(StrEnum):
    """What can be wrong with a print server."""

    UNREACHABLE = "unreachable"
    KEY = "wrong key"
    KIND = "wrong kind"
    FULL = "no room"
    BUSY = "busy"
    CUT = "connection cut"
    HOSTILE = "not understood"
    OTHER = "refused"


class HostError(RemotePrinterError):
    """A print server cannot do what was asked of it; `fault` names why."""

    def __init__(self, fault: HostFault, message: str) -> None:
        self.fault = fault
        super().__init__(message)
