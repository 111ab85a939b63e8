"""Curves as the text of a STEP file; what OCCT and FreeCAD read of it is in test_forms.py."""

from __future__ import annotations

from v3dcad.formats.curve_step import step_text


def test_names_are_written_as_part_21_has_them() -> None:
    """ISO 10303-21, 6.4.3: four digits for a letter of the basic plane, eight for others."""
    text = "".join(step_text([], "o'ö\\😀\udcff", "AP214", "1970-01-01T00:00:00"))
    assert r"FILE_NAME('o''\X2\00F6\X0\\\\X4\0001F600\X0\\X2\003F\X0\'," in text
