"""Going on after a break: state, journal, and where the print is taken up again."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from printer.firmware import Firmware
from printer.world import World, job_for, of_the_file, program, state_after
from simulated_printer import Printer

from v3dcad.errors import FormatError, LocalPrinterError, SettingError
from v3dcad.printer import journal
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.fit import Machine, Needs, misfit
from v3dcad.printer.handshake import Greeting
from v3dcad.printer.job import Job
from v3dcad.printer.journal import (
    HEAD,
    RECORD,
    Head,
    Journal,
    Record,
    broken_off,
    journal_of,
    read_journal,
)
from v3dcad.printer.program import read_program
from v3dcad.printer.progress import Phase
from v3dcad.printer.resume import Continuation, continuation
from v3dcad.printer.settings import PortSettings

HEADER = ["M140 S60", "M104 S200", "M190 S60", "M109 S200", "G21", "G90", "G28", "M204 P500 T500",
          "M106 S128", "M83", "G92 E0"]  # fmt: skip
LAYERS = [[f"G1 Z{0.2 * n:.1f} F600", *(f"G1 X{x} Y{n} E0.1 F1200" for x in range(1, 31))]
          for n in range(1, 6)]  # fmt: skip
FILE = [*HEADER, *(line for layer in LAYERS for line in layer), "M104 S0", "M84"]
ALIVE = Greeting("Marlin", {}, checks_numbers=True)


MOVE = st.builds(
    lambda name, words: " ".join([name, *words]),
    st.sampled_from(["G0", "G1"]),
    st.lists(
        st.builds(lambda a, v: f"{a}{v}", st.sampled_from("XYZE"), st.integers(-20, 20)),
        min_size=1, max_size=4, unique_by=lambda word: word[0],
    ),
)  # fmt: skip
COMMAND = MOVE | st.sampled_from(["G90", "G91", "M82", "M83", "G92 E0", "G92 E3", "G1 F900"])


class Careless(Printer):
    """The printer of the G-code tests, which is written without v3dcad; takes any E."""

    def move(self, name: str, values: dict[str, float]) -> None:
        self.retracted = 0.0
        super().move(name, values)


def machine(commands: list[str]) -> Printer:
    return Careless(feed=600.0).run("\n".join(commands))


@given(st.lists(COMMAND, max_size=30), st.lists(COMMAND, min_size=1, max_size=10))
def test_parking_and_coming_back_changes_nothing(before: list[str], after: list[str]) -> None:
    """A printer that parked goes on as one that did not: places, feeds, filament."""
    before = ["M109 S200", "G28", "G90", "M82", "G1 X5 Y5 Z1 F600", *before]
    state = state_after(*before)
    aside = state.park((0.0, 200.0), 10.0, 2.0) + state.come_back(2.0)
    straight, parked = machine([*before, *after]), machine([*before, *aside, *after])
    assert parked.position == pytest.approx(straight.position)
    assert parked.e == pytest.approx(straight.e)
    assert (parked.absolute, parked.absolute_e) == (straight.absolute, straight.absolute_e)
    count = len([command for command in after if command[:2] in ("G0", "G1")])
    both = (list(reversed(one.moves))[:count] for one in (parked, straight))
    for one, other in zip(*both, strict=True):
        assert one.feed == other.feed
        assert one.start == pytest.approx(other.start)
        assert one.extruded == pytest.approx(other.extruded)


def test_state() -> None:
    text = "G20, G1 X1 Y2 Z0.1 F10, G92 E0.5 Z0.2, T1, M106, M220 S90, M104 R190, M190 S70, M117 hi"
    state = state_after(*text.split(", "), "SET_VELOCITY_LIMIT ACCEL=900")
    assert state.place == pytest.approx({"X": 25.4, "Y": 50.8, "Z": 5.08})
    assert state.e == pytest.approx(12.7)
    assert state.feed == 254
    assert (state.tool, state.fan, state.nozzle, state.bed) == ("T1", 255, 190, 70)
    assert state.kept == {"M220": "M220 S90", "SET_VELOCITY_LIMIT": "SET_VELOCITY_LIMIT ACCEL=900"}
    restored = state.after_reset(5.08, 0)
    assert restored[:4] == ["M140 S70", "M104 T1 S190", "M190 S70", "M109 T1 S190"]
    assert {"M220 S90", "T1", "M106 S255", "G28 X Y", "G20"} <= set(restored)
    assert "G28" not in restored
    state.follow("G28 X")
    assert set(state.place) == {"Y", "Z"}
    state.follow("G28")
    assert state.place == {}
    assert state.park((0, 0), 10, 2) == []
    assert state.come_back(2) == state.heat()
    state.follow("G91")
    state.follow("G1 X5")
    assert state.place == {}, "a relative move from an unknown place"
    state.follow("M107")
    assert "M107" in state.after_reset(0.2, 0)
    assert state_after("M104 S0").heat() == []
    assert state_after("G1 Z1").park((0, 0), 10, 2)[-1] == "G90", "x and y are not known"
    tools = state_after(
        "M104 S200", "M104 T1 S150", "T1", "M104 S190", "M141 S40", "T0", "G5 X+5 Y 6"
    )
    assert tools.nozzle == 200
    assert tools.heat() == ["M141 S40", "M104 T1 S190", "M104 T0 S200",
                            "M191 S40", "M109 T1 S190", "M109 T0 S200"]  # fmt: skip
    assert set(tools.cool()) == {"M104 T0 S0", "M104 T1 S0", "M141 S0"}
    assert tools.place == {"X": 5, "Y": 6}
    assert state_after("M104 S200", "T3").nozzle == 200, "tools that share a nozzle"
    assert state_after("M109 S200", "M109", "M104 S0").cool() == []
    cold = state_after("G1 X1 Y1 Z1 F600")
    assert not [line for line in cold.park((0, 0), 10, 2) + cold.come_back(2) if "G1 E" in line]


@given(st.integers(1, len(FILE)))
def test_a_living_printer_goes_on_with_the_line_it_wants(done: int) -> None:
    record = Record(done, done, done + 1, done + 1)
    for has in (done, done + 1):
        greeting = dataclasses.replace(ALIVE, last=has)
        onward = continuation(program(FILE), record, greeting)
        assert onward.exact
        assert onward.lines_done == min(has, len(FILE))


@given(st.integers(len(HEADER) + 3, len(FILE)))
def test_after_a_reset_a_layer_is_printed_from_its_start(done: int) -> None:
    record = Record(done, done + 7, done + 1, done + 8)
    for greeting in (
        dataclasses.replace(ALIVE, last=0),
        dataclasses.replace(ALIVE, last=done + 7, was_reset=True),
        dataclasses.replace(ALIVE, last=5),
        Greeting("Klipper"),
    ):
        onward = continuation(program(FILE), record, greeting)
        assert not onward.exact
        starts = [len(HEADER) + n * len(LAYERS[0]) for n in range(len(LAYERS))]
        behind = max(done - 24, len(HEADER) + 2)
        assert onward.lines_done == max(start for start in starts if start + 2 <= behind)
        assert "G28 X Y" in onward.before
        assert "M204 P500 T500" in onward.before
        height = float(onward.before[onward.before.index("G91") - 1].removeprefix("G92 Z"))
        layer = starts.index(onward.lines_done)
        assert height == pytest.approx(0.2 * max(layer, 0)) or height == pytest.approx(
            0.2 * (layer + 1)
        )


@pytest.mark.parametrize("relative", [True, False])
@pytest.mark.parametrize("paused", [0.0, 2.0])
def test_after_a_reset_no_drop_is_pushed_out_before_the_first_bead(
    relative: bool, paused: float
) -> None:
    """Each layer of the file begins with filament pulled back, which the printer's is not."""
    lines = [*HEADER, "M83" if relative else "M82", "G1 E-5 F1800"]
    fed = -5.0
    for layer in LAYERS:
        lines += [layer[0].replace("G1 Z", "G1 X0 Y0 Z")]
        for move, step in (
            ("", 5.0),
            *((f" {line[3:-11]}", 0.1) for line in layer[1:]),
            ("", -5.0),
        ):
            fed += step
            lines += [f"G1{move} E{step if relative else fed:.5f} F1200"]
    for done in range(len(HEADER) + 30, len(lines), 7):
        record = Record(done, done, done, done, retraction=paused)
        onward = continuation(program(lines), record, Greeting("Klipper"))
        told = [line for line in onward.before if not line.startswith("G92 Z")]
        pushed = 0.0
        for move in machine([*told, *lines[onward.lines_done :]]).moves:
            if move.start != move.stop and move.extruded > 0:
                break
            pushed += move.extruded
        assert pushed == pytest.approx(paused)


@given(st.integers(len(HEADER) + 60, len(FILE) - 2))
def test_after_a_reset_the_nozzle_does_not_dip_into_the_layer_that_stands(done: int) -> None:
    """Part of the layer is there: on the way to its start the nozzle stays as high or higher."""
    onward = continuation(program(FILE), Record(done, done, done, done), Greeting("Klipper"))
    told = [line.replace("G92 Z", "G1 F600 Z") for line in onward.before]
    heights = []
    for move in machine([*told, *FILE[onward.lines_done :]]).moves:
        heights.append(move.stop[2])
        if move.extruded > 0:
            break
    down = heights[heights.index(max(heights)) :]
    assert len(down) > 2
    assert min(down) == pytest.approx(heights[-1])


class Keeper:
    """A journal in memory."""

    def __init__(self) -> None:
        self.now = Record()

    def sent(self, line: int, wire: int) -> None:
        self.now = dataclasses.replace(self.now, sent_line=line, sent_wire=wire)

    def acknowledged(self, line: int, wire: int) -> None:
        sent_line, sent_wire = max(line, self.now.sent_line), max(wire, self.now.sent_wire)
        self.now = Record(line, wire, sent_line, sent_wire, self.now.lift, self.now.retraction)

    def parked(self, lift: float, retraction: float) -> None:
        self.now = dataclasses.replace(self.now, lift=lift, retraction=retraction)


class GoneError(Exception):
    """The host is gone."""


def gone() -> None:
    raise GoneError


def go_on(world: World, record: Record) -> Continuation:
    """Resume a print of FILE to its end."""
    greeting = world.shake_hands(fresh=False)
    lines = program(FILE)
    onward = continuation(lines, record, greeting)
    world.firmware.obeyed.clear()
    rest = Job(
        lines[onward.lines_done :], greeting, PortSettings(), before=onward.before,
        state=onward.state, lines_done=onward.lines_done, offset=onward.offset,
    )  # fmt: skip
    assert world.run(rest) == End.FINISHED
    return onward


@given(st.integers(len(HEADER) + 3, len(FILE) - 3))
def test_a_print_broken_off_anywhere_and_resumed_is_whole(at: int) -> None:
    """The host is gone after some line; the board lives. Each line is obeyed once."""
    firmware, keeper = Firmware(), Keeper()
    world, job = job_for(firmware, FILE, recorder=keeper)
    with pytest.raises(GoneError):
        world.run(job, (lambda: len(firmware.numbers) >= at, gone))
    world.shake_hands(fresh=False)
    first = of_the_file(firmware.obeyed)
    first = [line for line in first if line != "M115"]
    onward = go_on(world, keeper.now)
    assert onward.exact
    second = of_the_file(firmware.obeyed)
    assert second[: len(onward.before)] == onward.before
    assert first + second[len(onward.before) :] == FILE


@given(st.integers(100, 125))
def test_a_pause_broken_off_anywhere_goes_on_at_its_place(at: int) -> None:
    """The host is gone while the nozzle goes aside, stands there, or comes back."""
    firmware, keeper = Firmware(), Keeper()
    world, job = job_for(firmware, FILE, recorder=keeper)
    with pytest.raises(GoneError):
        world.run(
            job,
            (lambda: job.snapshot().line >= 100, lambda: job.pause(world.now)),
            (lambda: job.phase == Phase.PAUSED, lambda: job.resume(world.now)),
            (lambda: len(firmware.numbers) >= at, gone),
        )
    before = [line for line in of_the_file(firmware.obeyed) if not line.startswith("M11")]
    assert go_on(world, keeper.now).exact
    both = (
        [
            (move.start, move.stop, move.feed)
            for move in machine(lines).moves
            if move.extruded == 0.1
        ]
        for lines in (FILE, before + firmware.obeyed)
    )
    for straight, broken in zip(*both, strict=True):
        assert broken == straight


@pytest.mark.parametrize("reset", [False, True])
def test_a_print_that_was_paused_when_the_host_failed(reset: bool) -> None:
    firmware, keeper = Firmware(), Keeper()
    world, job = job_for(firmware, FILE, recorder=keeper)
    with pytest.raises(GoneError):
        world.run(
            job,
            (lambda: job.snapshot().line >= 100, lambda: job.pause(world.now)),
            (lambda: job.phase == Phase.PAUSED, gone),
        )
    assert (keeper.now.lift, keeper.now.retraction) == (10, 2)
    if reset:
        firmware.reset()
    onward = go_on(world, keeper.now)
    assert onward.exact is not reset
    if reset:
        assert onward.before[onward.before.index("G91") - 1] == "G92 Z10.6"
    else:
        assert "G1 E2 F1800" in onward.before


def test_a_printer_that_printed_something_else_since_is_not_taken_at_its_word() -> None:
    record = Record(line=100, wire=105, sent_line=101, sent_wire=106)
    for last in (107, 5000):
        assert not continuation(program(FILE), record, dataclasses.replace(ALIVE, last=last)).exact


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        (HEADER, "no layer was begun"),
        (["G28", "G1 X1 Y1 Z1 F600", "G1 X2 E1"] + ["G1 X3 E2"] * 40, "does not say how hot"),
    ],
)
def test_what_cannot_be_resumed(commands: list[str], message: str) -> None:
    with pytest.raises(LocalPrinterError, match=message):
        continuation(program(commands), Record(len(commands), 9, 0, 0), Greeting("Klipper"))


def test_lines_of_ours_and_of_the_file_are_told_apart() -> None:
    between = Record(line=10, wire=12, sent_line=13, sent_wire=15)
    assert [between.line_of(wire) for wire in (11, 12, 14, 15)] == [None, 10, 12, 13]
    ours = Record(line=10, wire=12, sent_line=10, sent_wire=13)
    assert [ours.line_of(wire) for wire in (12, 13, 14)] == [10, 10, None]


def test_the_journal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([0.0, *(0.2 * n for n in range(1000))])
    flushed: list[int] = []
    monkeypatch.setattr(os, "fsync", flushed.append)
    path = tmp_path / "deep" / "a.journal"
    head = Head("/a/part.gcode", "00ff", "/dev/ttyUSB0", 115200)
    begun = Record(7, 9, 7, 9)
    Journal(path, Head("", "", "", 0), lambda: 0.0, begun=begun).close(done=False)
    assert read_journal(path)[1] == begun, "what is written first is where it begins"
    flushed.clear()
    one = Journal(path, head, lambda: next(times))
    assert read_journal(path) == (head, Record())
    assert len(flushed) == 1
    one.sent(1, 1)
    assert read_journal(path)[1] == Record(0, 0, 1, 1)
    one.acknowledged(1, 1)
    one.sent(2, 2)
    assert read_journal(path)[1] == Record(1, 1, 2, 2)
    count = len(flushed)
    one.sent(1, 3)
    assert len(flushed) == count + 1, "a line that is not the file's is flushed at once"
    for number in range(2, 60):
        one.sent(number, number + 2)
    assert count + 5 < len(flushed) < 30
    data = bytearray(path.read_bytes())
    newest = HEAD + RECORD * (one._count % 2)
    data[newest + 3] ^= 1
    path.write_bytes(data)
    assert read_journal(path)[1].sent_line == 58, "a torn record leaves the one before"
    count = len(flushed)
    one.parked(10.0, 0.5)
    assert len(flushed) == count + 1
    assert read_journal(path)[1] == Record(1, 1, 59, 61, 10.0, 0.5)
    one.close(done=False)
    assert path.exists()
    Journal(path, head, lambda: 0.0).close(done=True)
    assert not path.exists()


def test_which_journal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    file = tmp_path / "part.gcode"

    def begun(port: str, instead_of: Path | None = None) -> Path:
        path = journal_of(file, port)
        Journal(path, Head("", "", port, 9600), lambda: 0.0, instead_of=instead_of).close(
            done=False
        )
        return path

    with pytest.raises(LocalPrinterError, match="no print of this file was broken off"):
        broken_off(file, None)
    one = begun("/dev/ttyUSB0")
    assert tmp_path in one.parents
    assert broken_off(file, None) == broken_off(file, "/dev/ttyUSB7") == one
    other = begun("/dev/ttyUSB1")
    assert broken_off(file, "/dev/ttyUSB1") == other
    with pytest.raises(LocalPrinterError, match=r"give port \(/dev/ttyUSB0, /dev/ttyUSB1\)"):
        broken_off(file, None)
    begun("/dev/ttyUSB0", instead_of=other)
    assert broken_off(file, None) == one
    begun("/dev/ttyUSB0", instead_of=one)
    assert one.exists()
    file = tmp_path / "second.gcode"
    begun("/dev/ttyUSB0")
    assert not one.exists(), "another print over the port: the printer stands elsewhere"
    file = tmp_path / "part.gcode"
    with pytest.raises(LocalPrinterError, match="no print"):
        broken_off(tmp_path / "other.gcode", None)


def test_journals_that_cannot_be_used(tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    path.mkdir()
    with pytest.raises(LocalPrinterError, match="cannot be read"):
        read_journal(path)
    with pytest.raises(LocalPrinterError, match="cannot be written"):
        Journal(path, Head("", "", "", 0), lambda: 0.0)
    path.rmdir()
    path.write_text("[]")
    with pytest.raises(LocalPrinterError, match="this is no journal"):
        read_journal(path)
    with pytest.raises(LocalPrinterError, match="path is too long"):
        Journal(path, Head("x" * journal.HEAD, "", "", 0), lambda: 0.0)


def test_a_program(tmp_path: Path) -> None:
    file = tmp_path / "part.gcode"
    file.write_bytes(
        b"; nozzle_diameter = 0.4\r\nM109 S215\r\nM190 R70 ; bed\r\n\r\nN7 G1 X1*99\r\n"
    )
    found = read_program(file)
    assert (found.commands, found.size, found.longest_at) == (3, file.stat().st_size, 2)
    assert found.needs == Needs(0.4, 215.0, 70.0)
    lines = list(found.lines())
    assert [line.command for line in lines] == ["M109 S215", "M190 R70", "G1 X1"]
    assert [line.offset for line in lines][-1] == found.size
    file.write_bytes(b"m0104S300\nM140 S+80 R60\n")
    assert read_program(file).needs == Needs(None, 300.0, 80.0)
    for text, message in ((b"G1 X1\rG1 X2\r", "CR alone"), (b"G28\nm112", "line 2: m112 stops")):
        file.write_bytes(text)
        with pytest.raises(FormatError, match=message):
            read_program(file)
    with pytest.raises(FormatError, match="cannot be read"):
        read_program(tmp_path)
    file.write_bytes(b"G1 X1\n" + b" " * 5000)
    with pytest.raises(FormatError, match="line 2: this is no G-code"):
        read_program(file)


def overwritten(file: Path) -> None:
    file.write_bytes(b"x" * file.stat().st_size)


def exchanged(file: Path) -> None:
    times = file.stat()
    (file.parent / "new").write_bytes(b"x" * times.st_size)
    os.utime(file.parent / "new", ns=(times.st_atime_ns, times.st_mtime_ns))
    (file.parent / "new").replace(file)


@pytest.mark.parametrize("change", [overwritten, exchanged, Path.unlink])
@pytest.mark.parametrize("done", [0, 1, 700])
def test_no_line_of_a_file_that_was_changed_since_it_was_checked(
    tmp_path: Path, change: Callable[[Path], None], done: int
) -> None:
    """Unless it is open already, and another one took its name: then it is printed as checked."""
    file = tmp_path / "part.gcode"
    file.write_text("".join(f"G1 X{n}\n" for n in range(900)))
    lines = read_program(file).lines()
    before = [next(lines).number for _ in range(done)]
    change(file)
    if done and change is not overwritten:
        assert len(list(lines)) + done == 900
        return
    with pytest.raises(PrintError, match="file changed"):
        next(lines)
    assert len(before) == done


BOX = Machine(bed=(200, 100), height=50, nozzle=0.4, hottest_nozzle=250, hottest_bed=80)


@pytest.mark.parametrize(
    ("machine", "corners", "needs", "words"),
    [
        (BOX, ((0, 0, 0), (200.005, 100, 50)), Needs(0.4, 250, 80), []),
        (BOX, ((-1, 0, 0), (200, 101, 51)), Needs(), ["x runs", "y runs", "51 mm high"]),
        (Machine(bed=(200, 100), centred=True), ((-100, -50, 0), (100, 50, 9)), Needs(), []),
        (BOX, None, Needs(0.6, 251, 81), ["nozzle to 251", "bed to 81", "0.6 mm nozzle"]),
        (Machine(), ((-1e6, 0, 0), (1e6, 0, 1e6)), Needs(9, 900, 900), []),
    ],
)
def test_what_fits(machine: Machine, corners, needs: Needs, words: list[str]) -> None:
    least, greatest = corners or (None, None)
    wrong = misfit(machine, least, greatest, needs)
    assert bool(wrong) is bool(words)
    assert all(word in wrong for word in words)


def test_park_places() -> None:
    assert PortSettings().park_place() is None
    assert PortSettings(park_at="0,200").park_place() == (0, 200)
    for wrong in ("corner", "1", "1,nan", "1,2,3"):
        with pytest.raises(Exception, match="park_at"):
            PortSettings(park_at=wrong).park_place()
    assert PortSettings().cancel_lines() == ["M104 S0", "M140 S0", "M107", "M84"]
    commented = PortSettings(cancel_gcode="M104 S0 ; nozzle\r\n\n; bed\nM140 S0")
    assert commented.cancel_lines() == ["M104 S0", "M140 S0"]
    with pytest.raises(SettingError, match="characters a line"):
        PortSettings(cancel_gcode="M117 " + "x" * 90).cancel_lines()


def test_a_world_of_its_own() -> None:
    """A simulated printer that nobody talks to does nothing."""
    assert World(Firmware()).firmware.next_event() is None
