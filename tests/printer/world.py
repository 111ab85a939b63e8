"""A printer and what drives it under one clock that the test owns."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from printer.firmware import Firmware

from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.handshake import Greeting, Handshake
from v3dcad.printer.job import Job
from v3dcad.printer.machine_state import MachineState
from v3dcad.printer.patience import Patience
from v3dcad.printer.progress import Line
from v3dcad.printer.settings import PortSettings

HOURS = 100 * 3600.0
TURNS = 3_000_000
PATIENCE = Patience()


def program(commands: Iterable[str]) -> list[Line]:
    """Commands as a file of theirs, a line each."""
    lines, offset = [], 0
    for number, command in enumerate(commands, 1):
        offset += len(command) + 1
        lines.append(Line(number, command, offset))
    return lines


def state_after(*commands: str) -> MachineState:
    """The state that commands leave a machine in."""
    state = MachineState()
    for command in commands:
        state.follow(command)
    return state


class World:
    """Runs what talks (a handshake or a job) against a firmware, event by event."""

    def __init__(self, firmware: Firmware) -> None:
        self.firmware = firmware
        self.now = 0.0
        self.quietest = 0.0
        """the longest time in which nothing happened on the line, s"""

    def shake_hands(self, **options: object) -> Greeting:
        talk = Handshake(self.now, **options)  # type: ignore[arg-type]
        self._run(talk, lambda: talk.greeting is not None)
        assert talk.greeting is not None
        return talk.greeting

    def run(self, job: Job, *do: tuple[Callable[[], bool], Callable[[], None]]) -> End:
        """Run a job to its end; each of `do` happens once, as soon as its condition holds."""
        pending = list(do)

        def over() -> bool:
            for pair in [pair for pair in pending if pair[0]()]:
                pending.remove(pair)
                pair[1]()
            return job.end is not None

        job.start(self.now)
        try:
            self._run(job, over)
        except PrintError as error:
            self.firmware.receive(job.data_to_send(), self.now)
            return error.end
        assert job.end is not None
        assert not pending, "not everything happened"
        return job.end

    def _run(self, talk: Job | Handshake, over: Callable[[], bool]) -> None:
        last_word = self.now
        for _ in range(TURNS):
            if over():
                return
            data = talk.data_to_send()
            if data:
                self.firmware.receive(data, self.now)
            said = self.firmware.reply(self.now)
            if not self.firmware.connected and not said:
                raise PrintError(End.LOST, "the cable is out")
            if said:
                self.quietest = max(self.quietest, self.now - last_word)
                last_word = self.now
                talk.receive(said, self.now)
                continue
            times = [t for t in (talk.wake_at(), self.firmware.next_event()) if t is not None]
            assert times, "nobody waits for anything: this hangs"
            self.now = max(self.now, min(times))
            assert self.now < HOURS, "this takes too long"
            talk.due(self.now)
        raise AssertionError("this goes round in circles")


def job_for(
    firmware: Firmware, commands: Iterable[str], world: World | None = None, **options: object
) -> tuple[World, Job]:
    """A world in which hands have been shaken, and a job to run in it."""
    world = world or World(firmware)
    greeting = world.shake_hands()
    firmware.obeyed.clear()
    firmware.numbers.clear()
    job = Job(program(commands), greeting, PortSettings(), **options)  # type: ignore[arg-type]
    return world, job


def of_the_file(obeyed: list[str]) -> list[str]:
    """What was obeyed, without what hosts ask by themselves."""
    return [command for command in obeyed if command not in ("M105", "M400", "M155 S2")]
