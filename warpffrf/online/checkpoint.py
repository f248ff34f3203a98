"""Restart of a run from a checkpoint.

A checkpoint (`Engine.checkpoint`) is the complete device state: positions, rates, algorithmic accelerations,
multipliers, active sets, pressures, the ledger, the clock and the control words; of cells that travel with the patch
the last change of their pressures, from which the next ones are predicted, and their compliances and factors, which
are reused from step to step while they are accurate. Everything else in a step is either constant (compiled from the
scene) or recomputed at the start of every step, so a run continued from a checkpoint with the same step and the same
options gives the same numbers, bit for bit, as an uninterrupted one. Tableaus of small-sliding contacts are not
included: their size is that of all cells squared, and they are recomputed from the cells' forces, so that such a run
continues to round-off of their solve, 1e-11 of the largest force per step. If the kept data do not fit, compliances are
recomputed, and the numbers are equal to the tolerance of the iteration.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online.arrays.declaration import numbers_of
from warpffrf.online.engine import OFF_END, Engine
from warpffrf_kernels.core import control as k

RELEASED = "released"  # of a checkpoint: how its joint rows hold, see `warpffrf.online.released`
SAME_STEP = 1e-9  # relative: steps that differ by less are considered equal


def is_dynamic(checkpoint: Mapping[str, np.ndarray]) -> bool:
    """Whether the checkpoint is of a run in time; False: of a static state, where velocities are still to be set."""
    words = checkpoint.get("ctl")
    return words is None or bool(np.all(np.asarray(words)["mode"] == int(k.DYNAMIC)))


def is_loaded(checkpoint: Mapping[str, np.ndarray]) -> bool:
    """Whether the checkpoint is that of a static run, an equilibrium with a history."""
    words = checkpoint.get("ctl")
    return words is not None and bool(np.all(np.asarray(words)["mode"] == int(k.LOADING)))


def time_of(checkpoint: Mapping[str, np.ndarray]) -> float:
    """The time [s] at which a checkpoint was taken; 0 if it does not contain the time (it is refused elsewhere)."""
    clock = np.asarray(checkpoint.get("clk", np.zeros(0)))
    return float(clock["time"][0]) if "time" in (clock.dtype.names or ()) else 0.0


def turned_of(checkpoint: Mapping[str, np.ndarray] | None, scene: Scene) -> np.ndarray:
    """The largest angular speed of each body [rad/s] up to a checkpoint; empty if it does not contain it, or is of
    another scene (it is refused elsewhere)."""
    found = np.asarray((checkpoint or {}).get("turned", np.zeros((1, 0))))
    return found[0] if found.shape == (1, len(scene.bodies)) and np.all(np.isfinite(found)) else np.zeros(0)


def off_end_of(checkpoint: Mapping[str, np.ndarray] | None) -> bool:
    """Whether cells covered patches of crowns that run off an end."""
    return bool(np.any((checkpoint or {}).get(OFF_END, False)))


def check_checkpoint(present: Mapping[str, np.ndarray], checkpoint: Mapping[str, np.ndarray], label: str) -> None:
    """Raises `InputError`, which begins with `label`, unless `checkpoint` holds the arrays of `present`, names, shapes
    and types, and finite numbers in all of them."""
    if not checkpoint:
        raise InputError(f"{label}: there is no checkpoint to continue from; run it again")
    cure = "continue with the scene and the version of warpffrf that wrote it, or start from 'initial'"
    missing = sorted(set(present) - set(checkpoint))
    if "v_rate" in missing and "omega" in checkpoint:
        raise InputError(
            f"{label}: the checkpoint is that of RungeKutta4 or EnergyMomentum, which leave no accelerations; go on "
            "with one of these, or start from 'initial'"
        )
    if missing:
        raise InputError(f"{label}: the checkpoint lacks {', '.join(missing)}; {cure}")
    modes = [np.shape(arrays["q"])[-1] for arrays in (checkpoint, present)]
    if modes[0] != modes[1] and np.shape(checkpoint["r"]) == present["r"].shape:
        raise InputError(
            f"{label}: the checkpoint has {modes[0]} modal coordinates, here are {modes[1]}: the local modes were "
            "treated in another way; use the same local_modes= for both, or start from 'initial' or 'equilibrium'"
        )
    for name, array in present.items():
        given = np.asarray(checkpoint[name])
        if given.shape != array.shape or given.dtype != array.dtype:
            raise InputError(
                f"{label}: {name} of the checkpoint is {given.dtype}{given.shape}, this scene has "
                f"{array.dtype}{array.shape}: another scene or device; {cure}"
            )
    for name in present:
        if not np.all(np.isfinite(numbers_of(checkpoint[name]))):
            raise InputError(f"{label}: {name} of the checkpoint holds NaN or infinite numbers: it is damaged; {cure}")


def restore(engine: Engine, checkpoint: Mapping[str, np.ndarray], step: float, label: str = "simulate: start") -> int:
    """Set `engine` to the state of `checkpoint`, ready for steps of `step` [s]; returns the user steps done so far.

    Another step than the checkpoint's begins a new count of steps at the checkpoint's time. Raises `InputError` for a
    checkpoint of another scene, with `label` in front.
    """
    if np.any(checkpoint.get(RELEASED, 0)) and not engine.scene.released.rows:
        raise InputError(
            f"{label}: it ends with joints or drives that are released, or hold where they stood since; go on with "
            "stages that say which are released, Stage(..., overrides={'released': [names]})"
        )
    check_checkpoint(engine.state.to_numpy(), checkpoint, label)
    engine.resume(checkpoint)
    engine.drained = engine.word("saved")
    if np.any(engine.word("status") & int(k.GAIN)):  # the energy created until there does not end the run again
        engine.clock(least=engine.state.made.numpy().sum(axis=1))
    engine.control(
        status=0, reason=0, again=0, gaining_steps=0
    )  # an attempt that was to be repeated is repeated from here
    if np.isclose(engine.word("user_step")[0], step, rtol=SAME_STEP):
        return int(engine.word("step")[0])
    # time is counted in steps from START_TIME: begin a new count here
    engine.clock(start_time=float(engine.word("time")[0]), user_step=step)
    engine.control(step=0, sub=0, level=0)
    return 0
