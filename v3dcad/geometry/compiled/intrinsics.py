"""What Python has no words for: sums in 128 bits, and room on the stack."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

StackArray = Annotated[Any, types.CPointer(types.float64)]
"""Room for numbers on the stack."""

STACK_ROOM = 26
"""How many numbers a `StackArray` has room for: a spline has so many poles in a span, along one
parameter, since OCCT makes none of a degree above 25."""


def _sign_of_sum(
    typing_context: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any
) -> tuple[Any, Any]:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        wide, word = ir.IntType(128), ir.IntType(64)
        p, q, r, s, t, u = (builder.sext(argument, wide) for argument in arguments)
        total = builder.add(builder.add(builder.mul(p, q), builder.mul(r, s)), builder.mul(t, u))
        zero = ir.Constant(wide, 0)
        positive = builder.zext(builder.icmp_signed(">", total, zero), word)
        negative = builder.zext(builder.icmp_signed("<", total, zero), word)
        return builder.sub(positive, negative)

    return types.int64(*[types.int64] * 6), generate


def _stack_array(typing_context: Any) -> tuple[Any, Any]:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return cgutils.alloca_once(builder, ir.DoubleType(), STACK_ROOM)

    return types.CPointer(types.float64)(), generate


sign_of_sum = cast(Callable[[int, int, int, int, int, int], int], intrinsic(_sign_of_sum))
"""The exact sign (−1, 0, 1) of ab + cd + ef for 64-bit integers, summed in 128 bits."""

stack_array = cast(Callable[[], StackArray], intrinsic(_stack_array))
"""A `StackArray` that lasts until the compiled function that asks for it returns."""
