"""Pretension of a bolt: a force that pulls two ports together, and from some time on the length that it has led to.

A bolt is tightened with a known force F, and what it does later, under loads, follows from its stiffness. So the
coordinate s of a joint, the distance of its two sides along the axis, obeys

    lambda = F(t)    until `lock_at`,        s = s_lock    from then on,

lambda the pull on the coordinate, positive where it draws the sides together, and s_lock the value of s at the end of
the first step, in time or static, that ends at `lock_at` or later, so that locking changes nothing by itself. The other
relative motions are the joint's.

With the joint between the two faces of a cut through the shank of a bolt (`Mesh.cut`) this is the *pretension section*
of finite-element programs: a Prismatic joint holds five relative coordinates of the faces, tension moves the faces
into one another by the shortening -s, as a nut that is turned shortens the shank. Between head and nut of a bolt that
is no mesh, `JointSpringDamper` with a preload is the bolt with its stiffness.

Work of the tension is work of forces, `-(lambda_0 + lambda_1)/2 (s_1 - s_0)` a step, none once the length is held.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import Coordinate, TensionLaw
from warpffrf.model.joints import Joint
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.signals import SignalLike, as_signal


@named_arguments
class Pretension(Force):
    """Pulls the two sides of a joint together with a force, and holds the length between them later.

    joint: leaves a translation or a distance free, such as a `Prismatic` joint between the faces of `Mesh.cut`. force:
    a number or a signal [N], positive: tension, b is drawn towards a. lock_at [s]: from the end of the first step at or
    after this time on the coordinate stays what it is then; 0 locks what a run starts from, "equilibrium" for one;
    None: the force acts throughout. coordinate: the joint's, or None where it has one only. A static state has the
    force unless its time is beyond lock_at, or it goes on from a run that has locked. Once locked it stays so, in later
    stages and in runs that go on from a checkpoint.

    The force in the results is that on the second body, the deformation the coordinate [m]. Raises `InputError` for a
    coordinate that is no length, or that the joint holds.
    """

    kind = "pretension"

    def __init__(
        self,
        joint: Joint,
        force: SignalLike,
        *,
        lock_at: float | None = None,
        coordinate: str | None = None,
        name: str | None = None,
    ) -> None:
        label = f"pretension {name!r}" if name else "pretension"
        if not isinstance(joint, Joint):
            raise InputError(f"{label}: acts on a joint, got {joint!r}; a Prismatic joint between the faces of a cut")
        try:
            self.coordinate = joint.coordinate(coordinate)
        except InputError as error:
            raise InputError(f"{label}: {error}") from None
        row = joint.coordinates[self.coordinate]
        if not row.is_length or row in joint.rows:
            free = [c for c, r in joint.coordinates.items() if r.is_length and r not in joint.rows]
            known = f"it leaves free {', '.join(free)}" if free else "it leaves no length free; take a Prismatic joint"
            raise InputError(f"{label}: pulls along a length that {joint.label} leaves free, {known}")
        self.name = name
        self.joint = joint
        self.force = as_signal(force, f"{label}: force")
        self.lock_at = None if lock_at is None else require_number(lock_at, f"{label}: lock_at", non_negative=True)

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports

    def tension(self) -> TensionLaw:
        """What the simulation applies."""
        row = self.joint.coordinates[self.coordinate]
        lock_at = np.inf if self.lock_at is None else self.lock_at
        return TensionLaw(self.joint, Coordinate(row.kind, row.i, row.j), self.force, lock_at)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = {name: getattr(self, name) for name in ("kind", "name", "coordinate", "lock_at")}
        return {**fields, "joint": self.joint.name, "force": self.force.describe()}
