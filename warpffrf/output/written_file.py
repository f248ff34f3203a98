"""A file written by a run: path, size, and write time."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from warpffrf.model.files.paths import size_text


@dataclass(frozen=True)
class Written:
    """A file of a run. `what`: "results" or "recording"; `size` [byte]; `seconds`: wall time of writing."""

    what: str
    path: Path
    size: int
    seconds: float

    @classmethod
    def of(cls, what: str, path: Path, seconds: float) -> Written:
        """The file at `path` with its current size."""
        return cls(what, path, path.stat().st_size, seconds)

    def __str__(self) -> str:
        return f"'{self.path}', {size_text(self.size)}, written in {self.seconds:.3g} s"
