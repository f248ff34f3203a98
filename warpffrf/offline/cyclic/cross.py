r"""Compliance between two contact surfaces of a periodic body, harmonic by harmonic.

In harmonic k the residual response to the loads `B_k^s` of surface s does to the functions of surface t

    C_k = (B_k^t)^H G_res,k B_k^s,      D_k = M_k^t^-1 C_k M_k^s^-1,

and the block of two sectors that are l apart is `1/N sum_k D_k e^{i k l phi}`, as on one surface. Column J of a grid
stands on the fine column `offset + stride J` (`surface`); where both grids are full turns of the same stride, that
makes a block-circulant operator, every stride-th of the blocks. An arc, or two strides, has the dense operator of its
columns: like the compliance of an arc itself that of the full turn, restricted to the columns that there are, so that
own and foreign compliances stay one symmetric positive semidefinite matrix.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from warpffrf.model.reduced.cross_compliance import CrossCompliance
from warpffrf.offline.cyclic.surface import CyclicField, CyclicSurface, by_distance
from warpffrf.offline.fe.assembly import Sparse

Array = np.ndarray


class CyclicCross:
    """Displacements of surface `target` under loads on surface `source`, as the harmonics come."""

    def __init__(self, target: CyclicSurface, source: CyclicSurface) -> None:
        self.target, self.source = target, source
        self._C = {
            (a, b): np.zeros((target.N // 2 + 1, of_target.count, of_source.count), dtype=complex)
            for a, of_target in enumerate(target.fields)
            for b, of_source in enumerate(source.fields)
        }

    def add(
        self,
        k: int,
        targets: Sequence[Sparse],
        response: Array,
        parts: Sequence[Array],
        scaled: Array | None,
        on_modes: Sequence[Array],
    ) -> None:
        """Harmonic k: `targets` (n, count) are the loads of the target's fields, `response @ parts[b]` the responses
        (n, count) to those of the source's field b; `scaled` (n, p) the global modes over their frequencies, None where
        there are none, and `on_modes[b]` (count, p) those loads on them."""
        for a, load in enumerate(targets):
            seen = load.conj().T @ response
            for b, part in enumerate(parts):
                self._C[a, b][k] = seen @ part
                if scaled is not None:
                    self._C[a, b][k] -= (load.conj().T @ scaled) @ on_modes[b].conj().T

    def product(self) -> CrossCompliance:
        """The finished operators."""
        names = self.target.name, self.source.name
        if len(self._C) == 1:
            return CrossCompliance(*names, self._lags(0, 0))
        return CrossCompliance(*names, self._lags(0, 0), self._lags(1, 1), self._lags(0, 1), self._lags(1, 0))

    def _lags(self, a: int, b: int) -> Array:
        t, s = self.target, self.source
        first, second = t.fields[a], s.fields[b]
        blocks = by_distance(self._C[a, b], first, second)
        if t.periodic and s.periodic and t.stride == s.stride:
            return np.ascontiguousarray(blocks[:: t.stride])
        (sector, part), (other, other_part) = _places(t), _places(s)
        lag = (sector[:, None] - other) % t.N
        parted = blocks.reshape(t.N, *_numbers(first), *_numbers(second))
        D = parted[lag, :, part[:, None], :, :, other_part, :]  # (columns, columns, d_t, rows, d_s, rows)
        D = D.transpose(2, 0, 3, 4, 1, 5)
        return np.ascontiguousarray(D).reshape(1, np.prod(D.shape[:3]), np.prod(D.shape[3:]))


def _places(surface: CyclicSurface) -> tuple[Array, Array]:
    """Sector and place in it of the grid's columns."""
    fine = surface.offset + surface.stride * np.arange(surface.columns)
    return fine // surface.c, fine % surface.c


def _numbers(field: CyclicField) -> tuple[int, int, int]:
    """Directions, columns of a sector, rows."""
    return len(field.directions), field.c, field.rows
