"""Friction of joints at the start of a run: which of them slip, and with which force.

A joint whose sides move against each other slips, against their velocity. One at rest sticks, unless it would need more
than the bound (`warpffrf.model.forces.laws.SlipLaw`); it then begins to slip the way that it was pulled, and of several
those go that are asked for too much, until no other is. The bound follows from reactions that friction changes, so it
is looked at anew whenever they are.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.forces import SlipLaw
from warpffrf.online.engine import Engine

AT_REST = 1e-9  # of the fastest surface that rubs and 1 m/s: what round-off leaves of velocities that are zero


class Friction:
    """Of the joints of one world, with velocities of the `rate` (rows,) of its rows."""

    def __init__(self, engine: Engine, world: int, rate: np.ndarray) -> None:
        self.engine, self.world = engine, world
        table = engine.compiled.slips
        self.rows, self.held = list(table.rows.values()), list(table.held.values())
        self.laws = list(table.laws.values())
        slip = [np.array(law.weights) * rate[rows] for law, rows in zip(self.laws, self.rows, strict=True)]
        fastest = max([1.0, *(float(np.linalg.norm(v)) for v in slip)])
        self.ways = [self._way(law, v, fastest) for law, v in zip(self.laws, slip, strict=True)]

    @property
    def sticking(self) -> list[int]:
        """Rows that stick."""
        return [row for rows, way in zip(self.rows, self.ways, strict=True) if way is None for row in rows]

    def forces(self, lam: np.ndarray) -> tuple[list[int], np.ndarray]:
        """Rows that slip, and their friction as multipliers, for reactions by the multipliers `lam`."""
        rows, found = [], []
        for e, way in enumerate(self.ways):
            if way is not None:
                rows += self.rows[e]
                found += list(np.array(self.laws[e].weights) * self._bound(e, lam) * way)
        return rows, np.array(found)

    def lets_go(self, lam: np.ndarray) -> bool:
        """Let those slip that stick by more than their bound; True if there are any."""
        gone = False
        for e, (law, rows, way) in enumerate(zip(self.laws, self.rows, self.ways, strict=True)):
            force = lam[rows] / np.array(law.weights)
            size = float(np.linalg.norm(force))
            if way is None and size > self._bound(e, lam):
                self.ways[e], gone = force / size, True
        return gone

    def store(self, lam: np.ndarray) -> None:
        """Tell the engine which joints slip, where the others stick, and the bounds by the multipliers `lam`."""
        value = self.engine.scratch.coordinate.numpy()[self.world]
        arrays = [self.engine.state.slipping, self.engine.state.stuck_at, self.engine.scratch.slip_bound]
        slipping, stuck_at, bound = (array.numpy().copy() for array in arrays)
        for e, (rows, way) in enumerate(zip(self.rows, self.ways, strict=True)):
            slipping[self.world, e] = int(way is not None)
            stuck_at[self.world, e, : len(rows)] = value[rows]
            bound[self.world, e] = self._bound(e, lam)
        for array, values in zip(arrays, (slipping, stuck_at, bound), strict=True):
            array.assign(values)

    @staticmethod
    def _way(law: SlipLaw, v: np.ndarray, fastest: float) -> np.ndarray | None:
        """Friction over its bound, None of one that sticks."""
        speed, slow = float(np.linalg.norm(v)), law.friction.creep_limit
        if slow > 0.0:
            return v / max(speed, slow)
        return v / speed if speed > AT_REST * fastest else None

    def _bound(self, e: int, lam: np.ndarray) -> float:
        law, wrench = self.laws[e], self.engine.scratch.row_wrench.numpy()[self.world]
        row = wrench[self.rows[e][0]]
        axis = row[:3] if law.coordinates[0].kind == "translation" else row[3:]
        on_second = -lam[self.held[e]] @ wrench[self.held[e]]
        return law.bound(on_second[:3], on_second[3:], axis)
