r"""Small-sliding contacts in small motions: cells under pressure stick, also those that have slipped; open
ones stay open.

With z the relative motion at the contacts and B its gradients (`warpffrf_kernels.matched.motion`), `delta z =
B delta x`, the forces s of the cells A under pressure keep their gaps closed and their slips constant,

    G_AA delta s + J_A delta z = 0,      delta f = J_A^T delta s = -S delta z,      S = J_A^T G_AA^-1 J_A >= 0,

so that B^T S B is added to the stiffness of the bodies. A has all three components of a cell with friction, and the
normal one of a cell without. The rotation of the bodies with the forces f = J^T s of the state itself gives geometric
stiffness: these forces are constant while the kernels are evaluated (`hold`), in the axes that rotate with the first
body.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.small_sliding.sliding import cells_of
from warpffrf.online.compile.matched import matched_order
from warpffrf.online.engine import Engine
from warpffrf.online.start.motions import gradients, matched_groups
from warpffrf_kernels.matched.forms import OPEN
from warpffrf_kernels.matched.status_words import HELD

Array = np.ndarray


def hold(engine: Engine) -> None:
    """From now on, apply the contact forces of the accepted state to the bodies of world 0, independent of motion."""
    if not engine.compiled.matched.count:
        return
    force, push = engine.state.matched_force.numpy()[0], engine.scratch.matched_push.numpy()
    for group in matched_groups(engine):
        push[0, group.columns] = group.J.T @ force[group.cells, : group.components].ravel()
    engine.scratch.matched_push.assign(push)
    words = engine.scratch.matched_words.numpy()
    words[:, :, int(HELD)] = 1
    engine.scratch.matched_words.assign(words)


def stuck_stiffness(engine: Engine, coordinates: int) -> Array:
    """B^T S B (coordinates, coordinates) of world 0 at the last evaluated state."""
    K = np.zeros((coordinates, coordinates))
    if not engine.compiled.matched.count:
        return K
    pressed, B = engine.state.matched_state.numpy()[0] != int(OPEN), gradients(engine, coordinates)
    for group in matched_groups(engine):
        own = B[group.columns]
        K += own.T @ group.stiffness(pressed[group.cells]) @ own
    return 0.5 * (K + K.T)


def largest_pull(engine: Engine) -> float:
    """Largest force [N] of a small-sliding contact on its bodies, while the forces are constant."""
    matched = engine.compiled.matched
    push = engine.scratch.matched_push.numpy()[0]
    pulls = [np.linalg.norm(push[at : at + 3]) for at in matched.rigid_column.numpy()[: matched.matched] if at >= 0]
    return float(max(pulls, default=0.0))


def stuck_notes(engine: Engine, name: str) -> list[str]:
    """Notes on the small-sliding contacts for modes about the state `name`."""
    matched, pressed = engine.scene.small_sliding, engine.state.matched_state.numpy()[0] != int(OPEN)
    notes, start = [], 0
    for number in matched_order(matched):
        count = len(cells_of(matched[number]).cell)
        closed = int(np.sum(pressed[start : start + count]))
        start += count
        held = (
            "stick" if matched[number].friction.static_coefficient > 0.0 else "stay closed and slide without friction"
        )
        if closed:
            notes.append(
                f"{matched[number].label}: {closed} of {count} cells are under pressure and {held}, the others stay "
                "open: the modes are those of vibrations too small to open or rub it; equivalent_damping() has larger "
                "ones"
            )
        else:
            notes.append(
                f"{matched[number].label}: none of its {count} cells is under pressure in the {name}, so that it holds "
                "nothing together; take about=None or the Result of equilibrium() or of a run, with what presses on it"
            )
    return notes
