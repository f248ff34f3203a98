r"""A mass on a belt, attached to a spring, with a friction coefficient that depends on the slip speed, event by event.

With x the displacement of the mass from the slack spring, V the speed of the belt, N the load, u = V - xdot

    m xddot = -k x + mu(u) N,      u > 0 (slip);      xdot = V while k x < mu(0) N (stick).

From breakaway, k x = mu(0) N and xdot = V, it slips until xdot is V again, and sticks until the next breakaway:
after one slip the motion is periodic, for any initial state. Slip is integrated to 1e-10 and ends at an event; the
turning points are events too. For constant mu_k < mu_s after breakaway and r = (mu_s - mu_k) N/k, amplitude and
period are

    r_0 = sqrt(r^2 + (V/omega)^2),      T = 2 (pi - arctan(r omega/V))/omega + 2 r/V,      omega^2 = k/m.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

ACCURACY = 1e-10  # of the integration
PERIODS = 20.0  # of the free oscillation: maximum duration of a slip phase


@dataclass(frozen=True)
class BeltOscillator:
    """mass [kg], stiffness [N/m], load [N] and the belt's speed [m/s]."""

    mass: float
    stiffness: float
    load: float
    speed: float

    def cycle(self, coefficient: Callable[[float], float]) -> tuple[float, float]:
        """Amplitude [m], half of the distance between the turning points, and period [s] for mu = coefficient(slip
        speed); (0, 0) if the mass comes to rest relative to the spring on the running belt and never sticks again."""
        m, k, N, V = self.mass, self.stiffness, self.load, self.speed
        away = coefficient(0.0) * N / k

        def rate(_: float, y: np.ndarray) -> list[float]:
            return [y[1], (-k * y[0] + coefficient(max(V - y[1], 0.0)) * N) / m]

        def with_the_belt(_: float, y: np.ndarray) -> float:
            return y[1] - V

        def turning(_: float, y: np.ndarray) -> float:
            return y[1]

        with_the_belt.terminal, with_the_belt.direction = True, 1.0  # type: ignore[attr-defined]
        longest = PERIODS * 2.0 * np.pi * np.sqrt(m / k)
        found = solve_ivp(
            rate, (0.0, longest), (away, V), events=(with_the_belt, turning), rtol=ACCURACY, atol=ACCURACY * away
        )
        if not len(found.t_events[0]):
            return 0.0, 0.0
        back, turns = found.y_events[0][0][0], found.y_events[1][:, 0]
        return 0.5 * float(turns.max() - turns.min()), float(found.t_events[0][0] + (away - back) / V)


def two_coefficients(case: BeltOscillator, static: float, kinetic: float) -> tuple[float, float]:
    """Amplitude [m] and period [s] of the module docstring for a coefficient that drops at once."""
    r, omega = (static - kinetic) * case.load / case.stiffness, np.sqrt(case.stiffness / case.mass)
    slips = 2.0 * (np.pi - np.arctan(r * omega / case.speed)) / omega
    return float(np.hypot(r, case.speed / omega)), float(slips + 2.0 * r / case.speed)
