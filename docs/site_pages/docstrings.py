"""Docstrings of the package as reStructuredText.

A docstring is prose in which `name: text` or `name [unit], other: text` begins what is said of a parameter, indented
blocks are formulas, and words in backticks are names. Parameters become a definition list, formulas literal blocks.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Sequence
from typing import Any

LINK = re.compile(r"`[A-Za-z_][\w.]*`")


def paragraphs(lines: Sequence[str]) -> list[list[str]]:
    """Runs of lines without an empty one between them."""
    text = "\n".join(lines).strip("\n")
    return [block.splitlines() for block in re.split(r"\n\s*\n", text) if block.strip()]


def prose(text: str) -> str:
    """Names in backticks as links or code, all else as it stands."""
    parts = re.split(r"(``.+?``|`[^`]+`)", text, flags=re.DOTALL)
    for i, part in enumerate(parts):
        if i % 2 == 0:
            escaped = re.sub(r"([*|\\])|(?<=\w)(_)(?!\w)", lambda m: "\\" + m.group(0), part)
            parts[i] = "\\ " * (i > 0 and bool(re.match(r"\w", part))) + escaped  # a letter would keep a role open
        elif not LINK.fullmatch(part):
            parts[i] = f"``{part.strip('`')}``"
    return "".join(parts)


def definitions(text: str, parameters: set[str]) -> list[str]:
    """A paragraph; what it says of parameters as a definition list."""
    if not parameters:
        return [prose(text), ""]
    name = rf"(?:{'|'.join(sorted(map(re.escape, parameters), key=len, reverse=True))})(?: \[[^\]]*\]| \([\w, ]*\))*"
    begins = re.compile(rf"(?:^|(?<=[.;)] )|(?<=[.;)]\n))({name}(?:, {name})*): ")
    flat = re.sub(r"\s*\n\s*", " ", text) if begins.search(re.sub(r"\s*\n\s*", " ", text)) else text
    found = list(begins.finditer(flat))
    if not found:
        return [prose(text), ""]
    out = [prose(flat[: found[0].start()]), ""] if found[0].start() else []
    for one, after in zip(found, [*found[1:], None], strict=True):
        said = flat[one.end() : after.start() if after else None].strip()
        out += [f"{prose(one.group(1))}", f"    {prose(said)}", ""]
    return out


def converted(lines: Sequence[str], parameters: set[str]) -> list[str]:
    """The docstring `lines` as reStructuredText."""
    out: list[str] = []
    listed = False
    for block in paragraphs(lines):
        if len(block) > 1 and re.fullmatch(r"-{3,}", block[1].strip()):
            out += [f".. rubric:: {block[0].strip()}", ""]
            block, listed = block[2:], True
            if not block:
                continue
        if block[0].lstrip().startswith(">>>"):
            out += [*block, ""]
        elif all(line.startswith(" ") for line in block):
            out += ["::", "", *(f"    {line}" for line in block), ""]
        elif listed and re.match(r"[a-z_]\w*", block[0]) and any(line.startswith(" ") for line in block):
            entries = re.split(r"\n(?=\S)", "\n".join(block))
            for entry in entries:
                head, _, said = entry.partition(":")
                out += [prose(head), "    " + prose(re.sub(r"\s+", " ", said).strip()), ""]
        else:
            out += definitions("\n".join(block), parameters)
    return out


def parameters_of(thing: Any) -> set[str]:
    """Names of the arguments of a function or class."""
    if not callable(thing):
        return set()
    try:
        return {*inspect.signature(thing).parameters} - {"self", "args", "kwargs"}
    except (TypeError, ValueError):
        return set()


def convert(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Handler of autodoc-process-docstring."""
    lines[:] = converted(lines, parameters_of(thing))


def setup(app: Any) -> dict[str, Any]:
    app.connect("autodoc-process-docstring", convert)
    return {"parallel_read_safe": True}
