"""Groove around a shaft or an inner ring: R(z) = R_0 + Rc - sqrt(Rc^2 - z^2)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.profile import SurfaceProfile
from warpffrf.model.surfaces.revolution import RevolutionShape


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Groove(RevolutionShape):
    """Circular groove of radius `groove_radius` [m] around a shaft, the inner raceway of a ball bearing.

    `radius` is that of the bottom of the groove, the smallest, at `axis_point`. What is None is fitted to the nodes.
    """

    groove_radius: float | None = None

    kind = "groove"
    required = (*RevolutionShape.required, "groove_radius")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.groove_radius is not None:
            self._keep_number("groove_radius", positive=True)

    def profile(self) -> SurfaceProfile:
        return replace(super().profile(), crown=self._arc("groove_radius", -1.0))

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        return self._completed_arc(points, "groove_radius", -1.0, "groove; use Cylinder()")
