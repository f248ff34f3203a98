"""Ripple of the contact force of two rollers that turn at constant approach.

On a round body nothing should change when it turns. What does change comes from the grid: the load on an element's
middle is met by
another compliance than the load on its edge. Rolling without slip freezes the relative phase of the two grids and
sweeps
the phase of the patch; turning both the same way round lets the grids slide past each other. Both are swept, at several
relative phases and several sizes of the patch, because the ripple is not monotone in any of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scenes.rollers import PAIR, Path, solve_path
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import Settings

SENSES = {"rolling": -1.0, "sliding": 1.0}  # turn of the second roller over that of the first


@dataclass(frozen=True)
class Ripple:
    """Force of one sweep over a pitch: peak to peak over mean, and where it was measured."""

    value: float  # peak to peak over mean
    sense: str
    phase: float  # of the two grids at the start, in pitches
    half_width: float  # Hertz half-width, mean over the sweep, in elements
    mean_force: float  # N


def element_size(body: ReducedBody) -> float:
    """Arc length [m] of an element of the rim of a rotationally periodic body: the circumference over its sectors."""
    surface = body.contact_surfaces["rim"]
    return 2.0 * np.pi * surface.shape.radius / len(surface.lags)


def window_for(body: ReducedBody, elements: float) -> Settings:
    """Settings whose contact window holds a patch of the half-width `elements` on two such rollers, and half as much
    again."""
    effective = 0.5 * body.contact_surfaces["rim"].shape.radius
    return Settings(window_strain=1.5 * elements * element_size(body) / effective)


def approach_for(body: ReducedBody, elements: Any, *, samples: int = 12) -> np.ndarray:
    """Approaches [m] of two such rollers at which Hertz's half-width for the mid-width line load is `elements`
    elements."""
    wanted = np.atleast_1d(np.asarray(elements, float))
    size = element_size(body)
    radius = 0.5 * body.contact_surfaces["rim"].shape.radius
    # F = F(half-width^2) is nearly linear in the approach; four times a^2/(2 R) is deep enough for hollow rollers
    deepest = 4.0 * (wanted.max() * size) ** 2 / radius
    settings = window_for(body, 2.0 * wanted.max())
    approach = np.linspace(deepest / samples, deepest, samples)
    contact = solve_path(body, body, Path.of(approach), settings=settings).contact(PAIR)
    widths = [contact.hertz(i).half_width if touches else 0.0 for i, touches in enumerate(contact.touching)]
    found = np.array(widths) / size
    return np.interp(wanted, found, approach[: len(found)])


def ripples(
    body: ReducedBody, elements: Any, *, positions: int = 12, phases: int = 5, second: ReducedBody | None = None
) -> list[Ripple]:
    """Ripple of every sweep: each size of the patch in `elements` (half-width over element), sense and relative
    phase."""
    other = second or body
    pitch = element_size(body) / body.contact_surfaces["rim"].shape.radius
    turn = pitch * np.arange(positions) / positions
    settings = window_for(body, float(np.max(elements)))
    out = []
    for approach in approach_for(body, elements):
        for sense, sign in SENSES.items():
            for phase in np.arange(phases) / phases:
                path = Path.of(np.full(positions, approach), turn, sign * turn + phase * pitch)
                contact = solve_path(body, other, path, settings=settings).contact(PAIR)
                force = contact.force_magnitude
                widths = [contact.hertz(i).half_width for i in range(len(force))]
                value = float(np.ptp(force) / force.mean()) if len(force) == positions else np.nan
                elements_found = float(np.mean(widths)) / element_size(body)
                out.append(Ripple(value, sense, float(phase), elements_found, float(force.mean())))
    return out


def worst(sweeps: list[Ripple]) -> Ripple:
    """The sweep with the largest ripple; a failed one (NaN) counts as the worst."""
    return max(sweeps, key=lambda r: np.inf if np.isnan(r.value) else r.value)
