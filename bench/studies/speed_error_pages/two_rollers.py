"""The two-roller demo: what pressures stand on x step."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

import warpffrf as wf
from demos import two_rollers as rollers
from studies.speed_error_pages.reduced import COARSE, roller
from studies.speed_error_pages.study import Study, steps
from warpffrf.model.contact import CELL_ERROR
from warpffrf.study.speed_against_error.outcome import SpeedError

STEPS = [4e-4, 2e-4, 1e-4, 5e-5]  # s, about that of the demo
RUN, LOAD_STEP = 0.024, 0.008  # s: the load step falls into the spin-up, and both are over at the end
ROUNDS = 2
SURFACE_SPEED = rollers.SPEED * rollers.OUTER_RADIUS  # m/s
PITCH = 2.0 * np.pi * rollers.OUTER_RADIUS / rollers.QUICK.sectors  # m, of the nodes


@dataclass(frozen=True)
class Grid:
    """What pressures stand on: `grid` of the contact, mesh of the rollers, error that its cells are chosen for or how
    many there are."""

    grid: str
    mesh: rollers.Size = rollers.QUICK
    error: float = CELL_ERROR
    cells: tuple[int, int] | None = None


GRIDS = {
    "nodes, 0.13 mm": Grid("body_fixed"),
    "nodes, 0.09 mm": Grid("body_fixed", rollers.Size(sectors=3600, layers=18, axial=4)),
    "7 x 9 cells, 4 mm mesh": Grid("contact_fixed", COARSE, cells=(7, 9)),
    "9 x 7 cells, 4 mm mesh": Grid("contact_fixed", COARSE, cells=(9, 7)),
    "cells to 0.5 %, 4 mm mesh": Grid("contact_fixed", COARSE),
    "cells to 0.2 %, 4 mm mesh": Grid("contact_fixed", COARSE, error=2e-3),
    "cells to 0.5 %, 0.13 mm mesh": Grid("contact_fixed"),
}
REFERENCE, FINEST = "cells to 0.1 %, 0.13 mm mesh", Grid("contact_fixed", error=1e-3)
QUICK_GRIDS = list(GRIDS)[::3]


def make(quick: bool, *, progress: bool = True) -> SpeedError:
    """Run it."""

    def two_rollers(cells: str) -> wf.Scene:
        chosen = {**GRIDS, REFERENCE: FINEST}[cells]
        scene = rollers.machine(roller(quick, chosen.mesh), load_step_at=LOAD_STEP)
        (contact,) = scene.contacts
        contact.cell_error, contact.cells = chosen.error, chosen.cells
        contact.grid = chosen.grid
        return scene

    return wf.study.speed_error(
        two_rollers,
        partial(wf.simulate, duration=RUN, step=rollers.STEP, start="equilibrium"),
        progress=progress,
        rounds=ROUNDS,
        parameters={"cells": REFERENCE},
        reference={"cells": REFERENCE},
        choices={"cells": QUICK_GRIDS if quick else list(GRIDS), "step": steps(STEPS, quick)},
    )


TWO_ROLLERS = Study(
    "two_rollers",
    "Two rollers",
    f"The machine of [the two-roller demo](../two_rollers.md), started from its equilibrium under "
    f"{rollers.LOAD / 1e3:g} kN, over {RUN * 1e3:g} ms: spun up in {rollers.SPIN_UP * 1e3:g} ms, and loaded "
    f"to {rollers.LOAD_AFTER / 1e3:g} kN between {LOAD_STEP * 1e3:g} and "
    f"{(LOAD_STEP + rollers.LOAD_STEP_TAKES) * 1e3:g} ms. `cells` are what pressures stand on: nodes of an FE mesh "
    f"with "
    "elements of that size at the rim, whose compliance they have, or cells that travel with the patch and have that "
    "of a half-space near the load, over the same mesh or over one of 4 mm. Cells are as many as are given, strips "
    "across by rows along, or as many as the program takes for an error of force and largest pressure of so many "
    "percent. Local modes are quasi-static: cells need that.\n\n"
    f"The rim runs at {SURFACE_SPEED:g} m/s, so that nodes of {PITCH * 1e3:.2g} mm pass the contact at "
    f"{SURFACE_SPEED / PITCH * 1e-3:.0f} kHz, which no step of this study resolves: forces on nodes do not converge "
    "with these steps. Without rolling they do, [see there](pressed_rollers.md).",
    make,
)
