r"""Interfaces of a body: their motion and their unit loads.

Kinds. How the nodes of a facet set are constrained to each other, and how the motion of the set is defined.

Every kind has six coordinates, translation and rotation at a reference point X_P, and `X (3 k, 6)`, the rigid motions
about X_P of its k nodes.

*rigid* (RBE2): the nodes follow the six coordinates, `u_a = t + theta x (X_a - X_P)`. This is a constraint `u = T u^`:
modes, attachment modes and responses all belong to the constrained model, and the interface never deforms.

*average* (RBE3): the nodes deform freely, the coordinates are the rigid motion nearest to theirs over the area,

    minimise int |N u - x|^2 dA over rigid motions x    =>    (t, theta) = S u,    S = (X^T W X)^-1 X^T W,

`W (3 k, 3 k)` is the mass matrix of the facets at unit density, which is definite for every kind of facet (nodal areas
of quadratic facets are zero or negative at corners). `S X = 1`: a rigid motion is reproduced exactly. A force and
moment on the interface are applied by the transpose, `S^T (f, m)`: the work is the same, and the load is that of a
traction that varies linearly over the facets.

*free*: every node keeps its own three unit loads and attachment modes; `S` defines the motion of the set as a whole.

X_P is the area centroid of the set; if the nodes lie on a circular cylinder, it is projected onto the cylinder's axis,
because a joint rotates about X_P and an irregular mesh must not make it eccentric.

System. The constrained model of a body with interfaces, as used by the reduction, in its coordinates.

    u = T u^,     K^ = T^T K T,     M^ = T^T M T,     f^ = T^T f,

with the dofs of all nodes except those of rigid interfaces first, then six of each rigid interface (`interfaces.py`).
The unit loads of all interfaces are the columns of `loads` F: six unit loads on the coordinates of a rigid interface,
`S^T` of an averaging one, one on each dof of a free one. They are conjugate to the interface coordinates `F^T u^`, so
that attachment modes `G F` in the span of the global modes keep all of these at rest under residual loads.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.mesh.structure import RigidLink
from warpffrf.model.reduced.data import Interface
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline.fe import FACET_DEGREE, Sparse, rule

# Transverse extent over the longest extent, below which nodes count as collinear: the rotation about the line would be
# determined to this relative accuracy only.
COLLINEAR = 1e-6
# Limit of nodes of a free interface: each adds three attachment modes, and the cost of the dense algebra grows with the
# third power of the columns; 200 nodes, 600 modes, take seconds.
MOST_FREE_NODES = 200


@dataclass(frozen=True, eq=False)
class BodyInterface:
    """Interface `name` with its mesh `nodes` (k,), sorted, and reference `point` (3,) [m]."""

    name: str
    nodes: np.ndarray
    point: np.ndarray

    kind: ClassVar[str] = ""
    slaved: ClassVar[bool] = False  # whether its nodes follow the six coordinates and lose their own dofs

    @classmethod
    def of(cls, mesh: Mesh, name: str) -> BodyInterface:
        """The interface on the facet set `name`, a rigid one on the facet or node set; raises `InputError` if the set
        is unsuitable."""
        nodes = mesh.facets(name).node_set
        require_spread(mesh.points[nodes], name)
        return cls(name, nodes, reference_point(mesh, name))

    @property
    def dofs(self) -> np.ndarray:
        """Dofs (3 k,) of its nodes in the mesh."""
        return (3 * self.nodes[:, None] + np.arange(3)).ravel()


@dataclass(frozen=True, eq=False)
class RigidInterface(BodyInterface):
    """Its nodes move as one rigid body."""

    kind: ClassVar[str] = "rigid"
    slaved: ClassVar[bool] = True

    @classmethod
    def of(cls, mesh: Mesh, name: str) -> BodyInterface:
        """The interface on the facet set or the node set `name`; with a node of a rigid link it includes the whole
        link, and is at its first node where a node set is given. Raises `InputError` if a rotation of the set is
        undetermined."""
        plain = None if name in mesh.node_sets else super().of(mesh, name)
        nodes = mesh.node_sets[name] if plain is None else plain.nodes
        point = mesh.points[nodes].mean(axis=0) if plain is None else plain.point
        for link in mesh.structure.of(RigidLink):
            if np.isin(nodes, link.nodes).any():
                nodes = np.union1d(nodes, link.nodes)
                point = mesh.points[link.nodes[0]] if plain is None else point
        if not np.isin(nodes, mesh.structure.rotating).any():
            require_spread(mesh.points[nodes], name)
        return cls(name, nodes, point)


@dataclass(frozen=True, eq=False)
class AverageInterface(BodyInterface):
    """The mean rigid motion `S` (6, 3 k) of nodes that deform freely."""

    S: np.ndarray
    kind: ClassVar[str] = "average"

    @classmethod
    def of(cls, mesh: Mesh, name: str) -> AverageInterface:
        """The interface on the facet set `name`; raises `InputError` if the set is unsuitable."""
        plain = BodyInterface.of(mesh, name)
        return cls(name, plain.nodes, plain.point, mean_motion(mesh, name, plain.point))

    @cached_property
    def loads(self) -> np.ndarray:
        """Nodal loads (3 k, a) of its unit loads, here three forces and three moments."""
        return self.S.T


@dataclass(frozen=True, eq=False)
class FreeInterface(AverageInterface):
    """Every node keeps its own displacement; `S` (6, 3 k) is their mean rigid motion."""

    kind: ClassVar[str] = "free"

    @classmethod
    def of(cls, mesh: Mesh, name: str) -> AverageInterface:
        """The interface on the facet set `name`; raises `InputError` for more than `MOST_FREE_NODES` nodes."""
        _refuse_many(name, mesh.facets(name).node_set)
        return super().of(mesh, name)

    @cached_property
    def loads(self) -> np.ndarray:
        """Unit forces on every node (3 k, 3 k)."""
        return np.eye(3 * len(self.nodes))


INTERFACE_KINDS: dict[str, type[BodyInterface]] = {
    cls.kind: cls for cls in (RigidInterface, AverageInterface, FreeInterface)
}


def body_interfaces(mesh: Mesh, kinds: Mapping[str, str]) -> list[BodyInterface]:
    """The interfaces on facet sets, {set: kind}.

    Raises `InputError` for an unknown set or kind, nodes that a rigid interface shares with another one, fewer than
    three nodes off a line, more than `MOST_FREE_NODES` of a free one.
    """
    found: list[BodyInterface] = []
    for name, kind in kinds.items():
        if kind not in INTERFACE_KINDS:
            raise unknown_name(f"interface {name!r}: kind", kind, INTERFACE_KINDS)
        interface = INTERFACE_KINDS[kind].of(mesh, name)
        for other in found:
            if interface.slaved or other.slaved:
                _refuse_shared(interface, other)
        found.append(interface)
    return found


def rigid_links(mesh: Mesh, interfaces: Sequence[BodyInterface]) -> list[RigidInterface]:
    """The rigid links of a mesh that are part of no interface. Raises `InputError` for a node that two links share, or
    a link and a rigid interface that does not hold the whole link."""
    found: list[BodyInterface] = []
    for link in mesh.structure.of(RigidLink):
        if any(i.slaved and np.isin(link.nodes, i.nodes).all() for i in interfaces):
            continue
        made = RigidInterface(f"rigid link {link.name}", np.sort(link.nodes), mesh.points[link.nodes[0]])
        for other in [*(i for i in interfaces if i.slaved), *found]:
            _refuse_shared(made, other)
        found.append(made)
    return [i for i in found if isinstance(i, RigidInterface)]


def rigid_interfaces(mesh: Mesh, names: list[str]) -> list[RigidInterface]:
    """Rigid interfaces on the facet sets `names`, see `body_interfaces`."""
    found = body_interfaces(mesh, dict.fromkeys(names, RigidInterface.kind))
    return [i for i in found if isinstance(i, RigidInterface)]


def _refuse_shared(interface: BodyInterface, other: BodyInterface) -> None:
    shared = np.intersect1d(interface.nodes, other.nodes)
    if len(shared):
        raise InputError(
            f"interfaces {other.name!r} and {interface.name!r} share {len(shared)} nodes; a node can follow one rigid "
            "interface only: separate the sets, or join them to one interface"
        )


def _refuse_many(name: str, nodes: np.ndarray) -> None:
    if len(nodes) > MOST_FREE_NODES:
        raise InputError(
            f"interface {name!r}: kind 'free' keeps three dofs of each of its {len(nodes)} nodes, which is "
            f"{3 * len(nodes)} attachment modes; at most {MOST_FREE_NODES} nodes are taken: use a smaller set, or kind "
            "'average' or 'rigid'"
        )


def require_spread(points: np.ndarray, name: str) -> None:
    """Raises `InputError` if the nodes at `points` (k, 3) of interface `name` leave a rotation undetermined."""
    extent = np.linalg.svd(points - points.mean(axis=0), compute_uv=False) if len(points) else np.zeros(1)
    if len(points) < 3 or extent[1] <= COLLINEAR * extent[0]:
        raise InputError(
            f"interface {name!r}: at least three nodes that are not on one line are needed to follow a rotation, the "
            f"set has {len(points)}{'' if len(points) < 3 else ' on a line'}; choose a set with more facets"
        )


def facet_mass(mesh: Mesh, name: str) -> tuple[Sparse, float, np.ndarray]:
    """W (n, n) [m2] of one component over all mesh nodes, area [m2], first moment of area (3,) [m3] of a set."""
    n = len(mesh.points)
    W = sp.csr_matrix((n, n))
    total, moment = 0.0, np.zeros(3)
    for kind, nodes in mesh.facets(name).blocks.items():
        r = rule(kind, FACET_DEGREE[kind])
        x = mesh.points[nodes]
        tangents = np.einsum("mki,qkd->mqdi", x, r.gradients)
        area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=2) * r.weights
        local = np.einsum("mq,qa,qb->mab", area, r.values, r.values)
        k = nodes.shape[1]
        W = W + sp.coo_matrix((local.ravel(), (np.repeat(nodes, k, axis=1).ravel(), np.tile(nodes, k).ravel())), (n, n))
        total += float(area.sum())
        moment += np.einsum("mq,qk,mki->i", area, r.values, x)
    return sp.csr_matrix(W), total, moment


def mean_motion(mesh: Mesh, name: str, point: np.ndarray) -> np.ndarray:
    """S (6, 3 k): translation and rotation at `point` (3,) of the rigid motion nearest to the k nodes of the set."""
    nodes = mesh.facets(name).node_set
    W, _, _ = facet_mass(mesh, name)
    X = rigid_modes(mesh.points[nodes], point)
    size = float(np.max(np.ptp(mesh.points[nodes], axis=0)))
    scale = np.repeat([1.0, 1.0 / size], 3)  # rotations times the size are lengths, like translations
    WX = sp.kron(W[nodes][:, nodes], sp.identity(3), format="csr") @ (X * scale)
    return scale[:, None] * np.linalg.solve((X * scale).T @ WX, WX.T)


def reference_point(mesh: Mesh, name: str) -> np.ndarray:
    """Reference point (3,) [m] of the facet set: area centroid, projected onto the axis if the set is a cylinder."""
    _, total, moment = facet_mass(mesh, name)
    center = moment / total
    points = mesh.points[mesh.facets(name).node_set]
    try:
        shape = Cylinder().fitted(points)
    except InputError:
        return center
    size = float(np.max(np.ptp(points, axis=0)))
    if float(shape.radius_at(0.0)) > size:  # a plane set fits any cylinder of very large radius
        return center
    return shape.axis_point + np.dot(center - shape.axis_point, shape.e_a) * shape.e_a


def constraint(
    points: np.ndarray, interfaces: Sequence[BodyInterface], rotating: np.ndarray | None = None
) -> tuple[Sparse, np.ndarray]:
    """T (3 n + 3 r, free + 6 i + 3 f) and the free nodes: first the dofs of the nodes on no rigid interface, then six
    of each, then the rotations of those f of the `rotating` nodes (r,) that are on none."""
    n = len(points)
    rigid = [i for i in interfaces if i.slaved]
    slaved = np.zeros(n, dtype=bool)
    for interface in rigid:
        slaved[interface.nodes] = True
    free = np.flatnonzero(~slaved)
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    blocks = [sp.csr_matrix((np.ones(len(dofs)), (dofs, np.arange(len(dofs)))), shape=(3 * n, len(dofs)))]
    for interface in rigid:
        R = sp.coo_matrix(rigid_modes(points[interface.nodes], interface.point))
        blocks.append(sp.csr_matrix((R.data, (interface.dofs[R.row], R.col)), shape=(3 * n, 6)))
    T: Sparse = sp.csr_matrix(sp.hstack(blocks, format="csr"))
    if rotating is not None and len(rotating):
        T = sp.csr_matrix(sp.vstack([T, sp.csr_matrix((3 * len(rotating), T.shape[1]))], format="csr"))
        own = np.flatnonzero(~slaved[rotating])
        columns = T.shape[1] + np.arange(3 * len(own))
        rows = 3 * n + (3 * own[:, None] + np.arange(3)).ravel()
        for k, interface in enumerate(rigid):
            held = np.flatnonzero(np.isin(rotating, interface.nodes))
            rows = np.concatenate([rows, 3 * n + (3 * held[:, None] + np.arange(3)).ravel()])
            columns = np.concatenate([columns, np.tile(3 * len(free) + 6 * k + 3 + np.arange(3), len(held))])
        shape = (T.shape[0], T.shape[1] + 3 * len(own))
        T.resize(shape)
        T = sp.csr_matrix(T + sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=shape))
    return T, free


Array = np.ndarray


@dataclass(frozen=True, eq=False)
class InterfaceSystem:
    """`points` (n, 3) [m] of the mesh's nodes and the interfaces on them; the `rotating` nodes (r,) have rotations, and
    `links` are rigid without being interfaces."""

    points: Array
    interfaces: Sequence[BodyInterface]
    links: Sequence[BodyInterface] = ()
    rotating: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @cached_property
    def _constraint(self) -> tuple[Sparse, Array]:
        return constraint(self.points, [*self.interfaces, *self.links], self.rotating)

    @property
    def T(self) -> Sparse:
        """(3 n, n^): displacements of all nodes from the coordinates of the model."""
        return self.whole[: 3 * len(self.points)] if len(self.rotating) else self.whole

    @property
    def whole(self) -> Sparse:
        """(3 n + 3 r, n^): displacements of all nodes, then rotations of the rotating ones."""
        return self._constraint[0]

    @cached_property
    def _turning(self) -> Array:
        """The rotating nodes that keep their own rotations; those come last among the coordinates."""
        held = [np.zeros(0, dtype=np.int64), *(i.nodes for i in [*self.rigid_interfaces, *self.links])]
        return self.rotating[~np.isin(self.rotating, np.concatenate(held))]

    @property
    def free(self) -> Array:
        """Nodes that keep their own three dofs; those come first among the coordinates."""
        return self._constraint[1]

    @property
    def size(self) -> int:
        """Number n^ of coordinates."""
        return self.T.shape[1]

    @property
    def rigid_interfaces(self) -> list[BodyInterface]:
        """The interfaces with six coordinates of their own, in the order of the coordinates."""
        return [i for i in self.interfaces if i.slaved]

    @property
    def pinned(self) -> Array | None:
        """Coordinates (6,) of a statically determinate support: those of the first rigid interface, if any."""
        return 3 * len(self.free) + np.arange(6) if self.rigid_interfaces else None

    @property
    def coordinates(self) -> Array:
        """Position (n^, 3) [m] of each coordinate; NaN for those of rigid interfaces, which involve many nodes."""
        places = np.full((self.size, 3), np.nan)
        places[: 3 * len(self.free)] = np.repeat(self.points[self.free], 3, axis=0)
        if len(self._turning):
            places[-3 * len(self._turning) :] = np.repeat(self.points[self._turning], 3, axis=0)
        return places

    def rigid(self, center: Array) -> Array:
        """Rigid motions (n^, 6) about `center` (3,): three translations, three rotations."""
        parts = [rigid_modes(self.points[self.free], center)]
        for interface in [*self.rigid_interfaces, *self.links]:  # translation of its point, and the rotation itself
            parts.append(np.concatenate([rigid_modes(interface.point[None], center), np.eye(3, 6, 3)]))
        parts.append(np.tile(np.eye(3, 6, 3), (len(self._turning), 1)))
        return np.concatenate(parts)

    @cached_property
    def loads(self) -> Array:
        """F (n^, a): unit loads [N, N m] of all interfaces, one interface after the other."""
        parts = [np.zeros((self.size, 0))]
        first = 3 * len(self.free)
        for interface in self.interfaces:
            if isinstance(interface, AverageInterface):
                parts.append(self._at_nodes(interface) @ interface.loads)
            else:
                parts.append(np.eye(self.size, 6, -first))
                first += 6
        return np.concatenate(parts, axis=1)

    def wrenches(self) -> dict[str, Array]:
        """Loads (n^, 6) of each interface by name: unit forces [N] and moments [N m] at its point, distributed
        according to its kind; a free one like an averaging one."""
        found = {}
        first = 3 * len(self.free)
        for interface in self.interfaces:
            if isinstance(interface, AverageInterface):
                found[interface.name] = self._at_nodes(interface) @ interface.S.T
            else:
                found[interface.name] = np.eye(self.size, 6, -first)
                first += 6
        return found

    def _at_nodes(self, interface: BodyInterface) -> Sparse:
        """(n^, 3 k): loads in the model's coordinates from loads on the interface's nodes."""
        return sp.csr_matrix(self.T[interface.dofs].T)

    def motions(self, Phi: Array) -> list[Array]:
        """Translation [m] and rotation (m, 6) of each interface at its point, of every column of Phi (n^, m)."""
        found = []
        first = 3 * len(self.free)
        for interface in self.interfaces:
            if isinstance(interface, AverageInterface):
                found.append((interface.S @ (self.T[interface.dofs] @ Phi)).T.copy())
            else:
                found.append(Phi[first : first + 6].T.copy())
                first += 6
        return found

    def rotations(self, Phi: Array) -> dict[str, Array]:
        """Rotation (m, 3) [rad] of each rigid interface by name, of every column of Phi (n^, m)."""
        named = zip(self.interfaces, self.motions(Phi), strict=True)
        return {interface.name: motion[:, 3:] for interface, motion in named if interface.slaved}

    def products(self, Phi: Array) -> dict[str, Interface]:
        """The interfaces of a reduced body whose global modes are Phi (n^, m), by name."""
        found = {}
        for interface, motion in zip(self.interfaces, self.motions(Phi), strict=True):
            points = node_modes = None
            if interface.kind == "free":
                points = self.points[interface.nodes]
                node_modes = (self.T[interface.dofs] @ Phi).T.reshape(Phi.shape[1], -1, 3).copy()
            found[interface.name] = Interface(interface.kind, interface.point, motion, points, node_modes)
        return found

    def from_nodes(self, U: Array) -> Array:
        """Coordinates (n^, t) nearest to nodal displacements U (3 n, t): a rigid interface takes the best-fitting
        rigid motion of its nodes. Raises `InputError` for a body whose nodes rotate."""
        if len(self.rotating):
            raise InputError("given displacements determine no rotations of shells and beams; use another basis")
        T = self.T
        return sp.linalg.spsolve(sp.csc_matrix(T.T @ T), T.T @ U).reshape(self.size, -1)
