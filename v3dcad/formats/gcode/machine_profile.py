"""Machine profiles: TOML files that give print settings their values."""

from __future__ import annotations

import difflib
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any, get_args, get_type_hints

from v3dcad.errors import FormatError, SettingError
from v3dcad.settings import PrintSettings

MAX_FILE_BYTES = 1_000_000


def profile_names() -> list[str]:
    """The profiles that come with v3dcad."""
    found = (resources.files("v3dcad") / "profiles").iterdir()
    return sorted(entry.name.removesuffix(".toml") for entry in found)


def print_settings(profile: str | None = None, **chosen: Any) -> PrintSettings:
    """What a profile says, if there is one, but for the settings that are chosen.

    Raises as `read_profile`, and as `PrintSettings` for a value that does not fit.
    """
    known = {} if profile is None else read_profile(profile)
    return PrintSettings(**{**known, **chosen})


def read_profile(name: str) -> dict[str, Any]:
    """The settings of a profile: one that comes with v3dcad, or a path to the user's own file.

    Values are checked as a whole by `print_settings`. Raises `FormatError` for a file that cannot
    be read, is not TOML, or has a key or value that no setting takes.
    """
    if name in profile_names():
        return _parsed((resources.files("v3dcad") / "profiles" / f"{name}.toml").read_bytes(), name)
    path = Path(name)
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_FILE_BYTES + 1)
    except OSError as error:
        known = ", ".join(profile_names())
        raise FormatError(
            f"cannot be read ({error.strerror}); name a TOML file, or one of {known}", path=name
        ) from error
    return _parsed(data, name)


def _parsed(data: bytes, path: str) -> dict[str, Any]:
    if len(data) > MAX_FILE_BYTES:
        raise FormatError("larger than 1 MB; name a profile", path=path)
    try:
        values = tomllib.loads(data.decode("utf-8"))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise FormatError("not UTF-8 text; save it as UTF-8", path=path, line=line) from error
    except tomllib.TOMLDecodeError as error:
        raise FormatError(f"not valid TOML: {error}", path=path) from error
    return {key: _checked(key, value, path) for key, value in values.items()}


def _checked(key: str, value: Any, path: str) -> Any:
    known = PrintSettings.__dataclass_fields__
    if key not in known:
        near = difflib.get_close_matches(key, known, n=1)
        hint = f"did you mean {near[0]}?" if near else "see `v3dcad fill -h` for their names"
        raise FormatError(f"{key} is not a setting; {hint}", path=path)
    kind = get_type_hints(PrintSettings)[key]
    wanted = get_args(kind) or (kind,)
    if float in wanted and type(value) is int:
        value = float(value)
    if type(value) not in wanted:
        words = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}
        raise FormatError(
            f"{key} = {value!r}: give {' or '.join(words[one] for one in wanted)}", path=path
        )
    try:
        alone: dict[str, Any] = {key: value}
        PrintSettings(**alone).bed_size()
    except SettingError as error:
        raise FormatError(f"{key}: {error.message}", path=path) from error
    return value


def profile_text(values: dict[str, Any], comment: str) -> str:
    """Settings as the TOML text of a profile, under a line of comment."""
    lines = [f"# {comment}", ""]
    for key, value in values.items():
        if isinstance(value, str) and "\n" in value:
            escaped = value.replace("\\", "\\\\").replace('"""', '""\\"')
            lines += [f'{key} = """', f'{escaped}"""']
        elif isinstance(value, str):
            escaped = value.replace("\\", "\\\\").replace('"', '\\"')
            lines.append(f'{key} = "{escaped}"')
        else:
            lines.append(f"{key} = {str(value).lower() if isinstance(value, bool) else value}")
    return "\n".join(lines) + "\n"
