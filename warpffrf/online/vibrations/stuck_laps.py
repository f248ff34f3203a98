r"""Laps in small motions: cells under pressure stick, also those that have slipped to get there; open ones stay open.

With z the motion that laps see and B its gradients (`warpffrf_kernels.laps.motion`), `delta z = B delta x`, the forces
s of the cells A that are under pressure keep their gaps closed and their slips as they are,

    G_AA delta s + J_A delta z = 0,      delta f = J_A^T delta s = -S delta z,      S = J_A^T G_AA^-1 J_A >= 0,

so that B^T S B is added to the stiffness of the bodies. A has all three components of a cell with friction, and the
normal one of a cell without. What turning bodies make of the forces f = J^T s of the state itself is geometric
stiffness: they are held while the kernels are evaluated (`hold`), in the axes that turn with the first body.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from warpffrf_kernels.laps import motion
from warpffrf_kernels.laps.forms import OPEN
from warpffrf_kernels.laps.words import HELD

from warpffrf.online.compile.laps import lap_order
from warpffrf.online.engine import Engine

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

    def stiffness(self, pressed: Array) -> Array:
        """S (z, z) of the cells `pressed` (cells,)."""
        closed = np.repeat(pressed[:, None], self.components, axis=1)
        if self.components == 3:
            closed[:, 1:] &= (self.friction > 0.0)[:, None]
        A = closed.ravel()
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


def hold(engine: Engine) -> None:
    """Let the laps of world 0 push the bodies with the forces of the accepted state from now on, whatever moves."""
    if not engine.compiled.laps.count:
        return
    force, push = engine.state.lap_force.numpy()[0], engine.scratch.lap_push.numpy()
    for group in lap_groups(engine):
        push[0, group.columns] = group.J.T @ force[group.cells, : group.components].ravel()
    engine.scratch.lap_push.assign(push)
    words = engine.scratch.lap_words.numpy()
    words[:, :, int(HELD)] = 1
    engine.scratch.lap_words.assign(words)


def gradients(engine: Engine, coordinates: int) -> Array:
    """B (z, coordinates) of world 0 at the state that was evaluated last, over displacements of the centres of mass,
    turns in body axes, and modes."""
    laps, bodies = engine.compiled.laps, engine.compiled.model.bodies.count
    if not laps.count:
        return np.zeros((0, coordinates))
    B = np.zeros((int(laps.column_start.numpy()[-1]), coordinates))
    own = engine.scratch.lap_gradient.numpy()[0]
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


def stuck_stiffness(engine: Engine, coordinates: int) -> Array:
    """B^T S B (coordinates, coordinates) of world 0 at the state that was evaluated last."""
    K = np.zeros((coordinates, coordinates))
    if not engine.compiled.laps.count:
        return K
    pressed, B = engine.state.lap_state.numpy()[0] != int(OPEN), gradients(engine, coordinates)
    for group in lap_groups(engine):
        own = B[group.columns]
        K += own.T @ group.stiffness(pressed[group.cells]) @ own
    return 0.5 * (K + K.T)


def largest_pull(engine: Engine) -> float:
    """Largest force [N] of a lap on its bodies, while they are held."""
    laps = engine.compiled.laps
    push = engine.scratch.lap_push.numpy()[0]
    pulls = [np.linalg.norm(push[at : at + 3]) for at in laps.rigid_column.numpy()[: laps.laps] if at >= 0]
    return float(max(pulls, default=0.0))


def stuck_notes(engine: Engine, name: str) -> list[str]:
    """What a reader of modes about the state `name` should know of its laps."""
    laps, pressed = engine.scene.laps, engine.state.lap_state.numpy()[0] != int(OPEN)
    notes, start = [], 0
    for number in lap_order(laps):
        count = len(laps[number].cells().cell)
        closed = int(np.sum(pressed[start : start + count]))
        start += count
        held = "stick" if laps[number].coefficient > 0.0 else "stay closed and slide without friction"
        if closed:
            notes.append(
                f"{laps[number].label}: {closed} of {count} cells are under pressure and {held}, the others stay open: "
                "the modes are those of vibrations too small to open or rub it; equivalent_damping() has larger ones"
            )
        else:
            notes.append(
                f"{laps[number].label}: none of its {count} cells is under pressure in the {name}, so that it holds "
                "nothing together; take about=None or the Result of equilibrium() or of a run, with what presses on it"
            )
    return notes
