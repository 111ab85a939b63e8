"""Clock and port for what knows neither: handshakes and jobs driven over a link."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Protocol

from v3dcad.errors import PrinterError
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.handshake import Greeting, Handshake
from v3dcad.printer.job import Job

BAUDS = (115200, 250000, 57600, 230400, 500000, 1_000_000, 19200, 9600)
"""Rates that printers use, the most used first."""
HEATERS_OFF = ("M104 S0", "M140 S0")
LISTEN = 1.0
"""Seconds that a port stays open after a bad end, so that the last bytes get out."""

Clock = Callable[[], float]


class Link(Protocol):
    """Bytes in and out; `read` waits only a moment."""

    def read(self) -> bytes:
        """The bytes that are here."""

    def write(self, data: bytes) -> None:
        """Send bytes."""


class TunableLink(Link, Protocol):
    """A link whose rate can be set."""

    def set_baud(self, baud: int) -> None:
        """Go on at another rate."""


class Talk(Protocol):
    """What is driven: a handshake or a job."""

    def data_to_send(self) -> bytes:
        """The bytes that are due to go out, once."""

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the printer."""

    def wake_at(self) -> float | None:
        """When `due` wants to be called."""

    def due(self, now: float) -> None:
        """Do what the clock asks for."""


def converse(
    talk: Talk,
    link: Link,
    over: Callable[[], bool],
    *,
    each_turn: Callable[[], None] = lambda: None,
    clock: Clock = time.monotonic,
) -> None:
    """Carry bytes between both until `over`; `each_turn` is called some 50 times a second.

    Raises what the talk or the link raises; `Patience` bounds how long a silent printer is
    waited for.
    """
    while not over():
        each_turn()
        if data := talk.data_to_send():
            link.write(data)
        data = link.read()
        now = clock()
        if data:
            talk.receive(data, now)
        wake = talk.wake_at()
        if wake is not None and now >= wake:
            talk.due(now)


def greet(
    link: Link,
    *,
    fresh: bool = True,
    again: float = 2.5,
    tries: int = 6,
    each_turn: Callable[[], None] = lambda: None,
    clock: Clock = time.monotonic,
) -> Greeting:
    """Shake hands over a link; see `Handshake`."""
    talk = Handshake(clock(), fresh=fresh, again=again, tries=tries)
    converse(talk, link, lambda: talk.greeting is not None, each_turn=each_turn, clock=clock)
    assert talk.greeting is not None
    return talk.greeting


def greet_at_any_baud(
    link: TunableLink,
    *,
    fresh: bool = True,
    each_turn: Callable[[], None] = lambda: None,
    clock: Clock = time.monotonic,
) -> tuple[Greeting, int]:
    """Shake hands at each rate of `BAUDS` until a printer is understood; the rate as well.

    The first rate is given the time that a board needs after a reset; it has passed then.
    """
    for baud in BAUDS:
        tries = 4 if baud == BAUDS[0] else 1
        link.set_baud(baud)
        try:
            return greet(link, fresh=fresh, tries=tries, each_turn=each_turn, clock=clock), baud
        except PrintError as error:
            if error.end != End.NO_ANSWER:
                raise
    raise PrintError(
        End.NO_ANSWER,
        f"nothing answered at {', '.join(map(str, BAUDS))} baud; is the printer on, and the port "
        "the right one?",
    )


def run_job(
    job: Job, link: Link, *, each_turn: Callable[[], None], clock: Clock = time.monotonic
) -> End:
    """Print to a good end, which is returned.

    At a bad one the heaters are turned off as far as the printer still listens; then what went
    wrong is raised, with a word on whether that could be sent.
    """
    try:
        job.start(clock())
        converse(job, link, lambda: job.end is not None, each_turn=each_turn, clock=clock)
    except PrinterError as error:
        sent = turn_heaters_off(link, job.data_to_send(), job.state.cool(), clock)
        if isinstance(error, PrintError):
            raise PrintError(error.end, f"{error.reason}; {sent}") from error
        raise
    except BaseException:
        turn_heaters_off(link, job.data_to_send(), job.state.cool(), clock)
        raise
    assert job.end is not None
    return job.end


def turn_heaters_off(
    link: Link, first: bytes = b"", more: Sequence[str] = (), clock: Clock = time.monotonic
) -> str:
    """Try to turn the heaters off, after bytes that are still due; what became of it, in words.

    `more` turns off further nozzles and heaters. The line feed before all ends a line that may have
    gone out in part.
    """
    lines = ["", *dict.fromkeys([*HEATERS_OFF, *more]), ""]
    try:
        link.write(first + "\n".join(lines).encode())
        until = clock() + LISTEN
        while clock() < until:
            link.read()
    except PrinterError:
        return "the heaters could NOT be told to turn off: check them"
    return "the heaters were told to turn off"
