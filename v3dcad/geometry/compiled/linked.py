"""Functions that are compiled once and that other compiled code calls by name.

numba takes a function, with all that it calls, into every function that calls it, and optimises
and stores it there again. Where many call a long one, as `surface_at`, that is most of the time
that compiling takes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

from llvmlite.binding import add_symbol
from numba import njit
from numba.core.cgutils import get_or_insert_function
from numba.core.types import Function
from numba.core.typing.templates import ConcreteTemplate, infer_global
from numba.extending import lower_builtin

from v3dcad.geometry.compiled.options import Options, P, R
from v3dcad.geometry.compiled.signatures import signature_of


def linked(options: Options) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compile an annotated function by numba, with options of `options.py`, to be linked.

    Compiled code calls it by the names of its module and its own, as a linker would have it, also
    from a cache. From Python it is called as any other, unless it is `INTERNAL`.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        signature = signature_of(function)
        compiled = njit(signature, **options)(function)
        (built,) = compiled.overloads.values()
        name = f"{function.__module__}.{function.__qualname__}"
        add_symbol(name, built.library.get_pointer_to_function(built.fndesc.llvm_func_name))

        @wraps(function)
        def called(*arguments: P.args, **named: P.kwargs) -> R:
            result: R = compiled(*arguments, **named)
            return result

        class Typing(ConcreteTemplate):
            key, cases = called, [signature]

        infer_global(called, Function(Typing))

        @lower_builtin(called, *signature.args)
        def call(context: Any, builder: Any, typing: Any, arguments: Any) -> Any:
            conventions, types = context.call_conv, (typing.return_type, typing.args)
            callee = get_or_insert_function(
                builder.module, conventions.get_function_type(*types), name
            )
            status, value = conventions.call_function(builder, callee, *types, arguments)
            with builder.if_then(status.is_error, likely=False):
                conventions.return_status_propagate(builder, status)
            return value

        return called

    return decorate
