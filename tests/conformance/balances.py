"""What is left of the equations of motion and of the ledger of energies at the saved steps of a run, from the recorded
motion alone; and the same run as seen from elsewhere."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from random_scenes import Place
from scipy.spatial.transform import Rotation

from warpffrf.model.scene import Scene
from warpffrf.online.history.history import BodyHistory, History

ARM = 0.05  # m: torques of a contact are measured by its force at this distance
LEAST_FORCE, LEAST_TORQUE = 1e-2, 1e-3  # N, N m: of bodies of a kilogram that nothing acts on


def axes(motion: BodyHistory) -> np.ndarray:
    """(T, 3, 3)."""
    return Rotation.from_quat(motion.rotation).as_matrix()


def place(body: Any, point: np.ndarray, history: History) -> np.ndarray:
    """Where `point` (3,) of a body, or of the ground, is (T, 3)."""
    if body.name not in history.bodies:
        return np.tile(point, (len(history.time), 1))
    motion = history.bodies[body.name]
    return motion.position + axes(motion) @ point


@dataclass
class Wrench:
    """Sums of forces (T, 3) [N] and of torques about the centre of mass, and the largest of each that went in."""

    force: np.ndarray
    torque: np.ndarray
    size: float = 0.0
    turning: float = 0.0
    center: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def add(self, at: np.ndarray, force: np.ndarray, torque: np.ndarray) -> None:
        """A force at a place, and a torque."""
        torque = torque + np.cross(at - self.center, force)
        self.force, self.torque = self.force + force, self.torque + torque
        self.size = max(self.size, float(np.abs(force).max()))
        self.turning = max(self.turning, float(np.abs(torque).max()))


def wrenches(scene: Scene, history: History) -> dict[str, Wrench]:
    """What acts on each body but for its weight, of all joints, force elements and contacts with two opposite sides."""
    T = len(history.time)
    found = {
        b.name: Wrench(np.zeros((T, 3)), np.zeros((T, 3)), center=place(b, b.center_of_mass, history))
        for b in scene.bodies
    }
    none = Wrench(np.zeros((T, 3)), np.zeros((T, 3)))  # of the ground

    def on(ports: Any, at: np.ndarray, force: np.ndarray, torque: np.ndarray) -> None:
        """On the last of the ports, and the opposite on the first where there are two."""
        for port, sign in zip(reversed(ports), (1.0, -1.0), strict=False):
            found.get(port.body.name, none).add(at, sign * force, sign * torque)

    for joint in scene.joints:
        at = place(joint.b.body, joint.frames()[1].point, history)
        wrench = history.joints[str(joint.name)]
        on(joint.ports, at, wrench.force, wrench.torque)
    for item in scene.forces:
        wrench = history.forces[item.name]
        if hasattr(item, "law"):
            law = item.law()
            point = law.points[1] if law.joint is None else law.joint.frames()[1].point
            on(law.ports, place(law.ports[1].body, point, history), wrench.force, wrench.torque)
        elif hasattr(item, "slip") or hasattr(item, "tension"):
            joint = item.joint
            at = place(joint.b.body, joint.frames()[1].point, history)
            on(joint.ports, at, wrench.force, wrench.torque)
        else:
            on((item.port,), place(item.port.body, item.port.point, history), wrench.force, wrench.torque)
    for contact in scene.contacts:
        c, second = history.contacts[contact.name], contact.b
        on((second, contact.a), place(contact.a.body, np.zeros(3), history), c.force, c.torque)
    return found


def unbalanced(scene: Scene, history: History) -> tuple[float, float]:
    """Newton's and Euler's equations of all bodies: what is left of the largest force and torque in the scene."""
    left, size, twist, turning = 0.0, LEAST_FORCE, 0.0, LEAST_TORQUE
    all_wrenches = wrenches(scene, history)
    for body in scene.bodies:
        motion, acting = history.bodies[body.name], all_wrenches[body.name]
        A, omega, alpha = axes(motion), motion.angular_velocity, motion.angular_acceleration
        arm, J = A @ body.center_of_mass, A @ body.inertia @ A.transpose(0, 2, 1)
        inertial = body.mass * (motion.acceleration + np.cross(alpha, arm) + np.cross(omega, np.cross(omega, arm)))
        turned = np.cross(omega, np.einsum("tij,tj->ti", J, omega))
        momentum_rate = np.einsum("tij,tj->ti", J, alpha) + turned
        left = max(left, float(np.abs(inertial - body.mass * np.asarray(scene.gravity) - acting.force).max()))
        twist = max(twist, float(np.abs(momentum_rate - acting.torque).max()))
        size = max(size, acting.size, float(np.abs(inertial).max()))
        turning = max(turning, acting.turning, float(np.abs(turned).max()))
    return left / size, twist / turning


def sides(scene: Scene, history: History) -> tuple[float, float]:
    """Forces on both surfaces of a contact, each integrated on its own: what is left of the sum of the forces, and of
    the torques about the first body's origin, over the force and its torque at `ARM`."""
    contact = scene.contacts[0]
    c = history.contacts[contact.name]
    (a, b), size = (history.bodies[port.body.name].position for port in contact.ports), np.abs(c.force).max()
    torque = c.torque + c.torque_second + np.cross(b - a, c.force_second)
    return float(np.abs(c.force + c.force_second).max() / size), float(np.abs(torque).max() / (ARM * size))


def stored(scene: Scene, history: History) -> dict[str, np.ndarray]:
    """Energies (T,) [J] from the recorded motion: kinetic, strain of the modes, and potential."""
    kinetic, strain, potential = (np.zeros(len(history.time)) for _ in range(3))
    for body in scene.bodies:
        motion, center = history.bodies[body.name], place(body, body.center_of_mass, history)
        velocity = motion.velocity + np.cross(motion.angular_velocity, center - motion.position)
        w = np.einsum("tji,tj->ti", axes(motion), motion.angular_velocity)
        kinetic += 0.5 * body.mass * np.sum(velocity**2, axis=1) + 0.5 * np.einsum("ti,ij,tj->t", w, body.inertia, w)
        kinetic += 0.5 * np.sum(motion.modal_velocity**2, axis=1)
        if motion.modal.shape[1]:
            reduced: Any = body.reduced
            strain += 0.5 * np.sum((2.0 * np.pi * reduced.frequencies * motion.modal) ** 2, axis=1)
        potential -= body.mass * center @ np.asarray(scene.gravity)
    for item in scene.forces:
        if hasattr(item, "law"):
            law = item.law()
            c = history.forces[item.name].deformation
            c = c if law.expand is None else c @ np.linalg.pinv(law.expand).T
            change = (c - law.reference)[:, : law.sprung]
            K = law.stiffness[: law.sprung, : law.sprung]
            potential += 0.5 * np.einsum("ti,ij,tj->t", change, K, change) + change @ law.preload[: law.sprung]
            potential += sum(curve.energy(change[:, i]) for i, curve in enumerate(law.elastic[: law.sprung]) if curve)
    return {"kinetic": kinetic, "strain": strain, "potential": potential}


def missing(energy: dict[str, np.ndarray]) -> np.ndarray:
    """What is stored (T,) [J] beyond what the lines of the ledger account for."""
    held = sum(energy[name] - energy[name][0] for name in ("kinetic", "strain", "contact", "potential"))
    came = sum(energy[name] for name in ("force_work", "drive_work", "contact_grid", "numerical", "friction"))
    return np.asarray(held - came + energy["damping"])


def differences(here: History, there: History, at: Place) -> dict[str, float]:
    """The largest differences of a run and of the same one built at another place."""

    def turned(x: np.ndarray) -> np.ndarray:
        return x @ at.turn.T

    moved = at.shift + here.time[:, None] * at.drift
    pairs = [(motion, there.bodies[name]) for name, motion in here.bodies.items()]
    found = {
        "position": [turned(a.position) + moved - b.position for a, b in pairs],
        "rotation": [at.turn @ axes(a) - axes(b) for a, b in pairs],
        "velocity": [turned(a.velocity) + at.drift - b.velocity for a, b in pairs],
        "spin": [turned(a.angular_velocity) - b.angular_velocity for a, b in pairs],
        "modal": [a.modal - b.modal for a, b in pairs],
    }
    loads: list[np.ndarray] = []
    for kind in ("joints", "forces", "contacts"):
        for name, a in getattr(here, kind).items():
            b = getattr(there, kind)[name]
            largest = max(1.0, *(float(np.abs(x).max()) for x in (a.force, a.torque)))
            loads += [(turned(x) - y) / largest for x, y in ((a.force, b.force), (a.torque, b.torque))]
    found["load"] = loads
    found["pressure"] = [
        (c.pressure - there.contacts[name].pressure) / max(np.abs(c.pressure).max(), 1.0)
        for name, c in here.contacts.items()
    ]
    return {name: max((float(np.abs(x).max(initial=0.0)) for x in all_), default=0.0) for name, all_ in found.items()}
