"""A pressed contact under a smooth load, local modes with inertia: treatment of the local modes x step."""

from __future__ import annotations

from functools import cache, partial

import warpffrf as wf
from demos import two_rollers as rollers
from scenes.rollers import guided_pair
from studies.speed_error_pages.study import Study
from warpffrf.online.local_modes import EXACT_DAMPING, LocalModes
from warpffrf.study.speed_against_error.outcome import SpeedError

STEPS = [2e-4, 1e-4, 5e-5, 2.5e-5]  # s, half a period of 20 kHz and more: `exponential` steps all local modes exactly
RUN = 0.016  # s
LOAD, LOAD_AFTER, DELAY, TAKES = 20e3, 26e3, 0.002, 0.01  # N, N, s, s
CARRIAGE_MASS = 500.0  # kg: it swings on the contact with a period of 3 ms, which all steps resolve
HIGHEST = 60e3  # Hz, of the local modes that have inertia; the global ones reach rollers.MAX_FREQUENCY
SIZE, QUICK_SIZE = rollers.Size(1200, layers=12, axial=2), rollers.Size(240, layers=5, axial=1)
TREATMENTS = [
    "quasi_static", LocalModes("exponential", max_frequency=HIGHEST), LocalModes("hht", max_frequency=HIGHEST),
]  # fmt: skip


@cache
def _roller(quick: bool) -> wf.ReducedBody:
    return rollers.roller_body(QUICK_SIZE if quick else SIZE, contact_fixed=False, local_dynamics=True, progress=False)


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""
    body = _roller(quick)

    def local_treatments() -> wf.Scene:
        load = wf.signals.SmoothStep(LOAD, LOAD_AFTER, duration=TAKES, delay=DELAY)
        return guided_pair(body, body, load=load, speed=0.0, carriage_mass=CARRIAGE_MASS)

    return wf.study.speed_error(
        local_treatments,
        partial(wf.simulate, duration=RUN, step=STEPS[0], start="equilibrium"),
        progress=progress,
        rounds=1,
        choices={"local_modes": TREATMENTS, "step": STEPS[1:] if quick else STEPS},
        measures=["force", "displacement", "deformation", "energy"],
    )


LOCAL_TREATMENTS = Study(
    "local_treatments",
    "Inertia of local modes in a smooth phase",
    f"Two rollers of the demo on a coarser mesh, their axles held, the upper one in a carriage of {CARRIAGE_MASS:g} "
    f"kg, started from equilibrium under {LOAD / 1e3:g} kN and loaded to {LOAD_AFTER / 1e3:g} kN smoothly within "
    f"{TAKES * 1e3:g} ms: nothing impacts. Local modes up to {HIGHEST / 1e3:g} kHz have inertia with `exponential` "
    f"(damped by {EXACT_DAMPING:.0%}) and `hht`, those above follow their load, as all do with `quasi_static`. Steps "
    "are longer than half a period of all local modes, so that `exponential` steps them exactly for a linear load "
    "(shorter ones would take HHT for modes that they resolve). Each treatment must be of order two, towards its own "
    "limit.",
    make,
)
