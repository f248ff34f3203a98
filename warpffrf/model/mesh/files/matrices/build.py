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
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.mesh.data import Matrices, Mesh
from warpffrf.model.mesh.files.matrices.checks import (
    require_matrix,
    require_no_mechanism,
    require_no_support_marks,
    require_positive_diagonal,
    require_semidefinite,
    require_symmetric,
)
from warpffrf.model.mesh.files.matrices.dofs import mapped_dofs, numbered_dofs, ordered, usual_dofs
from warpffrf.model.mesh.files.matrices.file_matrix import FileMatrix
from warpffrf.model.mesh.files.matrices.files import read_matrix
from warpffrf.model.mesh.files.matrices.motion import (
    RIGID_NOTE,
    plausibility,
    require_free,
    require_mass,
    require_one_body,
)
from warpffrf.model.mesh.files.matrices.surfaces import facet_sets
from warpffrf.model.messages.named_arguments import named_arguments

logger = logging.getLogger("warpffrf.mesh")
POUND = 4.4482216152605  # N, one pound-force by definition
UNITS = {"m": (1.0, 1.0), "cm": (1e-2, 1.0), "mm": (1e-3, 1.0), "in": (0.0254, POUND), "ft": (0.3048, POUND)}  # m, N
ROUND_OFF = 1e-12  # of the largest entry: unsymmetry of sums taken in another order, not worth a note
LEAST_NODES = 4  # fewer cannot resist all deformations and yet have a volume
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
    """A body from its mass and stiffness matrices, free and unloaded, with three displacements a node.

    Parameters
    ----------
    M, K: SciPy sparse or NumPy matrices, `FileMatrix`, or paths of files (`read_matrix` has the formats). One triangle
        in a file is completed; an array must be whole.
    nodes: (n, 3) coordinates of all nodes of the matrices, in `length_unit`; their frame is the body's user frame.
    dof_map: (rows, 2) integers, for each row the node (position in `nodes`) and the component: 0 to 2 displacements,
        3 to 5 rotations, whose rows must be empty. None: what the file says, else nodes in order with three rows each,
        or six.
    node_numbers: (n,) the number of each node in the FE program, for files that name nodes; None: 1, 2, 3, ...
    facets: {set name: FacetSet, or nodes (m, k) as positions in `nodes`, or {kind: nodes}}, in the node order of VTK
        with outward normals; the width k tells the kind (3 tri3, 4 quad4, 6 tri6, 8 quad8, 9 quad9). Orientation is
        checked against K: the nodes that are coupled with a facet lie behind it.
    length_unit: "m", "cm", "mm", "in" or "ft", with the units of force and mass that go with it (module docstring).
    matrix_units: the same for M and K, where they differ from the nodes' (nodes of a mesh that was read are in m).

    Returns a `Mesh` with `matrices` [N/m, kg] and without cells; `notes` tell what was left out or rounded. Raises
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
    residual = require_free(K, M, points)  # before the signs: a wrong order explains more than what follows from it
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
        return FileMatrix(require_matrix(given.matrix, f"{what} ({given.source})"), given.dofs, given.source)
    return FileMatrix(require_matrix(given, what), None, what)


def _dofs(A: FileMatrix, dof_map: Any, numbers: np.ndarray, what: str) -> np.ndarray:
    rows = A.matrix.shape[0]
    label = what if A.source == what else f"{what} ({A.source})"
    if A.dofs is not None:
        if dof_map is not None:
            raise InputError(f"{label}: the file says which dof each row is; leave dof_map out")
        return numbered_dofs(A.dofs, numbers, label)
    if dof_map is not None:
        return mapped_dofs(dof_map, rows, len(numbers), label)
    return usual_dofs(rows, len(numbers), label)


def _numbers(node_numbers: Any, count: int) -> np.ndarray:
    if node_numbers is None:
        return np.arange(1, count + 1)
    numbers = np.asarray(node_numbers)
    if numbers.shape != (count,) or not np.issubdtype(numbers.dtype, np.integer):
        raise InputError(f"node_numbers must be {count} integers, one a node, got {numbers.shape} of {numbers.dtype}")
    if len(np.unique(numbers)) != count:
        raise InputError("node_numbers: a number occurs twice; each node has its own")
    return numbers.astype(np.int64)


def _unit(unit: str, what: str) -> tuple[float, float]:
    if unit not in UNITS:
        raise unknown_name(f"from_matrices: {what}", unit, UNITS)
    return UNITS[unit]


def _by(shape: tuple[int, ...]) -> str:
    return " x ".join(str(n) for n in shape)
