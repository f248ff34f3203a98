"""Scratch arrays of pairs with friction, by topic."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, reals, topic
from warpffrf_kernels.core.scratch import FORCE, MODAL


@topic
class FrictionCells:
    """Cells with friction: position, slip and traction bound."""

    cell_area: DeviceArray = reals("world", "pair", "friction_node", unit="m2")
    cell_place: DeviceArray = reals("world", "pair", "friction_node", 2, note="column and row on B")
    cell_turn: DeviceArray = reals("world", "pair", "friction_node", 4, note="directions of A in those of B")
    cell_wrench: DeviceArray = reals("world", "pair", "2*friction_node", 6)
    cell_own: DeviceArray = reals(
        "world", "pair", "friction_node", unit="m/Pa", note="displacement by its own traction"
    )
    rigid_slip: DeviceArray = reals("world", "pair", "2*friction_node", unit="m")
    pressed_slip: DeviceArray = reals("world", "pair", "2*friction_node", unit="m", note="by a change of the pressures")
    slip: DeviceArray = reals("world", "pair", "2*friction_node", unit="m")
    elastic: DeviceArray = reals("world", "pair", "2*friction_node", unit="m")
    elastic_local: DeviceArray = reals("world", "pair", "2*friction_node", unit="m")
    share: DeviceArray = reals("world", "pair", "friction_node", "share")
    share_at: DeviceArray = integers("world", "pair", "friction_node", 2)
    bound: DeviceArray = reals("world", "pair", "friction_node", unit="Pa", note="mu p")
    steep: DeviceArray = integers("world", "speed_pair", 3, note="mark, count, worst: see `slip_speed`", carried=True)
    late: DeviceArray = reals("world", "pair", "friction_node", note="cells that come under pressure within the step")
    apart: DeviceArray = reals("world", "pair", "friction_node", unit="m/N", note="see `entering_cells`")
    pressure_change: DeviceArray = reals("world", "pair", "friction_node", unit="Pa")
    load_change: DeviceArray = reals("world", "pair", "friction_second_node", unit="N")
    first_force: DeviceArray = reals("world", "pair", "2*friction_node", unit="N", note="of tractions", flat=True)
    second_force: DeviceArray = reals("world", "pair", "2*friction_second_node", unit="N")
    traction_base: DeviceArray = reals("world", "pair", "2*friction_node", unit="Pa", note="of the evaluation")
    cell_phase: DeviceArray = reals(
        "world", "pair", 8, note="where the grids, or the patch, were when compliances were made", carried=True
    )
    cell_state: DeviceArray = integers("world", "pair", "friction_node", note="sticks, slips or is free")
    friction_record: DeviceArray = reals("world", "pair", 4, note="power, creep (2), rolling velocity")
    advanced: DeviceArray = reals("world", "pair", unit="columns")
    friction_work: DeviceArray = reals("world", "pair", 1, unit="J", zero_without=True)
    normal_wrench: DeviceArray = reals("world", "pair", 6, unit=FORCE, zero_without=True)
    first_shift: DeviceArray = reals("world", 2, "pair", "friction_node", unit="m", run=True)
    second_shift: DeviceArray = reals("world", 2, "pair", "friction_second_node", unit="m", run=True)
    first_push: DeviceArray = reals("world", "pair", "friction_node", unit="m", run=True)
    second_push: DeviceArray = reals("world", "pair", "friction_second_node", unit="m", run=True)
    second_modal: DeviceArray = reals("world", 2, "pair", "friction_second_node", unit="m", run=True)


@topic
class FrictionSolve:
    """The system of the active cells."""

    cell_slot_of: DeviceArray = integers("world", "pair", "friction_node", carried=True)
    cell_slot: DeviceArray = integers("world", "friction_pair", "cell", note="which cell", carried=True)
    cell_block: DeviceArray = integers("world", "friction_pair", 3, note="see `cell_blocks`", carried=True)
    cell_G: DeviceArray = reals(
        "world", "block_pair", "2*block_cell", "2*block_cell", unit="m/Pa", carried=True, flat=True
    )
    cell_D: DeviceArray = reals(
        "world", "block_pair", "2*block_cell", "2*block_cell", unit="m/Pa", note="G with the pressures' answer",
        carried=True, flat=True,
    )  # fmt: skip
    cell_L: DeviceArray = reals("world", "friction_pair", "2*cell", "coupled", carried=True, flat=True)
    cell_J: DeviceArray = reals("world", "friction_pair", "2*cell", "pair_mode", run=True, carried=True)
    cell_JT: DeviceArray = reals("world", "friction_pair", "pair_mode", "2*cell", note="transposed", carried=True)
    cell_bordered: DeviceArray = reals(
        "world", "friction_pair", "2*cell", "coupled", note="L with the pressures' answer", carried=True, flat=True
    )
    cell_diagonal: DeviceArray = reals(
        "world", "friction_pair", "cell", 3, unit="m/Pa", note="of K: 00, 01, 11", carried=True, flat=True
    )
    friction_receptance: DeviceArray = reals("world", "friction_retained", "friction_retained", run=True, carried=True)
    friction_receptance_rhs: DeviceArray = reals("world", "friction_retained", run=True)
    friction_receptance_column: DeviceArray = reals("world", "friction_retained", run=True)
    friction_receptance_own: DeviceArray = reals(
        "world", "friction_pair", "coupled", "coupled", note="of the columns of a pair", flat=True
    )
    cell_Y: DeviceArray = reals("world", "block_slot", "2*cell", note="pressures by tractions", flat=True)
    cell_base: DeviceArray = reals("world", "friction_pair", "2*cell", unit="Pa", flat=True)
    cell_right: DeviceArray = reals("world", "friction_pair", "2*cell", unit="m", flat=True)
    cell_tau: DeviceArray = reals("world", "friction_pair", "2*cell", unit="Pa", flat=True)
    cell_slip: DeviceArray = reals("world", "friction_pair", "2*cell", unit="m", flat=True)
    cell_radius: DeviceArray = reals("world", "friction_pair", "cell", unit="Pa")
    cell_softness: DeviceArray = reals("world", "friction_pair", "cell", unit="m/Pa")
    cell_frozen: DeviceArray = reals("world", "friction_pair", "2*cell", carried=True, flat=True)
    cell_jump: DeviceArray = reals("world", "friction_pair", "2*cell", flat=True)
    cell_direction: DeviceArray = reals("world", "friction_pair", "2*cell", carried=True, flat=True)
    cell_curvature: DeviceArray = reals("world", "friction_pair", "cell", carried=True, flat=True)
    cell_slope: DeviceArray = reals("world", "friction_pair", "cell", note="lambda, see `interior_point`", flat=True)
    cell_inside: DeviceArray = reals("world", 2)
    cell_order: DeviceArray = integers("world", "friction_pair", "2*cell", carried=True, flat=True)
    cell_sliding: DeviceArray = integers("world", "friction_pair", "2*cell", carried=True, flat=True)
    cell_outcome: DeviceArray = reals("world", 4)
    cell_start: DeviceArray = reals(
        "world", "friction_pair", "2*cell", unit="Pa", note="tractions before a step of Newton", flat=True
    )
    cell_start_slip: DeviceArray = reals("world", "friction_pair", "2*cell", unit="m", flat=True)
    cell_solution: DeviceArray = reals("world", "friction_pair", "2*cell", flat=True)
    cell_U: DeviceArray = reals(
        "world", "block_pair", "2*block_cell", "2*block_cell", note="factor of the free coordinates", carried=True,
        flat=True,
    )  # fmt: skip
    cell_W: DeviceArray = reals("world", "friction_pair", "2*cell", "coupled", carried=True, flat=True)
    cell_square: DeviceArray = reals("world", "friction_pair", "coupled", "coupled", carried=True, flat=True)
    cell_load: DeviceArray = reals("world", "friction_retained", run=True)
    cell_moved_retained: DeviceArray = reals("world", "friction_retained", run=True)
    cell_retained: DeviceArray = reals(
        "world", "friction_retained", "friction_retained", note="the retained matrix with W^T W", carried=True
    )
    cell_scaling: DeviceArray = reals("world", "friction_retained", carried=True)
    cell_pivots: DeviceArray = integers("world", "friction_retained", carried=True)
    cell_factor: DeviceArray = reals("world", "friction_factor", run=True, carried=True)
    cell_vector: DeviceArray = reals("world", 2, "friction_retained", run=True)
    cell_lines: DeviceArray = reals("world", "friction_line", run=True)
    cell_fallback: DeviceArray = integers("world", 2, note="solves by the dense elimination", carried=True)
    cell_work: DeviceArray = reals("world", "friction_retained", "friction_retained")
    cell_inverse_transposed: DeviceArray = reals(
        "world", "friction_retained", "friction_retained", run=True, carried=True
    )
    cell_shift: DeviceArray = reals("world", "friction_pair", 4, "friction_second_node", unit="m", run=True)
    cell_scaled: DeviceArray = reals("world", "friction_pair", 2, "pair_mode", run=True)
    cell_push: DeviceArray = reals("world", "mode", unit=MODAL, run=True)
    modal_drive: DeviceArray = reals("world", "mode", unit=MODAL, run=True)
    answer_node: DeviceArray = integers("world", "friction_slot", carried=True)
    answer_z: DeviceArray = reals("world", "friction_retained", run=True)
    answer_rhs: DeviceArray = reals("world", "friction_retained", run=True)
    answer_right: DeviceArray = reals("world", "friction_slot", unit="m3", flat=True)
    answer_step: DeviceArray = reals("world", "friction_slot", unit="Pa", flat=True)
    answer_moved: DeviceArray = reals("world", "friction_pair", "2*cell", unit="Pa", flat=True)
    answer_state: DeviceArray = integers("world", 4, carried=True)
    answer_change: DeviceArray = reals("world", 1, unit="Pa", carried=True)


@topic
class StripSolve:
    """Solution for the tractions by products over strips, see `rolling.strip_system`."""

    strip_laid: DeviceArray = reals("world", "strip_pair", 1, unit="m", note="W of the next", carried=True)
    strip_spectrum: DeviceArray = reals(
        "world", "strip_pair", "strip_spectrum_number", unit="m3/Pa", carried=True, flat=True
    )
    strip_work: DeviceArray = reals("world", "strip_pair", "strip_number", flat=True)
    strip_place: DeviceArray = reals("world", "strip_pair", "2*strip_place_number", flat=True)
    strip_out: DeviceArray = reals("world", "strip_pair", "2*strip_place_number", flat=True)
    strip_frame: DeviceArray = reals(
        "world", "strip_pair", "cell", 8, note="see `rolling.cell_frames`", carried=True, flat=True
    )
    strip_ready: DeviceArray = integers("world", note="1: frames and Z are those of the present L", carried=True)
    strip_residual: DeviceArray = reals("world", "strip_pair", "2*cell", unit="m", flat=True)
    strip_step: DeviceArray = reals("world", "strip_pair", "2*cell", unit="Pa", flat=True)
    strip_direction: DeviceArray = reals("world", "strip_pair", "2*cell", unit="Pa", flat=True)
    strip_image: DeviceArray = reals("world", "strip_pair", "2*cell", unit="m", flat=True)
    strip_change: DeviceArray = reals("world", "strip_pair", "2*cell", unit="Pa", note="of the tractions", flat=True)
    strip_retained: DeviceArray = reals("world", "strip_retained", note="increments along strip_direction", flat=True)


@topic
class SlipSpeedSolve:
    """The same system for coefficients that depend on the slip speed: their slopes are condensed, see `slip_speed`."""

    speed_D: DeviceArray = reals(
        "world", "speed_pair", "2*speed_cell", "2*speed_cell", unit="m/Pa", instead="cell_D", carried=True, flat=True
    )
    speed_L: DeviceArray = reals(
        "world", "speed_pair", "2*speed_cell", "coupled", instead="cell_bordered", carried=True, flat=True
    )
    speed_diagonal: DeviceArray = reals(
        "world", "speed_pair", "speed_cell", 3, unit="m/Pa", instead="cell_diagonal", carried=True, flat=True
    )
    speed_M: DeviceArray = reals(
        "world", "speed_retained", "speed_retained", run=True, instead="friction_receptance", carried=True
    )
    speed_bordered: DeviceArray = reals("world", "speed_retained", "speed_retained", instead="bordered")
    speed_own: DeviceArray = reals("world", "speed_pair", "coupled", "coupled", flat=True)
    speed_right: DeviceArray = reals("world", "speed_pair", "2*speed_cell", unit="m", instead="cell_right", flat=True)
    speed_tau: DeviceArray = reals(
        "world", "speed_pair", "2*speed_cell", unit="Pa", note="the part on the disc", instead="cell_tau", flat=True
    )
    speed_slope: DeviceArray = reals(
        "world", "speed_pair", "speed_cell", unit="Pa/m3", note="of the bound by the weak slip"
    )
    speed_drive: DeviceArray = reals("world", "speed_pair", "2*speed_cell", unit="Pa", flat=True)
    speed_line: DeviceArray = reals("world", "4*speed_cell", unit="m/Pa", note="two lines of the compliance", flat=True)
    speed_border: DeviceArray = reals("world", 2, "coupled", note="two lines of L", flat=True)
    speed_motion: DeviceArray = reals("world", 2, "speed_retained", note="retained increments by two lines", flat=True)
    speed_slip: DeviceArray = reals("world", "speed_pair", "2*speed_cell", unit="m3", note="weak, 0 of what sticks")
    speed_before: DeviceArray = reals("world", "speed_pair", "speed_cell", unit="m/s", note="of the round before")
    speed_late: DeviceArray = integers("world", 1, note="1 where late cells soften speed_K")
    speed_again: DeviceArray = integers("world", 1, note="1 where the bounds do not follow the speeds yet")
