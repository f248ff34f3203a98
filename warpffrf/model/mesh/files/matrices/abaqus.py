"""Abaqus text matrices, made by `*MATRIX GENERATE, STIFFNESS, MASS` and `*MATRIX OUTPUT, STIFFNESS, MASS`.

- FORMAT=MATRIX INPUT, the default: `row node, dof, column node, dof, value`; a symmetric matrix as one triangle
  (Abaqus Keywords Guide, *MATRIX INPUT). Nodes and rows are matched by number, so the order of lines does not matter.
- FORMAT=COORDINATE: `row column value`, counted from 1; nothing says which dof a row is: nodes in ascending order of
  their numbers, three rows each, for a model of solid elements without constraints.

The files are `<job>_STIF<step>.mtx` and `<job>_MASS<step>.mtx`. Abaqus marks a supported dof by 1e36 on the diagonal,
and gives internal nodes negative numbers.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.matrices.file_matrix import FileMatrix, from_triplets
from warpffrf.model.mesh.files.matrices.text_table import read_table, whole_numbers

COMPONENTS = 6  # dofs 1 to 6 are displacements and rotations


def read(file: Path, name: str | None, role: str) -> FileMatrix:
    """The matrix of an Abaqus .mtx file. Raises `InputError` for a garbled file, internal nodes, and dofs above 6."""
    table = read_table(file, (5, 3), "'node, dof, node, dof, value' or 'row column value'")
    numbers = whole_numbers(table[:, :-1], file, "node, dof, row and column")
    values = table[:, -1]
    if numbers.shape[1] == 2:
        if numbers.min() < 1:
            raise InputError(f"matrix file {file.name}: rows and columns count from 1, got {numbers.min()}")
        size = int(numbers.max())
        if size > len(table):  # each row has an entry on the diagonal at least
            raise InputError(f"matrix file {file.name}: {len(table)} entries cannot fill {size} rows; export it again")
        return FileMatrix(from_triplets(numbers[:, 0] - 1, numbers[:, 1] - 1, values, size), None, file.name)
    places = numbers.reshape(-1, 2)
    if places[:, 0].min() < 1:
        raise InputError(
            f"matrix file {file.name}: node {places[:, 0].min()} is an internal node of Abaqus; export a model of "
            "plain solid elements, without hybrid elements, shells or connectors"
        )
    odd = places[(places[:, 1] < 1) | (places[:, 1] > COMPONENTS)]
    if len(odd):
        raise InputError(
            f"matrix file {file.name}: dof {odd[0, 1]} of node {odd[0, 0]} is no displacement or rotation; export a "
            "structural model"
        )
    dofs, place = np.unique(places, axis=0, return_inverse=True)
    row, column = place.reshape(-1, 2).T
    return FileMatrix(from_triplets(row, column, values, len(dofs)), dofs - [0, 1], file.name)
