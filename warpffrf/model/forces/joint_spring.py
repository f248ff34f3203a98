"""Springs and dampers on the coordinate of a joint."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.forces.characteristics import Characteristic
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import (
    Coordinate,
    SpringLaw,
    TensionLaw,
    described,
    require_damping,
    require_stiffness,
    scalar_law,
    vanishes,
)
from warpffrf.model.joints import Joint
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.signals import Constant, Signal, as_signal

ROTATION = "rotation"


@named_arguments
class JointSpringDamper(Force):
    """A spring and damper on a coordinate s of a joint: a displacement or an angle that it leaves free.

    The force [N] along (torque [N m] about) the axis on the second body is preload - stiffness (s - reference) -
    damping ds/dt, its opposite acts on the first. stiffness [N/m or N m/rad], damping [N s/m or N m s/rad], reference
    [m or rad], preload [N or N m], a number or a signal of time, which loads softly. coordinate: the name of the
    joint's coordinate ("translation", "rotation", ...), or None where it has one only. Turns of an angle are counted,
    so a spiral spring winds up over any number of them.
    A characteristic (`characteristics`) in the place of stiffness or damping is the force over s - reference, or over
    ds/dt. Between interfaces under head and nut, a joint that leaves their axis free and a negative preload make a bolt
    of it, whose tension is -preload where nothing has yielded yet. Raises `InputError`.

    Softly pressed, with `guide` as in `joints.Prismatic`:

    >>> load = wf.signals.SmoothStep(-100.0, -1000.0, duration=1e-3)  # N
    >>> press = scene.add(wf.forces.JointSpringDamper(guide, stiffness=1e5, damping=100.0, preload=load, name="press"))
    """

    kind = "joint_spring_damper"

    def __init__(
        self,
        joint: Joint,
        stiffness: float | Characteristic,
        damping: float | Characteristic = 0.0,
        *,
        coordinate: str | None = None,
        reference: float = 0.0,
        preload: float | Signal = 0.0,
        name: str | None = None,
    ) -> None:
        label = f"joint spring {name!r}" if name else "joint spring"
        if not isinstance(joint, Joint):
            raise InputError(f"{label}: acts on a joint, got {joint!r}")
        free = [c for c, row in joint.coordinates.items() if row not in joint.rows]
        if not free:
            raise InputError(
                f"{label}: acts on a coordinate that its joint leaves free, {joint.kind} joint {joint.name!r} has none"
            )
        self.coordinate = joint.coordinate(coordinate)
        if self.coordinate not in free:
            raise InputError(f"{label}: {joint.label} holds its {self.coordinate}; it leaves free {', '.join(free)}")
        self.name = name
        self.joint = joint
        self.stiffness = require_stiffness(stiffness, f"{label}: stiffness")
        self.damping = require_damping(damping, f"{label}: damping")
        self.reference = require_number(reference, f"{label}: reference")
        given = as_signal(preload, f"{label}: preload")
        self.preload: float | Signal = given.value if isinstance(given, Constant) else given

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports

    def law(self) -> SpringLaw:
        """Coordinate and law. Raises `InputError` where stiffness and damping are both zero."""
        if vanishes(self.stiffness) and vanishes(self.damping):
            raise InputError(
                f"joint spring {self.name!r}: stiffness and damping are both zero; use a PointForce or PointTorque"
            )
        constant = 0.0 if isinstance(self.preload, Signal) else -self.preload
        return scalar_law(
            self._row(), self.stiffness, self.damping, self.reference, constant, ports=self.ports, joint=self.joint
        )

    def tension(self) -> TensionLaw | None:
        """The preload that changes with time, a pull of its own beside the law; None of a constant one."""
        if not isinstance(self.preload, Signal):
            return None
        return TensionLaw(self.joint, self._row(), self.preload.scaled(-1.0), np.inf)

    def _row(self) -> Coordinate:
        row = self.joint.coordinates[self.coordinate]
        return Coordinate(row.kind, row.i, row.j)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = ("kind", "name", "coordinate", "stiffness", "damping", "reference", "preload")
        return {**{f: described(getattr(self, f)) for f in fields}, "joint": self.joint.name}


@named_arguments
class TorsionalSpringDamper(JointSpringDamper):
    """A spring and damper on the angle of a revolute or cylindrical joint: `JointSpringDamper` with
    coordinate="rotation". stiffness [N m/rad], damping [N m s/rad], or characteristics; reference [rad], preload [N
    m]."""

    kind = "torsional_spring_damper"

    def __init__(
        self,
        joint: Joint,
        stiffness: float | Characteristic,
        damping: float | Characteristic = 0.0,
        *,
        reference: float = 0.0,
        preload: float | Signal = 0.0,
        name: str | None = None,
    ) -> None:
        super().__init__(
            joint, stiffness, damping, coordinate=ROTATION, reference=reference, preload=preload, name=name
        )
