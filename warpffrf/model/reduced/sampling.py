r"""Few points of a contact surface that stand for all of its points: `Contact(evaluation="hyper")`.

The strip between two columns of a contact grid repeats itself around the surface, so that one list of points serves
every strip. Point p lies at the fraction x_p of a column, and zeta_p between the rows row_p and row_p + 1; its weight
w_p > 0 [m^2] is its share of the area of the strip. Integrals of a function f with the hats psi of the grid become

    int psi_i f dA  ~  sum over strips, sum_p w_p psi_i(x_p) f(x_p),

and hats add up to one, so that the weights of the points around a hat are that hat's area. How the points are chosen is
in `warpffrf.offline.contact.cubature`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError

ALL_AROUND = 3  # Gauss points across a grid cell: the second grid's hats have kinks inside the cell
ALL_ALONG = 2  # Gauss points along a grid cell: exact for products of two linear hats


@dataclass(frozen=True, eq=False)
class Sampling:
    """Points of a strip: `fraction` (n,) of a column in [0, 1), `row` (n,) int, `zeta` (n,) in [0, 1], `weight` (n,)
    [m^2]; what they were trained for.

    `wanted_error`, `training_error`: of the integrals of a training family, against those by all points and over their
    size; wanted, and the worst that was found. `mean_error`: root of the mean square over the families. `families`: how
    many there were.
    """

    fraction: np.ndarray
    row: np.ndarray
    zeta: np.ndarray
    weight: np.ndarray
    wanted_error: float
    training_error: float
    mean_error: float
    families: int

    def __post_init__(self) -> None:
        """Raises `InputError` for points outside a strip and for weights that are not positive."""
        n = len(self.fraction)
        if n == 0 or any(len(a) != n for a in (self.row, self.zeta, self.weight)):
            raise InputError("sampling: fraction, row, zeta and weight must have one entry a point, at least one")
        if np.any(self.fraction < 0.0) or np.any(self.fraction >= 1.0):
            raise InputError("sampling: a point's fraction of a column must be in [0, 1)")
        if np.any(self.row < 0) or np.any(self.zeta < 0.0) or np.any(self.zeta > 1.0):
            raise InputError("sampling: a point must lie between two rows, row >= 0 and zeta in [0, 1]")
        if not np.all(self.weight > 0.0):
            raise InputError("sampling: the weight of every point must be positive [m^2]")

    @property
    def count(self) -> int:
        """Number of points of a strip."""
        return len(self.fraction)

    @property
    def area(self) -> float:
        """Area of the strip [m^2], the sum of the weights."""
        return float(self.weight.sum())

    def axial(self, z: np.ndarray) -> np.ndarray:
        """Axial places (n,) [m] of the points between the rows z (rows,) [m] of the grid."""
        return z[self.row] + self.zeta * (z[self.row + 1] - z[self.row])

    def arrays(self) -> dict[str, np.ndarray]:
        """What of it is arrays, for a file."""
        return {"fraction": self.fraction, "row": self.row, "zeta": self.zeta, "weight": self.weight}

    def facts(self) -> dict[str, Any]:
        """What of it is numbers, for a file and a report."""
        return {
            "wanted_error": float(self.wanted_error),
            "training_error": float(self.training_error),
            "mean_error": float(self.mean_error),
            "families": int(self.families),
        }

    @classmethod
    def restore(cls, arrays: dict[str, np.ndarray], facts: dict[str, Any]) -> Sampling:
        """The sampling that `arrays` and `facts` were taken of. Raises `InputError` as the constructor does."""
        return cls(**arrays, **facts)


def gauss_points(rows: int, around: int, along: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Tensor Gauss points of a strip between `rows` rows: fraction, row, zeta (n,) and the share (n,) of the area of a
    cell of the chart, whose sum is 1 a cell. Evaluation "semi" has `ALL_AROUND` x `ALL_ALONG` of them."""
    (x, wx), (z, wz) = ((0.5 * (p + 1.0), 0.5 * w) for p, w in map(np.polynomial.legendre.leggauss, (around, along)))
    cell = np.arange(rows - 1)
    row, zeta, fraction = (a.ravel() for a in np.meshgrid(cell, z, x, indexing="ij"))
    share = np.broadcast_to(wz[:, None] * wx, (rows - 1, along, around)).ravel()
    return fraction, row.astype(np.int64), zeta, share.copy()
