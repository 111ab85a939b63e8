"""Command-line options made from the settings' declarations.

An option that is not given is None, so that a profile, an `.ont` file or the default can say.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Annotated, Any, get_type_hints

import typer

from v3dcad.settings import Checked, declared, option

Command = Callable[..., None]


def with_options(*classes: type[Checked]) -> Callable[[Command], Command]:
    """Give a command one option for each setting of the classes, in their order.

    The command receives them as keyword arguments; `given` picks those of one class.
    """

    def decorate(command: Command) -> Command:
        own = inspect.signature(command, eval_str=True)
        parameters = [
            parameter
            for parameter in own.parameters.values()
            if parameter.kind is not inspect.Parameter.VAR_KEYWORD
        ]
        for cls in classes:
            parameters += [_parameter(cls, name) for name in cls.__dataclass_fields__]

        def run(**arguments: Any) -> None:
            command(**arguments)

        run.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
        run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        run.__name__ = command.__name__
        run.__doc__ = command.__doc__
        return run

    return decorate


def _parameter(cls: type[Checked], name: str) -> inspect.Parameter:
    known = declared(cls, name)
    default = cls.__dataclass_fields__[name].default
    kind = get_type_hints(cls)[name]
    names = [option(name) + ("/--no-" + option(name)[2:] if kind is bool else "")]
    says = f"{known.help[:-1]} ({known.unit})." if known.unit else known.help
    if "\n" not in str(default):
        says += f" Default: {default}."
    if known.method is not None:
        says += f" Method {known.method} only."
    number = ("NUMBER", *known.words) if known.words else ()
    number += ("EXPRESSION",) if known.fields else ()
    shown = typer.Option(
        *names,
        help=says,
        metavar="|".join(known.choices) or known.metavar or "|".join(number) or None,
        parser=_number_or_word if known.words else None,
        rich_help_panel=(cls.__doc__ or "").split(".")[0],
    )
    annotation: Any = Annotated[Any if known.words else kind | None, shown]
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation
    )


def _number_or_word(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text  # the setting's declaration says whether it is one of its words


def given(cls: type[Checked], arguments: dict[str, Any]) -> dict[str, Any]:
    """The settings of one class that were given among a command's keyword arguments."""
    return {
        name: arguments[name]
        for name in cls.__dataclass_fields__
        if arguments.get(name) is not None
    }
