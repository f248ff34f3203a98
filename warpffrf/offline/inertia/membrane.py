r"""The membrane energy of a body as a sum of few squares: the part that no in-plane motion relieves.

With the second-order strain E2 of `second_order`, which is orthogonal to that of every mode, the elastic energy is

    V = |z|^2/2 + V4 + ...,      z_i = omega_i q_i,      V4 = 1/2 int E2 . C E2 dV = 1/2 r.A r,

r the products of z of `second_order.Pairs`, A (P, P) the Gram matrix of the strains of unit pairs in the energy, summed
over cells: symmetric and never negative, whatever the round-off in the fields. The algebraically identical
K4 - a.K_f^+ a/2 would be the small difference of large numbers. With its eigenvalues A v_r = lambda_r v_r

    V4 = 1/2 sum_r e_r^2,      e_r = sqrt(lambda_r) v_r.r = q.L_r q/2,      L_r = 2 sqrt(lambda_r) Omega S_r Omega,

S_r the symmetric matrix of v_r.r. Eigenvalues below `TRUNCATION` of the largest are omitted; as |r| = |z|^2, this
changes V4 by less than this fraction of the largest V4 of all states of the same V2. Terms omitted from V altogether:

* terms int sigma . H(phi)^T H(Theta) of bending stress, smaller than those kept by thickness over length, and those of
  fourth order of a body that bends without stretching; both scale with the square of rotations from the mean axes;
* inertia of Theta.

**No bending.** Stretching becomes significant in a mode at the amplitude at which its energy (eta/2) . C (eta/2) equals
that of the linear strain: with kappa_i twice this energy at z_i = 1, it is z_i^2 = 1/kappa_i, and the strain, as a
uniform one of the same energy, 1/sqrt(kappa_i int E dV): about (t/L)^2 of a plate, a fraction of one of a solid. If
that is above `BENDING` in all modes, none bends, and the terms would be for strains at which the material law fails.

**All relieved.** A beam whose ends move freely has next to no V4; the remainder due to its mesh is not kept: it is zero
if the largest eigenvalue is below `RELIEVED` of the largest kappa.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.report import stiffest
from warpffrf.offline.elastic import ElasticModel
from warpffrf.offline.fe import CHUNK_BYTES, Assignment, Sparse, physical_gradients
from warpffrf.offline.inertia.second_order import SecondOrderStrain, second_order_motion, second_order_shapes
from warpffrf.offline.interfaces import InterfaceSystem
from warpffrf.offline.products import MembraneTerms

Array = np.ndarray
MEMBRANE = "membrane"  # its name in `ReductionOptions(stiffening=)`
MODES = 20  # default number with membrane energy: 210 pairs, each a field of displacements
TRUNCATION = 1e-2  # of the largest eigenvalue: a plate's deflection changes by less than 0.05 %
BENDING = 0.1  # strain, see the module docstring: a beam five times as long as thick has 0.02, a cube 0.24
RELIEVED = 5e-3  # of stretching alone: a free beam ten times as long as thick keeps 1e-4, a free plate 5e-2
LOCKING = ("hex8", "wedge6", "tet4")  # linear cells: their second-order strain is relieved on average at best


def membrane_terms(
    mesh: Mesh,
    assignment: Assignment,
    model: ElasticModel,
    system: InterfaceSystem,
    M: Sparse,
    U: Array,
    omega: Array,
    modes: int | None,
    rotations: Mapping[str, Array],
    *,
    memory_limit: int,
    chunk_bytes: int = CHUNK_BYTES,
) -> MembraneTerms:
    """Membrane energy of the first `modes` (None: up to `MODES`) of the modes `U` (3 n, k) of frequencies `omega` (k,)
    [rad/s]; `rotations` (k, 3) [rad] of each rigid interface by these modes, `M` (3 n, 3 n) [kg] nodal mass matrix.

    Raises `InputError` if none of the modes bends, if more are requested than there are, and if the memory limit is
    too small.
    """
    covered = len(omega)
    count = min(MODES, covered) if modes is None else modes
    if not covered:
        raise InputError(
            "stiffening='membrane': a membrane basis without bending modes: the body has no modes with inertia "
            "terms; request some (modes=, max_frequency=, inertia_modes=)"
        )
    if count > covered:
        raise InputError(
            f"reduce: membrane_modes={count}, of a body with {covered} modes that have inertia terms; request fewer, "
            "or raise modes and inertia_modes"
        )
    scale = omega[:count]
    strain = SecondOrderStrain(mesh.points, mesh.cells, assignment, U[:, :count] / scale, chunk_bytes)
    pairs = strain.pairs
    turned = {name: turn[:count] / scale[:, None] for name, turn in rotations.items()}
    theta, bare = second_order_motion(strain, model, system, M, turned, memory_limit=memory_limit)
    kappa = bare[pairs.first == pairs.second]
    bending = _require_bending(mesh, assignment, kappa)
    moved = second_order_shapes(pairs, theta, scale, M, U)
    A = strain.energies(theta)
    values, vectors = np.linalg.eigh(A)
    values, vectors = values[::-1], vectors[:, ::-1]
    kept = int(np.sum(values > TRUNCATION * values[0])) if values[0] > RELIEVED * kappa.max() else 0
    vectors = vectors[:, :kept] * np.sign(vectors[np.abs(vectors[:, :kept]).argmax(axis=0), np.arange(kept)])
    S, root = pairs.forms(vectors), np.sqrt(values[:kept])
    whole = (slice(None), slice(None, count), slice(None, count))
    forms, products = np.zeros((2, kept, covered, covered))
    both = np.outer(scale, scale)
    forms[whole] = 2.0 * root[:, None, None] * (S * both)
    products[whole] = S / both / root[:, None, None]
    facts = {
        "modes": count,
        "pairs": len(pairs),
        "rank": kept,
        "truncation": float(max(values[kept], 0.0) / values[0]) if 0 < kept < len(values) else 0.0,
        "share_left_out": float(values[kept:].clip(0.0).sum() / values.clip(0.0).sum()) if kept else 1.0,
        "least_eigenvalue": float(values[-1] / values[0]),
        "relieved": float(1.0 - values[0] / kappa.max()),
        "bending_strain": bending,
        **moved.facts,
    }
    return MembraneTerms(forms, U, products, theta @ (vectors / root), moved.motion, moved.shapes, facts)


def membrane_notes(facts: Mapping[str, Any], mesh: Mesh) -> tuple[list[str], list[str]]:
    """Notes and warnings on the `facts` of membrane terms."""
    moved = (
        f"second-order motion on {facts['shapes']} shapes, the truncation error is below "
        f"{facts['motion_left_out']:.2g} of the largest; its inertia is neglected"
    )
    notes = [
        f"stiffening='membrane': {facts['rank']} squares for {facts['pairs']} products of {facts['modes']} modes, the "
        f"truncation error is below {facts['truncation']:.2g} of the largest membrane energy; {moved}"
    ]
    if not facts["rank"]:
        notes = [
            f"stiffening='membrane': the motion of the body relieves all but {1.0 - facts['relieved']:.2g} of its "
            "membrane strain, no membrane energy is kept; stiffening=True is equivalent at less cost, except for "
            f"pictures; {moved}"
        ]
    linear = [kind for kind in mesh.cells if kind in LOCKING]
    warnings = [
        f"stiffening='membrane': {', '.join(linear)} cells cannot relieve second-order strain within themselves, the "
        "body is too stiff at large deflections; use hex20, hex27, wedge15 or tet10 cells"
    ]
    return notes, warnings if linear else []


def _require_bending(mesh: Mesh, assignment: Assignment, kappa: Array) -> float:
    """The least strain at which stretching is significant (module docstring), of `kappa` (m,) [1/J] of the modes."""
    stiffness = 0.0  # int E dV [J]
    for kind, cells in mesh.cells.items():
        _, weight = physical_gradients(mesh.points[cells], kind)
        E = np.array([stiffest(m) for m in assignment.materials])[assignment.of_cell[kind]]
        stiffness += float(E @ weight.sum(axis=1))
    least = float(1.0 / np.sqrt(kappa.max() * stiffness)) if kappa.max() > 0.0 else np.inf
    if least > BENDING:
        linear = [kind for kind in mesh.cells if kind in LOCKING]
        locking = f"use quadratic cells, as {', '.join(linear)} cells lock in bending, " if linear else ""
        raise InputError(
            "stiffening='membrane': a membrane basis without bending modes: stretching is significant in none of the "
            f"first {len(kappa)} modes below a strain of {least:.2g}; {locking}request more vibration modes (modes=, "
            "membrane_modes=), or leave stiffening='membrane' out for a body that does not bend"
        )
    return least
