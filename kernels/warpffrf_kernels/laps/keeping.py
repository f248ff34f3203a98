"""What laps keep of an accepted attempt, what they lose, and what of them is saved.

Slip is counted from where the scene begins; what a cell without pressure slides is part of it.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.laps.cells import put_triple, triple
from warpffrf_kernels.laps.forms import SLIP, SMOOTH, STICK
from warpffrf_kernels.laps.tableau import cells_of, line_at
from warpffrf_kernels.laps.words import ANEW, NONE, READY, SINCE

wp.set_module_options(MODULE_OPTIONS)

# --- numbers of a cell that are saved: forces p, t1, t2 on the second face [N], then
GAP = wp.constant(3)  # m
SLIPPED = wp.constant(4)  # slip so far along t1, t2, m
STATE = wp.constant(6)  # 0 open, 1 stick, 2 slip
LOST = wp.constant(7)  # by friction so far, J
NUMBERS = 8


@wp.kernel
def keep_laps(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    lap_mode: wp.array2d(dtype=int),
    lap_trial: wp.array(dtype=real),
    lap_moved: wp.array(dtype=real),
    lap_stored: wp.array2d(dtype=real),
    lap_words: inout(wp.array3d(dtype=int)),
    lap_force: out(wp.array3d(dtype=real)),
    lap_gap: out(wp.array2d(dtype=real)),
    lap_state: out(wp.array2d(dtype=int)),
    lap_energy: out(wp.array2d(dtype=real)),
):
    """Per (world, group), lanes over cells: the trial forces become the accepted ones.

    After a rejected attempt the next one begins with cells under pressure sticking: a load that
    turns back makes slipping cells stick, which Newton's method misses where it begins soft and goes too far.
    """
    w, group, lane = wp.tid()
    model = models[w]
    if lane == 0 and ctl[w].attempt != 0 and ctl[w].accept == 0:
        lap_words[w, group, READY] = wp.where(lap_words[w, group, READY] == NONE, NONE, ANEW)
    if ctl[w].accept == 0 or ctl[w].mode == k.PROJECT:
        return
    components = model.elements[0].laps[0].components[group]
    lines = line_at(model, w, group)
    first = model.elements[0].laps[0].cell_start[group]
    c = lane
    while c < cells_of(model, group):
        cell = first + c
        s = triple(lap_trial, lines + components * c, components)
        for i in range(3):
            lap_force[w, cell, i] = s[i]
        lap_gap[w, cell] = lap_moved[lines + components * c]
        state = lap_mode[w, cell]
        lap_state[w, cell] = wp.where(state == SMOOTH, SLIP, state)
        c += wp.block_dim()
    if lane == 0:
        lap_energy[w, group] = lap_stored[w, group]
        lap_words[w, group, SINCE] = lap_words[w, group, SINCE] + 1


@wp.kernel
def commit_laps(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    lap_mode: wp.array2d(dtype=int),
    lap_aim: wp.array3d(dtype=real),
    lap_trial: wp.array(dtype=real),
    lap_moved: inout(wp.array(dtype=real)),
    lap_u: inout(wp.array(dtype=real)),
    lap_v: inout(wp.array(dtype=real)),
    lap_slip: inout(wp.array3d(dtype=real)),
    lap_lost: inout(wp.array2d(dtype=real)),
):
    """Per (world, group), lanes over cells: slips of the evaluated state become history, and begin anew."""
    w, group, lane = wp.tid()
    model = models[w]
    if ctl[w].commit == 0 or model.elements[0].laps[0].components[group] == 1:
        return
    lines = line_at(model, w, group)
    first = model.elements[0].laps[0].cell_start[group]
    c = lane
    while c < cells_of(model, group):
        cell = first + c
        at = lines + 3 * c
        state = lap_mode[w, cell]
        if state != STICK:
            s = triple(lap_trial, at, 3)
            y = triple(lap_moved, at, 3)
            u = triple(lap_u, at, 3)
            v = triple(lap_v, at, 3)
            for i in range(2):
                lap_slip[w, cell, i] = lap_slip[w, cell, i] + y[1 + i]
            lap_lost[w, cell] = lap_lost[w, cell] - s[1] * y[1] - s[2] * y[2]
            v[1] = real(0.0)
            if state == SLIP:
                u[2] = u[2] - (lap_aim[w, cell, 0] * y[2] - lap_aim[w, cell, 1] * y[1])
            else:
                v[2] = real(0.0)
            put_triple(lap_u, at, 3, u)
            put_triple(lap_v, at, 3, v)
            put_triple(lap_moved, at, 3, vec3(y[0], real(0.0), real(0.0)))
        c += wp.block_dim()


@wp.kernel
def record_laps(
    ctl: wp.array(dtype=Control),
    lap_force: wp.array3d(dtype=real),
    lap_gap: wp.array2d(dtype=real),
    lap_slip: wp.array3d(dtype=real),
    lap_state: wp.array2d(dtype=int),
    lap_lost: wp.array2d(dtype=real),
    saved_lap: out(wp.array4d(dtype=real)),
):
    """Per (world, cell): NUMBERS of the accepted state."""
    w, cell = wp.tid()
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % saved_lap.shape[1]
    for i in range(3):
        saved_lap[w, at, cell, i] = lap_force[w, cell, i]
    saved_lap[w, at, cell, GAP] = lap_gap[w, cell]
    saved_lap[w, at, cell, SLIPPED] = lap_slip[w, cell, 0]
    saved_lap[w, at, cell, SLIPPED + 1] = lap_slip[w, cell, 1]
    saved_lap[w, at, cell, STATE] = real(lap_state[w, cell])
    saved_lap[w, at, cell, LOST] = lap_lost[w, cell]
