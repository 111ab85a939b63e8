"""Serial ports: which there are, and bytes in and out of one. The only file that imports serial.

One process at a time has a port: pyserial locks it on POSIX (`exclusive`), Windows does so itself.
"""

from __future__ import annotations

import contextlib
import errno
import os
import time
from dataclasses import dataclass
from pathlib import Path

import serial
from serial.tools import list_ports

from v3dcad.errors import LocalPrinterError
from v3dcad.printer.ends import End, PrintError

try:
    import termios

    TERMIOS: tuple[type[Exception], ...] = (termios.error,)
except ImportError:  # Windows
    TERMIOS = ()

TURN = 0.02
"""Seconds that a read waits for the first byte; so often the caller can do other things."""
PULL = 0.1
"""Seconds that the reset line is pulled."""
WRITE_LIMIT = 5.0
"""Seconds after which a write is given up: the board takes nothing any more."""


@dataclass(frozen=True, slots=True)
class Port:
    """A serial port that the system knows."""

    device: str
    """what `--port` takes"""
    name: str
    """what is plugged in, as vendor and product name themselves"""
    usb: str
    """vendor and product as the USB numbers, such as 1a86:7523; "" if it is no USB"""


def ports() -> list[Port]:
    """The serial ports of this computer, by name. Opens none."""
    found = []
    for port in list_ports.comports():
        words = [port.manufacturer or "", port.product or ""]
        name = " ".join(word for word in words if word) or port.description or ""
        usb = f"{port.vid:04x}:{port.pid:04x}" if port.vid is not None else ""
        found.append(Port(port.device, "" if name == "n/a" else name, usb))
    return sorted(found, key=lambda port: port.device)


class SerialLink:
    """An open port. Errors of the cable are `PrintError` (connection lost)."""

    def __init__(self, port: str, baud: int, *, reset: bool = False) -> None:
        self.port = port
        try:
            self._serial = serial.Serial(
                port, baud, timeout=TURN, write_timeout=WRITE_LIMIT, exclusive=True
            )
        except (serial.SerialException, ValueError, *TERMIOS) as error:
            raise LocalPrinterError(_refusal(port, baud, error)) from error
        if reset:
            self.reset()

    def read(self) -> bytes:
        """The bytes that are here; waits for the first at most `TURN` seconds."""
        try:
            data: bytes = self._serial.read(1)
            if data:
                data += self._serial.read(self._serial.in_waiting)
        except (serial.SerialException, OSError) as error:
            raise self._lost(error) from error
        return data

    def write(self, data: bytes) -> None:
        """Send all of these bytes; at most `WRITE_LIMIT` seconds."""
        try:
            self._serial.write(data)
        except serial.SerialTimeoutException:
            message = f"{self.port} takes no bytes any more; check the printer"
            raise PrintError(End.NO_ANSWER, message) from None
        except (serial.SerialException, OSError) as error:
            raise self._lost(error) from error

    def set_baud(self, baud: int) -> None:
        """Go on at another rate."""
        try:
            self._serial.baudrate = baud
            self._serial.reset_input_buffer()
        except (serial.SerialException, OSError, ValueError, *TERMIOS) as error:
            raise LocalPrinterError(_refusal(self.port, baud, error)) from error

    def reset(self) -> None:
        """Pull the line that resets most boards (DTR), and let go; not every port has one."""
        with contextlib.suppress(OSError):
            self._serial.dtr = False
            time.sleep(PULL)
            self._serial.dtr = True

    def close(self) -> None:
        """Let others have the port."""
        with contextlib.suppress(serial.SerialException, OSError):
            self._serial.close()

    def _lost(self, error: Exception) -> PrintError:
        return PrintError(
            End.LOST, f"{self.port} does not answer the computer any more ({_reason(error)})"
        )


def _reason(error: Exception) -> str:
    number = getattr(error, "errno", None)
    return os.strerror(number) if isinstance(number, int) else str(error).partition(":")[0]


def _refusal(port: str, baud: int, error: Exception) -> str:
    """Why a port cannot be opened, and what to do."""
    number = getattr(error, "errno", None)
    known = ", ".join(found.device for found in ports()) or "none"
    if number in (errno.ENOENT, errno.ENXIO, errno.ENODEV) or "FileNotFound" in str(error):
        return f"{port}: there is no such port; v3dcad ports lists them (now: {known})"
    if number == errno.EACCES or "PermissionError" in str(error):
        return f"{port}: no permission; {_remedy(port)}"
    if number in (errno.EBUSY, errno.EAGAIN) or "exclusively lock" in str(error):
        return f"{port}: in use by another program; close that one"
    if isinstance(error, ValueError):
        return f"{port}: cannot be set to {baud} baud; give another --baud"
    return f"{port}: cannot be opened as a serial port ({_reason(error)})"


def _remedy(port: str) -> str:
    """The group that may use a port, where the system has groups."""
    try:
        import grp

        group = grp.getgrgid(Path(port).stat().st_gid).gr_name
    except (ImportError, OSError, KeyError):
        return "another program may have it open"
    return f"join the group {group} (sudo usermod -aG {group} $USER) and log in again"
