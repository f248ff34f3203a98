r"""Stiffness of a bearing about a state: derivative of the force and torque on the inner ring with respect to its pose.

The rings and the cage are fixed in the poses of the state, and the inner ring is displaced by +-h in each of six
directions, three translations and three rotations about the bearing's centre as fixed to that ring; the equilibrium of
every element is recomputed. A flexible ring is fixed at its interfaces, as by the joints to the ground in the scene,
and its deformation is also recomputed; then the other, rigid ring is displaced. With the constraint reaction R(x) of
the inner ring,

    K_ij = -(R_i(+h_j) - R_i(-h_j))/(2 h_j),

central differences of equilibria, of second order in h. Torques are about the centre that moves with the ring. K is
symmetric, because forces have a potential, except for rotations, which do not commute: an existing torque M leaves
entries of its size there. `asymmetry` measures the deviation as a check. Contact laws are those of the machine: the
Hertz stiffness is not updated at the displaced pose.

**At speed.** With the normal forces N_c of the saved step in lumped contact, at x_c, an element has the force and
torque

    F = -sum N_c,      M = -sum (x_c - x) x N_c,

which are its inertia, centrifugal and gyroscopic, the friction of rings and pockets that provides the gyroscopic
moment, gravity and other loads. They keep their values while the ring is displaced. Their change is neglected: of the
centrifugal force it is m w_c^2, a millionth of the stiffness of contacts, and what the contact angle changes of w_c, a
thousandth; `left_out` names friction and rolling resistance where they act. Elements in distributed contact are in
equilibrium under contact forces alone, and `left_out` names what else acts on them.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from warpffrf.model.bearings import Bearing
from warpffrf.model.bodies import GROUND_INDEX, Body, Ground
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.forces import PointForce, PointTorque
from warpffrf.model.joints import Fixed
from warpffrf.model.laws.lumped import HertzPoint, PowerForce
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.scene import Scene
from warpffrf.online import History, find_equilibrium

MOVE = 1e-3  # of the largest approach under load: far above the equilibrium tolerance, quadratic error 1e-6 of K
LEAST = 1e-9  # m
SOFTEST = 0.1  # smallest root of a diagonal entry for scaling, of the largest of its kind: zero about the axis
SIDES = ("inner", "outer")
BALANCED = 1e-6  # of the largest contact force, and times a diameter: what equilibria leave unbalanced is no load


@dataclass(frozen=True)
class BearingStiffness:
    """`matrix` (6, 6) N/m, N/rad, N m/m, N m/rad: derivative of the force and of the torque about the bearing's centre
    that displace the inner ring, with respect to its displacement and rotation against the outer ring, in the bearing's
    frame; symmetric part. `asymmetry`: largest difference of a pair of entries, scaled by the roots of the diagonal.
    `left_out`: effects on the elements in that state whose change is not in the stiffness, as text. `reason`: why both
    are NaN, if they are."""

    matrix: np.ndarray
    asymmetry: float
    left_out: tuple[str, ...] = ()
    reason: str = ""


def bearing_stiffness(scene: Scene, name: str, history: History, row: int = -1) -> BearingStiffness:
    """Stiffness of the bearing called `name` of a scene about a saved step; NaN, with the reason, if no element is
    loaded or an equilibrium is not found. Raises `InputError` for flexible rings that are not constrained by joints to
    the ground, and for two flexible rings."""
    bearing = scene.bearing(name)
    _refuse_rings(scene, bearing)
    both = history.lumped_contacts | history.contacts
    approach = max(float(both[contact.name].approach[row]) for contact in bearing.contacts.values())
    if approach <= 0.0:
        return _unknown("no element is loaded, so the stiffness is zero; load the bearing first")
    h = max(MOVE * approach, LEAST)
    arm = 0.5 * bearing.geometry.pitch_diameter
    steps = np.array([h] * 3 + [h / arm] * 3)
    columns = []
    for j, step in enumerate(steps):
        both = [_reaction(scene, name, history, row, sign * step * np.eye(6)[j]) for sign in (1.0, -1.0)]
        if failed := [answer for answer in both if isinstance(answer, str)]:
            return _unknown(failed[0])
        columns.append((both[0] - both[1]) / (2.0 * step))
    K = np.stack(columns, axis=1)
    size = np.sqrt(np.abs(np.diag(K)))
    size = np.maximum(size, SOFTEST * np.repeat([size[:3].max(), size[3:].max()], 3))
    asymmetry = float(np.abs((K - K.T) / np.outer(size, size)).max())
    return BearingStiffness(0.5 * (K + K.T), asymmetry, _left_out(scene, bearing, history, row))


def _unknown(why: str) -> BearingStiffness:
    return BearingStiffness(np.full((6, 6), np.nan), np.nan, reason=why)


def _left_out(scene: Scene, bearing: Bearing, history: History, row: int) -> tuple[str, ...]:
    """Effects on the elements at a saved step that the stiffness neglects."""
    loads = [port.body for load in scene.forces for port in load.ports]
    present = {
        "friction": any(contact.friction.acts for contact in bearing.contacts.values()),
        "rolling resistance": any(getattr(c, "rolling_resistance", None) for c in bearing.contacts.values()),
    }
    if any(isinstance(contact, Contact) for contact in bearing.contacts.values()):
        present |= {
            "gravity": bool(np.any(scene.gravity)),
            "forces on elements": any(body is element for body in loads for element in bearing.elements),
            "centrifugal forces": any(np.any(history.bodies[e.name].velocity[row]) for e in bearing.elements),
        }
    return tuple(what for what, acts in present.items() if acts)


def _reaction(scene: Scene, name: str, history: History, row: int, move: np.ndarray) -> Any:
    """Force and torque about the bearing's centre (6,) that displace the inner ring by `move` (6,), bearing's frame; or
    the message of an equilibrium that was not found."""
    alone = _alone(scene, name, history, row)
    bearing = alone.bearing(name)
    rest = scene.bearing(name).describe()["poses"]
    frame = _turned(bearing.outer, rest).apply(bearing.place.axes)
    lever = bearing.place.center - np.asarray(rest[bearing.inner.name]["position"])
    pivot = bearing.inner.position + _turned(bearing.inner, rest).apply(lever)
    turn = Rotation.from_rotvec(frame.T @ move[3:])
    moved, still = bearing.inner, bearing.outer
    if moved.index == GROUND_INDEX or moved.reduced is not None:
        moved, still, turn, move = still, moved, turn.inv(), -move
    shift = frame.T @ move[:3]
    moved.position = pivot + turn.apply(moved.position - pivot) + shift
    moved.rotation = (turn * Rotation.from_quat(moved.rotation)).as_quat()
    for body in (moved, still, *_carriers(bearing)):
        if body.index != GROUND_INDEX and body.reduced is None:
            at = body.position
            alone.add(Fixed(alone.ground.at(at), body.at((0.0, 0.0, 0.0)), name=f"hold {body.name}"))
    found = find_equilibrium(alone)
    if found.status != "completed":
        return found.message
    joint = found.joints[f"hold {moved.name}"]
    F = joint.force[-1]
    inner = moved is bearing.inner
    M = joint.torque[-1] + np.cross(moved.position - pivot - (shift if inner else 0.0), F)
    sign = 1.0 if inner else -1.0
    return sign * np.concatenate([frame @ F, frame @ M])


def _held_by(scene: Scene, ring: Body | Ground) -> list[Any]:
    """The joints between the interfaces of a flexible ring and the ground."""
    if ring.reduced is None:
        return []
    ends = {id(ring), id(scene.ground)}
    return [joint for joint in scene.joints if {id(port.body) for port in joint.ports} == ends]


def _refuse_rings(scene: Scene, bearing: Bearing) -> None:
    """Raises `InputError` for flexible rings that are not constrained, or two of them."""
    flexible = [ring for ring in (bearing.inner, bearing.outer) if ring.reduced is not None]
    if len(flexible) == 2:
        raise InputError(
            f"bearing {bearing.name!r}: stiffness: both rings are flexible, so neither moves as a rigid body; take a "
            "rigid ring for the one that is held stiffly"
        )
    for ring in flexible:
        if not _held_by(scene, ring):
            raise InputError(
                f"bearing {bearing.name!r}: stiffness: the flexible ring {ring.name!r} is held by no joint between one "
                "of its interfaces and the ground"
            )


def _carriers(bearing: Bearing) -> list[Body]:
    """What the walls of the cage belong to: its body, of a flexible one those on its interfaces."""
    return list(bearing.pockets.values()) or bearing.between[len(bearing.elements) :]


def _turned(body: Any, rest: dict[str, Any]) -> Rotation:
    """Rotation of a ring's body, at the pose of the saved step, since the initial one."""
    return Rotation.from_quat(body.rotation) * Rotation.from_quat(rest[body.name]["rotation"]).inv()


def _alone(scene: Scene, name: str, history: History, row: int) -> Scene:
    """The bearing alone, with parts at the poses of the saved step and the laws of the machine."""
    laws = {c.name: c.approach() for c in scene.bearing(name).contacts.values() if isinstance(c, LumpedContact)}
    shared = {id(body.reduced): body.reduced for body in scene.bodies if body.reduced is not None}
    alone = copy.deepcopy(scene, shared)
    bearing = alone.bearing(name)
    parts = [bearing.inner, bearing.outer, *_carriers(bearing), *bearing.elements]
    alone.gravity = np.zeros(3)
    alone.bodies = [body for body in alone.bodies if any(body is part for part in parts)]
    for i, body in enumerate(alone.bodies):
        body.index = i
        body.position, body.rotation = history.bodies[body.name].position[row], history.bodies[body.name].rotation[row]
        body.velocity, body.angular_velocity = np.zeros(3), np.zeros(3)
    holding = [joint for ring in (bearing.inner, bearing.outer) for joint in _held_by(alone, ring)]
    alone.joints = [*holding, *(joint for key, joint in bearing.joints.items() if key.startswith("pocket"))]
    alone.drives, alone.forces, alone.films, alone.sensors = [], [], [], []
    alone.contacts = [c for c in bearing.contacts.values() if isinstance(c, Contact)]
    for contact in alone.contacts:
        contact.friction = 0.0
    alone.lumped_contacts = [c for c in bearing.contacts.values() if isinstance(c, LumpedContact)]
    for contact in alone.lumped_contacts:
        contact.rolling_resistance, contact.spin = None, False
        if isinstance(contact.law, HertzPoint):
            law = laws[contact.name]
            contact.law = PowerForce(law.stiffness, law.exponent, shear=law.shear)
    if not alone.contacts:
        _add_loads(alone, bearing, history, row)
    return alone


def _add_loads(alone: Scene, bearing: Bearing, history: History, row: int) -> None:
    """Add to the elements what balances their normal forces at the saved step."""
    known = {contact.name: history.lumped_contacts[contact.name] for contact in alone.lumped_contacts}
    least = BALANCED * max(float(each.normal_force[row]) for each in known.values())
    for element in bearing.elements:
        force, torque = np.zeros(3), np.zeros(3)
        for contact in alone.lumped_contacts:
            if element not in (contact.a.body, contact.b.body):
                continue
            one = known[contact.name]
            normal = (one.friction_force[row] - one.force[row]) * (1.0 if contact.a.body is element else -1.0)
            force += normal
            torque += np.cross(one.place[row] - element.position, normal)
        if np.linalg.norm(force) > least:
            alone.add(PointForce(element, force, name=f"inertia and loads of {element.name}"))
        if np.linalg.norm(torque) > least * bearing.geometry.diameter:
            alone.add(PointTorque(element, torque, name=f"moments of {element.name}"))
