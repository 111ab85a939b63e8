"""Command-line options made from the settings' declarations."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Annotated, Any, TypeVar, get_type_hints

import typer

from v3dcad.settings import Checked, declared, option

S = TypeVar("S", bound=Checked)
Command = Callable[..., None]


def with_options(*classes: type[Checked]) -> Callable[[Command], Command]:
    """Give a command one option for each setting of the classes, in their order.

    The command receives them as keyword arguments; `taken` makes the classes of them.
    """

    def decorate(command: Command) -> Command:
        own = inspect.signature(command, eval_str=True)
        parameters = [
            parameter
            for parameter in own.parameters.values()
            if parameter.kind is not inspect.Parameter.VAR_KEYWORD
        ]
        parameters += [
            _parameter(cls, name) for cls in classes for name in cls.__dataclass_fields__
        ]

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
    help_text = f"{known.help[:-1]} ({known.unit})." if known.unit else known.help
    shown = typer.Option(
        option(name),
        help=help_text,
        metavar=known.metavar,
        rich_help_panel=(cls.__doc__ or "")[:-1],
    )
    annotation: Any = Annotated[get_type_hints(cls)[name], shown]
    return inspect.Parameter(
        name,
        inspect.Parameter.KEYWORD_ONLY,
        default=cls.__dataclass_fields__[name].default,
        annotation=annotation,
    )


def taken(cls: type[S], arguments: dict[str, Any]) -> S:
    """The settings of one class out of a command's keyword arguments."""
    return cls(**{name: arguments[name] for name in cls.__dataclass_fields__})
