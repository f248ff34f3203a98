"""Joints and drives that the stages of a run release and hold again: rows and checkpoints.

All stages have the same rows, see `warpffrf.model.released`. The checkpoint at the end of each has how they hold,
`RELEASED` (joint rows,): AS_BUILT, LOOSE, or ELSEWHERE, where they stood.

A stage in time in which other rows hold than before begins with the accelerations and multipliers of the new rows, and
with velocities that satisfy them (`warpffrf.online.start.accelerations`): rows that begin to hold stop a motion as a
plastic impact does. With the velocities V, the mass matrix M, the Jacobian J of the rows and the rates s' of drives,

    V+ = V - M^-1 J^T (J M^-1 J^T)^-1 (J V - s'),

which differ from V least, in kinetic energy. Where no drive moves 1/2 (V - V+).M (V - V+) is lost; in general it is
1/2 V.M V - 1/2 V+.M V+, booked as damping.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.checks.redundancy import ConstraintRow, all_rows, find_redundancy
from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.pieces import FromInput
from warpffrf.online.checkpoint import RELEASED, time_of
from warpffrf.online.history.history import ENERGY_LINES
from warpffrf.online.start.accelerations import refine
from warpffrf_kernels.core import control as k

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene
    from warpffrf.online.engine import Engine

AS_BUILT, LOOSE, ELSEWHERE = 0, 1, 2
LOSS = 1e-9  # of the kinetic energy: larger losses are noted
VELOCITIES = ("v", "omega", "qd")
ACCELERATIONS = tuple(f"{name}_{kind}" for name in VELOCITIES for kind in ("rate", "alg")) + ("lam", "lam0")

Checkpoint = Mapping[str, np.ndarray]


def require_released(scene: Scene, names: Any, label: str) -> frozenset[str]:
    """Names of joints and drives of `scene`; raises `InputError`."""
    if isinstance(names, str) or not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
        raise InputError(f"{label}: released must be a list of names of joints and drives, got {names!r}")
    known = sorted(set().union(*(row.owners for row in all_rows(scene))))
    for name in names:
        if name not in known:
            raise unknown_name(f"{label}: released joint or drive", name, known)
    for drive in scene.drives:
        if {str(drive.name), str(drive.joint.name)} & set(names) and isinstance(drive.signal, FromInput):
            raise InputError(
                f"{label}: drive {drive.name!r} follows an Input, and cannot be released; give it the number, as "
                "stages keep the initial value of an Input"
            )
    return frozenset(names)


def with_common_rows(scene: Scene, staged: Sequence[Scene], labels: Sequence[str]) -> list[Scene]:
    """The scenes of stages of `scene`, each with the rows that hold in any of them. Raises `InputError` for a drive
    whose position would jump."""
    if not any(each.released.names for each in staged):
        return list(staged)
    away: set[str] = set()
    for each, label in zip(staged, labels, strict=True):
        for drive in scene.drives:
            owners = {str(drive.name), str(drive.joint.name)}
            if drive.quantity == "position" and owners & away and not owners & each.released.names:
                raise InputError(
                    f"{label}: drive {drive.name!r} prescribes a position and was released before: its joint would "
                    "jump there; let it stay released, or prescribe the velocity"
                )
        away |= each.released.names
    rows = frozenset().union(*(find_redundancy(each).holding for each in (scene, *staged)))
    found = [copy.copy(each) for each in staged]
    for each in found:
        each.released = replace(each.released, rows=rows)
    return found


def enter(checkpoint: Checkpoint, staged: Scene) -> None:
    """Tell the scene `staged` of a stage that begins from `checkpoint` where rows hold that did not before."""
    rows, holding = _rows(staged)
    before = _states(checkpoint, len(rows))
    after = _after(before, rows, holding)
    stretch, time = np.asarray(checkpoint["stretch"])[0], time_of(checkpoint)
    held_at = {
        row.key: float(stretch[n] - (row.drive.position()(time) if row.drive is not None else 0.0))
        for n, row in enumerate(rows)
        if after[n] == ELSEWHERE
    }
    staged.released = replace(staged.released, held_at=held_at)
    held_again = bool(np.any((before == LOOSE) & (after != LOOSE)))
    changed = not np.array_equal(before == LOOSE, after == LOOSE)
    staged.released = replace(staged.released, held_at=held_at, changed=changed, held_again=held_again)


def left(start: Checkpoint, checkpoint: Checkpoint, staged: Scene) -> dict[str, np.ndarray]:
    """The `checkpoint` at the end of a stage that began from `start`, with how its rows hold."""
    rows, holding = _rows(staged)
    return {**checkpoint, RELEASED: _after(_states(start, len(rows)), rows, holding)}


def _rows(staged: Scene) -> tuple[list[ConstraintRow], frozenset[Any]]:
    """The rows of all stages, in the order of the device, and the keys of those that hold in this one."""
    return [row for row in all_rows(staged) if row.key in staged.released.rows], find_redundancy(staged).holding


def _states(checkpoint: Checkpoint, rows: int) -> np.ndarray:
    return np.array(checkpoint.get(RELEASED, np.full(rows, AS_BUILT, dtype=np.int32)))


def _after(before: np.ndarray, rows: list[ConstraintRow], holding: frozenset[Any]) -> np.ndarray:
    holds = np.array([row.key in holding for row in rows], dtype=bool)
    return np.where(~holds, LOOSE, np.where(before == AS_BUILT, AS_BUILT, ELSEWHERE)).astype(np.int32)


def begin_changed(engine: Engine, step: float) -> None:
    """Begin a stage in time, in steps of `step` [s], in which other rows hold: `engine` has the state at the end of the
    previous one."""
    if not engine.scene.released.changed:
        return
    before = engine.checkpoint()
    engine.enter(k.START, engine.settings.start_fraction * step)
    found = refine(engine, before)
    new = engine.checkpoint()
    engine.resume(before | {name: new[name] for name in (*VELOCITIES, *ACCELERATIONS)})
    if not found:  # the first step finds them
        engine.control(restart=1)
    kinetic, damping = ENERGY_LINES.index("kinetic"), ENERGY_LINES.index("damping")
    lost = before["energy"][0, 0, kinetic] - new["energy"][0, 0, kinetic]
    energy = before["energy"].copy()
    energy[0, 0, [kinetic, damping]] += (-lost, lost)
    engine.state.energy.assign(energy)
    if engine.scene.released.held_again and abs(lost) > LOSS * abs(before["energy"][0, 0, kinetic]):
        engine.start_notes.append(
            f"joints or drives held again what moved, as a plastic impact does, which took {lost:.4g} J (ledger line "
            "damping)"
        )
