"""Arrays of numbers in separate files, and arithmetic in values.

Expressions. A text that begins with "=" is evaluated from numbers and the parameters of the file.

    "= 2 * outer_radius"    "= upper.load / (pi * sqrt(area))"    "= -speed"

Expressions consist of numbers, dotted names of parameters, pi, + - * / **, brackets, and the functions below. A
single name returns the parameter unchanged: a text, a number, true or false, a list, or a table.
"""

from __future__ import annotations

import ast
import io
import math
import operator
import reprlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.files.paths import read_regular
from warpffrf.scene_file.forms import brief

MOST_BYTES = 1 << 28  # per file


def read_numbers(file: Path, column: Any, factor: Any = None) -> Any:
    """An array from {file = "...", column = n, factor = x}, multiplied by the factor: .npy, or text with commas or
    blanks; whole numbers remain integers."""
    import numpy as np

    name = file.name
    if column is not None and (isinstance(column, bool) or not isinstance(column, int) or column < 0):
        raise InputError(f"column must be a whole number from 0, got {brief(column)}")
    if not file.is_file():
        raise InputError(f"file {name!r} does not exist; it is searched in {file.parent}")
    try:
        content = read_regular(file, MOST_BYTES)
    except InputError as error:
        raise InputError(f"file {name!r} {error}") from None
    except OSError as error:
        raise InputError(f"file {name!r} cannot be read ({error.strerror or error})") from None
    try:
        if not content.strip():
            raise ValueError("is empty")
        if file.suffix.lower() == ".npy":
            array = _array(content)
        else:
            array = np.loadtxt(content.decode("utf-8").replace(",", " ").splitlines(), ndmin=2, comments="#")
            array = array[:, 0] if array.shape[1] == 1 else array
    except (ValueError, MemoryError):  # NumPy's message would quote the contents of the file
        raise InputError(f"file {name!r} is not a table of numbers{_at_line(content)}") from None
    if column is not None:
        if array.ndim != 2 or column >= array.shape[1]:
            raise InputError(f"file {name!r}: column {column} does not exist, its numbers have shape {array.shape}")
        array = array[:, column]
    if factor is not None:
        return array * require_number(factor, "factor")
    whole = (
        array.size and np.all(np.isfinite(array)) and np.all(array == np.rint(array)) and np.abs(array).max() < 2**53
    )
    return array.astype(np.int64) if whole else array


def _array(content: bytes) -> Any:
    """The array of a .npy file. Raises ValueError if the header declares more numbers than the file has."""
    import numpy as np

    stream = io.BytesIO(content)
    major = np.lib.format.read_magic(stream)[0]
    read_header = np.lib.format.read_array_header_1_0 if major == 1 else np.lib.format.read_array_header_2_0
    shape, _, dtype = read_header(stream)
    if dtype.kind not in "biuf" or math.prod(shape) * dtype.itemsize != len(content) - stream.tell():
        raise ValueError("no array of numbers of the size of the file")
    return np.load(io.BytesIO(content), allow_pickle=False)


def _at_line(content: bytes) -> str:
    """Text for a message: the first line that is not numeric; "" if there is none."""
    for number, line in enumerate(content.decode("utf-8", errors="replace").splitlines(), start=1):
        for word in line.replace(",", " ").split("#")[0].split():
            try:
                float(word)
            except ValueError:
                return f": line {number} is not numeric"
    return ""


LONGEST = 500  # characters: limits the recursion of the parser
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
    """Whether a value of the file is an expression."""
    return isinstance(value, str) and value.startswith("=")


def evaluate(text: str, parameter: Callable[[str], Any]) -> Any:
    """The value of the expression `text` ("= ..."). parameter: the value of a dotted name. Raises `InputError`."""
    if len(text) > LONGEST:
        raise InputError(f"an expression may have at most {LONGEST} characters, this one has {len(text)}")
    try:
        tree = ast.parse(text[1:].strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError(f"{text!r} is not an expression; known: numbers, parameters, + - * / ** ( )") from None
    try:
        value = _value(tree, parameter, text)
    except (ArithmeticError, ValueError, TypeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{text!r} cannot be evaluated: {error}") from None
    except RecursionError:
        raise InputError(f"{text!r} is nested too deeply") from None
    if isinstance(value, complex) or (isinstance(value, float) and not math.isfinite(value)):
        raise InputError(f"{text!r} is not a real number")
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
    raise InputError(f"{text!r}: {ast.unparse(node)!r} is not supported; known: numbers, parameters, + - * / ** ( )")
