"""How far a print is, kept in a file, so that it can go on after host, cable or power failed.

A journal lies in the user's folder for state, under a name made of the file's path and the port, so
that several printers may print one file at a time. Its head says what is printed where. Behind it
lie two records that are written in turn, each with a checksum: whatever happens while one is
written, the other is whole. A new journal is written beside an old one, and then takes its place.
A record is written before a line goes out and after it is acknowledged; what was written survives
the end of this process at once, and a power failure when it has been flushed to the disk, which
happens every second and with every line that is not the file's.
"""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from collections.abc import Callable
from dataclasses import asdict, astuple, dataclass, replace
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
    lift: float = 0.0
    """mm by which the nozzle stands above its place while the print is paused"""
    retraction: float = 0.0
    """mm of filament pulled back meanwhile"""

    def line_of(self, wire: int) -> int | None:
        """How many commands of the file a printer has that has all lines up to `wire`.

        None where that cannot be known: between the two only the file's lines follow each other,
        and a printer that has later ones was used for something else since.
        """
        if not self.wire <= wire <= self.sent_wire:
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

    `begun` is where it begins. `instead_of` is the journal of the print that goes on: it is deleted
    when this one is there. So are those of other files over this port, since from now on the
    printer stands elsewhere.
    """

    def __init__(
        self,
        path: Path,
        head: Head,
        clock: Callable[[], float],
        *,
        begun: Record = Record(),
        instead_of: Path | None = None,
    ) -> None:
        text = json.dumps(asdict(head)).encode()
        if len(text) >= HEAD:
            raise LocalPrinterError(f"{head.file}: the path is too long; move the file")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            beside = path.with_suffix(".new")
            with beside.open("wb") as stream:
                stream.write(text.ljust(HEAD, b" ") + _slot(0, begun) + b" " * RECORD)
                stream.flush()
                os.fsync(stream.fileno())
            beside.replace(path)
            self._stream = path.open("r+b", buffering=0)
            others = set(path.parent.glob(f"*-{path.name.rpartition('-')[2]}"))
            for other in others | ({instead_of} if instead_of else set()):
                if other != path:
                    other.unlink(missing_ok=True)
        except OSError as error:
            message = f"{path}: the journal cannot be written ({error.strerror})"
            raise LocalPrinterError(message) from error
        self.path = path
        self._clock = clock
        self._flushed_at = clock()
        self._count = 0
        self._now = begun

    def sent(self, line: int, wire: int) -> None:
        """Line `line` of the file is about to go out under number `wire`."""
        due = line == self._now.line or self._clock() >= self._flushed_at + FLUSH_EVERY
        self._write(replace(self._now, sent_line=line, sent_wire=wire), flush=due)

    def acknowledged(self, line: int, wire: int) -> None:
        """The printer has all lines up to `line` of the file, and up to number `wire`."""
        sent_line, sent_wire = max(line, self._now.sent_line), max(wire, self._now.sent_wire)
        self._write(
            replace(self._now, line=line, wire=wire, sent_line=sent_line, sent_wire=sent_wire)
        )

    def parked(self, lift: float, retraction: float) -> None:
        """The nozzle stands so much (mm) above its place, and so much filament is pulled back."""
        self._write(replace(self._now, lift=lift, retraction=retraction), flush=True)

    def close(self, *, done: bool) -> None:
        """Close the file; when the print is done nobody needs it any more."""
        self._stream.close()
        if done:
            self.path.unlink(missing_ok=True)

    def _write(self, record: Record, *, flush: bool = False) -> None:
        self._now = record
        self._count += 1
        try:
            self._stream.seek(HEAD + (self._count % 2) * RECORD)
            self._stream.write(_slot(self._count, record))
            if flush:
                os.fsync(self._stream.fileno())
                self._flushed_at = self._clock()
        except OSError as error:
            message = f"{self.path}: the journal cannot be written ({error.strerror})"
            raise LocalPrinterError(message) from error


def _slot(count: int, record: Record) -> bytes:
    """A record as it is written: a count, its values, a checksum."""
    values = " ".join(map(str, (count, *astuple(record))))
    return f"{values} {zlib.crc32(values.encode())}\n".encode().ljust(RECORD, b" ")


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
    count, *rest = values.split()
    return int(count), Record(*map(int, rest[:4]), *map(float, rest[4:]))
