r"""Sheets in motion: every node of the full model, contact and friction solved in every step.

The generalized-alpha method with an auxiliary acceleration a (M. Arnold and O. Bruls, Multibody Syst. Dyn. 18 (2007)
185), the equations of motion at the end of the step:

    u1 = u + h v + h^2 ((1/2 - beta) a + beta a1),      v1 = v + h ((1 - gamma) a + gamma a1),
    (1 - alpha_m) a1 + alpha_m a = (1 - alpha_f) w1 + alpha_f w,      M w1 = f1 - K u1 - D v1 + B s1,

w the acceleration; gamma = 1/2 - alpha_m + alpha_f, beta = (gamma + 1/2)^2/4. With all known terms in u* and v*,
u1 = u* + c w1 and v1 = v* + d w1, so that with A = M + d D + c K the relative displacement of the cells is

    delta1 = B^T (u* + c A^-1 (f1 - K u* - D v*)) + c B^T A^-1 B s1,

an increment of `contact_program`. The gap is closed in displacements: if a cell closes in motion its velocity jumps
over the steps determined by the method's damping. D = alpha M + beta K is Rayleigh's, none by default.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from references.small_sliding.contact_program import solve
from references.small_sliding.quasi_static import Followed, StaticSmallSliding
from warpffrf.model.errors import InputError, require_number

Array = np.ndarray


@dataclass(frozen=True)
class Scheme:
    """alpha_m and alpha_f of the method."""

    alpha_m: float
    alpha_f: float

    @classmethod
    def damped(cls, rho: float) -> Scheme:
        """Generalized-alpha of spectral radius rho at infinite frequency (J. Chung and G. M. Hulbert 1993)."""
        if not 0.0 <= rho <= 1.0:
            raise InputError(f"scheme: the spectral radius must lie between 0 and 1, got {rho:g}")
        return cls((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0))

    @classmethod
    def trapezoidal(cls) -> Scheme:
        """The trapezoidal rule (Newmark's with 1/4 and 1/2), without damping."""
        return cls(0.0, 0.0)

    @property
    def gamma(self) -> float:
        """gamma [-]."""
        return 0.5 - self.alpha_m + self.alpha_f

    @property
    def beta(self) -> float:
        """beta [-]."""
        return 0.25 * (self.gamma + 0.5) ** 2


@dataclass(frozen=True, eq=False)
class Motion:
    """time (n,) [s]; observed (n, m); dissipated (n,) [J] by friction and damped (n,) [J] by D, both so far; kinetic
    and strain (n,) [J]; force (n, c, 3) [N] and state (n, c) of the cells. Row 0 is the initial state."""

    time: Array
    observed: Array
    dissipated: Array
    damped: Array
    kinetic: Array
    strain: Array
    force: Array
    state: Array


def released(
    lap: StaticSmallSliding,
    loads: Array,
    before: Array,
    after: Array | Callable[[float], Array],
    *,
    steps: int,
    step: float,
    scheme: Scheme | None = None,
    damping: tuple[float, float] = (0.0, 0.0),
    observed: Array | None = None,
) -> Motion:
    """Motion from rest after a static history.

    loads F (dofs, k); before (n, k): factors of the static history, the last is released at time 0; after (k,):
    the factors from then on, or a function of time [s]; `step` h [s]; scheme: None for rho = 0.8; damping: alpha
    [1/s] and beta [s] of D; observed (dofs, m). Raises `InputError` for a step that is not positive.
    """
    h = require_number(step, "motion: step", positive=True)
    scheme = scheme or Scheme.damped(0.8)
    model, cells = lap.model, lap.cells
    free = model.free
    F, B = np.asarray(loads, dtype=float)[free], cells.loads.tocsr()[free].tocsc()
    watched = (np.zeros((model.size, 0)) if observed is None else np.asarray(observed, dtype=float))[free]
    K, M = model.K[free][:, free], model.M[free][:, free]
    D = damping[0] * M + damping[1] * K
    ratio = (1.0 - scheme.alpha_f) / (1.0 - scheme.alpha_m)
    c, d = scheme.beta * h**2 * ratio, scheme.gamma * h * ratio
    inverse = model.factor(model.M * (1.0 + d * damping[0]) + model.K * (c + d * damping[1]))
    answers = inverse.solve(B.toarray())
    G = c * (B.T @ answers)
    G = 0.5 * (G + G.T) + np.diag(lap.layers)
    count = cells.count

    start: Followed = lap.follow(loads, before)
    s, slipped = start.force[-1], start.slip[-1]
    u = lap.model.solve((np.asarray(loads) @ before[-1])[:, None])[free, 0] + lap.responses[free] @ s.ravel()
    v, a, w = np.zeros(len(free)), np.zeros(len(free)), np.zeros(len(free))
    initial = np.zeros((count, 3))
    initial[:, 0] = cells.gap

    rows = steps + 1
    time = h * np.arange(rows)
    shown, force = np.zeros((rows, watched.shape[1])), np.zeros((rows, count, 3))
    state = np.zeros((rows, count), dtype=int)
    dissipated, damped, kinetic, strain = (np.zeros(rows) for _ in range(4))
    shown[0], force[0], state[0] = watched.T @ u, s, start.state[-1]
    strain[0] = 0.5 * (u @ (K @ u) + lap.layers @ s.ravel() ** 2)
    for i in range(1, rows):
        factors = after(float(time[i])) if callable(after) else after
        known = (scheme.alpha_f * w - scheme.alpha_m * a) / (1.0 - scheme.alpha_m)
        u_star = u + h * v + h**2 * ((0.5 - scheme.beta) * a + scheme.beta * known)
        v_star = v + h * ((1.0 - scheme.gamma) * a + scheme.gamma * known)
        alone = inverse.solve(F @ factors - K @ u_star - D @ v_star)
        b = (B.T @ (u_star + c * alone)).reshape(count, 3) + initial
        b[:, 1:] -= slipped
        found = solve(G, b, lap.friction, s)
        s = found.force
        slipped = slipped + found.motion[:, 1:]
        w1 = alone + answers @ s.ravel()
        a1 = ratio * w1 + known
        u, v_before, v = u_star + c * w1, v, v_star + d * w1
        a, w = a1, w1
        middle = 0.5 * (v_before + v)
        shown[i], force[i], state[i] = watched.T @ u, s, found.state
        dissipated[i] = dissipated[i - 1] + found.dissipated
        damped[i] = damped[i - 1] + h * (middle @ (D @ middle))
        kinetic[i] = 0.5 * (v @ (M @ v))
        strain[i] = 0.5 * (u @ (K @ u) + lap.layers @ s.ravel() ** 2)
    return Motion(time, shown, dissipated, damped, kinetic, strain, force, state)


def peaks(values: Array, least: float = 0.02) -> Array:
    """Numbers of the local maxima of values (n,) above `least` of the largest one."""
    inner = values[1:-1]
    return 1 + np.flatnonzero((inner > values[:-2]) & (inner >= values[2:]) & (inner > least * values.max()))
