"""Whether two histories are the same, bit for bit."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

# words of a checkpoint that count rows of the device, which records every step of a `Simulation`, and those kept
OF_ROWS = ("saved", "every", "pending", "pending_solves")
NOT_COMPARED = ("scene", "counters", "options", "samples")  # seconds, and what a run was asked for


def unlike(a: Any, b: Any, where: str = "history") -> list[str]:
    """Where two histories, or parts of them, differ."""
    if isinstance(a, np.ndarray):
        if a.dtype.names and "attempt" in a.dtype.names and isinstance(b, np.ndarray):
            a, b = a.copy(), b.copy()  # whether the last attempt of all was one of this world
            a["attempt"], b["attempt"] = 0, 0
        same = isinstance(b, np.ndarray) and a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
        return [] if same else [where]
    if isinstance(a, dict):
        found = [] if a.keys() == b.keys() else [f"keys of {where}"]
        return found + [at for key in a.keys() & b.keys() for at in unlike(a[key], b[key], f"{where}[{key!r}]")]
    if isinstance(a, list | tuple):
        found = [] if len(a) == len(b) else [f"length of {where}"]
        pairs = enumerate(zip(a, b, strict=False))
        return found + [at for i, (x, y) in pairs for at in unlike(x, y, f"{where}[{i}]")]
    if is_dataclass(a):
        names = [f.name for f in fields(a) if f.name not in NOT_COMPARED]
        return [at for name in names for at in unlike(getattr(a, name), getattr(b, name), f"{where}.{name}")]
    return [] if a is b or a == b or (a != a and b != b) else [where]


def steps_alone(history: Any) -> Any:
    """The history without the counts of rows, and without checks of films, which are made on the states of a run: a run
    of `simulate` and one of a `Simulation` differ in these."""
    words = history.checkpoint["ctl"].copy()
    for name in OF_ROWS:
        words[name] = 0
    history.checkpoint["ctl"] = words
    history.film_checks = {}
    return history
