"""Friction of the pairs that have any: cells, slip and tractions, and the solve for stick and slip.

Within one Newton iteration the tractions are solved for when the pressures and their active set have settled, with
bodies, modes, joints and the pressures of that set condensed into them, and in rounds with the bounds, which follow the
pressures.
"""

from __future__ import annotations

from warpffrf_kernels.friction import (
    cell_compliance,
    cell_forces,
    cell_shares,
    cells,
    entering_cells,
    history,
    patch_advance,
    pressure_answer,
    slip_speed,
    stick_slip_problem,
    stick_slip_solve,
    tangential_fields,
    traction_bounds,
)

from warpffrf.online.step.launches import Launch, blocks, once, threads
from warpffrf.online.step.outer import FACTOR
from warpffrf.online.step.phases import Loop, Participant

SPEED = "speed_pair"  # where a coefficient depends on the slip speed
G, K, L, J, V, Y = ({letter: f"cell_{letter}"} for letter in "GKLJVY")
TAU, BASE, RIGHT = {"tau": "cell_tau"}, {"base": "cell_base"}, {"right": "cell_right"}
SYSTEM = {"K": "speed_K", "right": "speed_right", "tau": "speed_tau"}  # K, RIGHT and TAU where no slopes are condensed
LIMITS = {"radius": "cell_radius", "softness": "cell_softness"}
STEP, SCALED = {"step": "answer_step"}, {"scratch": "cell_scaled"}
OWN = ("slip", "direction", "frozen", "curvature", "order", "sliding", "outcome", "solution", "work")


def bounds(of_state: int) -> list[Launch]:
    """mu p of the cells, of the state or of the pressures just found; with those of the state tractions are cut."""
    return [
        blocks(traction_bounds.bound_cells, "pair", clip=of_state),
        blocks(entering_cells.soften_late, "pair", of_state=of_state, last_normal="contact_normal"),
    ]


def press(pressure: str, load: str, of_state: int) -> Launch:
    """What pressures, or changes of them, move along the surfaces."""
    return blocks(tangential_fields.press_cells, "pair", pressure=pressure, second_load=load, of_state=of_state)


RUB = [
    blocks(stick_slip_problem.limit_tractions, **LIMITS),
    blocks(slip_speed.condense_slopes, when=SPEED, **G, **K, **RIGHT, **TAU, **LIMITS),
    blocks(
        stick_slip_solve.solve_tractions, jumps="cell_jump", **SYSTEM, **LIMITS,
        **{name: f"cell_{name}" for name in OWN},
    ),
    blocks(slip_speed.split_tractions, when=SPEED, radius="cell_radius", found="cell_slip", **TAU),
    blocks(
        pressure_answer.press_with_tractions, tau_base="cell_base", change="answer_change", z_change="answer_z",
        **Y, **V, **TAU, **STEP,
    ),
    threads(slip_speed.keep_following, when=SPEED),
    *bounds(0),
    once(pressure_answer.count_rounds, again="rubbing"),
]  # fmt: skip

FRICTION = Participant(
    "friction",
    when="friction_pair",
    predict=[threads(slip_speed.open_attempt, "pair", when=SPEED)],
    cells=[
        threads(cells.open_cells, "pair"),
        blocks(cells.place_cells, "pair"),
        blocks(cell_shares.spread_cells, "pair"),
        *bounds(1),
        blocks(tangential_fields.force_second, "pair"),
        blocks(tangential_fields.push_gaps, "pair"),
    ],
    displace=[blocks(tangential_fields.add_push, "pair")],
    slide=[
        press("base", "second_load", of_state=1),
        blocks(tangential_fields.rub_cells, "pair"),
        blocks(tangential_fields.displace_cells, "pair", amplitude="q1"),
        blocks(cell_forces.slide_cells, "pair"),
        blocks(slip_speed.follow_slips, "pair", when=SPEED),
        blocks(cell_forces.load_tractions, "pair"),
    ],
    sum=[threads(cell_forces.add_friction)],
    stick=[
        *bounds(0),
        blocks(tangential_fields.change_pressures, "pair"),
        threads(cell_compliance.take_cells),
        blocks(cell_compliance.cell_modes),
        blocks(cell_compliance.assemble_cells, shift="cell_shift", **SCALED, **G),
        blocks(cell_compliance.outer_cells),
        blocks(pressure_answer.answer_tractions, shift="second_shift", **SCALED, **Y),
        blocks(
            pressure_answer.border_cells,
            matrix="bordered",
            bordered="cell_bordered",
            right="mobility_rhs",
            column="mobility_column",
            **L,
            **Y,
            **V,
            **FACTOR,
        ),  # fmt: skip
        blocks(cell_compliance.condense_cells, L="cell_bordered", **G, **V, **K),
        blocks(pressure_answer.condense_answer, **Y, **K),
        press("pressure_change", "load_change", of_state=0),
        blocks(stick_slip_problem.drive_modes),
        blocks(stick_slip_problem.pose_tractions, **K, **L, **J, **BASE, **RIGHT, **TAU),
        blocks(slip_speed.begin_slips, when=SPEED),
        Loop("rubbing", RUB),
        blocks(stick_slip_problem.take_tractions, **TAU, **BASE, **V),
    ],
    answer=[blocks(stick_slip_problem.push_modes, push="cell_push", **TAU, **BASE, **J)],
    keep=[
        threads(patch_advance.follow_patch, "pair"),
        blocks(history.keep_slips, "pair"),
        blocks(entering_cells.keep_pressed, "pair"),
        threads(slip_speed.mark, "pair", when=SPEED),
    ],
    measure=[threads(history.add_friction_second, "pair")],
    record=[blocks(history.record_friction, "pair")],
)
