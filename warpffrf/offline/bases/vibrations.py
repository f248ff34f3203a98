r"""Fixed-interface modes and constraint modes (Craig and Bampton 1968), for any kind of interface.

The interface coordinates are F^T u, with F the unit loads. Fixing them causes reactions `-F lam`:

    K u = f - F lam,      F^T u = 0.

The free body must be in equilibrium, `R^T (f - F lam) = 0`, and then `u = G (f - F lam) + R c` with the inertia-relief
flexibility G and a rigid motion c. So the same factorisation is used, and the interface constraint is a small system,

    [ F^T G F   B^T ] [ lam ]   [ F^T G f ]
    [ B         0   ] [ -c  ] = [ R^T f   ],      B = R^T F (r, a),

for any F: dofs of rigid interfaces, dofs of nodes, or averages of nodes. Any one interface constrains the body, rank B
= r. *Fixed-interface modes* are those of this flexibility; the *constraint mode* of interface coordinate j has the
right-hand side (e_j, 0) and no load f. Its reactions are in equilibrium, so that

    u_j = G F lam_j + R c_j

is a combination of attachment modes and rigid motion: the constraint modes lie in the span of the attachment modes,
which come first anyway. The latter add the responses to interface loads with inertia relief, r directions.

Craig chang. Free vibration modes and residual flexibility (Craig and Chang 1977, after MacNeal 1971 and Rubin 1975).

The residual-flexibility attachment modes are the part of the static response to interface loads outside the modes V,

    A_res = G F - V Omega^-2 V^T F,      G = P^T K^+ P.

MacNeal's method uses them in the stiffness only, without mass; Rubin's, and Craig and Chang's as a basis, project both
mass and stiffness, as the Rayleigh-Ritz step here does. Since V Omega^-2 V^T F is in the span of V,

    span [V, A_res] = span [V, G F]:

the *space* is that of `free_free` with the same modes, and so is every frequency and response. The two differ in their
coordinates before orthonormalisation only.

Free free. Vibration modes of the free body: no constraints, hence modes of the floating body itself.

Shifted. Solves with the dynamic stiffness of the free body, K - lambda M, real and indefinite or complex.

SuperLU with partial pivoting by threshold: the ordering for low fill is kept, pivots that are too small are exchanged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from warpffrf.model.errors import InputError
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import ModalBasis
from warpffrf.offline.bases.modes import BasisProblem, RawBasis, lowest_modes
from warpffrf.offline.elastic import Array, ElasticModel
from warpffrf.offline.solvers.ordering import nested_dissection

# Singular value, of the largest, of the scaled small system below which interface coordinates are dependent (two free
# interfaces share nodes): the square of the round-off of a dependent column.
DEPENDENT = 1e-12


@named_arguments
@dataclass(frozen=True, kw_only=True)
class CraigBampton(ModalBasis):
    """Vibration modes of the body with all interfaces fixed, and constraint modes (Craig and Bampton 1968)."""

    kind: ClassVar[str] = "craig_bampton"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "highest fixed-interface mode",
        "modes": "number of fixed-interface modes",
    }

    def columns(self, problem: BasisProblem) -> RawBasis:
        problem.require_interfaces(self.kind)
        held, constraint_modes, rank = hold_interfaces(problem)
        problem.require_fits(
            self.kind, problem.limits.count or 0, "fixed-interface modes", available=problem.model.size - rank
        )
        omega, V, notes = lowest_modes(held, problem.limits, self.mode_tolerance)
        columns = np.concatenate([V, constraint_modes], axis=1)
        facts: dict[str, Any] = {"fixed_interface_modes": len(omega), "constraint_modes": rank}
        if len(omega):
            facts["fixed_interface_frequencies"] = [float(omega[0] / (2 * np.pi)), float(omega[-1] / (2 * np.pi))]
        return RawBasis(columns, redundant=constraint_modes.shape[1], notes=notes, facts=facts)


def hold_interfaces(problem: BasisProblem) -> tuple[ElasticModel, Array, int]:
    """The body with all interface coordinates fixed, constraint modes (n, a), and the number of fixed coordinates."""
    model, F, A = problem.model, problem.system.loads, problem.attachments
    r, a = model.R.shape[1], F.shape[1]
    B = model.R.T @ F
    # unit energy per load, unit norm per rigid motion: forces and moments, lengths and angles become comparable
    D = F.T @ A
    scale = 1.0 / np.sqrt(np.diag(D))
    rows = 1.0 / np.linalg.norm(B * scale, ord=2)
    system = np.block([[scale[:, None] * D * scale, (B * scale).T * rows], [B * scale * rows, np.zeros((r, r))]])
    values = np.linalg.svd(system, compute_uv=False)
    inverse = np.linalg.pinv(system, rcond=DEPENDENT, hermitian=True)
    rank = int(np.sum(values > DEPENDENT * values[0])) - r

    def reactions(at_interface: Array, on_rigid: Array) -> tuple[Array, Array]:
        """lam (a, m) and -c (r, m)."""
        x = inverse @ np.concatenate([scale[:, None] * at_interface, rows * on_rigid])
        return scale[:, None] * x[:a], rows * x[a:]

    def solve(f: Array) -> Array:
        u, on_rigid = model.flexibility(f), model.R.T @ f
        for _ in range(2):  # the second pass removes the round-off in the interface's motion
            lam, c = reactions(F.T @ u, on_rigid)
            u, on_rigid = u - A @ lam - model.R @ c, np.zeros_like(on_rigid)
        return u

    lam, c = reactions(np.eye(a), np.zeros((r, a)))
    held = ElasticModel(model.K, model.M, np.zeros((model.size, 0)), solve)
    return held, A @ lam + model.R @ c, rank


@named_arguments
@dataclass(frozen=True, kw_only=True)
class FreeFree(ModalBasis):
    """Vibration modes of the free body (interfaces free to move) and inertia-relief attachment modes: the default."""

    kind: ClassVar[str] = "free_free"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "highest vibration mode",
        "modes": "number of vibration modes",
    }

    def columns(self, problem: BasisProblem) -> RawBasis:
        problem.require_fits(self.kind, problem.limits.count or 0, "vibration modes")
        omega, V, notes = lowest_modes(problem.model, problem.limits, self.mode_tolerance)
        return RawBasis(V, notes=notes, facts={"vibration_modes": len(omega)})


# Energy norm relative to the whole attachment mode below which a residual one is round-off of the subtraction.
NEGLIGIBLE = 1e-7


@named_arguments
@dataclass(frozen=True, kw_only=True)
class CraigChang(ModalBasis):
    """Free vibration modes and residual-flexibility attachment modes (Craig and Chang 1977; Rubin 1975)."""

    kind: ClassVar[str] = "craig_chang"
    takes: ClassVar[Mapping[str, str]] = FreeFree.takes

    def columns(self, problem: BasisProblem) -> RawBasis:
        problem.require_fits(self.kind, problem.limits.count or 0, "vibration modes")
        model = problem.model
        omega, V, notes = lowest_modes(model, problem.limits, self.mode_tolerance)
        A, F = problem.attachments, problem.system.loads
        residual = A - V @ ((V.T @ F) / (omega**2)[:, None])
        energy = np.einsum("na,na->a", residual, model.K @ residual)
        kept = energy > NEGLIGIBLE**2 * np.einsum("na,na->a", A, model.K @ A)
        columns = np.concatenate([V, residual[:, kept]], axis=1)
        facts = {"vibration_modes": len(omega), "residual_attachment_modes": int(kept.sum())}
        return RawBasis(columns, redundant=int(kept.sum()), notes=notes, facts=facts)


SMALL_SYSTEM = 2000  # dofs; below it SuperLU's own ordering costs less than a dissection
PIVOT = 0.01  # a diagonal pivot is kept while it is this fraction of the largest of its column
# Residual of the load after one step of refinement: far above round-off, far below any use of the result.
ACCURATE = 1e-8


def shifted_solver(K: Any, M: Any, shift: complex, coordinates: Array, what: str) -> Callable[[Array], Array]:
    """Solver of (K - shift M) u = f for blocks f (n, m); `shift` = omega^2 [rad^2/s^2].

    coordinates (n, 3) [m], position of each dof, NaN if it has none. Raises `InputError`, naming `what` is solved,
    if the matrix is singular to working precision: a natural frequency.
    """
    S: Any = sp.csc_matrix(K - shift * M)
    order, permutation = np.arange(len(coordinates)), "MMD_AT_PLUS_A"
    if len(order) > SMALL_SYSTEM:
        order, permutation = nested_dissection(K, coordinates).order, "NATURAL"
        S = sp.csc_matrix(S[order][:, order])
    try:
        lu = spla.splu(S, permc_spec=permutation, diag_pivot_thresh=PIVOT, options={"SymmetricMode": True})
    except RuntimeError:
        raise InputError(f"{what} is a natural frequency of the body; move it by a percent") from None

    def solve(f: Array) -> Array:
        rhs = np.ascontiguousarray(f[order].astype(S.dtype, copy=False))
        x = lu.solve(rhs)
        x = x + lu.solve(rhs - S @ x)
        rest = np.linalg.norm(rhs - S @ x, axis=0)
        if not np.all(rest <= ACCURATE * np.linalg.norm(rhs, axis=0)):
            raise InputError(f"{what} is a natural frequency of the body; move it by a percent")
        u = np.empty_like(x)
        u[order] = x
        return u

    return solve
