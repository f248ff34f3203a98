r"""Rigid interfaces: the nodes of a facet set slaved to six dofs at a reference point P (RBE2).

    u_a = t + r x (X_a - P),     u = T u^,     K^ = T^T K T,     M^ = T^T M T,     f^ = T^T f.

Modes, attachment modes and responses to loads all live in this constrained model, so a rigid interface never deforms.
P is the area centroid of the set; where the nodes lie on a circular cylinder, its foot on the cylinder's axis,
because a joint turns about P and an irregular mesh must not make it eccentric.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline.assembly import Sparse, rigid_modes
from warpffrf.offline.reference import FACET_DEGREE, rule


@dataclass(frozen=True)
class RigidInterface:
    """Interface `name` with its mesh `nodes` (sorted) and reference `point` (3,) [m]."""

    name: str
    nodes: np.ndarray
    point: np.ndarray


def rigid_interfaces(mesh: Mesh, names: list[str]) -> list[RigidInterface]:
    """The interfaces on the facet sets `names`. Raises `InputError` for an unknown set, or nodes shared by two sets."""
    found: list[RigidInterface] = []
    for name in names:
        facets = mesh.facets(name)
        nodes = facets.node_set
        for other in found:
            shared = np.intersect1d(nodes, other.nodes)
            if len(shared):
                raise InputError(
                    f"interfaces {other.name!r} and {name!r} share {len(shared)} nodes; a node can follow one rigid "
                    "interface only: separate the sets, or join them to one interface"
                )
        found.append(RigidInterface(name, nodes, reference_point(mesh, name)))
    return found


def reference_point(mesh: Mesh, name: str) -> np.ndarray:
    """Reference point (3,) [m] of the facet set: area centroid, moved onto the axis where the set is a cylinder."""
    facets = mesh.facets(name)
    total, moment = 0.0, np.zeros(3)
    for kind, nodes in facets.blocks.items():
        r = rule(kind, FACET_DEGREE[kind])
        x = mesh.points[nodes]
        tangents = np.einsum("mki,qkd->mqdi", x, r.gradients)
        area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=2) * r.weights
        total += float(area.sum())
        moment += np.einsum("mq,qk,mki->i", area, r.values, x)
    center = moment / total
    try:
        shape = Cylinder().fitted(mesh.points[facets.node_set])
    except InputError:
        return center
    size = float(np.max(np.ptp(mesh.points[facets.node_set], axis=0)))
    if float(shape.radius_at(0.0)) > size:  # a plane set fits a cylinder of any huge radius
        return center
    return shape.axis_point + np.dot(center - shape.axis_point, shape.e_a) * shape.e_a


def constraint(points: np.ndarray, interfaces: list[RigidInterface]) -> tuple[Sparse, np.ndarray]:
    """T (3 n, free + 6 i) and the free nodes: first the dofs of the nodes on no interface, then six of each
    interface."""
    n = len(points)
    slaved = np.zeros(n, dtype=bool)
    for interface in interfaces:
        slaved[interface.nodes] = True
    free = np.flatnonzero(~slaved)
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    blocks = [sp.csr_matrix((np.ones(len(dofs)), (dofs, np.arange(len(dofs)))), shape=(3 * n, len(dofs)))]
    for interface in interfaces:
        rows = (3 * interface.nodes[:, None] + np.arange(3)).ravel()
        R = sp.coo_matrix(rigid_modes(points[interface.nodes], interface.point))
        blocks.append(sp.csr_matrix((R.data, (rows[R.row], R.col)), shape=(3 * n, 6)))
    return sp.csr_matrix(sp.hstack(blocks, format="csr")), free
