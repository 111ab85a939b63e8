"""The worker ends with the program that started it, even while it computes."""

from __future__ import annotations

import os
import queue
import sys
import threading
from collections.abc import Iterator
from typing import BinaryIO


def requests_of(stream: BinaryIO) -> Iterator[bytes]:
    """The lines of a stream, until it ends or the parent does.

    On Linux the kernel kills this process when the thread that started it ends
    (PR_SET_PDEATHSIG); requests that are already there when the stream ends are answered first.
    Elsewhere a thread reads ahead, and the stream's end ends the process at once.
    """
    if sys.platform != "linux":
        return _read_ahead(stream)
    _die_with_parent()
    return iter(stream.readline, b"")


def _die_with_parent() -> None:
    import ctypes
    import signal

    set_death_signal = 1  # PR_SET_PDEATHSIG
    parent = os.getppid()
    ctypes.CDLL(None, use_errno=True).prctl(set_death_signal, signal.SIGKILL)
    if os.getppid() != parent:  # it ended before the kernel was told
        os._exit(1)


def _read_ahead(stream: BinaryIO) -> Iterator[bytes]:
    lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def read() -> None:
        for line in iter(stream.readline, b""):
            lines.put(line)
        os._exit(0)

    threading.Thread(target=read, daemon=True).start()
    while True:
        yield lines.get()
