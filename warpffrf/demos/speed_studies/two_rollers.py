"""The two-roller demo: grid of the contact x inertia level x step."""

from __future__ import annotations

import numpy as np

import warpffrf as wf
from warpffrf.demos import two_rollers as rollers
from warpffrf.demos.speed_studies.reduced import roller
from warpffrf.demos.speed_studies.study import Study, steps
from warpffrf.study.speed_against_error.outcome import SpeedError

STEPS = [4e-4, 2e-4, 1e-4, 5e-5]  # s, about that of the demo
RUN, LOAD_STEP = 0.024, 0.008  # s: the load step falls into the spin-up, and both are over at the end
ROUNDS = 2
SURFACE_SPEED = rollers.SPEED * rollers.OUTER_RADIUS  # m/s
PITCH = 2.0 * np.pi * rollers.OUTER_RADIUS / rollers.QUICK.sectors  # m, of the hats


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""
    body = roller(quick)

    def two_rollers() -> wf.Scene:
        return rollers.machine(body, load_step_at=LOAD_STEP)

    return wf.study.speed_error(
        two_rollers, RUN, step=rollers.STEP, start="equilibrium", progress=progress, rounds=ROUNDS,
        choices={"grid": ["material", "patch"], "inertia": ["constant", "full"], "step": steps(STEPS, quick)},
    )  # fmt: skip


TWO_ROLLERS = Study(
    "two_rollers",
    "Two rollers",
    f"The machine of [the two-roller demo](../two_rollers.md), started from its equilibrium under "
    f"{rollers.LOAD / 1e3:g} kN, over {RUN * 1e3:g} ms: spun up in {rollers.SPIN_UP * 1e3:g} ms, and loaded "
    f"to {rollers.LOAD_AFTER / 1e3:g} kN between {LOAD_STEP * 1e3:g} and "
    f"{(LOAD_STEP + rollers.LOAD_STEP_TAKES) * 1e3:g} ms. `grid=material` puts pressures on hats of the FE "
    "mesh, whose compliance they have, `grid=patch` on cells that travel with the patch and have that of a "
    "half-space near the load; the reference has cells. Local modes are quasi-static: cells need that.\n\n"
    f"The rim runs at {SURFACE_SPEED:g} m/s, so that hats pass the contact at {SURFACE_SPEED / PITCH * 1e-3:.0f} "
    "kHz, which no step of this study resolves: forces on hats do not converge with these steps. Without rolling "
    "they do, [see there](pressed_rollers.md). Curves of the two inertia levels lie on each other where the level does "
    "not matter.",
    make,
)
