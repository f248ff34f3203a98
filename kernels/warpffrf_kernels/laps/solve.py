r"""Forces of laps for a given motion of their bodies: contact and friction of all cells of a group, exactly.

With z the motion, p and t normal and tangential forces of a cell, g its gap and w its slip since the last accepted
state,

    (g, w) = G s + J z + (gap, -slip so far),     0 <= p, g >= 0, p g = 0,     |t| <= mu p,   t = -mu p w/|w| where w is
    not 0.

Cells have states (`forms`) in which this is linear, but for slipping ones, whose small independent numbers follow in
passes, mixed by Anderson's rule. A pass takes them to where they should be, looks at all cells, and lets those change
whose sign is wrong: of the gaps first, then stick and slip, all three of them in every third pass. A gap that closes
has the force that its own block of the tableau gives it: whether it then sticks or slips decides its state; where it
comes back time and again, the other one is tried. Cells that lie on each other to begin with are taken as pressed, so
that the first step of Newton's method does not drive the faces through each other. Tableau and states stay from one
evaluation to the next, few cells change in a step. What round-off makes of the numbers that follow is put right from
G itself every REFRESHED steps.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, sync, vec3
from warpffrf_kernels.laps.cells import put_triple
from warpffrf_kernels.laps.changes import change_cells, press_cells
from warpffrf_kernels.laps.evaluation import begin_table, book, displaced, look_at_motion, own_forces, put_right
from warpffrf_kernels.laps.loops import weigh_lines
from warpffrf_kernels.laps.passes import aim_cells, judge_cells, largest_force
from warpffrf_kernels.laps.tableau import (
    cells_of,
    columns_of,
    factorise,
    go_ahead,
    line_at,
    unknowns_of,
)
from warpffrf_kernels.laps.words import (
    AHEAD,
    COUNT,
    DONE,
    HELD,
    KNOWN,
    NONE,
    NORMAL,
    READY,
    SINCE,
    STANDS,
    TANGENTIAL,
    TURNING,
)

wp.set_module_options(MODULE_OPTIONS)

SETTLED = wp.constant(wp.float64(1.0e-11))  # of the largest force, and what it yields
ROUGHLY = wp.constant(wp.float64(1.0e-4))  # in the first iteration whose balance counts, ...
NEARLY = wp.constant(wp.float64(1.0e-7))  # ... and in the second
EARLY = wp.constant(3)  # iterations in which states change once, and the motion follows, ...
EARLY_LOADING = wp.constant(8)  # ... and of a load step, in which more of them change
UNSETTLED = wp.constant(wp.float64(0.01))  # what is told of forces whose cells have just changed
MOST_PASSES = wp.constant(150)
SAME_PLACE = wp.constant(wp.float64(1.0e-15))  # of the scene's length: what round-off leaves of a gap that is none
REFRESHED = wp.constant(25)


@wp.kernel
def look_ahead(ctl: wp.array(dtype=Control), lap_words: out(wp.array3d(dtype=int))):
    """Per (world, group): the evaluation that follows is that of a prediction."""
    w, group = wp.tid()
    if ctl[w].run != 0:
        lap_words[w, group, AHEAD] = 1


@wp.kernel
def solve_laps(
    models: wp.array(dtype=Model),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    q1: wp.array2d(dtype=real),
    lap_force: wp.array3d(dtype=real),
    lap_slip: wp.array3d(dtype=real),
    lap_gap: wp.array2d(dtype=real),
    lap_state: wp.array2d(dtype=int),
    lap_z_flat: wp.array(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    lap_words: inout(wp.array3d(dtype=int)),
    lap_z: inout(wp.array2d(dtype=real)),
    lap_step: inout(wp.array2d(dtype=real)),
    lap_mode: inout(wp.array2d(dtype=int)),
    lap_aim: inout(wp.array3d(dtype=real)),
    lap_wish: inout(wp.array2d(dtype=int)),
    lap_next: inout(wp.array3d(dtype=real)),
    lap_flips: inout(wp.array2d(dtype=int)),
    lap_u: inout(wp.array(dtype=real)),
    lap_v: inout(wp.array(dtype=real)),
    lap_target: inout(wp.array(dtype=real)),
    lap_guess: inout(wp.array(dtype=real)),
    lap_rest: inout(wp.array(dtype=real)),
    lap_list: inout(wp.array(dtype=int)),
    lap_given: inout(wp.array(dtype=real)),
    lap_base: inout(wp.array2d(dtype=int)),
    lap_base_aim: inout(wp.array3d(dtype=real)),
    lap_table: inout(wp.array(dtype=real)),
    lap_slot: inout(wp.array2d(dtype=int)),
    lap_place: inout(wp.array(dtype=int)),
    lap_owner: inout(wp.array(dtype=int)),
    lap_active: inout(wp.array(dtype=int)),
    lap_rows: inout(wp.array(dtype=real)),
    lap_units: inout(wp.array(dtype=real)),
    lap_maps: inout(wp.array(dtype=mat33)),
    lap_factor: inout(wp.array(dtype=real)),
    lap_pivot: inout(wp.array(dtype=int)),
    lap_weight: inout(wp.array(dtype=real)),
    lap_before: inout(wp.array(dtype=real)),
    lap_left: inout(wp.array(dtype=real)),
    lap_right: inout(wp.array(dtype=real)),
    lap_strip: inout(wp.array(dtype=real)),
    lap_trial: inout(wp.array(dtype=real)),
    lap_moved: out(wp.array(dtype=real)),
    lap_gradient: out(wp.array4d(dtype=real)),
    lap_push: out(wp.array2d(dtype=real)),
    lap_sum: out(wp.array2d(dtype=real)),
    lap_stored: out(wp.array2d(dtype=real)),
    lap_taken: out(wp.array3d(dtype=real)),
    lap_off: out(wp.array2d(dtype=real)),
    lap_depth: out(wp.array2d(dtype=real)),
):
    """Per (world, group): forces of all cells at the trial state, what they do to the motion, their energy."""
    w, group, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    components = model.elements[0].laps[0].components[group]
    yields = model.elements[0].laps[0].yields[group]
    n = unknowns_of(model, group)
    cells = cells_of(model, group)
    columns = columns_of(model, group)
    first = model.elements[0].laps[0].cell_start[group]
    first_column = model.elements[0].laps[0].column_start[group]
    lines = line_at(model, w, group)
    ready = lap_words[w, group, READY]
    since = lap_words[w, group, SINCE]
    ahead = lap_words[w, group, AHEAD]
    sync()
    if lane == 0:
        look_at_motion(model, w, group, r1, axes, q1, lap_gradient, lap_z, lap_step)
        lap_words[w, group, KNOWN] = -1
        lap_words[w, group, AHEAD] = 0
        c = int(0)
        while c < cells:
            lap_flips[w, first + c] = 0
            c += 1
    if lap_words[w, group, HELD] != 0:
        return
    if ready == NONE:
        begin_table(model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words)
    if ready != STANDS:
        press_cells(
            model, w, group, lane, lap_state, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words, lap_slot,
            lap_place, lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot, lap_left, lap_right,
        )  # fmt: skip
        c = lane
        while c < cells:
            s = vec3(lap_force[w, first + c, 0], lap_force[w, first + c, 1], lap_force[w, first + c, 2])
            put_triple(lap_trial, lines + components * c, components, s)
            c += wp.block_dim()
        sync()
    factorise(
        model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words, lap_slot, lap_place,
        lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot,
    )  # fmt: skip
    if ready == STANDS:
        if lane == 0:
            count = int(0)
            c = int(0)
            while c < columns:
                step = lap_step[w, first_column + c]
                if step != real(0.0):
                    lap_list[lines + count] = n + c
                    lap_given[lines + count] = step
                    count += 1
                c += 1
            lap_words[w, group, COUNT] = count
        sync()
        go_ahead(
            model, w, group, lane, lap_list, lap_given, lap_table, lap_words, lap_slot, lap_place, lap_owner,
            lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot, lap_weight, lap_before, lap_v,
        )  # fmt: skip
        if since >= REFRESHED:
            own_forces(model, w, group, lane, lap_mode, lap_aim, lap_u, lap_v, lap_trial)
    if ready != STANDS or since >= REFRESHED:
        displaced(model, w, group, lane, 1, lap_trial, lap_z_flat, lap_list, lap_strip)
        if lane == 0:
            put_right(model, w, group, lap_slip, lap_mode, lap_aim, lap_trial, lap_strip, lap_u, lap_v)
            lap_words[w, group, SINCE] = 0
        sync()
    done = int(0)
    if ahead != 0 and ready == STANDS:
        done = int(1)
    enough = SETTLED
    if ctl[w].iteration == 1:  # of an evaluation that no balance follows it is 0
        enough = ROUGHLY
    elif ctl[w].iteration == 2:
        enough = NEARLY
    least = real(0.0)
    if ready != STANDS and ctl[w].iteration == 0:
        least = SAME_PLACE * model.length / yields
    early = ctl[w].iteration >= 1 and ctl[w].iteration <= wp.where(ctl[w].mode == k.LOADING, EARLY_LOADING, EARLY)
    changed_states = int(0)
    passes = int(0)
    off = real(0.0)
    while done == 0:
        passes += 1
        change = real(0.0)
        if lane == 0:
            change = aim_cells(
                model, w, group, lap_mode, lap_aim, lap_words, lap_wish, lap_next, lap_target, lap_guess, lap_rest,
                lap_u, lap_v, lap_list, lap_given,
            )  # fmt: skip
        sync()
        factorise(
            model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words, lap_slot,
            lap_place, lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot,
        )  # fmt: skip
        go_ahead(
            model, w, group, lane, lap_list, lap_given, lap_table, lap_words, lap_slot, lap_place, lap_owner,
            lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot, lap_weight, lap_before, lap_v,
        )  # fmt: skip
        if lane == 0:
            judge_cells(
                model, w, group, lap_mode, lap_words, lap_wish, lap_next, lap_flips, lap_u, lap_v, least, lap_table,
                lap_slot, lap_place, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot, lap_weight,
            )  # fmt: skip
            changing = lap_words[w, group, NORMAL] + lap_words[w, group, TANGENTIAL] + lap_words[w, group, TURNING]
            lap_words[w, group, DONE] = 0
            off = change
            if changed_states != 0:
                off = UNSETTLED
                lap_words[w, group, DONE] = 1
            if changing == 0 and change <= enough:
                lap_words[w, group, DONE] = 1
            elif passes >= MOST_PASSES or not wp.isfinite(change):
                lap_words[w, group, DONE] = 2
            if changing > 0:
                lap_words[w, group, KNOWN] = -1
            else:
                lap_words[w, group, KNOWN] = wp.max(lap_words[w, group, KNOWN], 0)
        sync()
        done = lap_words[w, group, DONE]
        if done == 0:
            changed = change_cells(
                model, w, group, lane, passes % 3 == 0, lap_wish, lap_next, lap_mode, lap_aim, lap_u, lap_v, lap_base,
                lap_base_aim, lap_table, lap_words, lap_slot, lap_place, lap_owner, lap_active, lap_rows, lap_units,
                lap_maps, lap_factor, lap_pivot, lap_left, lap_right,
            )  # fmt: skip
            if early and changed:
                changed_states = int(1)
    if lane == 0 and done == 2:
        ctl[w].failure = ctl[w].failure | k.NOT_CONVERGED
        lap_words[w, group, READY] = NONE
    own_forces(model, w, group, lane, lap_mode, lap_aim, lap_u, lap_v, lap_trial)
    weigh_lines(
        n, columns, model.elements[0].laps[0].motion, model.elements[0].laps[0].motion_start[group], lap_trial, lines,
        lap_push, lap_sum, w * lap_push.shape[1] + first_column,
    )  # fmt: skip
    displaced(model, w, group, lane, 0, lap_trial, lap_z_flat, lap_list, lap_strip)
    if lane == 0:
        book(
            model, w, group, lap_force, lap_slip, lap_gap, lap_mode, lap_aim, lap_u, lap_v, lap_trial, lap_strip,
            lap_moved, lap_stored, lap_taken,
        )  # fmt: skip
        lap_off[w, group] = off
        lap_depth[w, group] = yields * largest_force(model, w, group, lines, lap_mode, lap_v)
