r"""Friction of a patch that pivots about its normal: the moment of Coulomb's friction over Hertz's ellipse.

With the pressure p = p_0 sqrt(1 - x^2/a^2 - y^2/b^2) of the force F, pivoting at w_s without any slip of the whole, and
regularised friction of the slip velocity v_s, tractions are mu p min(r w_s/v_s, 1) at the distance r, so that

    slow     M = mu w_s/v_s int p r^2 dA = mu F (a^2 + b^2)/5 w_s/v_s,
    fast     M = mu int p r dA = 3/8 mu F a E(m),      m = 1 - b^2/a^2, E the complete elliptic integral,

3 pi/16 mu F a of a circle. Between both M is taken as the smaller of them, which it is at most. a and b grow as
F^(1/3).

Slip of the whole patch lessens the moment, and pivoting the friction force, as both have one traction to share
(Contensou 1963). That is not modelled: force and moment each have their whole bound, and the pivoting of a patch that
slips faster than it pivots at its edge, |v| > a w_s, is resisted by too much.
"""

from __future__ import annotations

from scipy.special import ellipe

from warpffrf.model.errors import InputError
from warpffrf.model.friction import FrictionLaw
from warpffrf.model.moments.patch import Patch
from warpffrf.model.moments.resistance import Resistance


def spin_resistance(friction: FrictionLaw, patch: Patch | None, label: str) -> Resistance:
    """Of a contact with that friction and that patch, None where the law of the force knows none. Raises `InputError`
    naming `label` for friction that sticks, which has no velocity to answer, and for patches that are no ellipse."""
    if not friction.acts or not friction.creep_limit:
        raise InputError(
            f"{label}: spin=True needs friction that answers the velocity of the surfaces, laws.RegularisedCoulomb or "
            "laws.TractionCurve"
        )
    if patch is None or patch.long is None:
        raise InputError(
            f"{label}: spin=True needs an elliptical patch, that of laws.HertzPoint; laminae resist pivoting without it"
        )
    a, b, mu = patch.long, patch.short, friction.static_coefficient
    fast = 0.375 * mu * a * float(ellipe(1.0 - (b / a) ** 2))
    slow = mu * (a**2 + b**2) / (5.0 * friction.creep_limit)
    return Resistance(fast, 1.0 + patch.growth, slow, 1.0 + 2.0 * patch.growth)
