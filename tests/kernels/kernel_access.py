"""Which arrays a kernel reads and which it writes, from its source: Python and the C++ of native functions.

Followed through the functions that it calls. An array is read where an element of it stands in an expression, and
written where one is assigned; C++ reaches arrays through pointers, `double* q = y.data + at`, which are followed by
name. What a kernel reads of what it has just written counts as read.
"""

from __future__ import annotations

import ast
import functools
import importlib
import inspect
import re
import textwrap
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

ASSIGNED = re.compile(r"\s*(\+|-|\*|/)?=(?!=)")


@dataclass
class Access:
    """Names of parameters."""

    read: set[str] = field(default_factory=set)
    written: set[str] = field(default_factory=set)

    def take(self, name: str, other: Access, theirs: str) -> None:
        if theirs in other.read:
            self.read.add(name)
        if theirs in other.written:
            self.written.add(name)


def access_of(kernel: Any) -> Access:
    """Of the parameters of `kernel`."""
    return _of_python(kernel.func)


@functools.cache
def _of_python(function: Any) -> Access:
    source = textwrap.dedent(inspect.getsource(function))
    tree: Any = ast.parse(source).body[0]
    module = importlib.import_module(function.__module__)
    names = {a.arg for a in tree.args.args}
    found = Access()
    fields: set[int] = set()  # elements of structs of which a field is set: met on the way to it
    node: Any
    element: Any
    for node in ast.walk(tree):
        stored = isinstance(getattr(node, "ctx", None), ast.Store)
        if isinstance(node, ast.Attribute) and stored and _is_element(_owner(node), names):
            element = _owner(node)
            found.written.add(element.value.id)
            fields.add(id(element))
        elif _is_element(node, names) and id(node) not in fields:
            element = node.value
            (found.written if stored else found.read).add(element.id)
        elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Subscript):
            found.read.add(ast.unparse(node.target.value))
        elif isinstance(node, ast.Call):
            _follow(node, names, module, found)
    found.read &= names
    return found


def _owner(node: Any) -> Any:
    """What the fields `element.field.field` belong to."""
    return _owner(node.value) if isinstance(node, ast.Attribute) else node


def _is_element(node: Any, names: set[str]) -> bool:
    return isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id in names


def _follow(call: ast.Call, names: set[str], module: ModuleType, found: Access) -> None:
    """What a called function does to arrays that it is given whole, or to one line of them."""
    given = [(i, a.id) for i, a in enumerate(call.args) if isinstance(a, ast.Name) and a.id in names]
    if not given:
        return
    target: Any = _resolve(call.func, module)
    if not hasattr(target, "is_builtin"):
        return
    if target.is_builtin():
        for i, name in given:
            if target.key.startswith("atomic_") and i == 0:
                found.read.add(name)
                found.written.add(name)
        return
    theirs = _of_function(target)
    parameters = list(inspect.signature(target.func).parameters)
    for i, name in given:
        found.take(name, theirs, parameters[i])


def _of_function(function: Any) -> Access:
    snippet = getattr(function, "native_snippet", None)
    return _of_python(function.func) if snippet is None else _of_native(function)


@functools.cache
def _of_native(function: Any) -> Access:
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", function.native_snippet, flags=re.S)
    found = Access()
    for name in inspect.signature(function.func).parameters:
        for at in re.finditer(rf"\b{name}\.data\b", text):
            declared = re.search(r"([\w\s*]*?[*&]\s*(?:const\s+)?(?:__restrict\s+)?)(\w+)\s*=\s*$", text[: at.start()])
            after = text[at.end() :]
            if declared is None:
                declared = re.search(r"\*\s*(?:const\s+)?(?:__restrict\s+)?(\w+)\s*=\s*[^;={}]*$", text[: at.start()])
                pointer = declared.group(1) if declared and not re.match(r"\s*\[", after) else None
            else:
                pointer = declared.group(2)
            if pointer is not None:
                _uses(text, pointer, name, found)
            else:
                _element(after, name, found)
    return found


def _uses(text: str, pointer: str, name: str, found: Access) -> None:
    """Elements reached through a pointer, and pointers made of it."""
    for use in re.finditer(rf"(?<![\w.>])(\*\s*)?{pointer}\b(?!\s*=[^=])", text):
        after = text[use.end() :]
        if re.match(r"\s*\[", after):
            _element(after, name, found)
            continue
        made = re.search(r"\*\s*(?:const\s+)?(?:__restrict\s+)?(\w+)\s*=\s*[^;={}]*$", text[: use.start()])
        if made and made.group(1) != pointer:
            _uses(text, made.group(1), name, found)


def _element(after: str, name: str, found: Access) -> None:
    """An element `[...]` at the beginning of `after`: assigned, read, or both."""
    depth, end = 0, 0
    for letter in after:
        end += 1
        depth += {"[": 1, "]": -1}.get(letter, 0)
        if depth == 0 and letter == "]":
            break
    assigned = ASSIGNED.match(after[end:])
    if assigned is None or assigned.group(1):
        found.read.add(name)
    if assigned is not None:
        found.written.add(name)


def _resolve(node: ast.expr, module: ModuleType) -> Any:
    if isinstance(node, ast.Name):
        return getattr(module, node.id, None)
    if isinstance(node, ast.Attribute):
        owner = _resolve(node.value, module)
        return None if owner is None else getattr(owner, node.attr, None)
    return None
