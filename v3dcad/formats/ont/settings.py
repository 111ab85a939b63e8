"""The settings in an `.ont` file, made from their declarations."""

from __future__ import annotations

import re
from typing import Any, get_args, get_type_hints

from v3dcad.errors import SettingError
from v3dcad.formats.numbers import number_in, number_text
from v3dcad.formats.ont.sections import Field
from v3dcad.settings import FillSettings, declared

IN_OWN_SECTIONS = ("offset", "layer_height")
"""Settings that the thesis gives a section each."""

ALWAYS = ("method", "cell_size", "stretch", "heights", "max_overhang", "random_seed")
"""Settings that are written even where they are the default."""

NEVER = ("density", "mass")
"""Settings that stand for a cell size, which the print settings have a say in: it is written."""

UNSAID = {"heights": "bottom"}
"""What files of a foam mean that do not say: settings that came later than format 2."""


def settings_fields(settings: FillSettings) -> dict[str, str]:
    """The settings that differ from their defaults, by name, as text."""
    defaults = FillSettings()
    return {
        name: _text(getattr(settings, name))
        for name in FillSettings.__dataclass_fields__
        if name not in IN_OWN_SECTIONS
        and declared(FillSettings, name).method in (None, settings.method)
        and (name in ALWAYS or getattr(settings, name) != getattr(defaults, name))
    }


def settings_from(
    fields: dict[str, Field], offset: float, layer_height: float, sites: int | None
) -> FillSettings:
    """The settings in a file, the others at their defaults; `sites` where the file lists them.

    A file without settings of ours is the thesis's.

    Raises `FormatError` for an unknown setting, and for a value that is invalid or out of range.
    """
    hints = get_type_hints(FillSettings)
    chosen: dict[str, Any] = {"layer_height": layer_height}
    method = fields["method"].value if "method" in fields else "thesis"
    chosen["method"] = method
    chosen |= {"offset": offset} if method == "thesis" else UNSAID
    for name, field in fields.items():
        if name not in hints or name in IN_OWN_SECTIONS:
            raise field.error(
                f"the setting {name[:40]!r} is unknown to this v3dcad; update it, since the "
                "structure depends on it"
            )
        if name in NEVER:
            raise field.error(f"{name} stands for a cell size: the file must say that instead")
        chosen[name] = _value(field, hints[name])
        known = declared(FillSettings, name)
        if known.fields and isinstance(chosen[name], str) and chosen[name] not in known.words:
            # The sites that an expression made are listed in its place.
            raise field.error(f"{field.value[:40]!r}: give a number or {' or '.join(known.words)}")
        try:
            FillSettings(**{"method": method, name: chosen[name]})
        except SettingError as error:
            raise field.error(error.message) from error
    if sites is not None and method == "thesis" and chosen.setdefault("sites", sites) != sites:
        raise fields["sites"].error(f"states {chosen['sites']} sites, but {sites} are listed")
    return FillSettings(**chosen)


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return number_text(value) if isinstance(value, float) else str(value)


def _value(field: Field, hint: Any) -> object:
    """The value of a field's text, given the setting's type."""
    kinds = get_args(hint) or (hint,)
    text = field.value
    if bool in kinds and text in ("true", "false"):
        return text == "true"
    if int in kinds and re.fullmatch("[0-9]{1,19}", text):
        return int(text)
    number = number_in(text)
    if float in kinds and number is not None:
        return number
    if text in kinds or (str in kinds and re.fullmatch(r"[\w.+-]{1,64}", text, re.ASCII)):
        return text
    raise field.error(f"{text[:40]!r} is not a value of this setting")
