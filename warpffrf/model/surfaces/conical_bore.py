"""Inside of a circular cone: R(z) = R_0 + tan(alpha) z, the material outside."""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.cone import Cone


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class ConicalBore(Cone):
    """Inside of a cone, a tapered seat; its normal points to the axis. Arguments as of `Cone`."""

    kind = "conical_bore"
    side = -1.0
