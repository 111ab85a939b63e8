"""Writing files whole or not at all, and saying plainly why one cannot be read or written."""

from __future__ import annotations

import errno
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from v3dcad.errors import V3dcadError

STREAMS = {"/dev/stdin": "0", "/dev/stdout": "1", "/dev/stderr": "2"}
OPEN_FILE = re.compile(r"/(?:dev|proc/self)/fd/(\d+)")
"""Paths of what this process has open already."""


@contextmanager
def written_beside(path: Path) -> Iterator[Path]:
    """A path to write to; what is there takes the place of `path` when the block succeeds.

    Its name ends as that of `path` does, since some writers go by the ending. Where the block
    fails, nothing is left behind, and `path` is as it was. Through a link the file is written that
    it leads to; a device or a pipe is given the whole at the end. Raises `V3dcadError` where `path`
    cannot be written to.
    """
    try:
        if is_stream(path):
            with tempfile.TemporaryDirectory(prefix="v3dcad-") as folder:
                whole = Path(folder) / f"whole{path.suffix}"
                yield whole
                with whole.open("rb") as source, _opened(path) as target:
                    shutil.copyfileobj(source, target)
            return
        target_path = Path(os.path.realpath(path))
        if target_path.is_symlink():
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
        target_path.parent.mkdir(parents=True, exist_ok=True)
        exists = target_path.exists()
        if exists:
            target_path.open("r+b").close()  # a folder, or a file that is read-only, says so
        beside = _new_beside(target_path)
        try:
            yield beside
            if exists:
                shutil.copymode(target_path, beside)
            beside.replace(target_path)
        finally:
            beside.unlink(missing_ok=True)
    except OSError as error:
        raise V3dcadError(f"{path}: cannot be written ({error.strerror or error})") from error


def is_stream(path: Path) -> bool:
    """Whether a path is a device, a pipe, or something that this process has open already."""
    if _open_file(path) is not None:
        return True
    try:
        mode = path.stat().st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def is_stdout(path: Path) -> bool:
    """Whether a path is this process's standard output."""
    return _open_file(path) == 1


def _open_file(path: Path) -> int | None:
    """The number of the open file that a path stands for."""
    name = str(path)
    found = OPEN_FILE.fullmatch(name)
    number = found[1] if found else STREAMS.get(name)
    return None if number is None else int(number)


def _opened(path: Path) -> BinaryIO:
    """A device or pipe, opened for writing; what is open already is written on where it stands."""
    number = _open_file(path)
    return path.open("wb") if number is None else os.fdopen(os.dup(number), "wb")


def _new_beside(path: Path) -> Path:
    """A new empty file in the folder of `path`: what others left there stays."""
    number = 0
    while True:
        beside = path.with_name(f".v3dcad-{os.getpid()}-{number}{path.suffix}")
        try:
            beside.touch(exist_ok=False)
            return beside
        except FileExistsError:
            number += 1
