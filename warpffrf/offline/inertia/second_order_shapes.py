r"""The second-order motion of a body on few shapes.

Theta = theta r, r the products of `second_order.Pairs`, has a field for each pair of modes. In the mass it is

    int |Theta|^2 dm = r.G r,      G = theta^T M theta = sum_s mu_s v_s v_s^T,
    Theta = sum_s g_s B_s,      g_s = sqrt(mu_s) v_s.r = q.S_s q/2,      B_s = theta v_s/sqrt(mu_s),

B_s of modal mass 1 and orthogonal to one another. As |r| = 2 V2, shapes with sqrt(mu_s) below `TRUNCATION` of the
largest leave out at most this fraction of the largest root mean square of Theta of all states of the same strain energy
V2, whichever modes span the space.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.reduced.second_order_motion import SecondOrderMotion
from warpffrf.offline.fe.assembly import Sparse
from warpffrf.offline.inertia.second_order import Pairs

Array = np.ndarray
TRUNCATION = 3e-3  # of the largest second-order motion; at 1e-2 strains of skins were wrong by half of them
COLUMNS = 64  # fields that are multiplied by the mass together


@dataclass(frozen=True, eq=False)
class SecondOrderShapes:
    """`motion`, the amplitudes of the `shapes` B (3 n, R), and `facts` for the report."""

    motion: SecondOrderMotion
    shapes: Array
    facts: dict[str, Any]


def second_order_shapes(pairs: Pairs, theta: Array, scale: Array, M: Sparse, U: Array) -> SecondOrderShapes:
    """Shapes of the second-order motion `theta` (3 n, P) [m] of `pairs` of the first of the modes `U` (3 n, k), at unit
    energy, `scale` (m,) [rad/s] their frequencies; `M` (3 n, 3 n) [kg] nodal mass matrix."""
    count, covered = pairs.modes, U.shape[1]
    G = np.empty((len(pairs), len(pairs)))
    for start in range(0, len(pairs), COLUMNS):
        part = slice(start, start + COLUMNS)
        G[:, part] = theta.T @ (M @ theta[:, part])
    values, vectors = np.linalg.eigh(0.5 * (G + G.T))
    size, vectors = np.sqrt(values[::-1].clip(0.0)), vectors[:, ::-1]
    kept = int(np.sum(size > TRUNCATION * size[0]))
    vectors = vectors[:, :kept] * np.sign(vectors[np.abs(vectors[:, :kept]).argmax(axis=0), np.arange(kept)])
    forms = np.zeros((kept, covered, covered))
    forms[:, :count, :count] = 2.0 * size[:kept, None, None] * pairs.forms(vectors) * np.outer(scale, scale)
    shapes = theta @ (vectors / size[:kept])
    left_out = float(size[kept] / size[0]) if 0 < kept < len(size) else 0.0
    return SecondOrderShapes(
        SecondOrderMotion(forms, U.T @ (M @ shapes)), shapes, {"shapes": kept, "motion_left_out": left_out}
    )
