"""How commands print what they found."""

from __future__ import annotations

from collections.abc import Iterable

import typer


def print_rows(rows: Iterable[tuple[str, object]]) -> None:
    """Print names and values in two columns."""
    for name, value in rows:
        typer.echo(f"{name:<12}  {value}")
