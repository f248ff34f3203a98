r"""A pin pressed into a bore of nearly its own radius: full finite elements compared with Persson's solution.

The pin (radius R, about (dR, 0), where it touches) and the sleeve (bore R + dR about the origin) are both modelled in
plane strain by `contact`, with the true bore: a pin node at R (cos t, sin t) + (dR, 0) has the gap
R + dR - |x| under the normal x/|x|. The sleeve is fixed at its outer radius. The pin either floats on a uniform body
force (`held=False`, with a hole so small that it is negligible) or its inner circle moves as a rigid one (True, a
roller on its shaft). Either body may be rigid (material None).

Persson's plate has no outer edge and his gap is linear in dR/R: both differences appear in the errors, the first by
the outer radius, the second by the clearance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.closed_forms import conformal_by_half_angle
from references.finite_elements.contact import HalfRing, Solved, active_set, pressure_rows, quadratic_rows
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.material import Material

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7800.0, name="steel")
GROWTH = 1.25  # of cells away from the patch
MARGIN = 1.35  # half-angles within which nodes can carry pressure and cells are fine
LARGEST = np.deg2rad(8.0)  # of a cell far from the patch


def graded(first: float, length: float, largest: float = np.inf, growth: float = GROWTH) -> Array:
    """Positions 0 ... length whose spacing grows by `growth` from about `first` to at most `largest`."""
    steps = [first]
    while sum(steps) < length:
        steps.append(min(steps[-1] * growth, largest))
    places = np.append(0.0, np.cumsum(steps))
    return places * (length / places[-1])


@dataclass(frozen=True)
class Pin:
    """Lengths [m]: radius R, clearance dR, inner radius of the pin, outer of the sleeve; materials, None: rigid."""

    radius: float = 0.01
    clearance: float = 1e-5
    inner_radius: float = 1e-4
    outer_radius: float = 0.2
    pin: Material | None = STEEL
    bore: Material | None = STEEL
    held: bool = False


def solve_pin(case: Pin, load: float, half_angle: float, cells: float = 32.0) -> Solved:
    """The loaded pin. load P' [N/m] of the whole pin; half_angle [rad] expected, `cells` in it: for the mesh only."""
    require_number(load, "load", positive=True)
    if case.pin is None and case.bore is None:
        raise InputError("pin in bore: both bodies are rigid, give one of them a material")
    R, bore = case.radius, case.radius + case.clearance
    h = half_angle / cells
    fine = h * np.arange(int(np.ceil(MARGIN * cells)) + 1)
    if fine[-1] > 0.9 * np.pi:
        raise InputError(f"pin in bore: half-angle {half_angle:g} is too large for this mesh")
    angles = np.append(fine, fine[-1] + graded(h * GROWTH, np.pi - fine[-1], LARGEST)[1:])
    nodes = np.empty(2 * len(fine) - 1)
    nodes[::2], nodes[1::2] = fine, 0.5 * (fine[1:] + fine[:-1])
    x = np.stack([R * np.cos(nodes) + case.clearance, R * np.sin(nodes)], axis=1)
    reach = np.linalg.norm(x, axis=1)
    e = x / reach[:, None]
    A = np.zeros((len(nodes), len(nodes)))
    if case.pin is not None:
        depth = graded(R * h, R - case.inner_radius)
        ring = HalfRing(case.pin, np.sort(R - depth), angles)
        _, dofs = ring.on_circle(R)
        E = np.zeros((ring.basis.N, len(nodes)))
        for k in range(2):
            E[dofs[: len(nodes), k], np.arange(len(nodes))] = e[:, k]
        inner, fixed = ring.on_circle(case.inner_radius)
        if not case.held:
            E -= np.outer(ring.body_force(), e[:, 0])
            fixed = fixed[:1, 0]  # one point, without load
        A += ring.flexibility(E, np.ravel(fixed))
    if case.bore is not None:
        depth = graded(R * h, case.outer_radius - bore)
        ring = HalfRing(case.bore, bore + depth, angles)
        places, dofs = ring.on_circle(bore)
        rows = quadratic_rows(places, np.arctan2(x[:, 1], x[:, 0]))
        E = np.zeros((ring.basis.N, len(nodes)))
        for k in range(2):
            E[dofs[:, k]] = rows.T * e[:, k]
        A += ring.flexibility(E, np.ravel(ring.on_circle(case.outer_radius)[1]))
    B = pressure_rows(nodes, R)
    s, gap, delta, sets = active_set(A, bore - reach, e[:, 0], B, 0.5 * load)
    return Solved(fine, s, gap, delta, sets)


def errors(case: Pin, half_angle: float, cells: float) -> list[float]:
    """Errors of peak pressure and moment angle against Persson, and the two nodes between which the patch ends over
    his half-angle [rad], at the load that gives it."""
    if case.pin is None:
        raise InputError("pin in bore: the closed form wants an elastic pin")
    exact = conformal_by_half_angle(half_angle, case.radius, case.clearance, case.pin, case.bore)
    found = solve_pin(case, exact.load, half_angle, cells)
    return [
        found.peak_pressure / exact.peak_pressure - 1.0,
        found.moment_angle / exact.moment_angle - 1.0,
        *(place / half_angle for place in found.edge),
    ]
