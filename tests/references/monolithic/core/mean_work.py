r"""The mean over a step of forces through quadratic coordinates, with exactly the work of their potential.

A force f through a coordinate c with gradient g, linear in q, has the mean (f_0 + f_1)/2 (g_0 + g_1)/2, whose work is
that of f; the mean of f g at both ends differs from it by C = -(f_1 - f_0)(g_1 - g_0)/4. There are two kinds: the
squares of the membrane energy, f = e_r, g = L_r q, and the second-order motion -q.K_c q/2 of a marker's interface,
g = -K_c q, under the force f (6,) of all rows and springs there, body axes. A step in time with memory of accelerations
has on the modes the force Y_1 in addition, and y_1 in their algorithmic acceleration,

    gamma y_1 + (1 - gamma) y_0 = C,      (1 - alpha_f) Y_1 + alpha_f Y_0 = (1 - alpha_m) y_1 + alpha_m y_0.

The force of a row follows from its generalised force on the marker's body, force F (world axes) and moment
M about the centre of mass (body axes): with d the position of the marker and l its lever from the interface's point,

    f = A^T F,      t = M + (l - d) x f.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.monolithic.core.description import SceneData
from references.monolithic.core.integrator import BEGIN, FORGET, PROJECT, REST, Formula
from references.monolithic.core.rotation import hat
from references.monolithic.core.rows import MarkerState, RowStates
from references.monolithic.core.state import Layout, State

FORGETTING = (REST, PROJECT, BEGIN, FORGET)  # steps without memory of accelerations


@dataclass(eq=False)
class Pulls:
    """Forces of rows at markers whose interfaces have a second-order motion: `value` (markers, 6), and by marker its
    `change` (6, unknowns)."""

    value: np.ndarray
    change: dict[int, np.ndarray]

    @classmethod
    def none(cls, data: SceneData, layout: Layout) -> Pulls:
        size = layout.retained + layout.rows
        stiffened = [m for m, place in enumerate(data.markers) if place.stiffening is not None]
        return cls(np.zeros((len(data.markers), 6)), {m: np.zeros((6, size)) for m in stiffened})

    def add(
        self, number: int, marker: MarkerState, rows: RowStates, first: int, at: np.ndarray, lam: np.ndarray,
        columns: np.ndarray, lam_change: np.ndarray,
    ) -> None:  # fmt: skip
        """Rows (k) with multipliers `lam` (k,), which change by `lam_change` (k, c) with the unknowns `columns` (c,);
        the coordinates of the rows are the unknowns `at` (n,), those of the marker's body starting at `first`."""
        own = slice(first, first + marker.moved.shape[1])
        turn = slice(first + 3, first + 6)
        A = marker.A
        f = rows.force[:, first : first + 3] @ A
        df = np.einsum("ij,kin->kjn", A, rows.turning[:, first : first + 3])
        arm = marker.place.point - marker.place.pivot - A.T @ (marker.x - marker.r)
        t = rows.force[:, turn] + np.cross(arm, f)
        moved = A.T @ marker.moved
        moved[:, :6] = 0.0
        for k in range(len(lam)):
            df[k][:, turn] += hat(f[k])
            dt = rows.turning[k, turn] + hat(arm) @ df[k]
            dt[:, own] += hat(f[k]) @ moved
            np.add.at(self.change[number].T, at, lam[k] * np.concatenate([df[k], dt]).T)
            pull = np.concatenate([f[k], t[k]])
            self.value[number] += lam[k] * pull
            np.add.at(self.change[number].T, columns, np.outer(lam_change[k], pull))


def add_mean_work(
    data: SceneData, layout: Layout, state: State, formula: Formula, q: np.ndarray, pulls: Pulls,
    residual: np.ndarray, tangent: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Add Y_1 of the trial coordinates `q` and pulls to `residual` and `tangent`; returns (2, modes): y_1, Y_1."""
    c, n = formula.coefficients, layout.modes
    if c in FORGETTING:
        return np.zeros((2, n))
    miss, slope = np.zeros(n), np.zeros((n, len(residual)))
    dq = q[:n] - state.q[:n]
    for b, body in enumerate(data.bodies):
        if body.membrane is not None:
            first, L = layout.mode_start[b], body.membrane
            some = slice(first, first + L.shape[1])
            y0, y1 = L @ state.q[some], L @ q[some]
            de = 0.5 * (y1 @ q[some] - y0 @ state.q[some])
            miss[some] -= 0.25 * de @ (y1 - y0)
            columns = slice(6 * layout.bodies + some.start, 6 * layout.bodies + some.stop)
            slope[some, columns] -= 0.25 * ((y1 - y0).T @ y1 + np.tensordot(de, L, 1))
    for m, change in pulls.change.items():
        place = data.markers[m]
        first, K = layout.mode_start[place.body], place.stiffening
        assert K is not None
        some = slice(first, first + K.shape[1])
        columns = slice(6 * layout.bodies + some.start, 6 * layout.bodies + some.stop)
        df, dg = pulls.value[m] - state.pulls[m], -K @ dq[some]
        miss[some] -= 0.25 * df @ dg
        slope[some] -= 0.25 * dg.T @ change
        slope[some, columns] += 0.25 * np.tensordot(df, K, 1)
    y = (miss - (1.0 - c.gamma) * state.lag[0]) / c.gamma
    Y = ((1.0 - c.alpha_m) * y + c.alpha_m * state.lag[0] - c.alpha_f * state.lag[1]) / (1.0 - c.alpha_f)
    at = slice(6 * layout.bodies, layout.retained)
    residual[at] += Y
    tangent[at] += (1.0 - c.alpha_m) / (c.gamma * (1.0 - c.alpha_f)) * slope
    return np.stack([y, Y])
