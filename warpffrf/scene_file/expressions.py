"""Arithmetic in values: a text that begins with "=" is worked out from numbers and the file's parameters.

    "= 2 * outer_radius"    "= upper.load / (pi * sqrt(area))"    "= -speed"

Numbers, parameters by their dotted names, pi, + - * / **, brackets, and the functions below; nothing else. A single
name gives the parameter as it is: a text, a number, true or false, or a list.
"""

from __future__ import annotations

import ast
import math
import operator
import reprlib
from collections.abc import Callable
from typing import Any

from warpffrf.model.errors import InputError

LONGEST = 500  # characters: keeps the parser's recursion short
FUNCTIONS: dict[str, Any] = {
    "sqrt": math.sqrt, "sin": math.sin, "cos": math.cos, "tan": math.tan, "atan2": math.atan2,
    "radians": math.radians, "degrees": math.degrees, "abs": abs, "min": min, "max": max,
}  # fmt: skip
CONSTANTS = {"pi": math.pi}
_BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: lambda a, b: float(a) ** float(b),
}  # fmt: skip
_UNARY: dict[type, Callable[[Any], Any]] = {ast.USub: operator.neg, ast.UAdd: operator.pos}


def is_expression(value: Any) -> bool:
    """Whether a value of the file is to be worked out."""
    return isinstance(value, str) and value.startswith("=")


def evaluate(text: str, parameter: Callable[[str], Any]) -> Any:
    """The value of the expression `text` ("= ..."); `parameter` gives the value of a dotted name. `InputError`s."""
    if len(text) > LONGEST:
        raise InputError(f"an expression may have {LONGEST} characters, this one has {len(text)}")
    try:
        tree = ast.parse(text[1:].strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError(f"{text!r} is no expression; known: numbers, parameters, + - * / ** ( )") from None
    try:
        value = _value(tree, parameter, text)
    except (ArithmeticError, ValueError, TypeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{text!r} cannot be worked out: {error}") from None
    except RecursionError:
        raise InputError(f"{text!r} is nested too deeply") from None
    if isinstance(value, complex) or (isinstance(value, float) and not math.isfinite(value)):
        raise InputError(f"{text!r} is no real number")
    return value


def _value(node: ast.expr, parameter: Callable[[str], Any], text: str) -> Any:
    def number(part: ast.expr) -> float:
        value = _value(part, parameter, text)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{text!r}: {ast.unparse(part)} is {reprlib.repr(value)}, a number is needed")
        return value

    if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        return node.value
    if isinstance(node, ast.Name | ast.Attribute):
        name = ast.unparse(node)
        return CONSTANTS[name] if name in CONSTANTS else parameter(name)
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        return _BINARY[type(node.op)](number(node.left), number(node.right))
    if isinstance(node, ast.UnaryOp) and type(node.op) in _UNARY:
        return _UNARY[type(node.op)](number(node.operand))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id in FUNCTIONS:
            return FUNCTIONS[node.func.id](*(number(argument) for argument in node.args))
        raise InputError(f"{text!r}: the function {node.func.id!r} does not exist; known: {', '.join(FUNCTIONS)}")
    raise InputError(f"{text!r}: {ast.unparse(node)!r} is not understood; known: numbers, parameters, + - * / ** ( )")
