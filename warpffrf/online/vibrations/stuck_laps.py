r"""Small-sliding contacts in small motions: cells under pressure stick, also those that have slipped to get there; open
ones stay open.

With z the motion that laps see and B its gradients (`warpffrf_kernels.laps.motion`), `delta z = B delta x`, the forces
s of the cells A that are under pressure keep their gaps closed and their slips as they are,

    G_AA delta s + J_A delta z = 0,      delta f = J_A^T delta s = -S delta z,      S = J_A^T G_AA^-1 J_A >= 0,

so that B^T S B is added to the stiffness of the bodies. A has all three components of a cell with friction, and the
normal one of a cell without. What turning bodies make of the forces f = J^T s of the state itself is geometric
stiffness: they are held while the kernels are evaluated (`hold`), in the axes that turn with the first body.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.small_sliding.sliding import cells_of
from warpffrf.online.compile.laps import lap_order
from warpffrf.online.engine import Engine
from warpffrf.online.start.motions import gradients, lap_groups
from warpffrf_kernels.laps.forms import OPEN
from warpffrf_kernels.laps.words import HELD

Array = np.ndarray


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
    laps, pressed = engine.scene.small_sliding, engine.state.lap_state.numpy()[0] != int(OPEN)
    notes, start = [], 0
    for number in lap_order(laps):
        count = len(cells_of(laps[number]).cell)
        closed = int(np.sum(pressed[start : start + count]))
        start += count
        held = "stick" if laps[number].friction.static_coefficient > 0.0 else "stay closed and slide without friction"
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
