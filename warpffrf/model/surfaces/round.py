r"""Outside of a circular cylinder: R(z) = R_0.

Bore. Inside of a circular cylinder: R(z) = R_0, the material outside.

Crowned cylinder. Outside of a cylinder with a circular crown: R(z) = R_0 - (Rc - sqrt(Rc^2 - z^2)).

Cone. Outside of a circular cone: R(z) = R_0 + tan(alpha) z.

Radius and axial position are one unknown, R_0 = R at `axis_point`: if the point is fitted, it is placed where R is the
given radius, or at the middle of the nodes.

Conical bore. Inside of a circular cone: R(z) = R_0 + tan(alpha) z, the material outside.

Sphere. Outside of a sphere: R(z) = sqrt(R_0^2 - z^2), a crown of radius R_0.

Fit. |x|^2 = 2 c.x + (R^2 - c.c) is linear in c and R^2 - c.c; Gauss-Newton on f = |x - c| - R, with the columns
-(x - c)/|x - c| and -1, refines it to the least-squares fit of distances.

Cup. Inside of a sphere: R(z) = sqrt(R_0^2 - z^2), the material outside.

Groove around a shaft or an inner ring: R(z) = R_0 + Rc - sqrt(Rc^2 - z^2).

Ring. Inside of an outer ring with a groove: R(z) = R_0 - (Rc - sqrt(Rc^2 - z^2)), the material outside.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import FIT_STALLED, FIT_STEPS, fit_revolution, reference_direction
from warpffrf.model.surfaces.profile import SurfaceProfile
from warpffrf.model.surfaces.profiled_cylinder import RevolutionShape


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Cylinder(RevolutionShape):
    """Outside of a circular cylinder; parameters that are None are fitted to the nodes of the facet set.

    radius [m], axis_point (3,) [m], axis_direction (3,), user frame of the body; fit_tolerance [m] is the largest
    distance of a node that is accepted, 1e-5 of the radius where None.

    >>> wf.surfaces.Cylinder().missing  # of a mesh: fitted to the nodes of its facet set
    ('radius', 'axis_point', 'axis_direction')
    >>> tread = wf.surfaces.Cylinder(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))  # of a rigid body
    """

    kind = "cylinder"


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Bore(RevolutionShape):
    """Inside of a circular cylinder, a bore or a bush; its normal points to the axis. Arguments as of `Cylinder`."""

    kind = "bore"
    side = -1.0


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


# Of a mesh: a steeper cone is a disc, the axis of its chart is nearly normal to it
STEEPEST = np.radians(80.0)
FLATTEST = np.radians(89.99)  # of a rigid surface in lumped contact, which needs no chart: the face of a rib
STRAIGHT = 1e-9  # tangent below which points show no cone: round-off of nodes over their width


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Cone(RevolutionShape):
    """Outside of a cone; parameters that are None are fitted to the nodes of the facet set.

    half_angle [rad] between axis and generatrix, positive where the radius grows along `axis_direction`; radius [m] at
    `axis_point`, which is not the tip. Beyond 80 degrees, as for faces of ribs, it is restricted to lumped contacts.
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
        """Whether it is restricted to lumped contacts."""
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
            raise InputError(f"surface {self.kind}: half_angle is not determined yet; call fitted(points) first")
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


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class ConicalBore(Cone):
    """Inside of a cone, a tapered seat; its normal points to the axis. Arguments as of `Cone`."""

    kind = "conical_bore"
    side = -1.0


ALL_ROUND = 0.1  # length of the mean direction of the nodes below which they lie all around the centre
RIGID_AXIS = (0.0, 1.0, 0.0)  # as of a roller: a ball on a floor has its poles at the sides


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Sphere(RevolutionShape):
    """Outside of a sphere, a ball; `axis_point` (3,) [m] is its centre. Parameters that are None are fitted.

    axis_direction (3,): of the chart's axis, whose two poles cannot be in contact; where None it is perpendicular to
    the middle of the nodes seen from the centre, z where they lie all around, and y of a rigid surface.
    """

    kind = "sphere"

    @property
    def center(self) -> np.ndarray:
        """The centre (3,) [m, user frame]."""
        return self._known()[1]

    def profile(self) -> SurfaceProfile:
        profile = super().profile()
        return replace(profile, crown=profile.radius)

    def without_nodes(self) -> Any:
        return replace(self, axis_direction=RIGID_AXIS) if self.axis_direction is None else self

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        c, R = _fit_sphere(points, self.kind, self.axis_point, self.radius)
        axis = self.axis_direction
        if axis is None:
            middle = np.mean((points - c) / np.linalg.norm(points - c, axis=1)[:, None], axis=0)
            length = float(np.linalg.norm(middle))
            axis = np.array([0.0, 0.0, 1.0]) if length < ALL_ROUND else _across(middle / length)
        return replace(self, radius=R, axis_point=c, axis_direction=axis)


def _across(direction: np.ndarray) -> np.ndarray:
    """Unit vector perpendicular to `direction` that a roller's axis y would be there, or near it."""
    seed = np.array([0.0, 1.0, 0.0])
    if abs(direction[1]) > 0.9:
        return reference_direction(direction)
    across = seed - (seed @ direction) * direction
    return across / np.linalg.norm(across)


def _fit_sphere(
    points: np.ndarray, kind: str, center: np.ndarray | None, radius: float | None
) -> tuple[np.ndarray, float]:
    """Centre (3,) [m] and radius [m], fitted where None. Raises `InputError` for points that do not determine them."""
    unknowns = 3 * (center is None) + (radius is None)
    if len(points) < max(unknowns, 1):
        raise InputError(f"surface {kind}: {len(points)} points cannot determine {unknowns} unknowns")
    if center is not None:
        R = float(np.mean(np.linalg.norm(points - center, axis=1))) if radius is None else radius
        return center, R
    middle = points.mean(axis=0)
    x = points - middle
    A = np.hstack([2.0 * x, np.ones((len(x), 1))])
    solution, _, rank, _ = np.linalg.lstsq(A, np.einsum("ij,ij->i", x, x), rcond=1e-12)
    if rank < 4:
        raise InputError(
            f"surface {kind}: the points lie in one plane and determine no sphere; give radius and axis_point"
        )
    c = solution[:3]
    R = float(np.sqrt(max(solution[3] + c @ c, 0.0))) if radius is None else radius
    for _ in range(FIT_STEPS):
        away = np.linalg.norm(x - c, axis=1)
        J = np.hstack([-(x - c) / away[:, None], -np.ones((len(x), 1))])[:, : 4 if radius is None else 3]
        step = -np.linalg.lstsq(J, away - R, rcond=None)[0]
        c, R = c + step[:3], R + (float(step[3]) if radius is None else 0.0)
        if np.max(np.abs(step)) <= FIT_STALLED * abs(R):
            break
    if not (np.all(np.isfinite(c)) and R > 0.0):
        raise InputError(f"surface {kind}: no sphere fits the facets; give radius and axis_point")
    return middle + c, R


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Cup(Sphere):
    """Inside of a sphere, the socket of a ball joint; its normal points to the centre. Arguments as of `Sphere`."""

    kind = "cup"
    side = -1.0


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Groove(RevolutionShape):
    """Circular groove of radius `groove_radius` [m] around a shaft, the inner raceway of a ball bearing.

    `radius` is that of the bottom of the groove, the smallest, at `axis_point`. Parameters that are None are fitted.
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


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Ring(RevolutionShape):
    """Inside of a ring with a circular groove of radius `groove_radius` [m], the outer raceway of a ball bearing.

    `radius` is that of the bottom of the groove, the largest, at `axis_point`. Parameters that are None are fitted.
    """

    groove_radius: float | None = None

    kind = "ring"
    required = (*RevolutionShape.required, "groove_radius")
    side = -1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.groove_radius is not None:
            self._keep_number("groove_radius", positive=True)

    def profile(self) -> SurfaceProfile:
        return replace(super().profile(), crown=self._arc("groove_radius", 1.0))

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        return self._completed_arc(points, "groove_radius", 1.0, "groove; use Bore()")
