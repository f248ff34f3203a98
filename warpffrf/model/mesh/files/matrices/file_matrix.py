"""What the reader of a format hands over: the matrix of a file, and which dofs its rows are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class FileMatrix:
    """A matrix of a file in the file's own units and order.

    `matrix`: scipy.sparse csr (d, d). `dofs` (d, 2) int64: of each row the node's number *in the FE program* and the
    component (0 to 2 displacements, 3 to 5 rotations); None where the file does not say. `source`: for messages.
    """

    matrix: Any
    dofs: np.ndarray | None
    source: str


def from_triplets(rows: np.ndarray, columns: np.ndarray, values: np.ndarray, size: int) -> Any:
    """csr (size, size) of entries at 0-based `rows` and `columns`."""
    import scipy.sparse as sp

    return sp.coo_matrix((values, (rows, columns)), shape=(size, size)).tocsr()
