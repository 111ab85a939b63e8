"""Where numba keeps compiled code: a place that can be written to, and nothing of older sources.

Numba takes the first of three places that it can write to: the folder that NUMBA_CACHE_DIR names,
`__pycache__` beside the sources, the user's cache.
"""

from __future__ import annotations

import atexit
import os
import shutil
import stat
import sys
import tempfile
from hashlib import blake2b
from pathlib import Path
from typing import Any

from numba.core import config as _config
from numba.core.caching import (
    InTreeCacheLocator,
    UserProvidedCacheLocator,
    UserWideCacheLocator,
)

from v3dcad.errors import V3dcadError

NOTE = "compiled-sources"
"""The file beside the caches that says which sources they were made of."""

COMPILED_FOLDERS = ("geometry", "structure")
"""The folders, at any depth, with compiled functions that call others in other files. The few in
`formats` call none: numba itself sees when their file has changed."""

config: Any = _config

VARIABLE = "NUMBA_CACHE_DIR"


def settle_caches(package: Path) -> None:
    """Have numba keep what it compiles of a package, and nothing of its older sources.

    Where numba finds no place (a read-only install, and no home), a folder in the system's
    temporary folder becomes it, which is said once on stderr. Matplotlib, which would find no place
    either and say so each time, then keeps its list of fonts there, too. To be called before
    anything is compiled.
    """
    sources = [
        source for name in COMPILED_FOLDERS for source in sorted((package / name).rglob("*.py"))
    ]
    places = [_place(source) for source in sources]
    if None in places:
        folder = _temporary_folder()
        os.environ[VARIABLE] = str(folder)  # for child processes too
        os.environ.setdefault("MPLCONFIGDIR", str(folder / "matplotlib"))
        config.reload_config()
        places = [_place(source) for source in sources]
    _forget_stale(sources, sorted({place for place in places if place}))


def _place(source: Path) -> Path | None:
    """The folder in which numba keeps what it compiles of a file; None where it finds none."""
    for kind in (UserProvidedCacheLocator, InTreeCacheLocator, UserWideCacheLocator):
        if kind is UserProvidedCacheLocator and not config.CACHE_DIR:
            continue
        found = kind(settle_caches, str(source))
        if kind is UserWideCacheLocator and not Path(found.get_cache_path()).is_absolute():
            continue  # "~": there is no home, and the working folder is none
        try:
            found.ensure_cache_path()
        except OSError:
            continue
        return Path(found.get_cache_path())
    return None


def _temporary_folder() -> Path:
    """A folder of this user alone; where another user holds its name, one for this process."""
    number = f"-{os.getuid()}" if hasattr(os, "getuid") else ""
    folder = Path(tempfile.gettempdir()) / f"v3dcad{number}"
    remedy = f"to keep it elsewhere, name a folder of yours in {VARIABLE}"
    try:
        folder.mkdir(mode=0o700)
    except FileExistsError:
        if _is_own(folder):
            return folder
        own = Path(tempfile.mkdtemp(prefix="v3dcad-"))
        atexit.register(shutil.rmtree, own, ignore_errors=True)
        _say(f"{folder} is open to others and not used: all is compiled anew each time; {remedy}")
        return own
    _say(f"no home or program folder to write to: {folder} keeps what is compiled; {remedy}")
    return folder


def _is_own(folder: Path) -> bool:
    """Whether a folder is no link, belongs to this user, and nobody else may enter it.

    Numba unpickles what it finds there: whoever can write to it can run code.
    """
    found = folder.lstat()
    if not hasattr(os, "getuid"):
        return stat.S_ISDIR(found.st_mode)
    return (
        stat.S_ISDIR(found.st_mode)
        and found.st_uid == os.getuid()
        and not stat.S_IMODE(found.st_mode) & 0o077
    )


def _say(what: str) -> None:
    print(f"v3dcad: {what}", file=sys.stderr)


def _forget_stale(sources: list[Path], places: list[Path]) -> None:
    """Delete what numba keeps in folders if it was made of other sources.

    Numba compares only the file that a function stands in. It would keep using old copies of the
    functions that were compiled into it from other files before an upgrade, and crash, or compute
    what was computed before. Raises `V3dcadError` where old code cannot be deleted.
    """
    digest = blake2b(b"".join(source.read_bytes() for source in sources)).hexdigest()
    for place in places:
        note = place / NOTE
        if note.exists() and note.read_bytes() == digest.encode():
            continue
        try:
            for old in (*place.glob("*.nb[ic]"), note):
                old.unlink(missing_ok=True)
            note.write_text(digest, encoding="ascii")
        except OSError as error:
            raise V3dcadError(
                f"{place}: holds code of older sources that cannot be deleted ({error.strerror}); "
                f"delete it, or name another folder in {VARIABLE}"
            ) from error
