"""What a page prints for its reader to run: blocks of Python between fences, and commands on indented lines.

One reading for the tests of the pages and for `wheel_blocks.py`, which runs them all from an installed wheel.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass

FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
LANGUAGE = ("python", "py")
COMMAND = re.compile(r"^    (warpffrf (?:.*\\\n)*.*)$", re.MULTILINE)


@dataclass(frozen=True)
class Printed:
    """A block of Python, or a command in one line, of a page; line: where it begins there, from 1."""

    is_python: bool
    text: str
    line: int

    @property
    def words(self) -> list[str]:
        """The words of a command."""
        return shlex.split(self.text)


def printed(page: str) -> list[Printed]:
    """All that the text of a page prints to be run, in its order."""
    fences = list(FENCE.finditer(page))
    blocks = [(match.start(), True, match[2]) for match in fences if match[1] in LANGUAGE]
    lines = [
        (match.start(), False, _command(match[1]))
        for match in COMMAND.finditer(page)
        if not any(fence.start() < match.start() < fence.end() for fence in fences)
    ]
    return [Printed(is_python, text, page.count("\n", 0, at) + 1) for at, is_python, text in sorted(blocks + lines)]


def python_blocks(page: str) -> list[str]:
    """The blocks of Python of a page, in its order."""
    return [item.text for item in printed(page) if item.is_python]


def commands(page: str) -> list[Printed]:
    """The commands of a page, in its order."""
    return [item for item in printed(page) if not item.is_python]


def _command(text: str) -> str:
    """A command as one line; what stands two blanks behind it explains it."""
    return re.split("  +", re.sub(r" *\\\n *", " ", text).strip())[0]
