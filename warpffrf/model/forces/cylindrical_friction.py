"""Friction of a cylindrical joint: a pin that turns and slides in its bush.

The surface of the pin, of radius r, slides along helices, with the velocity (v, r omega). Friction points against it:
of the force F along the axis and the torque T about it, the vector (F, T/r) is at most mu (|N_1| + |N_2|) long, and
turning eases sliding.
"""

from __future__ import annotations

from warpffrf.model.forces.joint_friction import JointFriction
from warpffrf.model.forces.laws import SlipLaw
from warpffrf.model.friction import FrictionLike
from warpffrf.model.joints import Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class CylindricalFriction(JointFriction):
    """Dry friction that brakes, or holds, the turning and sliding of a cylindrical joint, both as one.

    friction: a coefficient, or a law (`Coulomb`, `RegularisedCoulomb`). pin_radius [m]: of the surface that rubs.
    bearing_length [m]: distance of the two places that carry the pin, on either side of the second body's port, with
    which they move; a bending moment M presses with M/bearing_length on each; None: bending moments do not rub. preload
    [N]: friction force on the pin's surface that is there without any reaction, it does not depend on the coefficient.
    Raises `InputError`.
    """

    kind = "cylindrical_friction"
    joint_kind = "cylindrical"
    numbers = ("pin_radius", "bearing_length", "preload")

    def __init__(
        self,
        joint: Joint,
        friction: FrictionLike,
        *,
        pin_radius: float,
        bearing_length: float | None = None,
        preload: float = 0.0,
        name: str | None = None,
    ) -> None:
        super().__init__(joint, friction, name)
        self.pin_radius = self._number(pin_radius, "pin_radius", positive=True)
        self.bearing_length = self._length(bearing_length, "bearing_length")
        self.preload = self._number(preload, "preload", non_negative=True)

    def slip(self) -> SlipLaw:
        """What slides, and what presses."""
        return self._law(
            {"translation": 1.0, "rotation": self.pin_radius}, radial=1.0, preload=self.preload,
            bearing_length=self.bearing_length,
        )  # fmt: skip
