r"""A roller dropped on another: energy ledger and restitution of the first bounce.

The upper roller and its carriage, mass m together, fall freely through `gap` on the lower one: t = sqrt(2 gap / g), v
= sqrt(2 g gap).
A step h lands on the impact at an arbitrary *phase*; the phase is swept by moving the start, gap(t) = g t^2/2 with t
= t_0 + phase h.

*Rise of the ledger*: with L = numerical + contact_grid (all that no wrench accounts for), the largest climb of L
above what it has
been before, over the energy at hand (the kinetic energy that arrives, m g gap): an integrator that gains energy
shows here even where it loses as much later.
*Restitution*: speed of the common centre of mass of roller and carriage at the separation over that at the touch, both
freed of the free fall within the step that holds them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.rollers import CARRIAGE_MASS, PAIR, guided_pair
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import GeneralizedAlpha, History, run

GRAVITY = 9.81  # m/s2
AFTER = 1.0e-3  # s looked at after the first touch: contact of two steel rollers of some kg lasts a third of it


@dataclass(frozen=True)
class Drop:
    """One drop: step [s], phase of the impact in steps, and what came of it."""

    step: float
    phase: float
    restitution: float  # NaN where the rollers did not separate within the run
    rise: float  # of the ledger, over the energy at hand
    loss: float  # of the ledger at the end, over the energy at hand
    status: str
    accepted: int
    rejected: int


def ledger_rise(history: History) -> float:
    """Largest climb [J] of numerical + contact_grid above its own past."""
    L = history.energy["numerical"] + history.energy["contact_grid"]
    return float(np.max(L - np.minimum.accumulate(L), initial=0.0))


def center_velocity(history: History, names: tuple[str, ...]) -> np.ndarray:
    """Vertical velocity (T,) [m/s] of the common centre of mass of the named bodies."""
    momentum, mass = 0.0, 0.0
    for name in names:
        body = history.scene.body(name)  # pyright: ignore[reportAttributeAccessIssue]
        motion = history.bodies[name]
        momentum = momentum + body.mass * motion.velocity[:, 2]
        mass += body.mass
    return np.asarray(momentum / mass)


def restitution(history: History, fall: float, gravity: float = GRAVITY) -> float:
    """Speed of roller and carriage after the first contact over that before it; NaN where it does not rise again.

    Both speeds are taken at saved steps without contact and carried to the touch at the common height of the fall:
    v^2 + 2 g z is constant in free flight, so that the place of the steps does not matter.
    `fall` [m] is the distance from the start to the touch.
    """
    v = center_velocity(history, ("upper", "carriage"))
    z = history.bodies["carriage"].position[:, 2]
    free = np.linalg.norm(history.contacts[PAIR].force, axis=1) == 0.0
    rising = np.flatnonzero(free & (v > 0.0))
    if not len(rising):
        return np.nan
    after = rising[0]
    before = np.flatnonzero(free[:after] & (v[:after] <= 0.0))[-1]
    touch = z[0] - fall
    speeds = [np.sqrt(max(v[i] ** 2 + 2.0 * gravity * (z[i] - touch), 0.0)) for i in (before, after)]
    return float(speeds[1] / speeds[0])


def drop(
    first: ReducedBody,
    second: ReducedBody,
    *,
    step: float,
    phase: float = 0.0,
    gap: float = 1e-3,
    after: float = AFTER,
    rho_inf: float = 0.8,
    carriage_mass: float = CARRIAGE_MASS,
) -> tuple[Drop, History]:
    """Drop `second` with its carriage through about `gap` [m] on `first`; the touch comes `phase` steps later than
    that."""
    fall_time = np.sqrt(2.0 * gap / GRAVITY) + phase * step
    fall = 0.5 * GRAVITY * fall_time**2
    scene = guided_pair(
        first, second, load=0.0, stiffness=0.0, damping=0.0, gap=fall, gravity=GRAVITY, carriage_mass=carriage_mass
    )
    steps = int(np.ceil((fall_time + max(after, 3.0 * step)) / step))
    history = run(scene, steps * step, step=step, integrator=GeneralizedAlpha(rho_inf), progress=False)
    at_hand = (second.mass + carriage_mass) * GRAVITY * fall
    L = history.energy["numerical"] + history.energy["contact_grid"]
    counters = history.counters
    found = Drop(
        step, phase, restitution(history, fall), ledger_rise(history) / at_hand, float(L[-1] - L[0]) / at_hand,
        history.status,
        int(counters["steps"]), int(counters["rejected_steps"]),
    )  # fmt: skip
    return found, history
