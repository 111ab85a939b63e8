"""Caches of compiled code that are older than the sources."""

from __future__ import annotations

from hashlib import blake2b
from pathlib import Path

NOTE = "compiled-sources"
"""The file beside the caches that says which sources they were made of."""

COMPILED_FOLDERS = ("geometry", "structure")
"""The folders, at any depth, with compiled functions that call others in other files. The few in
`formats` call none: numba itself sees when their file has changed."""


def forget_stale(package: Path) -> None:
    """Delete numba's caches below a package's compiled folders if they were made of other sources.

    Numba compares only the file that a function stands in. It would keep using old copies of the
    functions that were compiled into it from other files before an upgrade, and crash. Where
    folders cannot be written to, nothing is done.
    """
    roots = [package / name for name in COMPILED_FOLDERS]
    try:
        sources = [source for root in roots for source in sorted(root.rglob("*.py"))]
        digest = blake2b(b"".join(source.read_bytes() for source in sources)).hexdigest()
        for folder in sorted({source.parent for source in sources}):
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
