"""Gradients of gaps and slips of closed contacts, and of slips of joints, by the rigid coordinates of all bodies."""

from __future__ import annotations

import numpy as np

from warpffrf.online.engine import Engine
from warpffrf_kernels.core.model import AT_POINTS


def joint_slips(engine: Engine, world: int, size: int) -> np.ndarray:
    """Gradients of the coordinates of joints with friction that may stick, by the rigid coordinates (rows, size)."""
    table = engine.compiled.slips
    rows = [
        row
        for law, own in zip(table.laws.values(), table.rows.values(), strict=True)
        if law.friction.creep_limit == 0.0
        for row in own
    ]
    return np.asarray(engine.scratch.C.numpy()[world][rows, :size]).reshape(len(rows), size)


def cell_slips(engine: Engine, world: int, size: int) -> list[np.ndarray]:
    """Gradients of the slips of the loaded cells of each contact with friction, by the rigid coordinates (2 cells,
    size).
    """
    m, scratch = engine.compiled.model, engine.scratch
    found = []
    for pair in np.flatnonzero(m.pairs.friction.numpy()[: m.pairs.count] > 0.0):
        rows = int(m.surfaces.rows.numpy()[m.pairs.first.numpy()[pair]])
        pressed = engine.state.active.numpy()[world, pair] != 0
        wrench = scratch.cell_wrench.numpy()[world, pair]
        cells = np.flatnonzero(pressed & (scratch.cell_area.numpy()[world, pair, : len(pressed)] > 0.0))
        first = (cells // rows) * 2 * rows + cells % rows
        found.append(_of_wrenches(engine, world, int(pair), wrench[np.concatenate([first, first + rows])], size))
    return found


def closed_places(engine: Engine, world: int) -> np.ndarray:
    """The lumped contacts that carry load."""
    places = engine.compiled.elements.lumped.places
    return np.flatnonzero(engine.state.lumped_force.numpy()[world, 1, :places] > 0.0)


def lumped_gradients(engine: Engine, world: int, size: int, *, slips: bool = False) -> np.ndarray:
    """Gradients of the gaps of closed lumped contacts, by the rigid coordinates (places, size); slips: of the slips of
    those that may stick (2 places, size).
    """
    m, state, scratch = engine.compiled.model, engine.state, engine.scratch
    lumped = engine.compiled.elements.lumped
    places = closed_places(engine, world)
    n, x = (getattr(state, name).numpy()[world, 1] for name in ("lumped_normal", "lumped_at"))
    axes, r, body = scratch.axes.numpy()[world], scratch.r1.numpy()[world], m.surfaces.body.numpy()
    ways = n[places]
    if slips:
        laws = [c.friction for c in engine.scene.lumped_contacts]
        sticks = [laws[c].acts and laws[c].creep_limit == 0.0 for c in lumped.contact.numpy()[places]]
        places = np.repeat(places[np.array(sticks, dtype=bool)], 2)
        ways = np.linalg.svd(n[places[::2], None])[2][:, 1:].reshape(-1, 3)
    contact, lines = lumped.contact.numpy()[places], np.zeros((len(places), size // 6, 6))
    for sign, surface in ((1.0, lumped.first.numpy()[contact]), (-1.0, lumped.second.numpy()[contact])):
        moving = np.flatnonzero(body[surface] >= 0)
        b = body[surface[moving]]
        moment = np.cross(x[places[moving]] - r[b], ways[moving])
        lines[moving, b] = sign * np.hstack([ways[moving], np.einsum("pi,pij->pj", moment, axes[b])])
    return lines.reshape(-1, size)


def gap_gradients(engine: Engine, world: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Gradients of the gaps of active nodes, by the rigid coordinates (nodes, size), and their pressures [Pa]
    (nodes,).
    """
    m, scratch = engine.compiled.model, engine.scratch
    active = (engine.state.active.numpy()[world] != 0) & (scratch.area.numpy()[world] > 0.0)
    wrench, pressure = scratch.wrench.numpy()[world], engine.state.pressure.numpy()[world]
    families = m.pairs.family.numpy()
    lines, pressures = [np.zeros((0, size))], [np.zeros(0)]
    for pair in range(m.pairs.count):
        at = active[pair, : wrench.shape[1]]
        own = wrench[pair][at]
        if families[pair] == AT_POINTS:
            own = own + scratch.more_wrench.numpy()[world, pair][at]
        lines.append(_of_wrenches(engine, world, pair, own, size))
        pressures.append(pressure[pair, : wrench.shape[1]][at])
    return np.vstack(lines), np.concatenate(pressures)


def _of_wrenches(engine: Engine, world: int, pair: int, own: np.ndarray, size: int) -> np.ndarray:
    """Gradients, by the rigid coordinates (n, size), of the quantities conjugate to the wrenches `own` (n, 6) on the
    first body of a contact: force and torque about its centre of mass, world axes.
    """
    m, scratch = engine.compiled.model, engine.scratch
    axes, r = scratch.axes.numpy()[world], scratch.r1.numpy()[world]
    line = np.zeros((len(own), size))
    A, B = (int(m.surfaces.body.numpy()[s.numpy()[pair]]) for s in (m.pairs.first, m.pairs.second))
    force, moment = own[:, :3], own[:, 3:]
    line[:, 6 * A : 6 * A + 6] = np.hstack([force, moment @ axes[A]])
    if B >= 0:
        about_b = moment + np.cross(r[A] - r[B], force)
        line[:, 6 * B : 6 * B + 6] -= np.hstack([force, about_b @ axes[B]])
    return line
