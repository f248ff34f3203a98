"""The state at the end of a monolithic run as plain arrays, so that a results file holds it, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.monolithic.core.state import State

MARK = "monolithic_"  # in front of every name: a checkpoint of the separated solver is none of these
YOUNGER = ("nodes", "lost")  # fields that files of before the law at nodes of true shapes lack


def to_arrays(state: State) -> dict[str, np.ndarray]:
    """Name -> array of every field of `state`; pressures as rows (pair, number, value)."""
    found = {
        MARK + f.name: np.array(getattr(state, f.name), dtype=np.float64) for f in fields(state) if f.name != "active"
    }
    rows = [(pair, number, value) for pair, of in enumerate(state.active) for number, value in of.items()]
    found[MARK + "active"] = np.array(rows, dtype=np.float64).reshape(-1, 3)
    found[MARK + "pairs"] = np.array(len(state.active))
    return found


def is_monolithic(checkpoint: Mapping[str, np.ndarray]) -> bool:
    """Whether the checkpoint was written by `to_arrays`."""
    return MARK + "time" in checkpoint


def time_of(checkpoint: Mapping[str, np.ndarray]) -> float:
    """The time [s] of a monolithic checkpoint."""
    return float(np.asarray(checkpoint[MARK + "time"]))


def from_arrays(checkpoint: Mapping[str, np.ndarray]) -> State:
    """The state of a checkpoint of `to_arrays`. Raises `InputError` for one that lacks arrays or holds NaN."""
    names = [f.name for f in fields(State) if f.name != "active"]
    younger = [name for name in YOUNGER if MARK + name not in checkpoint]
    names = [name for name in names if name not in younger]
    missing = [name for name in (*names, "active", "pairs") if MARK + name not in checkpoint]
    if missing:
        raise InputError(f"simulate: the checkpoint lacks {', '.join(missing)}; run it again, or start from 'initial'")
    values = {name: np.array(checkpoint[MARK + name], dtype=np.float64) for name in names}
    rows = np.asarray(checkpoint[MARK + "active"], dtype=np.float64)
    for name, array in {**values, "active": rows}.items():
        if not np.all(np.isfinite(array)):
            raise InputError(f"simulate: {name} of the checkpoint holds NaN or infinite numbers: it is damaged")
    active: list[dict[int, float]] = [{} for _ in range(int(checkpoint[MARK + "pairs"]))]
    for pair, number, value in rows:
        active[int(pair)][int(number)] = float(value)
    time = float(values.pop("time"))
    return State(time=time, active=active, **values)
