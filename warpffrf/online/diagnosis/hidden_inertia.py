"""Bodies so light beside their neighbours that round-off leaves nothing of them in the equations of the joints.

A row c of a joint lets its side b give way by c_b M_b^-1 c_b^T under a unit force. What holds a heavy body by a light
one adds both; where the one is 1e16 times the other, double precision has no digit for the latter, and rows that do not
depend on each other look as if they did. A system that is singular although its rows are independent is of that kind.
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.engine import Engine

INDEPENDENT = 1e-8  # smallest over largest singular value of the rows, of length one: they depend on each other below
APART = 1e10  # how much more easily one side gives way than the other, from which round-off is worth a word


def hidden_inertia(engine: Engine, world: int = 0) -> str:
    """What to say of a singular system whose joints are independent, "" of one whose joints are not, or whose masses
    lie near each other."""
    m, scratch, bodies = engine.compiled.model, engine.scratch, engine.scene.bodies
    count, rows = m.bodies.count, np.flatnonzero(m.rows.rigid.numpy()[: m.rows.count])
    C = np.asarray(scratch.C.numpy()[world], dtype=np.float64)[rows, : 6 * count]
    shapes = np.asarray(scratch.C_modal.numpy()[world], dtype=np.float64)[rows, : m.modes.count]
    if not len(rows) or not np.all(np.isfinite(C)) or not _independent(C, shapes, float(m.length)):
        return ""
    gives = _gives_way(C, m.bodies.mass.numpy()[:count], m.bodies.inertia.numpy()[:count])
    two = np.count_nonzero(gives > 0.0, axis=1) == 2
    if not np.any(two):
        return ""
    apart = np.where(two, gives.max(axis=1) / np.where(gives > 0.0, gives, np.inf).min(axis=1), 0.0)
    row = int(np.argmax(apart))
    if apart[row] < APART:
        return ""
    light, heavy = int(np.argmax(gives[row])), int(np.argmin(np.where(gives[row] > 0.0, gives[row], np.inf)))
    return (
        f"body {bodies[light].name!r} is too light beside body {bodies[heavy].name!r}: where a joint holds the two it "
        f"gives way {apart[row]:.1g} times as easily, of which double precision keeps 16 digits; give it more mass or "
        "inertia (it stays negligible with a millionth of its neighbour's), or join its neighbours without it"
    )


def _independent(C: np.ndarray, shapes: np.ndarray, length: float) -> bool:
    """Whether no row depends on the others: C (rows, 6 bodies), turns counted in `length` [m], and `shapes` (rows,
    modes), counted by the largest."""
    scaled = C.reshape(len(C), -1, 6) / np.repeat([1.0, length], 3)
    scaled = np.hstack([scaled.reshape(len(C), -1), shapes / max(float(np.abs(shapes).max(initial=0.0)), 1e-300)])
    sizes = np.linalg.norm(scaled, axis=1)
    if len(C) > scaled.shape[1] or not np.all(sizes > 0.0):
        return False
    values = np.linalg.svd(scaled / sizes[:, None], compute_uv=False)
    return bool(values[-1] > INDEPENDENT * values[0])


def _gives_way(C: np.ndarray, mass: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """c_b M_b^-1 c_b^T (rows, bodies)."""
    c = C.reshape(len(C), len(mass), 6)
    turned = np.einsum("rbi,bij,rbj->rb", c[..., 3:], np.linalg.inv(inertia), c[..., 3:])
    return np.sum(c[..., :3] ** 2, axis=2) / mass + turned
