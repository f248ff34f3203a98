r"""Tables of the products by strips -> device (kernels of `patch.strips`): the compliance K of pressures, and that of
tractions, by the half-spaces, and their preconditioners W, as blocks by frequency.

Cells have equal widths, so K depends on the distance in strips d = c - c' and on two rows, in any way: K is block
Toeplitz. A discrete Fourier transform along the strips, of length L >= 2 columns - 1, makes it block diagonal. The
kinds (pressures; `rolling.shear`) are even in d, or odd where e_1 and tau_2, or e_2 and tau_1 meet; so with component 1
of tractions divided by i every block is real and symmetric,

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


def transformed(kinds: Array, length: int, *, odd: bool = False) -> Array:
    """sum_d cos(omega_k d) K_d, or sines where K is odd in d, of K (distances, i, j) -> (frequencies, i, j)."""
    reach = len(kinds) - 1
    angle = np.outer(2.0 * np.pi * np.arange(length // 2 + 1) / length, np.arange(reach + 1))
    twice = np.where(np.arange(reach + 1) > 0, 2.0, 1.0)
    if length % 2 == 0 and reach == length // 2:
        twice[-1] = 1.0  # both distances of half a period are the same cell
    return np.einsum("kd,dij->kij", twice * (np.sin(angle) if odd else np.cos(angle)), kinds)


def blocks(table: Array, rings: int, length: int, reach: int) -> Array:
    """M_k (frequencies, 2 rows, 2 rows) of a table (kinds, strips, loaded rows, receiving rows) of `rolling.shear`, by
    the distances up to `reach`; lines displace, columns load."""
    rows = table.shape[2]
    kinds = np.swapaxes(table[:3, : reach + 1, :, rings : rings + rows], 2, 3)  # (kind, d, displaced, loaded)
    along, across, both = (transformed(kinds[n], length, odd=n == 2) for n in range(3))
    return np.block([[along, -both], [both, across]])


def inverted(M: Array) -> Array:
    """M_k^-1, with eigenvalues that are not too small."""
    value, vector = np.linalg.eigh(0.5 * (M + np.swapaxes(M, 1, 2)))
    value = np.maximum(value, LEAST_EIGENVALUE * np.median(value))
    return np.einsum("kij,kj,klj->kil", vector, 1.0 / value, vector)


def padded(M: Array, line: int, components: int) -> Array:
    """(frequencies, loaded, displaced), all components filled up to `line` rows."""
    rows = M.shape[1] // components
    out = np.zeros((len(M), components, line, components, line))
    out[:, :, :rows, :, :rows] = np.swapaxes(M, 1, 2).reshape(len(M), components, rows, components, rows)
    return out.reshape(len(M), components * line, components * line)


def waves(columns: int) -> Array:
    """The wave tables of a pair, those of K before those of W."""
    return np.concatenate([wave_tables(columns, length).ravel() for length in (2 * columns, period_of(columns))])


def period_of(columns: int) -> int:
    """L of the preconditioner."""
    return int(LONGER * columns) + MORE


def with_diagonals(W: Array, period: int) -> Array:
    """(levels, numbers): by level the diagonal of W (levels, frequencies, n, n), and W."""
    own = np.einsum("k,lkii->li", weights(period), W)
    return np.concatenate([own, W.reshape(len(W), -1)], axis=1)


def pressure_tables(table: Array, line: int) -> tuple[Array, Array]:
    """Of the near table of a pair (levels, strips, rows, rows): the blocks of K by level; W with its diagonal."""
    columns = table.shape[1]
    period = period_of(columns)
    near = table[:, : min(period // 2, columns - 1) + 1]
    K = np.stack([padded(transformed(level, 2 * columns), line, 1) for level in table])
    W = np.stack([padded(inverted(transformed(level, period)), line, 1) for level in near])
    return K, with_diagonals(W, period)


def strip_tables(levels: Array, columns: int, rings: int, line: int) -> tuple[Array, Array]:
    """The same of tractions, `levels` (levels, kinds, strips, loaded rows, receiving rows)."""
    period = period_of(columns)
    reach = min(period // 2, columns + RINGS - 1)
    K = np.stack([padded(blocks(table, rings, 2 * columns, columns - 1), line, 2) for table in levels])
    W = np.stack([padded(inverted(blocks(table, rings, period, reach)), line, 2) for table in levels])
    return K, with_diagonals(W, period)


def product_numbers(columns: int, line: int, components: int) -> int:
    """Numbers that a product needs."""
    return components * line * (2 * ((columns + 1) // 2) + 4 * (columns + 1))


class StripTables:
    """The tables of the tractions of all pairs of a scene, pair by pair; none unless `present`."""

    def __init__(self, *, present: bool) -> None:
        self.present = present
        self._found: dict[str, list[Array]] = {"spectrum": [], "inverse": []}
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
        spectrum, inverse = strip_tables(levels, columns, rings, line)
        self._found["spectrum"].append(spectrum.ravel())
        self._found["inverse"].append(inverse.ravel())
        self._blocks = max(self._blocks, spectrum[0].size)
        self._numbers = max(self._numbers, product_numbers(columns, line, 2))

    def arrays(self) -> dict[str, Any]:
        """What `Rolling` has of them."""
        found: dict[str, Any] = {f"{name}_start": start for name, start in self._start.items()}
        found |= {name: np.concatenate([np.zeros(0), *tables]) for name, tables in self._found.items()}
        return found | {
            "strips": int(self.present), "strip_numbers": self._numbers, "spectrum_numbers": self._blocks
        }  # fmt: skip
