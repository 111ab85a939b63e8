"""Printers by name: where they are, in a file; their keys, in the system's key store.

The file is `printers.toml` in the user's folder for settings. Where the system has no key store
(`keyring` finds none, as on a computer without a desktop), keys lie beside it in `keys.json`, which
only its owner can read.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import tomllib
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import platformdirs

from v3dcad.errors import FormatError, LocalPrinterError, SettingError
from v3dcad.printer.settings import HostSettings

SERVICE = "v3dcad"
"""What keys are filed under in the key store."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}")


def folder() -> Path:
    """Where the file lies."""
    return platformdirs.user_config_path("v3dcad")


def printers() -> dict[str, HostSettings]:
    """All named printers, by name. Raises `FormatError` for a file that cannot be read."""
    path = folder() / "printers.toml"
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8"))
        return {name: _entry(name, entries[name], path) for name in sorted(entries)}
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise FormatError(f"cannot be read ({error.strerror})", path=str(path)) from error
    except ValueError as error:
        raise FormatError(f"no TOML: {error}", path=str(path)) from error


def printer(name: str) -> HostSettings:
    """One named printer; `SettingError` if there is none of this name."""
    known = printers()
    if name not in known:
        names = ", ".join(known) or "none yet; v3dcad printer add"
        raise SettingError("to", f"{name}: no printer of this name (known: {names})")
    return known[name]


def add(name: str, settings: HostSettings) -> Path:
    """Write a printer down, in the place of one of the same name; the file it is written to."""
    if not NAME.fullmatch(name):
        raise SettingError("name", f"{name!r}: name a printer with letters, digits, - _ and .")
    _write(printers() | {name: settings})
    return folder() / "printers.toml"


def remove(name: str) -> None:
    """Forget a printer and its key; `SettingError` if there is none of this name."""
    printer(name)
    set_key(name, "")
    _write({known: settings for known, settings in printers().items() if known != name})


def key(name: str) -> str:
    """The key of a printer, "" if it has none."""
    import keyring
    import keyring.errors

    with contextlib.suppress(keyring.errors.KeyringError):
        if found := keyring.get_password(SERVICE, name):
            return found
    return _key_file().get(name, "")


def set_key(name: str, secret: str) -> str:
    """Keep a key ("" forgets it); where it is kept now, in words."""
    import keyring
    import keyring.errors

    kept = _key_file()
    try:
        if secret:
            keyring.set_password(SERVICE, name, secret)
        elif keyring.get_password(SERVICE, name):
            keyring.delete_password(SERVICE, name)
        where = "the system's key store"
        secret = ""
    except keyring.errors.KeyringError:
        where = f"{_key_path()}, which only you can read; this system has no key store"
    kept.pop(name, None)
    if secret:
        kept[name] = secret
    if kept or _key_path().exists():
        _private(_key_path(), json.dumps(kept, indent=1))
    return where


def _entry(name: str, values: Any, path: Path) -> HostSettings:
    known = {field.name for field in fields(HostSettings)}
    if not isinstance(values, dict) or not values.keys() <= known:
        raise FormatError("knows a key that no printer has", path=str(path), section=name)
    return HostSettings(**values)


def _write(entries: dict[str, HostSettings]) -> None:
    lines = ["# Printers that v3dcad knows; v3dcad printer add writes this file.\n"]
    for name in sorted(entries):
        lines.append(f"\n[{json.dumps(name)}]\n")
        for field, value in asdict(entries[name]).items():
            # JSON's texts and numbers are TOML's as well, but for letters as two numbers, and DEL.
            text = json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
            lines.append(f"{field} = {text}\n")
    _private(folder() / "printers.toml", "".join(lines))


def _key_path() -> Path:
    return folder() / "keys.json"


def _key_file() -> dict[str, str]:
    try:
        found: object = json.loads(_key_path().read_text(encoding="utf-8"))
        if not isinstance(found, dict):
            raise ValueError("no names in it")
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise LocalPrinterError(f"{_key_path()}: cannot be read ({error}); delete it") from error
    return {str(name): str(secret) for name, secret in found.items()}


def _private(path: Path, text: str) -> None:
    """Write a file whole, for its owner alone; no moment in which others could read it."""
    beside = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(text)
        beside.replace(path)
    except OSError as error:
        raise LocalPrinterError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        beside.unlink(missing_ok=True)
