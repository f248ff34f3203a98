"""The retained linear system (bodies, modes with inertia, rows), its increments, and the loop that they end."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, once
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.bodies import inertia, mean_work, membrane
from warpffrf_kernels.impulsive import impulsive_contact
from warpffrf_kernels.linear import geometric_stiffness, retained, retained_solve
from warpffrf_kernels.normal import contact_solve
from warpffrf_kernels.step import balance

OUTER = Participant(
    "retained",
    load=[blocks(retained.pull, when="row")],
    balance=[blocks(balance.balance)],
    unbalanced=[once(retained.find_unbalanced)],
    assemble=[
        blocks(retained.condense),
        blocks(inertia.couple_modes, when="inertia_mode"),
        blocks(membrane.stiffen_membranes, when="square_mode"),
        blocks(mean_work.couple_pulls, when="stiffened_row"),
        blocks(geometric_stiffness.stiffen, when='row'),
        blocks(geometric_stiffness.stiffen_applied, when='applied'),
    ],
    eliminate=[blocks(retained_solve.solve_retained, when='free_retained')],
    increase=[
        blocks(contact_solve.modal_increments, when="mode"),
        blocks(impulsive_contact.push_further, when='dynamic_mode'),
    ],
    advance=[
        blocks(retained.advance_retained),
        blocks(retained.advance_rest, when="row_or_mode"),
        once(retained.count_iteration),
    ],
)  # fmt: skip
