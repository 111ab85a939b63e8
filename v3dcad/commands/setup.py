"""Commands for setting v3dcad up."""

from __future__ import annotations

import typer


def warm_up() -> None:
    """Compile the engine now, so that the first fill does not have to."""
    from v3dcad.structure.warm_up import warm_up as compile_engine

    compile_engine()
    typer.echo("the engine is compiled")
