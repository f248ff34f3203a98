"""Arrays of a run, the world axis first: `State` is what a step takes and leaves, `Work` what happens in between."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import warp as wp
from warpffrf_kernels import control as k
from warpffrf_kernels.contact_points import LINE
from warpffrf_kernels.contact_wrench import Held

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.online.compile import CompiledScene
from warpffrf.online.layer_arrays import layer_arrays, layer_points
from warpffrf.online.outer_pattern import scratch_sizes
from warpffrf.online.settings import LARGEST_INDEX

REAL, VEC3, MAT33, QUAT, INT = wp.float64, wp.vec3d, wp.mat33d, wp.quatd, wp.int32
RESIDUALS_KEPT = 32


@dataclass
class State:
    """Accepted state of every world, and what the next step needs to continue bit for bit."""

    r: wp.array  # (W, bodies) m, centre of mass
    p: wp.array  # (W, bodies) body axes -> world
    v: wp.array  # m/s
    v_rate: wp.array
    v_alg: wp.array  # algorithmic acceleration of generalized-alpha
    omega: wp.array  # rad/s, body axes
    omega_rate: wp.array
    omega_alg: wp.array
    q: wp.array  # (W, modes)
    qd: wp.array
    qd_rate: wp.array
    qd_alg: wp.array
    lam0: wp.array  # (W, rows)
    lam: wp.array
    active: wp.array  # (W, pairs, hats of the window) in the contact frame
    pressure: wp.array  # Pa
    patch_offset: wp.array  # (W, pairs) columns: line of centres less the centre column, where the active set was found
    traction: wp.array  # (W, pairs, 2 cells of the window) Pa, in the contact frame; columns of (2, rows)
    friction_offset: wp.array  # (W, pairs) as patch_offset, where the tractions were found
    elastic_before: wp.array  # (W, pairs, 2 cells) m, elastic slip at the end of the last step
    history_center: wp.array  # (W, pairs) grid column of its window's centre
    pressed_before: wp.array  # (W, pairs, cells of the window) 1 where the last step left a node under pressure
    history_phase: wp.array  # (W, pairs) columns: nearest place, or line of centres, at the end of the last step
    history_z: wp.array  # (W, pairs) m, z of that place on the first surface, of pairs whose gaps are taken at points
    most_advanced: wp.array  # (W, pairs) columns that the patch advanced at most in a step since the last saved row
    contact_normal: wp.array  # (W, pairs) unit vector of the normal force on the second body, zero without contact
    energy: wp.array  # (W, 2, lines): accepted, trial
    pair_force: wp.array  # (W, pairs, 2, 12): accepted, trial, by the pressures, see `impulsive_contact`
    pair_modal: wp.array  # (W, pairs, 2, modes of both bodies) the same on the modes
    memory: wp.array  # (W, pairs, 1, 12) what the algorithmic accelerations have of it
    modal_memory: wp.array  # (W, pairs, 1, modes of both bodies)
    friction_force: wp.array  # as pair_force and so on, of the tractions
    friction_modal: wp.array
    friction_memory: wp.array
    modal_friction_memory: wp.array
    pair_energy: wp.array  # (W, pairs, 2) J, contact energy
    elastic_energy: wp.array  # (W, pairs, 2) J, that of the tractions
    made: wp.array  # (W, pairs) J, what of `created` is beyond doubt, see `energy_watch`
    created: wp.array  # (W, pairs) J, energy that the pair has made so far, see `impulsive_means.judge_pairs`
    impulsive: wp.array  # (W, pairs) 1 where the attempt takes the pair as impulsive
    modal_load: wp.array  # (W, 2, modes)
    applied: wp.array  # (W, 2, forces)
    applied_at: wp.array
    load: wp.array  # (W, 2, 6 bodies) torques and body loads: force (world axes), torque (body axes)
    load_on_modes: wp.array  # (W, 2, modes)
    stretch: wp.array  # (W, rows) value of each row where it was accepted
    drive_rate: wp.array  # (W, 2, rows)
    layer_depth: wp.array  # (W, pairs, points) m, of damped layers, see `warpffrf_kernels.layer_energy`
    layer_drag: wp.array  # (W, pairs, points) Pa, what their pressure has above the elastic one
    layer_column: wp.array  # (W, pairs) centre column of these points
    ctl: wp.array  # (W, CTL) see warpffrf_kernels.control
    clk: wp.array  # (W, CLK)

    def to_numpy(self) -> dict[str, np.ndarray]:
        """Copies of all arrays by name."""
        return {f.name: getattr(self, f.name).numpy().copy() for f in fields(self)}

    def assign(self, values: dict[str, np.ndarray]) -> None:
        """Overwrite all arrays with the copies of `to_numpy`."""
        for f in fields(self):
            getattr(self, f.name).assign(values[f.name])


class Work:
    """Scratch arrays of a step, as attributes; shapes in the table below."""

    def __init__(self, compiled: CompiledScene, worlds: int, ring_rows: int) -> None:
        m, W = compiled.model, worlds
        P, rows, B, Q = m.pair_count, m.row_count, m.body_count, m.modal_count
        stations = (m.max_rows - 1) * m.z_points
        points = (m.window_columns + 1) * m.theta_points * max(stations, 1)
        N, S = m.outer_count, m.slot_capacity
        table = {
            "dx": (VEC3, B), "psi": (VEC3, B), "dq": (REAL, Q),
            "r1": (VEC3, B), "p1": (QUAT, B), "axes": (MAT33, B), "psi_inverse": (MAT33, B),
            "inertia_sums": (REAL, m.dense_count, 21), "extra_energy": (REAL, B), "row_pull": (REAL, 2 * rows, 6),
            "interface_motion": (REAL, *compiled.interface_modes.shape[:2]),
            "v1": (VEC3, B), "v1_rate": (VEC3, B), "omega1": (VEC3, B), "omega1_rate": (VEC3, B),
            "q1": (REAL, Q), "qd1": (REAL, Q), "qd1_rate": (REAL, Q),
            "residual": (REAL, 6 * B), "modal_residual": (REAL, Q), "receptance": (REAL, Q),
            "restless": (INT, P), "theta": (REAL, P), "bracket": (REAL, P, 9), "weight": (REAL, P), "wanted": (INT, P),
            "created_now": (REAL, P), "pair_loss": (REAL, P),
            "v_rate0": (VEC3, B if P else 0), "v_alg0": (VEC3, B if P else 0), "v_rest": (VEC3, B if P else 0),
            "omega_rate0": (VEC3, B if P else 0), "omega_alg0": (VEC3, B if P else 0),
            "omega_rest": (VEC3, B if P else 0), "qd_rate0": (REAL, Q if P else 0), "qd_alg0": (REAL, Q if P else 0),
            "qd_rest": (REAL, Q if P else 0),
            "contact_receptance": (REAL, Q if m.dynamic_count else 0),
            "exact": (REAL, Q if compiled.local.exact else 0, 9),
            "C": (REAL, rows, 6 * B), "C_modal": (REAL, rows, Q), "coordinate": (REAL, rows), "defect": (REAL, rows),
            "applied_torque": (VEC3, m.torque_count),
            "softness": (REAL, rows), "missed": (REAL, rows), "row_wrench": (REAL, rows, 6),
            "tangent": (REAL, N, N), "rhs": (REAL, N), "scaling": (REAL, N), "pivots": (INT, N),
            "elimination": (REAL, N, N),
            "residual_history": (REAL, RESIDUALS_KEPT), "gap_defect": (REAL, 2),
            "pair_wrench": (REAL, P, 6), "phase": (REAL, P, 12), "center": (INT, P, 3),
            "nearest": (REAL, P, 2), "touched": (INT, P, 2),
            "point_line": (REAL, P, (m.window_columns + 1) * m.most_points * LINE),
            "station": (REAL, P, stations, 11), "station_wrench": (REAL, P, stations, 6),
            "window": (INT, P, 2), "second_window": (INT, P, 2),
            "point_gap": (REAL, P, points), "point_place": (REAL, P, points, 2),
            "weak_gap": (REAL, P, m.mode_capacity), "shifted_gap": (REAL, P, m.mode_capacity),
            "area": (REAL, P, m.mode_capacity),
            "gap": (REAL, P, m.mode_capacity), "opened": (REAL, P, m.mode_capacity), "base": (REAL, P, m.mode_capacity),
            "active_before": (INT, P, m.mode_capacity), "pressure_before": (REAL, P, m.mode_capacity),
            "offset_before": (REAL, P),
            "wrench": (REAL, P, m.mode_capacity, 6), "held": (Held, P, m.most_points), "held_ball": (MAT33, P),
            "more_wrench": (REAL, P, m.mode_capacity if m.most_points else 0, 6),
            "proposed": (INT, P, m.mode_capacity),
            "stencil": (REAL, P, m.mode_capacity, m.stencil_columns * m.stencil_rows),
            "stencil_at": (INT, P, m.mode_capacity, 2),
            "first_field": (REAL, P, m.mode_capacity), "first_step": (REAL, P, m.mode_capacity),
            "slot_of": (INT, P, m.mode_capacity), "slot_mode": (INT, S, 2),
            "G": (REAL, S, S), "condensed": (REAL, S, S),
            "L": (REAL, S, m.coupled_capacity), "right": (REAL, S), "order": (INT, S),
            "factor": (REAL, S, S + 1), "solution": (REAL, S),
            "second_load": (REAL, P, m.node_capacity), "second_wrench": (REAL, P, 6),
            "hold": (REAL, 6 * B if P else 0, 6 * B), "hold_count": (INT,),
            "ring": (REAL, ring_rows, ring_width(m)),
        }  # fmt: skip
        table |= friction_table(m) | layer_arrays(m)
        for name, (dtype, *shape) in table.items():
            setattr(self, name, zeros(dtype, (W, *shape), compiled.device))
        flat = {  # read and written along contiguous runs, by index: one axis
            "z_free": N, "z": N, "change": N, "modal_step": Q, "inverse_transposed": N * N, "V": S * N,
            "J": S * m.pair_modes, "scaled_modes": m.pair_modes,
            "T": S * m.node_capacity, "second_field": P * m.node_capacity, "second_step": P * m.node_capacity,
            "C_receptance": rows * Q, "first_local": P * m.mode_capacity, "second_local": P * m.node_capacity,
            "shared_field": max(m.mode_capacity, m.node_capacity), **friction_runs(m),
            "modal_push": Q if m.dynamic_count else 0,
            "flexibility": 36 * m.group_count, "slope": compiled.interface_modes.size,
        }  # fmt: skip
        for name, size in flat.items():
            setattr(self, name, zeros(REAL, (W * max(size, 1),), compiled.device))
        self.running = zeros(INT, (1,), compiled.device)
        self.rubbing = zeros(INT, (1,), compiled.device)
        self.budget = zeros(INT, (1,), compiled.device)
        self.more = zeros(INT, (1,), compiled.device)
        self.coefficients = zeros(REAL, (W, 4), compiled.device)
        self.local_coefficients = zeros(REAL, (W, 4), compiled.device)
        self.accuracy = zeros(REAL, (W,), compiled.device)
        self.project = zeros(INT, (W,), compiled.device)
        self.slope.assign(np.tile(compiled.interface_modes.ravel(), W))

    def make_room(self, pattern: Any, worlds: int, device: str) -> None:
        """Arrays of the sparse outer solve (`warpffrf_kernels.sparse_outer`)."""
        for name, size in scratch_sizes(pattern).items():
            setattr(self, name, zeros(REAL, (worlds * max(size, 1),), device))
        self.fallback = zeros(INT, (worlds, 2), device)

    def __getattr__(self, name: str) -> Any:  # declared by the table
        raise AttributeError(name)


def friction_table(m: Any) -> dict[str, tuple]:
    """Scratch arrays of friction, see `warpffrf_kernels.friction_fields` and its neighbours; empty without friction."""
    P, F = m.pair_count, m.cell_capacity
    C = m.mode_capacity if F else 0
    shares = m.share_columns * m.share_rows
    return {
        "cell_area": (REAL, P, C), "cell_place": (REAL, P, C, 2), "cell_turn": (REAL, P, C, 4),
        "cell_wrench": (REAL, P, 2 * C, 6), "rigid_slip": (REAL, P, 2 * C), "slip": (REAL, P, 2 * C),
        "share": (REAL, P, C, shares), "share_at": (INT, P, C, 2), "bound": (REAL, P, C), "late": (REAL, P, C),
        "pressure_change": (REAL, P, C), "load_change": (REAL, P, m.node_capacity if F else 0),
        "second_force": (REAL, P, 2 * m.node_capacity if F else 0), "elastic": (REAL, P, 2 * C),
        "elastic_local": (REAL, P, 2 * C), "traction_base": (REAL, P, 2 * C), "traction_before": (REAL, P, 2 * C),
        "friction_offset_before": (REAL, P), "cell_phase": (REAL, P, 4), "cell_state": (INT, P, C),
        "friction_record": (REAL, P, 4), "advanced": (REAL, P),
        "friction_work": (REAL, P, 1), "normal_wrench": (REAL, P, 6),
        "cell_slot_of": (INT, P, C), "cell_slot": (INT, F, 2), "cell_G": (REAL, 2 * F, 2 * F),
        "cell_K": (REAL, 2 * F, 2 * F), "cell_L": (REAL, 2 * F, m.coupled_capacity), "cell_base": (REAL, 2 * F),
        "cell_right": (REAL, 2 * F), "cell_radius": (REAL, F), "cell_softness": (REAL, F), "cell_tau": (REAL, 2 * F),
        "cell_slip": (REAL, 2 * F), "cell_frozen": (REAL, 2 * F), "cell_jump": (REAL, 2 * F),
        "cell_direction": (REAL, 2 * F), "cell_curvature": (REAL, F), "cell_order": (INT, 2 * F),
        "cell_sliding": (INT, 2 * F), "cell_outcome": (REAL, 2), "cell_work": (REAL, 2 * F, 2 * F),
        "cell_solution": (REAL, 2 * F), "cell_Y": (REAL, m.slot_capacity if F else 0, 2 * F),
        "answer_hat": (INT, m.slot_capacity if F else 0), "answer_step": (REAL, m.slot_capacity if F else 0),
        "answer_state": (INT, 4), "answer_change": (REAL, 1),
    }  # fmt: skip


def friction_runs(m: Any) -> dict[str, int]:
    """Scratch arrays of friction that are read and written along contiguous runs."""
    P, F, Q = m.pair_count, m.cell_capacity, m.modal_count
    C = m.mode_capacity if F else 0
    return {
        "first_shift": 2 * P * C, "second_shift": 2 * P * m.node_capacity if F else 0,
        "first_push": P * C, "second_push": P * m.node_capacity if F else 0,
        "second_modal": 2 * P * m.node_capacity if F else 0,
        "cell_shift": 4 * m.node_capacity if F else 0, "cell_J": 2 * F * m.pair_modes,
        "cell_scaled": 2 * m.pair_modes, "cell_V": 2 * F * m.outer_count, "modal_drive": Q, "cell_push": Q,
    }  # fmt: skip


def friction_width(m: Any) -> int:
    """Numbers a pair adds to a record in scenes with friction, see `warpffrf_kernels.friction_keep`."""
    return 5 * m.mode_capacity + 5 if m.cell_capacity else 0


def ring_width(m: Any) -> int:
    """Numbers in one record, see `warpffrf_kernels.record.record`."""
    pair = 16 + m.mode_capacity + 1 + m.node_capacity + friction_width(m)
    return 4 + k.LINES + 19 * m.body_count + 3 * m.modal_count + 7 * m.row_count + pair * m.pair_count


def zeros(dtype: Any, shape: tuple[int, ...], device: str) -> wp.array:
    """Zero array; an axis without entries gets one that nobody uses, so that kernels can be given it.

    Raises InputError for more entries than the indices of kernels reach.
    """
    size = int(np.prod([max(n, 1) for n in shape], dtype=np.int64))
    if size > LARGEST_INDEX:
        raise InputError(
            f"scene: an array of {size} numbers is needed, at most {LARGEST_INDEX} can be indexed; run fewer worlds "
            "at a time, or lower the capacity of the contacts"
        )
    return wp.zeros(tuple(max(n, 1) for n in shape), dtype=dtype, device=device)


def initial_state(compiled: CompiledScene, worlds: int) -> State:
    """State at the scene's initial pose and velocities, in `worlds` copies; accelerations and multipliers zero."""
    m, W, scene = compiled.model, worlds, compiled.scene
    P, rows, B, Q, F = m.pair_count, m.row_count, m.body_count, m.modal_count, m.force_count
    cells = 2 * m.mode_capacity if m.cell_capacity else 0
    rubbing, modes = P if m.cell_capacity else 0, m.pair_modes
    table = {
        "r": (VEC3, B), "p": (QUAT, B), "v": (VEC3, B), "v_rate": (VEC3, B), "v_alg": (VEC3, B),
        "omega": (VEC3, B), "omega_rate": (VEC3, B), "omega_alg": (VEC3, B),
        "q": (REAL, Q), "qd": (REAL, Q), "qd_rate": (REAL, Q), "qd_alg": (REAL, Q),
        "lam0": (REAL, rows), "lam": (REAL, rows),
        "active": (INT, P, m.mode_capacity), "pressure": (REAL, P, m.mode_capacity), "patch_offset": (REAL, P),
        "traction": (REAL, P, cells), "friction_offset": (REAL, P), "elastic_before": (REAL, P, cells),
        "history_center": (INT, P), "history_phase": (REAL, P), "history_z": (REAL, P), "most_advanced": (REAL, P),
        "pressed_before": (INT, P, cells // 2), "contact_normal": (VEC3, P), "energy": (REAL, 2, k.LINES),
        "pair_force": (REAL, P, 2, 12), "pair_modal": (REAL, P, 2, modes), "memory": (REAL, P, 1, 12),
        "modal_memory": (REAL, P, 1, modes), "friction_force": (REAL, rubbing, 2, 12),
        "friction_modal": (REAL, rubbing, 2, modes), "friction_memory": (REAL, rubbing, 1, 12),
        "modal_friction_memory": (REAL, rubbing, 1, modes), "pair_energy": (REAL, P, 2),
        "elastic_energy": (REAL, P, 2), "created": (REAL, P),
        "made": (REAL, P), "impulsive": (INT, P), "modal_load": (REAL, 2, Q),
        "applied": (VEC3, 2, F), "applied_at": (VEC3, 2, F),
        "load": (REAL, 2, 6 * B), "load_on_modes": (REAL, 2, Q), "stretch": (REAL, rows),
        "drive_rate": (REAL, 2, rows), "ctl": (INT, k.CTL), "clk": (REAL, k.CLK),
        "layer_depth": (REAL, P, layer_points(m)), "layer_drag": (REAL, P, layer_points(m)), "layer_column": (INT, P),
    }  # fmt: skip
    state = State(**{name: zeros(dtype, (W, *shape), compiled.device) for name, (dtype, *shape) in table.items()})
    r, p, v, omega = np.zeros((B, 3)), np.zeros((B, 4)), np.zeros((B, 3)), np.zeros((B, 3))
    for i, body in enumerate(scene.bodies):
        A = rot.matrix(body.rotation)
        arm = A @ body.center_of_mass
        r[i] = body.position + arm
        p[i] = body.rotation
        v[i] = body.velocity + np.cross(body.angular_velocity, arm)
        omega[i] = A.T @ body.angular_velocity
    for name, value in (("r", r), ("p", p), ("v", v), ("omega", omega)):
        getattr(state, name).assign(np.broadcast_to(value, (W, *value.shape)).copy())
    return state
