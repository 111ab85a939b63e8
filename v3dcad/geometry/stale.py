"""Caches of compiled code that are older than the sources."""

from __future__ import annotations

from hashlib import blake2b
from pathlib import Path

NOTE = "compiled-sources"
"""The file beside the caches that tells which sources they were made of."""


def forget_stale(package: Path) -> None:
    """Delete numba's caches in a package's folders if they were made of other sources.

    Numba compares only the file that a function stands in: of functions that it has taken in from
    other files it would go on using what they were before an upgrade, and crash. Where folders
    cannot be written to, nothing is done.
    """
    folders = [package / name for name in ("geometry", "structure")]
    try:
        sources = [source for folder in folders for source in sorted(folder.glob("*.py"))]
        digest = blake2b(b"".join(source.read_bytes() for source in sources)).hexdigest()
        for folder in folders:
            caches = folder / "__pycache__"
            caches.mkdir(exist_ok=True)
            note = caches / NOTE
            if note.exists() and note.read_text(encoding="ascii") == digest:
                continue
            for cache in caches.glob("*.nb[ic]"):
                cache.unlink(missing_ok=True)
            note.write_text(digest, encoding="ascii")
    except OSError:
        pass
