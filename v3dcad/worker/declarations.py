"""Settings as JSON: how each is declared, and values that come back."""

from __future__ import annotations

import math
from dataclasses import asdict
from types import NoneType
from typing import Any, get_args, get_type_hints

from v3dcad.errors import SettingError
from v3dcad.settings import (
    Checked,
    ExportSettings,
    FillSettings,
    PrintSettings,
    declared,
    option,
)

GROUPS: dict[str, type[Checked]] = {
    "fill": FillSettings,
    "print": PrintSettings,
    "export": ExportSettings,
}


def declarations() -> list[dict[str, Any]]:
    """All settings, in the order of their declaration; limits that there are none are null."""
    return [_declaration(group, cls, name) for group, cls in GROUPS.items() for name in _names(cls)]


def chosen(cls: type[Checked], values: object) -> dict[str, Any]:
    """Values from JSON as a settings class takes them.

    Raises `SettingError` for a name that is no setting, or a value of another type.
    """
    if not isinstance(values, dict):
        raise SettingError("settings", "settings are no object: write them as {name: value}")
    known = _names(cls)
    for name in values:
        if name not in known:
            raise SettingError(name, f"there is no setting {name!r}")
    return {name: _value(cls, name, value) for name, value in values.items()}


def own(settings: FillSettings) -> dict[str, Any]:
    """Settings by name, but for those of another method."""
    return {
        name: getattr(settings, name)
        for name in _names(FillSettings)
        if declared(FillSettings, name).method in (None, settings.method)
    }


def _names(cls: type[Checked]) -> tuple[str, ...]:
    return tuple(cls.__dataclass_fields__)


def _type(cls: type[Checked], name: str) -> type:
    """float, int, bool or str; a number that words may stand for is a number."""
    hint = get_type_hints(cls)[name]
    kinds = [kind for kind in get_args(hint) or (hint,) if kind is not NoneType]
    first: type = kinds[0]
    return first


def _declaration(group: str, cls: type[Checked], name: str) -> dict[str, Any]:
    known = {
        key: None if isinstance(value, float) and math.isinf(value) else value
        for key, value in asdict(declared(cls, name)).items()
        if key != "metavar"
    }
    return {
        "name": name,
        "group": group,
        "type": _type(cls, name).__name__,
        "default": cls.__dataclass_fields__[name].default,
        **known,
    }


def _value(cls: type[Checked], name: str, value: object) -> object:
    kind, known = _type(cls, name), declared(cls, name)
    if isinstance(value, str) and (kind is str or known.fields or value in known.words):
        return value
    if kind is bool and isinstance(value, bool):
        return value
    if kind in (int, float) and isinstance(value, (int, float)) and not isinstance(value, bool):
        if kind is float:
            return float(value)
        if isinstance(value, int) or value.is_integer():
            return int(value)
    wanted = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}
    raise SettingError(
        name, f"{option(name)} {value}: give {' or '.join([wanted[kind], *known.words])}"
    )
