"""Small-sliding contacts of the engine in motion: joints that spin in free flight, and joints that ring down.

Part of `studies.small_sliding.acceptance`. A pair of blocks that a spring holds together flies and rotates about an
axis of no symmetry: no external load acts on it, so that momentum is conserved, and the same pair rotated as a whole
has the same forces, rotated. A mass on a spring at the end of the bar of `cases` vibrates with a few per cent of
damping by the slip of the bar. Over a cycle the force F of the spring falls by pi 2 zeta, 2 zeta = D/(2 pi U) with the
loss D and the energy U = F x/2 of the loop that load steps follow between the same forces (derived in
tests/demos/lap_loops.py); the displacement of the mass falls faster, by secant over tangent of a joint that gets
softer.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from studies.small_sliding.cases import BAR, BLOCK, CLAMPED, HIGH, WEIGHTLESS, bar, block, pulled
from studies.small_sliding.rows import Row, completed, cycle, loads, static
from warpffrf.model import forces, joints, rotation, sensors, signals
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online.stages import Stage
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

Array = np.ndarray

# --- free flight

SPUN = np.array([30.0, 20.0, -25.0])  # rad/s
FLOWN = np.array([1.0, -2.0, 0.5])  # m/s
DRAWN = 2e4  # N, by which the spring draws the blocks together
TURN = rotation.quaternion(rotation.matrix(np.array([0.3, -0.4, 0.5, np.sqrt(0.5)])))


def flying(turn: Array | None = None) -> Scene:
    """The pair, all of it rotated by the quaternion `turn`."""
    A = np.eye(3) if turn is None else rotation.matrix(turn)
    q = np.array([0.0, 0.0, 0.0, 1.0]) if turn is None else turn
    scene = Scene(gravity=WEIGHTLESS)
    half = 0.5 * BLOCK[2]
    ports = []
    for name, joint, head, z in (("low", "z_max", "z_min", -half), ("high", "z_min", "z_max", half)):
        place = A @ np.array([0.0, 0.0, z])
        body = scene.add_body(
            block((3, 3, 2), joint, head), name=name, position=place, rotation=q, angular_velocity=A @ SPUN,
            velocity=A @ (FLOWN + np.cross(SPUN, [0.0, 0.0, z])), damping=0.7,
        )  # fmt: skip
        ports.append(body)
    low, high = ports
    stiffness = 0.1 * CLAMPED
    scene.add(
        forces.SpringDamper(
            low["z_min"], high["z_max"], stiffness, free_length=2.0 * BLOCK[2] - DRAWN / stiffness
        )
    )  # fmt: skip
    scene.add(Contact(high["face"], low["face"], sliding="small", friction=0.2, name="joint"))
    return scene


def momenta(scene: Scene, found: Result) -> tuple[Array, Array]:
    """Momentum (T, 3) and angular momentum about the origin (T, 3) of rigid motion."""
    total, turning = 0.0, 0.0
    for body in scene.bodies:
        motion = found.history.bodies[body.name]
        A = np.stack([rotation.matrix(q) for q in motion.rotation])
        arm = A @ body.center_of_mass
        v = body.mass * (motion.velocity + np.cross(motion.angular_velocity, arm))
        spin = np.einsum("tij,jk,tlk,tl->ti", A, body.inertia, A, motion.angular_velocity)
        total = total + v
        turning = turning + np.cross(motion.position + arm, v) + spin
    return np.asarray(total), np.asarray(turning)


def flight_rows(steps: int = 200) -> list[Row]:
    """Two milliseconds of flight, straight and rotated; the spring acts from the start, and the first half passes
    by."""
    found = []
    for turn in (None, TURN):
        scene = flying(turn)
        found.append((scene, completed(simulate(scene, steps * 1e-5, step=1e-5, progress=False))))
    scene, first = found[0]
    lap, turned = first.contact("joint"), found[1][1].contact("joint")
    push = np.abs(lap.normal_force).max()
    P, L = momenta(scene, first)
    A = rotation.matrix(TURN)
    case, cells = "pair that flies and spins", f"{lap.cells}"
    off = np.abs(turned.force - lap.force @ A.T).max() / push
    return [
        Row(case, cells, "cells that slip", "", 0.0, float(lap.counts[:, 2].max()), 0.0, relative=False),
        Row(case, cells, "momentum, over force times time", "", 0.0,
            float(np.abs(P - P[0]).max() / (push * first.time[-1])), 1e-12, relative=False),
        Row(case, cells, "angular momentum", "", 0.0,
            float(np.abs(L - L[-1])[steps // 2 :].max() / np.linalg.norm(L[-1])), 1e-5, relative=False),
        Row(case, cells, "forces of the rotated pair, over the clamp force", "", 0.0, float(off), 1e-9, relative=False),
    ]  # fmt: skip


# --- ring-down

SPRING, MASS = 1e7, 10.0  # N/m, kg
SWUNG = 30.0 * HIGH * BAR.resistance  # N, the force of the spring from which the mass swings


@cache
def ringing_bar() -> ReducedBody:
    """Coarser than the bar of the micro-slip rows."""
    return bar(0.5, 1.05, 1.0)


def swinging(force: signals.Table) -> Scene:
    """The bar, a spring at its end, a mass that `force` [N] pulls."""
    scene = pulled(ringing_bar(), signals.Table([0.0, 10.0], [0.0, 0.0]))
    mass = scene.add_rigid_body(MASS, (1.0, 1.0, 1.0), name="mass", position=(1.0, 0.0, 0.0))
    scene.add(joints.Prismatic(scene.ground, mass.at((0, 0, 0)), axis=(1, 0, 0), name="guide"))
    scene.add(forces.SpringDamper(scene.bodies[0]["x_max"], mass.at((0, 0, 0)), SPRING, name="spring"))
    scene.add(forces.PointForce(mass.at((0, 0, 0)), (force, 0.0, 0.0)))
    scene.add(sensors.Position(mass.at((0, 0, 0)), name="place"))
    return scene


def summits(x: Array) -> list[float]:
    """The first value, where the swing begins, and its largest ones, each the top of a parabola through three."""
    k = np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:])) + 1
    slope, bend = 0.5 * (x[k + 1] - x[k - 1]), x[k + 1] - 2.0 * x[k] + x[k - 1]
    return [float(x[0]), *(x[k] - 0.5 * slope**2 / bend)]


def ring_down_rows(cycles: int = 3, steps: int = 150) -> list[Row]:
    """Released from a static load; twice the damping ratio of each cycle against that of the static loop."""
    period = 2.0 * np.pi * np.sqrt(MASS / SPRING)
    pull = signals.Table([0.0, 1.0, 1.0 + 1e-9, 10.0], [0.0, SWUNG, 0.0, 0.0])
    scene = swinging(pull)
    stages = [
        Stage("pull", 1.0, 0.25, kind="static"), Stage("swing", (cycles + 0.5) * period, period / steps)
    ]  # fmt: skip
    found = completed(simulate(scene, stages, progress=False))
    stretch = (found.sensor("place").values - found.sensor("end").values)[:, 0]
    tops = summits(SPRING * (stretch - stretch[0])[found.time >= 1.0])
    rows = []
    path = cycle(2)
    for number, (begin, end) in enumerate(zip(tops[:-1], tops[1:], strict=True)):
        ratio, peak = begin / end, float(np.sqrt(begin * end))
        loop = static(swinging(loads(path, peak)), len(path) - 1)
        lost = loop.contact("low").loss + loop.contact("high").loss
        reach = loop.sensor("place").values[-1, 0] - 1.0
        damping = (lost[-1] - lost[2]) / (2.0 * np.pi * 0.5 * peak * reach)
        rows.append(
            Row("mass at the bar's end", f"{loop.contact('low').cells} on a face", f"2 zeta, cycle {number + 1}", "",
                float(damping), float(np.log(ratio) / np.pi), 0.05)
        )  # fmt: skip
    return rows
