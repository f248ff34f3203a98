"""Cache of the meshes and reduced bodies that scenes of one file have in common.

The scene of a file is rebuilt for every row of a sweep, and most rows change a load or a speed. A mesh or reduced body
is defined by its table, the tables of materials and meshes, and files. If none of these has changed, the same object is
returned: bodies are in memory once, and scenes that are worlds of one graph share them.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

from warpffrf.scene_file.source import Path

SECTIONS = ("meshes", "reduced_bodies")
MADE_OF = ("materials", *SECTIONS)  # sections that their tables refer to
MOST = 16  # objects: a sweep over meshes creates one per row

State = tuple[int, int]  # of a file: modification time and size


@dataclass(frozen=True)
class _Entry:
    thing: Any
    files: dict[Path, FilePath]
    states: dict[FilePath, State]


class Kept:
    """Cached objects, the least recently used first."""

    def __init__(self) -> None:
        self._entries: OrderedDict[str, _Entry] = OrderedDict()

    def find(self, recipe: str) -> tuple[Any, dict[Path, FilePath]] | None:
        """The object of a recipe and its input files; None if it is not cached or if a file has changed."""
        entry = self._entries.get(recipe)
        if entry is None or any(_state(file) != state for file, state in entry.states.items()):
            return None
        self._entries.move_to_end(recipe)
        return entry.thing, entry.files

    def keep(self, recipe: str, thing: Any, files: Mapping[Path, FilePath]) -> None:
        """Cache the object of a recipe that reads these files."""
        states = {file: state for file in files.values() if (state := _state(file)) is not None}
        if len(states) == len(set(files.values())):
            self._entries[recipe] = _Entry(thing, dict(files), states)
        while len(self._entries) > MOST:
            self._entries.popitem(last=False)


def _state(file: FilePath) -> State | None:
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size
