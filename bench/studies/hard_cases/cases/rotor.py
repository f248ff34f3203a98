r"""A flexible shaft with a disc at its free end, run up through its first critical speed: Jeffcott's rotor.

The shaft, square and hence equally stiff all round, is held and driven at one end. The middle of the disc, z in the
complex plane across the shaft, moves by

    (m + 33/140 m_s) z'' + c z' + k z = m e (phi'^2 - i phi'') exp(i phi),      k = 3 E I/L^3,

with the disc's mass m and eccentricity e, the shaft's mass m_s as Rayleigh has it for this shape, damping c from the
outside, and the prescribed angle phi. Integrated by an eighth-order Runge-Kutta method; what is compared is the largest
amplitude so far, which a rotor that runs up reaches beyond its critical speed. The disc itself rotates with next to no
inertia.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import Polynomial
from scipy.integrate import solve_ivp

from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces, joints, signals
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.output.result import Result

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
LENGTH, SIDE, DISC, OFFSET = 0.4, 0.012, 2.0, 5e-5  # m, m, kg, m
STIFFNESS = 3.0 * STEEL.youngs_modulus * SIDE**4 / 12.0 / LENGTH**3
MASS = DISC + 33.0 / 140.0 * STEEL.density * SIDE**2 * LENGTH
CRITICAL = float(np.sqrt(STIFFNESS / MASS))  # rad/s
DAMPING = 2.0 * 0.03 * MASS * CRITICAL  # N s/m
RUN_UP, DURATION = 2.0, 1.6  # s
SPEED = signals.SmoothStep(0.0, 2.0 * CRITICAL, duration=RUN_UP)
HELD = 1.0  # N/m: a bearing has a radial stiffness; 6e-5 of the shaft's
SEEN = 1e-3  # of the largest amplitude of all


@lru_cache
def _shaft() -> ReducedBody:
    mesh = box((SIDE, LENGTH, SIDE), (1, 10, 1), center=(0.0, 0.5 * LENGTH, 0.0), order=2, name="shaft")
    return reduce(mesh, STEEL, interfaces={"y_min": "rigid", "y_max": "rigid"}, modes=4, cache=False, progress=False)


def build() -> Scene:
    """The rotor at rest, its shaft along y."""
    scene = Scene()
    shaft = scene.add_body(_shaft(), name="shaft")
    disc = scene.add_rigid_body(
        DISC, (1e-6,) * 3, name="disc", position=(0.0, LENGTH, 0.0), center_of_mass=(OFFSET, 0.0, 0.0)
    )
    held = scene.add(joints.Revolute(scene.ground, shaft["y_min"], axis=(0, 1, 0), name="drive end"))
    scene.add(joints.Drive(held, SPEED, quantity="velocity"))
    scene.add(joints.Fixed(shaft["y_max"], disc.at((0.0, 0.0, 0.0)), name="seat"))
    tip = scene.ground.at((0.0, LENGTH, 0.0))
    scene.add(
        forces.BearingSpring(tip, shaft["y_max"], axis=(0, 1, 0), radial=HELD, radial_damping=DAMPING, name="damper")
    )
    return scene


@lru_cache
def amplitudes() -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and the amplitude |z| [m] of the run-up at them."""
    speed = Polynomial(SPEED.polynomial()[1][0])
    angle, turn = speed.integ(), speed.deriv()

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        push = DISC * OFFSET * (speed(t) ** 2 - 1j * turn(t)) * np.exp(1j * angle(t))
        a = (push - DAMPING * (y[2] + 1j * y[3]) - (STIFFNESS + HELD) * (y[0] + 1j * y[1])) / MASS
        return np.array([y[2], y[3], a.real, a.imag])

    times = np.linspace(0.0, DURATION, 8001)
    found = solve_ivp(rate, (0.0, DURATION), np.zeros(4), method="DOP853", t_eval=times, rtol=1e-9, atol=1e-14)
    return times, np.hypot(found.y[0], found.y[1])


def check(result: Result) -> list[Finding]:
    """The largest amplitude so far, where that can be distinguished from none."""
    place, (times, exact) = result.body("disc").position, amplitudes()
    found = float(np.hypot(place[:, 0], place[:, 2]).max())
    wanted = float(exact[times <= result.time[-1]].max())
    size = max(wanted, SEEN * float(exact.max()))
    return [Finding("largest amplitude", abs(found - wanted) / size, 3e-2, 1.5e-1)]


CASE = Case(
    "rotor through resonance",
    "A flexible shaft with an eccentric disc is run up through its first critical speed.",
    build, DURATION, check, middle=1e-3, most_steps=16_000,
)  # fmt: skip
