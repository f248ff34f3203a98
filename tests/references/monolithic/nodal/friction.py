r"""Friction at a node: traction of the first surface and slip of the step, and Newton's method for both together.

Ds (2,) is the slip of the step [m] in the tangents of the first surface, whose material stores the memory. All laws
are a disc with a softness sigma [m/Pa],

    w = Ds + sigma (tau - tau_0),      |tau| <= b = mu(|w|/h) p,      w = 0 where |tau| < b,      w = -l tau, l >= 0,

laws that stick      tau_0 the traction when the step began, sigma = 1/k_t: an elastic deflection of sticking nodes,
                     with the constant stick stiffness k_t [Pa/m]; w is the plastic slip. For given Ds the solution
                     is the closest point of the disc to tau_0 - k_t Ds (return mapping, `closest_point`).
laws that creep      tau_0 = 0, sigma = h v_slip/b: tau = -b Ds/max(|Ds|, h v_slip), no memory.

Newton. Tractions computed with a stiff k_t alternate between opposite sides of the disc during the iteration for the
displacements. So tau is an unknown of its own at every active node, eliminated there. The law is `F = tau - b e = 0`
with v = tau - c w, e = v/|v| if |v| > b, else w = 0, for any c > 0 [Pa/m]: of the order of the surface's own
stiffness, for any k_t (Alart and Curnier 1991). Linearised, with P = 1 - e e^T, beta = b/|v| and
d = 1 - beta (1 - c sigma),

    stick    dtau = -(w + ds + (tau - tau_0) sigma' dp)/sigma
    slip     dtau = -(e e^T/a + P/d) F + (mu/a) e dp - (m/a e e^T + beta c/d P) (ds + (tau - tau_0) sigma' dp)

ds, dp the changes of slip and pressure. A coefficient that depends on the slip speed gives m = mu' p/h and a = 1 +
sigma m, as w is along -e. If a is not clearly positive the node alone is unstable against the decrease of its bound
(`warpffrf.model.friction`); there, and if the tangent leads to a bound that the law has at no speed, the bound
is that of the iteration before, m = 0. The bound follows the pressure, so the tangent is not symmetric. With c = k_t
and F = 0 it is the consistent tangent of return mapping.

Work. The work done by the surfaces is -tau.Ds; the deflection stores tau^2/(2 k_t). As k_t is constant,

    -tau.Ds = (tau^2 - tau_0^2)/(2 k_t) + |tau| |w| + |tau - tau_0|^2/(2 k_t),

as w is opposite to tau. `lost` is |tau| |w|, never negative; the last part is the dissipation of implicit Euler in
the deflection, of first order in the step, and so belongs to the integration. The regularised law dissipates
-tau.Ds >= 0.

Default stick stiffness. The tangential compliance of two half-spaces of one material is (2 - nu)/(2 (1 - nu)) of the
normal one (Mindlin 1949; K. L. Johnson, Contact Mechanics, 1985, eq. 7.44): k_t = k 2(1 - nu)/(2 - nu), 0.82 k at nu =
0.3, k the stiffness of a linear layer. Other layers have no constant stiffness; there k is that of the surface itself
times `STIFFER` of `line_of_centres.pair`, stiff compared with the body. The separated solver has no such deflection:
its cells stick.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

POISSON = 0.3  # of metals; between 0.2 and 0.4 the ratio changes by less than 0.07
MINDLIN = 2.0 * (1.0 - POISSON) / (2.0 - POISSON)  # tangential stiffness of a contact over its normal stiffness
STICK, SLIP = 1, 2
TINY = np.finfo(float).tiny
LEAST = 0.1  # of a: below it the bound is used, not its tangent
HALVINGS = 60  # of an interval, to round-off


@dataclass(frozen=True, eq=False)
class NodeTraction:
    """At nodes (k,): traction tau (k, 2) [Pa], its linear change `constant + by_slip ds + by_pressure dp` (k, 2), (k,
    2, 2), (k, 2), state (k,) (1 stick, 2 slip), residual of the law (k,) [Pa], energy of the deflection (k,)
    [J/m^2] and dissipation in the step (k,) [J/m^2]."""

    traction: np.ndarray
    constant: np.ndarray
    by_slip: np.ndarray
    by_pressure: np.ndarray
    state: np.ndarray
    off: np.ndarray
    stored: np.ndarray
    lost: np.ndarray


def node_traction(
    law: Any, pressure: np.ndarray, slip: np.ndarray, before: np.ndarray, tau: np.ndarray | None, *,
    stick: float, search: float, h: float,
) -> NodeTraction:  # fmt: skip
    """The law at pressures (k,) [Pa], slips (k, 2) [m] of a step h [s] and tractions tau (k, 2) [Pa], which were
    `before` when it began; stick: k_t, search: c [Pa/m]. Without tau that of the law, and c = 1/sigma."""
    soft, by_p = np.full(len(pressure), 1.0 / stick), np.zeros(len(pressure))
    creeping = law.creep_limit > 0.0
    if creeping:
        bound = law.coefficient_at(law.creep_limit) * pressure
        soft = h * law.creep_limit / np.maximum(bound, TINY)
        by_p = -soft / np.maximum(pressure, TINY)
    start = np.zeros_like(before) if creeping else before
    c = 1.0 / soft
    if tau is None:
        trial = start - slip / soft[:, None]
        tau = closest_point(trial, law.coefficient_at(_slip_speed(law, trial, pressure, soft, h)) * pressure)
    else:
        c = np.minimum(c, search)
    w = slip + soft[:, None] * (tau - start)
    speed = np.linalg.norm(w, axis=1) / h
    mu = law.coefficient_at(speed)
    bound = mu * pressure
    v = tau - c[:, None] * w
    size = np.linalg.norm(v, axis=1)
    sliding = size > bound
    e = v / np.maximum(size, TINY)[:, None]
    beta = np.where(sliding, bound / np.where(sliding, size, 1.0), 0.0)
    d = 1.0 - beta * (1.0 - c * soft)
    P = np.eye(2) - e[:, :, None] * e[:, None, :]
    F = tau - bound[:, None] * e
    across = np.einsum("kij,kj->ki", P, F)
    m = law.slope_at(speed) * pressure / h
    a = 1.0 + soft * m
    leads_to = bound + np.einsum("ki,ki->k", e, F) * (soft * m / np.maximum(a, LEAST))
    within = (leads_to >= law.least_coefficient * pressure) & (leads_to <= law.largest_coefficient * pressure)
    usable = (a > LEAST) & within
    m, a = np.where(usable, m, 0.0), np.where(usable, a, 1.0)
    shift = (tau - start) * by_p[:, None]
    slides = sliding[:, None]
    constant = np.where(slides, -(F - across) / a[:, None] - across / d[:, None], -w / soft[:, None])
    along = (m / a)[:, None, None] * (np.eye(2) - P)
    by_slip = -np.where(
        sliding[:, None, None], (beta * c / d)[:, None, None] * P + along, np.eye(2) / soft[:, None, None]
    )
    by_pressure = np.einsum("kij,kj->ki", by_slip, shift) + np.where(slides, (mu / a)[:, None] * e, 0.0)
    off = np.linalg.norm(tau - closest_point(v, bound), axis=1)
    lost = np.where(sliding, np.linalg.norm(tau, axis=1) * np.linalg.norm(w, axis=1), 0.0)
    stored = np.einsum("ki,ki->k", tau, tau) / (2.0 * stick)
    if creeping:
        lost, stored = np.maximum(-np.einsum("ki,ki->k", tau, slip), 0.0), np.zeros_like(lost)
    return NodeTraction(tau, constant, by_slip, by_pressure, np.where(sliding, SLIP, STICK), off, stored, lost)


def _slip_speed(law: Any, trial: np.ndarray, pressure: np.ndarray, soft: np.ndarray, h: float) -> np.ndarray:
    """|w|/h (k,) [m/s] of return mapping from the tractions `trial`: |w| = sigma (|trial| - b(|w|/h))."""
    size = np.linalg.norm(trial, axis=1)
    low, high = np.zeros(len(size)), soft * size / h
    if not law.breaks:
        return low
    sliding = size > law.static_coefficient * pressure
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        faster = h * middle < soft * (size - law.coefficient_at(middle) * pressure)
        low, high = np.where(faster, middle, low), np.where(faster, high, middle)
    return np.where(sliding, 0.5 * (low + high), 0.0)


def closest_point(tau: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """The points (k, 2) of discs of radius `bound` (k,) closest to tau (k, 2)."""
    size = np.linalg.norm(tau, axis=1)
    return tau * (bound / np.where(size > bound, size, np.maximum(bound, TINY)))[:, None]
