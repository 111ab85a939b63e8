"""Clock and port for handshakes and jobs: rates tried in turn, heaters off at bad ends."""

from __future__ import annotations

import pytest
from printer.firmware import Firmware
from printer.world import program, state_after

from v3dcad.errors import LocalPrinterError
from v3dcad.printer.drive import (
    BAUDS,
    HEATERS_OFF,
    greet,
    greet_at_any_baud,
    run_job,
    turn_heaters_off,
)
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.job import Job
from v3dcad.printer.settings import PortSettings

FILE = ["M109 S200", "G28", "M83", "G1 X1 Y1 Z0.2 F600", *(f"G1 X{n} E1" for n in range(50))]


class Cable:
    """A link to a simulated printer whose clock moves with every read."""

    def __init__(self, firmware: Firmware, baud: int = 115200) -> None:
        self.firmware = firmware
        self.right = self.baud = baud
        self.now = 0.0
        self.rates: list[int] = []
        self.broken = False

    def clock(self) -> float:
        return self.now

    def set_baud(self, baud: int) -> None:
        self.baud = baud
        self.rates.append(baud)

    def read(self) -> bytes:
        self.now += 0.02
        data = self.firmware.reply(self.now)
        if self.broken:
            raise PrintError(End.LOST, "gone")
        return data if self.baud == self.right else bytes(byte | 0x80 for byte in data)

    def write(self, data: bytes) -> None:
        if self.broken:
            raise PrintError(End.LOST, "gone")
        spoilt = data if self.baud == self.right else bytes(len(data))
        self.firmware.receive(spoilt, self.now)


@pytest.mark.parametrize("baud", BAUDS)
def test_the_rate_is_found(baud: int) -> None:
    cable = Cable(Firmware(), baud)
    greeting, found = greet_at_any_baud(cable, clock=cable.clock)
    assert found == baud
    assert cable.rates == list(BAUDS[: BAUDS.index(baud) + 1])
    assert greeting.firmware.startswith("Marlin")
    assert cable.now < 35


def test_no_rate_fits() -> None:
    cable = Cable(Firmware(), 12345)
    with pytest.raises(PrintError, match="nothing answered at 115200, 250000") as caught:
        greet_at_any_baud(cable, clock=cable.clock)
    assert caught.value.end == End.NO_ANSWER
    assert cable.now < 40


def test_a_printer_in_trouble_is_not_tried_at_other_rates() -> None:
    cable = Cable(Firmware())
    cable.firmware.say("Error:Printer halted. kill() called!", 0.0)
    with pytest.raises(PrintError, match="printer halted"):
        greet_at_any_baud(cable, clock=cable.clock)
    assert cable.rates == [115200]


def job_over(cable: Cable) -> Job:
    return Job(program(FILE), greet(cable, clock=cable.clock), PortSettings())


class OddError(Exception):
    """Something that nobody thought of."""


@pytest.mark.parametrize("error", [OddError(), KeyboardInterrupt(), LocalPrinterError("ours")])
def test_heaters_go_off_whatever_happens(error: BaseException) -> None:
    cable = Cable(Firmware())
    job = job_over(cable)

    def each_turn() -> None:
        if job.snapshot().line == 20:
            raise error

    with pytest.raises(type(error)):
        run_job(job, cable, each_turn=each_turn, clock=cable.clock)
    assert cable.firmware.targets == {"T": 0.0, "B": 0.0}


def test_whether_heaters_could_be_told_is_told() -> None:
    cable = Cable(Firmware())
    job = job_over(cable)

    def each_turn() -> None:
        cable.broken = job.snapshot().line == 20

    with pytest.raises(PrintError, match="gone; the heaters could NOT be told") as caught:
        run_job(job, cable, each_turn=each_turn, clock=cable.clock)
    assert caught.value.end == End.LOST
    cable.broken = False
    assert turn_heaters_off(cable, clock=cable.clock) == "the heaters were told to turn off"


def test_every_heater_goes_off() -> None:
    """Of a second nozzle and a chamber as well; a line that went out in part is ended before."""
    cable = Cable(Firmware())
    cable.write(b"G1 X")
    more = state_after("M104 T1 S200", "M141 S50", "M140 S60").cool()
    turn_heaters_off(cable, more=more, clock=cable.clock)
    assert cable.firmware.obeyed == ["G1 X", *HEATERS_OFF, "M104 T1 S0", "M141 S0"]


def test_a_good_end() -> None:
    cable = Cable(Firmware())
    assert run_job(job_over(cable), cable, each_turn=lambda: None, clock=cable.clock) == "finished"
