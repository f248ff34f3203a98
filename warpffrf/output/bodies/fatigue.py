"""Cycles of a stress history for fatigue: rainflow counting by ASTM E1049-85 (2011), 5.4.4, of the package rainflow.

The standard counts a closed range as one cycle and what remains open at the ends of the history as halves. A history
that repeats, such as the last revolution of a run, has to begin at its largest or smallest value to have no halves but
those of its envelope. With an S-N curve N r^m = constant and the linear damage of Palmgren and Miner, n_i cycles of
ranges r_i damage as much as n cycles of the range (sum n_i r_i^m / n)^(1/m).
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.errors import InputError, require_count, require_direction, require_number, unknown_name
from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole
from warpffrf.model.messages import reprs
from warpffrf.model.reduced.stress_field import to_tensor, von_mises

Array = np.ndarray
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
SIGNED = "signed_von_mises"


@dataclass(frozen=True, eq=False, repr=False)
class StressCycles(reprs.Rows):
    """Cycles of a stress history by rainflow counting, returned by `StressResult.rainflow`, as they close: `range` and
    `mean` (n,) [Pa], `count` (n,) 1 or 0.5, `start` and `end` (n,) [s] of the first and second extreme."""

    quantity: str
    range: Array
    mean: Array
    count: Array
    start: Array
    end: Array

    def equivalent_range(self, exponent: float, cycles: float = 1.0) -> float:
        """The range [Pa] that, with this number of `cycles`, damages as much as the history, by an S-N curve N r^m =
        constant of exponent m and linear damage; mean stresses have no effect on it. Raises `InputError` for an
        exponent or a number that is not positive."""
        m = require_number(exponent, "equivalent_range: exponent", positive=True)
        n = require_number(cycles, "equivalent_range: cycles", positive=True)
        largest = float(self.range.max(initial=0.0))
        if largest == 0.0:
            return 0.0
        return largest * float(self.count @ (self.range / largest) ** m / n) ** (1.0 / m)

    def to_csv(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write the cycles, a row each; returns the path. Raises `InputError` for a file that is not to be replaced."""
        columns = {"range [Pa]": self.range, "mean [Pa]": self.mean, "count [1]": self.count}
        columns |= {"start [s]": self.start, "end [s]": self.end}
        return written_csv(path, [f"cycles of {self.quantity}, rainflow counting by ASTM E1049-85"], columns, overwrite)


def rainflow(stress: Any, point: int, of: str | Vector) -> StressCycles:
    """See `StressResult.rainflow`."""
    try:
        from rainflow import extract_cycles
    except ImportError:
        raise InputError("rainflow: it needs the package rainflow; pip install 'warpffrf[fatigue]'") from None
    point = require_count(point, "rainflow: point", 0, stress.tensor.shape[1] - 1)
    values, label = _history(stress.tensor[:, point], of)
    found = np.array(list(extract_cycles(values.tolist())), dtype=np.float64).reshape(-1, 5)
    first, last = stress.time[found[:, 3:].astype(np.int64)].T
    return StressCycles(f"{label} at point {point}", found[:, 0], found[:, 1], found[:, 2], first, last)


def _history(tensor: Array, of: str | Vector) -> tuple[Array, str]:
    """The scalar history (T,) of a stress (T, 6), and its name."""
    if not isinstance(of, str):
        n = require_direction(of, "rainflow: of")
        along = ", ".join(f"{v:.4g}" for v in n)
        return np.einsum("i,tij,j->t", n, to_tensor(tensor), n), f"normal stress along ({along})"
    if of == SIGNED:
        values = np.linalg.eigvalsh(to_tensor(tensor))
        return np.where(values[:, 2] >= -values[:, 0], 1.0, -1.0) * von_mises(tensor), "signed von Mises stress"
    if of not in COMPONENTS:
        raise unknown_name("rainflow: of", of, (*COMPONENTS, SIGNED))
    return tensor[:, COMPONENTS.index(of)], f"stress {of}"


def stress_csv(stress: Any, path: str | os.PathLike[str], overwrite: bool) -> Path:
    """See `StressResult.to_csv`."""
    notes = ["stress tensors in axes of the body's user frame"]
    notes += [f"point {k}: {', '.join(map(repr, x))} m" for k, x in enumerate(stress.points.tolist())]
    columns = {"time [s]": stress.time}
    for k in range(stress.tensor.shape[1]):
        columns |= {f"{name}[{k}] [Pa]": stress.tensor[:, k, c] for c, name in enumerate(COMPONENTS)}
    return written_csv(path, notes, columns, overwrite)


def written_csv(path: str | os.PathLike[str], notes: list[str], columns: dict[str, Array], overwrite: bool) -> Path:
    """Write columns of equal length with their names, after `notes` as comments; all digits."""
    check_ending(path, "to_csv", (".csv",))
    target = checked_output_path(path, "to_csv", overwrite=overwrite)
    rows = [",".join(map(repr, row)) for row in np.stack(list(columns.values()), axis=1).tolist()]
    lines = ["# written by warpffrf", *(f"# {note}" for note in notes), ",".join(columns), *rows, ""]
    with written_whole(target) as partial:
        partial.write_text("\n".join(lines))
    return target
