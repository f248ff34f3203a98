"""Every kernel takes constants first, then what it reads, then what it writes: seen from its source.

An array argument is written when it is assigned to by index, or handed to a function that writes it; functions are
followed until nothing changes, native snippets are read as C++. Structs (`Model`) and scalars cannot be written.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import warpffrf_kernels

FILES = sorted(Path(next(iter(warpffrf_kernels.__path__))).glob("*.py"))

NATIVE_WRITE = re.compile(
    r"(?<!const )(?:double|int)\*\s*(?:__restrict\s+)?\w+ = (\w+)\.data"  # a pointer that is not to constants
    r"|(\w+)\.data\[[^;]*?\]\s*[-+]?=(?!=)"
)


@dataclass
class Function:
    """A kernel, function or snippet: its array arguments in order, those it writes, and calls (name, arguments)."""

    name: str
    kind: str
    arguments: list[str]
    arrays: list[str]
    writes: set[str] = field(default_factory=set)
    calls: list[tuple[str, list[str | None]]] = field(default_factory=list)


def kind_of(node: ast.FunctionDef) -> tuple[str, str]:
    """ "kernel", "func" or "func_native" with its snippet."""
    for decorator in node.decorator_list:
        call = decorator.func if isinstance(decorator, ast.Call) else decorator
        if isinstance(call, ast.Attribute) and call.attr in ("kernel", "func", "func_native"):
            snippet = decorator.args[0] if isinstance(decorator, ast.Call) and decorator.args else None
            return call.attr, str(snippet.value) if isinstance(snippet, ast.Constant) else ""
    return "", ""


def name_of(node: ast.AST) -> str | None:
    return node.id if isinstance(node, ast.Name) else None


def parse(source: str) -> list[Function]:
    """All kernels and functions of a module."""
    found = []
    for node in ast.parse(source).body:
        if not isinstance(node, ast.FunctionDef):
            continue
        kind, snippet = kind_of(node)
        arguments = [a.arg for a in node.args.args]
        arrays = [a.arg for a in node.args.args if a.annotation and "array" in ast.unparse(a.annotation)]
        function = Function(node.name, kind, arguments, [a for a in arrays if a != "models"])
        if kind == "func_native":
            written = {name for pair in NATIVE_WRITE.findall(snippet) for name in pair if name}
            function.writes = written & set(arguments)
        for inner in ast.walk(node):
            targets = []
            if isinstance(inner, ast.Assign):
                targets = inner.targets
            elif isinstance(inner, ast.AugAssign):
                targets = [inner.target]
            for target in targets:
                base = name_of(target.value) if isinstance(target, ast.Subscript) else None
                if base in arrays:
                    function.writes.add(str(base))
            if isinstance(inner, ast.Call) and isinstance(inner.func, ast.Name):
                function.calls.append((inner.func.id, [name_of(a) for a in inner.args]))
            if isinstance(inner, ast.Call) and isinstance(inner.func, ast.Attribute) and "atomic" in inner.func.attr:
                function.writes |= {n for n in [name_of(inner.args[0])] if n in arrays}
        found.append(function)
    return found


def follow_calls(functions: list[Function]) -> None:
    """A caller writes what it hands to an argument that its callee writes."""
    by_name = {f.name: f for f in functions}
    changed = True
    while changed:
        changed = False
        for f in functions:
            for called, handed in f.calls:
                callee = by_name.get(called)
                if callee is None:
                    continue
                new = {
                    a for a, p in zip(handed, callee.arguments, strict=False) if p in callee.writes and a in f.arrays
                }
                if new - f.writes:
                    f.writes |= {str(a) for a in new}
                    changed = True


def out_of_order(function: Function) -> list[str]:
    """Arrays that are written although one that is only read follows."""
    read_last = max([i for i, a in enumerate(function.arrays) if a not in function.writes], default=0)
    return [a for a in function.arrays[:read_last] if a in function.writes]


def everything() -> list[Function]:
    functions = [f for path in FILES for f in parse(path.read_text())]
    follow_calls(functions)
    return functions


KERNELS = [f for f in everything() if f.kind == "kernel"]


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda f: f.name)
def test_inputs_stand_before_outputs(kernel: Function) -> None:
    assert not out_of_order(kernel), f"{kernel.name} writes {out_of_order(kernel)} before arrays that it only reads"
    assert kernel.arguments[0] == "models" or "models" not in kernel.arguments
    assert kernel.writes, f"{kernel.name} writes nothing"


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda f: f.name)
def test_no_argument_is_unused(kernel: Function) -> None:
    path = next(p for p in FILES if f"def {kernel.name}(" in p.read_text())
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.FunctionDef) and node.name == kernel.name:
            used = {n.id for statement in node.body for n in ast.walk(statement) if isinstance(n, ast.Name)}
            assert set(kernel.arguments) <= used


def test_the_check_can_fail() -> None:
    """A kernel in the wrong order is found, directly and through a function and a snippet."""
    source = '''
@wp.func_native("""double* q = y.data + at; q[0] = x.data[1]; z.data[0] = 1.0; const double* p = x.data;""")
def native(x: wp.array(dtype=real), y: wp.array(dtype=real), z: wp.array(dtype=real), at: int): ...
@wp.func
def through(a: wp.array(dtype=real), b: wp.array(dtype=real), c: wp.array(dtype=real)):
    native(a, b, c, 0)
@wp.kernel
def good(x: wp.array(dtype=real), y: wp.array(dtype=real)):
    y[0] = x[0]
@wp.kernel
def direct(y: wp.array(dtype=real), x: wp.array(dtype=real)):
    y[0] += x[0]
@wp.kernel
def indirect(y: wp.array(dtype=real), z: wp.array(dtype=real), x: wp.array(dtype=real)):
    through(x, y, z)
'''
    functions = parse(source)
    follow_calls(functions)
    found = {f.name: (sorted(f.writes), out_of_order(f)) for f in functions}
    assert found["native"][0] == ["y", "z"]
    assert found["good"] == (["y"], [])
    assert found["direct"] == (["y"], ["y"])
    assert found["indirect"] == (["y", "z"], ["y", "z"])


def test_kernels_and_writes_are_found() -> None:
    """What is known of some of them, so that the search itself is not empty."""
    by_name = {f.name: f for f in everything()}
    assert len(KERNELS) > 25
    assert by_name["couple"].writes == {"G", "scratch"} and by_name["axpy"].writes == {"y"}
    assert not by_name["dot"].writes
    assert by_name["weigh"].writes == {"ctl", "weak_gap", "area", "wrench", "stencil", "stencil_at"}
    assert {"right", "order", "work", "solution", "pressure", "z"} <= by_name["solve_pressures"].writes
