r"""Tables of the products by strips -> device (kernels of `rolling.strips`): the compliance K of the tractions by the
half-spaces, and the preconditioner W, as blocks by frequency.

Cells have equal widths, so K depends on the distance in strips d = c - c' and on two rows, in any way: K is block
Toeplitz. A discrete Fourier transform along the strips, of length L >= 2 columns - 1, makes it block diagonal. The
kinds (`rolling.shear`) are even in d, or odd where e_1 and tau_2, or e_2 and tau_1 meet; so with component 1 divided by
i every block is real and symmetric,

    M_k = sum_d cos(omega_k d) K_d    (even),      +- sum_d sin(omega_k d) K_d    (odd),      omega_k = 2 pi k/L.

W has the inverse blocks of the kernel that is periodic with L = 1.25 columns + 3: its opposite order makes the
spectrum of W K, restricted to any set of cells, nearly independent of their number (conditions below 8).

Both are tabulated at the levels of W of the near field, over W^power; the blocks of K between levels follow by the same
cubic, as they depend on the near field linearly, those of the preconditioner from the nearest level.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from warpffrf.model.contact import Contact
from warpffrf.online.compile.patches.plan import PatchPlan
from warpffrf_kernels.rolling.shear import RINGS

Array = np.ndarray
LONGER, MORE = 1.25, 3  # L of the preconditioner is LONGER columns + MORE
FEWEST = 250  # cells of a patch: below, factors of all tractions cost less than iterations
LEAST_EIGENVALUE = 0.02  # of the median of a preconditioner's: smaller ones, of kernels cut off, are raised to it


def weights(length: int) -> Array:
    """Weights of the frequencies in the inverse transform."""
    found = np.full(length // 2 + 1, 2.0 / length)
    found[0] = 1.0 / length
    if length % 2 == 0:
        found[-1] = 1.0 / length
    return found


def wave_tables(columns: int, length: int) -> Array:
    """(4, frequencies, pairs of strips): cosines and sines of the transform, and the same with its weights 1/L, 2/L for
    the inverse; strips in pairs that are opposite about the middle, from the outside."""
    angle = np.outer(
        2.0 * np.pi * np.arange(length // 2 + 1) / length, (columns - 1) / 2 - np.arange((columns + 1) // 2)
    )
    weight = weights(length)[:, None]
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine, sine, weight * cosine, weight * sine])


def blocks(table: Array, rings: int, length: int, reach: int) -> Array:
    """M_k (frequencies, 2 rows, 2 rows) of a table (kinds, strips, loaded rows, receiving rows) of `rolling.shear`, by
    the distances up to `reach`; lines displace, columns load."""
    rows = table.shape[2]
    kinds = np.swapaxes(table[:3, : reach + 1, :, rings : rings + rows], 2, 3)  # (kind, d, displaced, loaded)
    omega = 2.0 * np.pi * np.arange(length // 2 + 1) / length
    angle = np.outer(omega, np.arange(reach + 1))
    twice = np.where(np.arange(reach + 1) > 0, 2.0, 1.0)
    if length % 2 == 0 and reach == length // 2:
        twice[-1] = 1.0  # both distances of half a period are the same cell
    even, odd = twice * np.cos(angle), twice * np.sin(angle)
    along, across = (np.einsum("kd,dij->kij", even, kinds[n]) for n in (0, 1))
    both = np.einsum("kd,dij->kij", odd, kinds[2])
    return np.block([[along, -both], [both, across]])


def inverted(M: Array) -> Array:
    """M_k^-1, with eigenvalues that are not too small."""
    value, vector = np.linalg.eigh(0.5 * (M + np.swapaxes(M, 1, 2)))
    value = np.maximum(value, LEAST_EIGENVALUE * np.median(value))
    return np.einsum("kij,kj,klj->kil", vector, 1.0 / value, vector)


def padded(M: Array, line: int) -> Array:
    """(frequencies, loaded, displaced), both components filled up to `line` rows."""
    rows = M.shape[1] // 2
    out = np.zeros((len(M), 2, line, 2, line))
    out[:, :, :rows, :, :rows] = np.swapaxes(M, 1, 2).reshape(len(M), 2, rows, 2, rows)
    return out.reshape(len(M), 2 * line, 2 * line)


def strip_tables(levels: Array, columns: int, rings: int, line: int) -> tuple[Array, Array, Array]:
    """Of the levels of a pair (levels, kinds, strips, loaded rows, receiving rows): its wave tables, those of K before
    those of W; the blocks of K by level; by level the diagonal of W, padded, and its blocks."""
    length, period = 2 * columns, int(LONGER * columns) + MORE
    waves = [wave_tables(columns, length), wave_tables(columns, period)]
    reach = min(period // 2, columns + RINGS - 1)
    K = np.stack([padded(blocks(table, rings, length, columns - 1), line) for table in levels])
    W = np.stack([padded(inverted(blocks(table, rings, period, reach)), line) for table in levels])
    own = np.einsum("k,lkii->li", weights(period), W)
    return np.concatenate([t.ravel() for t in waves]), K, np.concatenate([own, W.reshape(len(W), -1)], axis=1)


class StripTables:
    """The tables of all pairs of a scene, pair by pair; none unless `present`."""

    def __init__(self, *, present: bool) -> None:
        self.present = present
        self._found: dict[str, list[Array]] = {"wave": [], "spectrum": [], "inverse": []}
        self._start: dict[str, list[int]] = {name: [] for name in self._found}
        self._numbers = self._blocks = 0

    @classmethod
    def of(cls, contacts: Sequence[Contact], rolling: Mapping[int, PatchPlan]) -> StripTables:
        """Present where all contacts with friction are patches of enough cells, with coefficients that do not depend on
        the slip speed, whose slopes need all cells in one block."""
        rubbing = [i for i, contact in enumerate(contacts) if contact.friction.acts]
        enough = all(i in rolling and rolling[i].columns * len(rolling[i].z) >= FEWEST for i in rubbing)
        constant = not any(contacts[i].friction.breaks for i in rubbing)
        return cls(present=bool(rubbing) and enough and constant)

    def skip(self) -> None:
        """The next pair has none."""
        for name, tables in self._found.items():
            self._start[name].append(sum(map(len, tables)))

    def add(self, levels: Array, columns: int, rings: int, line: int) -> None:
        """Those of the next pair, see `strip_tables`."""
        self.skip()
        if not self.present:
            return
        wave, spectrum, inverse = strip_tables(levels, columns, rings, line)
        for name, table in (("wave", wave), ("spectrum", spectrum), ("inverse", inverse)):
            self._found[name].append(table.ravel())
        self._blocks = max(self._blocks, spectrum[0].size)
        self._numbers = max(self._numbers, 2 * line * (2 * ((columns + 1) // 2) + 4 * (columns + 1)))

    def arrays(self) -> dict[str, Any]:
        """What `Rolling` has of them."""
        found: dict[str, Any] = {f"{name}_start": start for name, start in self._start.items()}
        found |= {name: np.concatenate([np.zeros(0), *tables]) for name, tables in self._found.items()}
        return found | {
            "strips": int(self.present), "strip_numbers": self._numbers, "spectrum_numbers": self._blocks
        }  # fmt: skip
