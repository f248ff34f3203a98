"""Stored quantities of small-sliding contacts after an accepted attempt, their dissipation, and saved quantities.

Slip is counted from the start of the scene and includes the sliding of cells without pressure.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.ring import SavedMatched
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.state import MatchedState
from warpffrf_kernels.matched.cells import put_triple, triple
from warpffrf_kernels.matched.forms import SLIP, SMOOTH, STICK
from warpffrf_kernels.matched.status_words import ANEW, NONE, READY, SINCE
from warpffrf_kernels.matched.tableau import cells_of, line_at

wp.set_module_options(MODULE_OPTIONS)

# --- saved numbers of a cell: forces p, t1, t2 on the second face [N], then
GAP = wp.constant(3)  # m
SLIPPED = wp.constant(4)  # slip so far along t1, t2, m
STATE = wp.constant(6)  # 0 open, 1 stick, 2 slip
LOST = wp.constant(7)  # by friction so far, J


@kernel
def keep_matched(run: Run, tableau: MatchedScratch, matched: MatchedState):
    """Per (world, group), lanes over cells: the trial forces become the accepted ones.

    After a rejected attempt the next one begins with sticking cells under pressure: a load reversal makes slipping
    cells stick, which Newton's method misses if it starts with a compliant tangent and overshoots.
    """
    w, group, lane = wp.tid()
    model = run.models[w]
    if lane == 0 and run.ctl[w].attempt != 0 and run.ctl[w].accept == 0:
        tableau.matched_words[w, group, READY] = wp.where(tableau.matched_words[w, group, READY] == NONE, NONE, ANEW)
    if run.ctl[w].accept == 0 or run.ctl[w].mode == k.PROJECT:
        return
    components = model.elements[0].matched[0].components[group]
    lines = line_at(model, w, group)
    first = model.elements[0].matched[0].cell_start[group]
    c = lane
    while c < cells_of(model, group):
        cell = first + c
        s = triple(tableau.matched_trial, lines + components * c, components)
        for i in range(3):
            matched.matched_force[w, cell, i] = s[i]
        matched.matched_gap[w, cell] = tableau.matched_moved[lines + components * c]
        state = tableau.matched_mode[w, cell]
        matched.matched_state[w, cell] = wp.where(state == SMOOTH, SLIP, state)
        c += wp.block_dim()
    if lane == 0:
        matched.matched_energy[w, group] = tableau.matched_stored[w, group]
        tableau.matched_words[w, group, SINCE] = tableau.matched_words[w, group, SINCE] + 1


@kernel
def commit_matched(run: Run, tableau: MatchedScratch, matched: MatchedState):
    """Per (world, group), lanes over cells: adds the slips of the evaluated state to the history, and resets them."""
    w, group, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].commit == 0 or model.elements[0].matched[0].components[group] == 1:
        return
    lines = line_at(model, w, group)
    first = model.elements[0].matched[0].cell_start[group]
    c = lane
    while c < cells_of(model, group):
        cell = first + c
        at = lines + 3 * c
        state = tableau.matched_mode[w, cell]
        if state != STICK:
            s = triple(tableau.matched_trial, at, 3)
            y = triple(tableau.matched_moved, at, 3)
            u = triple(tableau.matched_u, at, 3)
            v = triple(tableau.matched_v, at, 3)
            for i in range(2):
                matched.matched_slip[w, cell, i] = matched.matched_slip[w, cell, i] + y[1 + i]
            matched.matched_lost[w, cell] = matched.matched_lost[w, cell] - s[1] * y[1] - s[2] * y[2]
            v[1] = real(0.0)
            if state == SLIP:
                u[2] = u[2] - (
                    tableau.matched_target_form[w, cell, 0] * y[2] - tableau.matched_target_form[w, cell, 1] * y[1]
                )
            else:
                v[2] = real(0.0)
            put_triple(tableau.matched_u, at, 3, u)
            put_triple(tableau.matched_v, at, 3, v)
            put_triple(tableau.matched_moved, at, 3, vec3(y[0], real(0.0), real(0.0)))
        c += wp.block_dim()


@kernel
def record_matched(run: Run, matched: MatchedState, saved: SavedMatched):
    """Per (world, cell): NUMBERS of the accepted state."""
    w, cell = wp.tid()
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_matched.shape[1]
    for i in range(3):
        saved.saved_matched[w, at, cell, i] = matched.matched_force[w, cell, i]
    saved.saved_matched[w, at, cell, GAP] = matched.matched_gap[w, cell]
    saved.saved_matched[w, at, cell, SLIPPED] = matched.matched_slip[w, cell, 0]
    saved.saved_matched[w, at, cell, SLIPPED + 1] = matched.matched_slip[w, cell, 1]
    saved.saved_matched[w, at, cell, STATE] = real(matched.matched_state[w, cell])
    saved.saved_matched[w, at, cell, LOST] = matched.matched_lost[w, cell]
