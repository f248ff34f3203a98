"""Can a scene begin to move: do initial velocities and prescribed motions agree with the joints, have all bodies mass?

A joint asks for C V = 0 of the velocities V that the bodies are given, a drive for C V = s'(0), with C the Jacobian of
`redundancy`. What is left is judged against how fast the joint's points could move apart at most, the largest speed of
a body's origin plus its turning times the scene's length. Of the joint coordinates only those with a prescribed
*position* can disagree at the initial pose: joints are built from it, and a prescribed velocity counts from it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.checks.redundancy import ConstraintRow, constraint_jacobian, constraint_rows, scene_length
from warpffrf.model.errors import InputError
from warpffrf.model.joints.base import coincident_within

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

TYPED = 1e-5  # of the largest velocity: rounding of velocities typed with six digits
NO_INERTIA = 1e-14  # of the largest principal moment: round-off of a moment that is zero
SAME_ANGLE = 1e-6  # rad: rounding of a typed angle, as `coincident_within` of a typed length


@dataclass(frozen=True)
class VelocityDefect:
    """What the initial velocities leave of a joint or drive: `translation` [m/s] and `rotation` [rad/s]; `driven` where
    a drive asks for the motion."""

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

    Drives are not judged: they say what the velocity is, and a body at rest follows from the first instant.
    """
    found = [str(defect) for defect in velocity_defects(scene) if not defect.driven]
    if found:
        raise InputError(
            f"simulate: the initial velocities of the bodies do not agree with the joints: they pull apart "
            f"{', '.join(found)}; give velocities that fit (a body turning about a joint moves with omega x arm), or "
            "project_start=True to change them as little as possible"
        )


def refuse_singular_mass(scene: Scene) -> None:
    """Raises `InputError` for a body that nothing accelerates by a finite amount: no mass, or no inertia about some
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
    """Raises `InputError` where a drive prescribes another position at t = 0 than its joint has."""
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
