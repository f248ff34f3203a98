"""The state at the end of a monolithic run as plain arrays, so that a results file holds it, and back.

A run under way has more: the time it began at and the steps since, from which times of steps are counted; what it has
spent; how far the windows of pairs reach; and, of variant "modified", the factor that goes on over steps. With these
one that goes on gives the same numbers, bit for bit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.monolithic.core.linear import Dense
from warpffrf.monolithic.core.state import State
from warpffrf.monolithic.newton import System

MARK = "monolithic_"  # in front of every name: a checkpoint of the separated solver is none of these
COUNTS = MARK + "counts"  # steps, iterations, factorisations, whether the last step locked a length
BEGIN, REACH, FACTOR = MARK + "begin", MARK + "reach", MARK + "factor_"
FACTOR_PARTS = ("scale", "factor", "pivots")
# fields that files of before the law at nodes of true shapes, pretensions, oil films, and the mean of work, lack
YOUNGER = ("nodes", "lost", "locked", "film_nodes", "film_points", "film_step", "pulls", "lag")


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


@dataclass
class Progressed:
    """Where a run stands: the time [s] it began at, the steps done since, and whether the last one locked a length."""

    begin: float
    steps: int = 0
    locked: bool = False


def under_way(system: System, state: State, done: Progressed) -> dict[str, np.ndarray]:
    """The checkpoint of a run under way; nothing in it changes any more."""
    spent = system.counters
    found = to_arrays(state)
    found[BEGIN] = np.array(done.begin)
    found[COUNTS] = np.array([done.steps, spent.iterations, spent.factorisations, int(done.locked)])
    found[REACH] = np.array([pair.half for pair in system.pairs if not system.nodal], dtype=int)
    if system.variant == "modified" and isinstance(system.kept, Dense):
        found |= {FACTOR + part: getattr(system.kept, part).copy() for part in FACTOR_PARTS}
    return found


def goes_on(system: System, state: State, kept_for: tuple, checkpoint: Mapping[str, np.ndarray]) -> Progressed:
    """Bring system and state to where a checkpoint of `under_way` was taken; kept_for: step size and coefficients of
    the run. Raises `InputError` as `from_arrays`."""
    for name, value in vars(from_arrays(checkpoint)).items():
        setattr(state, name, value)
    steps, spent = (int(checkpoint[COUNTS][0]), system.counters)
    spent.steps, spent.iterations, spent.factorisations = (int(value) for value in checkpoint[COUNTS][:3])
    if not system.nodal:
        for pair, half in zip(system.pairs, checkpoint[REACH], strict=True):
            pair.half = int(half)
    if FACTOR + "factor" in checkpoint:
        system.kept, system.kept_for = Dense.of(*(checkpoint[FACTOR + part] for part in FACTOR_PARTS)), kept_for
    return Progressed(float(checkpoint[BEGIN]), steps, bool(np.any(checkpoint[COUNTS][3:])))
