"""From ring rows (layout of `warpffrf_kernels.step.record.record`) to a History in user frames."""

from __future__ import annotations

import numpy as np
from warpffrf_kernels.core import control as k

from warpffrf.online.arrays.axes import friction_width, ring_width
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.history.history import (
    ENERGY_LINES,
    BodyHistory,
    ContactHistory,
    FrictionHistory,
    History,
    JointHistory,
)
from warpffrf.online.history.joint_motion import coordinates, half_turn_notes, left_out_notes
from warpffrf.online.history.sensors import force_histories, sensor_histories, turned
from warpffrf.online.history.user_frame import user_frame


def history_from_rows(compiled: CompiledScene, chunks: list[np.ndarray]) -> History:
    """Unpack the saved rows of one world."""
    m, scene = compiled.model, compiled.scene
    rows = np.concatenate(chunks) if chunks else np.zeros((0, ring_width(m)))
    T = len(rows)
    at = 4
    energy = {name: rows[:, at + i].copy() for i, name in enumerate(ENERGY_LINES)}
    at += k.LINES
    bodies: dict[str, BodyHistory] = {}
    modal = at + 19 * m.bodies.count
    for i, body in enumerate(scene.bodies):
        x = rows[:, at : at + 19]
        at += 19
        q, qd, qdd = (
            rows[:, at_modes + compiled.modal_start[i] :][:, : body.mode_count]  # the global ones
            for at_modes in modal + m.modes.count * np.arange(3)
        )
        r, p, v, w, vdot, wdot = np.split(x, np.cumsum([3, 4, 3, 3, 3]), axis=1)
        bodies[body.name] = user_frame(body.center_of_mass, r, p, v, w, vdot, wdot, q, qd, qdd)
    at += 3 * m.modes.count
    row_data = rows[:, at : at + 7 * m.rows.count].reshape(T, m.rows.count, 7)
    at += 7 * m.rows.count
    joints = {}
    for joint in scene.joints:
        drives = {d.coordinate: d for d in scene.drives if d.joint is joint}
        found = coordinates(joint, drives, rows[:, 0], bodies)
        first, second = [*found.values(), np.full(T, np.nan), np.full(T, np.nan)][:2]
        wrench = row_data[:, compiled.joints.rows[joint.name], 1:].sum(axis=1)
        joints[joint.name] = JointHistory(first, wrench[:, :3], wrench[:, 3:], second, tuple(found))
    forces = force_histories(compiled, rows[:, 0], row_data, bodies)
    contacts = {}
    for i, contact in enumerate(scene.contacts):
        contacts[contact.name] = _contact(compiled, i, rows[:, at:], bodies)
        if contact.friction.coefficient > 0.0:
            contacts[contact.name].friction = _friction(compiled, i, rows)
        at += 17 + m.window.hats + m.window.nodes
    return History(
        scene=scene, time=rows[:, 0].copy(), step_size=rows[:, 1].copy(),
        bodies=bodies, joints=joints, contacts=contacts, forces=forces,
        sensors=sensor_histories(scene, T, bodies, joints, forces),
        energy=energy, iterations=rows[:, 2].astype(int), factorisations=rows[:, 3].astype(int),
        notes=left_out_notes(scene, compiled.joints.dropped, bodies, T)
        + half_turn_notes(compiled.forces.laws, bodies, T),
    )  # fmt: skip


def _contact(compiled: CompiledScene, i: int, x: np.ndarray, bodies: dict[str, BodyHistory]) -> ContactHistory:
    m, contact = compiled.model, compiled.scene.contacts[i]
    a, b = contact.a.surface, contact.b.surface
    T = len(x)
    first, second = contact.a.body, contact.b.body
    r_a = bodies[first.name].position + turned(bodies[first.name].rotation, first.center_of_mass)
    force, about_r_a = x[:, 4:7].copy(), x[:, 7:10]
    force_second, second_about_r_a = x[:, 10:13].copy(), x[:, 13:16]
    torque = about_r_a + np.cross(r_a - bodies[first.name].position, force)
    about = bodies[second.name].position if second.name in bodies else np.zeros(3)  # of the ground the world's origin
    torque_second = second_about_r_a + np.cross(r_a - about, force_second)
    hats = x[:, 16 : 16 + m.window.hats]
    pressure = hats[:, : m.window.columns * a.grid.rows].reshape(T, m.window.columns, a.grid.rows).copy()
    after = 16 + m.window.hats
    load = np.zeros((T, 0, 0))  # a rigid second surface has no grid
    if b.grid is not None:
        load = x[:, after + 1 : after + 1 + m.window.second_columns * b.grid.rows]
        load = load.reshape(T, m.window.second_columns, b.grid.rows).copy()
    # distance of the axes at mid-width, or the smallest gap of a pair whose gaps are taken at points
    family = m.pairs.family.numpy()[i]
    approach = -x[:, 3] if family == 1 else a.shape.radius + b.shape.radius - x[:, 3]
    return ContactHistory(
        force=force, torque=torque, force_second=force_second, torque_second=torque_second,
        first_column=x[:, 0].astype(int) - m.window.half, center_column=x[:, 2].copy(), pressure=pressure,
        first_column_second=x[:, 1].astype(int) - m.window.second_half, load_second=load,
        approach=approach, active_modes=x[:, after].astype(int),
    )  # fmt: skip


def _friction(compiled: CompiledScene, i: int, rows: np.ndarray) -> FrictionHistory:
    """Friction of pair i, from the end of the rows."""
    m, grid = compiled.model, compiled.scene.contacts[i].a.surface.grid
    T, width, C = len(rows), friction_width(m), m.window.hats
    x = rows[:, rows.shape[1] - (m.pairs.count - i) * width :][:, :width]
    cells = m.window.columns * grid.rows

    def field(first: int, count: int) -> np.ndarray:
        values = x[:, first * C : (first + count) * C].reshape(T, count, C)[:, :, :cells]
        return values.reshape(T, count, m.window.columns, grid.rows).copy()

    last = x[:, 5 * C :]
    return FrictionHistory(
        traction=field(0, 2), slip_velocity=field(2, 2), state=field(4, 1)[:, 0].astype(np.int8),
        power=last[:, 0].copy(), creep_velocity=last[:, 1:3].copy(), rolling_velocity=last[:, 3].copy(),
        cells_per_step=last[:, 4].copy(),
    )  # fmt: skip
