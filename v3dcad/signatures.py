"""Functions that take settings show them: in their signature, and in their help."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TypeVar

from v3dcad.errors import with_arguments
from v3dcad.settings import Checked, declared

F = TypeVar("F", bound=Callable[..., object])


def takes_settings(cls: type[Checked]) -> Callable[[F], F]:
    """Say of a function with `**settings` which they are: the fields of a class of settings.

    `inspect.signature` shows each with its type and default, `help` also what it is for. A
    parameter that the function names itself stays as it is.
    """

    def decorate(function: F) -> F:
        own = inspect.signature(function)
        kept = [
            parameter
            for parameter in own.parameters.values()
            if parameter.kind is not inspect.Parameter.VAR_KEYWORD
        ]
        fields = cls.__dataclass_fields__
        shown = [
            inspect.Parameter(
                name,
                inspect.Parameter.KEYWORD_ONLY,
                default=fields[name].default,
                annotation=fields[name].type,
            )
            for name in fields
            if name not in own.parameters
        ]
        function.__signature__ = own.replace(parameters=[*kept, *shown])  # type: ignore[attr-defined]
        lines = [f"    {_help(cls, name)}" for name in fields]
        doc = inspect.cleandoc(function.__doc__ or "")
        function.__doc__ = "\n".join([doc, "", f"Settings ({cls.__name__}):", *lines])
        return function

    return decorate


def _help(cls: type[Checked], name: str) -> str:
    known = declared(cls, name)
    unit = f" ({known.unit})" if known.unit else ""
    choices = f" {' or '.join(known.choices)}." if known.choices else ""
    method = f" Method {known.method} only." if known.method else ""
    return f"{name}{unit}: {with_arguments(known.help)}{choices}{method}"
