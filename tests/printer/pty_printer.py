"""A firmware behind a real serial device: a pseudo-terminal and a thread."""

from __future__ import annotations

import contextlib
import os
import select
import threading
import time
import tty
from collections import deque

from printer.firmware import Firmware
from terminals import open_terminal


class PtyPrinter:
    """Runs a `Firmware` in real time; `port` is what `--port` takes.

    `bytes_per_second` paces both directions as a cable does: each byte takes its time, and none
    waits for those of the other direction. 0 is as fast as it goes.
    """

    def __init__(self, firmware: Firmware, bytes_per_second: float = 0.0) -> None:
        self.firmware = firmware
        self._per_byte = 1 / bytes_per_second if bytes_per_second else 0.0
        self._master, self._slave = open_terminal()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self.run, daemon=True)

    def __enter__(self) -> PtyPrinter:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join(10)
        for end in (self._master, self._slave):
            with contextlib.suppress(OSError):
                os.close(end)

    def unplug(self) -> None:
        """Pull the cable."""
        self.firmware.connected = False

    def run(self) -> None:
        """Serve until the block is left, or the cable is pulled."""
        begun = time.monotonic()
        firmware = self.firmware
        coming: deque[tuple[float, bytes]] = deque()
        going: deque[tuple[float, bytes]] = deque()
        in_free = out_free = 0.0
        while not self._stop.is_set():
            now = time.monotonic() - begun
            if not firmware.connected:
                # The slave's own end is closed first: a reader then sees the hang-up.
                os.close(self._slave)
                os.close(self._master)
                return
            times = [at for at, _ in [*list(coming)[:1], *list(going)[:1]]]
            wake = firmware.next_event()
            times += [] if wake is None else [wake]
            wait = min(max(min(times, default=now + 0.01) - now, 0.0), 0.01)
            ready, _, _ = select.select([self._master], [], [], wait)
            now = time.monotonic() - begun
            if ready:
                for line in os.read(self._master, 4096).splitlines(keepends=True):
                    in_free = max(in_free, now) + len(line) * self._per_byte
                    coming.append((in_free, line))
            while coming and coming[0][0] <= now:
                at, line = coming.popleft()
                firmware.receive(line, at if self._per_byte else now)
            for line in firmware.reply(time.monotonic() - begun).splitlines(keepends=True):
                out_free = max(out_free, now) + len(line) * self._per_byte
                going.append((out_free, line))
            now = time.monotonic() - begun
            while going and going[0][0] <= now:
                os.write(self._master, going.popleft()[1])
