"""The worker's input: requests of its parent, work between them, and the end with the parent."""

from __future__ import annotations

import os
import queue
import sys
import threading
from collections.abc import Iterator
from typing import BinaryIO


def requests_of(stream: BinaryIO, meanwhile: Iterator[object]) -> Iterator[bytes]:
    """The lines of a stream, until it ends or the parent does.

    After the first one, steps of `meanwhile` are done for as long as no line waits. On Linux the
    kernel kills this process when the thread that started it ends (PR_SET_PDEATHSIG); requests
    that are already there when the stream ends are answered first. Elsewhere the stream's end ends
    the process at once.
    """
    if sys.platform == "linux":
        _die_with_parent()
    lines = _read_ahead(stream)
    while line := lines.get():
        yield line
        while lines.empty() and next(meanwhile, None) is not None:
            pass


def _die_with_parent() -> None:
    import ctypes
    import signal

    set_death_signal = 1  # PR_SET_PDEATHSIG
    parent = os.getppid()
    ctypes.CDLL(None, use_errno=True).prctl(set_death_signal, signal.SIGKILL)
    if os.getppid() != parent:  # it ended before the kernel was told
        os._exit(1)


def _read_ahead(stream: BinaryIO) -> queue.SimpleQueue[bytes]:
    """Lines as a thread of its own reads them; the last one is empty."""
    lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def read() -> None:
        for line in iter(stream.readline, b""):
            lines.put(line)
        if sys.platform != "linux":
            os._exit(0)
        lines.put(b"")

    threading.Thread(target=read, daemon=True).start()
    return lines
