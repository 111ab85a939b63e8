"""Expressions of x, y and z as fields: parsed, never run as Python."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.model import Floats
from v3dcad.settings import Field

LONGEST = 4000
"""Characters of an expression."""

GIVE = "give a number, auto, or an expression of x, y, z"
"""What to do where a text is none."""

AXES = {"x": 0, "y": 1, "z": 2}
CONSTANTS = {"pi": np.pi}

OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
}


def ramp(value: Floats, start: float, end: float, first: float, last: float) -> Floats:
    """From `first` where a value is at its start to `last` where it is at its end, in a line."""
    share = np.clip((value - start) / (end - start), 0.0, 1.0)
    return np.asarray(first + share * (last - first))


def smooth(value: Floats, start: float, end: float, first: float, last: float) -> Floats:
    """As `ramp`, but leaving both ends smoothly."""
    share = np.clip((value - start) / (end - start), 0.0, 1.0)
    return np.asarray(first + share * share * (3 - 2 * share) * (last - first))


FUNCTIONS: dict[str, tuple[Callable[..., Any], int, int]] = {
    "min": (lambda *values: np.minimum.reduce(np.broadcast_arrays(*values)), 2, 20),
    "max": (lambda *values: np.maximum.reduce(np.broadcast_arrays(*values)), 2, 20),
    "abs": (np.abs, 1, 1),
    "sqrt": (np.sqrt, 1, 1),
    "exp": (np.exp, 1, 1),
    "log": (np.log, 1, 1),
    "sin": (np.sin, 1, 1),
    "cos": (np.cos, 1, 1),
    "tan": (np.tan, 1, 1),
    "atan2": (np.arctan2, 2, 2),
    "hypot": (lambda *values: np.sqrt(sum(value**2 for value in values)), 2, 3),
    "ramp": (ramp, 5, 5),
    "smooth": (smooth, 5, 5),
}
"""What can be called, and with how few and how many values."""

Source = Callable[..., Field]
"""Makes a field of constants: numbers and texts."""

Evaluated = Callable[[tuple[Floats, Floats, Floats]], Any]


def field_of(text: str, sources: Mapping[str, Source]) -> Field:
    """The field that an expression of x, y and z says, mm.

    It has numbers, + - * / **, comparisons in `a if b else c`, the functions of `FUNCTIONS`, and
    `sources`, called with numbers and texts. Raises `SettingError` for anything else.
    """
    if len(text) > LONGEST:
        raise SettingError("cell_size", f"--cell-size: an expression of over {LONGEST} characters")
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        why = getattr(error, "msg", None) or "cannot be read"
        raise _refusal(text, f"{why}; {GIVE}") from None
    try:
        evaluate = _compiled(tree.body, text, sources)
    except RecursionError:
        raise _refusal(text, "nested too deeply") from None

    def field(x: Floats, y: Floats, z: Floats) -> Floats:
        with np.errstate(all="ignore"):
            return np.broadcast_to(np.asarray(evaluate((x, y, z)), np.float64), np.shape(x))

    return field


def _refusal(text: str, why: str) -> SettingError:
    shown = text if len(text) <= 60 else text[:57] + "…"
    return SettingError("cell_size", f"--cell-size {shown!r}: {why}")


def _compiled(node: ast.expr, text: str, sources: Mapping[str, Source]) -> Evaluated:
    """A function that evaluates a node at coordinates."""

    def part(inner: ast.expr) -> Evaluated:
        return _compiled(inner, text, sources)

    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        try:
            number = np.float64(node.value)
        except OverflowError:
            raise _refusal(text, "a number is too large") from None
        return lambda at: number
    if isinstance(node, ast.Name):
        if node.id in AXES:
            axis = AXES[node.id]
            return lambda at: at[axis]
        if node.id in CONSTANTS:
            return lambda at: CONSTANTS[node.id]
        raise _refusal(text, f"{node.id[:30]!r} is not known; {GIVE}")
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        left, right, operate = part(node.left), part(node.right), OPERATORS[type(node.op)]
        return lambda at: operate(left(at), right(at))
    if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
        value, operate = part(node.operand), OPERATORS[type(node.op)]
        return lambda at: operate(value(at))
    if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in OPERATORS:
        left, right = part(node.left), part(node.comparators[0])
        operate = OPERATORS[type(node.ops[0])]
        return lambda at: operate(left(at), right(at))
    if isinstance(node, ast.IfExp):
        test, yes, no = part(node.test), part(node.body), part(node.orelse)
        return lambda at: np.where(test(at), yes(at), no(at))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return _called(node, node.func.id, text, sources)
    raise _refusal(text, f"{ast.unparse(node)[:30]!r} is not allowed in an expression")


def _called(node: ast.Call, name: str, text: str, sources: Mapping[str, Source]) -> Evaluated:
    if name in sources:
        values = [_constant(value, name, text) for value in node.args]
        named = {str(given.arg): _constant(given.value, name, text) for given in node.keywords}
        try:
            field = sources[name](*values, **named)
        except TypeError as error:
            raise _refusal(text, f"{name}: {str(error).split('() ')[-1]}") from error
        return lambda at: field(*at)
    if name not in FUNCTIONS:
        known = ", ".join(sorted([*FUNCTIONS, *sources]))
        raise _refusal(text, f"there is no function {name[:30]!r}; there are {known}")
    function, fewest, most = FUNCTIONS[name]
    if node.keywords or not fewest <= len(node.args) <= most:
        count = f"{fewest}" if fewest == most else f"{fewest} to {most}"
        raise _refusal(text, f"{name} takes {count} values")
    parts = [_compiled(value, text, sources) for value in node.args]
    return lambda at: function(*(value(at) for value in parts))


def _constant(node: ast.expr, name: str, text: str) -> Any:
    """A number or text that a source is called with."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value = _constant(node.operand, name, text)
        if not isinstance(value, str):
            return -value
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float, str):
        return node.value
    raise _refusal(text, f"{name} takes numbers and texts in quotes")
