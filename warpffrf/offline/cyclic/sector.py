r"""One sector of a rotationally periodic mesh: check of periodicity, and its matrices.

Every sector describes displacements in its own axes, those of sector 0 rotated by `s phi`, `phi = 2 pi/N`, about the
third axis (the axis of rotation). In them all sectors have the same matrices: with the cells of sector 0 between its
own nodes (0) and those of the next (1),

    A = K_00 + K_11,     B = K_01,     f_s = A u_s + B u_{s+1} + B^T u_{s-1},

and likewise for M. A travelling wave `u_s = Re(u e^{i k s phi})` has `K_k = A + e^{i k phi} B + e^{-i k phi} B^T`
(D. L. Thomas 1979, Int. J. Numer. Meth. Eng. 14, 81).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh import Mesh
from warpffrf.offline.fe import Assignment, Sparse, assemble

PERIODIC = 1e-10  # of the body's radius: nodes of rotated sectors agree to round-off; 1 nm on 50 mm is detected (2e-8)


@dataclass(frozen=True)
class Sector:
    """Sector 0: `coordinates` (nn, 3) [m] in the sector's axes about the axis point; A, B of K and M, sparse."""

    count: int
    axes: np.ndarray  # (3, 3), columns are the sector's axes in user axes
    origin: np.ndarray  # (3,) m, on the axis
    coordinates: np.ndarray
    K: tuple[Sparse, Sparse]
    M: tuple[Sparse, Sparse]

    @property
    def phi(self) -> float:
        """Angle of a sector [rad]."""
        return 2.0 * np.pi / self.count

    @property
    def nodes(self) -> int:
        """Nodes of a sector."""
        return len(self.coordinates)

    def harmonic(self, pair: tuple[Sparse, Sparse], k: int) -> Sparse:
        """A + e^{ik phi} B + e^{-ik phi} B^T, real where the factors are."""
        A, B = pair
        e = phase(k, self.count)
        return sp.csr_matrix(A + e * B + np.conj(e) * B.T)


def phase(k: int, count: int):
    """e^{2 pi i k/N}, exactly real for k = 0 and k = N/2 so that those harmonics stay real."""
    k %= count
    if k == 0:
        return 1.0
    if 2 * k == count:
        return -1.0
    return np.exp(2j * np.pi * k / count)


def sector_axes(axis: np.ndarray, toward: np.ndarray) -> np.ndarray:
    """Right-handed axes (3, 3) in columns: radial direction nearest `toward`, its neighbour, and the unit `axis`."""
    e_0 = toward - np.dot(toward, axis) * axis
    e_0 = e_0 / np.linalg.norm(e_0)
    return np.stack([e_0, np.cross(axis, e_0), axis], axis=1)


def turned(points: np.ndarray, axes: np.ndarray, angle: float) -> np.ndarray:
    """Vectors (n, 3) in user axes rotated by `angle` [rad] about the third of `axes`."""
    local = points @ axes
    c, s = np.cos(angle), np.sin(angle)
    return (local @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])) @ axes.T


def periodicity_fault(mesh: Mesh, whole_sets: list[str], assignment: Assignment | None = None) -> str | None:
    """The reason why `mesh` cannot be treated as its `cyclic` states, or None. `whole_sets` are facet sets that must be
    periodic too, and so must the materials."""
    if mesh.cyclic is None:
        return "the mesh is not marked as rotationally periodic"
    N, n = mesh.cyclic.sectors, len(mesh.points)
    nn = n // N
    axes = sector_axes(mesh.cyclic.axis_direction, _off_axis(mesh.cyclic.axis_direction))
    relative = mesh.points - mesh.cyclic.axis_point
    size = float(np.max(np.linalg.norm(relative - np.outer(relative @ axes[:, 2], axes[:, 2]), axis=1)))
    local = (relative @ axes).reshape(N, nn, 3)
    angle = 2.0 * np.pi * np.arange(N)[:, None] / N
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = local[0].T
    error = np.abs(np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(z, (N, nn))], axis=2) - local)
    if float(error.max()) > PERIODIC * size:
        return f"nodes of rotated sectors differ by {error.max():.3g} m"
    shift = nn * np.arange(N)[:, None, None]
    for kind, nodes in mesh.cells.items():
        cells = nodes.reshape(N, -1, nodes.shape[1])
        if cells[0].max() >= 2 * nn:
            return f"{kind} cells of sector 0 reach beyond sector 1"
        if not np.array_equal((cells[0][None] + shift) % n, cells):
            return f"{kind} cells of the sectors have different numberings"
        parts = None if assignment is None else assignment.of_cell[kind].reshape(N, -1)
        if parts is not None and np.any(parts != parts[0]):
            return "the materials differ from sector to sector"
    for name in whole_sets:
        nodes = mesh.facets(name).node_set
        here = nodes[nodes < nn]
        if not np.array_equal(np.sort(((here[None] + shift[:, :, 0]) % n).ravel()), nodes):
            return f"facet set {name!r} is not periodic"
    return None


def _off_axis(axis: np.ndarray) -> np.ndarray:
    return np.eye(3)[int(np.argmin(np.abs(axis)))]


def assemble_sector(mesh: Mesh, assignment: Assignment, axes: np.ndarray) -> Sector:
    """Matrices of sector 0 of a periodic mesh, in the sector's `axes` (third column: the axis of rotation)."""
    cyclic = mesh.cyclic
    if cyclic is None:
        raise ValueError("assemble_sector needs a periodic mesh")
    N = cyclic.sectors
    nn = len(mesh.points) // N
    cells = {kind: nodes[: len(nodes) // N] for kind, nodes in mesh.cells.items()}
    own_materials = {kind: part[: len(part) // N] for kind, part in assignment.of_cell.items()}
    K, M = assemble(mesh.points[: 2 * nn], cells, Assignment(assignment.materials, own_materials))
    phi = 2.0 * np.pi / N
    own = sp.kron(sp.identity(nn), axes)
    next_axes = np.stack([turned(a[None], axes, phi)[0] for a in axes.T], axis=1)
    turn = sp.csr_matrix(sp.block_diag([own, sp.kron(sp.identity(nn), next_axes)]))
    m = 3 * nn

    def split(matrix) -> tuple[Sparse, Sparse]:
        local = sp.csr_matrix(turn.T @ matrix @ turn)
        return sp.csr_matrix(local[:m, :m] + local[m:, m:]), sp.csr_matrix(local[:m, m:])

    coordinates = (mesh.points[:nn] - cyclic.axis_point) @ axes
    return Sector(N, axes, cyclic.axis_point, coordinates, split(K), split(M))
