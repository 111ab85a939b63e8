"""Commands for setting v3dcad up."""

from __future__ import annotations

import typer

from v3dcad.commands.compiling import tell_of_compiling
from v3dcad.warm_up import ALL
from v3dcad.warm_up import warm_up as compile_all


def warm_up() -> None:
    """Compile the engine now, so that the first fill does not have to."""
    tell_of_compiling(ALL)
    compile_all()
    typer.echo("the engine is compiled")
