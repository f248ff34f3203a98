"""Laps on the host: constants of their groups, and the motion that they see."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.online.engine import Engine
from warpffrf_kernels.laps import motion
from warpffrf_kernels.laps.forms import OPEN

Array = np.ndarray


@dataclass(frozen=True)
class LapGroup:
    """Constants of a group of laps on the host, s its forces, z the motion that it sees."""

    cells: slice
    columns: slice  # of z
    components: int  # forces of a cell: 3, or the normal one alone
    G: Array  # (s, s) m/N
    J: Array  # (s, z)
    friction: Array  # (cells,)

    def closed(self, pressed: Array) -> Array:
        """Which components (s,) hold what the cells `pressed` (cells,) see: gaps, and slips where they rub."""
        closed = np.repeat(pressed[:, None], self.components, axis=1)
        if self.components == 3:
            closed[:, 1:] &= (self.friction > 0.0)[:, None]
        return closed.ravel()

    def stiffness(self, pressed: Array) -> Array:
        """S (z, z) of the cells `pressed` (cells,)."""
        A = self.closed(pressed)
        J_A = self.J[A]
        return J_A.T @ np.linalg.solve(self.G[np.ix_(A, A)], J_A)


def lap_groups(engine: Engine) -> list[LapGroup]:
    """All groups of laps of a scene."""
    laps = engine.compiled.laps
    table = {name: getattr(laps, name).numpy() for name in (
        "cell_start", "column_start", "components", "compliance", "compliance_start", "motion", "motion_start",
        "friction",
    )}  # fmt: skip
    found = []
    for group in range(laps.count):
        cells, columns = (slice(*table[f"{name}_start"][group : group + 2]) for name in ("cell", "column"))
        components = int(table["components"][group])
        s, z = components * (cells.stop - cells.start), columns.stop - columns.start
        G, J = (table[name][table[f"{name}_start"][group] :] for name in ("compliance", "motion"))
        found.append(
            LapGroup(
                cells, columns, components, G[: s * s].reshape(s, s), J[: s * z].reshape(z, s).T,
                table["friction"][cells],
            )
        )  # fmt: skip
    return found


def gradients(engine: Engine, coordinates: int, world: int = 0) -> Array:
    """B (z, coordinates) at the state that was evaluated last, over displacements of the centres of mass,
    turns in body axes, and modes."""
    laps, bodies = engine.compiled.laps, engine.compiled.model.bodies.count
    if not laps.count:
        return np.zeros((0, coordinates))
    B = np.zeros((int(laps.column_start.numpy()[-1]), coordinates))
    own = engine.scratch.lap_gradient.numpy()[world]
    rigid, sides = laps.rigid_column.numpy(), (laps.first.numpy(), laps.second.numpy())
    for lap in range(laps.laps):
        at = rigid[lap]
        for side, body in enumerate(sides):
            if at >= 0 and body[lap] >= 0:
                here = slice(6 * body[lap], 6 * body[lap] + 6)
                B[at : at + int(motion.RIGID), here] += own[lap, :, 6 * side : 6 * side + 6]
    for column, mode in enumerate(laps.column_mode.numpy()):
        if mode >= 0:
            B[column, 6 * bodies + mode] = 1.0
    return B


def held_by_laps(engine: Engine, world: int, size: int) -> tuple[Array, Array]:
    """Gradients, by the rigid coordinates (n, size), of the gaps of cells under pressure, and of their slips where they
    rub, and the forces [N] along them (n,); at the state that was evaluated last."""
    lines, pulls = [np.zeros((0, size))], [np.zeros(0)]
    if engine.compiled.laps.count:
        B = gradients(engine, engine.compiled.model.bodies.count * 6 + engine.compiled.model.modes.count, world)
        pressed = engine.state.lap_state.numpy()[world] != int(OPEN)
        force = engine.state.lap_force.numpy()[world]
        for group in lap_groups(engine):
            closed = group.closed(pressed[group.cells])
            lines.append(group.J[closed] @ B[group.columns, :size])
            pulls.append(force[group.cells, : group.components].ravel()[closed])
    return np.vstack(lines), np.concatenate(pulls)
