r"""Excess stiffness of the cells behind a contact surface for a line load: the error of the mesh in addition to the
grid's.

The rule of `grid_rule` is for the grid on an exact body. Under a line load the strain energy of a plane body is
distributed evenly over the logarithm of the distance from the load, so that each layer of cells counts equally, down to
the axis: layers that grow quickly inwards cost more than a coarse rim. Cells of the degree p miss a part of their
energy that grows with the ratio of their height h, along the ray from the load, to their distance d from it. With the
mean over the energy of the radial stress under the load (Flamant), phi the angle of the ray with the normal and b the
half-width,

    error = c_p mean of (h/r)^(n_p) with the weights dV cos^2(phi)/r^2,      r^2 = d^2 + b^2,

is the excess of the force at a given approach: n_1 = 1.5, c_1 = 0.2 for linear cells, n_2 = 2, c_2 = 0.014 for
quadratic ones, fitted to hexahedra in rollers whose layers grow by 1.15 to 3 from one to the next
(`studies.contact.grid_on_roller.layer_states`, docs/studies/contact_grid.md). Point loads are excluded: their energy
lies within a few half-widths.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.offline.contact.contact_grid import FINER_BEHIND, largest_radius

FACTORS = {1: (0.2, 1.5), 2: (0.014, 2.0)}  # c_p, n_p by degree of the cells
EXPECTED = 4.0  # half-width, in spacings of the grid, if no half-width is expected
MOST = 0.03  # of the force: above it `reduce` warns
PLACES = 3  # positions of the load around the surface
# of the line load at mid-width of a nearly incompressible cover, over the cube of the spacings along the axis, and its
# upper bound: covers of 5 and 10 mm, 100 mm wide, nu 0.47 to 0.4999, compared with 24 cells (tests/offline)
AXIAL, MOST_AXIAL, WORTH_A_WORD = 10.0, 0.05, 0.01
CHUNK = 100_000  # cells processed together


def line_mesh_error(mesh: Mesh, shape: Any, grid: SurfaceGrid, half_width: float | None = None) -> float | None:
    """Relative error of the force at a given approach under a line load at mid-width, `half_width` [m] to either side
    (None: `EXPECTED` spacings of the grid), on surface `shape` with the contact `grid`: the worst of `PLACES` around.

    None for surfaces in point contact, planes among them, and for meshes without cells.
    """
    if not touched_in_lines(shape) or not mesh.cells:
        return None
    if half_width is None:
        half_width = EXPECTED * grid.pitch * largest_radius(shape, grid.z)
    turn = grid.pitch * (grid.columns if grid.periodic else grid.columns - 1)
    places = grid.theta_start + turn * (np.arange(PLACES) + 0.5) / PLACES
    return max(_error(mesh, *_frame(shape, theta, float(np.mean(grid.z[[0, -1]]))), half_width) for theta in places)


def touched_in_lines(shape: Any) -> bool:
    """Whether the meridian is straight or slightly profiled; a plane may also be in point contact."""
    profile = shape.profile()
    return not (profile.flat or profile.crown)


def mesh_error_warning(name: str, error: float | None) -> str | None:
    """The warning if the cells behind contact surface `name` are too coarse, else None."""
    if error is None or error <= MOST:
        return None
    return (
        f"contact {name!r}: the cells behind the surface are coarse: under a line load the force at a given approach "
        f"is about {error:.0%} too high; {FINER_BEHIND}"
    )


def axial_error(shape: Any, grid: SurfaceGrid, material: Material | None) -> float:
    """Estimated relative excess of the line load at mid-width due to few cells along the axis: between two free ends,
    pressures of a nearly incompressible cover on few nodes are not smooth. 0 for other surfaces and materials."""
    if material is None or not material.mixed or not touched_in_lines(shape) or len(grid.z) < 2:
        return 0.0
    spacings = float(np.ptp(grid.z) / np.diff(grid.z).max())
    return min(AXIAL / spacings**3, MOST_AXIAL)


def axial_warning(name: str, error: float) -> str | None:
    """The warning if that is significant, else None."""
    if error <= WORTH_A_WORD:
        return None
    return (
        f"contact {name!r}: there are few cells along the axis for a nearly incompressible material: the error of the "
        f"line load in the middle may be about {error:.0%}; give the mesh more of them (mesh.roller: axial=, six "
        "quadratic cells or twelve linear ones)"
    )


def _frame(shape: Any, theta: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    """The loaded point (3,), and the inward normal, the tangent across and that along the line (3, 3)."""
    normal, around = shape.normal(theta, z), shape.around(theta, z)
    return shape.point(theta, z), np.stack([-normal, around, np.cross(normal, around)])


def _error(mesh: Mesh, point: np.ndarray, axes: np.ndarray, half_width: float) -> float:
    missed = energy = 0.0
    for kind, cells in mesh.cells.items():
        factor, power = FACTORS[cell_kind(kind).degree]
        for start in range(0, len(cells), CHUNK):
            x = (mesh.points[cells[start : start + CHUNK]] - point) @ axes.T  # (e, k, 3), depth first
            length = np.ptp(x[..., 2], axis=1)
            x = x[..., :2]
            middle = x.mean(axis=1)
            distance = np.linalg.norm(middle, axis=1)
            ray = middle / np.maximum(distance, np.finfo(float).tiny)[:, None]
            height = np.ptp(np.einsum("eki,ei->ek", x, ray), axis=1)
            width = np.ptp(np.einsum("eki,ei->ek", x, np.stack([-ray[:, 1], ray[:, 0]], axis=1)), axis=1)
            r = np.hypot(distance, half_width)
            part = length * height * width * (np.maximum(ray[:, 0], 0.0) / r) ** 2
            energy += part.sum()
            missed += factor * np.sum(part * (height / r) ** power)
    return float(missed / energy)
