r"""Flexible bodies whose surface is an exact elastic half-plane or half-space: contact without finite elements.

A `ReducedBody` with a plane contact surface, no global modes, and a compliance from closed forms: results of the engine
differ from Hertz, Cattaneo, Mindlin and Carter by the contact algorithm alone. It is fixed at interface "hold"; mass
and inertia have no significance.

Normal: `C_ij = int psi_i K psi_j`, exact for nodal functions (`compliances`); the body stores D = M^-1 C M^-1, of which
M D M is used. Tangential: mean displacement of a cell by uniform tractions on cells (`influence`), per force, as in
every body.

*Half-plane*: two rows of nodes at the ends of the width, each a half-plane of its own under half of the load: under a
uniform load they move equally. *Coupling* between normal and tangential, which vanishes between like bodies and which
the closed forms of friction neglect, is omitted.
"""

from __future__ import annotations

import numpy as np

from references.closed_forms import contact_modulus
from references.half_space.compliances import plane_table, space_table, toeplitz
from references.half_space.influence import mean_2d, mean_3d
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery, Tangential
from warpffrf.model.reduced.data import DisplaySurface, Interface
from warpffrf.model.surfaces import Plane

Array = np.ndarray
FACE, HOLD = "face", "hold"  # names of surface and interface
# theta runs along +x, z along +y, the normal is +z: e_theta x t_z = n
PLANE = Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0))


def half_plane(columns: int, pitch: float, width: float, material: Material, depth: float) -> ReducedBody:
    """Plane strain; `columns` nodes `pitch` [m] apart along x about the origin, `width` [m] along y; displacements
    against a point at `depth` [m], above columns * pitch."""
    modulus = contact_modulus(material)
    grid_nodes = toeplitz(plane_table("nodes", pitch, columns, depth)) / modulus
    cells = mean_2d(columns, pitch, modulus, depth) / (pitch * 0.5 * width)
    tangential = np.einsum("de,ij,kl->dikejl", np.eye(2), cells, np.eye(2))
    return _body(
        _grid(columns, pitch, np.array([-0.5, 0.5]) * width), np.kron(grid_nodes, 0.5 * width * np.eye(2)), tangential
    )


def half_space(columns: int, rows: int, pitch: float, material: Material) -> ReducedBody:
    """Square cells of `pitch` [m] about the origin, `columns` along x and `rows` along y."""
    grid = _grid(columns, pitch, pitch * (np.arange(rows) - 0.5 * (rows - 1)))
    centers = np.stack(np.meshgrid(grid.theta, grid.z, indexing="ij"), axis=-1).reshape(-1, 2)
    size = (pitch, pitch)
    grid_nodes = toeplitz(space_table("nodes", size, (columns, rows))) / contact_modulus(material)
    cells = mean_3d(centers, size, material) / pitch**2
    n = len(centers)
    return _body(grid, grid_nodes, cells.reshape(n, 2, n, 2).transpose(1, 0, 3, 2))


def _grid(columns: int, pitch: float, z: Array) -> SurfaceGrid:
    start = -0.5 * (columns - 1) * pitch
    return SurfaceGrid(np.asarray(PLANE.e_0), start, pitch, columns, False, z, columns)


def _body(grid: SurfaceGrid, C: Array, tangential: Array) -> ReducedBody:
    """C (n, n) [m3/Pa] of the nodes; tangential [m/N], (2 n, 2 n) in the shape of its directions and cells."""
    n = len(C)
    around, along = (np.linalg.inv(M) for M in (grid.gram_theta(), grid.gram_z(PLANE)))
    inverse = np.kron(around, along)
    D = inverse @ C @ inverse
    cells = SurfaceGrid(grid.e_0, grid.theta_start, grid.pitch, grid.columns, False, grid.z, grid.columns, "cells")
    shear = Tangential(
        cells, tangential.reshape(1, 2 * n, 2 * n), np.zeros((1, n, 2 * n)), np.zeros((2, n, 0)),
        Recovery(np.zeros((1, 9, 2 * n), np.float32), 1, np.eye(3)),
    )  # fmt: skip
    recovery = Recovery(np.zeros((1, 9, n), np.float32), 1, np.eye(3))
    surface = ContactSurface(FACE, PLANE, grid, 0.5 * (D + D.T)[None], np.zeros((n, 0)), recovery, tangential=shear)
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]) * grid.pitch
    skin = DisplaySurface(corners, np.array([[0, 1, 2]]), np.zeros((0, 3, 3)))
    hold = Interface("rigid", np.zeros(3), np.zeros((0, 6)))
    return ReducedBody(1.0, np.zeros(3), np.eye(3), np.zeros(0), {HOLD: hold}, {FACE: surface}, skin)
