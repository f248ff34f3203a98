"""The two rollers rolling on contact-fixed cells, in steps that resolve their vibration on the contact."""

from __future__ import annotations

from functools import partial

import warpffrf as wf
from demos import two_rollers as rollers
from studies.speed_error_pages.pressed_rollers import STEPS
from studies.speed_error_pages.reduced import roller
from studies.speed_error_pages.study import Study
from warpffrf.study.speed_against_error.outcome import SpeedError

RUN, LOAD_STEP = 0.006, 0.0  # s: the first half of the load step, where cells widen fastest


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""
    body = roller(quick)

    def rolling_cells() -> wf.Scene:
        return rollers.machine(body, load_step_at=LOAD_STEP)

    return wf.study.speed_error(
        rolling_cells,
        partial(wf.simulate, duration=RUN, step=STEPS[0], start="equilibrium"),
        progress=progress,
        rounds=1,
        choices={"grid": ["contact_fixed"], "step": STEPS[:-1] if quick else STEPS},
    )


ROLLING_CELLS = Study(
    "rolling_cells",
    "The two rollers on cells, in fine steps",
    "The machine of [the two rollers](two_rollers.md) on cells that travel with the patch, spun up while the load "
    "rises. In the steps of that study errors of the force are round about 1e-5 and of no order: what is left then is "
    f"the vibration of the rollers on their contact, of 0.3 ms, which steps of {STEPS[0]:g} s and less resolve.\n\n"
    "The force is of order two here. Where bodies are, and pressures, are of order one, and their errors small: cells "
    "have the width that the pressures at the begin of a step ask for [`patch.place`], which is late by a step, and "
    "the cells' own error depends on it. A width extrapolated to the end of the step makes all of it of order two, and "
    "is not taken: in [the bearing](bearing.md) it made runs of neighbouring steps differ by far more than now.",
    make,
)
