"""What friction in joints has in common: the joint that rubs, the law, and what presses.

A pin in its bush, a slide in its guide are pressed together by the reactions of the joint, so that the bound of
friction is known only with them (`laws.SlipLaw` says how it is made of them). Rows of a joint that are left out as
redundant press nothing.

The terms are those of the joint friction of other multibody programs (radial, axial and bending reactions with an arm
each, and a preload), but for the bending: the pin is carried at two places, whose loads are taken one by one, not
as |R| + 2 |M|/L, which they never exceed.
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
    numbers: ClassVar[tuple[str, ...]] = ()  # attributes that describe it beside joint and law

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
        """A length that may be left out."""
        return None if value is None else self._number(value, name, positive=True)

    def _law(
        self, coordinates: dict[str, float], *, radial: float, preload: float, axial: float = 0.0, spin: float = 0.0,
        bearing_length: float | None = None,
    ) -> SlipLaw:  # fmt: skip
        """`coordinates`: the joint's, by name, with their weights."""
        rows = [self.joint.coordinates[name] for name in coordinates]
        return SlipLaw(
            self.joint, self.friction, tuple(Coordinate(row.kind, row.i, row.j) for row in rows),
            tuple(coordinates.values()), radial, axial, spin, preload, bearing_length,
        )  # fmt: skip
