"""Writing files whole or not at all, and saying plainly why one cannot be read or written."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from v3dcad.errors import V3dcadError


@contextmanager
def written_beside(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to; it takes the place of `path` when the block succeeds.

    Its name ends as that of `path` does, since some writers go by the ending. Where the block
    fails, nothing is left behind. Raises `V3dcadError` where the folder cannot be written to.
    """
    beside = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        beside.touch(exist_ok=False)
        try:
            yield beside
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)
    except OSError as error:
        raise V3dcadError(f"{path}: cannot be written ({error.strerror or error})") from error
