"""A smooth surface over whatever a mesh is: a height over a plane, fitted to the nodes of a facet set.

x = origin + h(theta, z) e_0 + theta e_1 + z e_a, theta and z lengths in the plane, as on a plane, of which this is the
general form; h is a bicubic spline (`height`). e_theta is the tangent along theta, t_z = n x e_theta.

Why a height and no patches on facets. Patches of a triangle or quadrilateral (Nagata, PN, Coons) meet with continuous
tangents at most: curvatures, which pressures follow, jump from facet to facet, and a closest point walks over their
edges. A spline over a plane has continuous curvatures, one piece of arithmetic, and no walk. It covers what two bodies
touch on: caps, crowned blocks, cushions, shoes, hips and lobes, up to 75 degrees from the plane. Surfaces that close
around are those of revolution and extruded curves. Edges are the borders of the facet set.

Nodes are fitted, not facets: those of quadratic facets lie on the surface too, and between nodes the spline is nearer
to it than any facet. The normals of the facets show the side of the material, and folds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.height import SHARP, Height, unit_normal
from warpffrf.model.surfaces.plane import Plane
from warpffrf.model.surfaces.profile import SurfaceProfile

STEEPEST = np.radians(75.0)  # of the facets to the plane: beyond, a height is steep everywhere, or folds
DIRECTED = 0.5  # length of a normal: that of a node with one is 1, without one 0


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class MeshSurface(Plane):
    """A smooth surface through the nodes of a facet set of any form, over a plane that it is not steep to.

    outward (3,): normal of the plane, away from the material; None: that of the plane nearest to the nodes. direction
    (3,): that of z, as of `Plane`; where the surface is the first one of a contact the rows of cells lie along it.
    spacing [m]: size of the pieces of the spline; None: as many pieces as nodes. fit_tolerance [m]: largest distance of
    a node from the surface, 1e-5 of the rectangle's longer side where None. User frame of the body.

    The surface ends at the rectangle about the nodes; corners of it without facets are a smooth continuation without
    material, which contact must not reach. origin (3,) [m], the middle of the rectangle, half (2,) [m], half its
    sides, and coefficients are found from the nodes, and given where a surface is read from a file. Facets are to be
    without edges: `mesh.select_feature` ends at them. `MeshSurface.of(mesh, facet_set)` is the one of a rigid body.

    Raises `InputError` when fitted to fewer than 16 nodes, facets without a normal, facets that are steeper than 75
    degrees to the plane, or fold over it, edges within them, and nodes off the surface.
    """

    spacing: float | None = None
    half: Any = None
    coefficients: Any = None

    kind = "mesh_surface"
    required = (*Plane.required, "half", "coefficients")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.spacing is not None:
            self._keep_number("spacing", positive=True)
        if (self.half is None) != (self.coefficients is None):
            raise InputError(f"surface {self.kind}: half and coefficients belong together; give both, or fit both")
        if self.half is not None:
            half = require_array(self.half, f"surface {self.kind}: half", (2,))
            coefficients = require_array(self.coefficients, f"surface {self.kind}: coefficients", (None, None))
            if not half.min() > 0.0 or min(coefficients.shape) < 4:
                raise InputError(
                    f"surface {self.kind}: half must be positive and coefficients (4, 4) at least, got {half.tolist()} "
                    f"and {coefficients.shape}"
                )
            object.__setattr__(self, "half", half)
            object.__setattr__(self, "coefficients", coefficients)

    @classmethod
    def of(cls, mesh: Any, facet_set: str, **options: Any) -> Any:
        """The surface over a `facet_set` of a `mesh`, for a rigid body or the ground; `options` as of the class.

        Raises `InputError` for a set that does not exist, and where the nodes do not fit.
        """
        facets = mesh.facets(facet_set)
        return cls(**options).fitted(mesh.points[facets.node_set], facets.node_normals(mesh.points))

    # --- frame and chart

    @property
    def size(self) -> float:
        return 0.0 if self.half is None else 2.0 * float(np.max(self.half))

    @cached_property
    def height(self) -> Height:
        """The spline of the heights over the plane. Raises `InputError` while it remains to be fitted."""
        if self.half is None:
            raise self._unknown("the heights are")
        return Height(self.half, self.coefficients)

    def without_nodes(self) -> Any:
        """Itself. Raises `InputError` while parameters remain to be fitted: a rigid surface has no nodes."""
        if self.resolved:
            return self
        raise InputError(
            f"surface {self.kind}: a rigid surface has no nodes to be fitted to; use MeshSurface.of(mesh, facet_set)"
        )

    def profile(self) -> SurfaceProfile:
        return SurfaceProfile(planar=True, side=1.0, radius=1.0, height=self.height)

    def chart(self, points: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        local = (np.asarray(points, float) - self.axis_point) @ self.frame.T
        return self.height.foot(local)

    def gap(self, points: Any) -> np.ndarray:
        local = (np.asarray(points, float) - self.axis_point) @ self.frame.T
        return self.height.foot(local, ends=True)[2]

    def point(self, theta: Any, z: Any) -> np.ndarray:
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return super().point(theta, z) + self.height.at(theta, z)[0][..., None] * self.e_0

    def normal(self, theta: Any, z: Any) -> np.ndarray:
        return unit_normal(self.height.at(theta, z)[1]) @ self.frame

    def around(self, theta: Any, z: Any = 0.0) -> np.ndarray:
        slope = self.height.at(theta, z)[1][..., 0]
        scale = 1.0 / np.hypot(1.0, slope)
        return np.stack([scale * slope, scale], axis=-1) @ self.frame[:2]

    def curvatures(self, theta: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
        """Curvatures [1/m] (any shape) along e_theta and t_z, which need not be the principal ones, at theta, z [m];
        positive where the material is convex."""
        tensor = self.curvature_tensor(theta, z)
        around, along = self.around(theta, z), self.along(theta, z)
        bend = [np.einsum("...i,...ij,...j->...", t, tensor, t) for t in (around, along)]
        return bend[0], bend[1]

    def curvature_tensor(self, theta: Any, z: Any) -> np.ndarray:
        _, gradient, bend = self.height.at(theta, z)
        tangents = np.concatenate([gradient[..., None, :], np.broadcast_to(np.eye(2), bend.shape)], axis=-2)
        inverse = np.linalg.inv(np.eye(2) + gradient[..., :, None] * gradient[..., None, :])
        dual = self.frame.T @ tangents @ inverse
        normal = 1.0 / np.sqrt(1.0 + np.sum(gradient**2, axis=-1))
        return -dual @ (normal[..., None, None] * bend) @ np.swapaxes(dual, -1, -2)

    def sampled_curvatures(self) -> np.ndarray:
        """`curvatures` (2, n) [1/m] in the middles of the pieces of the spline."""
        height = self.height
        middles = [
            d * (np.arange(n) + 0.5) - a for d, n, a in zip(height.pitch, height.counts, height.half, strict=True)
        ]
        return np.stack(self.curvatures(*np.meshgrid(*middles, indexing="ij"))).reshape(2, -1)

    # --- fit

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        if normals is not None and not np.linalg.norm(normals, axis=1).min(initial=1.0) > DIRECTED:
            at = points[np.argmin(np.linalg.norm(normals, axis=1))]
            raise InputError(
                f"surface {self.kind}: the facets at {_place(at)} have no normal: they have no area, or face each "
                "other; repair the mesh there, or leave them out"
            )
        plane = Plane(origin=self.origin, outward=self.outward, direction=self.direction)
        plane = plane if plane.resolved else plane._completed(points, normals)
        if normals is not None:
            lean = normals @ plane.e_0
            if not lean.min() > np.cos(STEEPEST):
                at, angle = points[np.argmin(lean)], np.degrees(np.arccos(np.clip(lean.min(), -1.0, 1.0)))
                raise InputError(
                    f"surface {self.kind}: the facets at {_place(at)} are {angle:.0f} degrees steep to the plane, more "
                    f"than {np.degrees(STEEPEST):.0f}, or fold over it; choose fewer facets, or give outward, the "
                    "direction that all of them face"
                )
        local = (points - plane.axis_point) @ plane.frame.T
        try:
            height = Height.fitted(local, self.spacing)
        except InputError as error:
            raise InputError(f"surface {self.kind}: {error}") from None
        found = replace(
            self, origin=plane.origin, outward=plane.outward, half=height.half, coefficients=height.coefficients
        )
        sharp, place = height.sharpest()
        if sharp > SHARP:
            raise InputError(
                f"surface {self.kind}: the nodes bend sharply at {_place(found.point(*place))}: an edge lies within "
                "the facets, or they are too large for the curvature there; end the set at edges "
                "(mesh.select_feature), or refine the mesh"
            )
        return found


def _place(point: np.ndarray) -> str:
    return "({:.4g}, {:.4g}, {:.4g}) m".format(*point)
