"""Inside of a sphere: R(z) = sqrt(R_0^2 - z^2), the material outside."""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.sphere import Sphere


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Cup(Sphere):
    """Inside of a sphere, the socket of a ball joint; its normal points to the centre. Arguments as of `Sphere`."""

    kind = "cup"
    side = -1.0
