"""Outside of a cylinder with a circular crown: R(z) = R_0 - (Rc - sqrt(Rc^2 - z^2))."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.profile import SurfaceProfile
from warpffrf.model.surfaces.revolution import RevolutionShape


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class CrownedCylinder(RevolutionShape):
    """Outside of a cylinder with a circular crown; `crown_radius` [m] too is fitted where None.

    `axis_point` is the centre of the crown: R(z) is largest there. Other arguments as for `Cylinder`.
    """

    crown_radius: float | None = None

    kind = "crowned_cylinder"
    required = (*RevolutionShape.required, "crown_radius")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.crown_radius is not None:
            self._keep_number("crown_radius", positive=True)

    def profile(self) -> SurfaceProfile:
        return replace(super().profile(), crown=self._arc("crown_radius", 1.0))

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        return self._completed_arc(points, "crown_radius", 1.0, "crown; use Cylinder()")
