r"""A layer that loses energy when it is compressed and released (Hunt and Crossley, J. Appl. Mech. 42, 1975).

    p = k d^n (1 + chi d_dot),      d = -g > 0,   cut at zero: the surfaces do not pull

Force and rate vanish together at first contact, so that the force has no jump, unlike that of a damper in parallel. k
d^n is elastic, and k d^n chi d_dot^2 >= 0 [W/m^2] is lost.

Restitution. A mass m that hits the layer along its normal with the speed v leaves it with e v. As every depth of the
contact has the same rate, the force is K f(d) (1 + chi d_dot) whatever the shape of the bodies, and m u du = -K f(d)
(1 + chi u) dd gives int u/(1 + chi u) du = 0 between -e v and v, hence with a = chi v

    a (1 + e) = ln[(1 + a)/(1 - e a)],

which holds for every exponent, stiffness and mass, and for a given by e is solved by bisection between 0 and 1/e. To
first order in 1 - e it is the usual chi = 3 (1 - e)/(2 v). The deformation of the bodies adds to the restitution.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.laws.curves import Power
from warpffrf.model.laws.curves.curve import require_exponent
from warpffrf.model.laws.layers import Law
from warpffrf.model.messages.named_arguments import named_arguments

BISECTIONS = 200  # bisections down to neighbouring numbers
ELASTIC = 1e-9  # 1 - e below which the first-order formula is as exact as the difference of two numbers that far apart
SERIES = 0.1  # up to there ln(1 + x) - x from its series: the difference itself would leave round-off of x
TERMS = 18  # of the series: 0.1^18 is below round-off


@named_arguments
@dataclass(frozen=True)
class HuntCrossley(Law):
    """A layer with the pressure stiffness * depth^exponent * (1 + damping * closing speed), never tensile.

    stiffness [Pa/m^exponent] positive, exponent at least 1. Either damping [s/m], not negative, or restitution (0 < e
    <= 1) with the impact_speed [m/s] for which it is specified. Raises `InputError`.
    """

    stiffness: float
    exponent: float
    damping: float | None = None
    restitution: float | None = None
    impact_speed: float | None = None
    kind: ClassVar[str] = "hunt_crossley"

    def __post_init__(self) -> None:
        stiffness = require_number(self.stiffness, "HuntCrossley: stiffness [Pa/m^exponent]", positive=True)
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "exponent", require_exponent(self.exponent, "HuntCrossley: exponent"))
        if (self.damping is None) == (self.restitution is None):
            raise InputError("HuntCrossley: give damping, or restitution with its impact_speed")
        if (self.restitution is None) != (self.impact_speed is None):
            raise InputError("HuntCrossley: restitution and impact_speed belong together")
        if self.damping is not None:
            damping = require_number(self.damping, "HuntCrossley: damping [s/m]", non_negative=True)
            object.__setattr__(self, "damping", damping)
        if self.restitution is not None:
            e = require_number(self.restitution, "HuntCrossley: restitution", positive=True)
            if e > 1.0:
                raise InputError(f"HuntCrossley: restitution must be at most 1, got {e:g}")
            speed = require_number(self.impact_speed, "HuntCrossley: impact_speed [m/s]", positive=True)
            object.__setattr__(self, "restitution", e)
            object.__setattr__(self, "impact_speed", speed)

    @property
    def chi(self) -> float:
        """Damping [s/m], also where the restitution is given."""
        if self.damping is not None:
            return self.damping
        e, speed = self.restitution or 1.0, self.impact_speed or 1.0
        return chi_times_speed(e) / speed

    @property
    def curve(self) -> Power:
        """k d^n, the elastic part."""
        return Power(self.stiffness, self.exponent)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        numbers = {"stiffness": self.stiffness, "exponent": self.exponent, "damping": self.chi}
        return {"kind": self.kind, **numbers}


def chi_times_speed(restitution: float) -> float:
    """a = chi v of a restitution 0 < e <= 1: the root of a (1 + e) = ln[(1 + a)/(1 - e a)] (module docstring)."""
    e = restitution
    if e > 1.0 - ELASTIC:
        return 1.5 * (1.0 - e)
    low, high = 0.0, 1.0 / e
    for _ in range(BISECTIONS):
        a = 0.5 * (low + high)
        if e * a < 1.0 and _bend(a) < _bend(-e * a):
            low = a
        else:
            high = a
    return 0.5 * (low + high)


def _bend(x: float) -> float:
    """ln(1 + x) - x."""
    if abs(x) > SERIES:
        return float(np.log1p(x) - x)
    return -sum((-x) ** n / n for n in range(2, TERMS))
