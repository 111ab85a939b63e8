"""A filled shape in one of its forms: what both adapters wrap."""

from __future__ import annotations

from typing import Any

from v3dcad.errors import SettingError
from v3dcad.forms import FORMS
from v3dcad.pipeline import Structure, fill
from v3dcad.sources import bare

SIZES = {
    "solid": ("thickness", "skin"),
    "struts": ("diameter", "cut", "fuse"),
    "beads": ("width", "profile"),
}
"""The keyword arguments of each form; all others are settings of `fill`."""


def shape_of(source: Any, form: str, settings: dict[str, Any]) -> tuple[Any, Structure]:
    """The OCP shape of a form of the filled source, and the structure it is taken from.

    Raises `SettingError` for another form, or a size that the form needs and is not given.
    """
    if form not in FORMS:
        raise SettingError("form", f"form {form!r}: give {', '.join(FORMS)}")
    sizes = {name: settings[name] for name in SIZES.get(form, ()) if name in settings}
    needed = SIZES.get(form, ("",))[0]
    if needed and needed not in sizes:
        raise SettingError(needed, f"{form} needs a {needed}, mm: give {needed}=…")
    structure = fill(source, **{name: settings[name] for name in settings if name not in sizes})
    made = getattr(structure, form)(**sizes)
    if form == "cells":
        from v3dcad.kernel.shapes import compound

        made = compound(map(bare, made))
    return bare(made), structure
