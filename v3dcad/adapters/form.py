"""A filled shape in one of its forms: what both adapters wrap."""

from __future__ import annotations

from typing import Any

from v3dcad.forms import FORMS, check_form
from v3dcad.pipeline import Structure, fill
from v3dcad.sources import bare


def shape_of(source: Any, form: str, settings: dict[str, Any]) -> tuple[Any, Structure]:
    """The OCP shape of a form of the filled source, and the structure it is taken from.

    Of `settings`, what the form takes goes to it (see `FORMS`), and all others to `fill`. Raises
    `SettingError` for another form, or a size that the form needs and is not given.
    """
    sizes = {name: settings[name] for name in FORMS.get(form, ()) if name in settings}
    check_form(form, sizes, FORMS)
    structure = fill(source, **{name: settings[name] for name in settings if name not in sizes})
    made = getattr(structure, form)(**sizes)
    if form == "cells":
        from v3dcad.kernel.shapes import compound

        made = compound(map(bare, made))
    return bare(made), structure
