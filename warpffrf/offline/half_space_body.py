r"""Rigid bodies with elastic surfaces: under a patch the body is a half-space.

A patch that is small compared with its body displaces the surface as it displaces that of a half-space,

    u_n(x) = (1 - nu^2)/(pi E) int p(x')/|x - x'| dA',

and the body beyond it hardly deforms: wheels on rails, balls, crowned rollers (the assumption of Hertz and of Kalker).
The reduced body then has no global modes, and a far field of zero (`warpffrf.model.reduced.far_field`): left are the
half-space between the cells of a patch, on any grid, and quarter spaces at free ends, without finite elements. In a
*line* contact the pressures across are right, too, but the approach is not that of the bodies: it contains the
logarithm of their depth, for which a half-space has the length of the line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.errors import InputError, require_array, require_inertia, require_number
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery, Tangential
from warpffrf.model.reduced.data import DisplaySurface, Interface
from warpffrf.model.reduced.far_field import FarField, FarTangential, FreeEnd
from warpffrf.model.surfaces import Shape
from warpffrf.offline.near_field.quarter_space import QuarterSpace

Array = np.ndarray
COLUMNS, ROWS = 8, 5  # of the grid: it has no displacements to resolve, the fewest for splines
SKIN_COLUMNS, SKIN_ROWS = 96, 17  # of the surface in pictures


@named_arguments
def half_space_body(
    mass: float,
    inertia_tensor: Vector | Matrix,
    material: Material,
    *,
    contact: Mapping[str, Shape],
    extent: Mapping[str, Vector | Matrix] | Vector | Matrix | None = None,
    free_ends: bool = True,
    points: Mapping[str, Vector] | None = None,
    center_of_mass: Vector = (0.0, 0.0, 0.0),
) -> ReducedBody:
    """A rigid body whose contact surfaces are elastic half-spaces: for patches that are small compared with the body.

    mass [kg]; inertia_tensor (3, 3), or its diagonal (3,) [kg m2], about the centre of mass; center_of_mass (3,) [m];
    material: of the half-spaces; contact: {name: shape} of `warpffrf.surfaces` with all parameters given; extent:
    {name: (low, high)} [m], the limits of each surface along its axis from `axis_point`, not needed where the profile
    is a table; of a plane ((low, high), (low, high)), across and along; without names: of all. free_ends: the body ends
    there with a face across the axis; False: it continues, and only the cells end. points: {name: (3,) [m]}, ports for
    joints and forces, by default {"center": center_of_mass}. User frame. Its surfaces carry pressures with
    `grid="contact_fixed"` only.

    Returns a `ReducedBody` without modes, for `Scene.add_body`. Raises `InputError` for a shape with parameters left to
    be fitted, missing limits, and an impossible inertia.

    >>> steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
    >>> tread = wf.surfaces.CrownedCylinder(
    ...     radius=0.46, crown_radius=0.3, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)
    ... )
    >>> wheel = wf.half_space_body(
    ...     400.0, (30.0, 55.0, 30.0), steel, contact={"tread": tread}, extent={"tread": (-0.05, 0.05)}
    ... )
    >>> list(wheel.contact_surfaces), list(wheel.interfaces)
    (['tread'], ['center'])
    """
    label = "half_space_body"
    if not isinstance(material, Material):
        raise InputError(f"{label}: material must be a warpffrf.Material, got {material!r}")
    if not contact:
        raise InputError(f"{label}: contact names no surface; add a body without any by scene.add_rigid_body")
    if extent is not None and not isinstance(extent, Mapping):
        extent = dict.fromkeys(contact, extent)
    extent = dict(extent or {})
    if unknown := [name for name in extent if name not in contact]:
        raise InputError(f"{label}: extent names {unknown[0]!r}, which is no surface of contact")
    center = require_array(center_of_mass, f"{label}: center_of_mass", (3,))
    patches = {name: Patch.of(name, shape, extent.get(name)) for name, shape in contact.items()}
    skin = skin_of(patches)
    surfaces = {name: patch.surface(name, material, free_ends, len(skin.points)) for name, patch in patches.items()}
    places = points if points else {"center": center}
    return ReducedBody(
        mass=require_number(mass, f"{label}: mass", positive=True),
        center_of_mass=center,
        inertia=require_inertia(inertia_tensor, f"{label}: inertia_tensor"),
        frequencies=np.zeros(0),
        interfaces={
            name: Interface("rigid", require_array(point, f"{label}: points[{name!r}]", (3,)), np.zeros((0, 6)))
            for name, point in places.items()
        },
        contact_surfaces=surfaces,
        surface=skin,
        report={"path": "half-space", "notes": [], "warnings": []},
        provenance={"mesh_name": "half-space", "contact_materials": dict.fromkeys(contact, asdict(material))},
    )


class Patch:
    """A surface within its limits: across, angles [rad] or of a plane lengths [m], None all around; along [m]."""

    def __init__(self, shape: Any, across: Array | None, along: Array) -> None:
        self.shape, self.across, self.along = shape, across, along

    @classmethod
    def of(cls, name: str, shape: Any, limits: Any, caller: str = "half_space_body", *, arcs: bool = False) -> Patch:
        """A checked one; arcs: limits around are possible on surfaces of revolution, too."""
        label = f"{caller}: surface {name!r}"
        if not isinstance(shape, Shape):
            raise InputError(f"{label} must be a shape of warpffrf.surfaces, got {shape!r}")
        shape = shape.without_nodes()
        if not shape.resolved:
            raise InputError(f"{label} has no nodes to be fitted to; give {' and '.join(shape.missing)}")
        profile = shape.profile()
        if profile.height is not None:
            return cls(shape, *np.outer(profile.height.half, [-1.0, 1.0]))
        if limits is None and getattr(shape, "table", None) is not None:
            limits = (shape.table[0][0], shape.table[0][-1])
        if limits is None:
            raise InputError(f"{label} has no ends; give extent={{{name!r}: (low, high)}}, along its axis")
        wanted = (2, 2) if profile.flat or (arcs and np.ndim(limits) == 2) else (2,)
        limits = np.atleast_2d(require_array(limits, f"{label}: extent", wanted))
        if np.any(np.diff(limits) <= 0.0):
            raise InputError(f"{label}: extent must be ascending, got {limits.tolist()}")
        if profile.curve is not None and not profile.curve.closed:
            return cls(shape, profile.curve.knots[[0, -1]], limits[-1])
        return cls(shape, limits[0] if len(limits) == 2 else None, limits[-1])

    def chart(self, columns: int, rows: int) -> tuple[Array, Array]:
        """theta (columns,), without the last of a full revolution, and z (rows,)."""
        z = np.linspace(self.along[0], self.along[1], rows)
        if self.across is not None:
            return np.linspace(self.across[0], self.across[1], columns), z
        curve = self.shape.profile().curve
        start, turn = (0.0, 2.0 * np.pi) if curve is None else (curve.knots[0], curve.length)
        return start + turn / columns * np.arange(columns), z

    def surface(self, name: str, material: Material, free_ends: bool, skin_points: int) -> ContactSurface:
        theta, z = self.chart(COLUMNS, ROWS)
        periodic = self.across is None
        sectors = COLUMNS if periodic else 1
        block, functions = COLUMNS // sectors * ROWS, COLUMNS * ROWS

        def grid(kind: str) -> SurfaceGrid:
            pitch = float(theta[1] - theta[0])
            per_sector = COLUMNS // sectors
            return SurfaceGrid(
                np.asarray(self.shape.e_0), float(theta[0]), pitch, COLUMNS, periodic, z, per_sector, kind
            )

        def recovery(directions: int) -> Recovery:
            return Recovery(np.zeros((1, 3 * skin_points, directions * functions), np.float32), 1, np.eye(3))

        lags, lags_nt = np.zeros((sectors, block, block)), np.zeros((sectors, block, 2 * block))
        lags_tt = np.zeros((sectors, 2 * block, 2 * block))
        far = FarField(
            lags,
            material.youngs_modulus,
            material.poisson_ratio,
            (FreeEnd(float(z[0]), -1), FreeEnd(float(z[-1]), 1)) if free_ends else (),
            asymmetry=0.0,
            quarter=QuarterSpace(material.poisson_ratio).on_surface if free_ends else None,
            tangential=FarTangential(lags_tt, lags_nt, 0.0),
        )
        tangential = Tangential(grid("cells"), lags_tt, lags_nt, np.zeros((2, functions, 0)), recovery(2))
        modes = np.zeros((functions, 0))
        return ContactSurface(name, self.shape, grid("nodes"), lags, modes, recovery(1), tangential, far=far)


def skin_of(patches: Mapping[str, Patch]) -> DisplaySurface:
    """The surfaces, open at their ends."""
    points: list[Array] = []
    triangles: list[Array] = []
    for patch in patches.values():
        theta, z = patch.chart(SKIN_COLUMNS, SKIN_ROWS)
        first = sum(map(len, points))
        points.append(patch.shape.point(theta[:, None], z[None, :]).reshape(-1, 3))
        index = first + np.arange(len(theta) * len(z)).reshape(len(theta), len(z))
        if patch.across is None:
            index = np.concatenate([index, index[:1]])
        triangles.append(triangles_of(index))
    count = sum(map(len, points))
    return DisplaySurface(np.concatenate(points), np.concatenate(triangles), np.zeros((0, count, 3)))


def triangles_of(index: Array) -> Array:
    """Triangles (t, 3) of the cells between points numbered by `index` (n, m)."""
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    return np.concatenate([np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((a, b, c), (a, c, d))])
