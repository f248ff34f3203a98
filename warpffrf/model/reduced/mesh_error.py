r"""Mesh error of a body's contact forces, by comparison with the same body on another mesh.

On a contact-fixed grid (`Contact(grid="contact_fixed")`) the half-space is exact, and mesh errors occur only in the far
field and the global modes. For a unit force, spread over a strip as long as the surface (line contacts) or a square
(others) of half-width b, u = near + far is the mean displacement of the loaded region, with the interface fixed. With
another mesh of the same body

    (u - u')/u'

is the excess compliance of the body on its own mesh, and the force at a given approach is smaller by this fraction. For
hollow rollers with 4 and 8 mm elements of any kind this is the error of the force to 0.1 % of it
(docs/studies/coarse_rollers.md). The estimate does not include the error of the other mesh: with elements of half the
size about a quarter. Elements of the same size and a higher degree are not an alternative: of 4 mm tet4 and tet10 the
errors are 0.7 and 0.5 %.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.half_space import rectangle
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.reduced.far_field import FarField

if TYPE_CHECKING:
    from warpffrf.model.reduced.body import ReducedBody

Array = np.ndarray
NARROW = 0.005  # of the smallest radius of curvature, or of the extent of a plane: the default half-width
PLACES = 5  # points around the surface
POINTS = 33  # of the load along it
SAME = 1e-3  # of the size of a surface: two meshes of one body agree to this
CUSP, BENDS = 1.0 / 12.0, 0.06  # `own_mesh_error`: of an approach of some twelve P'(1 - nu^2)/(pi E); measured


def mesh_error(
    body: ReducedBody, finer: ReducedBody, half_width: float | None = None, interface: str | None = None
) -> dict[str, float]:
    """`ReducedBody.mesh_error`; the largest at `PLACES` points around each surface."""
    if half_width is not None:
        half_width = require_number(half_width, "mesh_error: half_width", positive=True)
    held = interface if interface is not None else next(iter(body.interfaces), None)
    for one in (body, finer):
        if held is not None and held not in one.interfaces:
            raise unknown_name("mesh_error: interface", held, list(one.interfaces))
    names = [
        name
        for name, surface in body.contact_surfaces.items()
        if surface.far is not None and name in finer.contact_surfaces and finer.contact_surfaces[name].far is not None
    ]
    if not names:
        raise InputError(
            "mesh_error: no contact surface has a far field in both bodies; reduce both with contact_fixed=True and "
            "the same contact="
        )
    return {name: _error(body, finer, name, held, half_width) for name in names}


def _error(body: ReducedBody, finer: ReducedBody, name: str, held: str | None, half_width: float | None) -> float:
    own, other = body.contact_surfaces[name], finer.contact_surfaces[name]
    size = float(np.ptp(own.grid.z))
    if max(abs(own.grid.z[0] - other.grid.z[0]), abs(own.grid.z[-1] - other.grid.z[-1])) > SAME * size or (
        own.shape.kind != other.shape.kind
    ):
        raise InputError(f"mesh_error: contact {name!r} is another surface in the second body; give two meshes of one")
    middle = 0.5 * float(own.grid.z[0] + own.grid.z[-1])
    k = max(float(np.max(np.abs(v))) for v in own.shape.curvatures(own.grid.theta, middle))
    b = half_width if half_width is not None else NARROW * (1.0 / k if k > 0.0 else size)
    profile = own.shape.profile()
    length = 2.0 * b if profile.flat or profile.crown else size
    x, w = np.polynomial.legendre.leggauss(POINTS)
    z, weight = middle + 0.5 * length * x, 0.5 * w
    far = _far(own)
    c = (1.0 - far.poisson_ratio**2) / (np.pi * far.youngs_modulus)
    centres = [middle, *(2.0 * end.z - middle for end in far.ends)]  # of the strip, and of its images at the ends
    near = c * sum(float(weight @ rectangle(0.0, z - at, 2.0 * b, length)) for at in centres) / (2.0 * b * length)
    if far.quarter is not None:
        for end in far.ends:
            inside = end.side * (end.z - z)
            near += float(weight @ far.quarter.displacement(0.0, inside[:, None], inside) @ weight) / far.youngs_modulus
    turn = own.grid.pitch * (own.grid.columns if own.grid.periodic else own.grid.columns - 1)
    places = own.grid.theta_start + turn * (np.arange(PLACES) + 0.5) / PLACES
    found = []
    for theta in places:
        softer, fine = (_beyond(one, name, held, float(theta), z, weight) for one in (body, finer))
        found.append((fine - softer) / (near + fine))
    return float(found[int(np.argmax(np.abs(found)))])


def _beyond(body: ReducedBody, name: str, held: str | None, theta: float, z: Array, weight: Array) -> float:
    """Mean displacement [m/N], without the half-space, of a unit force distributed over z (n,) [m] by `weight`."""
    surface = body.contact_surfaces[name]
    splines = surface.splines
    P = np.outer(splines.around([theta])[0], weight @ splines.along(z)).ravel()
    used = np.flatnonzero(P)
    far = float(P[used] @ _entries(surface, used) @ P[used])
    modes = P @ splines.of_nodes(surface.mode_normal)
    if held is not None:
        interface = body.interfaces[held]
        places, normals = surface.shape.point(theta, z), surface.shape.normal(theta, z)
        rigid = np.concatenate([normals, np.cross(places - interface.point, normals)], axis=1)
        modes = modes - (weight @ rigid) @ interface.modes.T
    return far + float(np.sum((modes / (2.0 * np.pi * body.frequencies)) ** 2))


def _entries(surface: ContactSurface, numbers: Array) -> Array:
    """S (n, n) [m/N] among the splines `numbers`, of its layout by distance in sectors."""
    lags = _far(surface).lags
    per_sector = surface.grid.columns_per_sector
    column, row = np.divmod(numbers, surface.grid.rows)
    own = (column % per_sector) * surface.grid.rows + row
    return lags[(column[:, None] // per_sector - column // per_sector) % len(lags), own[:, None], own]


def _far(surface: ContactSurface) -> FarField:
    if surface.far is None:
        raise TypeError(f"contact surface {surface.name!r} has no far field")
    return surface.far


def own_mesh_error(body: ReducedBody, name: str, half_widths: tuple[float, float], *, line: bool) -> float:
    r"""Magnitude of the same error, estimated without another mesh, for a surface with a far field: a fraction of the
    force at a given approach.

    half_widths [m] of the patch around and along the surface; line: whether it extends to the ends. The splines of the
    far field, h apart, spread its non-smooth parts over h. These are mainly the cusp of a curved surface
    (docs/studies/coarse_points.md), for a line `CUSP` (1 - 2 nu)/(1 - nu) h/(2 R) of the approach, for a point
    4 (1 - 2 nu)^2/(6 pi (1 - nu)) (a/R) ln(h/a), and the bending of the wall t behind the surface, `BENDS` (h/t)^2.
    The reduction also computes the error of the cells in that wall ("wall_error" of its report): the larger one is
    used. Within a factor of three of a second mesh, for hollow and thin rollers with 2 to 10 mm cells of any kind, and
    solid balls; not for one or two cells on a radius, nor for slender linear tetrahedra.
    """
    surface = body.contact_surfaces[name]
    far, grid = _far(surface), surface.grid
    middle = 0.5 * float(grid.z[0] + grid.z[-1])
    h = grid.pitch * float(surface.shape.radius_at(middle))
    k = max(float(np.max(np.abs(v))) for v in surface.shape.curvatures(grid.theta, middle))
    wall = body.provenance.get("contact_walls", {}).get(name) or (2.0 / k if k > 0.0 else float(np.ptp(grid.z)))
    a = float(np.sqrt(half_widths[0] * half_widths[1]))
    soft = (1.0 - 2.0 * far.poisson_ratio) / (1.0 - far.poisson_ratio)
    if line or not 0.0 < a < h / np.e:
        cells = body.report.get("contact", {}).get(name, {}).get("far_field", {}).get("wall_error", 0.0)
        return float(max(CUSP * soft * 0.5 * h * k + BENDS * (h / wall) ** 2, cells))
    spread = a / wall  # fraction of a point's approach that the far field has
    cusp = 4.0 * soft * (1.0 - 2.0 * far.poisson_ratio) / (6.0 * np.pi) * a * k * np.log(h / a)
    return float(cusp + BENDS * (h / wall) ** 2 * min(10.0 * spread, 1.0))
