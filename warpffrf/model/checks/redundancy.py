"""The constraints of a scene on the host: values, Jacobian, and which of them are redundant.

**Jacobian.** A row exerts the wrench (f, t) at x_b on the second body and its opposite on the first (`joints.rows`), so
a body with origin r has the entries f (translation), (x_b - r) x f + t (rotation vector) and, where its marker X is
on a flexible interface that moves by (u, theta) = Phi^T q about its point X_if, Phi (A^T f, A^T ((x_b - x_marker) x f +
t) + (X - X_if) x A^T f), without terms linear in theta. Columns and rows are made comparable by a length L
of the scene: translations and modal coordinates are counted in L, rows that are lengths divided by it.

**Redundancy.** The rows of all joints are taken block by block, undriven joints in the order of adding, then the
driven rows: first driven distances, then drives. From each block the part in the span of the rows kept so far is
projected out; a column-pivoted QR factorisation of the remainder gives its rank and the rows that define it. The others
are
redundant: the motion satisfies them anyway. They are omitted from the equations, so their multipliers are zero; another
choice would share the same total load differently. Which joint of a loop is named depends on the order of adding. A
*driven* row that is found redundant is a contradiction, or superfluous: the joints already fix what it prescribes.

**Singular poses.** At a dead centre or in a flat loop, rows depend on each other that are independent elsewhere and
must be kept. The rank is therefore also taken at two poses nearby: a step along a random combination of free motions
(fixed seed), corrected by Gauss-Newton until the joints close. The largest rank decides. Redundancy still depends on
the pose; a run measures at its saved steps how well the omitted rows are satisfied (`online.joint_motion`).

Consistency. Initial conditions of a scene: initial velocities and prescribed motions agree with the joints, all bodies
have mass.

A joint requires C V = 0 of the initial velocities V of the bodies, a drive C V = s'(0), with C the Jacobian of
`redundancy`. The residual is compared with the largest possible relative speed of the joint's points, the largest speed
of a body's origin plus its angular speed times the scene's length. Of the joint coordinates only those with a
prescribed *position* can disagree at the initial pose: joints are built from it, and a prescribed velocity counts from
it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import qr

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import GROUND_INDEX
from warpffrf.model.errors import InputError
from warpffrf.model.joints import Drive, Joint, Marker, Row
from warpffrf.model.joints.base import coincident_within, gradient, value
from warpffrf.model.released import RowKey

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

RANK_TOLERANCE = 1e-6  # of the longest row; its square, the residual of elimination, stays above round-off of pivots
NEARBY = 0.03  # rad, or of L: how far poses are moved to separate a singular pose from a redundancy
NEARBY_POSES = 2
CLOSED = 1e-10  # of L and rad: defect of a pose that Gauss-Newton has closed; it converges quadratically
CLOSING_STEPS = 12
ROUND_OFF_ARM = 1e-9  # of a body's radius of gyration: arms below are round-off of coordinates, no length of a scene


@dataclass(frozen=True, eq=False)
class ConstraintRow:
    """A row that a joint or drive constrains: owner's name, function, markers, and the value at the initial pose."""

    owner: str
    joint: Joint
    row: Row
    markers: tuple[Marker, Marker]
    initial: float
    drive: Drive | None

    @property
    def key(self) -> RowKey:
        """Its owner and function, which no other row of its scene has."""
        return self.owner, self.row

    @property
    def owners(self) -> set[str]:
        """Names of its joint and its drive."""
        return {self.owner, str(self.joint.name), *([str(self.drive.name)] if self.drive is not None else [])}

    @property
    def label(self) -> str:
        """The constrained motion, for messages."""
        return f"{self.owner!r}: {self.row.held}"


@dataclass(frozen=True)
class Redundancy:
    """Rows of a scene in the order of `constraint_rows`, which of them are kept, the rank, and the rank at the initial
    pose itself (smaller in a singular one)."""

    rows: tuple[ConstraintRow, ...]
    kept: tuple[bool, ...]
    rank: int
    rank_here: int

    @property
    def holding(self) -> frozenset[RowKey]:
        return frozenset(row.key for row, kept in zip(self.rows, self.kept, strict=True) if kept)

    @property
    def dropped(self) -> list[ConstraintRow]:
        return [row for row, kept in zip(self.rows, self.kept, strict=True) if not kept]

    def counts(self) -> dict[str, int]:
        """Number of redundant rows of each joint or drive that has some."""
        found: dict[str, int] = {}
        for row in self.dropped:
            found[row.owner] = found.get(row.owner, 0) + 1
        return found


def undetermined(scene: Scene, found: Redundancy) -> list[str]:
    """Owners of rows whose reactions the constraints do not determine, in the order of adding.

    An omitted row J_d = c J_kept takes any share mu of the load from the kept rows, lambda - c mu: the reactions of d
    and of all rows with c != 0 follow from the choice mu = 0 alone.
    """
    if not found.dropped:
        return []
    J, kept = constraint_jacobian(scene, list(found.rows))[0], np.array(found.kept)
    shares = np.linalg.lstsq(J[kept].T, J[~kept].T, rcond=None)[0]
    concerned = ~kept
    concerned[kept] = np.abs(shares).max(axis=1, initial=0.0) > RANK_TOLERANCE
    return list(dict.fromkeys(row.owner for row, one in zip(found.rows, concerned, strict=True) if one))


@dataclass
class Pose:
    """Positions (b, 3) and axes (b, 3, 3) of the user frames, and the modal coordinates of each body."""

    position: np.ndarray
    axes: np.ndarray
    modal: list[np.ndarray]


def initial_pose(scene: Scene) -> Pose:
    """The bodies as they are placed, undeformed."""
    return Pose(
        np.array([b.position for b in scene.bodies]).reshape(-1, 3),
        np.array([rot.matrix(b.rotation) for b in scene.bodies]).reshape(-1, 3, 3),
        [np.zeros(b.mode_count) for b in scene.bodies],
    )


def constraint_rows(scene: Scene) -> list[ConstraintRow]:
    """The rows of `all_rows` that hold."""
    return [item for item in all_rows(scene) if not item.owners & scene.released.names]


def all_rows(scene: Scene) -> list[ConstraintRow]:
    """All rows: joints in the order of adding, those of drives after the joints; a drive of a function that its joint
    constrains (a distance) replaces that row."""
    rows: list[ConstraintRow] = []
    frames = {id(joint): joint.frames() for joint in scene.joints}
    taken = {(id(d.joint), d.row): d for d in scene.drives if d.row in d.joint.rows}
    for joint in scene.joints:
        for row in joint.rows:
            drive = taken.get((id(joint), row))
            rows.append(ConstraintRow(str(joint.name), joint, row, frames[id(joint)], joint.initial_value(row), drive))
    for drive in scene.drives:
        if drive.row not in drive.joint.rows:
            initial = drive.joint.initial_value(drive.row)
            owner = drive.name or f"drive of {drive.joint.name}"
            rows.append(ConstraintRow(owner, drive.joint, drive.row, frames[id(drive.joint)], initial, drive))
    return rows


def marker_pose(scene: Scene, pose: Pose, port: Any, marker: Marker) -> tuple[np.ndarray, np.ndarray]:
    """World position (3,) and axes (3, 3) of a marker."""
    index = port.body.index
    X, axes = marker.point, rot.matrix(marker.rotation)
    if index == GROUND_INDEX:
        return X, axes
    if port.interface_name is not None and len(pose.modal[index]):
        interface = port.body.reduced.interfaces[port.interface_name]
        motion = pose.modal[index] @ interface.modes
        X = X + motion[:3] + np.cross(motion[3:], X - interface.point)
        axes = rot.rotation_vector_matrix(motion[3:]) @ axes
    return pose.position[index] + pose.axes[index] @ X, pose.axes[index] @ axes


def scene_length(scene: Scene) -> float:
    """A length [m] of the scene: the largest distance of a joint from a body that it connects; where all are zero, or
    round-off, the largest radius of gyration, and 1 m of bodies without any."""
    arms = [np.linalg.norm(m.point) for joint in scene.joints for m in joint.frames()]
    arms += [np.linalg.norm(body.center_of_mass) for body in scene.bodies]
    longest = float(max(arms, default=0.0))
    size = max(
        (float(np.sqrt(max(0.5 * np.trace(b.inertia), 0.0) / b.mass)) for b in scene.bodies if b.mass > 0.0),
        default=0.0,
    )
    if longest > ROUND_OFF_ARM * size:
        return longest
    return size if size > 0.0 else 1.0


def constraint_jacobian(
    scene: Scene, rows: list[ConstraintRow], pose: Pose | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Jacobian (rows, unknowns), scaled as in the module docstring, the values (rows,) relative to the initial ones,
    scaled likewise, and the factors (unknowns,) from scaled to plain unknowns.

    Unknowns, body by body: translation of the user origin, rotation vector (world axes), modal coordinates.
    """
    pose = pose or initial_pose(scene)
    L = scene_length(scene)
    starts = np.cumsum([0] + [6 + body.mode_count for body in scene.bodies])
    shapes = [i.modes for b in scene.bodies if b.reduced is not None for i in b.reduced.interfaces.values()]
    largest = max((float(np.abs(m).max()) for m in shapes if m.size), default=0.0)
    factor = np.ones(starts[-1])
    for body, start in zip(scene.bodies, starts, strict=False):
        factor[start : start + 3] = L
        factor[start + 6 : start + 6 + body.mode_count] = L / largest if largest > 0.0 else 1.0
    J, values = np.zeros((len(rows), starts[-1])), np.zeros(len(rows))
    for n, item in enumerate(rows):
        ports = item.joint.ports
        (x_a, A_a), (x_b, A_b) = (marker_pose(scene, pose, p, m) for p, m in zip(ports, item.markers, strict=True))
        scale = 1.0 / L if item.row.is_length else 1.0
        values[n] = scale * (float(value(item.row, x_a, A_a, x_b, A_b)) - item.initial)
        f, t = gradient(item.row, x_a, A_a, x_b, A_b)
        for sign, x, port, marker in zip((-1.0, 1.0), (x_a, x_b), ports, item.markers, strict=True):
            b = port.body.index
            if b == GROUND_INDEX:
                continue
            A, at = pose.axes[b], starts[b]
            J[n, at : at + 3] += sign * scale * f
            J[n, at + 3 : at + 6] += sign * scale * (np.cross(x_b - pose.position[b], f) + t)
            if port.interface_name is not None and port.body.mode_count:
                interface = port.body.reduced.interfaces[port.interface_name]
                torque = A.T @ (np.cross(x_b - x, f) + t) + np.cross(marker.point - interface.point, A.T @ f)
                J[n, at + 6 : starts[b + 1]] += sign * scale * (interface.modes @ np.concatenate([A.T @ f, torque]))
    return J * factor, values, factor


def held_motions(scene: Scene) -> np.ndarray:
    """Rigid motions that joints and drives constrain (rows, 6 bodies): translations of the user origins, and rotations
    scaled by `scene_length`."""
    starts = np.cumsum([0] + [6 + body.mode_count for body in scene.bodies])[:-1]
    J, _, factor = constraint_jacobian(scene, constraint_rows(scene))
    L = scene_length(scene)
    return np.hstack([(J / factor)[:, s : s + 6] * np.repeat([1.0, 1.0 / L], 3) for s in starts])


def find_redundancy(scene: Scene) -> Redundancy:
    """Redundant rows of the scene's joints and drives; see the module."""
    rows = constraint_rows(scene)
    if not rows:
        return Redundancy((), (), 0, 0)
    J, _, _ = constraint_jacobian(scene, rows)
    kept = _independent(rows, J)
    here = best = int(np.sum(kept))
    if here < len(rows):
        for pose in _nearby(scene, rows):
            found = _independent(rows, constraint_jacobian(scene, rows, pose)[0])
            if np.sum(found) > best:
                kept, best = found, int(np.sum(found))
    return Redundancy(tuple(rows), tuple(bool(k) for k in kept), best, here)


def _independent(rows: list[ConstraintRow], J: np.ndarray) -> np.ndarray:
    """Rows (n,) bool that are kept."""
    blocks: dict[tuple[int, str], list[int]] = {}
    for n, item in enumerate(rows):
        rank = 0 if item.drive is None else 1 if item.row in item.joint.rows else 2
        blocks.setdefault((rank, item.owner), []).append(n)
    kept = np.zeros(len(rows), dtype=bool)
    basis = np.zeros((J.shape[1], 0))
    tolerance = RANK_TOLERANCE * float(np.linalg.norm(J, axis=1).max(initial=0.0))
    for _, members in sorted(blocks.items(), key=lambda item: item[0][0]):
        rest = J[members].T
        for _ in range(2):  # twice: the first projection leaves round-off
            rest = rest - basis @ (basis.T @ rest)
        factors: Any = qr(rest, mode="economic", pivoting=True)
        Q, R, order = factors
        rank = int(np.sum(np.abs(np.diag(R)) > tolerance))
        kept[[members[i] for i in order[:rank]]] = True
        basis = np.hstack([basis, Q[:, :rank]])
    return kept


def _nearby(scene: Scene, rows: list[ConstraintRow]) -> list[Pose]:
    """Poses near the initial one in which all undriven rows hold; fewer than `NEARBY_POSES` where none is found."""
    held = [row for row in rows if row.drive is None]
    if not held:
        return []
    J, _, factor = constraint_jacobian(scene, held)
    _, s, Vt = np.linalg.svd(J)
    rank = int(np.sum(s > RANK_TOLERANCE * max(s[0], 1e-300)))
    free = Vt[rank:]
    if not len(free):
        return []
    random = np.random.default_rng(0)
    poses = []
    for _ in range(NEARBY_POSES):
        step = random.standard_normal(len(free)) @ free
        pose = _moved(initial_pose(scene), NEARBY * step / np.abs(step).max() * factor)
        for _ in range(CLOSING_STEPS):
            J, c, _ = constraint_jacobian(scene, held, pose)
            if np.abs(c).max() < CLOSED:
                poses.append(pose)
                break
            pose = _moved(pose, -np.linalg.lstsq(J, c, rcond=RANK_TOLERANCE)[0] * factor)
    return poses


def _moved(pose: Pose, change: np.ndarray) -> Pose:
    """A pose moved by plain unknowns (see `constraint_jacobian`)."""
    position, axes, modal = pose.position.copy(), pose.axes.copy(), []
    at = 0
    for b, q in enumerate(pose.modal):
        position[b] += change[at : at + 3]
        axes[b] = rot.rotation_vector_matrix(change[at + 3 : at + 6]) @ axes[b]
        modal.append(q + change[at + 6 : at + 6 + len(q)])
        at += 6 + len(q)
    return Pose(position, axes, modal)


TYPED = 1e-5  # of the largest velocity: rounding of velocities typed with six digits
NO_INERTIA = 1e-14  # of the largest principal moment: round-off of a moment that is zero
SAME_ANGLE = 1e-6  # rad: rounding of a typed angle, as `coincident_within` of a typed length


@dataclass(frozen=True)
class VelocityDefect:
    """Residual of a joint or drive under the initial velocities: `translation` [m/s] and `rotation` [rad/s]; `driven`
    where a drive prescribes the motion."""

    owner: str
    translation: float
    rotation: float
    driven: bool

    def __str__(self) -> str:
        parts = [
            f"{value:.3g} {unit}" for value, unit in ((self.translation, "m/s"), (self.rotation, "rad/s")) if value
        ]
        return f"{'drive' if self.driven else 'joint'} {self.owner!r} by {' and '.join(parts)}"


def velocity_defects(scene: Scene) -> list[VelocityDefect]:
    """Joints and drives whose motion the initial velocities contradict by more than `TYPED`, in the order of adding;
    modes are at rest."""
    rows = constraint_rows(scene)
    if not rows:
        return []
    J, _, factor = constraint_jacobian(scene, rows)
    L = scene_length(scene)
    velocity = np.concatenate(
        [np.concatenate([b.velocity, b.angular_velocity, np.zeros(b.mode_count)]) for b in scene.bodies]
    )
    prescribed = np.array([_rate(row) for row in rows])
    lengths = np.array([row.row.is_length for row in rows])
    left = (J @ (velocity / factor)) * np.where(lengths, L, 1.0) - prescribed
    turning = max((float(np.linalg.norm(b.angular_velocity)) for b in scene.bodies), default=0.0)
    moving = max((float(np.linalg.norm(b.velocity)) for b in scene.bodies), default=0.0)
    asked = np.abs(prescribed / np.where(lengths, L, 1.0)).max()
    scale = max(moving / L + turning, asked)  # 1/s
    found: dict[tuple[str, bool], list[float]] = {}
    for row, is_length, rate in zip(rows, lengths, left, strict=True):
        if abs(rate) > TYPED * scale * (L if is_length else 1.0):
            driven = row.drive is not None
            parts = found.setdefault((_owner(row), driven), [0.0, 0.0])
            parts[0 if is_length else 1] = float(np.hypot(parts[0 if is_length else 1], rate))
    return [VelocityDefect(owner, parts[0], parts[1], driven) for (owner, driven), parts in found.items()]


def refuse_velocities(scene: Scene) -> None:
    """Raises `InputError` with the residual of each joint that the initial velocities contradict.

    Drives are not checked: they prescribe the velocity, and a body at rest follows from the first instant.
    """
    found = [str(defect) for defect in velocity_defects(scene) if not defect.driven]
    if found:
        raise InputError(
            "simulate: the initial velocities of the bodies do not agree with the joints: they violate "
            f"{', '.join(found)}; give velocities that fit (a body rotating about a joint moves with omega x arm), or "
            "project_start=True to change them as little as possible"
        )


def refuse_singular_mass(scene: Scene) -> None:
    """Raises `InputError` for a body without a finite acceleration: no mass, or no inertia about some
    axis, as that of a reduced body whose nodes lie on one line."""
    for body in scene.bodies:
        moments = np.linalg.eigvalsh(body.inertia)
        if not (body.mass > 0.0 and moments[0] > NO_INERTIA * moments[-1] > 0.0):
            raise InputError(
                f"body {body.name!r}: its mass matrix is singular (mass {body.mass:.3g} kg, principal moments "
                f"{', '.join(f'{m:.3g}' for m in moments)} kg m2): a body needs mass, off any one line; check its "
                "density, or the mass matrix it was made from"
            )


def refuse_positions(scene: Scene) -> None:
    """Raises `InputError` where a drive prescribes a position at t = 0 other than that of its joint."""
    for drive in scene.drives:
        if drive.quantity != "position":
            continue
        asked, there = float(drive.signal(0.0)), drive.joint.initial_value(drive.row)
        is_length = drive.row.is_length
        off = asked - there if is_length else float(np.angle(np.exp(1j * (asked - there))))
        if abs(off) > (coincident_within(*drive.joint.ports) if is_length else SAME_ANGLE):
            unit = "m" if is_length else "rad"
            raise InputError(
                f"drive {drive.name!r}: it prescribes {drive.coordinate} = {asked:.6g} {unit} at t = 0, but joint "
                f"{drive.joint.name!r} stands at {there:.6g} {unit} there; let the signal begin at that value, move "
                "the bodies, or start='equilibrium'"
            )


def _owner(row: ConstraintRow) -> str:
    return str(row.drive.name) if row.drive is not None and row.drive.name else row.owner


def _rate(row: ConstraintRow) -> float:
    """Prescribed rate of a row at t = 0 [m/s or rad/s]."""
    if row.drive is None:
        return 0.0
    if row.drive.quantity == "velocity":
        return float(row.drive.signal(0.0))
    breaks, c = row.drive.signal.polynomial()
    if breaks[0] > 0.0:  # held until then
        return 0.0
    piece = int(np.clip(np.searchsorted(breaks, 0.0, side="right") - 1, 0, len(c) - 1))
    return float(np.polynomial.Polynomial(c[piece]).deriv()(0.0 - breaks[piece]))
