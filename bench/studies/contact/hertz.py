"""The mid-plane of a pressed pair against Hertz's line contact, over the phases of the contact grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.rollers import PAIR, Path, solve_path
from studies.contact.ripple import SENSES, approach_for, element_size, window_for
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.output.result import Result


@dataclass(frozen=True, eq=False)
class HertzErrors:
    """Relative errors at mid-width against Hertz for the line load found there, one entry a state."""

    elements: np.ndarray  # Hertz half-width over element
    half_width: np.ndarray  # twice the root of the second moment of the pressure
    peak: np.ndarray  # as results report it at mid-width
    nodal_peak: np.ndarray  # largest node

    def worst(self) -> tuple[float, float]:
        """Largest error of half-width and of peak."""
        return float(np.abs(self.half_width).max()), float(np.abs(self.peak).max())


def hertz_errors(result: Result, size: float) -> HertzErrors:
    """Errors of every row of `result`; size [m] of an element."""
    c = result.contact(PAIR)
    exact = [c.hertz(i) for i in range(len(c.force))]
    a = np.array([e.half_width for e in exact])
    p0 = np.array([e.peak_pressure for e in exact])
    nodal = c.mid_pressure.max(axis=1)
    return HertzErrors(a / size, c.half_width / a - 1.0, c.mid_peak_pressure / p0 - 1.0, nodal / p0 - 1.0)


def hertz_phases(body: ReducedBody, elements: float, *, phases: int = 8) -> dict[str, HertzErrors]:
    """Two such rollers at the approach where the half-width is `elements` elements, at `phases` positions in a pitch.

    Both senses: rolling (the two grids face each other alike) and sliding (every relative phase occurs).
    """
    size = element_size(body)
    turn = size / body.contact_surfaces["rim"].shape.radius * np.arange(phases) / phases
    approach = approach_for(body, elements)[0]
    settings = window_for(body, elements)
    found = {}
    for sense, sign in SENSES.items():
        path = Path.of(
            np.full(phases, approach), turn, 0.5 * (sign - 1.0) * turn
        )  # rolling: opposite; else the first alone
        found[sense] = hertz_errors(solve_path(body, body, path, settings=settings), size)
    return found
