"""The commands as a person at a terminal meets them: keys, the live view, the console."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from printer.firmware import Firmware
from printer.pty_printer import PtyPrinter
from terminals import open_terminal

from v3dcad.cli import main
from v3dcad.commands.controls import Wish, wish_of
from v3dcad.printer import serial_link

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
WITHIN = 60.0


class Terminal:
    """A command on a terminal of its own."""

    def __init__(self, home: Path, *words: object) -> None:
        self.master, slave = open_terminal()
        self.process = subprocess.Popen(
            [sys.executable, "-c", "from v3dcad.cli import main; main()", *map(str, words)],
            stdin=slave, stdout=slave, stderr=slave, start_new_session=True,
            env={**os.environ, "PYTHONPATH": str(ROOT), "XDG_STATE_HOME": str(home),
                 "TERM": "xterm", "COLUMNS": "100", "LINES": "30"},
        )  # fmt: skip
        os.close(slave)
        self.shown = ""

    def press(self, keys: str) -> None:
        os.write(self.master, keys.encode())

    def sees(self, text: str) -> None:
        """Wait until a text is shown."""
        limit = time.monotonic() + WITHIN
        while text not in self.shown:
            assert time.monotonic() < limit, self.shown[-3000:]
            self._read()

    def code(self) -> int:
        limit = time.monotonic() + WITHIN
        while self.process.poll() is None:
            assert time.monotonic() < limit, self.shown[-3000:]
            self._read()
        os.close(self.master)
        return self.process.returncode

    def _read(self) -> None:
        if select.select([self.master], [], [], 0.05)[0]:
            try:
                self.shown += os.read(self.master, 65536).decode(errors="replace")
            except OSError:
                time.sleep(0.05)


def test_keys_and_live_view(tmp_path: Path) -> None:
    file = tmp_path / "part.gcode"
    file.write_text("M104 S200\nG28\nM83\nG1 X1 Y1 Z0.2 F600\n" + "G1 X2 E1\nG1 X1 E1\n" * 500)
    firmware = Firmware(seconds=lambda command: 0.02)
    with PtyPrinter(firmware) as printer:
        terminal = Terminal(tmp_path, "print", file, "--port", printer.port)
        terminal.sees("EMERGENCY STOP")
        terminal.sees("layer 1/1")
        terminal.sees("T 200/200 °C")
        terminal.press("p")
        terminal.sees("paused")
        terminal.press("++>")
        terminal.press("r")
        terminal.sees("speed 110 %, flow 101 %")
        terminal.press("c")
        assert terminal.code() == 130
    assert firmware.targets["T"] == 0
    assert {"M220 S110", "M221 S101", "G1 E-2 F1800"} <= set(firmware.obeyed)


def test_keys_that_are_not_for_us_do_nothing(tmp_path: Path) -> None:
    """Shift and an arrow in some terminals ends with c; a key may be no text; Ctrl-Z stops."""
    file = tmp_path / "part.gcode"
    file.write_text("G28\nM83\nG1 X1 Y1 Z0.2 F600\n" + "G1 X2 E1\nG1 X1 E1\n" * 100)
    with PtyPrinter(Firmware(seconds=lambda command: 0.02)) as printer:
        terminal = Terminal(tmp_path, "print", file, "--port", printer.port)
        terminal.sees("EMERGENCY STOP")
        for keys in (b"\x1b[c", b"\x1bOs", b"\xff", b"\x1a"):
            os.write(terminal.master, keys)
            time.sleep(0.05)
        terminal.press("+")
        terminal.sees("speed 105 %")
        assert terminal.code() == 0
    assert not printer.firmware.halted


@pytest.mark.parametrize(("key", "code"), [("y", 0), ("n", 1)])
def test_resuming_asks(tmp_path: Path, key: str, code: int) -> None:
    file = tmp_path / "part.gcode"
    file.write_text("M109 S200\nG28\nM83\nG1 X1 Y1 Z0.2 F600\n" + "G1 X2 E1\nG1 X1 E1\n" * 100)
    firmware = Firmware(seconds=lambda command: 0.01)
    with PtyPrinter(firmware) as printer:
        first = Terminal(tmp_path, "print", file, "--port", printer.port)
        first.sees("layer 1/1")
        first.process.kill()
        first.code()
        second = Terminal(tmp_path, "print", file, "--resume")
        second.sees("was not reset")
        second.sees("Go on?")
        obeyed = len(firmware.numbers)
        second.press(key)
        assert second.code() == code
    assert (len(firmware.numbers) > obeyed) is (key == "y")


def run(capsys: pytest.CaptureFixture[str], *words: object, stdin: bytes = b"") -> tuple[int, str]:
    with pytest.MonkeyPatch.context() as patch, tempfile.TemporaryFile("w+") as typed:
        typed.buffer.write(stdin)
        typed.seek(0)
        patch.setattr(sys, "argv", ["v3dcad", *map(str, words)])
        patch.setattr(sys, "stdin", typed)
        with pytest.raises(SystemExit) as stop:
            main()
    said = capsys.readouterr()
    return int(stop.value.code or 0), said.out + said.err


def test_the_console_sends_a_pipe_line_by_line(capsys: pytest.CaptureFixture[str]) -> None:
    with PtyPrinter(Firmware()) as printer:
        words = ["console", "--port", printer.port]
        code, said = run(capsys, *words, stdin=b"M115\n\nG28 ; home\nM117 \xff\nM105\n")
    assert code == 0
    assert printer.firmware.obeyed == ["M115", "G28 ; home", "M117 ?", "M105"]
    assert said.splitlines()[0].startswith("FIRMWARE_NAME:Marlin")
    assert said.splitlines()[-1].startswith("ok T:")
    assert "give --port" in run(capsys, "console")[1]


def test_the_console_at_a_terminal(tmp_path: Path) -> None:
    with PtyPrinter(Firmware()) as printer:
        terminal = Terminal(tmp_path, "console", "--port", printer.port)
        terminal.press("M115\n")
        terminal.sees("FIRMWARE_NAME:Marlin")
        terminal.press("\x04")
        assert terminal.code() == 0


def test_ports(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    class Found:
        def __init__(self, device: str, **known: object) -> None:
            self.device = device
            self.manufacturer = self.product = self.vid = self.pid = None
            self.description = "n/a"
            self.__dict__ |= known

    found = [
        Found("/dev/ttyUSB1", manufacturer="QinHeng", product="CH340", vid=0x1A86, pid=0x7523),
        Found("/dev/ttyS0"),
    ]
    monkeypatch.setattr(serial_link.list_ports, "comports", lambda: found)
    assert run(capsys, "ports")[1].splitlines() == [
        "/dev/ttyS0", "/dev/ttyUSB1  1a86:7523  QinHeng CH340"
    ]  # fmt: skip
    assert json.loads(run(capsys, "ports", "--json")[1])[1] == {
        "port": "/dev/ttyUSB1", "name": "QinHeng CH340", "usb": "1a86:7523"
    }  # fmt: skip
    found.clear()
    assert "no serial ports" in run(capsys, "ports")[1]


def test_no_permission_names_the_group(tmp_path: Path) -> None:
    """As root every port can be opened, so the words alone are looked at."""
    text = serial_link._refusal(str(tmp_path), 115200, PermissionError(13, "denied"))
    assert "no permission; join the group" in text
    assert "usermod -aG" in text


@pytest.mark.parametrize(
    ("line", "wish"),
    [
        ('{"do": "pause"}', Wish("pause")),
        ('{"do": "speed", "percent": 90}', Wish("speed", 90)),
        ('{"do": "speed"}', None),
        ('{"do": "speed", "percent": "fast"}', None),
        ('{"do": "yes"}', None),
        ("[1]", None),
        ("pause", None),
        ("{" * 5000, None),
        ("[" * 5000, None),
    ],
)
def test_wishes_as_json(line: str, wish: Wish | None) -> None:
    found = wish_of(line)
    assert found == wish if wish else found.do == "mistake"
    assert len(found.text) < 200


def test_a_console_whose_cable_is_pulled_ends_in_one_line(tmp_path: Path) -> None:
    printer = PtyPrinter(Firmware())
    with printer:
        terminal = Terminal(tmp_path, "console", "--port", printer.port)
        terminal.press("M115\n")
        terminal.sees("FIRMWARE_NAME:Marlin")
        printer.unplug()
        assert terminal.code() == 2
    assert "Traceback" not in terminal.shown
    assert "Fatal" not in terminal.shown
