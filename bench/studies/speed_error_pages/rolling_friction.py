"""The rolling-friction demo: grid of the contact x step."""

from __future__ import annotations

from functools import cache, partial

import warpffrf as wf
from demos import rolling_friction as demo
from studies.speed_error_pages.study import Study, steps
from warpffrf.study.speed_against_error.outcome import SpeedError

STEPS = [1.6e-4, 8e-5, 4e-5, 2e-5]  # s
RUN, QUICK_RUN = 0.08, 0.004  # s: spin-up, rolling freely, the brake rises
GRIDS = {  # what friction and pressure stand on -> the meshes
    "nodes, 1000 around": demo.Size(sectors=1000),
    "nodes, 1500 around": demo.Size(sectors=1500),
    "patch of 9 x 7": demo.Size(78, layers=8, axial=3, patch=(9, 7)),
    "patch of 13 x 9": demo.BIG_CELLS,
}
QUICK_GRIDS = {
    "nodes, 300 around": demo.Size(300, layers=4, axial=1),
    "patch of 5 x 5": demo.Size(78, layers=5, axial=2, patch=(5, 5)),
}
REFERENCE, QUICK_REFERENCE = "patch of 19 x 9", "patch of 7 x 5"
FINEST = {
    REFERENCE: demo.Size(78, layers=8, axial=3, patch=(19, 9)),
    QUICK_REFERENCE: demo.Size(78, layers=5, axial=2, patch=(7, 5)),
}
AT_RIM = {name: [(demo.OUTER_RADIUS, 0.0, 0.0)] for name in ("lower", "flywheel")}  # m: what creep adds up to


@cache
def _scene(cells: str) -> wf.Scene:
    return demo.build({**GRIDS, **QUICK_GRIDS, **FINEST}[cells], progress=False)


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""

    def rolling_friction(cells: str) -> wf.Scene:
        return _scene(cells)

    grids = list(QUICK_GRIDS if quick else GRIDS)
    finest = QUICK_REFERENCE if quick else REFERENCE
    return wf.study.speed_error(
        rolling_friction,
        partial(wf.simulate, duration=QUICK_RUN if quick else RUN, step=STEPS[0], start="equilibrium"),
        progress=progress,
        rounds=1,
        parameters={"cells": finest},
        points=AT_RIM,
        choices={"cells": grids, "step": steps(STEPS, quick)},
        reference={"cells": finest},
    )


ROLLING_FRICTION = Study(
    "rolling_friction",
    "Rolling with friction",
    f"The machine of the rolling-friction demo over its first {RUN * 1e3:g} ms: one roller is driven up to speed "
    f"within {demo.SPIN_UP * 1e3:g} ms and carries the other along, they roll freely until "
    f"{demo.schedule().free * 1e3:.0f} ms, and then a brake rises to {demo.SHARES[0]:g} of what friction can give. "
    "`cells` are what pressures and tractions stand on: nodes and their cells on a fine mesh of quadratic cells, or "
    f"cells that travel with the patch on a mesh of 4 mm, strips across by rows along; the reference has a "
    f"{REFERENCE}. Displacement is that of points on the rims of the driven roller and of the flywheel, which creep "
    "sets apart.",
    make,
)
