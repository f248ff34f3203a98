"""Intermediate quantities of a step: bodies, joints, the retained system; see `warpffrf.online.arrays.scratch`."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, matrices, quaternions, reals, topic, vectors

FORCE, MODAL = "N, N m", "N/kg^1/2"


@topic
class RunWords:
    """Settings of a whole run, and the loop conditions of the graph."""

    coefficients: DeviceArray = reals("world", 4, note="of the integrator", carried=True)
    local_coefficients: DeviceArray = reals("world", 4, note="of local modes", carried=True)
    step_error: DeviceArray = reals("world", note="allowed local error", carried=True)
    project: DeviceArray = integers("world", note="1: velocities are projected", carried=True)
    running: DeviceArray = integers("one", note="1 while the iteration of a world goes on")
    rubbing: DeviceArray = integers("one", note="1 while pressures and tractions go on answering each other")
    budget: DeviceArray = integers("world", note="attempts left", carried=True)
    more: DeviceArray = integers("one", note="1 while attempts are to be made", carried=True)


@topic
class Trial:
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
    q1: DeviceArray = reals("world", "mode", unit="m kg^1/2", flat=True)
    qd1: DeviceArray = reals("world", "mode", unit="m kg^1/2/s")
    qd1_rate: DeviceArray = reals("world", "mode", unit="m kg^1/2/s2")
    exact: DeviceArray = reals("world", "exact_mode", 9, note="step, exact coefficients for it", carried=True)
    inertia_sums: DeviceArray = reals("world", "dense", 21, note="of modes and rates, see `inertia`")
    extra_energy: DeviceArray = reals("world", "body", unit="J", note="kinetic, of inertia terms", zero_without=True)
    membrane_slope: DeviceArray = reals("world", "square_line", note="L_r q, see `membrane`", flat=True)
    membrane_amplitude: DeviceArray = reals("world", "square", unit="J^1/2", note="q.L_r q/2", zero_without=True)
    membrane_slope0: DeviceArray = reals(
        "world", "square_line", note="L_r q where the attempt begins", carried=True, flat=True
    )
    membrane_amplitude0: DeviceArray = reals("world", "square", unit="J^1/2", note="there", carried=True)
    interface_motion: DeviceArray = reals("world", "interface", 6, unit="m, rad")
    slope: DeviceArray = reals(
        "world", "interface_shape", note="modes of interfaces, as loads shorten them", run=True, carried=True
    )
    slope0: DeviceArray = reals("world", "stiffened_shape", note="where the attempt begins", run=True, carried=True)
    pull_change: DeviceArray = reals("world", "stiffened_interface", 6, unit=FORCE, note="of rows, in the attempt")
    lag1: DeviceArray = reals("world", 2, "mean_mode", unit=MODAL, note="`lag` at the end of the attempt")


@topic
class Residuals:
    """Unbalanced forces and rows of joints, drives and springs."""

    residual: DeviceArray = reals("world", "6*body", unit=FORCE)
    modal_residual: DeviceArray = reals("world", "mode", unit=MODAL)
    receptance: DeviceArray = reals("world", "mode", unit="s2", note="d(dq)/d(modal load)", flat=True)
    # entries of bodies that a row does not involve stay zero
    C: DeviceArray = reals("world", "row", "6*body", note="d(row)/d(dx, psi)", carried=True)
    C_modal: DeviceArray = reals("world", "row", "mode", note="d(row)/d(dq)", carried=True, flat=True)
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


@topic
class RetainedSystem:
    """The retained linear system: bodies, modes that are not condensed, rows."""

    tangent: DeviceArray = reals("world", "retained", "retained")
    rhs: DeviceArray = reals("world", "retained")
    scaling: DeviceArray = reals("world", "retained")
    pivots: DeviceArray = integers("world", "retained")
    elimination: DeviceArray = reals("world", "retained", "retained")
    inverse_transposed: DeviceArray = reals("world", "retained", "retained", run=True)
    C_receptance: DeviceArray = reals("world", "row", "mode", run=True, carried=True)
    sparse_factor: DeviceArray = reals("world", "factor_number", run=True)
    sparse_vector: DeviceArray = reals("world", 2, "retained", run=True)
    sparse_lines: DeviceArray = reals("world", "factor_line", run=True)
    fallback: DeviceArray = integers("world", 2, note="solves by the dense elimination", carried=True)
    z: DeviceArray = reals("world", "retained", note="retained increments", run=True)
    projection_rhs: DeviceArray = reals("world", "projected_retained", run=True)
    change: DeviceArray = reals("world", "retained", note="of velocities by their projection", run=True)
    modal_step: DeviceArray = reals("world", "mode", unit="m kg^1/2", run=True)
    hold: DeviceArray = reals("world", "6*held_body", "6*body", note="motions that a static state keeps", carried=True)
    hold_count: DeviceArray = integers("world", carried=True)
    hold_firm: DeviceArray = integers(
        "world", note="those of them that do not weaken from round to round", carried=True
    )
    hold_weak: DeviceArray = reals("world", note="by how much the others have", carried=True)
    hold_force: DeviceArray = reals("world", note="of the others, in the last round, over the largest", carried=True)


@topic
class ImpulsiveContact:
    """Impulsive pairs: accelerations without them, and the mean forces that return their energy."""

    v_rate0: DeviceArray = vectors("world", "contact_body", unit="m/s2", instead="v_rate")
    v_alg0: DeviceArray = vectors("world", "contact_body", unit="m/s2", instead="v_alg")
    omega_rate0: DeviceArray = vectors("world", "contact_body", unit="rad/s2", instead="omega_rate")
    omega_alg0: DeviceArray = vectors("world", "contact_body", unit="rad/s2", instead="omega_alg")
    qd_rate0: DeviceArray = reals("world", "contact_mode", unit="m kg^1/2/s2", instead="qd_rate")
    qd_alg0: DeviceArray = reals("world", "contact_mode", unit="m kg^1/2/s2", instead="qd_alg")
    v_rest: DeviceArray = vectors("world", "contact_body", unit="m/s2", note="what impulsive forces add to v_alg")
    omega_rest: DeviceArray = vectors("world", "contact_body", unit="rad/s2")
    qd_rest: DeviceArray = reals("world", "contact_mode", unit="m kg^1/2/s2")
    unsettled: DeviceArray = integers(
        "world", "pair", note="1 where the active set goes on changing", zero_without=True
    )
    theta: DeviceArray = reals("world", "pair", note="weight of the trial force in the mean", carried=True)
    bracket: DeviceArray = reals("world", "pair", 9, note="of theta, see `impulsive_means`", carried=True)
    weight: DeviceArray = reals("world", "pair", note="d(mean force)/d(trial force)", carried=True)
    wanted: DeviceArray = integers("world", "pair", note="1 where another attempt is to take the pair as impulsive")
    created_now: DeviceArray = reals("world", "pair", unit="J")
    pair_loss: DeviceArray = reals("world", "pair", unit="J", note="of damped layers", zero_without=True)
    contact_receptance: DeviceArray = reals("world", "dynamic_mode", unit="s2", instead="receptance")
    modal_push: DeviceArray = reals("world", "dynamic_mode", unit=MODAL, run=True)
