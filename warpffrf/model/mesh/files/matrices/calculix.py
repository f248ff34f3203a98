"""CalculiX matrices: `<job>.sti`, `<job>.mas` and `<job>.dof` of a `*FREQUENCY, SOLVER=MATRIXSTORAGE` step.

A line of .sti (stiffness) and .mas (mass) is `row column value`, counted from 1, one triangle, 14 digits; line i of
.dof is `node.direction` of row i, directions from 1 (written by `matrixstorage.c` of CalculiX 2.20; files of that
version are among the tests). Dofs that a boundary condition or an equation takes away have no row.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.regular_file import MOST_DIGITS, exists, read_named
from warpffrf.model.mesh.files.matrices.file_matrix import FileMatrix, from_triplets
from warpffrf.model.mesh.files.matrices.text_table import SHOWN, read_table, whole_numbers


def read(file: Path, name: str | None, role: str) -> FileMatrix:
    """The matrix of a .sti or .mas file, with the dofs of the .dof file beside it. Raises `InputError` for a garbled or
    missing one, and for rows that the .dof file does not know."""
    table = read_table(file, (3,), "'row column value'")
    numbers = whole_numbers(table[:, :2], file, "row and column")
    dofs = _dofs(file.with_suffix(".dof"))
    if numbers.min() < 1 or numbers.max() > len(dofs):
        raise InputError(
            f"matrix file {file.name}: rows {numbers.min()} to {numbers.max()} do not fit the {len(dofs)} lines of "
            f"{file.stem}.dof; keep the files of one run together (cyclic symmetry doubles the rows: export the whole)"
        )
    return FileMatrix(from_triplets(numbers[:, 0] - 1, numbers[:, 1] - 1, table[:, 2], len(dofs)), dofs, file.name)


def _dofs(file: Path) -> np.ndarray:
    if not exists(file):
        raise InputError(f"matrix file {file.name} does not exist; keep .sti, .mas and .dof of a CalculiX run together")
    dofs = []
    # as text: read as numbers, directions 1 and 10 of a node would be one
    text = read_named(file, "matrix file").decode("ascii", errors="replace")
    for number, line in enumerate(text.splitlines(), start=1):
        node, dot, direction = line.strip().partition(".")
        known = all(word.isdigit() and len(word) <= MOST_DIGITS for word in (node, direction))
        if not (dot and known and int(direction) >= 1):
            raise InputError(
                f"matrix file {file.name}, line {number}: {line.strip()[:SHOWN]!r} is not node.direction; export again"
            )
        dofs.append((int(node), int(direction) - 1))
    if not dofs:
        raise InputError(f"matrix file {file.name}: holds no entries; export it again")
    return np.array(dofs, dtype=np.int64)
