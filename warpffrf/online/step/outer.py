"""The outer linear system: bodies, modes with inertia and rows; its increments, and the loop that they end."""

from __future__ import annotations

from warpffrf_kernels.bodies import inertia, motion
from warpffrf_kernels.constraints import geometric_stiffness
from warpffrf_kernels.impulsive import impulsive_contact
from warpffrf_kernels.linear import outer, sparse_outer
from warpffrf_kernels.normal import contact_solve
from warpffrf_kernels.step import balance

from warpffrf.online.step.launches import blocks, once, threads
from warpffrf.online.step.phases import Participant

INTERFACES = {"motion": "interface_motion"}

OUTER = Participant(
    "outer",
    load=[
        blocks(outer.add_multipliers, when="dense_row"),
        blocks(sparse_outer.pull, when="sparse_row"),
    ],
    balance=[threads(balance.balance, history="residual_history")],
    assemble=[
        blocks(outer.condense, when="dense_outer"),
        blocks(sparse_outer.condense_sparse, when="sparse_outer"),
        blocks(inertia.couple_modes, when="dense"),
        threads(geometric_stiffness.stiffen, when="row", **INTERFACES),
        blocks(motion.add_held, when="pair"),
        threads(geometric_stiffness.stiffen_applied, when="applied", **INTERFACES),
    ],
    eliminate=[
        blocks(outer.factor_outer, when="dense_outer", work="elimination"),
        blocks(
            sparse_outer.solve_outer, when="sparse_outer", factor="sparse_factor", vector="sparse_vector",
            lines="sparse_lines", work="elimination", z="z_free",
        ),
    ],
    increase=[
        blocks(contact_solve.modal_increments, when="mode"),
        blocks(impulsive_contact.push_further, when="dynamic_mode", push="modal_push"),
    ],
    advance=[
        blocks(outer.advance_outer),
        blocks(outer.advance_rest, when="row_or_mode"),
        once(outer.count_iteration, any_running="running"),
    ],
)  # fmt: skip
