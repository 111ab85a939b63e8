"""A printer's firmware as the other side of the cable sees it, with faults. No I/O, no clock.

Each behaviour follows its firmware's source:

marlin     `Marlin/src/gcode/queue.cpp`: `get_serial_commands` compares numbers and checksums,
           `gcode_line_error` empties the receive buffer, `flush_and_request_resend` asks again,
           `ok_to_send` answers when a line has been obeyed (with ADVANCED_OK: N, P and B);
           `host_keepalive` says busy every 2 s; M112 and M108 are read out of their turn with
           EMERGENCY_PARSER (`feature/e_parser.h`)
repetier   `gcode.cpp`: `checkAndPushCommand` answers `skip` to a line it has and, after
           `requestResend`, up to 15 times to any line but the one it wants (`waitingForResend`);
           `reportFatalError` answers all lines after a fatal error, with an `ok` behind it;
           `ok` is said when a line is taken; `wait` each second when there is nothing to do
klipper    `klippy/gcode.py`: `_process_commands` looks at neither numbers nor checksums, and says
           `ok` to a blank line too
reprapfirmware  `GCodeBuffer/StringParser.cpp`: `LineFinished` drops a line with a wrong checksum
           in silence and does not compare numbers
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import reduce
from operator import xor

NAMES = {
    "marlin": "Marlin 2.1.2 (Jan  1 2026) SOURCE_CODE_URL:github.com/MarlinFirmware/Marlin "
    "PROTOCOL_VERSION:1.0 MACHINE_TYPE:Simulated EXTRUDER_COUNT:1",
    "repetier": "Repetier_1.0.4 COMPILED:Jan FIRMWARE_URL:https://github.com/repetier PROTOCOL_"
    "VERSION:1.0 MACHINE_TYPE:Simulated EXTRUDER_COUNT:1 REPETIER_PROTOCOL:3",
    "klipper": "Klipper FIRMWARE_VERSION:v0.12.0",
    "reprapfirmware": "RepRapFirmware for Duet 2 WiFi/Ethernet FIRMWARE_VERSION: 3.5.4 "
    "ELECTRONICS: Duet WiFi FIRMWARE_DATE: 2024-11-24",
}
CHECKS_NUMBERS = {"marlin", "repetier"}

Bytes = Callable[[bytes, int], bytes]


@dataclass
class Faults:
    """What goes wrong. Functions get a line and how many came before it, and change it."""

    to_printer: Bytes = lambda line, count: line
    to_host: Bytes = lambda line, count: line
    when_obeyed: dict[int, str] = field(default_factory=dict)
    """what happens once so many numbered lines are obeyed: halt, reset, disconnect, storm, pause,
    silence, glued (newline lost), error"""


@dataclass
class Firmware:
    """Takes bytes, obeys lines one after another, answers when time has come."""

    kind: str = "marlin"
    advanced: bool = False
    resend_ok: bool = True
    """whether an `ok` follows a request to send again: so in Marlin 1.1 and since 2.1, not
    between"""
    emergency_parser: bool = True
    keepalive: bool = True
    reads_while_busy: bool = False
    """whether lines are read while one is obeyed; Marlin's `idle()` reads none, the others do"""
    queue_size: int = 4
    rx_size: int = 128
    seconds: Callable[[str], float] = lambda command: 0.002
    latency: float = 0.001
    faults: Faults = field(default_factory=Faults)

    obeyed: list[str] = field(default_factory=list)
    """every command obeyed, without number"""
    numbers: list[int] = field(default_factory=list)
    """the numbers of those that had one, in order"""
    taken: list[str] = field(default_factory=list)
    """every numbered line taken, as it arrived"""
    last: int = 0
    connected: bool = True
    halted: bool = False
    silent: bool = False
    overruns: int = 0
    skips: int = -1
    """how many wrong lines are skipped before a line is asked for again"""
    targets: dict[str, float] = field(default_factory=lambda: {"T": 0.0, "B": 0.0})

    def __post_init__(self) -> None:
        self.rx = b""
        self.line = b""
        self.queue: deque[tuple[int | None, str]] = deque()
        self.out: deque[tuple[float, bytes]] = deque()
        self.done_at: float | None = None
        self.busy_at = 0.0
        self.idle_since = 0.0
        self.received = self.said = 0

    # What the host does

    def receive(self, data: bytes, now: float) -> None:
        """Bytes arrive, a line at a time through `faults.to_printer`."""
        self.run(now)
        if not self.connected:
            return
        for part in re.findall(rb"[^\n]*\n|[^\n]+$", data):
            spoiled = self.faults.to_printer(part, self.received)
            self.received += part != b"\n"
            if self.emergency_parser and part.strip() == b"M112":
                self.halt(now)
            if self.emergency_parser and part.strip() == b"M108":
                self.done_at = now if self.done_at is not None else None
            self.rx += spoiled
            self.take(now)
            if len(self.rx) > self.rx_size:
                self.overruns += 1
                self.rx = self.rx[: self.rx_size]

    def reply(self, now: float) -> bytes:
        """What has been said by now and not yet been read."""
        self.run(now)
        said = b""
        while self.out and self.out[0][0] <= now:
            said += self.out.popleft()[1]
        return said

    def next_event(self) -> float | None:
        """When something is going to happen if no more bytes arrive."""
        times = [time for time, _ in list(self.out)[:1]]
        if self.done_at is not None and not self.halted:
            times.append(min(self.done_at, self.busy_at) if self.keepalive else self.done_at)
        elif self.kind == "repetier" and self.connected and not self.halted:
            times.append(self.idle_since + 1.0)
        return min(times) if times else None

    # What goes on inside

    def say(self, text: str, now: float) -> None:
        if self.silent or not self.connected:
            return
        line = self.faults.to_host(text.encode() + b"\n", self.said)
        self.said += 1
        self.out.append((now + self.latency, line))

    def run(self, now: float) -> None:
        """Let time pass up to `now`."""
        while self.connected and not self.halted:
            if self.done_at is None:
                if self.kind == "repetier" and now >= self.idle_since + 1.0:
                    self.idle_since += 1.0
                    self.say("wait", self.idle_since)
                    continue
                return
            if self.keepalive and self.busy_at <= now and self.busy_at < self.done_at:
                self.say("busy:processing" if self.kind == "repetier" else "echo:busy: processing",
                         self.busy_at)  # fmt: skip
                self.busy_at += 2.0
                continue
            if self.done_at > now:
                return
            self.finish(self.done_at)

    def take(self, now: float) -> None:
        """Read lines from the receive buffer while the queue has room."""
        if self.done_at is not None and self.kind == "marlin" and not self.reads_while_busy:
            return
        while not self.halted and len(self.queue) < self.queue_size and b"\n" in self.rx:
            line, _, self.rx = self.rx.partition(b"\n")
            if line.strip():
                self.line_done(line.decode("latin-1"), now)
            elif self.kind == "klipper":
                self.enqueue(None, "", now)
        if self.queue and self.done_at is None and not self.halted:
            self.begin(now)

    def line_done(self, line: str, now: float) -> None:
        found = re.match(r"N(\d+)\s*(.*?)(?:\*(\d+))?$", line)
        if found is None:
            self.enqueue(None, line, now)
            return
        number, command = int(found[1]), found[2]
        right = reduce(xor, line.rpartition("*")[0].encode("latin-1"), 0)
        good = found[3] is not None and int(found[3]) == right
        sets = re.search(r"M110 N(\d+)", command)
        if self.kind == "klipper":
            self.enqueue(number, command, now)
        elif self.kind == "reprapfirmware":
            if good:
                self.enqueue(number, command, now)
        elif not good and self.kind == "repetier":
            self.ask_again("", now)
        elif self.kind == "repetier" and number != self.last + 1 and not sets and (
            (self.last - number) % 65536 < 40 or self.skips >= 0
        ):  # fmt: skip
            self.skips -= (self.last - number) % 65536 >= 40
            self.say(f"skip {number}", now)
            self.say("ok", now)
        elif number != self.last + 1 and not sets:
            self.ask_again("Line Number is not Last Line Number+1", now)
        elif not good:
            what = "No Checksum with line number" if found[3] is None else "checksum mismatch"
            self.ask_again(what, now)
        else:
            self.last = int(sets[1]) if sets else number
            self.taken.append(line)
            self.enqueue(number, command, now)

    def ask_again(self, why: str, now: float) -> None:
        self.rx = b""
        self.skips = 14
        if why:
            self.say(f"Error:{why}, Last Line: {self.last}", now)
        self.say(f"Resend: {self.last + 1}", now)
        if self.resend_ok or self.kind == "repetier":
            self.say("ok", now)

    def enqueue(self, number: int | None, command: str, now: float) -> None:
        self.skips = -1
        self.queue.append((number, command))
        if self.kind == "repetier":
            self.say("ok", now)

    def begin(self, now: float) -> None:
        self.done_at = now + self.seconds(self.queue[0][1])
        self.busy_at = now + 2.0

    def finish(self, now: float) -> None:
        """The first line of the queue has been obeyed."""
        number, command = self.queue.popleft()
        self.done_at = None
        self.idle_since = now
        if command:
            self.obeyed.append(command)
        if number is not None:
            self.numbers.append(number)
        heats = re.match(r"M(104|109|140|190) S([\d.]+)", command)
        if heats:
            self.targets["T" if heats[1] in ("104", "109") else "B"] = float(heats[2])
        self.answer(number, command, now)
        if number is not None:
            self.happen(self.faults.when_obeyed.pop(len(self.numbers), ""), now)
        self.take(now)

    def answer(self, number: int | None, command: str, now: float) -> None:
        temperatures = " ".join(f"{name}:{at:.2f} /{at:.2f}" for name, at in self.targets.items())
        if self.kind == "repetier":
            if command == "M105":
                self.say(temperatures, now)
            elif command == "M115":
                self.say(f"FIRMWARE_NAME:{NAMES[self.kind]}", now)
            return
        if command == "M105":
            self.say(f"ok {temperatures} @:0 B@:0", now)
            return
        if command == "M115":
            self.say(f"FIRMWARE_NAME:{NAMES[self.kind]}", now)
            if self.kind == "marlin":
                self.say("Cap:AUTOREPORT_TEMP:0", now)
                self.say(f"Cap:EMERGENCY_PARSER:{int(self.emergency_parser)}", now)
        tail = ""
        if self.advanced:
            tail = f" N{number}" if number is not None else ""
            tail += f" P15 B{self.queue_size - len(self.queue) - 1}"
        self.say("ok" + tail, now)

    def happen(self, what: str, now: float) -> None:
        if what == "halt":
            self.halt(now)
        elif what == "reset":
            self.reset()
            self.say("start", now)
        elif what == "disconnect":
            self.connected = False
        elif what == "storm":
            for _ in range(50):
                self.say(f"Resend: {self.last + 1}", now)
                self.say("ok", now)
        elif what == "error":
            self.say("Error:Heating failed, system stopped! Heater_ID: 0", now)
        elif what == "fatal":
            self.say("fatal:Heater/sensor error Printer stopped and heaters disabled", now)
        elif what == "pause":
            self.say("//action:pause", now)
        elif what == "silence":
            self.silent = True

    def halt(self, now: float) -> None:
        if self.kind == "klipper":
            self.say("!! Shutdown due to M112 command", now)
        else:
            self.say("Error:Printer halted. kill() called!", now)
        self.halted = True
        self.targets = dict.fromkeys(self.targets, 0.0)

    def reset(self) -> None:
        """As when the board's reset line is pulled."""
        self.rx, self.last, self.done_at, self.halted = b"", 0, None, False
        self.queue.clear()
        self.targets = dict.fromkeys(self.targets, 0.0)
