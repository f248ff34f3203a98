"""Inside of a circular cylinder: R(z) = R_0, the material outside."""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.revolution import RevolutionShape


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Bore(RevolutionShape):
    """Inside of a circular cylinder, a bore or a bush; its normal points to the axis. Arguments as of `Cylinder`."""

    kind = "bore"
    side = -1.0
