r"""The constrained model of a body with interfaces: what the reduction needs to know of them, in its coordinates.

    u = T u^,     K^ = T^T K T,     M^ = T^T M T,     f^ = T^T f,

with the dofs of all nodes but those of rigid interfaces first, then six of each rigid interface (`interfaces.py`). The
unit loads of all interfaces are the columns of `loads` F: six unit loads on the coordinates of a rigid interface, `S^T`
of an averaging one, one on each dof of a free one. Their work is conjugate to the interface coordinates `F^T u^`, so
that attachment modes `G F` in the span of the global modes keep all of these at rest under residual loads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh.rigid import rigid_modes
from warpffrf.model.reduced.data import Interface
from warpffrf.offline.fe.assembly import Sparse
from warpffrf.offline.interfaces.kinds import AverageInterface, BodyInterface, constraint

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class InterfaceSystem:
    """`points` (n, 3) [m] of the mesh's nodes and the interfaces on them."""

    points: Array
    interfaces: Sequence[BodyInterface]

    @cached_property
    def _constraint(self) -> tuple[Sparse, Array]:
        return constraint(self.points, self.interfaces)

    @property
    def T(self) -> Sparse:
        """(3 n, n^): displacements of all nodes from the model's coordinates."""
        return self._constraint[0]

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
        """Those with six coordinates of their own, in their order among the coordinates."""
        return [i for i in self.interfaces if i.slaved]

    @property
    def pinned(self) -> Array | None:
        """Coordinates (6,) whose holding is statically determinate: those of the first rigid interface, if any."""
        return 3 * len(self.free) + np.arange(6) if self.rigid_interfaces else None

    @property
    def coordinates(self) -> Array:
        """Place (n^, 3) [m] of each coordinate; NaN for those of rigid interfaces, which touch many nodes."""
        places = np.full((self.size, 3), np.nan)
        places[: 3 * len(self.free)] = np.repeat(self.points[self.free], 3, axis=0)
        return places

    def rigid(self, center: Array) -> Array:
        """Rigid motions (n^, 6) about `center` (3,): three translations, three rotations."""
        parts = [rigid_modes(self.points[self.free], center)]
        for interface in self.rigid_interfaces:  # translation of its point, and the rotation itself
            parts.append(np.concatenate([rigid_modes(interface.point[None], center), np.eye(3, 6, 3)]))
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
        """Loads (n^, 6) of each interface by name: of unit forces [N] and moments [N m] at its point, in the way that
        its kind spreads them; a free one like an averaging one."""
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
        """Coordinates (n^, t) nearest to nodal displacements U (3 n, t): a rigid interface takes the rigid motion that
        fits its nodes best."""
        T = self.T
        return sp.linalg.spsolve(sp.csc_matrix(T.T @ T), T.T @ U).reshape(self.size, -1)
