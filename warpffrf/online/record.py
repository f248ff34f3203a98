"""From ring rows (layout of `warpffrf_kernels.commit.record`) to a History in user frames."""

from __future__ import annotations

import numpy as np
from warpffrf_kernels import control as k

from warpffrf.online.compile import CompiledScene
from warpffrf.online.history import ENERGY_LINES, BodyHistory, ContactHistory, History, JointHistory
from warpffrf.online.state import ring_width


def rotate(p: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Vectors x (3,) or (T, 3) turned by unit quaternions p (T, 4)."""
    v, w = p[:, :3], p[:, 3:]
    x = np.broadcast_to(x, v.shape)
    t = 2.0 * np.cross(v, x)
    return x + w * t + np.cross(v, t)


def history_from_rows(compiled: CompiledScene, chunks: list[np.ndarray]) -> History:
    """Unpack the saved rows of one world."""
    m, scene = compiled.model, compiled.scene
    rows = np.concatenate(chunks) if chunks else np.zeros((0, ring_width(m)))
    T = len(rows)
    at = 4
    energy = {name: rows[:, at + i].copy() for i, name in enumerate(ENERGY_LINES)}
    at += k.LINES
    bodies: dict[str, BodyHistory] = {}
    modal = at + 13 * m.body_count
    for i, body in enumerate(scene.bodies):
        x = rows[:, at : at + 13]
        at += 13
        p = x[:, 3:7].copy()
        arm = rotate(p, body.center_of_mass)
        omega = rotate(p, x[:, 10:13])
        q = rows[:, modal + compiled.modal_start[i] : modal + compiled.modal_start[i + 1]].copy()
        bodies[body.name] = BodyHistory(x[:, :3] - arm, p, x[:, 7:10] - np.cross(omega, arm), omega, q)
    at += m.modal_count
    row_data = rows[:, at : at + 7 * m.row_count].reshape(T, m.row_count, 7)
    at += 7 * m.row_count
    joints = {}
    for name, indices in compiled.joint_rows.items():
        coordinate = np.full(T, np.nan)
        if name in compiled.coordinate_rows:
            coordinate = row_data[:, compiled.coordinate_rows[name], 0].copy()
        wrench = row_data[:, indices, 1:].sum(axis=1)
        joints[name] = JointHistory(coordinate, wrench[:, :3], wrench[:, 3:])
    contacts = {}
    for i, contact in enumerate(scene.contacts):
        contacts[contact.name] = _contact(compiled, i, rows[:, at:], bodies)
        at += 17 + m.mode_capacity + m.node_capacity
    return History(
        scene=scene, time=rows[:, 0].copy(), step_size=rows[:, 1].copy(),
        bodies=bodies, joints=joints, contacts=contacts,
        energy=energy, iterations=rows[:, 2].astype(int), factorisations=rows[:, 3].astype(int),
    )  # fmt: skip


def _contact(compiled: CompiledScene, i: int, x: np.ndarray, bodies: dict[str, BodyHistory]) -> ContactHistory:
    m, contact = compiled.model, compiled.scene.contacts[i]
    a, b = contact.a.surface, contact.b.surface
    T = len(x)
    first, second = contact.a.body, contact.b.body
    r_a = bodies[first.name].position + rotate(bodies[first.name].rotation, first.center_of_mass)
    force, about_r_a = x[:, 4:7].copy(), x[:, 7:10]
    force_second, second_about_r_a = x[:, 10:13].copy(), x[:, 13:16]
    torque = about_r_a + np.cross(r_a - bodies[first.name].position, force)
    torque_second = second_about_r_a + np.cross(r_a - bodies[second.name].position, force_second)
    hats = x[:, 16 : 16 + m.mode_capacity]
    pressure = hats[:, : m.window_columns * a.grid.rows].reshape(T, m.window_columns, a.grid.rows).copy()
    after = 16 + m.mode_capacity
    load = x[:, after + 1 : after + 1 + m.second_columns * b.grid.rows].reshape(T, m.second_columns, b.grid.rows).copy()
    return ContactHistory(
        force=force, torque=torque, force_second=force_second, torque_second=torque_second,
        first_column=x[:, 0].astype(int) - m.half_window, center_column=x[:, 2].copy(), pressure=pressure,
        first_column_second=x[:, 1].astype(int) - m.second_half_window, load_second=load,
        approach=a.shape.radius + b.shape.radius - x[:, 3], active_modes=x[:, after].astype(int),
    )  # fmt: skip
