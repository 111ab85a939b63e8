"""How a print is set: a machine profile and options, for all commands that trace one."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from v3dcad.options import given
from v3dcad.settings import PrintSettings

Profile = Annotated[
    str | None,
    typer.Option(metavar="NAME|TOML", help="Machine profile, as prusa-mk4, or a file of yours."),
]


def print_settings(profile: str | None, settings: dict[str, Any]) -> PrintSettings:
    """What a profile says, unless an option says otherwise; `SettingError` for nonsense."""
    from v3dcad.formats.gcode import machine_profile
    from v3dcad.formats.gcode.blocks import check_blocks

    chosen = machine_profile.print_settings(profile, **given(PrintSettings, settings))
    chosen.bed_size()
    check_blocks(chosen)
    return chosen
