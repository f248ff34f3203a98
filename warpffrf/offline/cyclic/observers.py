r"""What is looked at in every harmonic of a periodic body: linear operators on its displacement.

An observer gives `rows` values a sector, those of sector s from the displacements u_{s+o} of sectors near it, each in
its own axes: `y_s = sum_o blocks[o] u_{s+o}`. Under a wave `u_s = u e^{i k s phi}` the values are a wave too, of
amplitude `y = sum_o e^{i k o phi} blocks[o] u`. The display skin is one (o = 0 alone), stresses at points are others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.offline.cyclic.sector import phase
from warpffrf.offline.fe.assembly import Sparse

Array = np.ndarray


@dataclass(frozen=True)
class CyclicObserver:
    """`blocks` {sector offset o: csr (rows, 3 nn)}."""

    name: str
    blocks: Mapping[int, Sparse]

    @property
    def rows(self) -> int:
        """Values a sector."""
        return next(iter(self.blocks.values())).shape[0]

    def harmonic(self, k: int, count: int) -> Sparse:
        """Operator (rows, 3 nn) on the wave of sector 0 in harmonic k of `count` sectors."""
        return sp.csr_matrix(sum(phase(k * o, count) * block for o, block in self.blocks.items()))


def selected_dofs(name: str, dofs: Array, size: int) -> CyclicObserver:
    """The displacements at `dofs` (r,) of `size` dofs of a sector."""
    entries = (np.ones(len(dofs)), (np.arange(len(dofs)), dofs))
    return CyclicObserver(name, {0: sp.csr_matrix(entries, shape=(len(dofs), size))})


@dataclass(frozen=True)
class ObservedModes:
    """An observer's values of the global modes: waves [(k, (rows, p))] of the harmonics that have modes, `rows` values.

    `combine` turns complex waves (n, p) of these harmonics into real fields (n, m) of the body's modes.
    """

    waves: list[tuple[int, Array]]
    rows: int
    combine: Callable[[list[Array]], Array]

    def real(self, sampled: Callable[[int, Array], Array]) -> Array:
        """Real values (n, m); `sampled(k, wave (rows, p)) -> (n, p)` gives `wave e^{i k s phi}` where it is wanted."""
        if not self.waves:
            return np.real(sampled(0, np.zeros((self.rows, 0))))
        return self.combine([sampled(k, wave) for k, wave in self.waves])
