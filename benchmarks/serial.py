"""Printing over a port, and uploading: lines a second, processor time, memory.

python -m benchmarks.serial            lines a second at two rates, ping-pong and windowed
python -m benchmarks.serial --million  a million lines: is memory flat?
python -m benchmarks.serial --upload   an upload of 100 MB: is memory constant?

The printer is the tests' simulated Marlin behind a pseudo-terminal, in a process of its own, whose
bytes take as long as on a cable. A board's own limits (its planner) are not in it.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BITS = 10
"""Bits on the wire for each byte."""
RUNS = [(rate, windowed) for rate in (115200, 1_000_000) for windowed in (False, True)]

SIMULATOR = """
import sys
sys.path.insert(0, {tests!r})
from printer.firmware import Firmware
from printer.pty_printer import PtyPrinter
firmware = Firmware(advanced={windowed}, seconds=lambda command: 0.0, latency=0.0, queue_size=8)
firmware.obeyed = type("Few", (list,), dict(append=lambda self, item: None))()
firmware.numbers = type("Few", (list,), dict(append=lambda self, item: None))()
printer = PtyPrinter(firmware, {speed})
print(printer.port, flush=True)
printer.run()
"""


@contextmanager
def simulator(baud: int, windowed: bool) -> Iterator[str]:
    """A simulated printer in another process; its port."""
    code = SIMULATOR.format(
        tests=str(ROOT / "tests"), windowed=windowed, speed=baud / BITS if baud else 0
    )
    words = [sys.executable, "-c", code]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    assert process.stdout is not None
    try:
        yield process.stdout.readline().strip()
    finally:
        process.kill()
        process.wait()


def gcode(path: Path, lines: int) -> None:
    """A file of moves as a slicer writes them."""
    with path.open("w") as stream:
        stream.write("G28\nM83\nG1 Z0.2 F600\n")
        for n in range(lines):
            stream.write(f"G1 X{n % 200 + 0.125:.3f} Y{n % 180 + 0.25:.3f} E0.03125\n")


def print_lines(lines: int, baud: int, windowed: bool) -> dict[str, float]:
    """Print a file and say how fast, with how much processor time and memory."""
    from v3dcad.printer.drive import greet, run_job
    from v3dcad.printer.job import Job
    from v3dcad.printer.journal import Head, Journal
    from v3dcad.printer.program import read_program
    from v3dcad.printer.serial_link import SerialLink
    from v3dcad.printer.settings import PortSettings

    with tempfile.TemporaryDirectory() as folder, simulator(baud, windowed) as port:
        file = Path(folder) / "moves.gcode"
        gcode(file, lines)
        program = read_program(file)
        link = SerialLink(port, 115200)
        journal = Journal(Path(folder) / "j", Head("", "", "", 0), time.monotonic)
        job = Job(program.lines(), greet(link), PortSettings(), recorder=journal)
        peaks: dict[int, int] = {}

        def look() -> None:
            peaks[10 * job.snapshot().line // lines] = _resident()

        begun, processor = time.monotonic(), time.process_time()
        run_job(job, link, each_turn=look if lines >= 1_000_000 else lambda: None)
        took, used = time.monotonic() - begun, time.process_time() - processor
        link.close()
        journal.close(done=True)
        result = {
            "lines_per_s": lines / took,
            "processor_us_per_line": 1e6 * used / lines,
            "window": float(job.sender.window),
            "sent_again": float(job.sender.resent),
        }
        if peaks:
            result |= {"mb_at_10_percent": peaks[1] / 1e6, "mb_at_90_percent": peaks[9] / 1e6}
        return result


def _resident() -> int:
    """Bytes of memory this process has now."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


class Sink(BaseHTTPRequestHandler):
    """Takes a file and forgets it."""

    def do_PUT(self) -> None:
        """Read all, answer 201."""
        left = int(self.headers["Content-Length"])
        while left:
            left -= len(self.rfile.read(min(left, 1 << 20)))
        self.send_response(201)
        self.send_header("Content-Length", "2")
        self.end_headers()
        self.wfile.write(b"{}")

    def do_GET(self) -> None:
        """Name a storage."""
        body = json.dumps({"storage_list": [{"path": "/usb", "available": True}]}).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """Say nothing."""


def upload(megabytes: int) -> dict[str, float]:
    """Send a file to a server on this computer and say how fast, with how much memory."""
    from v3dcad.printer.hosts.prusalink import PrusaLink
    from v3dcad.printer.http_link import Address, carry

    server = ThreadingHTTPServer(("127.0.0.1", 0), Sink)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    url = f"http://127.0.0.1:{server.server_address[1]}"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "big.gcode"
        with file.open("wb") as stream:
            for _ in range(megabytes):
                stream.write(b"G1 X1.234\n" * 100_000)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        begun = time.monotonic()
        carry(PrusaLink().upload("big.gcode", "", replace=True), Address(url), file=file)
        took = time.monotonic() - begun
        more = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    server.shutdown()
    return {"mb_per_s": megabytes / took, "more_memory_mb": more / 1024}


def show(name: str, figures: dict[str, float]) -> None:
    """One row."""
    print(f"{name:<28}", ", ".join(f"{key} {value:.1f}" for key, value in figures.items()))


def main() -> None:
    """Run what was asked for."""
    if "--upload" in sys.argv:
        for megabytes in (10, 100):
            show(f"upload of {megabytes} MB", upload(megabytes))
    elif "--million" in sys.argv:
        show("1,000,000 lines", print_lines(1_000_000, 0, True))
    else:
        for baud, windowed in RUNS:
            name = f"{baud} baud, {'windowed' if windowed else 'ping-pong'}"
            show(name, print_lines(baud // 30, baud, windowed))


if __name__ == "__main__":
    main()
