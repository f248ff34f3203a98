"""What happens between two states: arrays that a step makes anew. Those that are `carried` keep what an attempt before,
or the set-up of the run, has left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from warpffrf.online.arrays.axes import Sizes
from warpffrf.online.arrays.declaration import Arrays
from warpffrf.online.arrays.lap_scratch import Laps
from warpffrf.online.arrays.state import State
from warpffrf.online.compile.scene import CompiledScene
from warpffrf_kernels.core.declaration import DeviceArray, integers, matrices, quaternions, reals, structs, vectors
from warpffrf_kernels.films.sampling import HAT_LINE, PULL
from warpffrf_kernels.films.sampling import LINE as FILM_LINE
from warpffrf_kernels.kinematics.contact_wrench import Held
from warpffrf_kernels.lumped.forces import Load
from warpffrf_kernels.lumped.moments import Moment
from warpffrf_kernels.patch.cells import Row

FORCE, MODAL = "N, N m", "N/kg^1/2"


class RunWords(Arrays):
    """What holds for a whole run, and the conditions of the loops of the graph."""

    coefficients: DeviceArray = reals("world", 4, note="of the integrator", carried=True)
    local_coefficients: DeviceArray = reals("world", 4, note="of local modes", carried=True)
    step_error: DeviceArray = reals("world", note="allowed local error", carried=True)
    project: DeviceArray = integers("world", note="1: velocities are projected", carried=True)
    running: DeviceArray = integers("one", note="1 while the iteration of a world goes on")
    rubbing: DeviceArray = integers("one", note="1 while pressures and tractions go on answering each other")
    budget: DeviceArray = integers("world", note="attempts left", carried=True)
    more: DeviceArray = integers("one", note="1 while attempts are to be made", carried=True)


class Motion(Arrays):
    """Increments and trial state of bodies and modes."""

    dx: DeviceArray = vectors("world", "body", unit="m", note="a repeated attempt starts from it", carried=True)
    psi: DeviceArray = vectors("world", "body", unit="rad", note="likewise", carried=True)
    dq: DeviceArray = reals("world", "mode", unit="m kg^1/2", note="likewise", carried=True)
    centre_dx: DeviceArray = vectors("world", "body", unit="m", note="what a load step has come to, see `proximal`")
    centre_psi: DeviceArray = vectors("world", "body", unit="rad", note="likewise")
    centre_dq: DeviceArray = reals("world", "mode", unit="m kg^1/2", note="likewise")
    r1: DeviceArray = vectors("world", "body", unit="m")
    p1: DeviceArray = quaternions("world", "body")
    axes: DeviceArray = matrices("world", "body", note="of p1")
    psi_inverse: DeviceArray = matrices("world", "body", note="psi' -> rotation vector's rate")
    v1: DeviceArray = vectors("world", "body", unit="m/s")
    v1_rate: DeviceArray = vectors("world", "body", unit="m/s2")
    omega1: DeviceArray = vectors("world", "body", unit="rad/s")
    omega1_rate: DeviceArray = vectors("world", "body", unit="rad/s2")
    q1: DeviceArray = reals("world", "mode", unit="m kg^1/2")
    qd1: DeviceArray = reals("world", "mode", unit="m kg^1/2/s")
    qd1_rate: DeviceArray = reals("world", "mode", unit="m kg^1/2/s2")
    exact: DeviceArray = reals("world", "exact_mode", 9, note="step, exact coefficients for it", carried=True)
    inertia_sums: DeviceArray = reals("world", "dense", 21, note="of modes and rates, see `inertia`")
    extra_energy: DeviceArray = reals("world", "body", unit="J", note="kinetic, of inertia terms", zero_without=True)
    membrane_slope: DeviceArray = reals("world", "square_line", note="L_r q, see `membrane`")
    membrane_amplitude: DeviceArray = reals("world", "square", unit="J^1/2", note="q.L_r q/2", zero_without=True)
    membrane_slope0: DeviceArray = reals("world", "square_line", note="L_r q where the attempt begins", carried=True)
    membrane_amplitude0: DeviceArray = reals("world", "square", unit="J^1/2", note="there", carried=True)
    interface_motion: DeviceArray = reals("world", "interface", 6, unit="m, rad")
    slope: DeviceArray = reals(
        "world",
        "interface_shape",
        note="modes of interfaces, as loads shorten them",
        run=True,
        carried=True,
    )
    slope0: DeviceArray = reals("world", "stiffened_shape", note="where the attempt begins", run=True, carried=True)
    pull_change: DeviceArray = reals("world", "stiffened_interface", 6, unit=FORCE, note="of rows, in the attempt")
    lag1: DeviceArray = reals("world", 2, "mean_mode", unit=MODAL, note="`lag` at the end of the attempt")


class Residuals(Arrays):
    """Unbalanced forces and rows of joints, drives and springs."""

    residual: DeviceArray = reals("world", "6*body", unit=FORCE)
    modal_residual: DeviceArray = reals("world", "mode", unit=MODAL)
    receptance: DeviceArray = reals("world", "mode", unit="s2", note="d(dq)/d(modal load)")
    # places of bodies that a row does not touch stay zero
    C: DeviceArray = reals("world", "row", "6*body", note="d(row)/d(dx, psi)", carried=True)
    C_modal: DeviceArray = reals("world", "row", "mode", note="d(row)/d(dq)", carried=True)
    coordinate: DeviceArray = reals("world", "row", unit="m or rad")
    defect: DeviceArray = reals("world", "row", unit="m or rad")
    softness: DeviceArray = reals("world", "row", unit="m/N or rad/(N m)")
    missed: DeviceArray = reals("world", "row", unit="m/s or rad/s", note="rate that a projection takes off")
    row_wrench: DeviceArray = reals("world", "row", 6, unit=FORCE)
    row_pull: DeviceArray = reals("world", "2*row", 6, unit=FORCE, note="on each interface, body axes")
    flexibility: DeviceArray = reals("world", 36, "group", note="of coupled springs", run=True)
    applied_torque: DeviceArray = vectors("world", "torque", unit="N m")
    slip_branch: DeviceArray = integers("world", "joint_friction", note="0 stick, 1 slip")
    slip_anchor: DeviceArray = reals("world", "joint_friction", 2, unit="m or rad", note="where slips are counted from")
    slip_way: DeviceArray = reals("world", "joint_friction", 2, note="friction over its bound, points as the slip does")
    slip_softness: DeviceArray = reals("world", "joint_friction", 2, unit="m/N", note="along the slip, across it")
    slip_bound: DeviceArray = reals("world", "joint_friction", unit="N")
    slip_loss: DeviceArray = reals("world", "joint_friction", unit="J", note="dissipated in a step", zero_without=True)
    holds: DeviceArray = integers("world", "pretension", note="1 where the length is held in the attempt")
    held_at: DeviceArray = reals("world", "pretension", unit="m", note="that length")
    residual_history: DeviceArray = reals("world", "residual", note="of an attempt, as fractions", carried=True)
    gap_defect: DeviceArray = reals(
        "world", 2, note="largest open gap under pressure, force left out", zero_without=True
    )


class Outer(Arrays):
    """The outer linear system: bodies, modes that are not condensed, rows."""

    tangent: DeviceArray = reals("world", "outer", "outer")
    rhs: DeviceArray = reals("world", "outer")
    scaling: DeviceArray = reals("world", "outer")
    pivots: DeviceArray = integers("world", "outer")
    elimination: DeviceArray = reals("world", "outer", "outer")
    inverse_transposed: DeviceArray = reals("world", "outer", "outer", run=True)
    C_receptance: DeviceArray = reals("world", "row", "mode", run=True, carried=True)
    sparse_factor: DeviceArray = reals("world", "factor_number", run=True)
    sparse_vector: DeviceArray = reals("world", 2, "outer", run=True)
    sparse_lines: DeviceArray = reals("world", "factor_line", run=True)
    fallback: DeviceArray = integers("world", 2, note="solves by the dense elimination", carried=True)
    z: DeviceArray = reals("world", "outer", note="outer increments", run=True)
    projection_rhs: DeviceArray = reals("world", "projected_outer", run=True)
    change: DeviceArray = reals("world", "outer", note="of velocities by their projection", run=True)
    modal_step: DeviceArray = reals("world", "mode", unit="m kg^1/2", run=True)
    hold: DeviceArray = reals("world", "6*held_body", "6*body", note="motions that a static state keeps", carried=True)
    hold_count: DeviceArray = integers("world", carried=True)
    hold_firm: DeviceArray = integers(
        "world", note="those of them that do not weaken from round to round", carried=True
    )
    hold_weak: DeviceArray = reals("world", note="by how much the others have", carried=True)
    hold_force: DeviceArray = reals("world", note="of the others, in the last round, over the largest", carried=True)


class ImpulsiveContact(Arrays):
    """Impulsive pairs: accelerations without them, and the mean forces that give back their energy."""

    v_rate0: DeviceArray = vectors("world", "contact_body", unit="m/s2", instead="v_rate")
    v_alg0: DeviceArray = vectors("world", "contact_body", unit="m/s2", instead="v_alg")
    omega_rate0: DeviceArray = vectors("world", "contact_body", unit="rad/s2", instead="omega_rate")
    omega_alg0: DeviceArray = vectors("world", "contact_body", unit="rad/s2", instead="omega_alg")
    qd_rate0: DeviceArray = reals("world", "contact_mode", unit="m kg^1/2/s2", instead="qd_rate")
    qd_alg0: DeviceArray = reals("world", "contact_mode", unit="m kg^1/2/s2", instead="qd_alg")
    v_rest: DeviceArray = vectors("world", "contact_body", unit="m/s2", note="what impulsive forces add to v_alg")
    omega_rest: DeviceArray = vectors("world", "contact_body", unit="rad/s2")
    qd_rest: DeviceArray = reals("world", "contact_mode", unit="m kg^1/2/s2")
    restless: DeviceArray = integers("world", "pair", note="1 where the active set goes on changing", zero_without=True)
    theta: DeviceArray = reals("world", "pair", note="weight of the trial force in the mean", carried=True)
    bracket: DeviceArray = reals("world", "pair", 9, note="of theta, see `impulsive_means`", carried=True)
    weight: DeviceArray = reals("world", "pair", note="d(mean force)/d(trial force)", carried=True)
    wanted: DeviceArray = integers("world", "pair", note="1 where another attempt is to take the pair as impulsive")
    created_now: DeviceArray = reals("world", "pair", unit="J")
    pair_loss: DeviceArray = reals("world", "pair", unit="J", note="of damped layers", zero_without=True)
    contact_receptance: DeviceArray = reals("world", "dynamic_mode", unit="s2", instead="receptance")
    modal_push: DeviceArray = reals("world", "dynamic_mode", unit=MODAL, run=True)


class ContactGeometry(Arrays):
    """Windows, gaps at points and weak gaps."""

    pair_wrench: DeviceArray = reals("world", "pair", 6, unit=FORCE)
    phase: DeviceArray = reals("world", "pair", 12, unit="columns", note="on both grids: in use, new")
    center: DeviceArray = integers("world", "pair", 3, note="centre columns and B's row")
    nearest: DeviceArray = reals("world", "pair", 2, note="column, and z [m] of the nearest place", zero_without=True)
    touched: DeviceArray = integers("world", "pair", 2, zero_without=True)
    station: DeviceArray = reals("world", "pair", "station", 11, note="line of centres")
    station_wrench: DeviceArray = reals("world", "pair", "station", 6, zero_without=True)
    window: DeviceArray = integers("world", "pair", 2)
    second_window: DeviceArray = integers("world", "pair", 2)
    point_gap: DeviceArray = reals("world", "pair", "window_point", unit="m")
    point_place: DeviceArray = reals("world", "pair", "window_point", 2, note="column and row on B")
    point_line: DeviceArray = reals("world", "pair", "point_number", note="see `at_points`")
    held: DeviceArray = structs(Held, "world", "pair", "column_point", note="contact frames, see `contact_wrench`")
    held_ball: DeviceArray = matrices("world", "pair")
    weak_gap: DeviceArray = reals("world", "pair", "hat", unit="m")
    shifted_gap: DeviceArray = reals("world", "pair", "hat", unit="m")
    area: DeviceArray = reals("world", "pair", "hat", unit="m2")
    wrench: DeviceArray = reals("world", "pair", "hat", 6, note="per unit pressure")
    more_wrench: DeviceArray = reals(
        "world", "pair", "held_hat", 6, note="what the true one has beside", zero_without=True
    )
    stencil: DeviceArray = reals("world", "pair", "hat", "stencil", unit="m2", zero_without=True)
    stencil_at: DeviceArray = integers("world", "pair", "hat", 2, note="column and row on B", zero_without=True)


class Patches(Arrays):
    """Cells that travel with the patch, see the kernels of `patch`."""

    patch_place: DeviceArray = reals("world", "patch_pair", 4, note="column and z [m] of A, W [m], column of B")
    patch_buffer: DeviceArray = reals("world", "patch_pair", "patch_hat", unit="Pa")
    patch_made: DeviceArray = reals(
        "world", "patch_pair", 3, note="W, tangent of the step and weight for which rows of G were made", carried=True
    )
    patch_steady: DeviceArray = integers(
        "world", "patch_pair", note="1: the next one does not undo the one before it", carried=True
    )
    patch_change: DeviceArray = reals(
        "world", "patch_pair", "patch_hat", unit="Pa", note="of pressures in the last accepted step", carried=True
    )
    patch_row: DeviceArray = structs(Row, "world", "patch_pair", "patch_row", note="what its cells have in common")
    patch_ball: DeviceArray = matrices("world", "patch_pair")
    patch_laid: DeviceArray = reals("world", "patch_pair", 2, note="W and ends of the next", carried=True)
    patch_near: DeviceArray = reals("world", "patch_pair", "near_number", unit="m3/Pa", carried=True)
    far_at: DeviceArray = integers("world", "patch_pair", "2*patch_hat", 2, note="first column and row of splines")
    far_weight: DeviceArray = reals("world", "patch_pair", "2*patch_hat", 9, unit="m2")
    far_window: DeviceArray = integers("world", "patch_pair", 2, 2, note="first column and columns, by side")
    far_load: DeviceArray = reals("world", "patch_pair", "2*far_node", unit="N")
    far_field: DeviceArray = reals("world", "patch_pair", "2*far_node", unit="m")
    far_modes: DeviceArray = reals("world", "patch_pair", "2*far_node", unit="m")
    far_answered: DeviceArray = integers(
        "world", "patch_pair", note="which of the next three are those of the evaluation"
    )
    far_soft: DeviceArray = reals("world", "patch_pair", "2*far_node", unit="m/N", note="a line", run=True)
    far_answer: DeviceArray = reals("world", "patch_pair", "2*far_node", "patch_place", unit="m/Pa", run=True)
    far_gradient: DeviceArray = reals("world", "patch_pair", "patch_mode", "patch_place", run=True)
    far_line: DeviceArray = reals("world", "patch_place", unit="m/Pa", note="a row of G")
    far_strip: DeviceArray = integers("world", "patch_pair", "2*patch_column", 2, note="columns of splines of a strip")
    far_share: DeviceArray = reals("world", "patch_pair", "2*far_node", "patch_place", unit="m2", run=True)
    far_laid: DeviceArray = integers("world", "patch_pair", 2, 2, note="the window of the next two", carried=True)
    far_table: DeviceArray = reals("world", "patch_pair", "2*far_node", "far_node", unit="m/N", run=True, carried=True)
    far_trace: DeviceArray = reals("world", "patch_pair", "patch_mode", "far_node", run=True, carried=True)
    patch_pressure: DeviceArray = reals("world", "patch_pair", "patch_place", unit="Pa")
    slot_place: DeviceArray = integers("world", "patch_slot")
    patch_between: DeviceArray = reals("world", "beside_patch", "between_place", unit="m3/Pa", note="over both strips")
    slot_reach: DeviceArray = integers("world", "patch_slot", note="last place of its pair, of the slots so far")
    far_others: DeviceArray = reals("world", "patch_pair", "2*far_node", unit="m", note="by the patches beside")
    beside_local: DeviceArray = reals("world", "pair", "hat", unit="m", note="by the patches beside")
    far_beside: DeviceArray = reals("world", "far_node", unit="m/Pa", note="of a cell on the splines of another patch")


class Rolling(Arrays):
    """Friction on cells that travel with the patch, see the kernels of `rolling`; [A, B] are the sides, [1, 2] the
    directions of each."""

    shear_laid: DeviceArray = reals("world", "rolling_pair", 1, unit="m", note="W of the next", carried=True)
    shear_near: DeviceArray = reals("world", "rolling_pair", "shear_number", unit="m3/Pa", carried=True)
    place_traction: DeviceArray = reals(
        "world", "rolling_pair", "4*rolling_place", unit="Pa", note="on A, on B, by place", run=True
    )
    place_change: DeviceArray = reals(
        "world", "rolling_pair", "rolling_place", unit="Pa", note="of pressures, by place", run=True
    )
    place_none: DeviceArray = reals("world", "rolling_pair", "4*rolling_place", unit="Pa", note="zeros", run=True)
    rub_laid: DeviceArray = integers("world", "rolling_pair", 2, 2, note="the window of the next two", carried=True)
    rub_table: DeviceArray = reals(
        "world", "rolling_pair", "4*rolling_node", "3*rolling_node", unit="m/N",
        note="by a force along: displacement along, outward", run=True, carried=True,
    )  # fmt: skip
    rub_trace: DeviceArray = reals("world", "rolling_pair", "rolling_mode", "2*rolling_node", run=True, carried=True)
    rub_load: DeviceArray = reals("world", "rolling_pair", "4*rolling_node", unit="N", run=True)
    press_load: DeviceArray = reals("world", "rolling_pair", "2*rolling_node", unit="N", note="of changes", run=True)
    rub_field: DeviceArray = reals("world", "rolling_pair", "4*rolling_node", unit="m", note="local modes", run=True)
    rub_modes: DeviceArray = reals("world", "rolling_pair", "4*rolling_node", unit="m", note="global modes", run=True)
    rub_push: DeviceArray = reals("world", "rolling_pair", "2*rolling_node", unit="m", note="outward", run=True)
    grown: DeviceArray = reals("world", "rolling_pair", "2*rolling_node", note="outward over the radius", run=True)
    gap_change: DeviceArray = reals("world", "rolling_pair", "rolling_hat", unit="m3", note="by a round", run=True)
    near_shift: DeviceArray = reals(
        "world", "rolling_pair", "2*rolling_hat", unit="m3", note="by the half-spaces", run=True
    )
    weak_shift: DeviceArray = reals("world", "rolling_pair", "4*rolling_hat", unit="m3", note="A, B", run=True)
    weak_modes: DeviceArray = reals("world", "rolling_pair", "4*rolling_hat", unit="m3", note="A, B", run=True)
    weak_grown: DeviceArray = reals(
        "world", "rolling_pair", "rolling_hat", unit="m2", note="growth, A less B", run=True
    )
    rub_line: DeviceArray = reals(
        "world", "rolling_pair", "4*rolling_node", note="of a cell's two directions", run=True
    )
    rub_soft: DeviceArray = reals(
        "world", "rolling_pair", "4*rolling_node", "2*rolling_node", unit="m/N", note="S_tt and modes", run=True
    )


class ContactFields(Arrays):
    """Displacements that open gaps, and loads on the second grids."""

    gap: DeviceArray = reals("world", "pair", "hat", unit="m")
    opened: DeviceArray = reals("world", "pair", "hat", unit="m", note="the gap without the pressures")
    base: DeviceArray = reals("world", "pair", "hat", unit="Pa", note="pressures of the evaluation")
    first_field: DeviceArray = reals("world", "pair", "hat", unit="m", note="by the modes of A")
    second_field: DeviceArray = reals(
        "world", "pair", "node", unit="m", note="by those of B", run=True, zero_without=True
    )
    first_step: DeviceArray = reals("world", "pair", "hat", unit="m", note="the same, of increments")
    second_step: DeviceArray = reals("world", "pair", "node", unit="m", run=True, zero_without=True)
    first_local: DeviceArray = reals("world", "pair", "hat", unit="m", note="by the local modes of A", run=True)
    second_local: DeviceArray = reals(
        "world", "pair", "node", unit="m", note="by those of B", run=True, zero_without=True
    )
    second_load: DeviceArray = reals("world", "pair", "node", unit="N", zero_without=True)
    second_wrench: DeviceArray = reals("world", "pair", 6, unit=FORCE)
    proposed: DeviceArray = integers("world", "pair", "hat", note="active set after a solve")


class ContactSolve(Arrays):
    """The system of the hats in play."""

    lasting: DeviceArray = integers("world", 6, note="see `normal.lasting`", carried=True)
    slot_of: DeviceArray = integers("world", "pair", "hat", carried=True)
    slot_hat: DeviceArray = integers("world", "slot", 2, note="pair and hat", zero_without=True, carried=True)
    T: DeviceArray = reals("world", "slot", "node", note="response of the second surface", run=True)
    J: DeviceArray = reals(
        "world", "slot", "pair_mode", note="d(gap)/d(modes)", run=True, zero_without=True, carried=True
    )
    G: DeviceArray = reals("world", "slot", "slot", unit="m/Pa", note="gaps by pressures", carried=True)
    L: DeviceArray = reals("world", "slot", "coupled", note="d(gap)/d(outer)")
    soft: DeviceArray = reals("world", "layer_slot", "layer_slot", note="G with the yield of layers", instead="G")
    scaled_modes: DeviceArray = reals("world", "pair_mode", run=True)
    field_beside: DeviceArray = reals("world", "surface_place", run=True)
    right: DeviceArray = reals("world", "slot", unit="m")
    order: DeviceArray = integers(
        "world", "slot", note="slots under pressure, pair by pair, then those that left", carried=True
    )
    block: DeviceArray = integers(
        "world", "pair", 4, note="where a pair's begin and how many; of those that left", carried=True
    )
    row_scale: DeviceArray = reals("world", "pair", note="W of a patch where its rows were made over W; 1 of hats")
    kept: DeviceArray = integers("world", note="what of the next three is that of the solve before")
    factor: DeviceArray = reals("world", "slot", "slot", note="U of each pair's block of G", carried=True)
    W: DeviceArray = reals("world", "slot", "coupled", note="U^-T L")
    square: DeviceArray = reals("world", "pair", "coupled", "coupled", note="W^T W")
    bordered: DeviceArray = reals("world", "contact_outer", "contact_outer", note="outer matrix with the pressures")
    bordered_rhs: DeviceArray = reals("world", "contact_outer")
    solution: DeviceArray = reals("world", "slot", unit="Pa")
    krylov: DeviceArray = reals("world", 4, "slot_beside", note="of the gradients: see `solve_between`", run=True)
    krylov_rhs: DeviceArray = reals("world", "outer_beside", run=True)
    krylov_z: DeviceArray = reals("world", "outer_beside", run=True)
    krylov_path: DeviceArray = reals("world", "outer_beside", run=True)


class Layers(Arrays):
    """Layers whose yield is no constant, see `weak_layer`."""

    layer_past: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_past_drag: DeviceArray = reals("world", "pair", "layer_point", unit="Pa")
    layer_at: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_flexibility: DeviceArray = reals("world", "pair", "layer_point", unit="m/Pa")
    layer_beginning: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_now: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_drag_now: DeviceArray = reals("world", "pair", "layer_point", unit="Pa")
    layer_support: DeviceArray = reals("world", "pair", "layer_hat")
    layer_offset: DeviceArray = reals("world", "pair", "layer_hat", unit="m")
    layer_tangent: DeviceArray = reals("world", "pair", "layer_hat", 9, unit="m/Pa")
    layer_rhs: DeviceArray = reals("world", "layer_outer", run=True)
    layer_moved: DeviceArray = reals("world", "layer_outer", note="outer increments by pressures", run=True)


class FrictionCells(Arrays):
    """Cells with friction: where they are, how far they slide, what bounds them."""

    cell_area: DeviceArray = reals("world", "pair", "friction_hat", unit="m2")
    cell_place: DeviceArray = reals("world", "pair", "friction_hat", 2, note="column and row on B")
    cell_turn: DeviceArray = reals("world", "pair", "friction_hat", 4, note="directions of A in those of B")
    cell_wrench: DeviceArray = reals("world", "pair", "2*friction_hat", 6)
    cell_own: DeviceArray = reals("world", "pair", "friction_hat", unit="m/Pa", note="displacement by its own traction")
    rigid_slip: DeviceArray = reals("world", "pair", "2*friction_hat", unit="m")
    pressed_slip: DeviceArray = reals("world", "pair", "2*friction_hat", unit="m", note="by a change of the pressures")
    slip: DeviceArray = reals("world", "pair", "2*friction_hat", unit="m")
    elastic: DeviceArray = reals("world", "pair", "2*friction_hat", unit="m")
    elastic_local: DeviceArray = reals("world", "pair", "2*friction_hat", unit="m")
    share: DeviceArray = reals("world", "pair", "friction_hat", "share")
    share_at: DeviceArray = integers("world", "pair", "friction_hat", 2)
    bound: DeviceArray = reals("world", "pair", "friction_hat", unit="Pa", note="mu p")
    steep: DeviceArray = integers("world", "speed_pair", 3, note="mark, count, worst: see `slip_speed`", carried=True)
    late: DeviceArray = reals("world", "pair", "friction_hat", note="cells that come under pressure within the step")
    apart: DeviceArray = reals("world", "pair", "friction_hat", unit="m/N", note="see `entering_cells`")
    pressure_change: DeviceArray = reals("world", "pair", "friction_hat", unit="Pa")
    load_change: DeviceArray = reals("world", "pair", "friction_node", unit="N")
    first_force: DeviceArray = reals("world", "pair", "2*friction_hat", unit="N", note="of tractions")
    second_force: DeviceArray = reals("world", "pair", "2*friction_node", unit="N")
    traction_base: DeviceArray = reals("world", "pair", "2*friction_hat", unit="Pa", note="of the evaluation")
    cell_phase: DeviceArray = reals(
        "world", "pair", 8, note="where the grids, or the patch, were when compliances were made", carried=True
    )
    cell_state: DeviceArray = integers("world", "pair", "friction_hat", note="sticks, slips or is free")
    friction_record: DeviceArray = reals("world", "pair", 4, note="power, creep (2), rolling velocity")
    advanced: DeviceArray = reals("world", "pair", unit="columns")
    friction_work: DeviceArray = reals("world", "pair", 1, unit="J", zero_without=True)
    normal_wrench: DeviceArray = reals("world", "pair", 6, unit=FORCE, zero_without=True)
    first_shift: DeviceArray = reals("world", 2, "pair", "friction_hat", unit="m", run=True)
    second_shift: DeviceArray = reals("world", 2, "pair", "friction_node", unit="m", run=True)
    first_push: DeviceArray = reals("world", "pair", "friction_hat", unit="m", run=True)
    second_push: DeviceArray = reals("world", "pair", "friction_node", unit="m", run=True)
    second_modal: DeviceArray = reals("world", 2, "pair", "friction_node", unit="m", run=True)


class FrictionSolve(Arrays):
    """The system of the cells in play."""

    cell_slot_of: DeviceArray = integers("world", "pair", "friction_hat", carried=True)
    cell_slot: DeviceArray = integers("world", "friction_pair", "cell", note="which cell", carried=True)
    cell_block: DeviceArray = integers("world", "friction_pair", 3, note="see `cell_blocks`", carried=True)
    cell_G: DeviceArray = reals("world", "friction_pair", "2*cell", "2*cell", unit="m/Pa", carried=True)
    cell_D: DeviceArray = reals(
        "world", "friction_pair", "2*cell", "2*cell", unit="m/Pa", note="G with the pressures' answer", carried=True
    )
    cell_L: DeviceArray = reals("world", "friction_pair", "2*cell", "coupled", carried=True)
    cell_J: DeviceArray = reals("world", "friction_pair", "2*cell", "pair_mode", run=True, carried=True)
    cell_JT: DeviceArray = reals("world", "friction_pair", "pair_mode", "2*cell", note="transposed", carried=True)
    cell_bordered: DeviceArray = reals(
        "world", "friction_pair", "2*cell", "coupled", note="L with the pressures' answer", carried=True
    )
    cell_V: DeviceArray = reals(
        "world", "friction_pair", "2*cell", "coupled", note="outer increments by tractions", carried=True
    )
    cell_diagonal: DeviceArray = reals(
        "world", "friction_pair", "cell", 3, unit="m/Pa", note="of K: 00, 01, 11", carried=True
    )
    mobility: DeviceArray = reals("world", "friction_outer", "friction_outer", run=True, carried=True)
    mobility_rhs: DeviceArray = reals("world", "friction_outer", run=True)
    mobility_column: DeviceArray = reals("world", "friction_outer", run=True)
    mobility_own: DeviceArray = reals("world", "friction_pair", "coupled", "coupled", note="of the columns of a pair")
    cell_Y: DeviceArray = reals("world", "friction_slot", "2*cell", note="pressures by tractions")
    cell_base: DeviceArray = reals("world", "friction_pair", "2*cell", unit="Pa")
    cell_right: DeviceArray = reals("world", "friction_pair", "2*cell", unit="m")
    cell_tau: DeviceArray = reals("world", "friction_pair", "2*cell", unit="Pa")
    cell_slip: DeviceArray = reals("world", "friction_pair", "2*cell", unit="m")
    cell_radius: DeviceArray = reals("world", "friction_pair", "cell", unit="Pa")
    cell_softness: DeviceArray = reals("world", "friction_pair", "cell", unit="m/Pa")
    cell_frozen: DeviceArray = reals("world", "friction_pair", "2*cell", carried=True)
    cell_jump: DeviceArray = reals("world", "friction_pair", "2*cell")
    cell_direction: DeviceArray = reals("world", "friction_pair", "2*cell", carried=True)
    cell_curvature: DeviceArray = reals("world", "friction_pair", "cell", carried=True)
    cell_slope: DeviceArray = reals("world", "friction_pair", "cell", note="lambda, see `interior_point`")
    cell_order: DeviceArray = integers("world", "friction_pair", "2*cell", carried=True)
    cell_sliding: DeviceArray = integers("world", "friction_pair", "2*cell", carried=True)
    cell_outcome: DeviceArray = reals("world", 4)
    cell_inside: DeviceArray = reals("world", 2)
    cell_solution: DeviceArray = reals("world", "friction_pair", "2*cell")
    cell_U: DeviceArray = reals(
        "world", "friction_pair", "2*cell", "2*cell", note="factor of the free coordinates", carried=True
    )
    cell_W: DeviceArray = reals("world", "friction_pair", "2*cell", "coupled", carried=True)
    cell_square: DeviceArray = reals("world", "friction_pair", "coupled", "coupled", carried=True)
    cell_load: DeviceArray = reals("world", "friction_outer", run=True)
    cell_moved_outer: DeviceArray = reals("world", "friction_outer", run=True)
    cell_outer: DeviceArray = reals(
        "world", "friction_outer", "friction_outer", note="the outer matrix with W^T W", carried=True
    )
    cell_scaling: DeviceArray = reals("world", "friction_outer", carried=True)
    cell_pivots: DeviceArray = integers("world", "friction_outer", carried=True)
    cell_factor: DeviceArray = reals("world", "friction_factor", run=True, carried=True)
    cell_vector: DeviceArray = reals("world", 2, "friction_outer", run=True)
    cell_lines: DeviceArray = reals("world", "friction_line", run=True)
    cell_fallback: DeviceArray = integers("world", 2, note="solves by the dense elimination", carried=True)
    cell_work: DeviceArray = reals("world", "friction_outer", "friction_outer")
    cell_inverse_transposed: DeviceArray = reals("world", "friction_outer", "friction_outer", run=True, carried=True)
    cell_shift: DeviceArray = reals("world", "friction_pair", 4, "friction_node", unit="m", run=True)
    cell_scaled: DeviceArray = reals("world", "friction_pair", 2, "pair_mode", run=True)
    cell_push: DeviceArray = reals("world", "mode", unit=MODAL, run=True)
    modal_drive: DeviceArray = reals("world", "mode", unit=MODAL, run=True)
    answer_hat: DeviceArray = integers("world", "friction_slot", carried=True)
    answer_z: DeviceArray = reals("world", "friction_outer", run=True)
    answer_step: DeviceArray = reals("world", "friction_slot", unit="Pa")
    answer_moved: DeviceArray = reals("world", "friction_pair", "2*cell", unit="Pa")
    answer_state: DeviceArray = integers("world", 4, carried=True)
    answer_change: DeviceArray = reals("world", 1)


class LumpedContacts(Arrays):
    """Places of lumped contacts, see `lumped.forces`."""

    lumped_load: DeviceArray = structs(Load, "world", "lumped_place", note="force on the first body, what moves it")
    lumped_taken: DeviceArray = reals(
        "world", "lumped_place", 4, unit="J", note="damped, rubbed, given by the step; of a bounce", zero_without=True
    )
    lumped_moment: DeviceArray = structs(Moment, "world", "lumped_moment", note="on the first body, see `moments`")


class Films(Arrays):
    """Oil films, see the kernels of `films`."""

    film_stretch: DeviceArray = reals("world", note="time of films over that of bodies in static steps", carried=True)
    film_rates: DeviceArray = reals("world", 3, unit="1/s", note="coefficients of BDF2")
    film_least: DeviceArray = reals("world", "film_point", unit="m", note="by which the prediction closes gaps")
    film_acting: DeviceArray = reals("world", "film_system", unit="Pa", note="pressures that deform", run=True)
    film_opened: DeviceArray = reals("world", "film_hat", unit="m", note="by deformation")
    film_local: DeviceArray = reals("world", "film_hat", unit="m", note="of this by local modes")
    film_seat: DeviceArray = integers("world", "film_seat", 2, note="hats of the second surface, see `films.seats`")
    film_seat_at: DeviceArray = reals("world", "film_seat", 2, note="where between them")
    film_press_load: DeviceArray = reals("world", "film_press", unit="N", note="by pressures and asperities")
    film_second_load: DeviceArray = reals("world", "film_second_hat", unit="N", note="on hats of the second surface")
    film_second_opened: DeviceArray = reals("world", "film_second_hat", unit="m", note="there, by deformation")
    film_second_energy: DeviceArray = reals("world", "film_second_hat", unit="J", note="of its local modes")
    film_second_weight: DeviceArray = reals("world", "film_load", unit="m2", note="W: (line, second hat)", carried=True)
    film_second_yield: DeviceArray = reals(
        "world", "film_load", unit="m/Pa", note="Q: (second hat, line)", carried=True
    )
    film_second_wide: DeviceArray = reals("world", "film_load", note="room of each line", run=True)
    film_second_ahead: DeviceArray = reals("world", "film_second_hat", unit="m", note="change by deformation")
    film_carried: DeviceArray = reals("world", "film_function", 2, unit="m/s", note="U: around, along")
    film_mass_now: DeviceArray = reals("world", "film_point", unit="m", note="of the trial state")
    film_line: DeviceArray = reals("world", "film_point", FILM_LINE, note="numbers of a point, see `films.sampling`")
    film_pull: DeviceArray = reals("world", "film_point", PULL, note="forces and powers of a point")
    film_sums: DeviceArray = reals("world", "film", PULL, note="of all points", zero_without=True)
    film_rest: DeviceArray = reals("world", "film_function", unit="m3/s", note="R")
    film_size: DeviceArray = reals("world", "film_function", unit="m3/s", note="of its parts")
    film_refill: DeviceArray = reals("world", "film_function", unit="m3/s", note="part of the voids in R")
    film_off: DeviceArray = reals("world", "film", note="R beside its parts", zero_without=True)
    film_modal: DeviceArray = reals("world", "film_column", unit=MODAL, note="load on modes", zero_without=True)
    film_changed: DeviceArray = integers("world", "film", note="functions that changed sides", zero_without=True)
    film_switch: DeviceArray = integers("world", "film_unknown", note="1 where the last iteration changed sides")
    film_hat_line: DeviceArray = reals("world", "film_hat", HAT_LINE, note="where there are asperities")
    film_energy_now: DeviceArray = reals("world", "film_hat", unit="J/m2", note="of asperities")
    film_rough: DeviceArray = integers("world", "film_hat", note="1 where asperities touch", carried=True)
    film_wide: DeviceArray = reals("world", "film_near", unit="m2/s", note="dR by the gap at hats")
    film_matrix: DeviceArray = reals(
        "world", "film_number", note="lines of J, R, B, P, then of J, R, J^-1 B, P", run=True, carried=True
    )
    film_factor: DeviceArray = reals(
        "world", "film_number", note="L, U of J in the order of film_order", run=True, carried=True
    )
    film_order: DeviceArray = integers("world", "film_system", note="place in the elimination", carried=True)
    film_pivots: DeviceArray = integers("world", "film_system", note="lines that changed places", carried=True)
    film_solution: DeviceArray = reals("world", "film_system", note="J^-1 R", run=True)
    film_stiffness: DeviceArray = reals("world", "film_square", note="P^T J^-1 B", carried=True)
    film_push: DeviceArray = reals("world", "film_column", note="P^T J^-1 R")
    film_change: DeviceArray = reals("world", "film_system", note="of pressures or voids", run=True)
    film_opening: DeviceArray = reals("world", "film_hat", unit="m", note="change by deformation")
    film_ahead: DeviceArray = reals("world", "film_point", unit="m", note="change of the gap")
    film_part: DeviceArray = reals("world", note="of the increments that is taken")
    film_taken: DeviceArray = reals("world", "film", 2, unit="J", note="by flow, by sliding", zero_without=True)


class SlipSpeedSolve(Arrays):
    """The same system where coefficients depend on the slip speed: their slopes are condensed, see `slip_speed`."""

    speed_D: DeviceArray = reals(
        "world", "speed_pair", "2*speed_cell", "2*speed_cell", unit="m/Pa", instead="cell_D", carried=True
    )
    speed_L: DeviceArray = reals(
        "world", "speed_pair", "2*speed_cell", "coupled", instead="cell_bordered", carried=True
    )
    speed_V: DeviceArray = reals("world", "speed_pair", "2*speed_cell", "coupled", instead="cell_V", carried=True)
    speed_diagonal: DeviceArray = reals(
        "world", "speed_pair", "speed_cell", 3, unit="m/Pa", instead="cell_diagonal", carried=True
    )
    speed_M: DeviceArray = reals("world", "speed_outer", "speed_outer", run=True, instead="mobility", carried=True)
    speed_bordered: DeviceArray = reals("world", "speed_outer", "speed_outer", instead="bordered")
    speed_own: DeviceArray = reals("world", "speed_pair", "coupled", "coupled")
    speed_right: DeviceArray = reals("world", "speed_pair", "2*speed_cell", unit="m", instead="cell_right")
    speed_tau: DeviceArray = reals(
        "world", "speed_pair", "2*speed_cell", unit="Pa", note="the part on the disc", instead="cell_tau"
    )
    speed_slope: DeviceArray = reals(
        "world", "speed_pair", "speed_cell", unit="Pa/m3", note="of the bound by the weak slip"
    )
    speed_drive: DeviceArray = reals("world", "speed_pair", "2*speed_cell", unit="Pa")
    speed_line: DeviceArray = reals("world", "4*speed_cell", unit="m/Pa", note="two lines of the compliance")
    speed_border: DeviceArray = reals("world", 2, "coupled", note="two lines of L")
    speed_motion: DeviceArray = reals("world", 2, "speed_outer", note="outer increments by two lines")
    speed_slip: DeviceArray = reals("world", "speed_pair", "2*speed_cell", unit="m3", note="weak, 0 of what sticks")
    speed_before: DeviceArray = reals("world", "speed_pair", "speed_cell", unit="m/s", note="of the round before")
    speed_late: DeviceArray = integers("world", 1, note="1 where late cells soften speed_K")
    speed_again: DeviceArray = integers("world", 1, note="1 where the bounds do not follow the speeds yet")


RESTORED = {name: declaration for name, declaration in State.declarations.items() if declaration.restored}


class Before(Arrays):
    """What a rejected attempt puts back: arrays of the state as it was before the attempt."""

    declarations = {
        f"{name}_before": replace(d, carried=False, restored=False, note="before the attempt")
        for name, d in RESTORED.items()
    }


class Scratch(
    RunWords, Motion, Residuals, Outer, ImpulsiveContact, ContactGeometry, Patches, Rolling, ContactFields,
    ContactSolve, Layers, FrictionCells, FrictionSolve, SlipSpeedSolve, LumpedContacts, Films, Laps, Before,
):  # fmt: skip
    """Scratch arrays of a step."""


KEPT = tuple(
    name
    for part in (Patches, Rolling, FrictionCells, FrictionSolve, SlipSpeedSolve)
    for name, declaration in part.declarations.items()
    if declaration.carried
)
"""With friction on cells that travel with the patch: their compliances and factors, which serve from step to step as
long as they are good."""
KEPT_OF_PATCHES = (
    "patch_change", "patch_steady", "patch_made", "lasting", "slot_of", "slot_hat", "J", "G", "order", "block",
    "factor",
)  # fmt: skip
"""Without: what an attempt begins with, and rows of G that stand from step to step. (Tables that are carried too are
the same bits whenever they are laid.)"""


def scratch_for(worlds: Sequence[CompiledScene], sizes: Sizes, state: State) -> Scratch:
    """Scratch arrays of a run of so many worlds, with the constants of interfaces in them."""
    scratch = Scratch(sizes, worlds[0].device, state)
    scratch.film_stretch.fill_(1.0)
    scratch.slope.assign(np.concatenate([compiled.interface_modes.ravel() for compiled in worlds]))
    return scratch
