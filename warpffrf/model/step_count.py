"""Number of steps of a run."""

from __future__ import annotations

from warpffrf.model.errors import MOST_COUNTED, InputError, require_number

SAME_TIME = 1e-9  # relative: times that differ by less count as equal


def step_count(duration: float, step: float) -> tuple[int, list[str]]:
    """Number of steps of `step` [s] in `duration` [s], and a note where that is no whole number. Raises
    `InputError`."""
    duration = require_number(duration, "simulate: duration", positive=True)
    step = require_number(step, "simulate: step", positive=True)
    if duration / step > MOST_COUNTED:
        raise InputError(
            f"simulate: {duration:g} s are {duration / step:.3g} steps of {step:g} s, more than can be counted"
        )
    steps = int(round(duration / step))
    if steps < 1:
        raise InputError(f"simulate: step {step:g} s is longer than the duration {duration:g} s")
    if abs(steps * step - duration) <= SAME_TIME * duration:
        return steps, []
    return steps, [
        f"the duration {duration:g} s is no multiple of the step: {steps} steps, {steps * step:g} s, are simulated"
    ]
