"""`v3dcad print` over a real serial device: a pseudo-terminal with a firmware behind it."""

from __future__ import annotations

import fcntl
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from printer.firmware import NAMES, Firmware
from printer.pty_printer import PtyPrinter
from printer.world import of_the_file

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
WITHIN = 60.0

LAYERS, MOVES = 6, 40


def gcode() -> str:
    lines = ["M140 S60", "M104 S200", "M190 S60", "M109 S200", "G28", "M83", "G92 E0"]
    for layer in range(LAYERS):
        lines += [f";LAYER:{layer}", f"G1 Z{0.2 * (layer + 1):.1f} F600"]
        lines += [f"G1 X{x} Y{10 + layer} E0.1 F1200 ; go" for x in range(1, MOVES)]
    return "\n".join([*lines, "M104 S0", "M140 S0", "M84", ""])


COMMANDS = [line.partition(";")[0].strip() for line in gcode().splitlines()]
COMMANDS = [command for command in COMMANDS if command]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "part.gcode"
    path.write_text(gcode())
    return path


class Printing:
    """`v3dcad print` as a child process, told and telling by JSON lines."""

    def __init__(self, home: Path, *words: object, as_json: bool = True) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "v3dcad", "print", *map(str, words),
             *(["--json"] if as_json else [])],
            stdin=subprocess.PIPE if as_json else subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
            env={**os.environ, "PYTHONPATH": str(ROOT), "XDG_STATE_HOME": str(home)},
        )  # fmt: skip

    def tell(self, **wish: object) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps(wish) + "\n")
        self.process.stdin.flush()

    def kill(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.communicate(timeout=WITHIN)

    def done(self) -> tuple[int, list[dict], str]:
        """Exit code, events, what was said on stderr."""
        out, err = self.process.communicate(timeout=WITHIN)
        events = [json.loads(line) for line in out.splitlines() if line.startswith("{")]
        return self.process.returncode, events, err


def until(condition: Callable[[], bool]) -> None:
    limit = time.monotonic() + WITHIN
    while not condition():
        assert time.monotonic() < limit, "it did not happen"
        time.sleep(0.005)


@pytest.fixture
def slow() -> Iterator[PtyPrinter]:
    """A Marlin that takes its time over moves, so that there is time to do something."""
    firmware = Firmware(seconds=lambda command: 0.01 if command.startswith("G1 X") else 0.001)
    with PtyPrinter(firmware) as printer:
        yield printer


@pytest.mark.parametrize("kind", sorted(NAMES))
def test_a_print(kind: str, file: Path, tmp_path: Path) -> None:
    with PtyPrinter(Firmware(kind, advanced=kind == "marlin")) as printer:
        code, events, err = Printing(tmp_path, file, "--port", printer.port).done()
    assert (code, err) == (0, "")
    assert of_the_file(printer.firmware.obeyed)[-len(COMMANDS) :] == COMMANDS
    told = [event["event"] for event in events]
    assert told[:2] == ["file", "printer"]
    assert events[-1] == {"event": "end", "end": "finished"}
    last = next(event for event in reversed(events) if event["event"] == "progress")
    assert last["percent"] == 100
    assert last["line"] == last["lines"] == len(COMMANDS)
    assert last["layer"] == last["layers"] == LAYERS
    assert not list(tmp_path.rglob("*.journal")), "the journal of a finished print stays"


def test_plain_lines_in_a_pipe(file: Path, tmp_path: Path) -> None:
    with PtyPrinter(Firmware()) as printer:
        printing = Printing(tmp_path, file, "--port", printer.port, as_json=False)
        out, err = printing.process.communicate(timeout=WITHIN)
    assert err == ""
    assert "\x1b" not in out
    assert "firmware Marlin 2.1.2" in out
    assert out.splitlines()[-1].split() == ["end", "finished"]


def test_pause_parks_and_comes_back(slow: PtyPrinter, file: Path, tmp_path: Path) -> None:
    printing = Printing(tmp_path, file, "--port", slow.port, "--park-at", "0,200")
    obeyed = slow.firmware.obeyed
    until(lambda: "G1 X20 Y11 E0.1 F1200" in obeyed)
    printing.tell(do="pause")
    until(lambda: "G1 X0 Y200 F3000" in obeyed)
    time.sleep(0.3)
    count = len([command for command in obeyed if command != "M105"])
    time.sleep(0.3)
    assert count == len([command for command in obeyed if command != "M105"])
    assert slow.firmware.targets == {"T": 200.0, "B": 60.0}, "heat stays on"
    printing.tell(do="resume")
    printing.tell(do="speed", percent=90)
    printing.tell(do="flow", percent=300)
    printing.tell(do="dance")
    code, events, _ = printing.done()
    assert code == 0
    last = obeyed[: obeyed.index("M84 S0")][-1]
    place = last.partition(" E")[0].removeprefix("G1 ")
    first, after = obeyed.index("M84 S0") + 1, obeyed.index(f"G1 {place} F3000")
    assert obeyed[first : first + 6] == ["G21", "M83", "G1 E-2 F1800", "G91", "G1 Z10 F600", "G90"]
    assert [line for line in obeyed[after:] if line != "M105"][1:8] == [
        "G1 Z0.4 F600", "M83", "G1 E2 F1800", f"G92 E{obeyed[after + 4].partition('E')[2]}",
        "G1 F1200", "G90", "M83",
    ]  # fmt: skip
    assert "M220 S90" in obeyed
    mistakes = [event["text"] for event in events if event["event"] == "mistake"]
    assert mistakes[0] == "flow 300: give 50 to 200 %"
    assert "dance" in mistakes[1]
    assert [line for line in obeyed if "E0.1" in line] == [c for c in COMMANDS if "E0.1" in c]


def test_cancel_turns_heaters_off(slow: PtyPrinter, file: Path, tmp_path: Path) -> None:
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G1 X20 Y11 E0.1 F1200" in slow.firmware.obeyed)
    printing.tell(do="cancel")
    code, events, err = printing.done()
    assert code == 130
    assert events[-1] == {"event": "end", "end": "cancelled"}
    assert err == ""
    assert slow.firmware.targets == {"T": 0.0, "B": 0.0}
    assert of_the_file(slow.firmware.obeyed)[-4:] == ["M104 S0", "M140 S0", "M107", "M84"]


def test_a_print_outlives_the_program_that_started_it(
    slow: PtyPrinter, file: Path, tmp_path: Path
) -> None:
    """The workbench's window crashes: nobody reads and nobody writes any more."""
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G1 X20 Y11 E0.1 F1200" in slow.firmware.obeyed)
    for stream in (printing.process.stdout, printing.process.stdin, printing.process.stderr):
        stream.close()
    assert printing.process.wait(WITHIN) == 0
    assert of_the_file(slow.firmware.obeyed)[-len(COMMANDS) :] == COMMANDS


@pytest.mark.parametrize("as_json", [True, False])
def test_a_print_does_not_wait_to_be_read(file: Path, tmp_path: Path, as_json: bool) -> None:
    """The window computes, or a pager waits: more is told than the pipe holds, and nobody reads."""
    firmware = Firmware()
    firmware.faults.to_host = lambda line, count: b"echo:" + b"x" * 1000 + b"\n" + line
    with PtyPrinter(firmware) as printer:
        printing = Printing(tmp_path, file, "--port", printer.port, as_json=as_json)
        code = printing.process.wait(WITHIN)
        assert (code, printing.done()[2]) == (0, "")
    assert of_the_file(firmware.obeyed)[-len(COMMANDS) :] == COMMANDS


def test_a_print_in_a_pipe_outlives_its_reader(
    slow: PtyPrinter, file: Path, tmp_path: Path
) -> None:
    """As in `v3dcad print … | head`."""
    printing = Printing(tmp_path, file, "--port", slow.port, as_json=False)
    assert printing.process.stdout is not None
    printing.process.stdout.close()
    assert printing.process.wait(WITHIN) == 0
    assert printing.process.stderr is not None
    with printing.process.stderr as errors:
        assert errors.read() == ""
    assert of_the_file(slow.firmware.obeyed)[-len(COMMANDS) :] == COMMANDS


def test_a_name_that_is_no_text(tmp_path: Path) -> None:
    file = tmp_path / os.fsdecode(b"part\xff.gcode")
    file.write_text(gcode())
    with PtyPrinter(Firmware()) as printer:
        printing = Printing(tmp_path, file, "--port", printer.port, as_json=False)
        out, _ = printing.process.communicate(timeout=WITHIN)
    assert out.splitlines()[-1].split() == ["end", "finished"]


def test_wishes_that_are_no_text_do_not_deafen(
    slow: PtyPrinter, file: Path, tmp_path: Path
) -> None:
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G1 X20 Y11 E0.1 F1200" in slow.firmware.obeyed)
    assert printing.process.stdin is not None
    for nonsense in (b"\xff\n", b"[" * 4000 + b"\n", b"x" * 10_000 + b"\n"):
        printing.process.stdin.buffer.write(nonsense)
    printing.tell(do="cancel")
    code, events, _ = printing.done()
    assert code == 130
    assert sum(event["event"] == "mistake" for event in events) == 5


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_cancel(slow: PtyPrinter, file: Path, tmp_path: Path, number: int) -> None:
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G1 X20 Y11 E0.1 F1200" in slow.firmware.obeyed)
    printing.process.send_signal(number)
    assert printing.done()[0] == 130
    assert slow.firmware.targets == {"T": 0.0, "B": 0.0}


def test_cancel_while_heating(file: Path, tmp_path: Path) -> None:
    firmware = Firmware(seconds=lambda command: 600.0 if command == "M190 S60" else 0.001)
    with PtyPrinter(firmware) as printer:
        printing = Printing(tmp_path, file, "--port", printer.port)
        until(lambda: "M104 S200" in firmware.obeyed)
        time.sleep(0.2)
        printing.tell(do="cancel")
        assert printing.done()[0] == 130
    assert firmware.targets == {"T": 0.0, "B": 0.0}
    assert "G28" not in firmware.obeyed


def test_emergency_stop(slow: PtyPrinter, file: Path, tmp_path: Path) -> None:
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G1 X20 Y11 E0.1 F1200" in slow.firmware.obeyed)
    printing.tell(do="stop")
    code, events, err = printing.done()
    assert code == 2
    assert events[-1]["end"] == "printer halted"
    assert slow.firmware.halted
    assert err.startswith("v3dcad: printer halted: emergency stop")


def test_a_cable_that_is_pulled(slow: PtyPrinter, file: Path, tmp_path: Path) -> None:
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G1 X20 Y11 E0.1 F1200" in slow.firmware.obeyed)
    slow.unplug()
    code, events, err = printing.done()
    assert code == 2
    assert events[-1]["end"] == "connection lost"
    assert err.startswith("v3dcad: connection lost: ")
    assert "heaters could NOT be told to turn off" in err
    assert err.count("\n") == 1


def test_a_printer_that_halts(slow: PtyPrinter, file: Path, tmp_path: Path) -> None:
    slow.firmware.faults.when_obeyed = {60: "error"}
    code, events, err = Printing(tmp_path, file, "--port", slow.port).done()
    assert code == 2
    assert events[-1]["end"] == "printer halted"
    assert "Heating failed" in err
    assert "the heaters were told to turn off" in err
    assert slow.firmware.targets == {"T": 0.0, "B": 0.0}


def test_a_file_that_is_changed_meanwhile(slow: PtyPrinter, tmp_path: Path) -> None:
    file = tmp_path / "long.gcode"
    file.write_text(gcode() + "G1 X1 E1\n" * 3000)
    slow.firmware.seconds = lambda command: 0.0005
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G28" in slow.firmware.obeyed)
    with file.open("a") as stream:
        stream.write("G1 X999\n")
    code, events, err = printing.done()
    assert code == 2
    assert events[-1]["end"] == "file changed"
    assert "was changed after it was checked" in err
    assert "G1 X999" not in slow.firmware.obeyed
    assert slow.firmware.targets == {"T": 0.0, "B": 0.0}


def test_killed_and_resumed_each_line_arrives_once(
    slow: PtyPrinter, file: Path, tmp_path: Path
) -> None:
    """kill -9; the board is not reset when its port is opened again."""
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G1 X20 Y12 E0.1 F1200" in slow.firmware.obeyed)
    printing.kill()
    printing = Printing(tmp_path, file, "--resume", "--yes")
    code, events, err = printing.done()
    assert (code, err) == (0, "")
    (how,) = [event for event in events if event["event"] == "resume"]
    assert how["exact"] is True
    assert "was not reset" in how["text"]
    moves = [command for command in slow.firmware.obeyed if "E0.1" in command]
    assert moves == [command for command in COMMANDS if "E0.1" in command]
    assert slow.firmware.obeyed.count("G28") == 1


@pytest.mark.parametrize("kind", ["marlin", "repetier"])
def test_killed_and_reset_the_layer_is_printed_again(kind: str, file: Path, tmp_path: Path) -> None:
    firmware = Firmware(kind, seconds=lambda command: 0.01 if "Y13" in command else 0.001)
    with PtyPrinter(firmware) as printer:
        printing = Printing(tmp_path, file, "--port", printer.port)
        until(lambda: "G1 X35 Y13 E0.1 F1200" in firmware.obeyed)
        printing.kill()
        time.sleep(0.5)
        firmware.reset()
        firmware.obeyed.clear()
        code, events, _ = Printing(tmp_path, file, "--resume", "--yes", "--port",
                                   printer.port).done()  # fmt: skip
    assert code == 0
    (how,) = [event for event in events if event["event"] == "resume"]
    assert how["exact"] is False
    assert "layer 4 is printed again from its start" in how["text"]
    obeyed = of_the_file(firmware.obeyed)
    obeyed = obeyed[obeyed.index("M140 S60") :]
    assert obeyed[:4] == ["M140 S60", "M104 S200", "M190 S60", "M109 S200"]
    assert "G28" not in obeyed, "Z is homed into the part"
    homing = obeyed.index("G28 X Y")
    assert obeyed[homing - 4 : homing] == ["G92 Z0.8", "G91", "G1 Z2 F600", "G90"]
    first = next(at for at, line in enumerate(obeyed) if line in COMMANDS and "Z0.8" in line)
    start = COMMANDS.index("G1 Z0.8 F600")
    assert obeyed[first:] == COMMANDS[start:]


def test_a_printer_that_is_silent(file: Path, tmp_path: Path) -> None:
    """Nothing answers at first contact: bounded, named, no byte of the file sent."""
    firmware = Firmware()
    firmware.silent = True
    with PtyPrinter(firmware) as printer:
        begun = time.monotonic()
        code, _, err = Printing(tmp_path, file, "--port", printer.port, "--baud", 115200).done()
    assert code == 2
    assert err.startswith("v3dcad: no answer: nothing answered for 15 s")
    assert time.monotonic() - begun < 30
    assert set(firmware.obeyed) == {"M115"}


def test_resume_refuses(slow: PtyPrinter, file: Path, tmp_path: Path) -> None:
    def said(*words: object) -> str:
        code, _, err = Printing(tmp_path, file, *words).done()
        assert code == 2
        assert err.count("\n") == 1
        return err

    assert "no print of this file was broken off" in said("--resume")
    printing = Printing(tmp_path, file, "--port", slow.port)
    until(lambda: "G1 X20 Y12 E0.1 F1200" in slow.firmware.obeyed)
    printing.kill()
    assert "asks before it heats and moves; give --yes" in said("--resume")
    file.write_text(gcode() + "G1 X1\n")
    assert "is not the file that was printed" in said("--resume", "--yes")


def test_ports_that_cannot_be_opened(file: Path, tmp_path: Path) -> None:
    def said(port: object) -> str:
        code, _, err = Printing(tmp_path, file, "--port", port).done()
        assert code == 2
        assert err.count("\n") == 1
        return err

    assert "there is no such port; v3dcad ports lists them" in said("/dev/ttyNONE9")
    assert "cannot be opened as a serial port" in said(file)
    with PtyPrinter(Firmware()) as printer:
        handle = os.open(printer.port, os.O_RDWR | os.O_NOCTTY)
        fcntl.flock(handle, fcntl.LOCK_EX)
        assert "in use by another program" in said(printer.port)
        os.close(handle)
    assert printer.firmware.obeyed == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no commands in it"),
        ("G1 X1\nM112\n", "line 2: M112 stops the printer; take it out"),
        ("G1 X1\nM28 a.g\n", "line 2: M28 a.g writes to the printer's card"),
        ("G1 X1\n\0", "line 2: this is no G-code"),
        ("G1 X1\nM117 " + "x" * 100 + "\n", "line 2: a command of 105 characters; this printer"),
    ],
)
def test_files_that_are_not_printed(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "part.gcode"
    file.write_text(text)
    with PtyPrinter(Firmware()) as printer:
        code, _, err = Printing(tmp_path, file, "--port", printer.port).done()
    assert code == 2
    assert message in err
    assert not [command for command in printer.firmware.obeyed if command.startswith("G1")]


def test_a_part_that_is_too_large_is_not_printed(file: Path, tmp_path: Path) -> None:
    file.write_text("G1 X300 Y10 Z1 F600\nG1 X310 E1\n")
    with PtyPrinter(Firmware()) as printer:
        words = [file, "--port", printer.port, "--profile", "ender3v2"]
        code, _, err = Printing(tmp_path, *words).done()
    assert code == 2
    assert "does not fit the printer: x runs from 300 to 310 mm" in err
    assert printer.firmware.obeyed == []


def test_without_a_port_nothing_is_chosen(file: Path, tmp_path: Path) -> None:
    code, _, err = Printing(tmp_path, file).done()
    assert code == 2
    assert "no port: give --port" in err
