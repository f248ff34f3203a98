r"""Integrators in free flight: a rigid body about its unstable axis, and a soft ring; two minutes.

*Rigid* (case D4): I = diag(1, 2, 3) kg m2, omega_0 = (1e-3, 5, 1e-3) rad/s, torque-free. omega(10 s) is known from
Jacobi's elliptic functions. The body nearly rests on its unstable axis and then tumbles, which amplifies what is
small: the perturbation that starts it, (1e-3/5)^2 of energy and momentum, is distinguished from their errors only down
to their size, so that an error of 1e-16 shows as one of about 1e-8 in omega(10).

*Flexible*: a rubber ring that tumbles fast enough to be bent by it. It starts undeformed, the centrifugal load comes at
once, so that all modes ring. Momenta are those of the ring's own inertia (`warpffrf.model.reduced.inertia`),

    linear m v, of the centre of mass,      angular r x m v + A (J(q) w + h(q, qdot)) about the world's origin,

evaluated from the history alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.oscillator import errors
from warpffrf.model import rotation as rot
from warpffrf.model.integrators import (
    CHECK_INTEGRATORS,
    HHT,
    EnergyMomentum,
    GeneralizedAlpha,
    Newmark,
    RungeKutta4,
    roots_at_infinity,
)
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import momentum
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online import History, run
from warpffrf.online.free_flight.check_run import run_check

Array = np.ndarray
RUBBER = Material(8e6, 0.45, 1100.0, name="rubber")
MOMENTS = np.array([1.0, 2.0, 3.0])  # kg m2
SPIN = np.array([1e-3, 5.0, 1e-3])  # rad/s
AFTER_TEN = np.array([4.510627138, -2.157369653, 2.604211920])  # rad/s, body axes, at t = 10 s
RING_SPEED = (1.0, -0.5, 2.0)  # m/s
RING_SPIN = (20.0, 60.0, 40.0)  # rad/s
RING_TIME = 0.05  # s: two periods of the lowest mode, half a revolution
RING_STEPS = (2e-4, 1e-4, 5e-5, 2.5e-5)  # s: the highest mode has 17 to 130 steps a period
ROWS = 50  # saved of each flight


@dataclass(frozen=True)
class Flight:
    """One flight: step [s], `error` against the reference (rad/s, or relative), largest deviations of energy, linear
    and angular momentum from the start, each over its size there."""

    step: float
    error: float
    energy: float
    linear: float
    angular: float
    status: str


def fly(scene: Scene, duration: float, step: float, integrator: Any, rows: int = ROWS) -> History:
    """The flight, on the device or on the host as the integrator has it."""
    steps = int(round(duration / step))
    every = max(n for n in range(1, max(steps // rows, 1) + 1) if steps % n == 0)  # the last step is saved
    runner = run_check if isinstance(integrator, CHECK_INTEGRATORS) else run
    return runner(scene, duration, step=step, integrator=integrator, save_every=every, progress=False)


def momenta(history: History, name: str) -> tuple[Array, Array]:
    """Linear (T, 3) [kg m/s] and angular momentum (T, 3) [N m s] about the world's origin, of the body called
    `name`."""
    body: Any = history.scene.body(name)  # pyright: ignore[reportAttributeAccessIssue]
    motion = history.bodies[name]
    terms = body.reduced.inertia_terms if body.mode_count and body.level != "constant" else None
    linear, angular = [], []
    for i in range(len(history.time)):
        A = rot.matrix(motion.rotation[i])
        arm = A @ body.center_of_mass
        mv = body.mass * (motion.velocity[i] + np.cross(motion.angular_velocity[i], arm))
        w = A.T @ motion.angular_velocity[i]
        L = body.inertia @ w
        if terms is not None:
            L = momentum(terms, body.inertia, motion.modal[i], motion.modal_velocity[i], w, body.level)
        linear.append(mv)
        angular.append(np.cross(motion.position[i] + arm, mv) + A @ L)
    return np.array(linear), np.array(angular)


def deviations(history: History, name: str) -> tuple[float, float, float]:
    """Largest deviation of energy, linear and angular momentum from the start, over their sizes there (of a body that
    does not move along: of its angular momentum per metre)."""
    energy = history.energy["kinetic"] + history.energy["strain"] + history.energy["potential"]
    found = [float(np.abs(energy / energy[0] - 1.0).max())]
    linear, angular = momenta(history, name)
    sizes = np.linalg.norm(linear[0]), np.linalg.norm(angular[0])
    for value, size in zip((linear, angular), (sizes[0] or sizes[1], sizes[1]), strict=True):
        found.append(float(np.linalg.norm(value - value[0], axis=1).max() / size))
    return found[0], found[1], found[2]


def rigid_flight(integrator: Any, step: float) -> Flight:
    """Case D4 for 10 s; the error is the largest of the components of omega(10 s) [rad/s]."""
    scene = Scene()
    scene.add_rigid_body(1.0, MOMENTS, name="body", angular_velocity=SPIN)
    history = fly(scene, 10.0, step, integrator)
    motion = history.bodies["body"]
    omega = rot.matrix(motion.rotation[-1]).T @ motion.angular_velocity[-1]
    return Flight(step, float(np.abs(omega - AFTER_TEN).max()), *deviations(history, "body"), history.status)


def ring() -> ReducedBody:
    """A rubber ring, 0.1 m across, of 12 curved quadratic cells; its first 8 vibration modes."""
    mesh = roller(0.05, 0.042, 0.02, sectors=12, layers=1, axial=1, order=2)
    return reduce(mesh, RUBBER, modes=8, options=ReductionOptions(periodic=False), cache=False, progress=False)


def ring_scene(body: ReducedBody, level: str = "full") -> Scene:
    """The ring in flight, without damping."""
    scene = Scene()
    scene.add_body(
        body, name="ring", position=(0.1, 0.2, 0.3), velocity=RING_SPEED, angular_velocity=RING_SPIN, damping=0.0,
        inertia=level,
    )  # fmt: skip
    return scene


def ring_flight(body: ReducedBody, integrator: Any, step: float, reference: History, level: str = "full") -> Flight:
    """The ring against the `reference` at its end: the error is that of the modes over their largest coordinate, or of
    the orientation [rad], whichever is larger."""
    history = fly(ring_scene(body, level), float(reference.time[-1]), step, integrator)
    motion, exact = history.bodies["ring"], reference.bodies["ring"]
    modal = np.linalg.norm(motion.modal[-1] - exact.modal[-1]) / np.abs(exact.modal).max()
    turn = rot.matrix(motion.rotation[-1]) - rot.matrix(exact.rotation[-1])
    return Flight(
        step, float(max(modal, np.linalg.norm(turn) / np.sqrt(2.0))), *deviations(history, "ring"), history.status
    )  # fmt: skip


def orders(flights: list[Flight], what: str = "error") -> Array:
    """Observed order of a field of `flights` from each one to the next."""
    h = np.array([f.step for f in flights])
    e = np.array([getattr(f, what) for f in flights])
    return np.log(e[1:] / e[:-1]) / np.log(h[1:] / h[:-1])


def _table(head: list[str], rows: list[list[str]]) -> str:
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, ["---"] * len(head), *rows]) + "\n"


def _flight_rows(name: str, flights: list[Flight]) -> list[list[str]]:
    found = ["", *(f"{order:.2f}" for order in orders(flights))]
    return [
        [name, f"{f.step:g}", f"{f.error:.2e}", order, f"{f.energy:.1e}", f"{f.linear:.1e}", f"{f.angular:.1e}"]
        for f, order in zip(flights, found, strict=True)
    ]


STEPPERS = {
    "generalized-alpha 0.8": GeneralizedAlpha(0.8),
    "HHT -0.1": HHT(-0.1),
    "HHT -0.3": HHT(-0.3),
    "Newmark": Newmark(),
}
CHECKS = {"energy-momentum": EnergyMomentum(), "Runge-Kutta 4": RungeKutta4()}


def compute() -> dict[str, Any]:
    """Rows of the three tables, and the figures of the ring that the text states."""
    rigid: list[list[str]] = []
    for name, integrator in STEPPERS.items():
        rigid += _flight_rows(
            name, [rigid_flight(integrator, h) for h in (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4, 1e-5)]
        )
    for name, integrator in CHECKS.items():
        steps = (4e-3, 2e-3, 1e-3) if name == "energy-momentum" else (4e-2, 2e-2, 1e-2)
        rigid += _flight_rows(name, [rigid_flight(integrator, h) for h in steps])
    body = ring()
    reference = fly(ring_scene(body), RING_TIME, 1e-5, RungeKutta4())
    flexible: list[list[str]] = []
    for name, integrator in STEPPERS.items():
        flexible += _flight_rows(name, [ring_flight(body, integrator, h, reference) for h in RING_STEPS])
    flexible += _flight_rows(
        "energy-momentum", [ring_flight(body, EnergyMomentum(), h, reference) for h in (1e-3, *RING_STEPS)]
    )
    flexible += _flight_rows(
        "Runge-Kutta 4", [ring_flight(body, RungeKutta4(), h, reference) for h in (4e-4, 2e-4, 1e-4)]
    )  # fmt: skip
    oscillator = []
    for name, integrator in STEPPERS.items():
        e = errors(integrator.coefficients, [500, 1000, 2000])
        shown = ", ".join(f"{z.real:.3f}" for z in roots_at_infinity(integrator.coefficients))
        oscillator.append([name, shown, f"{e[-1]:.2e}", f"{np.log2(e[-2] / e[-1]):.3f}"])
    bend = np.abs(body.surface.modes.transpose(1, 2, 0) @ reference.bodies["ring"].modal.T)
    return {
        "rigid": rigid, "flexible": flexible, "oscillator": oscillator, "frequencies": body.frequencies,
        "bend": float(bend.max()),
    }  # fmt: skip


def page(found: dict[str, Any]) -> str:
    """The page of the study."""
    head = ["integrator", "step [s]", "error", "order", "energy", "linear momentum", "angular momentum"]
    low, high = found["frequencies"][[0, -1]]
    return f"""# Free flight

**Rigid body about its unstable axis**: I = (1, 2, 3) kg m2, omega = (0.001, 5, 0.001) rad/s. Error of omega(10 s)
[rad/s] compared with elliptic functions; energy and momenta: largest deviation over the flight, relative. The motion
amplifies what an integrator leaves: below a few 1e-6 rad/s the error is that of the Newton tolerance and of round-off,
not of the method, as the deviations of energy and momentum show, which go on with order 2.

{_table(head, found["rigid"])}
**Soft ring, tumbling**: rubber, {len(found["frequencies"])} modes from {low:.0f} to {high:.0f} Hz,
{np.linalg.norm(RING_SPIN):.0f} rad/s, inertia "full", points moving by up to {1e3 * found["bend"]:.1f} mm. Error after
{RING_TIME:g} s, of the modes (over the largest coordinate) or of the orientation [rad], compared with Runge-Kutta with
a step of 1e-5 s: other equations in other code.

{_table(head, found["flexible"])}
**Oscillator**, damping ratio 5 %, after 10 rad: error with 2000 steps, order from 1000 to 2000; roots of the undamped
one at infinite frequency, the first that of the recursion between accelerations.

{_table(["integrator", "roots at infinity", "error", "order"], found["oscillator"])}"""
