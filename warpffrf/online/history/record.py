"""From the rows that a run has saved (`warpffrf.online.arrays.ring`) to a History in user frames."""

from __future__ import annotations

import numpy as np

from warpffrf.model.forces.notes import characteristic_notes
from warpffrf.online.arrays.ring import SavedContact, SavedRows
from warpffrf.online.compile.patches.plan import PatchPlan
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.history.films import film_histories
from warpffrf.online.history.history import (
    ENERGY_LINES,
    BodyHistory,
    CellHistory,
    ContactHistory,
    FrictionHistory,
    History,
    JointHistory,
)
from warpffrf.online.history.interface_motion import turned
from warpffrf.online.history.joint_friction import friction_histories
from warpffrf.online.history.joint_motion import coordinates, half_turn_notes, left_out_notes
from warpffrf.online.history.laps import lap_histories
from warpffrf.online.history.lumped import lumped_histories
from warpffrf.online.history.pretension import tension_histories, with_pulls
from warpffrf.online.history.sensors import force_histories, sensor_histories
from warpffrf.online.history.user_frame import user_frame
from warpffrf_kernels.core.model import LINE_OF_CENTRES


def history_from_rows(compiled: CompiledScene, rows: SavedRows) -> History:
    """The saved rows of one world as a History."""
    scene, time = compiled.scene, rows["saved_time"]
    T = len(time)
    energy = {name: rows["saved_energy"][:, i].copy() for i, name in enumerate(ENERGY_LINES)}
    bodies: dict[str, BodyHistory] = {}
    for i, body in enumerate(scene.bodies):
        first = compiled.modal_start[i]
        modes = slice(first, first + body.mode_count)  # the global ones
        bodies[body.name] = user_frame(
            body.center_of_mass,
            *(rows[f"saved_{name}"][:, i] for name in ("r", "p", "v", "omega", "v_rate", "omega_rate")),
            *(rows[f"saved_{name}"][:, modes] for name in ("q", "qd", "qd_rate")),
        )
    joints = {}
    for joint in scene.joints:
        drives = {d.coordinate: d for d in scene.drives if d.joint is joint}
        found = coordinates(joint, drives, time, bodies)
        first, second = [*found.values(), np.full(T, np.nan), np.full(T, np.nan)][:2]
        wrench = rows["saved_row_wrench"][:, compiled.joints.rows[str(joint.name)]].sum(axis=1)
        joints[str(joint.name)] = JointHistory(first, wrench[:, :3], wrench[:, 3:], second, tuple(found))
    stretches = {name: rows["saved_coordinate"][:, own] for name, own in compiled.forces.rows.items()}
    forces = force_histories(scene, compiled.forces, time, rows["saved_coordinate"], rows["saved_row_wrench"], bodies)
    forces = with_pulls(forces | friction_histories(compiled.slips, rows), tension_histories(compiled.tensions, rows))
    forces = {str(item.name): forces[str(item.name)] for item in scene.forces}
    contacts = {}
    for i, contact in enumerate(scene.contacts):
        contacts[contact.name] = _contact(compiled, i, rows, bodies)
        if contact.friction.acts:
            contacts[contact.name].friction = _friction(compiled, i, rows)
    history = History(
        scene=scene, time=time, step_size=rows["saved_step"],
        bodies=bodies, joints=joints, contacts=contacts, forces=forces,
        lumped_contacts=lumped_histories(compiled, rows, bodies), films=film_histories(compiled, rows, bodies),
        laps=lap_histories(compiled, rows, bodies),
        energy=energy, iterations=rows["saved_iterations"].astype(int),
        factorisations=rows["saved_solves"].astype(int),
        notes=left_out_notes(scene, compiled.joints.dropped, bodies, T)
        + half_turn_notes(compiled.forces.laws, bodies, T)
        + characteristic_notes(compiled.forces.laws, stretches, time),
    )  # fmt: skip
    history.sensors = sensor_histories(history)
    return history


def _contact(compiled: CompiledScene, i: int, rows: SavedRows, bodies: dict[str, BodyHistory]) -> ContactHistory:
    m, contact = compiled.model, compiled.scene.contacts[i]
    a, b = contact.a.surface, contact.b.surface
    x = {name: rows[name][:, i] for name in SavedContact.declarations if name != "saved_patch"}
    T = len(x["saved_active"])
    first, second = contact.a.body, contact.b.body
    r_a = bodies[first.name].position + turned(bodies[first.name].rotation, first.center_of_mass)
    force, about_r_a = x["saved_pair_wrench"][:, :3], x["saved_pair_wrench"][:, 3:]
    force_second, second_about_r_a = x["saved_second_wrench"][:, :3], x["saved_second_wrench"][:, 3:]
    torque = about_r_a + np.cross(r_a - bodies[first.name].position, force)
    about = bodies[second.name].position if second.name in bodies else np.zeros(3)  # of the ground the world's origin
    torque_second = second_about_r_a + np.cross(r_a - about, force_second)
    plan = compiled.patches.get(i)
    columns, lines = _window(compiled, i)
    pressure = x["saved_pressure"][:, : columns * lines].reshape(T, columns, lines)
    load = np.zeros((T, 0, 0))  # a rigid second surface has no grid, and cells that travel load none
    if plan is None and b.grid is not None:
        load = x["saved_second_load"][:, : m.window.second_columns * b.grid.rows]
        load = load.reshape(T, m.window.second_columns, b.grid.rows)
    # distance of the axes at mid-width, or the smallest gap of a pair whose gaps are taken at points
    distance, family = x["saved_distance"], m.pairs.family.numpy()[i]
    approach = -distance if family != LINE_OF_CENTRES else a.shape.radius + b.shape.radius - distance
    return ContactHistory(
        force=force.copy(), torque=torque, force_second=force_second.copy(), torque_second=torque_second,
        first_column=x["saved_center"][:, 0] - m.window.half, center_column=x["saved_column"].copy(),
        pressure=pressure.copy(), first_column_second=x["saved_center"][:, 1] - m.window.second_half,
        load_second=load.copy(), approach=approach, active_hats=x["saved_active"].astype(int),
        cells=None if plan is None else _cells(plan, rows["saved_patch"][:, i]),
    )  # fmt: skip


def _window(compiled: CompiledScene, i: int) -> tuple[int, int]:
    """Columns and rows of the window of pair i."""
    plan = compiled.patches.get(i)
    if plan is None:
        return compiled.model.window.columns, compiled.scene.contacts[i].a.surface.grid.rows
    return plan.columns, len(plan.z)


def _cells(plan: PatchPlan, place: np.ndarray) -> CellHistory:
    """Where the cells of a pair were, of its `saved_patch` (T, 4)."""
    width = place[:, 2]
    scale = (width if plan.follows else np.ones(len(width)))[:, None]
    middle = (place[:, 1] if plan.follows else np.zeros(len(width)))[:, None]
    return CellHistory(
        column=place[:, 0].copy(),
        half_width=width.copy(),
        z=middle + scale * plan.z,
        length=scale * plan.length,
        column_second=place[:, 3].copy(),
    )


def _friction(compiled: CompiledScene, i: int, rows: SavedRows) -> FrictionHistory:
    """Friction of pair i."""
    columns, lines = _window(compiled, i)
    T, cells = len(rows["saved_time"]), columns * lines

    def field(name: str) -> np.ndarray:
        values = rows[name][:, i, : 2 * cells].reshape(T, columns, lines, 2)
        return np.moveaxis(values, 3, 1).copy()

    state = rows["saved_cell_state"][:, i, :cells].reshape(T, columns, lines)
    numbers = rows["saved_friction"][:, i]
    return FrictionHistory(
        traction=field("saved_traction"), slip_velocity=field("saved_slip_velocity"), state=state.astype(np.int8),
        power=numbers[:, 0].copy(), creep_velocity=numbers[:, 1:3].copy(), rolling_velocity=numbers[:, 3].copy(),
        cells_per_step=rows["saved_advanced"][:, i].copy(),
    )  # fmt: skip
