"""Start of an evaluation of small-sliding contacts: the motion, the tableau, and numbers of cells from their forces."""

import warp as wp

from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import MatchedState
from warpffrf_kernels.matched.cells import form_of, put_triple, set_form, triple
from warpffrf_kernels.matched.forms import OPEN, Form, first_of, forces_of, moved_of, second_of, to_form
from warpffrf_kernels.matched.loops import add_columns
from warpffrf_kernels.matched.motion import WRENCH, relative_motion, rigid_gradient, turn_gradient
from warpffrf_kernels.matched.status_words import FACTORED, ROOM
from warpffrf_kernels.matched.tableau import cells_of, columns_of, line_at, lines_of, most_of, table_at, unknowns_of

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def look_at_motion(model: Model, w: int, group: int, trial: Trial, q1: wp.array2d(dtype=real), tableau: MatchedScratch):
    """z of the trial state, its change, and the gradients of its rigid part; by one lane."""
    contact = model.elements[0].matched[0].matched_start[group]
    while contact < model.elements[0].matched[0].matched_start[group + 1]:
        at = model.elements[0].matched[0].rigid_column[contact]
        if at >= 0:
            seen = relative_motion(model, w, contact, trial)
            for i in range(3):
                tableau.matched_step[w, at + i] = seen.d[i] - tableau.matched_z[w, at + i]
                tableau.matched_step[w, at + 3 + i] = seen.theta[i] - tableau.matched_z[w, at + 3 + i]
                tableau.matched_z[w, at + i] = seen.d[i]
                tableau.matched_z[w, at + 3 + i] = seen.theta[i]
            for i in range(WRENCH):
                d = rigid_gradient(seen, i)
                theta = turn_gradient(seen, i)
                for c in range(3):
                    tableau.matched_gradient[w, contact, c, i] = d[c]
                    tableau.matched_gradient[w, contact, 3 + c, i] = theta[c]
        contact += 1
    at = model.elements[0].matched[0].column_start[group]
    while at < model.elements[0].matched[0].column_start[group + 1]:
        mode = model.elements[0].matched[0].column_mode[at]
        if mode >= 0:
            tableau.matched_step[w, at] = q1[w, mode] - tableau.matched_z[w, at]
            tableau.matched_z[w, at] = q1[w, mode]
        at += 1


@wp.func
def displaced(
    model: Model,
    w: int,
    group: int,
    lane: int,
    with_forces: int,
    tableau: MatchedScratch,
    matched_z: wp.array(dtype=real),
):
    """J z, and with forces G s, at all lines of cells, into `matched_strip`."""
    n = unknowns_of(model, group)
    lines = line_at(model, w, group)
    first = w * model.elements[0].matched[0].column_start[model.elements[0].matched[0].count]
    first += model.elements[0].matched[0].column_start[group]
    i = lane
    while i < n:
        tableau.matched_strip[lines + i] = real(0.0)
        i += wp.block_dim()
    sync()
    add_columns(
        n, columns_of(model, group), tableau.matched_list, -1, matched_z, first, model.elements[0].matched[0].motion,
        model.elements[0].matched[0].motion_start[group], n, tableau.matched_strip, lines,
    )  # fmt: skip
    if with_forces != 0:
        add_columns(
            n, n, tableau.matched_list, -1, tableau.matched_trial, lines, model.elements[0].matched[0].compliance,
            model.elements[0].matched[0].compliance_start[group], n, tableau.matched_strip, lines,
        )  # fmt: skip
    sync()


@wp.func
def own_forces(model: Model, w: int, group: int, lane: int, tableau: MatchedScratch):
    """Forces of all cells from their numbers; lanes over cells."""
    components = model.elements[0].matched[0].components[group]
    first = model.elements[0].matched[0].cell_start[group]
    c = lane
    while c < cells_of(model, group):
        at = line_at(model, w, group) + components * c
        form = form_of(
            w,
            first + c,
            model.elements[0].matched[0].friction[first + c],
            tableau.matched_mode,
            tableau.matched_target_form,
        )
        s = forces_of(form, triple(tableau.matched_u, at, components), triple(tableau.matched_v, at, components))
        put_triple(tableau.matched_trial, at, components, s)
        c += wp.block_dim()
    sync()


@wp.func
def begin_table(model: Model, w: int, group: int, lane: int, tableau: MatchedScratch):
    """T = [[G, J], [J^T, 0]], all cells open; lanes over columns."""
    n = unknowns_of(model, group)
    all = lines_of(model, group)
    base = table_at(model, w, group)
    compliance = model.elements[0].matched[0].compliance_start[group]
    motion = model.elements[0].matched[0].motion_start[group]
    j = lane
    while j < all:
        i = int(0)
        while i < all:
            value = real(0.0)
            if i < n and j < n:
                value = model.elements[0].matched[0].compliance[compliance + j * n + i]
            elif i < n:
                value = model.elements[0].matched[0].motion[motion + (j - n) * n + i]
            elif j < n:
                value = model.elements[0].matched[0].motion[motion + (i - n) * n + j]
            tableau.matched_table[base + j * all + i] = value
            i += 1
        j += wp.block_dim()
    if lane == 0:
        form = Form()
        form.state = OPEN
        cell = model.elements[0].matched[0].cell_start[group]
        while cell < model.elements[0].matched[0].cell_start[group + 1]:
            set_form(w, cell, form, tableau.matched_mode, tableau.matched_target_form)
            set_form(w, cell, form, tableau.matched_base, tableau.matched_base_target_form)
            cell += 1
        tableau.matched_words[w, group, FACTORED] = 0
        tableau.matched_words[w, group, ROOM] = most_of(model, group)
    sync()


@wp.func
def put_right(model: Model, w: int, group: int, matched: MatchedState, tableau: MatchedScratch):
    """u and v of all cells from their forces, and G s + J z in `matched_strip`; by one lane."""
    components = model.elements[0].matched[0].components[group]
    lines = line_at(model, w, group)
    first = model.elements[0].matched[0].cell_start[group]
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        s = triple(tableau.matched_trial, lines + components * c, components)
        y = triple(tableau.matched_strip, lines + components * c, components)
        y += vec3(
            model.elements[0].matched[0].gap[cell], -matched.matched_slip[w, cell, 0], -matched.matched_slip[w, cell, 1]
        )
        map = to_form(
            form_of(
                w, cell, model.elements[0].matched[0].friction[cell], tableau.matched_mode, tableau.matched_target_form
            )
        )
        put_triple(tableau.matched_u, lines + components * c, components, first_of(map, s, y))
        put_triple(tableau.matched_v, lines + components * c, components, second_of(map, s, y))
        c += 1


@wp.func
def book(model: Model, w: int, group: int, matched: MatchedState, tableau: MatchedScratch):
    """Gaps and slips of the step, the elastic energy, the work of friction and the remainder of the trapezoidal work;
    J z is in `matched_strip`. By one lane."""
    components = model.elements[0].matched[0].components[group]
    lines = line_at(model, w, group)
    first = model.elements[0].matched[0].cell_start[group]
    stored = real(0.0)
    rubbed = real(0.0)
    rest = real(0.0)
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        at = lines + components * c
        form = form_of(
            w, cell, model.elements[0].matched[0].friction[cell], tableau.matched_mode, tableau.matched_target_form
        )
        s = triple(tableau.matched_trial, at, components)
        y = moved_of(form, triple(tableau.matched_u, at, components), triple(tableau.matched_v, at, components))
        put_triple(tableau.matched_moved, at, components, y)
        old = vec3(
            matched.matched_force[w, cell, 0], matched.matched_force[w, cell, 1], matched.matched_force[w, cell, 2]
        )
        given = triple(tableau.matched_strip, at, components)
        given += vec3(
            model.elements[0].matched[0].gap[cell], -matched.matched_slip[w, cell, 0], -matched.matched_slip[w, cell, 1]
        )
        stored += real(0.5) * wp.dot(s, y - given)
        rubs = -(s[1] * y[1] + s[2] * y[2])
        rubbed += rubs
        gone = vec3(y[0] - matched.matched_gap[w, cell], y[1], y[2])
        rest -= real(0.5) * wp.dot(s + old, gone) + rubs
        c += 1
    tableau.matched_stored[w, group] = stored
    tableau.matched_taken[w, group, 0] = rubbed
    tableau.matched_taken[w, group, 1] = rest
