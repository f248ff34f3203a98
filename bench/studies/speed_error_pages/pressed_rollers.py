"""The two rollers without rolling: grid of the contact x step."""

from __future__ import annotations

from functools import partial

import warpffrf as wf
from demos import two_rollers as rollers
from studies.speed_error_pages.reduced import roller
from studies.speed_error_pages.study import Study
from studies.speed_error_pages.two_rollers import LOAD_STEP, RUN
from warpffrf.study.speed_against_error.outcome import SpeedError

STEPS = [4e-5, 2e-5, 1e-5, 5e-6]  # s, that resolve the vibration of the rollers on their contact


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""
    body = roller(quick)

    def pressed_rollers() -> wf.Scene:
        return rollers.machine(body, load_step_at=LOAD_STEP, speed=0.0)

    return wf.study.speed_error(
        pressed_rollers,
        partial(wf.simulate, duration=RUN, step=STEPS[0], start="equilibrium"),
        progress=progress,
        rounds=1,
        choices={"grid": ["body_fixed"], "step": STEPS[:-1] if quick else STEPS},
        measures=["force", "displacement", "energy"],
    )


PRESSED_ROLLERS = Study(
    "pressed_rollers",
    "The two rollers without rolling",
    "The machine of [the two rollers](two_rollers.md) on the body-fixed grid with its axles held: no node passes "
    "the contact. What the step must resolve is the vibration of the rollers on their contact that the load "
    "step leaves.",
    make,
)
