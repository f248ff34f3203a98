"""A pressed contact under a smooth load, local modes with inertia: treatment of the local modes x step."""

from __future__ import annotations

from functools import cache

import warpffrf as wf
from warpffrf.demos import two_rollers as rollers
from warpffrf.demos.speed_studies.study import Study, steps
from warpffrf.online.local_dynamics import EXACT_DAMPING, LocalDynamics
from warpffrf.study.speed_against_error.outcome import SpeedError

STEPS = [4e-5, 2e-5, 1e-5, 5e-6]  # s
RUN, LOAD_STEP = 0.012, 0.001  # s
HIGHEST = 60e3  # Hz, of the local modes that have inertia; global ones reach MAX_FREQUENCY
SIZE, QUICK_SIZE = rollers.Size(1200, layers=12, axial=2), rollers.Size(240, layers=5, axial=1)
TREATMENTS = [
    "quasi_static", LocalDynamics("exponential", max_frequency=HIGHEST), LocalDynamics("hht", max_frequency=HIGHEST),
]  # fmt: skip


@cache
def _roller(quick: bool) -> wf.ReducedBody:
    return rollers.roller_body(QUICK_SIZE if quick else SIZE, patch_grid=False, local_dynamics=True, progress=False)


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""
    body = _roller(quick)

    def pressed_rollers() -> wf.Scene:
        return rollers.machine(body, load_step_at=LOAD_STEP, speed=0.0)

    return wf.study.speed_error(
        pressed_rollers, RUN, step=STEPS[0], start="equilibrium", progress=progress, rounds=1,
        choices={"local": TREATMENTS, "step": STEPS[:-1] if quick else steps(STEPS, quick)},
        measures=["force", "displacement", "deformation", "energy"],
    )  # fmt: skip


LOCAL_TREATMENTS = Study(
    "local_treatments",
    "Inertia of local modes in a smooth phase",
    f"The two rollers with their axles held on a coarser mesh, started from equilibrium and loaded smoothly within "
    f"{rollers.LOAD_STEP_TAKES * 1e3:g} ms: nothing impacts. Local modes up to {HIGHEST / 1e3:g} kHz have inertia with "
    f"`exponential` (damped by {EXACT_DAMPING:.0%}) and `hht`, those above follow their load, as all do with "
    "`quasi_static`. Each treatment must be of order two in the step, towards its own limit: these limits differ by "
    "what the inertia of the local modes does, and errors against the reference, which has `hht`, end there. "
    "`exponential` steps exactly those modes of which a step is longer than half a period, the others by HHT.",
    make,
)
