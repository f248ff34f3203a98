"""Friction of the pairs that have it: cells, slip and tractions, and the solution for stick and slip.

Within one Newton iteration the tractions are solved for once the pressures and their active set have converged. Bodies,
modes, joints and the pressures of that set are condensed into them. The solution alternates with updates of the bounds,
which follow the pressures.
"""

from __future__ import annotations

from warpffrf.online.step.launches import Launch, blocks, once, threads
from warpffrf.online.step.phases import Loop, Participant
from warpffrf_kernels.friction import (
    cell_compliance,
    cell_forces,
    cell_shares,
    cells,
    entering_cells,
    history,
    patch_advance,
    pressure_response,
    receptance,
    slip_speed,
    slope_condensation,
    stick_slip_problem,
    tangential_fields,
    traction_bounds,
)
from warpffrf_kernels.rolling import (
    couple,
    entering,
    fields,
    places,
    shear,
    spline_tables,
    strips,
    system,
    traction_solve,
)
from warpffrf_kernels.rolling import history as rolling_history

GRID = "grid_rubbing"  # pairs whose cells are fixed to the material of the first surface
ROLLING = "rolling_pair"  # pairs whose cells are contact-fixed
STRIPS = "strip_pair"  # tractions by products over strips
SPEED = "speed_pair"  # pairs whose coefficient depends on the slip speed
LIMITS = {"radius": "cell_radius", "softness": "cell_softness"}


def bounds(of_state: int) -> list[Launch]:
    """mu p of the cells, of the state or of the pressures just found; tractions are limited by that of the state."""
    return [
        blocks(traction_bounds.bound_cells, "pair", when=GRID, clip=of_state),
        blocks(places.bound_patch_cells, "pair", when=ROLLING, clip=of_state),
        blocks(entering_cells.soften_late, "pair", when=GRID, of_state=of_state),
        blocks(entering.soften_entering, "pair", when=ROLLING, of_state=of_state),
    ]


def press(pressure: str, load: str, of_state: int) -> Launch:
    """Tangential displacements due to pressures, or to changes of them."""
    return blocks(
        tangential_fields.press_cells, "pair", when=GRID, pressure=pressure, second_load=load, of_state=of_state
    )


RUB = [
    blocks(stick_slip_problem.limit_tractions, "friction_pair"),
    blocks(slope_condensation.condense_slopes, when=SPEED),
    blocks(slope_condensation.pose_slopes, when=SPEED),
    blocks(traction_solve.solve_tractions, **LIMITS),
    blocks(slip_speed.split_tractions, when=SPEED),
    blocks(fields.open_by_change, "pair", when=ROLLING),
    blocks(pressure_response.pose_answer),
    blocks(pressure_response.press_with_tractions),
    threads(slip_speed.keep_following, when=SPEED),
    *bounds(0),
    once(pressure_response.count_rounds),
]  # fmt: skip

FRICTION = Participant(
    "friction",
    when="friction_pair",
    predict=[threads(slip_speed.open_attempt, "pair", when=SPEED)],
    cells=[
        threads(cells.open_cells, "pair", when=GRID),
        blocks(rolling_history.extrapolate_tractions, "pair", when=ROLLING),
        threads(places.open_patch_cells, "pair", when=ROLLING),
        blocks(shear.lay_shear, "pair", when=ROLLING),
        blocks(places.place_patch_cells, "pair", when=ROLLING),
        blocks(strips.lay_spectrum, "pair", when=STRIPS),
        blocks(spline_tables.lay_splines_along, "pair", when=ROLLING),
        blocks(cells.place_cells, "pair", when=GRID),
        blocks(cell_shares.spread_cells, "pair", when=GRID),
        *bounds(1),
        blocks(tangential_fields.force_cells, "pair", when=GRID),
        blocks(tangential_fields.push_gaps, "pair", when=GRID),
        blocks(fields.load_along, "pair", when=ROLLING),
    ],
    displace=[blocks(tangential_fields.add_push, "pair", when=GRID), blocks(fields.open_gaps, "pair", when=ROLLING)],
    slide=[
        press("base", "second_load", of_state=1),
        blocks(tangential_fields.rub_cells, "pair", when=GRID),
        blocks(tangential_fields.displace_cells, "pair", when=GRID),
        blocks(fields.move_cells, "pair", when=ROLLING),
        blocks(cell_forces.slide_cells, "pair", when=GRID),
        blocks(rolling_history.slide_patch_cells, "pair", when=ROLLING),
        blocks(slip_speed.follow_slips, "pair", when=SPEED),
        blocks(cell_forces.clear_modes, "pair"),
        blocks(cell_forces.load_tractions, "pair", when=GRID),
        blocks(fields.load_modes_along, "pair", when=ROLLING),
    ],
    sum=[blocks(cell_forces.add_friction), threads(rolling_history.mean_work, "pair", when=ROLLING)],
    solve_tangential=[
        *bounds(0),
        blocks(tangential_fields.change_pressures, "pair", when=GRID),
        blocks(cell_compliance.take_cells),
        blocks(cell_compliance.cell_modes, "friction_pair", when=GRID),
        blocks(cell_compliance.assemble_cells, "friction_pair", when=GRID),
        blocks(system.modes_of_cells, "friction_pair", when=ROLLING),
        blocks(system.assemble_patch_cells, "friction_pair", when=ROLLING),
        blocks(cell_compliance.retained_cells, "friction_pair"),
        blocks(pressure_response.open_answer),
        blocks(pressure_response.answer_by_modes, "friction_pair"),
        blocks(pressure_response.answer_on_grid, "friction_pair", when=GRID),
        blocks(pressure_response.reduce_answer, "friction_pair"),
        blocks(pressure_response.condense_answer, "friction_pair"),
        blocks(receptance.invert_retained),
        blocks(receptance.diagonal_blocks, "block_pair"),
        blocks(traction_solve.soften_patches, "strip_pair"),
        press("pressure_change", "load_change", of_state=0),
        blocks(tangential_fields.shift_slips, "pair", when=GRID),
        blocks(fields.press_slips, "pair", when=ROLLING),
        blocks(stick_slip_problem.drive_modes),
        blocks(stick_slip_problem.pose_tractions, "friction_pair"),
        blocks(traction_solve.take_off_base),
        blocks(slip_speed.begin_slips, "speed_pair", when=SPEED),
        Loop("rubbing", RUB),
        blocks(stick_slip_problem.take_tractions),
        blocks(couple.follow_couples, when=ROLLING),
    ],
    recover=[blocks(stick_slip_problem.push_modes)],
    keep=[
        threads(patch_advance.follow_patch, "pair", when=GRID),
        blocks(history.keep_slips, "pair", when=GRID),
        blocks(entering_cells.keep_pressed, "pair", when=GRID),
        blocks(rolling_history.keep_rings, "pair", when=ROLLING),
        threads(rolling_history.keep_traction_change, "pair", when=ROLLING),
        threads(slip_speed.mark, "pair", when=SPEED),
    ],
    measure=[threads(history.add_friction_second, "pair")],
    record=[blocks(history.record_friction, "pair")],
)
