r"""What can be known of K and M without the elements: size, symmetry, sign.

An unsymmetric matrix is refused above `SYMMETRIC`; below it `(A + A^T)/2` is used. Signs are looked at in the scaled
matrix `S = D^-1/2 A D^-1/2`, D the diagonal: its eigenvalues have the signs of those of A, and no unit.

- Any vector with `v^T S v < 0` proves A indefinite. The smallest Ritz value of `LANCZOS_STEPS` Lanczos steps is such a
  quotient (Golub, Van Loan 2013, ch. 10): K or M with a wrong sign or a lost block is found, negative eigenvalues
  hidden among many others near zero may stay.
- Up to `EXACT_DOFS` the count is exact: `S + tau I = L D L^T` has as many negative pivots as S has eigenvalues below
  `-tau` (Sylvester's law of inertia). With `-tau` for `tau` this counts the motions of K without energy: a body has
  six.

What is not seen here is met by the factorisation of the reduction, which refuses a matrix that is not definite.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError

SYMMETRIC = 1e-6  # of the largest entry: files in single precision round to 6e-8; friction and follower loads give 1e-3
INDEFINITE = 1e-6  # of the largest eigenvalue of S: what rounding the entries of K to single precision does to a zero
ENERGY_FREE = 1e-12  # of the largest eigenvalue of S: above round-off, below the first bending of 500 cells in a row
SUPPORT_MARK = 1e30  # N/m on a diagonal: no stiffness of a body, but the 1e36 that Abaqus puts on supported dofs
EXACT_DOFS = 5_000  # a factorisation of this size takes about a second
LANCZOS_STEPS = 60
RIGID_MOTIONS = 6


def require_matrix(A: Any, what: str) -> Any:
    """`A` (SciPy sparse or array-like) as canonical csr float64. Raises `InputError` unless square, real and finite."""
    import scipy.sparse as sp

    try:
        matrix: Any = sp.csr_matrix(A)
        fits = matrix.dtype.kind in "biuf"
    except (TypeError, ValueError):
        raise InputError(f"{what} must be a SciPy sparse matrix, a NumPy array or a file, got {A!r}") from None
    if not fits:
        raise InputError(f"{what} must be real, got {matrix.dtype}; leave damping out")
    matrix = matrix.astype(np.float64)
    matrix.sum_duplicates()
    if matrix.shape[0] != matrix.shape[1] or not matrix.shape[0]:
        raise InputError(f"{what} must be square, got {matrix.shape[0]} x {matrix.shape[1]}; export the whole matrix")
    if not np.all(np.isfinite(matrix.data)):
        raise InputError(f"{what} holds NaN or infinite numbers; export it again")
    matrix.eliminate_zeros()
    return matrix


def require_symmetric(A: Any, what: str) -> tuple[Any, float]:
    """`(A + A^T)/2` and the largest difference, as a fraction of the largest entry. Raises `InputError` above
    `SYMMETRIC`."""
    import scipy.sparse as sp

    largest = float(np.max(np.abs(A.data), initial=0.0))
    if largest == 0.0:
        raise InputError(f"{what} is zero; export it again")
    gap = A - A.T
    unsymmetry = float(np.max(np.abs(gap.data), initial=0.0)) / largest
    if unsymmetry > SYMMETRIC:
        one_sided = not sp.triu(A, 1).nnz or not sp.tril(A, -1).nnz
        cure = (
            f"only one triangle is there: pass {what} + {what}.T without the diagonal twice"
            if one_sided
            else "export the symmetric matrix of the linear model, without friction and follower loads"
        )
        raise InputError(
            f"{what} is not symmetric: entries differ by {unsymmetry:.2g} of the largest, allowed {SYMMETRIC:g}; {cure}"
        )
    if unsymmetry == 0.0:
        return A, 0.0
    return sp.csr_matrix(0.5 * (A + A.T)), unsymmetry


def require_positive_diagonal(A: Any, what: str, cure: str) -> None:
    """Raise `InputError` naming the first dof whose diagonal entry is not greater than zero."""
    bad = np.flatnonzero(~(A.diagonal() > 0.0))
    if len(bad):
        node, component = divmod(int(bad[0]), 3)
        raise InputError(
            f"{what} is not positive: {len(bad)} of {A.shape[0]} diagonal entries are not greater than zero, the first "
            f"is component {component} of node {node} ({A.diagonal()[bad[0]]:.3g}); {cure}"
        )


def require_no_support_marks(K: Any) -> None:
    """Raise `InputError` where the diagonal of K holds the huge numbers that stand for supports."""
    marked = np.flatnonzero(K.diagonal() > SUPPORT_MARK)
    if len(marked):
        raise InputError(
            f"K: {len(marked)} diagonal entries are above {SUPPORT_MARK:g}, the first at node {marked[0] // 3}: "
            "Abaqus' mark of a supported dof; export the matrices of the free body, without boundary conditions"
        )


def require_semidefinite(A: Any, what: str) -> None:
    """Raise `InputError` for a matrix found to have a negative eigenvalue; see the module docstring for what is seen.

    The diagonal must be positive.
    """
    S, largest = _scaled(A)
    lowest = _lowest_ritz_value(S) / largest
    negative = _eigenvalues_below(S, -INDEFINITE * largest) if A.shape[0] <= EXACT_DOFS else None
    if lowest < -INDEFINITE or negative:
        how_many = f"{negative} negative eigenvalue(s)" if negative else f"an energy of {lowest:.2g} of the largest"
        raise InputError(
            f"{what} is indefinite, it has {how_many}; export the matrices of the unloaded linear model, and look for "
            "lost or doubled entries"
        )


def require_no_mechanism(K: Any) -> None:
    """Raise `InputError` for a K of at most `EXACT_DOFS` rows with more than six motions without energy."""
    if K.shape[0] > EXACT_DOFS:
        return
    S, largest = _scaled(K)
    free = _eigenvalues_below(S, ENERGY_FREE * largest)
    if free is not None and free > RIGID_MOTIONS:
        raise InputError(
            f"K has {free} motions without energy, a body has {RIGID_MOTIONS}; look for hinges, loose parts, or "
            "hourglass modes of reduced integration"
        )


def _scaled(A: Any) -> tuple[Any, float]:
    """S = D^-1/2 A D^-1/2 and a bound of its largest eigenvalue, the largest row sum of magnitudes."""
    import scipy.sparse as sp

    scale = sp.diags_array(1.0 / np.sqrt(A.diagonal()), format="csr")
    S = sp.csr_matrix(scale @ A @ scale)
    return S, float(np.max(abs(S).sum(axis=1)))


def _lowest_ritz_value(S: Any) -> float:
    """Smallest Ritz value of Lanczos steps from a fixed start, without reorthogonalisation.

    Lost orthogonality gives copies of Ritz values, never one outside the spectrum beyond round-off (Paige 1980).
    """
    from scipy.linalg import eigh_tridiagonal

    v = np.random.default_rng(S.shape[0]).standard_normal(S.shape[0])
    v /= np.linalg.norm(v)
    previous, beta = np.zeros_like(v), 0.0
    alphas: list[float] = []
    betas: list[float] = []
    for _ in range(min(LANCZOS_STEPS, S.shape[0])):
        w = S @ v - beta * previous
        alphas.append(float(v @ w))
        w -= alphas[-1] * v
        beta = float(np.linalg.norm(w))
        if beta <= np.finfo(float).eps * abs(alphas[0]):
            break
        betas.append(beta)
        previous, v = v, w / beta
    values = eigh_tridiagonal(np.array(alphas), np.array(betas[: len(alphas) - 1]), eigvals_only=True)
    return float(np.min(values))


def _eigenvalues_below(S: Any, bound: float) -> int | None:
    """Number of eigenvalues of S below `bound`; None where a pivot had to be exchanged and the count is not known."""
    import scipy.sparse as sp
    from scipy.sparse.linalg import splu

    shifted = sp.csc_matrix(S - bound * sp.eye_array(S.shape[0]))
    try:
        factors = splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:  # exactly singular: the bound is an eigenvalue
        return None
    if not np.array_equal(factors.perm_r, factors.perm_c):
        return None
    return int(np.sum(factors.U.diagonal() < 0.0))
