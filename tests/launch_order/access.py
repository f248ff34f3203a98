"""Which arrays a kernel reads and which it writes, from its source: Python and the C++ of native functions.

Followed through the functions that it calls. An array is read where an element of it stands in an expression, and
written where one is assigned; C++ reaches arrays through pointers, `double* q = y.data + at`, which are followed by
name. What a kernel reads of what it has just written counts as read; what it reads before it writes any of it, in the
order of the source, it changes. Arrays are named as they are declared where they are fields of a topic, `.dx`, and by
the parameter where they are given by themselves, `dx`.
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

from warpffrf.online.arrays.declaration import topic_of
from warpffrf.online.step.launches import DECLARED
from warpffrf_kernels.core.declaration import is_topic

ASSIGNED = re.compile(r"\s*(\+|-|\*|/)?=(?!=)")
READ, WRITTEN = True, False


@dataclass
class Access:
    """Arrays in the order in which they are met, and whether they are read there."""

    met: list[tuple[str, bool]] = field(default_factory=list)

    @property
    def read(self) -> set[str]:
        return {name for name, read in self.met if read}

    @property
    def written(self) -> set[str]:
        return {name for name, read in self.met if not read}

    @property
    def changed(self) -> set[str]:
        """What is written, and read before."""
        first = dict(reversed(self.met))
        return {name for name in self.written if first[name]}


def access_of(kernel: Any) -> Access:
    """Of the parameters of `kernel`."""
    return _of_python(kernel.func)


@functools.cache
def _of_python(function: Any) -> Access:
    source = textwrap.dedent(inspect.getsource(function))
    tree: Any = ast.parse(source).body[0]
    found = _Body(tree, inspect.get_annotations(function), importlib.import_module(function.__module__))
    for statement in tree.body:
        found.visit(statement)
    return found.access


def is_of_a_run(kind: Any) -> bool:
    """Whether it is a topic, and none of the model."""
    topic = topic_of(kind) or kind
    return is_topic(topic) and 0 < len(topic.declarations) and set(topic.declarations) <= set(DECLARED)


class _Body(ast.NodeVisitor):
    """The body of a function, in the order in which it is evaluated."""

    def __init__(self, tree: Any, annotations: dict[str, Any], module: ModuleType) -> None:
        self.module, self.access = module, Access()
        names = [argument.arg for argument in tree.args.args]
        self.topics = {name for name in names if is_of_a_run(annotations.get(name))}
        self.names = set(names) - self.topics

    def name(self, node: Any) -> str | None:
        """Of the array that an expression is, None where it is none."""
        if isinstance(node, ast.Name) and node.id in self.names:
            return node.id
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in self.topics:
            return f".{node.attr}"
        return None

    def visit_Assign(self, node: ast.Assign) -> None:
        self.visit(node.value)
        for target in node.targets:
            self.set(target)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self.visit(node.value)
        self.visit(node.target)
        self.set(node.target)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        self.generic_visit(node)
        name = self.name(node.value)
        if name is not None:
            self.access.met.append((name, READ))

    def visit_Call(self, node: ast.Call) -> None:
        """What a called function does to arrays and topics that it is given whole."""
        self.generic_visit(node)
        target: Any = _resolve(node.func, self.module)
        if not hasattr(target, "is_builtin"):
            return
        given = [self.name(argument) for argument in node.args]
        if target.is_builtin():
            if target.key.startswith("atomic_") and given[0] is not None:
                self.access.met += [(given[0], READ), (given[0], WRITTEN)]
            return
        own = dict(zip(inspect.signature(target.func).parameters, given, strict=False))
        for theirs, read in _of_function(target).met:
            name = theirs if theirs.startswith(".") else own.get(theirs)
            if name is not None:
                self.access.met.append((name, read))

    def set(self, target: Any) -> None:
        """An element, or a field of it, is assigned."""
        while isinstance(target, ast.Attribute):
            target = target.value
        if isinstance(target, ast.Subscript):
            self.visit(target.slice)
            name = self.name(target.value)
            if name is not None:
                self.access.met.append((name, WRITTEN))
        elif isinstance(target, ast.Tuple):
            for each in target.elts:
                self.set(each)


def _of_function(function: Any) -> Access:
    snippet = getattr(function, "native_snippet", None)
    return _of_python(function.func) if snippet is None else _of_native(function)


@functools.cache
def _of_native(function: Any) -> Access:
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", function.native_snippet, flags=re.S)
    found: list[tuple[int, str, bool]] = []
    for name in inspect.signature(function.func).parameters:
        for at in re.finditer(rf"\b{name}\.data\b", text):
            declared = re.search(r"([\w\s*]*?[*&]\s*(?:const\s+)?(?:__restrict\s+)?)(\w+)\s*=\s*$", text[: at.start()])
            if declared is None:
                declared = re.search(r"\*\s*(?:const\s+)?(?:__restrict\s+)?(\w+)\s*=\s*[^;={}]*$", text[: at.start()])
                pointer = declared.group(1) if declared and not re.match(r"\s*\[", text[at.end() :]) else None
            else:
                pointer = declared.group(2)
            if pointer is not None:
                _uses(text, pointer, name, found)
            else:
                _element(text, at.end(), name, found)
    return Access([(name, read) for _, name, read in sorted(found, key=lambda met: met[0])])


def _uses(text: str, pointer: str, name: str, found: list[tuple[int, str, bool]]) -> None:
    """Elements reached through a pointer, and pointers made of it."""
    for use in re.finditer(rf"(?<![\w.>])(\*\s*)?{pointer}\b(?!\s*=[^=])", text):
        if re.match(r"\s*\[", text[use.end() :]):
            _element(text, use.end(), name, found)
            continue
        made = re.search(r"\*\s*(?:const\s+)?(?:__restrict\s+)?(\w+)\s*=\s*[^;={}]*$", text[: use.start()])
        if made and made.group(1) != pointer:
            _uses(text, made.group(1), name, found)


def _element(text: str, begin: int, name: str, found: list[tuple[int, str, bool]]) -> None:
    """An element `[...]` that begins there: assigned, read, or both. What is assigned is met at the end of it."""
    depth, end = 0, begin
    for letter in text[begin:]:
        end += 1
        depth += {"[": 1, "]": -1}.get(letter, 0)
        if depth == 0 and letter == "]":
            break
    assigned = ASSIGNED.match(text[end:])
    if assigned is None or assigned.group(1):
        found.append((begin, name, READ))
    if assigned is not None:
        found.append((text.find(";", end), name, WRITTEN))


def _resolve(node: ast.expr, module: ModuleType) -> Any:
    if isinstance(node, ast.Name):
        return getattr(module, node.id, None)
    if isinstance(node, ast.Attribute):
        owner = _resolve(node.value, module)
        return None if owner is None else getattr(owner, node.attr, None)
    return None
