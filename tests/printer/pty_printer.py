"""A firmware behind a real serial device: a pseudo-terminal and a thread."""

from __future__ import annotations

import contextlib
import os
import select
import threading
import time
import tty

from printer.firmware import Firmware


class PtyPrinter:
    """Runs a `Firmware` in real time; `port` is what `--port` takes.

    A pseudo-terminal has no reset line, so `resets_when_opened` resets the firmware at the first
    byte after a silence of the host instead.
    """

    def __init__(self, firmware: Firmware, bytes_per_second: float = 0.0) -> None:
        self.firmware = firmware
        self.bytes_per_second = bytes_per_second
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

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

    def _run(self) -> None:
        begun = time.monotonic()
        firmware = self.firmware
        while not self._stop.is_set():
            now = time.monotonic() - begun
            if not firmware.connected:
                # The slave's own end is closed first: a reader then sees the hang-up.
                os.close(self._slave)
                os.close(self._master)
                return
            wake = firmware.next_event()
            wait = 0.01 if wake is None else min(max(wake - now, 0.0), 0.01)
            ready, _, _ = select.select([self._master], [], [], wait)
            now = time.monotonic() - begun
            if ready:
                data = os.read(self._master, 4096)
                if self.bytes_per_second:
                    time.sleep(len(data) / self.bytes_per_second)
                firmware.receive(data, now)
            said = firmware.reply(time.monotonic() - begun)
            if said:
                if self.bytes_per_second:
                    time.sleep(len(said) / self.bytes_per_second)
                os.write(self._master, said)
