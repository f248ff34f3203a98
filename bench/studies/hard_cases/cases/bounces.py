r"""A steel ball that bounces on a floor a thousand times, without damping and with it.

Without: from a height of 0.1 mm it comes back to 0.1 mm after every bounce, one in 2 sqrt(2 h/g) = 9 ms. With: by the
law of Hunt and Crossley, F = K a^(3/2) (1 + chi a'), whose restitution e(v) = 1 - O(v) follows from

    m a'' = m g - F,       a(0) = 0, a'(0) = v,

integrated for a range of v; from bounce to bounce v becomes e(v) v, the flights last 2 v/g, and so long as they are
longer than a touch the energy that is left at a time follows.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.integrate import solve_ivp

from studies.hard_cases.case import Case, Finding, Ledger
from warpffrf.model import laws, surfaces
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
RADIUS, HEIGHT, GRAVITY, BOUNCES = 0.01, 1e-4, 9.81, 1000  # m, m, m/s2
MASS = STEEL.density * 4.0 / 3.0 * np.pi * RADIUS**3
SPEED = float(np.sqrt(2.0 * GRAVITY * HEIGHT))
RESTITUTION = 0.9  # at SPEED
K = 4.0 / 3.0 * 0.5 * STEEL.plane_strain_modulus * np.sqrt(RADIUS)
WEIGHT = MASS * GRAVITY
AT_REST = (WEIGHT / K) ** (2.0 / 3.0)  # m
ENERGY = WEIGHT * HEIGHT
DURATION = BOUNCES * 2.0 * SPEED / GRAVITY
SLOWEST = 30.0  # of the speed at which a ball would rise by its depth at rest: bounces are flights down to there


def scene_of(law: laws.HertzPoint) -> Scene:
    """The ball at rest above the floor."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    skin = surfaces.Sphere(radius=RADIUS, axis_point=(0.0, 0.0, 0.0))
    ball = scene.add_rigid_body(
        MASS, (0.4 * MASS * RADIUS**2,) * 3, name="ball", position=(0.0, 0.0, RADIUS + HEIGHT), surfaces={"skin": skin}
    )
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    scene.add(LumpedContact(ball["skin"], floor, law=law, name="contact"))
    return scene


def build() -> Scene:
    """Without damping."""
    return scene_of(laws.HertzPoint(STEEL, STEEL))


def damped_law() -> laws.HertzPoint:
    """Restitution `RESTITUTION` at the first impact."""
    return laws.HertzPoint(STEEL, STEEL, restitution=RESTITUTION, impact_speed=SPEED)


def build_damped() -> Scene:
    """With damping."""
    return scene_of(damped_law())


def mechanical(result: Result) -> np.ndarray:
    """Kinetic, potential and contact energy (T,) over the drop, zero with the ball resting on an unyielding floor."""
    z = result.body("ball").position[:, 2] - RADIUS
    return (result.energy["kinetic"] + result.energy["contact"] + WEIGHT * z) / ENERGY


def check(result: Result) -> list[Finding]:
    """What is left of the energy of the drop, worst of all times, and how deep the ball came."""
    z = result.body("ball").position[:, 2] - RADIUS
    deepest = (2.5 * ENERGY / K) ** 0.4
    depth = max(float(-z.min()) / deepest - 1.0, 0.0)
    return [
        Finding("energy of the drop", float(np.abs(mechanical(result) - 1.0).max()), 1e-2, 1e-1),
        Finding("depth beyond Hertz's", depth, 2e-2, 2e-1),
    ]


@lru_cache
def _restitution() -> tuple[np.ndarray, np.ndarray]:
    """Speeds and e(v) at them."""
    chi, speeds = damped_law().chi, SPEED * np.geomspace(1e-3, 1.0, 25)

    def over(_: float, y: np.ndarray) -> float:
        return y[0]

    over.terminal, over.direction = True, -1.0  # type: ignore[attr-defined]
    found = []
    for v in speeds:
        span = 40.0 * (MASS / K) ** 0.4 * v**-0.2
        run = solve_ivp(
            lambda _, y: [y[1], GRAVITY - K / MASS * max(y[0], 0.0) ** 1.5 * max(1.0 + chi * y[1], 0.0)], (0.0, span),
            (0.0, v), events=over, rtol=1e-9, atol=1e-16, max_step=span / 200.0,
        )  # fmt: skip
        found.append(-run.y_events[0][0][1] / v if len(run.t_events[0]) else 0.0)
    return speeds, np.array(found)


def left_after(time: float) -> float | None:
    """Energy of the flight at `time` [s] over that of the drop; None where bounces are flights no more."""
    speeds, e = _restitution()
    v, t = SPEED, SPEED / GRAVITY  # the first touch
    if time < t:
        return 1.0
    while True:
        touch = 2.94 * (1.25 * MASS * v**2 / K) ** 0.4 / v
        v *= float(np.interp(v, speeds, e))
        if v < np.sqrt(2.0 * GRAVITY * SLOWEST * AT_REST):
            return None
        t += touch + 2.0 * v / GRAVITY
        if t > time:
            return (v / SPEED) ** 2


def check_damped(result: Result) -> list[Finding]:
    """The energy that is left, against the bounces one by one; later that the ball rests on the floor."""
    left, force = mechanical(result), result.lumped_contact("contact").normal_force
    flying = np.flatnonzero(force == 0.0)[-1]
    wanted = left_after(float(result.time[flying]))
    if wanted is not None:
        return [Finding("energy left", abs(float(left[flying]) - wanted), 1e-2, 1e-1)]
    late = result.time > 0.9 * result.time[-1]
    return [
        Finding("energy left at rest", float(left[-1]), 1e-3, 1e-2),
        Finding("mean force at rest", abs(float(force[late].mean()) / WEIGHT - 1.0), 1e-2, 1e-1),
    ]


CASE = Case(
    "1,000 bounces",
    "A ball bounces without damping, in nine seconds a thousand times: no bounce may take or give energy.",
    build, DURATION, check, steps=(1e-6, 1e-5, 1e-4, 1e-3, 1e-2), middle=1e-4,
    tolerances=(1e-6,), energies=(1e-6,), most_steps=100_000, ledger=Ledger(gain=(5e-3, 1e-2)),  # 5e-6 a bounce
)  # fmt: skip
DAMPED = Case(
    "bounces to rest",
    "The same with damping, until the ball rests: bounces that become shorter than any step.",
    build_damped, 1.0, check_damped, middle=1e-4, energies=(1e-5,), most_steps=50_000, quick=True,
)  # fmt: skip
