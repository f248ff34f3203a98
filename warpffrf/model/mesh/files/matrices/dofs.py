r"""Rows of matrices in the order of a mesh: dof `3*node + component`, three displacements a node.

With `s(3 a + i)` the row that belongs to component i of node a, the ordered matrix is `A'_rc = A_s(r),s(c)`. Rows of
rotations are left out where they are empty, as those of solid elements in a Nastran g-set are; one that carries
stiffness or mass belongs to shells, beams or rigid elements and cannot be dropped without changing the body.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError

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
    """csr (3 n, 3 n) in the order `3*node + component`, and the number of empty rotation rows left out.

    Raises `InputError` for a rotation that carries something, a dof with two rows, and one without.
    """
    turned = np.flatnonzero(dofs[:, 1] >= 3)
    if len(turned):
        carrying = turned[np.diff(matrix.indptr)[turned] > 0]
        if len(carrying):
            node, component = dofs[carrying[0]]
            raise InputError(
                f"{what}: row {carrying[0]}, the rotation about {AXES[component - 3]} of node {node}, is not empty; "
                "bodies here have three displacements a node: condense the rotations, or export solid elements"
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
