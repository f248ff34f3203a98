"""A bearing of six rollers between flexible rings, run up under load: mesh of the rings x grid x step."""

from __future__ import annotations

from functools import cache

import warpffrf as wf
from warpffrf.demos.speed_studies.study import Study, steps
from warpffrf.study.speed_against_error.outcome import SpeedError
from warpffrf.verification.scenes import bearing as scenes

BEARING_OF = scenes.Bearing(6)
STEPS = [2e-4, 1e-4, 5e-5, 2.5e-5]  # s
RUN, RAMP, QUICK_RUN = 0.02, 0.01, 0.002  # s: run-up, and as long at speed
HALF_WIDTHS, QUICK_HALF_WIDTHS = [4e-4, 2e-4], [1e-3, 8e-4]  # m, for which the rings are meshed
ROUNDS = 1

_rings = cache(scenes.rings)


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""

    def bearing(half_width: float) -> wf.Scene:
        return scenes.run_up(BEARING_OF, _rings(BEARING_OF, half_width, patch_grid=True), RAMP)

    meshes = QUICK_HALF_WIDTHS if quick else HALF_WIDTHS
    return wf.study.speed_error(
        bearing, QUICK_RUN if quick else RUN, step=STEPS[0], start="equilibrium", progress=progress, rounds=ROUNDS,
        parameters={"half_width": meshes[-1]},
        choices={"grid": ["material", "patch"], "half_width": meshes, "step": steps(STEPS, quick)},
    )  # fmt: skip


BEARING = Study(
    "bearing",
    "A bearing of six rollers",
    f"A roller bearing with {BEARING_OF.count} rollers of {2e3 * BEARING_OF.radius:g} mm, its shaft and cage driven "
    f"from rest to {scenes.SPEED:.0f} rad/s of the shaft in {RAMP * 1e3:g} ms, under {scenes.LOAD / 1e3:g} kN; twelve "
    "contacts on two flexible rings, rollers are rigid. `half_width` [m] is that for which the rings are meshed, in "
    "linear cells of half of it; contacts are about 0.13 mm wide to each side. `grid=material` needs such cells, "
    "`grid=patch` has cells of its own; the reference has these.",
    make,
)
