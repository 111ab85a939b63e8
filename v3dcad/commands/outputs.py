"""The files that a command is to write, looked at before it begins."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from v3dcad.errors import SettingError
from v3dcad.exports import KINDS, UNWRITTEN
from v3dcad.files import is_stream

ENDINGS = {**KINDS, "report": (".json",), "html": (".html", ".htm")}
"""Kinds of files that commands write, and how their names end."""

OPTIONS = {"threemf": "--3mf"}
"""Kinds whose option is named otherwise."""


def check_outputs(part: Path, files: Mapping[str, Path]) -> None:
    """Raise `SettingError` where files, by their kinds, cannot all be what they are to be.

    None may be the part, a folder, another's name, or end as another kind of file does. Devices
    and pipes may be named as often as one likes.
    """
    taken: dict[str, str] = {}
    for kind, file in files.items():
        option = OPTIONS.get(kind, f"--{kind}")
        place = os.path.realpath(file)
        if place == os.path.realpath(part):
            raise SettingError(kind, f"{file}: would overwrite the part itself; name another place")
        if file.is_dir():
            raise SettingError(kind, f"{option} {file}: a folder; name a file")
        if place in taken and not is_stream(file):
            raise SettingError(
                kind, f"{option} {file}: {taken[place]} names the same file; name another"
            )
        taken[place] = option
        _check_ending(kind, option, file)


def _check_ending(kind: str, option: str, file: Path) -> None:
    own = ENDINGS[kind]
    others = {*UNWRITTEN, *(ending for endings in ENDINGS.values() for ending in endings)} - {*own}
    if file.suffix.lower() in others:
        message = f"{option} {file}: ends as another kind of file; name it {file.stem}{own[0]}"
        raise SettingError(kind, message)
