r"""Stiffness and mass of solids and structural elements together.

Freedoms of a body of n nodes, r of which rotate: `3*node + component` for the displacements of all nodes, then three
rotations [rad] of each node in `rotating` (r,), in its order. A body of solids alone has r = 0.

Mass. The consistent mass of solids is a scalar matrix m_s on the nodes. Structural elements have mass points instead:
positions X_p, masses m_p and the motion u_p = D u of the freedoms u. Then

    M = [m_s (x) 1, 0; 0, 0] + D^T (m_p (x) 1) D,

and every inertia integral of the floating frame is that of the nodes with m_s and of the points with m_p, of which
`Inertia` is one scalar mass over both: exact for rotary inertia and for offsets.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.mesh.structure import Beam, PointMass, Shell, Spring
from warpffrf.model.reduced.inertia import InertiaTerms
from warpffrf.offline.fe import Assignment, Sparse, assemble, fe_matrices, scatter
from warpffrf.offline.inertia.invariants import centrifugal_acceleration, from_moments, inertia_terms, moments
from warpffrf.offline.structure.beam import BeamElements
from warpffrf.offline.structure.shell import CHUNK, ShellElements, directors, skew

Array = np.ndarray
ROUND_OFF = 1e-9  # of the stiffness of a spring: a direction written with nine figures


@dataclass(frozen=True, eq=False)
class Inertia:
    """Mass by scalar points: `positions` (P, 3) [m], `mass` (P, P) [kg] sparse and symmetric, for each direction, and
    `motion` (3 P, N) sparse: their displacements per freedom."""

    positions: Array
    mass: Sparse
    motion: Sparse


@dataclass(frozen=True, eq=False)
class BodyMatrices:
    """K [N/m, N, N m] and M [kg, kg m, kg m2] of the freedoms in the module docstring; `rotating` (r,) nodes;
    `inertia`: the points of the mass, None where it is on the nodes."""

    K: Sparse
    M: Sparse
    rotating: Array
    inertia: Inertia | None = None

    def inertia_terms(self, U: Array, points: Array, center: Array) -> InertiaTerms:
        """Inertia invariants of the modes `U` (N, k); `points` (n, 3) of the nodes and `center` (3,) of mass [m]."""
        if self.inertia is None:
            return inertia_terms(self.M, U, points, center)
        at = self.inertia
        return from_moments(*moments(at.mass, at.motion @ U, at.positions - center))

    def rotation_load(self, points: Array, center: Array) -> Array:
        """Loads (N, 6) of rotation on the freedoms, per product of angular velocities, see `inertia.invariants`."""
        if self.inertia is None:
            return np.asarray(self.M @ centrifugal_acceleration(points, center))
        at = self.inertia
        field = centrifugal_acceleration(at.positions, center)
        return np.asarray(at.motion.T @ (sp.kron(at.mass, sp.identity(3), format="csr") @ field))


def body_matrices(mesh: Mesh, assignment: Assignment) -> BodyMatrices:
    """K and M of a body of solids, of matrices, or with structural elements. Raises `InputError` for elements that are
    degenerate or attached to a node that cannot bear them."""
    if not mesh.structure.parts:
        K, M = fe_matrices(mesh, assignment)
        return BodyMatrices(K, M, np.zeros(0, dtype=np.int64))
    return _Assembly(mesh, assignment).finished()


class _Assembly:
    def __init__(self, mesh: Mesh, assignment: Assignment, empty: bool = False) -> None:
        self.points, self.structure = mesh.points, mesh.structure
        self.n = len(self.points)
        self.rotating = self.structure.rotating
        self.place = np.full(self.n, -1)
        self.place[self.rotating] = np.arange(len(self.rotating))
        self.size = 3 * (self.n + len(self.rotating))
        K, M = assemble(mesh.points, {} if empty else mesh.cells, assignment)
        K.resize((self.size, self.size))
        self.stiffness: list[Sparse] = [K]
        self.solid = sp.csr_matrix(M[0::3][:, 0::3])
        self.places: list[Array] = []
        self.masses: list[Array] = []
        self.motions: list[Sparse] = []

    def dofs(self, nodes: Array) -> Array:
        """(e, 6 k) of nodes (e, k) that rotate."""
        moving = 3 * nodes[:, :, None] + np.arange(3)
        turning = 3 * (self.n + self.place[nodes])[:, :, None] + np.arange(3)
        return np.concatenate([moving, turning], axis=2).reshape(len(nodes), -1)

    def finished(self) -> BodyMatrices:
        shells = self.structure.of(Shell)
        for shell, normals in zip(shells, directors(self.points, shells), strict=True):
            self._elements(shell, normals)
        for part in self.structure.parts:
            if isinstance(part, Beam):
                self._elements(part)
            elif isinstance(part, PointMass):
                self._point_mass(part)
            elif isinstance(part, Spring):
                self._spring(part)
        D = sp.csr_matrix(sp.vstack([sp.csr_matrix((0, self.size)), *self.motions], format="csr"))
        masses = np.concatenate([np.zeros(0), *self.masses])
        m = sp.diags(np.repeat(masses, 3))
        M = sp.csr_matrix(sp.kron(self.solid, sp.identity(3), format="csr"))
        M.resize((self.size, self.size))
        M = sp.csr_matrix(M + D.T @ m @ D)
        on_nodes = sp.eye(3 * self.n, self.size, format="csr")
        inertia = Inertia(
            np.concatenate([self.points, *self.places]),
            sp.csr_matrix(sp.block_diag([self.solid, sp.diags(masses)], format="csr")),
            sp.csr_matrix(sp.vstack([on_nodes, D], format="csr")),
        )
        parts = [part.tocoo() for part in self.stiffness]
        rows, columns, data = (np.concatenate([getattr(p, name) for p in parts]) for name in ("row", "col", "data"))
        K = sp.coo_matrix((data, (rows, columns)), shape=(self.size, self.size)).tocsr()
        return BodyMatrices(K, M, self.rotating, inertia)

    def _elements(self, part: Any, normals: Array | None = None) -> None:
        for start in range(0, len(part.nodes), CHUNK):
            here = slice(start, start + CHUNK)
            nodes = part.nodes[here]
            dofs = self.dofs(nodes)
            x = self.points[nodes]
            elements: Any
            if normals is not None:
                elements = ShellElements(x, part, normals[here])
            else:
                elements = BeamElements(x, part, here)
            K = elements.condensed()[0] if isinstance(elements, ShellElements) else elements.stiffness()
            self.stiffness.append(scatter(K, dofs, self.size))
            places, masses, motion = elements.mass_points()
            D = self.spread(motion, dofs)
            self._add(places.reshape(-1, 3), masses.ravel(), D)

    def spread(self, motion: Array, dofs: Array) -> Sparse:
        """(c e p, size) csr of c values at p points of each element, `motion` (e, p, c, m) per its `dofs` (e, m)."""
        count = motion[..., 0].size
        columns = np.broadcast_to(dofs[:, None, None, :], motion.shape)
        rows = np.broadcast_to(np.arange(count).reshape(*motion.shape[:3], 1), motion.shape)
        D = sp.csr_matrix((motion.ravel(), (rows.ravel(), columns.ravel())), shape=(count, self.size))
        D.eliminate_zeros()
        return D

    def _add(self, places: Array, masses: Array, motion: Sparse) -> None:
        self.places.append(places)
        self.masses.append(masses)
        self.motions.append(motion)

    def _motion_at(self, node: int, arm: Array, what: str) -> Sparse:
        """(6, size): displacement at `arm` (3,) [m] from the node, and rotation."""
        rows = sp.lil_matrix((6, self.size))
        rows[range(3), range(3 * node, 3 * node + 3)] = 1.0
        if self.place[node] >= 0:
            first = 3 * (self.n + int(self.place[node]))
            rows[:3, first : first + 3] = -skew(np.asarray(arm))
            rows[range(3, 6), range(first, first + 3)] = 1.0
        elif np.any(arm):
            raise InputError(
                f"{what}: node {node} has no rotation, it belongs to no shell, beam or rigid link, and cannot carry an "
                "offset, a moment or a lateral force of nodes apart; attach a rigid link"
            )
        return sp.csr_matrix(rows)

    def _point_mass(self, part: PointMass) -> None:
        values, axes = part.second_moments
        what = f"point mass at node {part.node}"
        arms = [part.offset]
        if np.any(part.inertia):
            reach = np.sqrt(3.0 * np.maximum(values, 0.0) / part.mass)
            arms = [
                part.offset + sign * r * axis for r, axis in zip(reach, axes.T, strict=True) for sign in (1.0, -1.0)
            ]
        motion = [self._motion_at(part.node, arm, what)[:3] for arm in arms]
        places = self.points[part.node] + np.array(arms)
        self._add(places, np.full(len(arms), part.mass / len(arms)), sp.csr_matrix(sp.vstack(motion, format="csr")))

    def _spring(self, part: Spring) -> None:
        first, second = part.nodes
        what = f"spring at nodes {part.nodes}"
        middle = 0.5 * (self.points[first] + self.points[second])
        apart = self.points[second] - self.points[first]
        k = part.stiffness
        length = np.linalg.norm(apart)
        if not np.any(k[3:]) and length > 0.0:
            # a force along the line of the nodes has no arm
            along = part.axes.T @ (apart / length)
            lateral = k[:3, :3] - (along @ k[:3, :3] @ along) * np.outer(along, along)
            if np.abs(lateral).max() <= ROUND_OFF * np.abs(k).max():
                middle = None
        arms = [np.zeros(3) if middle is None else middle - self.points[a] for a in part.nodes]
        if np.any(k[3:]) and np.any(self.place[list(part.nodes)] < 0):
            raise InputError(
                f"{what}: rotational stiffness needs two nodes with rotation; attach shells, beams or rigid links"
            )
        relative = self._motion_at(second, arms[1], what) - self._motion_at(first, arms[0], what)
        local = sp.block_diag([part.axes.T, part.axes.T]) @ relative
        self.stiffness.append(sp.csr_matrix(local.T @ sp.csr_matrix(k) @ local))


def rigid_motions(points: Array, rotating: Array, center: Array) -> Array:
    """Six rigid motions (3 n + 3 r, 6) about `center` (3,) [m]."""
    turns = np.tile(np.eye(3, 6, 3), (len(rotating), 1))
    return np.concatenate([rigid_modes(points, center), turns])


PRISM = np.array(
    [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
    + [t for i in range(4) for t in ([i, i + 4, (i + 1) % 4], [(i + 1) % 4, i + 4, (i + 1) % 4 + 4])]
)  # outward triangles between two ends of four corners


def beam_surface(mesh: Mesh) -> tuple[Array, Array, Sparse]:
    """Beams as prisms for pictures: points (q, 3) [m], triangles (t, 3), and the motion csr (3 q, 3 n + 3 r) of the
    points from the freedoms of the body."""
    beams = mesh.structure.of(Beam)
    if not beams:
        size = 3 * (len(mesh.points) + len(mesh.structure.rotating))
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), sp.csr_matrix((0, size))
    frame = _Assembly(mesh, Assignment((), {}), empty=True)
    places, motions = [], []
    for beam in beams:
        elements = BeamElements(mesh.points[beam.nodes], beam, slice(None))
        place, motion = elements.corners()
        places.append(place.reshape(-1, 3))
        motions.append(frame.spread(motion, frame.dofs(beam.nodes)))
    points = np.concatenate(places)
    triangles = (8 * np.arange(len(points) // 8)[:, None, None] + PRISM).reshape(-1, 3)
    return points, triangles, sp.csr_matrix(sp.vstack(motions, format="csr"))


def shell_stress(mesh: Mesh, layer: float) -> tuple[Array, Sparse]:
    """Points (p, 3) [m] at the centres of all shell elements, `layer` half thicknesses above their middle surface, and
    the stress there, csr (6 p, 3 n + 3 r) [Pa/m, Pa], user axes, from the freedoms of the body."""
    shells = mesh.structure.of(Shell)
    frame = _Assembly(mesh, Assignment((), {}), empty=True)
    places, operators = [], []
    for shell, normals in zip(shells, directors(mesh.points, shells), strict=True):
        for start in range(0, len(shell.nodes), CHUNK):
            here = slice(start, start + CHUNK)
            elements = ShellElements(mesh.points[shell.nodes[here]], shell, normals[here])
            place, S = elements.stress(shell.offset + 0.5 * layer * shell.thickness)
            dofs = frame.dofs(shell.nodes[here])
            places.append(place)
            operators.append(frame.spread(S[:, None], dofs))
    return np.concatenate(places), sp.csr_matrix(sp.vstack(operators, format="csr"))
