"""Native functions declare pointers and numbers apart: so that `checked_run` can give them pointers that check."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import warpffrf_kernels

FOLDER = Path(warpffrf_kernels.__file__).parent
NATIVE = re.compile(r'func_native\("""(.*?)"""\)\ndef (\w+)', re.DOTALL)
SNIPPETS = {
    f"{path.stem}.{name}": re.sub(r"//[^\n]*", "", body)
    for path in sorted(FOLDER.rglob("*.py"))
    for body, name in NATIVE.findall(path.read_text())
}
DECLARATION = re.compile(r"\s*(?:const\s+)?(?:double|int|size_t)\b(?P<pointer>\s*\*)?(?P<rest>.*)", re.DOTALL)


def declarators(text: str) -> list[str]:
    """`a = 1, *b = f(x, y)` -> ["a = 1", " *b = f(x, y)"]."""
    found, depth = [""], 0
    for letter in text:
        depth += (letter in "([") - (letter in ")]")
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return found


@pytest.mark.parametrize("name", SNIPPETS)
def test_pointers_and_numbers_are_declared_apart(name: str) -> None:
    for statement in re.split(r"[;{}]", SNIPPETS[name]):
        declaration = DECLARATION.match(statement)
        if declaration:
            for other in declarators(declaration["rest"])[1:]:
                assert ("*" in other.split("=")[0]) == bool(declaration["pointer"]), statement
