"""Which bodies have to move with a body that is shifted, so that the joints between them stay together.

A joint holds some of the directions in which its sides can move apart. Where a shift has a part along one of them, the
body on the other side goes too, and so on from joint to joint. The ground stays, and so does all that is joined to a
body that is to stay: the rest of the chain then cannot follow, and the body moves alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.bodies import GROUND_INDEX, Body, Ground
from warpffrf.model.joints import Joint

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

HELD = 1e-9  # of a shift: a part along a direction that is held, more than round-off of typed axes


def joined_bodies(scene: Scene, body: Body, stays: Body | Ground, shift: np.ndarray) -> list[Body]:
    """`body` and those that joints take along when it moves by `shift` (3,) [m], world; `body` alone where joints lead
    to the one that `stays` as well."""
    moved = [body]
    for one in moved:  # grows as it goes
        for joint in scene.joints:
            a, b = (port.body for port in joint.ports)
            other = b if a is one else a if b is one else None
            if other is None or other.index == GROUND_INDEX or other in moved or not holds(joint, shift):
                continue
            if other is stays:
                return [body]
            moved.append(other)
    return moved


def holds(joint: Joint, shift: np.ndarray) -> bool:
    """Whether the sides of `joint` cannot move apart by `shift` (3,) [m], world, at the initial pose."""
    along = np.abs(shift @ joint.axes())
    kinds = {(row.kind, row.i) for row in joint.rows}
    least = HELD * float(np.linalg.norm(shift))
    return any(kind == "distance" or (kind == "translation" and along[i] > least) for kind, i in kinds)


def shift_bodies(scene: Scene, bodies: list[Body], shift: np.ndarray) -> None:
    """Move `bodies` by `shift` (3,) [m], world, and with them the places of the joints between them."""
    for body in bodies:
        body.position = body.position + shift
    for joint in scene.joints:
        if joint.point is not None and all(any(port.body is b for b in bodies) for port in joint.ports):
            joint.point = joint.point + shift
