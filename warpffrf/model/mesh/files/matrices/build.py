r"""`from_matrices`: a mesh without cells, whose stiffness and mass come from the FE program.

The modes need K and M only; interfaces and contact need facets on the surface and the coordinates of their nodes.
Units: in a system of length L [m] and force F [N] with the second as unit of time, K is in F/L and M in F s2/L, so both
are multiplied by `F/L` and lengths by L:

| `length_unit` | force | stiffness | mass |
|---|---|---|---|
| m | N | N/m | kg |
| cm | N | N/cm | 100 kg |
| mm | N | N/mm | tonne |
| in | lbf | lbf/in | lbf s2/in |
| ft | lbf | lbf/ft | slug |

Dofs. Rows of matrices in the order of a mesh: dof `3*node + component`, three displacements per node.

With `s(3 a + i)` the row that belongs to component i of node a, the ordered matrix is `A'_rc = A_s(r),s(c)`. Rows of
rotations are omitted where they are empty, as those of solid elements in a Nastran g-set are; one that carries
stiffness or mass belongs to shells, beams or rigid elements and cannot be dropped without changing the body.

Checks of K and M without the elements: size, symmetry, sign.

An unsymmetric matrix is refused above `SYMMETRIC`; below it `(A + A^T)/2` is used. Signs are determined from the scaled
matrix `S = D^-1/2 A D^-1/2`, D the diagonal: its eigenvalues have the signs of those of A, and no unit.

- Any vector with `v^T S v < 0` proves A indefinite. The smallest Ritz value of `LANCZOS_STEPS` Lanczos steps is such a
  quotient (Golub, Van Loan 2013, ch. 10): K or M with a wrong sign or a lost block is found, negative eigenvalues
  hidden among many others near zero may remain undetected.
- Up to `EXACT_DOFS` the count is exact: `S + tau I = L D L^T` has as many negative pivots as S has eigenvalues below
  `-tau` (Sylvester's law of inertia). With `-tau` for `tau` this is the number of zero-energy motions of K: a body has
  six.

Undetected errors appear in the factorisation of the reduction, which rejects a matrix that is not definite.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.mesh.data import Matrices, Mesh
from warpffrf.model.mesh.files.matrices.files import read_matrix
from warpffrf.model.mesh.files.matrices.formats import FileMatrix
from warpffrf.model.mesh.files.matrices.inner_side import (
    RIGID_NOTE,
    facet_sets,
    plausibility,
    require_free,
    require_mass,
    require_one_body,
)
from warpffrf.model.messages.named_arguments import named_arguments

logger = logging.getLogger("warpffrf.mesh")
POUND = 4.4482216152605  # N, one pound-force by definition
UNITS = {"m": (1.0, 1.0), "cm": (1e-2, 1.0), "mm": (1e-3, 1.0), "in": (0.0254, POUND), "ft": (0.3048, POUND)}  # m, N
ROUND_OFF = 1e-12  # of the largest entry: unsymmetry by another order of summation, without a note
LEAST_NODES = 4  # fewer cannot resist all deformations and enclose a volume
CURE_K = "a dof without stiffness belongs to no element: leave such nodes out, and export without constraints"
CURE_M = "give the elements a density, and export the consistent mass matrix"


@named_arguments
def from_matrices(
    M: Any,
    K: Any,
    nodes: Any,
    *,
    dof_map: Any = None,
    node_numbers: Any = None,
    facets: Mapping[str, Any] | None = None,
    length_unit: str = "m",
    matrix_units: str | None = None,
    name: str = "",
) -> Mesh:
    """A body from its mass and stiffness matrices, free and unloaded, with three displacements per node.

    Parameters
    ----------
    M, K: SciPy sparse or NumPy matrices, `FileMatrix`, or paths of files (formats: see `read_matrix`). One triangle
        in a file is completed; an array must be complete.
    nodes: (n, 3) coordinates of all nodes of the matrices, in `length_unit`; their frame is the body's user frame.
    dof_map: (rows, 2) integers, for each row the node (position in `nodes`) and the component: 0 to 2 displacements,
        3 to 5 rotations, whose rows must be empty. None: as in the file, else nodes in order with three rows each,
        or six.
    node_numbers: (n,) the number of each node in the FE program, for files that name nodes; None: 1, 2, 3, ...
    facets: {set name: FacetSet, or nodes (m, k) as positions in `nodes`, or {kind: nodes}}, in the node order of VTK
        with outward normals; the width k determines the kind (3 tri3, 4 quad4, 6 tri6, 8 quad8, 9 quad9). Orientation
        is checked against K: the nodes that are coupled with a facet lie behind it.
    length_unit: "m", "cm", "mm", "in" or "ft", with the corresponding units of force and mass (module docstring).
    matrix_units: the same for M and K, where they differ from the nodes' (nodes of a mesh that was read are in m).

    Returns a `Mesh` with `matrices` [N/m, kg] and without cells; `notes` list omitted and rounded data. Raises
    `InputError` for matrices of unequal size, unsymmetric, not finite, found indefinite, with supports or hinges; nodes
    or dofs in another order (rigid motion must cost no energy); facets out of range, inside the body or inside out.
    """
    points = require_array(nodes, "from_matrices: nodes", (None, 3))
    if len(points) < LEAST_NODES:
        raise InputError(f"from_matrices: nodes: at least {LEAST_NODES} nodes are needed, got {len(points)}")
    length, _ = _unit(length_unit, "length_unit")
    unit_length, force = _unit(length_unit if matrix_units is None else matrix_units, "matrix_units")
    points = length * points
    numbers = _numbers(node_numbers, len(points))
    notes: list[str] = []

    given = {"M": _loaded(M, "M", "mass"), "K": _loaded(K, "K", "stiffness")}
    sizes = {what: A.matrix.shape for what, A in given.items()}
    if sizes["M"] != sizes["K"] and (dof_map is not None or all(A.dofs is None for A in given.values())):
        raise InputError(f"M is {_by(sizes['M'])} and K is {_by(sizes['K'])}: unequal sizes; export both from one run")
    found = {}
    for what, A in given.items():
        dofs = _dofs(A, dof_map, numbers, what)
        matrix, left_out = ordered(A.matrix, dofs, len(points), what)
        matrix, unsymmetry = require_symmetric(matrix, what)
        notes += A.notes
        if left_out:
            notes.append(f"{what}: {left_out} empty rows of rotations are left out")
        if unsymmetry > ROUND_OFF:
            notes.append(f"{what}: made symmetric, entries differed by {unsymmetry:.2g} of the largest")
        found[what] = (force / unit_length) * matrix

    K, M = found["K"], found["M"]
    _check(K, M, points, notes)
    sets = facet_sets(facets, points, K)
    for note in notes:
        logger.info("%s", note)
    return Mesh(points, {}, sets, name=name, notes=tuple(notes), matrices=Matrices(K, M))


def _check(K: Any, M: Any, points: np.ndarray, notes: list[str]) -> None:
    require_no_support_marks(K)
    residual = require_free(K, M, points)  # before the signs: a wrong order also causes wrong signs
    if residual > RIGID_NOTE:
        notes.append(f"K R of rigid motions is {residual:.2g} of the sum of magnitudes: rounded coordinates or entries")
    require_positive_diagonal(K, "K", CURE_K)
    require_positive_diagonal(M, "M", CURE_M)
    mass = require_mass(M, points)
    require_one_body(K, M)
    require_semidefinite(M, "M")
    require_semidefinite(K, "K")
    require_no_mechanism(K)
    for warning in plausibility(K, M, points, mass):
        logger.warning("%s", warning)
        notes.append(warning)


def _loaded(given: Any, what: str, role: str) -> FileMatrix:
    if isinstance(given, str | Path):
        given = read_matrix(given, role=role)
    if isinstance(given, FileMatrix):
        return replace(given, matrix=require_matrix(given.matrix, f"{what} ({given.source})"))
    return FileMatrix(require_matrix(given, what), None, what)


def _dofs(A: FileMatrix, dof_map: Any, numbers: np.ndarray, what: str) -> np.ndarray:
    rows = A.matrix.shape[0]
    label = what if A.source == what else f"{what} ({A.source})"
    if A.dofs is not None:
        if dof_map is not None:
            raise InputError(f"{label}: the file gives the dof of each row; leave dof_map out")
        return numbered_dofs(A.dofs, numbers, label)
    if dof_map is not None:
        return mapped_dofs(dof_map, rows, len(numbers), label)
    return usual_dofs(rows, len(numbers), label)


def _numbers(node_numbers: Any, count: int) -> np.ndarray:
    if node_numbers is None:
        return np.arange(1, count + 1)
    numbers = np.asarray(node_numbers)
    if numbers.shape != (count,) or not np.issubdtype(numbers.dtype, np.integer):
        raise InputError(f"node_numbers must be {count} integers, one per node, got {numbers.shape} of {numbers.dtype}")
    if len(np.unique(numbers)) != count:
        raise InputError("node_numbers: a number occurs twice; each node has its own")
    return numbers.astype(np.int64)


def _unit(unit: str, what: str) -> tuple[float, float]:
    if unit not in UNITS:
        raise unknown_name(f"from_matrices: {what}", unit, UNITS)
    return UNITS[unit]


def _by(shape: tuple[int, ...]) -> str:
    return " x ".join(str(n) for n in shape)


AXES = ("x", "y", "z")


def usual_dofs(rows: int, node_count: int, what: str) -> np.ndarray:
    """Dofs (rows, 2), node and component, of nodes in order with three or with six dofs each.

    Raises `InputError` for any other number of rows.
    """
    for per_node in (3, 6):
        if rows == per_node * node_count:
            return np.stack([np.repeat(np.arange(node_count), per_node), np.tile(np.arange(per_node), node_count)], 1)
    raise InputError(
        f"{what} has {rows} rows, {node_count} nodes have {3 * node_count} displacements; give the nodes of the "
        "matrices, or dof_map: node and component of each row"
    )


def mapped_dofs(dof_map: Any, rows: int, node_count: int, what: str) -> np.ndarray:
    """`dof_map` (rows, 2) as int64. Raises `InputError` for another shape, or nodes and components out of range."""
    array = np.asarray(dof_map)
    if array.shape != (rows, 2) or not np.issubdtype(array.dtype, np.integer):
        raise InputError(
            f"dof_map must be integers of shape ({rows}, 2), node and component of each row of {what}, got "
            f"{array.shape} of {array.dtype}"
        )
    dofs = array.astype(np.int64)
    for column, limit, cure in (
        (0, node_count, "nodes count from 0 in the order of `nodes`"),
        (1, 6, "components are 0, 1, 2 for displacements in x, y, z and 3, 4, 5 for rotations"),
    ):
        bad = np.flatnonzero((dofs[:, column] < 0) | (dofs[:, column] >= limit))
        if len(bad):
            raise InputError(f"dof_map: row {bad[0]} is {dofs[bad[0]].tolist()}; {cure}")
    return dofs


def numbered_dofs(dofs: np.ndarray, node_numbers: np.ndarray, what: str) -> np.ndarray:
    """`dofs` of a file, with the FE program's node numbers, in terms of the positions of `node_numbers` (n,).

    Raises `InputError` for a node that is not among them.
    """
    order = np.argsort(node_numbers)
    place = np.minimum(np.searchsorted(node_numbers, dofs[:, 0], sorter=order), len(order) - 1)
    index = order[place]
    missing = np.flatnonzero(node_numbers[index] != dofs[:, 0])
    if len(missing):
        raise InputError(
            f"{what}: node {dofs[missing[0], 0]} is not among the {len(node_numbers)} node_numbers; give the number "
            "that each row of `nodes` has in the FE program (default 1, 2, 3, ...)"
        )
    return np.stack([index, dofs[:, 1]], axis=1)


def ordered(matrix: Any, dofs: np.ndarray, node_count: int, what: str) -> tuple[Any, int]:
    """csr (3 n, 3 n) in the order `3*node + component`, and the number of omitted empty rotation rows.

    Raises `InputError` for a rotation with nonzero entries, a dof with two rows, and one without.
    """
    turned = np.flatnonzero(dofs[:, 1] >= 3)
    if len(turned):
        carrying = turned[np.diff(matrix.indptr)[turned] > 0]
        if len(carrying):
            node, component = dofs[carrying[0]]
            raise InputError(
                f"{what}: row {carrying[0]}, the rotation about {AXES[component - 3]} of node {node}, is not empty; "
                "bodies have three displacements per node: condense the rotations, or export solid elements"
            )
    rows = np.flatnonzero(dofs[:, 1] < 3)
    target = 3 * dofs[rows, 0] + dofs[rows, 1]
    source = np.full(3 * node_count, -1)
    source[target] = rows
    twice = np.flatnonzero(source[target] != rows)
    if len(twice):
        a, b = rows[twice[0]], source[target[twice[0]]]
        raise InputError(
            f"{what}: rows {a} and {b} are both component {dofs[a, 1]} of node {dofs[a, 0]}; each dof has one row"
        )
    missing = np.flatnonzero(source < 0)
    if len(missing):
        node, component = divmod(int(missing[0]), 3)
        raise InputError(
            f"{what}: {len(missing)} of {3 * node_count} displacements have no row, the first is component {component} "
            f"of node {node}; export without supports and constraints, and leave out nodes that no element uses"
        )
    return matrix[source][:, source].tocsr(), len(turned)


SYMMETRIC = 1e-6  # of the largest entry: files in single precision round to 6e-8; friction and follower loads give 1e-3
INDEFINITE = 1e-6  # of the largest eigenvalue of S: change of a zero one by rounding K to single precision
ENERGY_FREE = 1e-12  # of the largest eigenvalue of S: above round-off, below the first bending of 500 cells in a row
SUPPORT_MARK = 1e30  # N/m on a diagonal: above any stiffness of a body, below the 1e36 of Abaqus for supported dofs
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
    """Raise `InputError` where the diagonal of K has the huge numbers that mark supports."""
    marked = np.flatnonzero(K.diagonal() > SUPPORT_MARK)
    if len(marked):
        raise InputError(
            f"K: {len(marked)} diagonal entries are above {SUPPORT_MARK:g}, the first at node {marked[0] // 3}: "
            "Abaqus' mark of a supported dof; export the matrices of the free body, without boundary conditions"
        )


def require_semidefinite(A: Any, what: str) -> None:
    """Raise `InputError` for a matrix found to have a negative eigenvalue; limits: see the module docstring.

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
