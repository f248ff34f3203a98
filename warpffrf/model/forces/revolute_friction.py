"""Friction of a revolute joint: a pin that turns in its bush, and on its collar.

A reaction R across the axis, on a pin of radius r, allows the torque mu r (|N_1| + |N_2|), N the loads of the places
that carry the pin (without bending mu r |R|); a thrust R_z on a collar of mean radius r_t the torque mu r_t |R_z|.
"""

from __future__ import annotations

from warpffrf.model.errors import InputError
from warpffrf.model.forces.joint_friction import JointFriction
from warpffrf.model.forces.laws import SlipLaw
from warpffrf.model.friction import FrictionLike
from warpffrf.model.joints import Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class RevoluteFriction(JointFriction):
    """Dry friction that brakes, or holds, the turning of a revolute joint.

    friction: a coefficient, or a law (`Coulomb`, `RegularisedCoulomb`: of the velocity at the pin's surface).
    pin_radius [m]: arm of the friction by forces across the axis. thrust_radius [m]: arm of that by the force along it.
    bearing_length [m]: distance of the two places that carry the pin, in the middle of which the joint's point lies; a
    bending moment M presses with M/bearing_length on each; None: bending moments do not rub. preload [N m]: torque that
    is there without any reaction (a seal, a press fit), it does not depend on the coefficient. Raises `InputError`.
    """

    kind = "revolute_friction"
    joint_kind = "revolute"
    numbers = ("pin_radius", "thrust_radius", "bearing_length", "preload")

    def __init__(
        self,
        joint: Joint,
        friction: FrictionLike,
        *,
        pin_radius: float = 0.0,
        thrust_radius: float = 0.0,
        bearing_length: float | None = None,
        preload: float = 0.0,
        name: str | None = None,
    ) -> None:
        super().__init__(joint, friction, name)
        self.pin_radius = self._number(pin_radius, "pin_radius", non_negative=True)
        self.thrust_radius = self._number(thrust_radius, "thrust_radius", non_negative=True)
        self.bearing_length = self._length(bearing_length, "bearing_length")
        self.preload = self._number(preload, "preload", non_negative=True)
        if not (self.pin_radius or self.thrust_radius or self.preload):
            raise InputError(f"{self.label}: nothing rubs; give it a pin_radius, a thrust_radius or a preload")
        if self.friction.creep_limit > 0.0 and not (self.pin_radius or self.thrust_radius):
            raise InputError(
                f"{self.label}: the law depends on the velocity of the surfaces, in m/s; give it the pin_radius"
            )

    def slip(self) -> SlipLaw:
        """What slides, and what presses."""
        arm = self.pin_radius or self.thrust_radius or 1.0  # m; a preload alone is a torque at the arm of 1 m
        return self._law(
            {"rotation": arm}, radial=self.pin_radius / arm, axial=self.thrust_radius / arm, preload=self.preload / arm,
            bearing_length=self.bearing_length,
        )  # fmt: skip
