"""Friction of the pairs that have any: cells, slip and tractions, and the solve for stick and slip.

Within one Newton iteration the tractions are solved for when the pressures and their active set have settled, with
bodies, modes, joints and the pressures of that set condensed into them, and in rounds with the bounds, which follow the
pressures.
"""

from __future__ import annotations

from warpffrf_kernels import (
    friction_advance,
    friction_bounds,
    friction_compliance,
    friction_fields,
    friction_forces,
    friction_geometry,
    friction_keep,
    friction_late,
    friction_normal,
    friction_problem,
    friction_shares,
    friction_solve,
    shared_surface,
)

from warpffrf.online.step.launches import Launch, blocks, once, threads
from warpffrf.online.step.phases import Loop, Participant

SHARED = "shared_friction_pair"
G, K, L, J, V, Y = ({letter: f"cell_{letter}"} for letter in "GKLJVY")
TAU, BASE, RIGHT = {"tau": "cell_tau"}, {"base": "cell_base"}, {"right": "cell_right"}
LIMITS = {"radius": "cell_radius", "softness": "cell_softness"}
STEP, SCALED = {"step": "answer_step"}, {"scratch": "cell_scaled"}
OWN = ("slip", "direction", "frozen", "curvature", "order", "sliding", "outcome", "solution", "work")


def bounds(of_state: int) -> list[Launch]:
    """mu p of the cells, of the state or of the pressures just found; with those of the state tractions are cut."""
    return [
        blocks(friction_bounds.bound_cells, "pair", clip=of_state),
        blocks(friction_late.soften_late, "pair", of_state=of_state, last_normal="contact_normal"),
    ]


def press(pressure: str, load: str, of_state: int) -> list[Launch]:
    """What pressures, or changes of them, move along the surfaces."""
    given = {"pressure": pressure, "of_state": of_state}
    return [
        blocks(friction_fields.press_cells, "pair", second_load=load, **given),
        blocks(shared_surface.share_shift, "pair", when=SHARED, load=load, **given),
    ]


RUB = [
    blocks(friction_problem.limit_tractions, **LIMITS),
    blocks(
        friction_solve.solve_tractions, jumps="cell_jump", **K, **RIGHT, **LIMITS, **TAU,
        **{name: f"cell_{name}" for name in OWN},
    ),
    blocks(
        friction_normal.press_with_tractions, tau_base="cell_base", change="answer_change", **Y, **TAU, **STEP
    ),
    *bounds(0),
    once(friction_normal.count_rounds, again="rubbing"),
]  # fmt: skip

FRICTION = Participant(
    "friction",
    when="friction_pair",
    remember=[blocks(friction_keep.remember_tractions, "pair")],
    cells=[
        threads(friction_geometry.open_cells, "pair"),
        blocks(friction_geometry.place_cells, "pair"),
        blocks(friction_shares.spread_cells, "pair"),
        *bounds(1),
        blocks(friction_fields.push_gaps, "pair"),
        blocks(shared_surface.share_push, "pair", when=SHARED),
    ],
    displace=[blocks(friction_fields.add_push, "pair")],
    slide=[
        *press("base", "second_load", of_state=1),
        blocks(friction_fields.displace_cells, "pair", amplitude="q1"),
        blocks(friction_forces.slide_cells, "pair"),
        blocks(friction_forces.load_tractions, "pair"),
    ],
    sum=[threads(friction_forces.add_friction)],
    stick=[
        *bounds(0),
        blocks(friction_fields.change_pressures, "pair"),
        threads(friction_compliance.take_cells),
        blocks(friction_compliance.cell_modes),
        blocks(friction_compliance.assemble_cells, shift="cell_shift", **SCALED, **G),
        blocks(friction_compliance.outer_cells),
        blocks(friction_normal.answer_tractions, shift="second_shift", **SCALED, **Y),
        blocks(friction_compliance.condense_cells, **G, **L, **V, **K),
        blocks(friction_normal.condense_answer, **Y, **K),
        *press("pressure_change", "load_change", of_state=0),
        blocks(friction_problem.drive_modes),
        blocks(friction_problem.pose_tractions, **K, **L, **J, **BASE, **RIGHT, **TAU),
        Loop("rubbing", RUB),
        blocks(friction_problem.take_tractions, **TAU, **BASE, **V),
        blocks(friction_normal.move_with_answer, **STEP),
    ],
    answer=[blocks(friction_problem.push_modes, push="cell_push", **TAU, **BASE, **J)],
    keep=[
        threads(friction_advance.follow_patch, "pair"),
        blocks(friction_keep.keep_tractions, "pair"),
        blocks(friction_late.keep_pressed, "pair"),
    ],
    record=[blocks(friction_keep.record_friction, "pair")],
)
