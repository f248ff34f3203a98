"""Common base of joint friction: the joint, the friction law, and the normal loads.

A pin in its bush, a slide in its guide are pressed together by the reactions of the joint, so that the friction bound
depends on them (formula in `laws.SlipLaw`). Rows of a joint that are omitted as redundant contribute no normal load.

The terms are those of the joint friction of other multibody programs (radial, axial and bending reactions with an arm
each, and a load-independent part), except for bending: the pin is supported at two points, whose loads enter
separately, not as |R| + 2 |M|/L, which they never exceed.

Cylindrical friction. Friction of a cylindrical joint: a pin that rotates and slides in its bush.

The surface of the pin, of radius r, slides along helices, with the velocity (v, r omega). Friction points against it:
of the force F along the axis and the torque T about it, the vector (F, T/r) is at most mu (|N_1| + |N_2|) long, and
rotation reduces the resistance to sliding.

Prismatic friction. Friction of a prismatic joint: a slide in its guide.

A reaction R across the axis allows the force mu (|N_1| + |N_2|), N the loads of the two ends of the guide (without
bending mu |R|); a moment M_z about the axis is carried by forces M_z/(2 r) on both flanks at the distance r, which
allow mu |M_z|/r.

Revolute friction. Friction of a revolute joint: a pin that rotates in its bush, and on its collar.

A reaction R across the axis, on a pin of radius r, allows the torque mu r (|N_1| + |N_2|), N the loads of the supports
of the pin (without bending mu r |R|); a thrust R_z on a collar of mean radius r_t the torque mu r_t |R_z|.
"""

from __future__ import annotations

from typing import Any, ClassVar

from warpffrf.model.bodies import Port
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import Coordinate, SlipLaw
from warpffrf.model.friction import FrictionLike, as_constant_friction
from warpffrf.model.joints import Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class JointFriction(Force):
    """Friction of a joint of the kind `joint_kind`; see the subclasses."""

    kind: ClassVar[str] = "joint_friction"
    joint_kind: ClassVar[str] = ""
    numbers: ClassVar[tuple[str, ...]] = ()  # attributes that describe it in addition to joint and law

    def __init__(self, joint: Joint, friction: FrictionLike, name: str | None) -> None:
        self.name = name
        if not isinstance(joint, Joint) or joint.kind != self.joint_kind:
            got = f"{joint.kind} {joint.label}" if isinstance(joint, Joint) else repr(joint)
            raise InputError(f"{self.label}: acts on a {self.joint_kind} joint, got {got}")
        self.joint = joint
        self.friction = as_constant_friction(friction, self.label)

    @property
    def label(self) -> str:
        """Readable name, for messages."""
        words = self.kind.replace("_", " ")
        return f"{words} {self.name!r}" if self.name else words

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        numbers = {number: getattr(self, number) for number in self.numbers}
        law = {"joint": self.joint.name, "friction": self.friction.describe()}
        return {"kind": self.kind, "name": self.name, **law, **numbers}

    def _number(self, value: Any, name: str, **demands: bool) -> float:
        return require_number(value, f"{self.label}: {name}", **demands)

    def _length(self, value: Any, name: str) -> float | None:
        """An optional length."""
        return None if value is None else self._number(value, name, positive=True)

    def _law(
        self, coordinates: dict[str, float], *, radial: float, load_independent: float, axial: float = 0.0,
        spin: float = 0.0, bearing_length: float | None = None,
    ) -> SlipLaw:  # fmt: skip
        """`coordinates`: the joint's, by name, with their weights."""
        rows = [self.joint.coordinates[name] for name in coordinates]
        return SlipLaw(
            self.joint, self.friction, tuple(Coordinate(row.kind, row.i, row.j) for row in rows),
            tuple(coordinates.values()), radial, axial, spin, load_independent, bearing_length,
        )  # fmt: skip


@named_arguments
class CylindricalFriction(JointFriction):
    """Dry friction (sliding or sticking) on the combined rotation and translation of a cylindrical joint.

    friction: a coefficient, or a law (`Coulomb`, `RegularisedCoulomb`). pin_radius [m]: of the sliding surface.
    bearing_length [m]: distance of the two supports of the pin, on either side of the second body's port, with which
    they move; a bending moment M presses with M/bearing_length on each; None: bending moments do not rub.
    load_independent [N]: friction force on the pin's surface without any reaction; it does not depend on the
    coefficient. Raises `InputError`.
    """

    kind = "cylindrical_friction"
    joint_kind = "cylindrical"
    numbers = ("pin_radius", "bearing_length", "load_independent")

    def __init__(
        self,
        joint: Joint,
        friction: FrictionLike,
        *,
        pin_radius: float,
        bearing_length: float | None = None,
        load_independent: float = 0.0,
        name: str | None = None,
    ) -> None:
        super().__init__(joint, friction, name)
        self.pin_radius = self._number(pin_radius, "pin_radius", positive=True)
        self.bearing_length = self._length(bearing_length, "bearing_length")
        self.load_independent = self._number(load_independent, "load_independent", non_negative=True)

    def slip(self) -> SlipLaw:
        """The sliding coordinates and the normal loads."""
        return self._law(
            {"translation": 1.0, "rotation": self.pin_radius}, radial=1.0, load_independent=self.load_independent,
            bearing_length=self.bearing_length,
        )  # fmt: skip


@named_arguments
class PrismaticFriction(JointFriction):
    """Dry friction (sliding or sticking) on the translation of a prismatic joint.

    friction: a coefficient, or a law (`Coulomb`, `RegularisedCoulomb`). bearing_length [m]: distance of the two
    supports of the guide, on either side of the second body's port, with which they move; a bending moment M
    presses with M/bearing_length on each; None: bending moments do not rub. flank_radius [m]: distance of the flanks
    that carry a moment about the axis; None: such moments do not rub. load_independent [N]: friction force
    without any reaction (a gland, a clamp); it does not depend on the coefficient. Raises `InputError`.
    """

    kind = "prismatic_friction"
    joint_kind = "prismatic"
    numbers = ("bearing_length", "flank_radius", "load_independent")

    def __init__(
        self,
        joint: Joint,
        friction: FrictionLike,
        *,
        bearing_length: float | None = None,
        flank_radius: float | None = None,
        load_independent: float = 0.0,
        name: str | None = None,
    ) -> None:
        super().__init__(joint, friction, name)
        self.bearing_length = self._length(bearing_length, "bearing_length")
        self.flank_radius = self._length(flank_radius, "flank_radius")
        self.load_independent = self._number(load_independent, "load_independent", non_negative=True)

    def slip(self) -> SlipLaw:
        """The sliding coordinates and the normal loads."""
        spin = 0.0 if self.flank_radius is None else 1.0 / self.flank_radius
        return self._law(
            {"translation": 1.0}, radial=1.0, spin=spin, load_independent=self.load_independent,
            bearing_length=self.bearing_length,
        )  # fmt: skip


@named_arguments
class RevoluteFriction(JointFriction):
    """Dry friction (sliding or sticking) on the rotation of a revolute joint.

    friction: a coefficient, or a law (`Coulomb`, `RegularisedCoulomb`: of the velocity at the pin's surface).
    pin_radius [m]: arm of the friction by forces across the axis. thrust_radius [m]: arm of that by the force along it.
    bearing_length [m]: distance of the two supports of the pin, in the middle of which the joint's point lies; a
    bending moment M presses with M/bearing_length on each; None: bending moments do not rub. load_independent
    [N m]: friction torque without any reaction (a seal, a press fit); it does not depend on the coefficient. Raises
    `InputError`.
    """

    kind = "revolute_friction"
    joint_kind = "revolute"
    numbers = ("pin_radius", "thrust_radius", "bearing_length", "load_independent")

    def __init__(
        self,
        joint: Joint,
        friction: FrictionLike,
        *,
        pin_radius: float = 0.0,
        thrust_radius: float = 0.0,
        bearing_length: float | None = None,
        load_independent: float = 0.0,
        name: str | None = None,
    ) -> None:
        super().__init__(joint, friction, name)
        self.pin_radius = self._number(pin_radius, "pin_radius", non_negative=True)
        self.thrust_radius = self._number(thrust_radius, "thrust_radius", non_negative=True)
        self.bearing_length = self._length(bearing_length, "bearing_length")
        self.load_independent = self._number(load_independent, "load_independent", non_negative=True)
        if not (self.pin_radius or self.thrust_radius or self.load_independent):
            raise InputError(
                f"{self.label}: it has no friction; give it a pin_radius, a thrust_radius or load_independent friction"
            )
        if self.friction.creep_limit > 0.0 and not (self.pin_radius or self.thrust_radius):
            raise InputError(
                f"{self.label}: the law depends on the velocity of the surfaces, in m/s; give it the pin_radius"
            )

    def slip(self) -> SlipLaw:
        """The sliding coordinates and the normal loads."""
        arm = (
            self.pin_radius or self.thrust_radius or 1.0
        )  # m; load-independent friction alone: a torque at the arm of 1 m
        return self._law(
            {"rotation": arm}, radial=self.pin_radius / arm, axial=self.thrust_radius / arm,
            load_independent=self.load_independent / arm, bearing_length=self.bearing_length,
        )  # fmt: skip
