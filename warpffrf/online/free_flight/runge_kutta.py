r"""The classical Runge-Kutta method of order 4 (Kutta 1901) for free bodies, on the host.

The equations of motion (`warpffrf.online.free_flight.free_bodies`) are integrated as they stand, with pdot = p o (w,
0)/2 of the unit quaternion, which is brought back to length one after each step; its drift is of fifth order, so the
order stays. The work of the loads and the loss in dampers are integrated along with the motion, to the same order.

Explicit methods have a stability limit: with z = lambda h, lambda = -zeta omega +- i omega sqrt(1 - zeta^2) of a mode,
the step multiplies it by R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24, and |R| <= 1 ends at omega h = 2 sqrt(2) without
damping.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.online.free_flight.free_bodies import CURE, FreeBody, Motion, product

Array = np.ndarray
GROWTH = 1e-9  # of |R|: rounding of a mode on the edge of stability
IMAGINARY_LIMIT = 2.0 * np.sqrt(2.0)  # of omega h, undamped
SAFE = 0.7  # of the limit, in the step that a message proposes: damped modes may end a little earlier


def advance(body: FreeBody, state: Motion, t: float, h: float) -> tuple[Motion, float, float, int]:
    """One step of `h` [s] from time `t`: the new state, work of the loads, energy taken by damping [J], stages."""
    slopes = [_slope(body, state, t)]
    for part in (0.5, 0.5, 1.0):
        moved = Motion(*(x + part * h * s for x, s in zip(state, slopes[-1], strict=False)))
        slopes.append(_slope(body, moved, t + part * h))
    total = [a + 2.0 * b + 2.0 * c + d for a, b, c, d in zip(*slopes, strict=True)]
    new = Motion(*(x + h / 6.0 * s for x, s in zip(state, total, strict=False)))
    return (
        new._replace(p=new.p / np.linalg.norm(new.p)),
        float(h / 6.0 * total[6]),
        float(h / 6.0 * total[7]),
        len(slopes),
    )


def _slope(body: FreeBody, state: Motion, t: float) -> tuple:
    """Time derivatives of r, p, v, w, q, qd, and the two powers."""
    unit = state._replace(p=state.p / np.linalg.norm(state.p))
    rates = body.rates(unit, t)
    p_rate = 0.5 * product(state.p, np.array([*state.w, 0.0]))
    return state.v, p_rate, rates.v, rates.w, state.qd, rates.qd, rates.power, rates.dissipation


def amplification(stiffness: Array, damping: Array, h: float) -> Array:
    """|R| (m,) of modes with `stiffness` omega^2 [1/s^2] and `damping` 2 zeta omega [1/s] at step `h` [s]."""
    root = np.sqrt(np.asarray(0.25 * damping**2 - stiffness, dtype=complex))
    found = []
    for z in (h * (root - 0.5 * damping), h * (-root - 0.5 * damping)):
        found.append(np.abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))))
    return np.maximum(*found)


def check_step(body: FreeBody, h: float) -> None:
    """Raises `InputError` where a mode of `body` would grow at step `h` [s]."""
    growth = amplification(body.stiffness, body.damping, h)
    if not len(growth) or growth.max() <= 1.0 + GROWTH:
        return
    omega = float(np.sqrt(body.stiffness.max()))
    raise InputError(
        f"RungeKutta4: step {h:g} s is beyond the stability limit of body {body.name!r}, whose highest mode has "
        f"{omega / (2.0 * np.pi):.4g} Hz; use a step of at most {SAFE * IMAGINARY_LIMIT / omega:.2g} s, or {CURE}"
    )
