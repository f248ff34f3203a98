"""Force at a given approach under refinement of the mesh in all three directions.

Level by level every count doubles while the layers' grading keeps the same map of the wall (growth g becomes sqrt(g)),
so that the meshes are nested. The force is the mean over phases of the grid, which removes the ripple. Compliance
is an energy: linear elements promise an error of order h^2; quadratic ones h^4 for a smooth solution, but the
pressure ends in
a square root at the edge of the patch, which limits any uniform refinement to between h^2 and h^3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.rollers import PAIR, Path, roller_body, solve_path
from studies.contact.ripple import element_size
from warpffrf.online import Settings

WIDE = Settings(window_strain=0.3)  # the coarse levels are pressed far beyond a Hertz pressure of 0.035 E*
COARSEST = {1: (90, 4, 2, 2.0), 2: (45, 2, 1, 4.0)}  # sectors, layers, axial, grading by order: equal node spacing


@dataclass(frozen=True)
class Level:
    """One mesh of the sequence."""

    order: int
    sectors: int
    dofs: int
    elements: float  # Hertz half-width over element
    force: float  # N, mean over the phases
    ripple: float  # peak to peak over mean


def refine(order: int, levels: int, *, approach: float = 800e-6, phases: int = 8, cache: bool = True) -> list[Level]:
    """`levels` nested meshes of two equal rollers of element order 1 or 2 at the same approach [m]."""
    found = []
    for level in range(levels):
        sectors, layers, axial, grading = COARSEST[order]
        f = 2**level
        body = roller_body(
            sectors * f, layers=layers * f, axial=axial * f, grading=grading ** (1.0 / f), order=order, cache=cache
        )
        size = element_size(body)
        turn = size / body.contact_surfaces["rim"].shape.radius * np.arange(phases) / phases
        contact = solve_path(body, body, Path.of(np.full(phases, approach), turn, -turn), settings=WIDE).contact(PAIR)
        F = contact.force_magnitude
        found.append(
            Level(
                order, sectors * f, int(body.report["dofs"]), contact.hertz(0).half_width / size,
                float(F.mean()), float(np.ptp(F) / F.mean()),
            )
        )  # fmt: skip
    return found


def rates(levels: list[Level]) -> np.ndarray:
    """Observed order from three levels at a time: log2 of the ratio of successive differences of the force."""
    d = np.diff([level.force for level in levels])
    return np.log2(d[:-1] / d[1:])
