r"""Rolling resistance by a lever: M = e F, the force of the ground a distance e ahead of the middle of the patch.

A roller of mass m, radius r and moment of inertia J that rolls out on a plane slows down by

    dv/dt = -(e/r) g/(1 + J/(m r^2)),

as e F of the moment turns it and a friction force F e/(r (1 + J/(m r^2))) holds it back. e/r is the coefficient of
rolling resistance of handbooks. In a bearing Palmgren's torque M_1 = f_1 F d_m that grows with the load (A. Palmgren,
Ball and Roller Bearing Engineering, 1959) is that of a lever: an element of the diameter D that turns with w_e
against the one ring and the other takes e Q w_e at either contact from the shaft.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from warpffrf.model.errors import require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments.patch import Patch
from warpffrf.model.moments.resistance import RollingResistance


@named_arguments
@dataclass(frozen=True)
class RollingResistanceArm(RollingResistance):
    """M = lever * F against rolling, F the normal force; for any law of it, of laminae for each.

    lever [m]: not negative, some micrometres of hard steel. rolling_speed [rad/s] as in `RollingResistance`. Raises
    `InputError`.
    """

    lever: float
    rolling_speed: float
    kind: ClassVar[str] = "rolling_resistance_arm"

    def __post_init__(self) -> None:
        lever = require_number(self.lever, "RollingResistanceArm: lever [m]", non_negative=True)
        speed = require_number(self.rolling_speed, "RollingResistanceArm: rolling_speed [rad/s]", positive=True)
        object.__setattr__(self, "lever", lever)
        object.__setattr__(self, "rolling_speed", speed)

    def bound(self, patch: Patch | None, label: str) -> tuple[float, float]:
        return self.lever, 1.0
