"""How a print can end. Every end has a name."""

from __future__ import annotations

from enum import StrEnum

from v3dcad.errors import RemotePrinterError


class End(StrEnum):
    """The names of ends, as messages and `--json` give them."""

    FINISHED = "finished"
    CANCELLED = "cancelled"
    HALTED = "printer halted"
    LOST = "connection lost"
    NO_ANSWER = "no answer"
    FILE = "file changed"


class PrintError(RemotePrinterError):
    """The print ended otherwise than it should have; `end` names how."""

    def __init__(self, end: End, message: str) -> None:
        self.end = end
        self.message = message
        super().__init__(f"{end}: {message}")
