r"""Outside of a circular cone: R(z) = R_0 + tan(alpha) z.

Radius and place along the axis are one unknown, R_0 = R at `axis_point`: where the point is to be fitted it is put
where R is the given radius, or in the middle of the nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import fit_revolution
from warpffrf.model.surfaces.profile import SurfaceProfile
from warpffrf.model.surfaces.revolution import RevolutionShape

# Of a mesh: a steeper cone is a disc, its chart counts along an axis that it hardly follows
STEEPEST = np.radians(80.0)
FLATTEST = np.radians(89.99)  # of a rigid surface in lumped contact, which needs no chart: the face of a rib
STRAIGHT = 1e-9  # tangent below which points show no cone: round-off of nodes over their width


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Cone(RevolutionShape):
    """Outside of a cone; what is None is fitted to the nodes of the facet set.

    half_angle [rad] between axis and generatrix, positive where the radius grows along `axis_direction`; radius [m] at
    `axis_point`, which is not the tip. Beyond 80 degrees, as faces of ribs are, it is for lumped contacts alone.
    Raises `InputError` for an angle of 0 or beyond 89.99 degrees.
    """

    half_angle: float | None = None

    kind = "cone"
    required = (*RevolutionShape.required, "half_angle")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.half_angle is not None:
            self._keep_number("half_angle")
            if not 0.0 < abs(self.half_angle) < FLATTEST:
                raise InputError(
                    f"surface {self.kind}: half_angle must lie between -89.99 and 89.99 degrees and not be 0, got "
                    f"{np.degrees(self.half_angle):g} degrees; use {self._flat_forms()} for 0, Plane for 90"
                )

    @property
    def steep(self) -> bool:
        """Whether it is for lumped contacts alone."""
        return self.half_angle is not None and abs(self.half_angle) >= STEEPEST

    def fitted(self, points: Any, normals: Any = None) -> Any:
        """As of any shape, to points (n, 3) [m] with outward normals (n, 3) in the user frame; raises `InputError` for
        a cone beyond 80 degrees too."""
        found = super().fitted(points, normals)
        if found.steep:
            raise InputError(
                f"surface {self.kind}: of a mesh the half_angle must lie between -80 and 80 degrees, it is "
                f"{np.degrees(found.half_angle):g} degrees; use Plane"
            )
        return found

    def profile(self) -> SurfaceProfile:
        if self.half_angle is None:
            raise InputError(f"surface {self.kind}: half_angle is not known yet; call fitted(points) first")
        return replace(super().profile(), tangent=float(np.tan(self.half_angle)))

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        tangent = None if self.half_angle is None else float(np.tan(self.half_angle))
        radius = None if self.axis_point is None else self.radius  # else found by moving the point along the axis
        fit = fit_revolution(
            points, self.kind, radius, self.axis_point, self.axis_direction, curvature=0.0, tangent=tangent
        )
        t, c, R = fit.tangent, fit.axis_point, fit.radius
        if not abs(t) > STRAIGHT:
            raise InputError(
                f"surface {self.kind}: the points show no cone (tangent {t:.3g}); use {self._flat_forms()}"
            )
        if self.axis_point is None and self.radius is not None:
            c, R = c + (self.radius - R) / t * fit.axis_direction, self.radius
        half_angle = float(np.arctan(t)) if self.half_angle is None else self.half_angle
        return replace(self, radius=R, axis_point=c, axis_direction=fit.axis_direction, half_angle=half_angle)

    def _flat_forms(self) -> str:
        return "Cylinder()" if self.side > 0.0 else "Bore()"
