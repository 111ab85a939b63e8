# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Where the workbench's own files lie, and where it keeps what it makes."""

from __future__ import annotations

from pathlib import Path

import FreeCAD as App

HERE = Path(__file__).resolve().parent
ICONS = HERE / "resources" / "icons"
TRANSLATIONS = HERE / "resources" / "translations"
PINS = HERE / "resources" / "pins.txt"

PREFERENCES = App.ParamGet("User parameter:BaseApp/Preferences/Mod/V3dcad")


def icon(name: str) -> str:
    """The path of an icon."""
    return str(ICONS / f"{name}.svg")


def user_folder() -> Path:
    """Where environment and prints are kept, made if it is not there."""
    folder = Path(App.getUserAppDataDir()) / "v3dcad"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def source_beside() -> Path | None:
    """v3dcad's source where the add-on is a clone of its repository, otherwise None."""
    root = HERE.parents[2]
    return root if (root / "v3dcad" / "version.py").is_file() else None
