"""A bearing of six rollers between flexible rings, run up under load: what pressures stand on x step."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial

import warpffrf as wf
from scenes import bearing as scenes
from studies.speed_error_pages.study import Study
from warpffrf.study.speed_against_error.outcome import SpeedError

ROLLERS = scenes.Bearing(6)
STEPS = [2e-4, 1e-4, 5e-5]  # s
RUN, RAMP, QUICK_RUN = 0.006, 0.003, 0.0008  # s: run-up, and as long at speed


@dataclass(frozen=True)
class Cells:
    """Rings meshed for a contact of `half_width` [m], in linear cells of half of it, and the `grid` of all contacts;
    `error` of the cells of a patch."""

    half_width: float
    grid: str
    error: float = 0.02


CELLS = {
    "nodes, 0.2 mm": Cells(4e-4, "body_fixed"),
    "nodes, 0.1 mm": Cells(2e-4, "body_fixed"),
    "nodes, 0.05 mm": Cells(1e-4, "body_fixed"),
    "patch to 2 %, 0.2 mm": Cells(4e-4, "contact_fixed"),
}
REFERENCE, REFERENCE_CELLS = "patch to 0.5 %, 0.2 mm", Cells(4e-4, "contact_fixed", 0.005)
QUICK_CELLS = {"nodes, 0.5 mm": Cells(1e-3, "body_fixed"), "nodes, 0.4 mm": Cells(8e-4, "body_fixed")}
QUICK_REFERENCE, QUICK_REFERENCE_CELLS = "nodes, 0.3 mm", Cells(6e-4, "body_fixed")


@cache
def _rings(half_width: float) -> tuple[wf.ReducedBody, wf.ReducedBody]:
    patch = any(cells.grid == "contact_fixed" and cells.half_width == half_width for cells in CELLS.values())
    return scenes.rings(ROLLERS, half_width, contact_fixed=patch)


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it; quick: without contact-fixed cells, whose checks alone take seconds."""
    finest = QUICK_REFERENCE if quick else REFERENCE
    known = {**CELLS, **QUICK_CELLS, REFERENCE: REFERENCE_CELLS, QUICK_REFERENCE: QUICK_REFERENCE_CELLS}

    def bearing(cells: str) -> wf.Scene:
        chosen = known[cells]
        scene = scenes.run_up(ROLLERS, _rings(chosen.half_width), RAMP)
        for contact in scene.contacts:
            contact.cell_error = chosen.error
            contact.grid = chosen.grid
        return scene

    return wf.study.speed_error(
        bearing,
        partial(wf.simulate, duration=QUICK_RUN if quick else RUN, step=STEPS[0], start="equilibrium"),
        progress=progress,
        rounds=1,
        parameters={"cells": finest},
        reference={"cells": finest},
        choices={"cells": list(QUICK_CELLS if quick else CELLS), "step": STEPS[:2] if quick else STEPS},
    )


BEARING = Study(
    "bearing",
    "A bearing of six rollers",
    f"A roller bearing with {ROLLERS.count} rollers of {2e3 * ROLLERS.radius:g} mm, its shaft and cage driven "
    f"from rest to {scenes.SPEED:.0f} rad/s of the shaft in {RAMP * 1e3:g} ms and held there as long, under "
    f"{scenes.LOAD / 1e3:g} kN; twelve contacts on two flexible rings, rollers are rigid. `cells` are what pressures "
    "stand on: nodes of rings in linear cells of that size, or cells that travel with the patch, chosen for an error "
    "of so many percent. Contacts are about 0.13 mm wide to each side, where they are loaded most. The mesh of the "
    f"reference, {REFERENCE}, is the coarse one: what it leaves out of the rings is not in these errors. "
    "The rollers weigh 7 g between contacts of some 1e9 N/m: by that estimate they vibrate at about 80 kHz, which no "
    "step of this study resolves, and an order in the step is not to be expected.",
    make,
)
