"""A print from its first line to its end, against a simulated printer and a clock of the test's."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from printer.firmware import CHECKS_NUMBERS, NAMES, Faults, Firmware
from printer.world import World, job_for, of_the_file, program

from v3dcad.errors import LocalPrinterError, SettingError
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.handshake import Greeting, Handshake
from v3dcad.printer.job import LAST_WORD, Job
from v3dcad.printer.progress import Phase
from v3dcad.printer.sender import HISTORY, Sender
from v3dcad.printer.settings import PortSettings

FILE = ["M140 S60", "M109 S200", "G28", "M83", "G1 X0 Y0 Z0.2 F600",
        *(f"G1 X{i} E0.1 F1200" for i in range(1, 40))]  # fmt: skip


class Diary:
    """Remembers what a journal is told."""

    def __init__(self) -> None:
        self.told: list[tuple[str, int, int]] = []

    def sent(self, line: int, wire: int) -> None:
        self.told.append(("sent", line, wire))

    def acknowledged(self, line: int, wire: int) -> None:
        self.told.append(("acknowledged", line, wire))

    def parked(self, lift: float, retraction: float) -> None:
        self.told.append(("parked", round(lift), round(retraction)))


@pytest.mark.parametrize("kind", sorted(NAMES))
def test_the_journal_is_told_before_and_after(kind: str) -> None:
    diary = Diary()
    world, job = job_for(Firmware(kind), FILE, recorder=diary)
    assert world.run(job) == End.FINISHED
    assert diary.told[0] == ("acknowledged", 0, 0)
    sent = [told[1:] for told in diary.told if told[0] == "sent"]
    assert sent == [(n, n) for n in range(1, len(FILE) + 1)] + [(len(FILE), len(FILE) + 1)]
    assert diary.told[-1] == ("acknowledged", len(FILE), len(FILE) + 1)
    for number, told in enumerate(diary.told):
        if told[0] == "acknowledged" and told[2]:
            assert ("sent", *told[1:]) in diary.told[:number]


@pytest.mark.parametrize("kind", sorted(NAMES))
@pytest.mark.parametrize("line", [3, 10, len(FILE)])
def test_pause_at_any_line(kind: str, line: int) -> None:
    firmware = Firmware(kind, advanced=True)
    world, job = job_for(firmware, FILE)
    end = world.run(
        job,
        (lambda: job.snapshot().line >= line, lambda: job.pause(world.now)),
        (lambda: job.phase == Phase.PAUSED and world.now > 20, lambda: job.resume(world.now)),
    )
    assert end == End.FINISHED
    obeyed = of_the_file(firmware.obeyed)
    start = next((n for n, command in enumerate(obeyed) if command == "G1 E-2 F1800"), None)
    if start is None:
        assert obeyed == FILE, "where the place is not known there is no parking"
        return
    before = [line for line in obeyed[: start - 2] if line != "M84 S0"]
    assert ("M84 S0" in obeyed) is (kind in CHECKS_NUMBERS)
    assert before == FILE[: len(before)]
    rest = FILE[len(before) :]
    assert obeyed[len(obeyed) - len(rest) :] == rest
    assert obeyed.index("G1 E2 F1800") > start


@pytest.mark.parametrize("kind", sorted(NAMES))
@pytest.mark.parametrize("line", [0, 2, 10, len(FILE)])
def test_cancel_at_any_line(kind: str, line: int) -> None:
    firmware = Firmware(kind)
    world, job = job_for(firmware, FILE)
    end = world.run(job, (lambda: job.snapshot().line >= line, lambda: job.cancel(world.now)))
    assert end == End.CANCELLED
    if kind != "repetier":  # which says ok to a line that still waits
        assert firmware.targets == {"T": 0.0, "B": 0.0}
    job.cancel(world.now)
    assert job.end == End.CANCELLED


@pytest.mark.parametrize("emergency_parser", [True, False])
def test_cancel_while_heating(emergency_parser: bool) -> None:
    """With EMERGENCY_PARSER at once; without when the nozzle is warm, which the printer rules."""
    firmware = Firmware(
        emergency_parser=emergency_parser,
        seconds=lambda command: 300.0 if command.startswith("M109") else 0.001,
    )
    world, job = job_for(firmware, FILE)
    begun = world.now
    busy = (lambda: job.snapshot().doing == "processing", lambda: job.cancel(world.now))
    end = world.run(job, busy)
    assert end == End.CANCELLED
    assert firmware.targets == {"T": 0.0, "B": 0.0}
    assert (world.now - begun < 100) is emergency_parser


def test_a_pause_at_the_very_end_waits_for_the_last_move_all_the_same() -> None:
    firmware = Firmware()
    world, job = job_for(firmware, FILE)
    end = world.run(
        job,
        (lambda: "M400" in firmware.obeyed, lambda: job.pause(world.now)),
        (lambda: job.phase == Phase.PAUSED, lambda: job.resume(world.now)),
    )
    assert end == End.FINISHED
    assert "M400" in firmware.obeyed[firmware.obeyed.index("G1 E2 F1800") :]


def test_cancel_turns_every_heater_off() -> None:
    """The nozzle that waits as well; whatever the block for cancels says."""
    firmware = Firmware()
    world = World(firmware)
    file = ["M104 T1 S150", "M140 S60", *FILE]
    job = Job(program(file), world.shake_hands(), PortSettings(cancel_gcode="M84 ; off"))
    cancel = (lambda: job.snapshot().line == 20, lambda: job.cancel(world.now))
    assert world.run(job, cancel) == End.CANCELLED
    assert of_the_file(firmware.obeyed)[-4:] == ["M84", "M104 T1 S0", "M104 S0", "M140 S0"]


def test_cancel_while_paused() -> None:
    firmware = Firmware()
    world, job = job_for(firmware, FILE)
    end = world.run(
        job,
        (lambda: job.snapshot().line == 20, lambda: job.pause(world.now)),
        (lambda: job.phase == Phase.PAUSED, lambda: job.cancel(world.now)),
    )
    assert end == End.CANCELLED
    job.pause(world.now)
    job.resume(world.now)
    assert job.phase == Phase.ENDED


def test_emergency_stop_goes_first() -> None:
    firmware = Firmware(seconds=lambda command: 60.0)
    job = Job(program(FILE), Greeting("Marlin", checks_numbers=True), PortSettings())
    job.start(0.0)
    with pytest.raises(PrintError, match="emergency stop") as caught:
        job.stop()
    assert caught.value.end == End.HALTED
    data = job.data_to_send()
    assert data.startswith(b"\nM112\n"), "the line before may have gone out in part"
    firmware.receive(data, 0.0)
    assert firmware.halted


@pytest.mark.parametrize("action", ["pause", "paused"])
def test_the_printer_asks_for_a_pause(action: str) -> None:
    firmware = Firmware(faults=Faults(when_obeyed={20: "pause"}))
    firmware.faults.to_host = lambda line, count: line.replace(b"pause", action.encode())
    world, job = job_for(firmware, FILE)
    asked = []

    def resume() -> None:
        asked.append(world.now)
        firmware.say("//action:resume", world.now)

    assert world.run(job, (lambda: job.phase == Phase.PAUSED, resume)) == End.FINISHED
    assert asked
    assert of_the_file(firmware.obeyed) == FILE, "a printer that pauses parks by itself"


def test_the_printer_cancels() -> None:
    firmware = Firmware()
    world, job = job_for(firmware, FILE)

    def cancel() -> None:
        firmware.say("//action:cancel", world.now)
        firmware.say("//action:dance", world.now)
        firmware.say("//action:prompt_begin Filament runout", world.now)

    assert world.run(job, (lambda: job.snapshot().line == 20, cancel)) == End.CANCELLED
    assert list(job.told.messages) == ["Filament runout"]


def test_overrides() -> None:
    firmware = Firmware()
    world, job = job_for(firmware, FILE)
    change = (
        lambda: job.snapshot().line == 20,
        lambda: job.override(world.now, speed=80, flow=105),
    )
    assert world.run(job, change) == End.FINISHED
    assert [line for line in of_the_file(firmware.obeyed) if line not in FILE] == [
        "M220 S80", "M221 S105", "M220 S100", "M221 S100"
    ]  # fmt: skip
    assert (job.snapshot().speed, job.snapshot().flow) == (80, 105)
    job.override(world.now, speed=70)
    job.override(world.now, flow=100)
    assert (job.snapshot().speed, job.snapshot().flow) == (70, 100)
    for wrong in ({"speed": 9}, {"speed": 501}, {"flow": 49}, {"flow": 201}):
        with pytest.raises(SettingError):
            job.override(world.now, **wrong)


def test_what_is_shown() -> None:
    file = [*FILE, "M73 P50 R7", "G1 Z0.4", "G1 X5 E1"]
    firmware = Firmware(seconds=lambda command: 5.0 if command == "G28" else 0.5)
    world, job = job_for(firmware, file)
    seen: list[str] = []
    world.run(
        job,
        (lambda: job.snapshot().doing != "", lambda: seen.append(job.snapshot().doing)),
        (lambda: job.snapshot().line == 1, lambda: firmware.say("echo:hello", world.now)),
        (lambda: job.snapshot().line == 2, lambda: firmware.say("Error:SD init fail", world.now)),
    )
    assert seen == ["processing"]
    now = job.snapshot()
    assert (now.layer, now.height, now.minutes_left, now.doing) == (2, 0.4, 7.0, "")
    assert now.temperatures == {"T": (200.0, 200.0), "B": (60.0, 60.0)}
    assert now.offset == sum(len(line) + 1 for line in file)
    assert list(job.told.messages) == ["echo:hello", "SD init fail"]


def test_a_printer_that_reports_temperatures_is_not_asked() -> None:
    greeting = Greeting("Marlin", {"AUTOREPORT_TEMP": True}, checks_numbers=True)
    firmware = Firmware(seconds=lambda command: 3.0)
    job = Job(program(FILE[:8]), greeting, PortSettings())
    assert World(firmware).run(job) == End.FINISHED
    assert firmware.obeyed[0] == "M155 S2"
    assert firmware.obeyed.count("M105") == 1, "only once, at the end"


def test_a_printer_that_never_says_temperatures_ends_all_the_same() -> None:
    firmware = Firmware("repetier")
    world, job = job_for(firmware, FILE)
    firmware.faults.to_host = lambda line, count: b"" if line.startswith(b"T:") else line
    assert world.run(job) == End.FINISHED
    assert world.now < LAST_WORD + 20


def test_misuse_is_refused() -> None:
    sender = Sender(checks_numbers=True)
    with pytest.raises(LocalPrinterError, match="more than one line"):
        sender.send("G1 X1\nG1 X2", 0.0)
    sender.send("G28", 0.0)
    with pytest.raises(LocalPrinterError, match="buffer is full"):
        sender.send("G1 X1", 0.0)
    for ask in (sender.ask, sender.probe):
        with pytest.raises(LocalPrinterError, match="wait until idle"):
            ask(0.0)
    assert sender.due(1.0) == []


def test_answers_that_nobody_asked_for_change_nothing() -> None:
    sender = Sender(checks_numbers=True)
    assert sender.wake_at() is None
    sender.receive(b"ok\nok N7 P15 B3\nskip 99\n", 0.0)
    assert (sender.acknowledged, sender.newest) == (0, 0)
    assert sender.idle


@given(st.integers(HISTORY, 3 * HISTORY))
def test_a_request_from_long_ago_is_a_reset(count: int) -> None:
    sender = Sender(checks_numbers=True)
    for number in range(1, count + 1):
        sender.send("G1 X1", 0.0)
        sender.receive(b"ok\n", 0.0)
        assert sender.acknowledged == number
    with pytest.raises(PrintError, match="it was reset"):
        sender.receive(b"Resend: 1\n", 0.0)


@pytest.mark.parametrize(
    ("words", "kind", "message"),
    [
        (b"Grbl 1.1h ['$' for help]\n", LocalPrinterError, "this is Grbl 1.1h, which has no"),
        (b"Error:Printer halted. kill() called!\n", PrintError, "printer halted: the printer"),
    ],
)
def test_first_words_that_end_it(words: bytes, kind: type, message: str) -> None:
    with pytest.raises(kind, match=message):
        Handshake(0.0).receive(words, 0.0)


def test_another_baud_rate_is_recognised() -> None:
    talk = Handshake(0.0, tries=2)
    talk.receive(b"\xf8\x80\x00\n\xff\x8f\n", 0.1)
    talk.due(2.5)
    with pytest.raises(PrintError, match="baud rate is another"):
        talk.due(5.0)


def test_a_board_that_boots() -> None:
    """It hears nothing for 6 s, then says start and what it is."""
    firmware = Firmware()
    firmware.silent = True
    world = World(firmware)
    talk = Handshake(0.0)

    def wakes() -> bool:
        if firmware.silent and world.now >= 6.0:
            firmware.reset()
            firmware.silent = False
            firmware.say("start", world.now)
            firmware.say("echo:Marlin 2.1.2", world.now)
        return talk.greeting is not None

    world._run(talk, wakes)
    assert talk.greeting is not None
    assert talk.greeting.was_reset
    assert talk.greeting.checks_numbers


@pytest.mark.parametrize("kind", sorted(NAMES))
def test_greetings(kind: str) -> None:
    greeting = World(Firmware(kind)).shake_hands()
    assert greeting.firmware.split()[0].split("_")[0].lower() == kind
    assert greeting.checks_numbers is (kind in ("marlin", "repetier"))
    assert greeting.can("EMERGENCY_PARSER") is (kind == "marlin")
    assert not greeting.was_reset


def test_how_far_an_earlier_print_came() -> None:
    firmware = Firmware()
    world, job = job_for(firmware, FILE)
    world.run(job)
    assert world.shake_hands(fresh=False).last == len(FILE) + 1
    assert world.shake_hands().last == 0


def test_a_printer_without_sensors_is_greeted() -> None:
    firmware = Firmware("klipper")
    firmware.faults.to_host = lambda line, count: b"ok\n" if line.startswith(b"ok T") else line
    assert World(firmware).shake_hands().checks_numbers is False
