"""Which line of a scene file a refusal speaks of.

What a call refuses is told in its own words; the line is found by the name in them that the file wrote, or the key.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.scene_file.source import Path, Place, Source


class Refused(InputError):
    """An error whose message begins with its place already."""


def refused_place(source: Source, path: Path, table: Any, message: str) -> Place:
    """The place of what the message speaks of in the table at `path`: the first name in quotes that is a key or a
    text there, or else the longest key that is a word of it, or else the table."""
    quoted, named = len(message), ""
    found = worded = path
    for below, words in _words(table, path):
        for word in words:
            quote = re.search(rf"{re.escape(repr(word))}(?!:)", message)  # 'name': is the subject itself
            at = quote.start() if quote else quoted
            if at < quoted:
                quoted, found = at, below
        key = str(below[-1])
        if len(key) > len(named) and re.search(rf"(?<![\w.'\"]){re.escape(key)}(?![\w'\"])", message):
            named, worded = key, below
    return source.place(found if quoted < len(message) else worded)


def _words(value: Any, path: Path) -> Iterator[tuple[Path, list[str]]]:
    """Every path below `path` with its key and its text."""
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in entries:
        yield (*path, key), [word for word in (key, entry) if isinstance(word, str)]
        yield from _words(entry, (*path, key))
