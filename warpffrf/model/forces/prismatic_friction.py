"""Friction of a prismatic joint: a slide in its guide.

A reaction R across the axis allows the force mu (|N_1| + |N_2|), N the loads of the two ends of the guide (without
bending mu |R|); a moment M_z about the axis is carried by forces M_z/(2 r) on both flanks at the distance r, which
allow mu |M_z|/r.
"""

from __future__ import annotations

from warpffrf.model.forces.joint_friction import JointFriction
from warpffrf.model.forces.laws import SlipLaw
from warpffrf.model.friction import FrictionLike
from warpffrf.model.joints import Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class PrismaticFriction(JointFriction):
    """Dry friction that brakes, or holds, the sliding of a prismatic joint.

    friction: a coefficient, or a law (`Coulomb`, `RegularisedCoulomb`). bearing_length [m]: distance of the two places
    at which the guide carries, on either side of the second body's port, with which they move; a bending moment M
    presses with M/bearing_length on each; None: bending moments do not rub. flank_radius [m]: distance of the flanks
    that carry a moment about the axis; None: such moments do not rub. preload [N]: friction force that is there without
    any reaction (a gland, a clamp), it does not depend on the coefficient. Raises `InputError`.
    """

    kind = "prismatic_friction"
    joint_kind = "prismatic"
    numbers = ("bearing_length", "flank_radius", "preload")

    def __init__(
        self,
        joint: Joint,
        friction: FrictionLike,
        *,
        bearing_length: float | None = None,
        flank_radius: float | None = None,
        preload: float = 0.0,
        name: str | None = None,
    ) -> None:
        super().__init__(joint, friction, name)
        self.bearing_length = self._length(bearing_length, "bearing_length")
        self.flank_radius = self._length(flank_radius, "flank_radius")
        self.preload = self._number(preload, "preload", non_negative=True)

    def slip(self) -> SlipLaw:
        """What slides, and what presses."""
        spin = 0.0 if self.flank_radius is None else 1.0 / self.flank_radius
        return self._law(
            {"translation": 1.0}, radial=1.0, spin=spin, preload=self.preload, bearing_length=self.bearing_length
        )
