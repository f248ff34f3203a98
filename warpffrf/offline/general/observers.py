"""Observed quantities of a response: sparse operators on the displacements of all nodes.

Examples are the display skin and the stress at chosen points. For every unit load and every global mode the reduction
stores only the observed quantities, so a further quantity costs its own size only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError

Array = np.ndarray
SKIN = "skin"


@dataclass(frozen=True, eq=False)
class Observer:
    """`operator` (rows, 3 n) csr: the quantity `name`, by rows, of displacements of all nodes [m], dofs 3*node +
    component, user axes; (rows, 3 n + 3 r): of rotations too, see `structure.assembly`. Its transfer is stored in
    precision `dtype`."""

    name: str
    operator: Any
    dtype: np.dtype = field(default_factory=lambda: np.dtype(np.float32))

    @property
    def rows(self) -> int:
        """Number of values observed."""
        return self.operator.shape[0]


def node_observer(name: str, nodes: Array, node_count: int) -> Observer:
    """Displacements (3 k rows) of `nodes` (k,)."""
    columns = (3 * np.asarray(nodes)[:, None] + np.arange(3)).ravel()
    ones = np.ones(len(columns))
    return Observer(name, sp.csr_matrix((ones, (np.arange(len(columns)), columns)), (len(columns), 3 * node_count)))


def require_observers(observers: Sequence[Observer], node_count: int, rotating: int = 0) -> None:
    """Raise `InputError` for two observers of one name, or an operator that does not fit the mesh."""
    for i, observer in enumerate(observers):
        if any(other.name == observer.name for other in observers[:i]):
            raise InputError(f"observer {observer.name!r} exists twice; give each quantity its own name")
        if observer.operator.shape[1] not in (3 * node_count, 3 * (node_count + rotating)):
            raise InputError(
                f"observer {observer.name!r}: the operator has {observer.operator.shape[1]} columns, the mesh "
                f"{3 * node_count} dofs; create the observer for this mesh"
            )


def widened(observer: Observer, size: int) -> Observer:
    """The observer with an operator of `size` columns, those added being zero."""
    if observer.operator.shape[1] == size:
        return observer
    operator = sp.csr_matrix(observer.operator, copy=True)
    operator.resize((observer.rows, size))
    return replace(observer, operator=operator)
