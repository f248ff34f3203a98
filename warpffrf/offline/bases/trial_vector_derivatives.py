r"""Joint modes by trial vector derivatives: the change of static and vibration modes with the state of a joint.

W. Witteveen, F. Pichler, "Efficient model order reduction for the dynamics of nonlinear multilayer sheet structures
with trial vector derivatives" (Shock and Vibration 2014); F. Pichler, W. Witteveen, P. Fischer, Multibody Syst. Dyn. 40
(2017) 407. The method is theirs; the loads below are a reconstruction of it.

The base of modes phi_i (interface attachment modes, scaled to unit energy, and vibration modes of the free body with
the joint open) gives each pair of partner nodes of two facet sets a gap g_i along the normal and a slip w_i along two
tangents. With penalties that depend on the state of the joint, K(q) = K + k sum_i q_i dK_i, the derivative of mode j
along coordinate i solves K dphi = -dK_i phi_j: a static response to pressures and tractions

    g_i g_j n   (i <= j),       g_i w_j         (all i, j)

that act, equal and opposite, on the two faces, times nodal areas int N dA. The responses are made orthogonal to the
base in the inner product of K and each set, scaled to unit energy, is replaced by its leading vectors,

    X^T K X z = lambda z,       v = X z/sqrt(lambda),       left out = sqrt(sum of the other lambda/sum of all).

They join the basis as coordinates without dynamics of their own. The omitted part of the derivatives is reported; it
is no measure of the error of pressures and of loss per cycle, see docs/studies/joint_bases.md. Small-sliding contact
(`surfaces.Matched`) needs no such modes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from scipy.spatial import KDTree

from warpffrf.model.errors import InputError, require_count
from warpffrf.model.mesh import Mesh
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import ModalBasis
from warpffrf.offline.bases.modes import BasisProblem, RawBasis, lowest_modes
from warpffrf.offline.bases.vibrations import FreeFree
from warpffrf.offline.elastic import Array, ElasticModel
from warpffrf.offline.fe import FACET_DEGREE, rule

ROUND_OFF = 1e-14  # of the largest energy or eigenvalue: the noise of a Gram matrix is 1e-16
ASIDE = 0.5  # of the side of a node's share of the face: nodes further away along the face are not partners
MOSTLY_THERE = 0.5  # energy that must remain of a vector after a second orthogonalisation: round-off shrinks


@dataclass(frozen=True, eq=False)
class NodePairs:
    """Partner nodes of two faces: `relative` (3 p, 3 n) csr, displacement of the second against the first along n, t1,
    t2 of the first face; `area` (p,) [m2] of the first node; `alone`: nodes of the first face without a partner.
    """

    relative: Any
    area: Array
    alone: int


def node_pairs(mesh: Mesh, first: str, second: str) -> NodePairs:
    """The pairs; each node of the first face with the nearest of the second. Nodes shared by both are omitted.

    Raises `InputError` for an unknown facet set, and if no node has a partner.
    """
    faces, others = mesh.facets(first), mesh.facets(second).node_set
    nodes, normal, area = faces.node_set, faces.node_normals(mesh.points), np.zeros(len(mesh.points))
    for kind, facets in faces.blocks.items():
        r = rule(kind, FACET_DEGREE[kind])
        along = np.einsum("mkx,qkd->mqdx", mesh.points[facets], r.gradients)
        size = np.linalg.norm(np.cross(along[:, :, 0], along[:, :, 1]), axis=2)
        np.add.at(area, facets, np.einsum("q,mq,qk->mk", r.weights, size, r.values))
    partner = others[np.asarray(KDTree(mesh.points[others]).query(mesh.points[nodes])[1])]
    apart = mesh.points[partner] - mesh.points[nodes]
    aside = np.linalg.norm(apart - np.einsum("px,px->p", apart, normal)[:, None] * normal, axis=1)
    near = aside <= ASIDE * np.sqrt(area[nodes].sum() / len(nodes))
    if not near.any():
        raise InputError(
            f"trial vector derivatives: no node of {first!r} has a partner on {second!r}; the nearest is "
            f"{aside.min():.3g} m aside. Name two facet sets that face each other"
        )
    kept = near & (nodes != partner)
    nodes, partner, normal = nodes[kept], partner[kept], normal[kept]
    helper = np.where(np.abs(normal[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    t1 = helper - np.einsum("px,px->p", helper, normal)[:, None] * normal
    t1 /= np.linalg.norm(t1, axis=1)[:, None]
    frames = np.stack([normal, t1, np.cross(normal, t1)], axis=1)
    rows = np.repeat(np.arange(3 * len(nodes)), 3)
    entries = []
    for sign, ends in ((-1.0, nodes), (1.0, partner)):
        columns = np.broadcast_to(3 * ends[:, None, None] + np.arange(3), frames.shape).ravel()
        entries.append(sp.coo_matrix((sign * frames.ravel(), (rows, columns)), (3 * len(nodes), 3 * len(mesh.points))))
    return NodePairs(sp.csr_matrix(entries[0] + entries[1]), area[nodes], int(np.sum(~near)))


@dataclass(frozen=True, eq=False)
class JointModes:
    """columns (n, m), of unit energy, K-orthogonal to the base; of the normal and of the tangential derivatives: their
    number, the number of vectors used, and the omitted part (0 to 1)."""

    columns: Array
    derivatives: tuple[int, int]
    taken: tuple[int, int]
    left_out: tuple[float, float]


def joint_modes(
    model: ElasticModel, base: Array, relative: Any, area: Array, normal: int, tangential: int
) -> JointModes:
    """Leading vectors, `normal` and `tangential` of them, of the derivatives of the base (n, b).

    relative (3 p, n): of the pairs in the model's coordinates; area (p,) [m2].
    """
    base = _independent(model, base)
    seen = (relative @ base).reshape(-1, 3, base.shape[1])
    g, w = seen[:, 0], seen[:, 1:]
    weights = area / max(float(np.sqrt(area @ np.sum(g * g, axis=1))), np.finfo(float).tiny)
    loads = [np.zeros((len(area), 3, 0))] * 2
    i, j = np.triu_indices(base.shape[1])
    loads[0] = np.zeros((len(area), 3, len(i)))
    loads[0][:, 0] = weights[:, None] * g[:, i] * g[:, j]
    loads[1] = np.zeros((len(area), 3, base.shape[1] ** 2))
    loads[1][:, 1:] = (weights[:, None, None, None] * g[:, None, :, None] * w[:, :, None, :]).reshape(len(area), 2, -1)
    columns, derivatives, taken, left_out = [], [], [], []
    for load, wanted in zip(loads, (normal, tangential), strict=True):
        X = model.flexibility(relative.T @ load.reshape(3 * len(area), -1))
        V, rest = _leading(model, _freed(model, X, base), base, wanted)
        columns.append(V)
        derivatives.append(X.shape[1])
        taken.append(V.shape[1])
        left_out.append(rest)
    return JointModes(np.concatenate(columns, axis=1), *(tuple(v) for v in (derivatives, taken, left_out)))  # type: ignore[arg-type]


def _independent(model: ElasticModel, base: Array) -> Array:
    """K-orthonormal basis of the base (n, b); dependent directions of unit energy are dropped."""
    base = model.without_rigid(base)
    base = base / np.sqrt(np.einsum("nb,nb->b", base, model.K @ base))
    values, vectors = np.linalg.eigh(base.T @ (model.K @ base))
    keep = values > ROUND_OFF * values[-1]
    return base @ (vectors[:, keep] / np.sqrt(values[keep]))


def _freed(model: ElasticModel, X: Array, base: Array) -> Array:
    """X without its K-projection on the K-orthonormal base."""
    for _ in range(2):  # twice is enough (Kahan, Parlett)
        X = X - base @ (base.T @ (model.K @ X))
    return X


def _leading(model: ElasticModel, X: Array, base: Array, wanted: int) -> tuple[Array, float]:
    """Up to `wanted` leading vectors (n, m) of the columns of X, K-orthogonal to the base, scaled to unit energy, and
    the omitted part."""
    energy = np.einsum("nt,nt->t", X, model.K @ X)
    straining = energy > ROUND_OFF * energy.max(initial=0.0)
    if not straining.any() or not wanted:
        return X[:, :0], 1.0 if straining.any() else 0.0
    X = X[:, straining] / np.sqrt(energy[straining])
    values, Z = np.linalg.eigh(X.T @ (model.K @ X))
    values, Z = np.maximum(values[::-1], 0.0), Z[:, ::-1]
    kept = min(wanted, int(np.sum(values > ROUND_OFF * values[0])))
    V = _freed(model, X @ (Z[:, :kept] / np.sqrt(values[:kept])), base)
    again, Y = np.linalg.eigh(V.T @ (model.K @ V))
    there = again > MOSTLY_THERE
    return V @ (Y[:, there] / np.sqrt(again[there])), float(np.sqrt(values[kept:].sum() / values.sum()))


@named_arguments
@dataclass(frozen=True, kw_only=True)
class TrialVectorDerivatives(ModalBasis):
    """Vibration modes of the free body and joint modes of two touching faces `first` and `second` (facet sets of the
    mesh): derivatives of static and vibration modes with respect to the state of the joint (Witteveen, Pichler 2014).

    normal, tangential: number of joint modes from pressures and from tractions. For comparison with the published
    method; small-sliding contact (`surfaces.Matched`) resolves every cell without such modes. Raises `InputError`.
    """

    kind: ClassVar[str] = "trial_vector_derivatives"
    takes: ClassVar[Mapping[str, str]] = FreeFree.takes
    first: str = ""
    second: str = ""
    normal: int = 20
    tangential: int = 20

    def __post_init__(self) -> None:
        super().__post_init__()
        label = f"basis {self.kind!r}"
        for name in ("first", "second"):
            if not isinstance(getattr(self, name), str) or not getattr(self, name):
                raise InputError(
                    f"{label}: {name} must name a facet set; give bases.TrialVectorDerivatives(first=..., second=...), "
                    "the two faces of the joint"
                )
        if self.first == self.second:
            raise InputError(f"{label}: first and second are both {self.first!r}; name the two faces of the joint")
        for name in ("normal", "tangential"):
            object.__setattr__(self, name, require_count(getattr(self, name), f"{label}: {name}", 0))

    @property
    def facet_sets(self) -> tuple[str, ...]:
        """The two faces."""
        return self.first, self.second

    def columns(self, problem: BasisProblem) -> RawBasis:
        """Vibration modes and joint modes of the body `problem`. Raises `InputError` if there is no mode to
        differentiate."""
        if problem.mesh is None:
            raise ValueError("trial vector derivatives need the mesh of the body")
        problem.require_fits(self.kind, problem.limits.count or 0, "vibration modes")
        pairs = node_pairs(problem.mesh, self.first, self.second)
        omega, V, notes = lowest_modes(problem.model, problem.limits, self.mode_tolerance)
        base = np.concatenate([problem.unit_loads()[1], V], axis=1)
        if not base.shape[1]:
            raise InputError(
                f"basis {self.kind!r}: there is no mode to take derivatives of; name interfaces, or give modes or "
                "max_frequency"
            )
        found = joint_modes(
            problem.model, base, pairs.relative @ problem.system.T, pairs.area, self.normal, self.tangential
        )
        if pairs.alone:
            notes.append(f"{pairs.alone} node(s) of {self.first!r} have no partner on {self.second!r} and no load")
        for what, wanted, taken in zip(
            ("normal", "tangential"), (self.normal, self.tangential), found.taken, strict=True
        ):
            if taken < wanted:
                notes.append(f"{what}={wanted}: the derivatives hold {taken} directions, these are taken")
        facts = {
            "vibration_modes": len(omega),
            "node_pairs": len(pairs.area),
            "derivatives": list(found.derivatives),
            "joint_modes": list(found.taken),
            "derivatives_left_out": list(found.left_out),
        }
        return RawBasis(np.concatenate([V, found.columns], axis=1), notes=notes, facts=facts)
