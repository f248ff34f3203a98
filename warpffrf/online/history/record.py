"""Conversion of saved rows (`warpffrf.online.arrays.ring`) to a History in user frames.

Joint friction, from the saved rows.

Joint coordinates and the defects of omitted rows, from the recorded motion of the bodies.

A coordinate is a function of the markers' poses (`warpffrf.model.joints.base`), so it is evaluated from saved rows
instead of being integrated. Angles are in (-pi, pi]; revolutions are counted by prediction: the signal of a driven
coordinate, else the last value and the trapezoidal rule of its rate t.(omega_b - omega_a). The revolution closest to
the prediction is used, which is correct if its error is below half a revolution, also when saved steps are several
revolutions apart.

Histories of small-sliding contacts, from the saved rows of their cells.

Histories of lumped contacts, from the saved rows of their contact points.

Pretensions and time-dependent preloads of springs, from the saved rows.

User frame. Motion of the centre of mass -> motion of the user frame.

With c the centre of mass in the user frame, A the orientation and s = A c: the user origin is r - s, its velocity
v - w x s, its acceleration vdot - wdot x s - w x (w x s).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Port
from warpffrf.model.checks.redundancy import ConstraintRow, scene_length
from warpffrf.model.contact import Contact
from warpffrf.model.forces import SpringLaw
from warpffrf.model.forces.notes import characteristic_notes
from warpffrf.model.joints import Joint, Marker, Row
from warpffrf.model.joints.base import gradient, value
from warpffrf.model.pieces import Signal
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding.sliding import MatchedCells, cells_of
from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.compile.joint_friction import SlipTable
from warpffrf.online.compile.matched import matched_order
from warpffrf.online.compile.patches.plan import PatchPlan
from warpffrf.online.compile.pretension import TensionTable
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.history.films import film_histories
from warpffrf.online.history.history import (
    ENERGY_LINES,
    BodyHistory,
    CellHistory,
    ContactHistory,
    ForceHistory,
    FrictionHistory,
    History,
    JointFrictionHistory,
    JointHistory,
    LumpedHistory,
    SmallSlidingHistory,
)
from warpffrf.online.history.interface_motion import interface_motion, turned
from warpffrf.online.history.sensors import force_histories, sensor_histories
from warpffrf_kernels.core.declaration import declared_in
from warpffrf_kernels.core.model import LINE_OF_CENTRES
from warpffrf_kernels.core.ring import SavedContact
from warpffrf_kernels.matched import history


def history_from_rows(compiled: CompiledScene, rows: SavedRows) -> History:
    """The saved rows of one world as a History."""
    scene, time = compiled.scene, rows["saved_time"]
    T = len(time)
    energy = {name: rows["saved_energy"][:, i].copy() for i, name in enumerate(ENERGY_LINES)}
    bodies = {body.name: body_history(compiled, rows, i) for i, body in enumerate(scene.bodies)}
    joints = {str(joint.name): joint_history(compiled, rows, joint, bodies) for joint in scene.joints}
    stretches = {name: rows["saved_coordinate"][:, own] for name, own in compiled.forces.rows.items()}
    forces = force_histories(
        scene, compiled.forces, time, rows["saved_coordinate"], rows["saved_row_wrench"], bodies, compiled.inputs
    )
    forces = with_pulls(forces | friction_histories(compiled.slips, rows), tension_histories(compiled.tensions, rows))
    forces = {str(item.name): forces[str(item.name)] for item in scene.forces}
    contacts = {}
    for i, contact in enumerate(scene.finite_sliding):
        contacts[contact.name] = _contact(compiled, i, rows, bodies)
        if contact.friction.acts:
            contacts[contact.name].friction = _friction(compiled, i, rows)
    history = History(
        scene=scene, time=time, step_size=rows["saved_step"],
        bodies=bodies, joints=joints, contacts=contacts, forces=forces,
        lumped_contacts=lumped_histories(compiled, rows, bodies), films=film_histories(compiled, rows, bodies),
        small_sliding=small_sliding_histories(compiled, rows, bodies),
        energy=energy, iterations=rows["saved_iterations"].astype(int),
        factorisations=rows["saved_solves"].astype(int),
        notes=left_out_notes(scene, compiled.joints.dropped, bodies, T)
        + half_turn_notes(compiled.forces.laws, bodies, T)
        + characteristic_notes(compiled.forces.laws, stretches, time),
    )  # fmt: skip
    history.sensors = sensor_histories(history)
    return history


def body_history(compiled: CompiledScene, rows: SavedRows, i: int) -> BodyHistory:
    """The motion of body i."""
    body, first = compiled.scene.bodies[i], compiled.modal_start[i]
    modes = slice(first, first + body.mode_count)  # the global ones
    return user_frame(
        body.center_of_mass,
        *(rows[f"saved_{name}"][:, i] for name in ("r", "p", "v", "omega", "v_rate", "omega_rate")),
        *(rows[f"saved_{name}"][:, modes] for name in ("q", "qd", "qd_rate")),
    )


def joint_history(
    compiled: CompiledScene, rows: Mapping[str, np.ndarray], joint: Joint, bodies: Mapping[str, BodyHistory]
) -> JointHistory:
    """Reaction and coordinates of a joint."""
    first, second = joint_coordinates(compiled, rows, joint, bodies)
    wrench = reaction(compiled, rows, joint)
    return JointHistory(first, wrench[:, :3], wrench[:, 3:], second, tuple(joint.coordinates))


def joint_coordinates(
    compiled: CompiledScene,
    rows: Mapping[str, np.ndarray],
    joint: Joint,
    bodies: Mapping[str, BodyHistory],
    frames: tuple[Marker, Marker] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """First and second coordinate (T,) of a joint, NaN where it has none; `frames`: its own, if they are known."""
    time = rows["saved_time"]
    T, since = len(time), float(time[0]) if len(time) else 0.0
    drives = [] if compiled.scene.released.rows else compiled.scene.drives  # of a stage, which may hold elsewhere
    own = [d for d in drives if d.joint is joint]
    driven = {d.coordinate: compiled.inputs.resolved(d.position(), since) for d in own}
    found = coordinates(joint, driven, time, bodies, frames)
    first, second = [*found.values(), np.full(T, np.nan), np.full(T, np.nan)][:2]
    return first, second


def reaction(compiled: CompiledScene, rows: Mapping[str, np.ndarray], joint: Joint) -> np.ndarray:
    """Force and torque (T, 6) of a joint on its second body."""
    return rows["saved_row_wrench"][:, compiled.joints.rows[str(joint.name)]].sum(axis=1)


def _contact(compiled: CompiledScene, i: int, rows: SavedRows, bodies: dict[str, BodyHistory]) -> ContactHistory:
    m, contact = compiled.model, compiled.scene.finite_sliding[i]
    a, b = contact.a.surface, contact.b.surface
    x = {name: rows[name][:, i] for name in declared_in(SavedContact) if name != "saved_patch"}
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
    load = np.zeros((T, 0, 0))  # a rigid second surface has no grid, contact-fixed cells load none
    if plan is None and b.grid is not None:
        load = x["saved_second_load"][:, : m.window.second_columns * b.grid.rows]
        load = load.reshape(T, m.window.second_columns, b.grid.rows)
    # distance of the axes at mid-width, or the smallest gap with closest-point kinematics
    distance, family = x["saved_distance"], m.pairs.family.numpy()[i]
    approach = -distance if family != LINE_OF_CENTRES else a.shape.radius + b.shape.radius - distance
    return ContactHistory(
        force=force.copy(), torque=torque, force_second=force_second.copy(), torque_second=torque_second,
        first_column=x["saved_center"][:, 0] - m.window.half, center_column=x["saved_column"].copy(),
        pressure=pressure.copy(), first_column_second=x["saved_center"][:, 1] - m.window.second_half,
        load_second=load.copy(), approach=approach, active_nodes=x["saved_active"].astype(int),
        cells=None if plan is None else _cells(plan, rows["saved_patch"][:, i]),
    )  # fmt: skip


def _window(compiled: CompiledScene, i: int) -> tuple[int, int]:
    """Columns and rows of the window of contact i."""
    plan = compiled.patches.get(i)
    if plan is None:
        return compiled.model.window.columns, compiled.scene.finite_sliding[i].a.surface.grid.rows
    return plan.columns, len(plan.z)


def _cells(plan: PatchPlan, place: np.ndarray) -> CellHistory:
    """Position of the cells of a contact, from its `saved_patch` (T, 4 + rows)."""
    width = place[:, 2]
    scale = (width if plan.follows else np.ones(len(width)))[:, None]
    middle = (place[:, 1] if plan.follows else np.zeros(len(width)))[:, None]
    return CellHistory(
        column=place[:, 0].copy(),
        half_width=width.copy(),
        z=middle + scale * plan.z,
        length=scale * plan.length,
        column_second=place[:, 3].copy(),
        row_shift=place[:, 4 : 4 + len(plan.z)] - place[:, :1],
    )


def _friction(compiled: CompiledScene, i: int, rows: SavedRows) -> FrictionHistory:
    """Friction of contact i."""
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


ALONG, AROUND = 0, 1


def friction_histories(table: SlipTable, rows: SavedRows) -> dict[str, ForceHistory]:
    """Force and torque of the friction in every joint, and stick and slip."""
    found: dict[str, ForceHistory] = {}
    T = len(rows["saved_time"])
    for e, (name, law) in enumerate(table.laws.items()):
        own = table.rows[name]
        wrench = rows["saved_row_wrench"][:, own]
        velocity, traction = np.zeros((T, 2)), np.zeros((T, 2))
        for r, coordinate in enumerate(law.coordinates):
            direction = ALONG if coordinate.kind == "translation" else AROUND
            velocity[:, direction] = rows["saved_surface_velocity"][:, e, r]
            traction[:, direction] = rows["saved_surface_traction"][:, e, r]
        found[name] = ForceHistory(
            wrench[:, :, :3].sum(axis=1), wrench[:, :, 3:].sum(axis=1), rows["saved_coordinate"][:, own].copy(),
            JointFrictionHistory(
                state=(rows["saved_slipping"][:, e] + 1).astype(np.int8), slip_velocity=velocity, traction=traction,
                bound=rows["saved_slip_bound"][:, e].copy(), power=rows["saved_slip_power"][:, e].copy(),
            ),
        )  # fmt: skip
    return found


LEFT_OUT = 1e-6  # of the scene's length, or rad: a redundant row is satisfied to round-off; beyond, it was required
# of half a revolution: a bushing that rotates so far is no bushing; leaves a margin for unsaved states
NEAR_HALF_TURN = 0.75


def _matrices(q: np.ndarray) -> np.ndarray:
    """Rotation matrices (T, 3, 3) of unit quaternions (T, 4)."""
    v, w = q[:, :3], q[:, 3]
    V = np.zeros((len(q), 3, 3))
    V[:, 0, 1], V[:, 0, 2], V[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    V -= V.transpose(0, 2, 1)
    return np.eye(3) + 2.0 * w[:, None, None] * V + 2.0 * V @ V


def _turns(theta: np.ndarray) -> np.ndarray:
    """Rotation matrices (T, 3, 3) of rotation vectors (T, 3)."""
    angle = np.linalg.norm(theta, axis=1)
    s = 0.5 * np.sinc(0.5 * angle / np.pi)
    return _matrices(np.concatenate([s[:, None] * theta, np.cos(0.5 * angle)[:, None]], axis=1))


def marker_motion(
    port: Port, marker: Marker, bodies: Mapping[str, BodyHistory], count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (T, 3) [m], axes (T, 3, 3) of a marker, and the angular velocity (T, 3) of its body, world axes."""
    X = np.broadcast_to(marker.point, (count, 3))
    axes = np.broadcast_to(marker.axes, (count, 3, 3))
    if port.body.index < 0:
        return X, axes, np.zeros((count, 3))
    body = bodies[port.body.name]
    if port.interface_name is not None and body.modal.shape[1]:
        motion = interface_motion(port, body)[0]
        arm = marker.point - port.body.reduced.interfaces[port.interface_name].point
        X = X + motion[:, :3] + rot.cross(motion[:, 3:], arm)
        axes = _turns(motion[:, 3:]) @ axes
    A = _matrices(body.rotation)
    return body.position + np.einsum("tij,tj->ti", A, X), A @ axes, body.angular_velocity


def coordinates(
    joint: Joint, driven: Mapping[str, Signal], time: np.ndarray, bodies: Mapping[str, BodyHistory],
    frames: tuple[Marker, Marker] | None = None,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Coordinates (T,) [m or rad] of a joint by name; `driven`: the prescribed ones as signals."""
    (x_a, A_a, w_a), (x_b, A_b, w_b) = (
        marker_motion(p, m, bodies, len(time)) for p, m in zip(joint.ports, frames or joint.frames(), strict=True)
    )
    found = {}
    for name, row in joint.coordinates.items():
        c = value(row, x_a, A_a, x_b, A_b)
        if not row.is_length and len(time):
            _, t = gradient(row, x_a, A_a, x_b, A_b)
            c = _count_turns(c, np.einsum("ti,ti->t", t, w_b - w_a), time, driven.get(name))
        found[name] = c
    return found


def _count_turns(angle: np.ndarray, rate: np.ndarray, time: np.ndarray, driven: Signal | None) -> np.ndarray:
    if driven is not None:
        expected = driven(time)
        return expected + np.angle(np.exp(1j * (angle - expected)))
    travel = 0.5 * (rate[1:] + rate[:-1]) * np.diff(time)
    steps = np.diff(angle)
    steps += 2.0 * np.pi * np.round((travel - steps) / (2.0 * np.pi))
    return np.concatenate([angle[:1], angle[0] + np.cumsum(steps)])


def left_out_notes(scene: Scene, dropped: list[ConstraintRow], bodies: dict[str, BodyHistory], count: int) -> list[str]:
    """A note for every row omitted as redundant that did not stay satisfied at the `count` saved steps; in a run
    whose stages release joints, as satisfied as at the first of them."""
    notes = []
    length = scene_length(scene) if dropped else 1.0
    for item in dropped:
        (x_a, A_a, _), (x_b, A_b, _) = (
            marker_motion(p, m, bodies, count) for p, m in zip(item.joint.ports, item.markers, strict=True)
        )
        row: Row = item.row
        values = np.asarray(value(row, x_a, A_a, x_b, A_b))
        off = float(np.abs(values - (values[:1] if scene.released.rows else item.initial)).max(initial=0.0))
        if off > LEFT_OUT * (length if row.is_length else 1.0):
            notes.append(
                f"joint {item.label} was left out as redundant at the initial pose, but the motion broke it by "
                f"{off:.3g} {'m' if row.is_length else 'rad'}: the results are wrong there; start from another pose"
            )
    return notes


def half_turn_notes(laws: dict[str, SpringLaw], bodies: dict[str, BodyHistory], count: int) -> list[str]:
    """A note for every bushing that rotated by nearly half a revolution at the `count` saved steps, where its rotation
    vector jumps to the opposite sign."""
    notes = []
    for name, law in laws.items():
        if count == 0 or not any(c.kind == "bushing" and np.any(c.vector[3:]) for c in law.coordinates):
            continue
        A_a, A_b = (
            marker_motion(port, Marker(point, rot.quaternion(axes)), bodies, count)[1]
            for port, point, axes in zip(law.ports, law.points or (), law.axes or (), strict=True)
        )
        cosine = 0.5 * (np.einsum("tij,tij->t", A_a, A_b) - 1.0)
        angle = float(np.arccos(np.clip(cosine, -1.0, 1.0)).max())
        if angle > NEAR_HALF_TURN * np.pi:
            notes.append(
                f"bushing {name!r}: its ports rotated by {np.degrees(angle):.3g} degrees against each other; at half a "
                "turn its law jumps, the results beyond are wrong; use a joint with springs, or a Bearing for a shaft "
                "that spins"
            )
    return notes


def small_sliding_histories(
    compiled: CompiledScene, rows: SavedRows, bodies: dict[str, BodyHistory]
) -> dict[str, SmallSlidingHistory]:
    """By name, in the order of the scene."""
    matched = compiled.scene.small_sliding
    found, start = {}, 0
    for number in matched_order(matched):
        contact = matched[number]
        cells = cells_of(contact)
        count = len(cells.cell)
        found[contact.name] = _history(contact, cells, rows["saved_matched"][:, start : start + count], bodies)
        start += count
    return {contact.name: found[contact.name] for contact in matched}


def _history(
    contact: Contact, cells: MatchedCells, saved: np.ndarray, bodies: dict[str, BodyHistory]
) -> SmallSlidingHistory:
    """Of the numbers (T, c, `history.NUMBERS`) of its cells, whose forces and slips are those of the second face."""
    force = -np.einsum("tck,cki->tci", saved[:, :, :3], cells.frames)
    rotation = bodies[contact.a.body.name].rotation
    area = cells.area[None, :]
    slipped = slice(int(history.SLIPPED), int(history.SLIPPED) + 2)
    return SmallSlidingHistory(
        force=turned(rotation, force.sum(axis=1)), torque=turned(rotation, np.cross(cells.points, force).sum(axis=1)),
        normal_force=saved[:, :, 0].sum(axis=1), pressure=saved[:, :, 0] / area,
        traction=-saved[:, :, 1:3] / area[:, :, None], gap=saved[:, :, int(history.GAP)].copy(),
        slip=-saved[:, :, slipped], state=saved[:, :, int(history.STATE)].astype(np.int8),
        loss=saved[:, :, int(history.LOST)].copy(),
    )  # fmt: skip


def lumped_histories(
    compiled: CompiledScene, rows: SavedRows, bodies: dict[str, BodyHistory]
) -> dict[str, LumpedHistory]:
    """By name."""
    owner = compiled.elements.lumped.contact.numpy()[: compiled.elements.lumped.places]
    resisting = owner[compiled.elements.moments.place.numpy()[: compiled.elements.moments.count]]
    found = {}
    for i, contact in enumerate(compiled.scene.lumped_contacts):
        body = contact.a.body.name
        origin = bodies[body].position if body in bodies else np.zeros(3)  # of the ground the world's origin
        moment = rows["saved_lumped_moment"][:, np.flatnonzero(resisting == i)].sum(axis=1)
        found[contact.name] = _lumped_history(rows["saved_lumped"][:, np.flatnonzero(owner == i)], moment, origin)
    return found


def _lumped_history(saved: np.ndarray, moment: np.ndarray, origin: np.ndarray) -> LumpedHistory:
    """Of places (T, places, numbers) and the moment (T, 3) of all of them, torque about `origin`."""
    x, force, friction, slip = (saved[:, :, 3 * n : 3 * n + 3] for n in range(4))
    approach, normal = saved[:, :, 12], saved[:, :, 13]
    pressed = np.sum(normal, axis=1)
    nearest = np.eye(saved.shape[1])[np.argmax(approach, axis=1)]
    weight = np.where(pressed[:, None] > 0.0, normal / np.maximum(pressed[:, None], np.finfo(float).tiny), nearest)
    return LumpedHistory(
        force=force.sum(axis=1),
        torque=np.cross(x - np.asarray(origin)[..., None, :], force).sum(axis=1) + moment, moment=moment,
        place=np.einsum("tp,tpi->ti", weight, x), approach=approach.max(axis=1), normal_force=pressed,
        friction_force=friction.sum(axis=1), slip_velocity=np.einsum("tp,tpi->ti", weight, slip),
        lamina_force=normal.copy(),
    )  # fmt: skip


def with_pulls(forces: dict[str, ForceHistory], pulls: dict[str, ForceHistory]) -> dict[str, ForceHistory]:
    """`forces` with the `pulls`; that of a spring, by the same name, is part of its force."""
    found = dict(forces)
    for name, pull in pulls.items():
        own = forces.get(name)
        found[name] = (
            pull if own is None else replace(own, force=own.force + pull.force, torque=own.torque + pull.torque)
        )
    return found


def tension_histories(table: TensionTable, rows: SavedRows) -> dict[str, ForceHistory]:
    """Force on the second body, and the coordinate, of every pretension."""
    found: dict[str, ForceHistory] = {}
    for name, row in table.rows.items():
        wrench = rows["saved_row_wrench"][:, row]
        found[name] = ForceHistory(
            wrench[:, :3].copy(), wrench[:, 3:].copy(), rows["saved_coordinate"][:, row, None].copy()
        )
    return found


def user_frame(
    center: np.ndarray,
    r: np.ndarray,
    p: np.ndarray,
    v: np.ndarray,
    w: np.ndarray,
    vdot: np.ndarray,
    wdot: np.ndarray,
    q: np.ndarray,
    qd: np.ndarray,
    qdd: np.ndarray,
) -> BodyHistory:
    """Motion (T, ...) of the centre of mass, angular velocity and acceleration in body axes, as that of the user frame,
    in whose coordinates the centre of mass is at `center` (3,) [m]."""
    arm, omega, alpha = turned(p, center), turned(p, w), turned(p, wdot)
    swing = rot.cross(omega, arm)
    return BodyHistory(
        r - arm, p.copy(), v - swing, omega, q.copy(),
        vdot - rot.cross(alpha, arm) - rot.cross(omega, swing), alpha, qd.copy(), qdd.copy(),
    )  # fmt: skip
