"""Verification: rigid bodies, mechanisms and integrators."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from demos import cam_follower
from references.oscillator import errors
from scenes import hunting
from scenes import mechanisms as made
from studies.bodies.free_flight import AFTER_TEN, rigid_flight
from studies.hard_cases.cases import squeezer
from studies.validate.case import Row, case
from warpffrf.model.integrators import HHT, EnergyMomentum, GeneralizedAlpha, roots_at_infinity
from warpffrf.output.simulate import simulate

ROOM = "Mechanisms"


@case(ROOM, "Elliptic integral: T = 4 sqrt(l/g) K(1/2)")
def pendulum() -> Iterator[Row]:
    """D6: a pendulum of 1 m let go from the horizontal, 8,000 steps: where it is after 5/4 of the period"""
    history = made.completed(made.pendulum(), 1.25 * made.PERIOD, 8000, save_every=400)
    late = float(history.joints["pivot"].coordinate[-1] - 0.5 * np.pi) / np.sqrt(2.0 * made.GRAVITY)
    yield Row("period", made.PERIOD - late / 1.25, made.PERIOD, 1e-6, "s")


@case(ROOM, "Jacobi's elliptic functions; L. D. Landau and E. M. Lifshitz, Mechanics, section 37")
def free_rigid_body() -> Iterator[Row]:
    """D4: a free rigid body, I = (1, 2, 3) kg m², turns over about its unstable axis for 10 s, steps of 1 ms"""
    size = float(np.linalg.norm(AFTER_TEN))
    for integrator in (GeneralizedAlpha(0.8), EnergyMomentum()):
        flight = rigid_flight(integrator, 1e-3)
        name = type(integrator).__name__
        yield Row(f"ω(10 s) off by, {name}", flight.error, 0.0, 1e-4, "rad/s", size)
        yield Row(f"change of energy, {name}", flight.energy, 0.0, 2.5e-6, scale=1.0)
        yield Row(f"change of angular momentum, {name}", flight.angular, 0.0, 2.5e-6, scale=1.0)


@case(
    ROOM,
    "M. Géradin and A. Cardona, Flexible Multibody Dynamics (2001); values by the equations of rotation about the tip",
)
def heavy_top() -> Iterator[Row]:
    """D5: a top on a ball joint that spins at 150 rad/s, 64,000 steps"""
    history = made.completed(made.heavy_top(), 1.0, 64_000, save_every=6400)
    for axis, ours, theirs in zip("xyz", history.bodies["top"].position[-1], made.TOP_AFTER_ONE, strict=True):
        yield Row(f"{axis}(1 s)", ours, theirs, 2e-6, "m", 1.0)
    energy = history.energy["kinetic"][0] + history.energy["potential"][0]
    yield Row("energy", energy, made.TOP_ENERGY, 1e-7, "J")


@case(ROOM, "Kinematics: tan θ2 = tan θ1/cos δ")
def cardan_shaft() -> Iterator[Row]:
    """Two shafts at 0.6 rad with a universal joint and three redundant constraints, over two revolutions"""
    history = made.completed(made.cardan_shaft(), 0.7, 1400, rho_inf=0.6)
    theirs = made.cardan_angle(made.CARDAN_SPEED * history.time)
    apart = np.abs(history.joints["bearing_2"].coordinate - theirs)
    yield Row("angle of the second shaft off by", apart.max(), 0.0, 1e-8, "rad", 1.0)


@case(ROOM, "Kinematics of the slider-crank, and dT/dθ of its kinetic energy")
def slider_crank() -> Iterator[Row]:
    """A slider-crank of rigid bodies at 30 rad/s, one revolution, 800 steps"""
    history = made.completed(made.slider_crank(), 2.0 * np.pi / made.OMEGA, 800, rho_inf=0.6)
    theta = made.CRANK_START + made.OMEGA * history.time
    apart = history.joints["liner"].coordinate - (made.piston_place(theta) - made.piston_place(made.CRANK_START))
    yield Row("piston off by", np.abs(apart).max(), 0.0, 1e-9, "m", 1.0)
    torque, found = made.crank_torque(theta), -history.joints["axle"].torque[:, 1]
    yield Row("torque of the crank off by", np.abs(found - torque)[200:].max(), 0.0, 2e-3, "N m", np.abs(torque).max())


@case(ROOM, "W. Schiehlen, Multibody Systems Handbook (1990); IVP test set, problem Andrews' squeezing mechanism")
def squeezer_mechanism() -> Iterator[Row]:
    """P5: seven bodies, ten pins, a spring and a torque; steps of 4 µs"""
    result = simulate(squeezer.build(), squeezer.DURATION, step=4e-6, progress=False)
    for name, ours, theirs in zip(squeezer.NAMES, squeezer.angles_of(result)[-1], squeezer.END, strict=True):
        yield Row(f"{name}(0.03 s), over the crank's angle", ours, theirs, 1e-4, "rad", squeezer.END[0])


@case(ROOM, "H. M. Hilber, T. J. R. Hughes and R. L. Taylor, Earthq. Eng. Struct. Dyn. 5 (1977) 283")
def hht_integrator() -> Iterator[Row]:
    """D8: HHT with α = -0.3 on an oscillator: roots at infinite frequency, order between 1,000 and 2,000 steps"""
    integrator = HHT(-0.3)
    found: Any = np.sort(np.real(roots_at_infinity(integrator.coefficients)))
    for number, (ours, theirs) in enumerate(zip(found, (-0.538, -0.538, -0.429), strict=True), start=1):
        yield Row(f"root {number} at infinity", ours, theirs, 5e-4, scale=1.0)
    e = errors(integrator.coefficients, [1000, 2000])
    yield Row("order", float(np.log2(e[0] / e[1])), 2.0, 0.01, scale=1.0)


@case(
    ROOM, "law of the cam, 4-5-6-7; N cos(alpha) = m omega² s'' + k s + F_0 of a rigid follower, which is 0 at the jump"
)
def cam_and_roller_follower() -> Iterator[Row]:
    """An elastic roller on a rigid cam, the envelope of its positions; the jump by halving, within 0.25 %"""
    size = cam_follower.QUICK
    body = cam_follower.roller(size)
    mass = cam_follower.MASS + body.mass
    jump = cam_follower.jump_speed(mass)

    def turned(part: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Angles of the cam, lifts and forces of a revolution at this part of the jump speed."""
        result = cam_follower.run(body, part * jump, size, progress=False)
        if result.status != "completed":
            raise RuntimeError(result.message)
        height = result.body("follower").position[:, 2] - cam_follower.BASE - cam_follower.ROLLER
        return part * jump * result.time, height, np.linalg.norm(result.contact("valve").force, axis=1)

    angle, height, force = turned(1.0 / 3.0)
    for degrees in (140.0, 160.0, 180.0, 210.0):
        i = int(np.argmin(np.abs(angle - np.radians(degrees))))
        lift = 1e3 * cam_follower.lift(angle[i : i + 1])[0][0]
        yield Row(f"lift at {degrees:g}°", 1e3 * height[i], lift, 1e-3, "mm", 1e3 * cam_follower.LIFT)
        rigid = float(cam_follower.force(angle[i : i + 1], jump / 3.0, mass)[0])
        yield Row(f"contact force at {degrees:g}°, a third of the jump speed", force[i], rigid, 0.01, "N")
    angle, _, force = turned(0.98)
    rigid = float(cam_follower.force(angle, 0.98 * jump, mass).max())
    yield Row("largest contact force, 0.98 of the jump speed", float(force.max()), rigid, 0.01, "N")
    low, high = 0.98, 1.02
    while high - low > 0.005:
        middle = 0.5 * (low + high)
        if np.any(turned(middle)[2] == 0.0):
            high = middle
        else:
            low = middle
    yield Row("jump speed", 0.5 * (low + high) * jump, jump, 0.02, "rad/s")


@case(
    ROOM,
    "J. Klingel, Organ Fortschr. Eisenbahnwes. 38 (1883) 113; A. H. Wickens, Fundamentals of Rail Vehicle Dynamics",
)
def hunting_wheelset() -> Iterator[Row]:
    """A free wheelset of two cones, slope 1:20, on round rails, half-spaces, 100 kN, friction; rolling without slip"""
    found, (kappa, conicity, b, r) = hunting.hunting(), hunting.kinematics()
    yield Row("wavelength", found.wave, hunting.wavelength(), 0.005, "m")
    yield Row("roll per lateral displacement", found.roll, kappa, 0.005, "rad/m")
    yield Row("lateral speed per yaw", found.drift, found.speed / (1.0 + kappa * r), 0.005, "m/s")
    yield Row("yaw rate per lateral displacement", found.steer, -found.speed * conicity / (b * r), 0.005, "rad/(m s)")
