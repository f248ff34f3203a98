r"""Forces of small-sliding contacts for a given motion of their bodies: exact solution for all cells of a group.

With z the motion, p and t normal and tangential forces of a cell, g its gap and w its slip since the last accepted
state,
    (g, w) = G s + J z + (gap, -slip so far),     0 <= p, g >= 0, p g = 0,     |t| <= mu p,   t = -mu p w/|w| where w is
    not 0.

Cells have states (`forms`) in which this is linear, except for slipping ones, whose small independent numbers are
updated in passes with Anderson's method. A pass sets them to their target values, checks all cells, and changes the
state of those with a wrong sign: gaps first, then stick and slip, all three of them in every third pass. A gap that
closes has the force given by its own block of the tableau: whether it would then stick or slip decides its state; if it
recurs, the other state is tried. Cells initially in contact are treated as pressed, so the first Newton step does not
drive the faces through each other. Tableau and states are kept between evaluations, since few cells change in a step.
Round-off in the dependent numbers is removed with G itself every REFRESHED steps.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import MatchedState
from warpffrf_kernels.matched.cells import put_triple
from warpffrf_kernels.matched.changes import change_cells, press_cells
from warpffrf_kernels.matched.evaluation import begin_table, book, displaced, look_at_motion, own_forces, put_right
from warpffrf_kernels.matched.loops import weigh_lines
from warpffrf_kernels.matched.passes import aim_cells, judge_cells, largest_force
from warpffrf_kernels.matched.status_words import (
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
from warpffrf_kernels.matched.tableau import cells_of, columns_of, factorise, go_ahead, line_at, unknowns_of

wp.set_module_options(MODULE_OPTIONS)

SETTLED = wp.constant(wp.float64(1.0e-11))  # of the largest force, and of its displacement
ROUGHLY = wp.constant(wp.float64(1.0e-4))  # in the first iteration whose balance counts, ...
NEARLY = wp.constant(wp.float64(1.0e-7))  # ... and in the second
EARLY = wp.constant(3)  # iterations in which states change once, and the motion follows, ...
EARLY_LOADING = wp.constant(8)  # ... and in a load step, in which more of them change
UNSETTLED = wp.constant(wp.float64(0.01))  # reported defect of forces whose cells have just changed
MOST_PASSES = wp.constant(150)
SAME_PLACE = wp.constant(wp.float64(1.0e-15))  # of the scene's length: round-off of a closed gap
REFRESHED = wp.constant(25)


@kernel
def look_ahead(run: Run, tableau: MatchedScratch):
    """Per (world, group): marks the next evaluation as that of a prediction."""
    w, group = wp.tid()
    if run.ctl[w].run != 0:
        tableau.matched_words[w, group, AHEAD] = 1


@kernel
def solve_matched(
    run: Run, trial: Trial, matched: MatchedState, tableau: MatchedScratch, q1: wp.array2d(dtype=real),
    matched_z_flat: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, group): forces of all cells at the trial state, their loads on the motion, and their energy."""
    w, group, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    components = model.elements[0].matched[0].components[group]
    yields = model.elements[0].matched[0].yields[group]
    n = unknowns_of(model, group)
    cells = cells_of(model, group)
    columns = columns_of(model, group)
    first = model.elements[0].matched[0].cell_start[group]
    first_column = model.elements[0].matched[0].column_start[group]
    lines = line_at(model, w, group)
    ready = tableau.matched_words[w, group, READY]
    since = tableau.matched_words[w, group, SINCE]
    ahead = tableau.matched_words[w, group, AHEAD]
    sync()
    if lane == 0:
        look_at_motion(model, w, group, trial, q1, tableau)
        tableau.matched_words[w, group, KNOWN] = -1
        tableau.matched_words[w, group, AHEAD] = 0
        c = int(0)
        while c < cells:
            tableau.matched_reversals[w, first + c] = 0
            c += 1
    if tableau.matched_words[w, group, HELD] != 0:
        return
    # tableau: new, or with the states of the accepted forces
    if ready == NONE:
        begin_table(model, w, group, lane, tableau)
    if ready != STANDS:
        press_cells(model, w, group, lane, matched, tableau)
        c = lane
        while c < cells:
            s = vec3(
                matched.matched_force[w, first + c, 0],
                matched.matched_force[w, first + c, 1],
                matched.matched_force[w, first + c, 2],
            )
            put_triple(tableau.matched_trial, lines + components * c, components, s)
            c += wp.block_dim()
        sync()
    # change of the motion since the last evaluation, and removal of round-off
    factorise(model, w, group, lane, tableau)
    if ready == STANDS:
        if lane == 0:
            count = int(0)
            c = int(0)
            while c < columns:
                step = tableau.matched_step[w, first_column + c]
                if step != real(0.0):
                    tableau.matched_list[lines + count] = n + c
                    tableau.matched_given[lines + count] = step
                    count += 1
                c += 1
            tableau.matched_words[w, group, COUNT] = count
        sync()
        go_ahead(model, w, group, lane, tableau)
        if since >= REFRESHED:
            own_forces(model, w, group, lane, tableau)
    if ready != STANDS or since >= REFRESHED:
        displaced(model, w, group, lane, 1, tableau, matched_z_flat)
        if lane == 0:
            put_right(model, w, group, matched, tableau)
            tableau.matched_words[w, group, SINCE] = 0
        sync()
    # passes over the cells until states and independent numbers have converged
    done = int(0)
    if ahead != 0 and ready == STANDS:
        done = int(1)
    enough = SETTLED
    if run.ctl[w].iteration == 1:  # of an evaluation that no balance follows it is 0
        enough = ROUGHLY
    elif run.ctl[w].iteration == 2:
        enough = NEARLY
    least = real(0.0)
    if ready != STANDS and run.ctl[w].iteration == 0:
        least = SAME_PLACE * model.length / yields
    early = run.ctl[w].iteration >= 1 and run.ctl[w].iteration <= wp.where(
        run.ctl[w].mode == k.LOADING, EARLY_LOADING, EARLY
    )
    changed_states = int(0)
    passes = int(0)
    off = real(0.0)
    while done == 0:
        passes += 1
        change = real(0.0)
        if lane == 0:
            change = aim_cells(model, w, group, tableau)
        sync()
        factorise(model, w, group, lane, tableau)
        go_ahead(model, w, group, lane, tableau)
        if lane == 0:
            judge_cells(model, w, group, tableau, least)
            changing = (
                tableau.matched_words[w, group, NORMAL]
                + tableau.matched_words[w, group, TANGENTIAL]
                + tableau.matched_words[w, group, TURNING]
            )
            tableau.matched_words[w, group, DONE] = 0
            off = change
            if changed_states != 0:
                off = UNSETTLED
                tableau.matched_words[w, group, DONE] = 1
            if changing == 0 and change <= enough:
                tableau.matched_words[w, group, DONE] = 1
            elif passes >= MOST_PASSES or not wp.isfinite(change):
                tableau.matched_words[w, group, DONE] = 2
            if changing > 0:
                tableau.matched_words[w, group, KNOWN] = -1
            else:
                tableau.matched_words[w, group, KNOWN] = wp.max(tableau.matched_words[w, group, KNOWN], 0)
        sync()
        done = tableau.matched_words[w, group, DONE]
        if done == 0:
            changed = change_cells(model, w, group, lane, passes % 3 == 0, tableau)
            if early and changed:
                changed_states = int(1)
    if lane == 0 and done == 2:
        run.ctl[w].failure = run.ctl[w].failure | k.NOT_CONVERGED
        tableau.matched_words[w, group, READY] = NONE
    # forces of the cells, their loads on the motion, and the energies
    own_forces(model, w, group, lane, tableau)
    weigh_lines(
        n, columns, model.elements[0].matched[0].motion, model.elements[0].matched[0].motion_start[group],
        tableau.matched_trial,
        lines, tableau.matched_push, tableau.matched_sum, w * tableau.matched_push.shape[1] + first_column,
    )  # fmt: skip
    displaced(model, w, group, lane, 0, tableau, matched_z_flat)
    if lane == 0:
        book(model, w, group, matched, tableau)
        tableau.matched_off[w, group] = off
        tableau.matched_depth[w, group] = yields * largest_force(model, w, group, lines, tableau)
