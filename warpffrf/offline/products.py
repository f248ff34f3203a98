"""The common result of both reduction paths, from which a `ReducedBody` is built; and the mass properties of a body.

Paths. Resolve contact shapes on their facets, and choose the cyclic or the general path.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.material import Orthotropic
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import CrossCompliance, Recovery, Tangential
from warpffrf.model.reduced.data import Interface
from warpffrf.model.reduced.inertia import InertiaTerms, SecondOrderMotion
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.model.reduced.thermal import ReducedThermal
from warpffrf.model.small_sliding import MatchedSurface
from warpffrf.model.surfaces import Bore, Cone, ConicalBore, CrownedCylinder, Cup, Cylinder, Groove, Plane, Ring, Sphere
from warpffrf.offline.contact.contact_grid import largest_radius
from warpffrf.offline.cyclic.sector import periodicity_fault
from warpffrf.offline.cyclic.surface import FacetPattern, facet_pattern
from warpffrf.offline.fe import Assignment


@dataclass(frozen=True)
class Limits:
    """Requested vibration modes: the first `count`, those up to `omega_max` [rad/s], or the fewer of both.
    Both None: none."""

    count: int | None
    omega_max: float | None

    @property
    def none(self) -> bool:
        """True if no vibration mode is requested."""
        return self.count == 0 or (self.count is None and self.omega_max is None)


@dataclass
class SurfaceProduct:
    """Operators of one contact surface, see `ContactSurface`, and the input of the independence check: the flexible
    compliance `(B psi)^T G (B psi)` of a window of grid functions, with (`window`) and without (`residual_window`) the
    contribution of the global modes.

    `observed`, `observed_tangential`: transfer of each observer, by name, of normal and of tangential forces. The grid
    begins at `first_column` of the `whole_columns` of its plan. `traces`: the eigenvalue ratio of the traces of its
    functions on the mesh (`contact.independence`).
    """

    grid: SurfaceGrid
    lags: np.ndarray
    mode_normal: np.ndarray
    recovery: Recovery
    window: np.ndarray
    residual_window: np.ndarray
    traces: float
    tangential: Tangential | None = None
    local_mass: LocalMass | None = None
    slope_lags: np.ndarray | None = None
    observed: dict[str, Recovery] = field(default_factory=dict)
    observed_tangential: dict[str, Recovery] = field(default_factory=dict)
    first_column: int = 0
    whole_columns: int = 0


@dataclass
class MatchedProduct:
    """The joint interfaces of a body by name, the `compliance` (N, N) [m/N] among all their forces, the transfer
    (rows, N) of each observer by name, and the entries of the report."""

    surfaces: dict[str, MatchedSurface]
    compliance: np.ndarray
    observed: dict[str, np.ndarray]
    notes: list[str]
    warnings: list[str]

    def by_force(self, observer: str, components: int) -> np.ndarray | None:
        """Response of an observer to each force (N, points, components), None if it was not requested."""
        if observer not in self.observed:
            return None
        seen = self.observed[observer]
        return np.ascontiguousarray(seen.T).reshape(seen.shape[1], -1, components)


@dataclass(frozen=True, eq=False)
class MembraneTerms:
    """Membrane energy of the first modes of a body.

    `forms` L (R, k, k) [sqrt(J)/m^2], of k modes the first of which have entries; with the `modes` U (3 n, k),
    `products` (R, k, k) and `motion` (3 n, R) [m/sqrt(J)] the strain of second order is
    E2 = sum_r e_r (eps(motion_r) + sum_ij products_rij sym(H_i^T H_j)/2), `offline.inertia.membrane`.
    `second_order`: the second-order motion of all points, on the `shapes` (3 n, S). `facts`: entries of the report.
    """

    forms: np.ndarray
    modes: np.ndarray
    products: np.ndarray
    motion: np.ndarray
    second_order: SecondOrderMotion
    shapes: np.ndarray
    facts: dict[str, Any]


@dataclass
class PathProduct:
    """All results of a path. `observed_modes`: the global modes at each observer, (rows, m), or on the cyclic path
    `ObservedModes`."""

    mass: float
    center: np.ndarray  # (3,) m
    inertia: np.ndarray  # (3, 3) kg m2 about the centre
    omega: np.ndarray  # (m,) rad/s
    interfaces: dict[str, Interface]
    surfaces: list[SurfaceProduct]
    skin_points: np.ndarray
    skin_triangles: np.ndarray
    skin_modes: np.ndarray  # (m, n, 3)
    facts: dict = field(default_factory=dict)
    observed_modes: dict[str, Any] = field(default_factory=dict)
    inertia_terms: InertiaTerms | None = None
    cross: list[CrossCompliance] = field(default_factory=list)  # of each surface under loads on each later one
    matched: MatchedProduct | None = None
    membrane: MembraneTerms | None = None
    thermal: ReducedThermal | None = None
    skin_second_order: np.ndarray | None = None  # (S, n, 3), of the shapes of `membrane`


def mass_properties(J: np.ndarray, origin: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass [kg], centre (3,) [m] and inertia about it (3, 3) [kg m2] from the rigid mass matrix J (6, 6) about
    `origin`.

    J = [[m 1, -m c~], [m c~, I_o]] with c the centre relative to `origin`, I = I_o - m (c.c 1 - c c^T) (Steiner).
    """
    mass = float(np.trace(J[:3, :3]) / 3.0)
    coupling = J[3:, :3] / mass  # c~
    c = 0.5 * np.array(
        [coupling[2, 1] - coupling[1, 2], coupling[0, 2] - coupling[2, 0], coupling[1, 0] - coupling[0, 1]]
    )
    inertia = J[3:, 3:] - mass * (c @ c * np.eye(3) - np.outer(c, c))
    return mass, origin + c, 0.5 * (inertia + inertia.T)


COAXIAL = 1e-9  # of the radius: a shape this close to the axis of periodicity maps onto itself, far below any gap
# Shapes tried if none is given. The plane comes first, since a cylinder of very large radius fits it too; the sphere
# comes before the crowned shapes of which it is a special case.
PLAIN_SHAPES = (Plane, Cylinder, Bore, Sphere, Cup, CrownedCylinder, Ring, Groove, Cone, ConicalBore)
STRAIGHT = (Cylinder.kind, Bore.kind)  # no axial position to be fitted
TAPERED = (Cone.kind, ConicalBore.kind)  # axial position and radius are one unknown
LEAST_SECTORS = 3  # harmonics 0 and 1 must differ from each other and from N/2 for the rigid motions to separate


@dataclass(frozen=True)
class PathChoice:
    """Shapes by set; facet patterns for the cyclic path, None for the general one; and the reason."""

    shapes: dict[str, Any]
    patterns: dict[str, FacetPattern] | None
    reason: str


def resolve_shapes(mesh: Mesh, shapes: dict[str, Any]) -> dict[str, Any]:
    """Fit the open parameters of each shape to the nodes of its facet set; None: the first of `PLAIN_SHAPES` that fits.

    Raises `InputError` naming the set if it does not fit, or if the facets face the side of the material.
    """
    resolved = {}
    for name, shape in shapes.items():
        facets = mesh.facets(name)
        points, normals = mesh.points[facets.node_set], facets.node_normals(mesh.points)
        try:
            if getattr(shape, "twist", 0.0):
                raise InputError(
                    f"surface {shape.kind}: helical surfaces of finite elements carry no contact; use "
                    "wf.half_space_body for the gear, or reduce it without this surface"
                )
            resolved[name] = _any(mesh, points, normals) if shape is None else _fitted(mesh, shape, points, normals)
        except InputError as error:
            raise InputError(f"contact {name!r}: {error}") from None
    return resolved


def _fitted(mesh: Mesh, shape: Any, points: np.ndarray, normals: np.ndarray) -> Any:
    return _oriented(mesh, shape).fitted(points, normals)


def _oriented(mesh: Mesh, shape: Any) -> Any:
    """The shape with the mesh's axis of periodicity if its own direction is to be fitted: it is known exactly, and
    defines the whole axis of a straight profile."""
    if mesh.cyclic is None or getattr(shape, "axis_direction", "none of its own") is not None:
        return shape
    candidate = replace(shape, axis_direction=mesh.cyclic.axis_direction)
    straight = shape.kind in STRAIGHT or (shape.kind in TAPERED and shape.radius is None)
    if shape.axis_point is None and straight:
        candidate = replace(candidate, axis_point=mesh.cyclic.axis_point)
    return candidate


def _any(mesh: Mesh, points: np.ndarray, normals: np.ndarray) -> Any:
    """The first of `PLAIN_SHAPES` that fits the nodes and whose free side the facets face."""
    for shape in PLAIN_SHAPES:
        try:
            return _fitted(mesh, shape(), points, normals)
        except InputError:
            continue
    names = ", ".join(shape.kind for shape in PLAIN_SHAPES)
    raise InputError(f"the facets do not fit any of the shapes {names}; give a shape, or choose other facets")


def choose_path(
    mesh: Mesh,
    interface_sets: list[str],
    shapes: dict[str, Any],
    assignment: Assignment | None = None,
    reason: str | None = None,
) -> PathChoice:
    """Cyclic if mesh, interfaces and surfaces repeat from sector to sector, otherwise general; never silently.

    `reason`: why the general path is required in any case; None if it is not.
    """
    if reason is None and assignment and any(isinstance(m, Orthotropic) for m in assignment.materials):
        reason = "the axes of an orthotropic material do not turn from sector to sector"
    fault = reason or periodicity_fault(mesh, interface_sets, assignment)
    patterns: dict[str, FacetPattern] = {}
    if fault is None and mesh.cyclic is not None:
        if mesh.cyclic.sectors < LEAST_SECTORS:
            fault = f"fewer than {LEAST_SECTORS} sectors"
        for name, shape in shapes.items():
            found = facet_pattern(mesh, name)
            if isinstance(found, str):
                fault = found
                break
            patterns[name] = found
            fault = fault or _axis_fault(mesh, name, shape)
    if fault is not None:
        return PathChoice(shapes, None, fault)
    return PathChoice(shapes, patterns, "mesh, interfaces and contact surfaces repeat from sector to sector")


def _axis_fault(mesh: Mesh, name: str, shape: Any) -> str | None:
    if mesh.cyclic is None:
        return "the mesh is not marked as rotationally periodic"
    if shape.profile().planar:
        return f"contact surface {name!r} is a plane, which no rotation about an axis maps onto its next sector"
    axis = mesh.cyclic.axis_direction
    radius = largest_radius(shape, shape.chart(mesh.points[mesh.facets(name).node_set])[1])
    offset = shape.axis_point - mesh.cyclic.axis_point
    offset = offset - np.dot(offset, axis) * axis
    tilt = np.linalg.norm(shape.e_a - axis)
    if np.linalg.norm(offset) > COAXIAL * radius or tilt > COAXIAL:
        return f"the axis of contact surface {name!r} is not the axis of periodicity (or points the other way)"
    return None
