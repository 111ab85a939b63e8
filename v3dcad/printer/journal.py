"""How far a print is, kept in a file, so that it can go on after host, cable or power failed.

A journal lies in the user's folder for state, under a name made of the file's path and the port, so
that several printers may print one file at a time. Its head says what is printed where. Behind it
lie two records that are written in turn, each with a checksum: whatever happens while one is
written, the other is whole. A record is written before a line goes out and after it is
acknowledged; what was written survives the end of this process at once, and a power failure when it
has been flushed to the disk, which happens every second and with every line that is not the file's.
"""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import platformdirs

from v3dcad.errors import LocalPrinterError

HEAD = 8192
"""Bytes of the head; the records follow."""
RECORD = 128
FLUSH_EVERY = 1.0


@dataclass(frozen=True, slots=True)
class Head:
    """What is printed where."""

    file: str
    sha256: str
    port: str
    baud: int


@dataclass(frozen=True, slots=True)
class Record:
    """How far a print is: commands of the file, and the numbers they had on the wire."""

    line: int = 0
    """the last one acknowledged"""
    wire: int = 0
    sent_line: int = 0
    """the last one sent; the same as `line` while lines that are not the file's go out"""
    sent_wire: int = 0

    def line_of(self, wire: int) -> int | None:
        """How many commands of the file a printer has that has all lines up to `wire`.

        None where that cannot be known: between the two only the file's lines follow each other.
        """
        if wire < self.wire:
            return None
        if self.sent_line == self.line:
            return self.line
        return self.sent_line - (self.sent_wire - wire)


def journal_of(file: Path, port: str) -> Path:
    """Where the journal of a file's print over a port lies."""
    return _folder() / f"{_short(str(file.resolve()))}-{_short(port)}.journal"


def broken_off(file: Path, port: str | None) -> Path:
    """The journal of a file's print that was broken off.

    Where several printers printed it, `port` says which. With one it need not be the same, since a
    port may have another name after a restart. Raises `LocalPrinterError` where none is found.
    """
    found = sorted(_folder().glob(f"{_short(str(file.resolve()))}-*.journal"))
    if port is not None and journal_of(file, port) in found:
        return journal_of(file, port)
    if not found:
        raise LocalPrinterError(
            "--resume: no print of this file was broken off on this computer; print it without"
        )
    if len(found) > 1:
        ports = ", ".join(sorted(read_journal(path)[0].port for path in found))
        raise LocalPrinterError(f"--resume: several prints were broken off; give --port ({ports})")
    return found[0]


def _folder() -> Path:
    return platformdirs.user_state_path("v3dcad") / "prints"


def _short(text: str) -> str:
    return hashlib.sha256(os.fsencode(text)).hexdigest()[:16]


class Journal:
    """Writes one print's journal; a `progress.Recorder`.

    `instead_of` is the journal of the print that goes on: it is deleted when this one is there.
    """

    def __init__(
        self,
        path: Path,
        head: Head,
        clock: Callable[[], float],
        *,
        instead_of: Path | None = None,
    ) -> None:
        text = json.dumps(asdict(head)).encode()
        if len(text) >= HEAD:
            raise LocalPrinterError(f"{head.file}: the path is too long; move the file")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._stream = path.open("wb", buffering=0)
            self._stream.write(text.ljust(HEAD, b" ") + b" " * (2 * RECORD))
            os.fsync(self._stream.fileno())
            if instead_of is not None and instead_of != path:
                instead_of.unlink(missing_ok=True)
        except OSError as error:
            message = f"{path}: the journal cannot be written ({error.strerror})"
            raise LocalPrinterError(message) from error
        self.path = path
        self._clock = clock
        self._flushed_at = clock()
        self._count = 0
        self._now = Record()

    def sent(self, line: int, wire: int) -> None:
        """Line `line` of the file is about to go out under number `wire`."""
        self._write(Record(self._now.line, self._now.wire, line, wire))
        if line == self._now.line or self._clock() >= self._flushed_at + FLUSH_EVERY:
            os.fsync(self._stream.fileno())
            self._flushed_at = self._clock()

    def acknowledged(self, line: int, wire: int) -> None:
        """The printer has all lines up to `line` of the file, and up to number `wire`."""
        self._write(Record(line, wire, max(line, self._now.sent_line), self._now.sent_wire))

    def close(self, *, done: bool) -> None:
        """Close the file; when the print is done nobody needs it any more."""
        self._stream.close()
        if done:
            self.path.unlink(missing_ok=True)

    def _write(self, record: Record) -> None:
        self._now = record
        self._count += 1
        values = f"{self._count} {record.line} {record.wire} {record.sent_line} {record.sent_wire}"
        text = f"{values} {zlib.crc32(values.encode())}\n".encode().ljust(RECORD, b" ")
        self._stream.seek(HEAD + (self._count % 2) * RECORD)
        self._stream.write(text)


def read_journal(path: Path) -> tuple[Head, Record]:
    """What a journal says. Raises `LocalPrinterError` if it cannot be read."""
    try:
        data = path.read_bytes()
    except OSError as error:
        message = f"{path}: the journal cannot be read ({error.strerror})"
        raise LocalPrinterError(message) from error
    try:
        head = Head(**json.loads(data[:HEAD]))
    except (ValueError, TypeError):
        raise LocalPrinterError(f"{path}: this is no journal; delete it") from None
    slots = (data[HEAD + at : HEAD + at + RECORD] for at in (0, RECORD))
    counts = [count for count in map(_record, slots) if count is not None]
    return head, max(counts, default=(0, Record()), key=lambda found: found[0])[1]


def _record(slot: bytes) -> tuple[int, Record] | None:
    values, _, crc = slot.decode("latin-1").strip().rpartition(" ")
    if not crc.isdigit() or zlib.crc32(values.encode()) != int(crc):
        return None
    count, *rest = map(int, values.split())
    return count, Record(*rest)
