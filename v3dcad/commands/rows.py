"""How commands print what they found."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import typer

from v3dcad.files import is_stdout


def print_rows(rows: Iterable[tuple[str, object]], written: Iterable[Path] = ()) -> None:
    """Print names and values in two columns: on stderr where stdout is one of the written files."""
    aside = any(map(is_stdout, written))
    for name, value in rows:
        typer.echo(f"{name:<12}  {value}", err=aside)
