"""What a scene amounts to before it is run: masses, degrees of freedom, redundant constraints, initial gaps.

Grübler's count takes every constraint for independent: freedoms = 6 bodies + modes - constraints. The actual count uses
the rank of the constraint Jacobian C_q at the initial pose, freedoms = unknowns - rank(C_q); the difference is the
number of redundant constraints. C_q is found by central differences of the constraint functions of `joints` over each
body's translation, rotation vector and modal coordinates; a flexible interface moves by `modes^T q` at its point, so a
constraint that is redundant between rigid bodies need not be between flexible ones. Columns are made comparable by a
length L of the scene (rotations) and by one factor for all modes. A joint's redundant constraints are those of its rows
that do not raise the rank of all rows before them: which joint of a closed loop is named depends on the order of
adding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import GROUND_INDEX, Body, Port
from warpffrf.model.contact import smallest_gap
from warpffrf.model.errors import InputError
from warpffrf.model.joints import Joint

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

DIFFERENCE_STEP = 1e-5  # of L and rad: truncation h^2 and round-off 1e-16/h of central differences are both near 1e-10
RANK_TOLERANCE = 1e-7  # of the largest singular value: well above the 1e-10 of the differences


@dataclass(frozen=True)
class SceneCheck:
    """Findings of `Scene.check()`; `str()` gives a table. Masses kg, gaps m."""

    masses: dict[str, float]
    modes: dict[str, int]
    local_modes: dict[str, int]
    constraints: dict[str, int]
    grubler: int
    degrees_of_freedom: int
    redundant: dict[str, int]
    gaps: dict[str, float]
    unsupported: tuple[str, ...]

    def __str__(self) -> str:
        lines = [f"{'body':<20}{'mass [kg]':>14}{'global modes':>14}{'local modes':>14}"]
        for name, mass in self.masses.items():
            lines.append(f"{name:<20}{mass:>14.6g}{self.modes[name]:>14d}{self.local_modes[name]:>14d}")
        lines += ["", f"{'joint or drive':<20}{'constraints':>14}{'redundant':>14}"]
        for name, count in self.constraints.items():
            lines.append(f"{name:<20}{count:>14d}{self.redundant.get(name, 0):>14d}")
        lines += ["", f"{'contact':<20}{'initial gap [m]':>18}"]
        lines += [f"{name:<20}{gap:>18.6g}" for name, gap in self.gaps.items()]
        lines += ["", f"degrees of freedom  {self.degrees_of_freedom} (count without redundancy {self.grubler})"]
        if self.redundant:
            found = ", ".join(f"{name} ({count})" for name, count in self.redundant.items())
            lines.append(f"redundant constraints: {found}; their reactions are not unique")
        if self.unsupported:
            lines.append(f"no joint, spring or contact leads to the ground from: {', '.join(self.unsupported)}")
        return "\n".join(lines)


def check_scene(scene: Scene) -> SceneCheck:
    """See `Scene.check`."""
    if not scene.bodies:
        raise InputError("scene: there are no bodies; add one with scene.add_body or scene.add_rigid_body")
    J, owners = constraint_jacobian(scene)
    redundant: dict[str, int] = {}
    rank = 0
    scale = float(np.linalg.norm(J, 2)) if J.size else 0.0
    for name in owners:
        end = max(owners[name])
        new_rank = int(np.sum(np.linalg.svd(J[: end + 1], compute_uv=False) > RANK_TOLERANCE * scale))
        missing = len(owners[name]) - (new_rank - rank)
        if missing:
            redundant[name] = missing
        rank = new_rank
    unknowns = sum(6 + body.mode_count for body in scene.bodies)
    constraints = {name: len(rows) for name, rows in owners.items()}
    return SceneCheck(
        masses={b.name: b.mass for b in scene.bodies},
        modes={b.name: b.mode_count for b in scene.bodies},
        local_modes={b.name: _local_modes(b) for b in scene.bodies},
        constraints=constraints,
        grubler=unknowns - sum(constraints.values()),
        degrees_of_freedom=unknowns - rank,
        redundant=redundant,
        gaps={contact.name: smallest_gap(contact)[0] for contact in scene.contacts},
        unsupported=_unsupported(scene),
    )


def constraint_jacobian(scene: Scene) -> tuple[np.ndarray, dict[str, list[int]]]:
    """Jacobian (constraints, unknowns) at the initial pose, and the rows of each joint and drive by name.

    Unknowns, body by body: translation / L, rotation vector, modal coordinates (one common scale).
    """
    L = _length(scene)
    starts = np.cumsum([0] + [6 + body.mode_count for body in scene.bodies])
    modes = [
        np.abs(i.modes).max() for b in scene.bodies if b.reduced for i in b.reduced.interfaces.values() if i.modes.size
    ]
    modal_scale = L / max(modes, default=1.0) if max(modes, default=1.0) > 0.0 else 1.0
    driven = {id(drive.joint): drive for drive in scene.drives}
    rows: list[np.ndarray] = []
    owners: dict[str, list[int]] = {}
    for joint in scene.joints:
        frames = joint.frames()
        block = np.zeros((6, starts[-1]))
        for side, port in enumerate(joint.ports):
            if port.body.index == GROUND_INDEX:
                continue
            for k in range(6 + port.body.mode_count):
                column = []
                for sign in (1.0, -1.0):
                    change = np.zeros(6 + port.body.mode_count)
                    change[k] = sign * DIFFERENCE_STEP
                    column.append(_relative_motion(joint, frames, side, change, L, modal_scale))
                block[:, starts[port.body.index] + k] = (column[0] - column[1]) / (2.0 * DIFFERENCE_STEP)
        free = [2] if joint.free_translation else [5] if joint.free_rotation else []
        held = [i for i in range(6) if i not in free]
        name = str(joint.name)
        owners[name] = list(range(len(rows), len(rows) + len(held)))
        rows += [block[i] for i in held]
        if id(joint) in driven:
            drive = driven[id(joint)]
            owners[f"{drive.name}"] = [len(rows)]
            rows.append(block[free[0]])
    return np.array(rows).reshape(len(rows), starts[-1]), owners


def _relative_motion(
    joint: Joint, frames: tuple, side: int, change: np.ndarray, L: float, modal_scale: float
) -> np.ndarray:
    """d / L (3,) and the rotation of b against a (3,) [rad] after the body on `side` moved by `change`."""
    placed = []
    for i, (port, marker) in enumerate(zip(joint.ports, frames, strict=True)):
        moved = change if i == side else np.zeros(6)
        placed.append(_marker_pose(port, marker, moved, L, modal_scale))
    (x_a, A_a), (x_b, A_b) = placed
    A = A_a.T @ A_b
    twist = 0.5 * np.array([A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]])
    return np.concatenate([A_a.T @ (x_b - x_a) / L, twist])


def _marker_pose(port: Port, marker, change: np.ndarray, L: float, modal_scale: float) -> tuple[np.ndarray, np.ndarray]:
    """World position and axes of a marker after a rigid motion and an interface motion of its body."""
    body = port.body
    A = rot.rotation_vector_matrix(change[3:6]) @ rot.matrix(body.rotation)
    x_user, turned = marker.point, rot.matrix(marker.rotation)
    if port.interface_name is not None and len(change) > 6:
        interface = body.reduced.interfaces[port.interface_name]
        motion = modal_scale * change[6:] @ interface.modes
        turn = rot.rotation_vector_matrix(motion[3:])
        x_user = interface.point + motion[:3] + turn @ (x_user - interface.point)
        turned = turn @ turned
    return body.position + L * change[:3] + A @ x_user, A @ turned


def _length(scene: Scene) -> float:
    """A length [m] of the scene: the largest distance of a joint from a body it holds, or 1 m where all are zero."""
    arms = [np.linalg.norm(m.point) for joint in scene.joints for m in joint.frames()]
    arms += [np.linalg.norm(body.center_of_mass) for body in scene.bodies]
    longest = float(max(arms, default=0.0))
    return longest if longest > 0.0 else 1.0


def _local_modes(body: Body) -> int:
    if body.reduced is None:
        return 0
    return sum(s.grid.columns * len(s.grid.z) for s in body.reduced.contact_surfaces.values())


def _unsupported(scene: Scene) -> tuple[str, ...]:
    """Names of bodies that no chain of joints, springs and contacts connects with the ground."""
    links = [item.ports for item in [*scene.joints, *scene.forces, *scene.contacts] if len(item.ports) == 2]
    reached = {GROUND_INDEX}
    while True:
        new = {p.body.index for link in links for p in link if any(q.body.index in reached for q in link)} - reached
        if not new:
            break
        reached |= new
    return tuple(body.name for body in scene.bodies if body.index not in reached)
