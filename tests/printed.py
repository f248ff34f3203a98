"""What a page prints for its reader to run: blocks of Python between fences, and commands on indented lines.

One reading for the tests of the pages and for `wheel_blocks.py`, which runs them all from an installed wheel.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass

FENCE = re.compile(r"^```(?:python|py)\n(.*?)^```", re.MULTILINE | re.DOTALL)
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
    blocks = [(match, True) for match in FENCE.finditer(page)]
    commands = [(match, False) for match in COMMAND.finditer(page)]
    found = sorted(blocks + commands, key=lambda pair: pair[0].start())
    return [
        Printed(is_python, match[1] if is_python else _command(match[1]), page.count("\n", 0, match.start()) + 1)
        for match, is_python in found
    ]


def python_blocks(page: str) -> list[str]:
    """The blocks of Python of a page, in its order."""
    return [item.text for item in printed(page) if item.is_python]


def commands(page: str) -> list[Printed]:
    """The commands of a page, in its order."""
    return [item for item in printed(page) if not item.is_python]


def _command(text: str) -> str:
    """A command as one line; what stands two blanks behind it explains it."""
    return re.split("  +", re.sub(r" *\\\n *", " ", text).strip())[0]
