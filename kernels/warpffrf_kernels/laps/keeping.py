"""Stored quantities of small-sliding contacts after an accepted attempt, their dissipation, and saved quantities.

Slip is counted from the start of the scene and includes the sliding of cells without pressure.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lap_scratch import LapScratch
from warpffrf_kernels.core.ring import SavedLaps
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.state import LapState
from warpffrf_kernels.laps.cells import put_triple, triple
from warpffrf_kernels.laps.forms import SLIP, SMOOTH, STICK
from warpffrf_kernels.laps.tableau import cells_of, line_at
from warpffrf_kernels.laps.words import ANEW, NONE, READY, SINCE

wp.set_module_options(MODULE_OPTIONS)

# --- saved numbers of a cell: forces p, t1, t2 on the second face [N], then
GAP = wp.constant(3)  # m
SLIPPED = wp.constant(4)  # slip so far along t1, t2, m
STATE = wp.constant(6)  # 0 open, 1 stick, 2 slip
LOST = wp.constant(7)  # by friction so far, J


@kernel
def keep_laps(run: Run, tableau: LapScratch, laps: LapState):
    """Per (world, group), lanes over cells: the trial forces become the accepted ones.

    After a rejected attempt the next one begins with sticking cells under pressure: a load reversal makes slipping
    cells stick, which Newton's method misses if it starts with a compliant tangent and overshoots.
    """
    w, group, lane = wp.tid()
    model = run.models[w]
    if lane == 0 and run.ctl[w].attempt != 0 and run.ctl[w].accept == 0:
        tableau.lap_words[w, group, READY] = wp.where(tableau.lap_words[w, group, READY] == NONE, NONE, ANEW)
    if run.ctl[w].accept == 0 or run.ctl[w].mode == k.PROJECT:
        return
    components = model.elements[0].laps[0].components[group]
    lines = line_at(model, w, group)
    first = model.elements[0].laps[0].cell_start[group]
    c = lane
    while c < cells_of(model, group):
        cell = first + c
        s = triple(tableau.lap_trial, lines + components * c, components)
        for i in range(3):
            laps.lap_force[w, cell, i] = s[i]
        laps.lap_gap[w, cell] = tableau.lap_moved[lines + components * c]
        state = tableau.lap_mode[w, cell]
        laps.lap_state[w, cell] = wp.where(state == SMOOTH, SLIP, state)
        c += wp.block_dim()
    if lane == 0:
        laps.lap_energy[w, group] = tableau.lap_stored[w, group]
        tableau.lap_words[w, group, SINCE] = tableau.lap_words[w, group, SINCE] + 1


@kernel
def commit_laps(run: Run, tableau: LapScratch, laps: LapState):
    """Per (world, group), lanes over cells: adds the slips of the evaluated state to the history, and resets them."""
    w, group, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].commit == 0 or model.elements[0].laps[0].components[group] == 1:
        return
    lines = line_at(model, w, group)
    first = model.elements[0].laps[0].cell_start[group]
    c = lane
    while c < cells_of(model, group):
        cell = first + c
        at = lines + 3 * c
        state = tableau.lap_mode[w, cell]
        if state != STICK:
            s = triple(tableau.lap_trial, at, 3)
            y = triple(tableau.lap_moved, at, 3)
            u = triple(tableau.lap_u, at, 3)
            v = triple(tableau.lap_v, at, 3)
            for i in range(2):
                laps.lap_slip[w, cell, i] = laps.lap_slip[w, cell, i] + y[1 + i]
            laps.lap_lost[w, cell] = laps.lap_lost[w, cell] - s[1] * y[1] - s[2] * y[2]
            v[1] = real(0.0)
            if state == SLIP:
                u[2] = u[2] - (tableau.lap_target_form[w, cell, 0] * y[2] - tableau.lap_target_form[w, cell, 1] * y[1])
            else:
                v[2] = real(0.0)
            put_triple(tableau.lap_u, at, 3, u)
            put_triple(tableau.lap_v, at, 3, v)
            put_triple(tableau.lap_moved, at, 3, vec3(y[0], real(0.0), real(0.0)))
        c += wp.block_dim()


@kernel
def record_laps(run: Run, laps: LapState, saved: SavedLaps):
    """Per (world, cell): NUMBERS of the accepted state."""
    w, cell = wp.tid()
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_lap.shape[1]
    for i in range(3):
        saved.saved_lap[w, at, cell, i] = laps.lap_force[w, cell, i]
    saved.saved_lap[w, at, cell, GAP] = laps.lap_gap[w, cell]
    saved.saved_lap[w, at, cell, SLIPPED] = laps.lap_slip[w, cell, 0]
    saved.saved_lap[w, at, cell, SLIPPED + 1] = laps.lap_slip[w, cell, 1]
    saved.saved_lap[w, at, cell, STATE] = real(laps.lap_state[w, cell])
    saved.saved_lap[w, at, cell, LOST] = laps.lap_lost[w, cell]
