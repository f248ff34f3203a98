"""Input and output of a step, by topic: the accepted state of every world, see `warpffrf.online.arrays.state`."""

from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.declaration import DeviceArray, integers, quaternions, reals, structs, topic, vectors
from warpffrf_kernels.core.films import HEATS as FILM_HEATS


@topic
class MotionState:
    """Bodies and modes, in the frames of centres of mass."""

    r: DeviceArray = vectors("world", "body", unit="m", note="centre of mass")
    p: DeviceArray = quaternions("world", "body", note="body axes -> world")
    v: DeviceArray = vectors("world", "body", unit="m/s")
    v_rate: DeviceArray = vectors("world", "body", unit="m/s2")
    v_alg: DeviceArray = vectors("world", "body", unit="m/s2", note="algorithmic acceleration of generalized-alpha")
    omega: DeviceArray = vectors("world", "body", unit="rad/s", note="body axes")
    omega_rate: DeviceArray = vectors("world", "body", unit="rad/s2")
    omega_alg: DeviceArray = vectors("world", "body", unit="rad/s2")
    turned: DeviceArray = reals("world", "body", unit="rad/s", note="fastest turning of a run, see `inertia_plan`")
    q: DeviceArray = reals("world", "mode", unit="m kg^1/2")
    qd: DeviceArray = reals("world", "mode", unit="m kg^1/2/s")
    qd_rate: DeviceArray = reals("world", "mode", unit="m kg^1/2/s2")
    qd_alg: DeviceArray = reals("world", "mode", unit="m kg^1/2/s2")
    v_mean: DeviceArray = vectors("world", "body", unit="m/s", note="increment over the last step, see `motion`")
    omega_mean: DeviceArray = vectors("world", "body", unit="rad/s")
    qd_mean: DeviceArray = reals("world", "mode", unit="m kg^1/2/s")
    steady: DeviceArray = integers("world", "body", 2, note="1: v_mean, omega_mean predicted the last step better")
    steady_mode: DeviceArray = integers("world", "mode", note="1: qd_mean did")


@topic
class LoadState:
    """Joints, springs and applied loads; arrays with two entries: accepted, trial."""

    lam0: DeviceArray = reals("world", "row", unit="N or N m", note="multipliers at the last accepted state")
    lam: DeviceArray = reals("world", "row", unit="N or N m", note="multipliers")
    stretch: DeviceArray = reals("world", "row", unit="m or rad", note="value of each row where it was accepted")
    drive_rate: DeviceArray = reals("world", 2, "row", unit="m/s or rad/s", note="prescribed")
    modal_load: DeviceArray = reals("world", 2, "mode", unit="N/kg^1/2")
    applied: DeviceArray = vectors("world", 2, "force", unit="N")
    applied_at: DeviceArray = vectors("world", 2, "force", unit="m")
    load: DeviceArray = reals(
        "world", 2, "6*body", unit="N, N m", note="torques and body loads: force (world axes), torque (body axes)"
    )
    load_on_modes: DeviceArray = reals("world", 2, "mode", unit="N/kg^1/2")
    lag: DeviceArray = reals(
        "world", 2, "mean_mode", unit="N/kg^1/2", note="y and Y that give forces their mean, see `mean_work`"
    )
    interface_pull: DeviceArray = reals(
        "world", "stiffened_interface", 6, unit="N, N m", note="of rows, body axes, where it was accepted"
    )


@topic
class JointFrictionState:
    """Friction in joints, see `warpffrf_kernels.constraints.joint_friction`."""

    slipping: DeviceArray = integers("world", "joint_friction", note="1 where the last step slipped, or none was")
    stuck_at: DeviceArray = reals("world", "joint_friction", 2, unit="m or rad", note="coordinates where it sticks")


@topic
class PretensionState:
    """Pretensions, see `warpffrf_kernels.constraints.pretension`."""

    locked: DeviceArray = integers("world", "pretension", note="1 where the length is held")
    locked_at: DeviceArray = reals("world", "pretension", unit="m", note="that length")


@topic
class ContactState:
    """Contact pairs: the active set in the contact frame, and the force history used by the integrator."""

    active: DeviceArray = integers("world", "pair", "node", note="1 where the window is under pressure", restored=True)
    pressure: DeviceArray = reals("world", "pair", "node", unit="Pa", restored=True)
    patch_offset: DeviceArray = reals(
        "world",
        "pair",
        unit="columns",
        note="line of centres less the centre column, where the active set was found",
        restored=True,
    )
    patch_width: DeviceArray = reals(
        "world", "pair", unit="m", note="half-width W of cells that travel, 0 before the first look", restored=True
    )
    pair_force: DeviceArray = reals(
        "world", "pair", 2, 12, unit="N, N m", note="accepted, trial: by the pressures, see `impulsive_contact`"
    )
    pair_modal: DeviceArray = reals("world", "pair", 2, "pair_mode", unit="N/kg^1/2", note="the same on the modes")
    memory: DeviceArray = reals(
        "world", "pair", 1, 12, unit="N, N m", note="what the algorithmic accelerations have of pair_force"
    )
    modal_memory: DeviceArray = reals("world", "pair", 1, "pair_mode", unit="N/kg^1/2")
    pair_energy: DeviceArray = reals("world", "pair", 2, unit="J", note="accepted, trial: energy of the contact")
    made: DeviceArray = reals("world", "pair", unit="J", note="what of `created` is beyond doubt, see `energy_watch`")
    created: DeviceArray = reals("world", "pair", unit="J", note="made so far, see `impulsive_means.judge_pairs`")
    impulsive: DeviceArray = integers("world", "pair", note="how the attempt takes the pair: SMOOTH, IMPULSIVE, IDLE")


@topic
class FrictionState:
    """Tractions in the contact frame, columns of (2, rows) of a window, and the slip history."""

    traction: DeviceArray = reals("world", "pair", "2*friction_node", unit="Pa", restored=True)
    friction_offset: DeviceArray = reals(
        "world",
        "friction_pair",
        unit="columns",
        note="as patch_offset, where the tractions were found",
        restored=True,
        flat=True,
    )
    elastic_before: DeviceArray = reals(
        "world", "pair", "2*friction_node", unit="m", note="elastic slip at the end of the last step"
    )
    history_center: DeviceArray = integers("world", "pair", note="grid column of its window's centre")
    pressed_before: DeviceArray = integers(
        "world", "pair", "friction_node", note="1 where the last step left a node under pressure"
    )
    history_phase: DeviceArray = reals(
        "world", "pair", unit="columns", note="nearest place, or line of centres, at the end of the last step"
    )
    history_z: DeviceArray = reals(
        "world", "pair", unit="m", note="z of that place on the first surface, where gaps are taken at points"
    )
    most_advanced: DeviceArray = reals(
        "world", "pair", unit="columns", note="that the patch advanced at most in a step since the last saved row"
    )
    contact_normal: DeviceArray = vectors(
        "world", "pair", note="unit vector of the normal force on the second body, zero without contact"
    )
    ring_slip: DeviceArray = reals(
        "world", "rolling_pair", "2*ring_cell", unit="m", note="elastic_before of cells of a patch, and around them"
    )
    ring_place: DeviceArray = reals(
        "world", "rolling_pair", "rolling_number", unit="", note="where they were, as patch_place; [2] 0 without"
    )
    friction_force: DeviceArray = reals("world", "friction_pair", 2, 12, unit="N, N m", note="as pair_force")
    friction_modal: DeviceArray = reals("world", "friction_pair", 2, "pair_mode", unit="N/kg^1/2")
    friction_memory: DeviceArray = reals("world", "friction_pair", 1, 12, unit="N, N m")
    modal_friction_memory: DeviceArray = reals("world", "friction_pair", 1, "pair_mode", unit="N/kg^1/2")
    elastic_energy: DeviceArray = reals("world", "pair", 2, unit="J", note="accepted, trial: that of the tractions")


@topic
class LayerState:
    """Damped layers, see `warpffrf_kernels.layers.layer_energy`."""

    layer_depth: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_drag: DeviceArray = reals(
        "world", "pair", "layer_point", unit="Pa", note="what their pressure has above the elastic one"
    )
    layer_column: DeviceArray = integers("world", "pair", note="centre column of these points")


@topic
class LumpedState:
    """Points of lumped contacts: accepted, trial; forces on the first body, world axes."""

    lumped_force: DeviceArray = reals("world", 2, "lumped_place", unit="N", note="along the normal, 0 where apart")
    lumped_friction: DeviceArray = vectors("world", 2, "lumped_place", unit="N")
    lumped_normal: DeviceArray = vectors("world", 2, "lumped_place", note="of the second surface")
    lumped_at: DeviceArray = vectors("world", 2, "lumped_place", unit="m", note="the nearest place, world")
    lumped_shear: DeviceArray = reals("world", 2, "lumped_place", unit="N/m", note="tangential stiffness, 0 apart")
    lumped_power: DeviceArray = reals("world", 2, "lumped_place", 2, unit="W", note="taken by damping, by creep")
    lumped_approach: DeviceArray = reals("world", 2, "lumped_place", unit="m", note="less the gap")
    lumped_gained: DeviceArray = reals("world", 2, "lumped_place", unit="J", note="by the integrator, losses taken off")
    lumped_energy: DeviceArray = reals("world", 2, "lumped_place", unit="J", note="of the law, and of what sticks")


@topic
class FilmState:
    """Oil films; arrays with two entries: accepted, trial; of film_mass the accepted and the previous one."""

    film_pressure: DeviceArray = reals("world", 2, "film_function", unit="Pa")
    film_void: DeviceArray = reals("world", 2, "film_function", unit="m", note="volume of voids over area")
    film_full: DeviceArray = integers("world", 2, "film_function", note="1: a pressure, 0: a void")
    film_asperity: DeviceArray = reals("world", 2, "film_node", unit="Pa")
    film_energy: DeviceArray = reals("world", 2, "film", unit="J", note="of asperities")
    film_void_before: DeviceArray = reals("world", "film_function", unit="m", note="of the step before the last")
    film_mass: DeviceArray = reals("world", 2, "film_point", unit="m", note="gap times rho/rho_0")
    film_power: DeviceArray = reals("world", 2, "film", 2, unit="W", note="taken by the flow, by sliding")
    film_temperature: DeviceArray = reals("world", "film_heat_node", unit="degC", note="mean across the gap")
    film_thinning: DeviceArray = reals("world", "film_heat_node", note="ln of the viscosity there, as heat_table")
    film_heat: DeviceArray = reals("world", 2, "film", FILM_HEATS, note="see `films.heat`")
    film_step: DeviceArray = reals("world", unit="s", note="the last one, 0 where the history begins")


@topic
class MatchedState:
    """Joint interfaces: accepted forces, gaps, states and slips of their cells; forces on the second face."""

    matched_force: DeviceArray = reals("world", "matched_cell", 3, unit="N", note="normal, along t1, t2")
    matched_gap: DeviceArray = reals("world", "matched_cell", unit="m")
    matched_slip: DeviceArray = reals("world", "matched_cell", 2, unit="m", note="so far, of the second face")
    matched_state: DeviceArray = integers("world", "matched_cell", note="0 open, 1 stick, 2 slip")
    matched_lost: DeviceArray = reals("world", "matched_cell", unit="J", note="by friction so far")
    matched_energy: DeviceArray = reals("world", "matched_group", unit="J", note="of what yields under their forces")


@topic
class Books:
    """Ledger, control words and clock."""

    energy: DeviceArray = reals("world", 2, "line", unit="J", note="accepted, trial")
    ctl: DeviceArray = structs(Control, "world", note="control words")
    clk: DeviceArray = structs(Clock, "world", note="time, step and coefficients")
