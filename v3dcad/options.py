"""Command-line options made from the settings' declarations.

An option that is not given is None, so that a profile, an `.ont` file or the default can say.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Annotated, Any, get_args, get_type_hints

import typer

from v3dcad.errors import SettingError
from v3dcad.settings import Checked, Declared, checked, declared, option

Command = Callable[..., None]


def with_options(*classes: type[Checked]) -> Callable[[Command], Command]:
    """Give a command one option for each setting of the classes, in their order.

    The command receives them as keyword arguments; `given` picks those of one class. A setting that
    is on or off has a second option, `--no-…`, unless the command uses that name itself.
    """

    def decorate(command: Command) -> Command:
        own = inspect.signature(command, eval_str=True)
        parameters = [
            parameter
            for parameter in own.parameters.values()
            if parameter.kind is not inspect.Parameter.VAR_KEYWORD
        ]
        taken = {option(parameter.name) for parameter in parameters}
        for cls in classes:
            kinds = get_type_hints(cls)
            parameters += [
                _parameter(cls, name, kinds[name], taken) for name in cls.__dataclass_fields__
            ]

        def run(**arguments: Any) -> None:
            command(**arguments)

        run.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
        run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        run.__name__ = command.__name__
        run.__doc__ = command.__doc__
        return run

    return decorate


def _parameter(cls: type[Checked], name: str, kind: Any, taken: set[str]) -> inspect.Parameter:
    known = declared(cls, name)
    default = cls.__dataclass_fields__[name].default
    number = next((one for one in (float, int) if one in (get_args(kind) or (kind,))), None)
    off = "--no-" + option(name)[2:]
    names = [f"{option(name)}/{off}" if kind is bool and off not in taken else option(name)]
    says = f"{known.help[:-1]} ({known.unit})." if known.unit else known.help
    if "\n" not in str(default):
        says += f" Default: {default}."
    if known.method is not None:
        says += f" Method {known.method} only."
    takes = known.choices or (*(["NUMBER"] if number else []), *known.words)
    takes += ("EXPR",) if known.fields else ()
    shown = typer.Option(
        *names,
        help=says,
        metavar=known.metavar or "|".join(takes) or None,
        parser=_reader(name, known, number) if number else None,
        autocompletion=lambda: list(known.choices or known.words),
        rich_help_panel=(cls.__doc__ or "").split(".")[0],
    )
    annotation: Any = Annotated[Any if number else kind | None, shown]
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation
    )


def _reader(name: str, known: Declared, number: type) -> Callable[[str], float | str]:
    """What reads an option's number, whole for a setting that counts."""

    def read(text: str) -> float | str:
        try:
            found: float = number(text)
        except ValueError:
            if known.words:
                return text  # the setting's declaration says whether it is one of its words
            kind = "a whole number" if number is int else "a number"
            raise SettingError(name, f"{option(name)} {text}: give {kind}") from None
        return found

    return read


def given(cls: type[Checked], arguments: dict[str, Any]) -> dict[str, Any]:
    """The settings of one class that were given among a command's keyword arguments.

    `SettingError` for one that is outside its range.
    """
    chosen = {name: arguments[name] for name in cls.__dataclass_fields__}
    chosen = {name: value for name, value in chosen.items() if value is not None}
    return {name: checked(cls, name, value) for name, value in chosen.items()}
