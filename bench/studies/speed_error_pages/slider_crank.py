"""The slider-crank demo: integrator x inertia level of the rod x step."""

from __future__ import annotations

from functools import partial

import warpffrf as wf
from demos import slider_crank as crank
from studies.speed_error_pages.study import Study, steps
from warpffrf.model.integrators import HHT, GeneralizedAlpha
from warpffrf.study.speed_against_error.outcome import SpeedError

STEPS = [4e-4, 2e-4, 1e-4, 5e-5]  # s, about that of the demo
RUN = 0.12  # s: the spin-up and half a revolution at speed
ROUNDS = 2
INTEGRATORS = [HHT(alpha=-0.3), GeneralizedAlpha(rho_inf=0.5), GeneralizedAlpha(rho_inf=crank.RHO_INF)]


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""
    rod = crank.rod_body(crank.QUICK if quick else crank.FULL, progress=progress)

    def slider_crank() -> wf.Scene:
        return crank.machine(rod)

    return wf.study.speed_error(
        slider_crank, partial(wf.simulate, duration=RUN, step=crank.STEP), progress=progress, rounds=ROUNDS,
        points={"rod": [(0.0, 0.0, 0.5 * crank.SECTION)]},
        choices={"integrator": INTEGRATORS, "inertia": ["constant", "full"], "step": steps(STEPS, quick)},
    )  # fmt: skip


SLIDER_CRANK = Study(
    "slider_crank",
    "Slider-crank with an elastic rod",
    f"The machine of the slider-crank demo over {RUN * 1e3:g} ms: the spin-up, {crank.SPIN_UP * 1e3:g} ms, "
    "and half a revolution at speed. Deformation is that of the rod at midspan. The rod has its geometric stiffening "
    "in all runs; `inertia` is the level of its inertia terms.",
    make,
)
