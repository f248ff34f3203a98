r"""Sheets under slowly changing loads: increments with friction, on the full flexibility of the cells.

With the loads F a(step) and the cells' forces s, u = K^-1 (F a + B s); the relative displacement of the cells is

    delta = B^T K^-1 F a + C s,      C = B^T K^-1 B,

and an increment is `contact_program.solve` with G = C + E, E the compliance of layers, and b = delta without forces
plus the initial gap along n, less the accumulated slip along t1 and t2. Slip is that of Coulomb's element: with a layer
in series delta_t + E t, the rest being elastic. Nothing is reduced; K is factorised once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.small_sliding.cells import Cells
from references.small_sliding.contact_program import solve
from references.small_sliding.full_model import FullModel
from warpffrf.model.errors import require_array, require_number

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Followed:
    """Results of a path of n steps and c cells: force (n, c, 3) [N], gap (n, c) [m], slip (n, c, 2) [m] so far, state
    (n, c), dissipated (n,) [J] of each step, observed (n, m), energy (n,) [J]: strain energy of bodies, springs and
    layers; path_steps: of the interior path in all."""

    area: Array
    force: Array
    gap: Array
    slip: Array
    state: Array
    dissipated: Array
    observed: Array
    energy: Array
    path_steps: int

    @property
    def pressure(self) -> Array:
        """(n, c) [Pa]."""
        return self.force[:, :, 0] / self.area

    @property
    def traction(self) -> Array:
        """(n, c, 2) [Pa] along t1 and t2."""
        return self.force[:, :, 1:] / self.area[:, None]

    def loss(self, first: int, last: int) -> float:
        """Work [J] of friction in the steps after `first` up to and including `last`."""
        return float(self.dissipated[first + 1 : last + 1].sum())


class StaticSmallSliding:
    """The cells of a model, condensed: `flexibility` C (3 c, 3 c) [m/N], `responses` K^-1 B (dofs, 3 c).

    friction mu [-]; compliance [m/Pa] of layers between the faces, along n and across; 0: none. Raises `InputError` for
    negative values.
    """

    def __init__(
        self,
        model: FullModel,
        cells: Cells,
        friction: float,
        *,
        normal_compliance: float = 0.0,
        tangential_compliance: float = 0.0,
    ) -> None:
        self.model, self.cells = model, cells
        self.friction = require_number(friction, "joint: friction", non_negative=True)
        normal = require_number(normal_compliance, "joint: normal_compliance", non_negative=True)
        across = require_number(tangential_compliance, "joint: tangential_compliance", non_negative=True)
        self.layers = (np.array([normal, across, across]) / cells.area[:, None]).ravel()
        self.responses = model.solve(cells.loads)
        C = cells.loads.T @ self.responses
        self.flexibility = 0.5 * (C + C.T)

    def follow(self, loads: Array, path: Array, observed: Array | None = None) -> Followed:
        """The history through the factors `path` (n, k) of the `loads` F (dofs, k), from rest without slip; `observed`
        (dofs, m): vectors whose products with the displacements are stored."""
        F = require_array(loads, "joint: loads", (self.model.size, None))
        path = require_array(path, "joint: path", (None, F.shape[1]))
        watched = np.zeros((len(F), 0)) if observed is None else np.asarray(observed, dtype=float)
        still = self.model.solve(F)
        return follow(
            self.flexibility,
            self.cells,
            self.friction,
            self.layers,
            self.cells.loads.T @ still,
            path,
            (watched.T @ still, watched.T @ self.responses),
            F.T @ still,
        )


def follow(
    C: Array,
    cells: Cells,
    friction: float,
    layers: Array,
    moved: Array,
    path: Array,
    seen: tuple[Array, Array],
    own: Array,
) -> Followed:
    """The history of cells with any flexibility C (3 c, 3 c), so that reduced ones can be used instead.

    layers (3 c,) [m/N]; moved (3 c, k): delta per unit load; path (n, k); seen: observed values per unit load (m, k)
    and per cell force (m, 3 c); own (k, k): F^T K^-1 F.
    """
    c, steps = cells.count, len(path)
    G = C + np.diag(layers)
    initial = np.zeros((c, 3))
    initial[:, 0] = cells.gap
    force, gap = np.zeros((steps, c, 3)), np.zeros((steps, c))
    slip, state = np.zeros((steps, c, 2)), np.zeros((steps, c), dtype=int)
    dissipated, energy, shown = np.zeros(steps), np.zeros(steps), np.zeros((steps, len(seen[0])))
    s, slipped, path_steps = np.zeros((c, 3)), np.zeros((c, 2)), 0
    for i, a in enumerate(path):
        b = (moved @ a).reshape(c, 3) + initial
        b[:, 1:] -= slipped
        found = solve(G, b, friction, s)
        s = found.force
        slipped = slipped + found.motion[:, 1:]
        force[i], gap[i], slip[i], state[i] = s, found.motion[:, 0], slipped, found.state
        dissipated[i], path_steps = found.dissipated, path_steps + found.path_steps
        flat = s.ravel()
        shown[i] = seen[0] @ a + seen[1] @ flat
        energy[i] = 0.5 * (a @ own @ a + 2.0 * flat @ (moved @ a) + flat @ (C @ flat) + layers @ flat**2)
    return Followed(cells.area, force, gap, slip, state, dissipated, shown, energy, path_steps)
