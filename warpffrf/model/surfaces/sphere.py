r"""Outside of a sphere: R(z) = sqrt(R_0^2 - z^2), a crown of radius R_0.

Fit. |x|^2 = 2 c.x + (R^2 - c.c) is linear in c and R^2 - c.c; Gauss-Newton on f = |x - c| - R, with the columns
-(x - c)/|x - c| and -1, makes it the least-squares fit of distances.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import FIT_STALLED, FIT_STEPS, reference_direction
from warpffrf.model.surfaces.profile import SurfaceProfile
from warpffrf.model.surfaces.revolution import RevolutionShape

ALL_ROUND = 0.1  # length of the mean direction of the nodes below which they lie all around the centre
RIGID_AXIS = (0.0, 1.0, 0.0)  # as of a roller: a ball on a floor has its poles at the sides


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Sphere(RevolutionShape):
    """Outside of a sphere, a ball; `axis_point` (3,) [m] is its centre. What is None is fitted to the nodes.

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
    """Centre (3,) [m] and radius [m], fitted where None. Raises `InputError` for points that leave them open."""
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
