r"""Stiffness that a lumped contact under load has against motions which neither open nor close its gap.

To first order a ball slides freely across the bottom of its groove. To second order it climbs: the normal leans, and
the force F with it. A motion that gives the two bodies the displacements u_1, u_2 at the place x and the turns phi_1,
phi_2 moves the place and leans the normal by dx and dn (`warpffrf_kernels.lumped.places`), and the force on the first
body and its moment about r_1 change by

    df = F dn,      dm = (dx - dr_1) x F n + (x - r_1) x F dn,

opposite ones on the second. Over the motions, -(df . dr + dm . phi) of both bodies is a matrix, whose symmetric part is
the stiffness: F/(r - R) of a ball of radius R in a groove of radius r, none of a ball that spins or rolls on a plane.
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.diagnosis.failure_report import largest_force
from warpffrf.online.engine import Engine

SOFT = 1e-6  # of the largest force over the length of the scene: a stiffness below is none


def without_stiff(engine: Engine, world: int, weight: np.ndarray, motions: np.ndarray) -> np.ndarray:
    """Of `motions`, orthonormal lines (n, 6 bodies) as of `free_motions`, the combinations that no lumped contact under
    load resists."""
    if not len(motions):
        return motions
    K = sum(_stiffness(engine, world, motions / weight), np.zeros((len(motions), len(motions))))
    values, vectors = np.linalg.eigh(0.5 * (K + K.T))
    mass = weight[::6] ** 2
    soft = SOFT * largest_force(engine, world) / (float(engine.compiled.model.length) * float(mass.mean()))
    return vectors.T[values <= soft] @ motions


def _stiffness(engine: Engine, world: int, motions: np.ndarray) -> list[np.ndarray]:
    """Of each closed place, (n, n)."""
    m, lumped = engine.compiled.model, engine.compiled.elements.lumped
    loads = engine.scratch.lumped_load.numpy()[world, : lumped.places]
    r, axes = engine.scratch.r1.numpy()[world], engine.scratch.axes.numpy()[world]
    body, found = m.surfaces.body.numpy(), []
    for place in np.flatnonzero(loads["force"] > 0.0):
        touch, F = loads["touch"][place], float(loads["force"][place])
        x, n, H, Y = (np.asarray(touch[name]) for name in ("x", "n", "H", "Y"))
        contact = lumped.contact.numpy()[place]
        moves, turns, displaced, levers = [], [], [], []
        for surface in (lumped.first.numpy()[contact], lumped.second.numpy()[contact]):
            b = int(body[surface])
            part = motions[:, 6 * b : 6 * b + 6] if b >= 0 else np.zeros((len(motions), 6))
            lever = x - r[b] if b >= 0 else x
            turn = part[:, 3:] @ axes[b].T if b >= 0 else part[:, 3:]
            moves.append(part[:, :3])
            turns.append(turn)
            levers.append(lever)
            displaced.append(part[:, :3] + np.cross(turn, lever))
        (u1, u2), (t1, t2) = displaced, turns
        dx = u1 + (np.cross(t1 - t2, n) + (u2 - u1) @ H) @ Y + float(touch["between"]) * ((u2 - u1) @ n)[:, None] * n
        dn = np.cross(t2, n) + (dx - u2) @ H
        K = np.zeros((len(motions), len(motions)))
        for sign, move, turn, lever in zip((1.0, -1.0), moves, turns, levers, strict=True):
            moment = np.cross(dx - move, F * n) + np.cross(lever, F * dn)
            K -= sign * (F * dn @ move.T + moment @ turn.T)
        found.append(K)
    return found
