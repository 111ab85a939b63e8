"""Terminals for tests: printers and commands that a person watches need one."""

from __future__ import annotations

import os

import pytest


def open_terminal() -> tuple[int, int]:
    """Both ends of a new pseudo-terminal; skips the test where the system has none to give."""
    try:
        return os.openpty()
    except OSError as error:
        pytest.skip(f"needs a pseudo-terminal ({error}): mount -t devpts devpts /dev/pts")
