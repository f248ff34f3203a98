r"""Loads of small-sliding contacts on bodies and modes, and their tangent in the retained system.

Forces f on the coordinates z are B^T f on motions of the bodies, B the gradients of the rigid part (`motion`), and f
itself on modes. As the cells follow the motion, f changes by T_zz dz, T_zz the block of the tableau (negative
semidefinite), so the tangent of the residual is -B^T T_zz B, plus the effect of rotating forces and arms; the
derivative of J_l is neglected.
"""

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem, Trial
from warpffrf_kernels.matched.loops import add_columns, take
from warpffrf_kernels.matched.motion import RIGID, WRENCH, axis_of, relative_motion, unit
from warpffrf_kernels.matched.status_words import RANK
from warpffrf_kernels.matched.tableau import columns_of, lines_of, respond, slots_at, table_at, unknowns_of

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def body_of(model: Model, contact: int, i: int) -> int:
    """Body of motion i of a contact; -1 for the ground."""
    if i < 6:
        return model.elements[0].matched[0].first[contact]
    return model.elements[0].matched[0].second[contact]


@kernel
def push_matched(run: Run, tableau: MatchedScratch, residuals: Residuals):
    """Per world: subtracts the forces of all small-sliding contacts from the residuals of their bodies and modes."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    contact = int(0)
    while contact < model.elements[0].matched[0].matched:
        at = model.elements[0].matched[0].rigid_column[contact]
        if at >= 0:
            for i in range(WRENCH):
                b = body_of(model, contact, i)
                if b >= 0:
                    force = real(0.0)
                    for c in range(RIGID):
                        force += tableau.matched_gradient[w, contact, c, i] * tableau.matched_push[w, at + c]
                    residuals.residual[w, 6 * b + i % 6] = residuals.residual[w, 6 * b + i % 6] - force
        contact += 1
    at = int(0)
    while at < model.elements[0].matched[0].column_start[model.elements[0].matched[0].count]:
        mode = model.elements[0].matched[0].column_mode[at]
        if mode >= 0:
            residuals.modal_residual[w, mode] = residuals.modal_residual[w, mode] - tableau.matched_push[w, at]
        at += 1


@wp.func
def gradient_of(
    model: Model, w: int, contact: int, c: int, body: int, i: int, matched_gradient: wp.array4d(dtype=real)
) -> real:
    """Change of coordinate c of a contact by motion i of a body."""
    sum = real(0.0)
    if model.elements[0].matched[0].first[contact] == body:
        sum += matched_gradient[w, contact, c, i]
    if model.elements[0].matched[0].second[contact] == body:
        sum += matched_gradient[w, contact, c, 6 + i]
    return sum


@kernel
def stiffen_by_matched(run: Run, tableau: MatchedScratch, system: RetainedSystem):
    """Per world, lanes over the retained columns of each group: -B^T T_zz B."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0:
        return
    group = int(0)
    while group < model.elements[0].matched[0].count:
        n = unknowns_of(model, group)
        all = lines_of(model, group)
        columns = columns_of(model, group)
        square = w * model.elements[0].matched[0].square_start[model.elements[0].matched[0].count]
        square += model.elements[0].matched[0].square_start[group]
        base = table_at(model, w, group) + n
        slots = slots_at(model, w, group)
        c = int(0)
        while c < columns:
            if lane == 0:
                respond(model, w, group, n + c, tableau)
            take(columns, tableau.matched_table, base + (n + c) * all, tableau.matched_stiffness, square + c * columns)
            sync()
            add_columns(
                columns, tableau.matched_words[w, group, RANK], tableau.matched_active, slots, tableau.matched_weight,
                slots, tableau.matched_table, base, all, tableau.matched_stiffness, square + c * columns,
            )  # fmt: skip
            sync()
            c += 1
        first_contact = model.elements[0].matched[0].matched_start[group]
        last_contact = model.elements[0].matched[0].matched_start[group + 1]
        first_column = model.elements[0].matched[0].column_start[group]
        start = model.elements[0].matched[0].retained_start[group]
        count = model.elements[0].matched[0].retained_start[group + 1] - start
        followed = w * model.elements[0].matched[0].followed_start[model.elements[0].matched[0].count]
        followed += model.elements[0].matched[0].followed_start[group]
        j = lane
        while j < count:
            at = followed + j * columns
            column = model.elements[0].matched[0].retained[start + j]
            own = model.elements[0].matched[0].retained_column[start + j]
            a = int(0)
            while a < columns:
                tableau.matched_followed[at + a] = real(0.0)
                a += 1
            if own >= 0:
                a = int(0)
                while a < columns:
                    tableau.matched_followed[at + a] = tableau.matched_stiffness[square + own * columns + a]
                    a += 1
            else:
                contact = first_contact
                while contact < last_contact:
                    rigid = model.elements[0].matched[0].rigid_column[contact] - first_column
                    if rigid >= 0:
                        for c in range(RIGID):
                            g = gradient_of(model, w, contact, c, column / 6, column % 6, tableau.matched_gradient)
                            if g != real(0.0):
                                a = int(0)
                                while a < columns:
                                    more = g * tableau.matched_stiffness[square + (rigid + c) * columns + a]
                                    tableau.matched_followed[at + a] = tableau.matched_followed[at + a] + more
                                    a += 1
                    contact += 1
            i = int(0)
            while i < count:
                line = model.elements[0].matched[0].retained[start + i]
                other = model.elements[0].matched[0].retained_column[start + i]
                sum = real(0.0)
                if other >= 0:
                    sum = tableau.matched_followed[at + other]
                else:
                    contact = first_contact
                    while contact < last_contact:
                        rigid = model.elements[0].matched[0].rigid_column[contact] - first_column
                        if rigid >= 0:
                            for c in range(RIGID):
                                g = gradient_of(model, w, contact, c, line / 6, line % 6, tableau.matched_gradient)
                                sum += g * tableau.matched_followed[at + rigid + c]
                        contact += 1
                system.tangent[w, line, column] = system.tangent[w, line, column] - sum
                i += 1
            j += wp.block_dim()
        sync()
        group += 1


@kernel
def turn_matched(run: Run, trial: Trial, tableau: MatchedScratch, system: RetainedSystem):
    """Per world: forces of small-sliding contacts rotate with their first body, and their arms move."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0:
        return
    contact = int(0)
    while contact < model.elements[0].matched[0].matched:
        at = model.elements[0].matched[0].rigid_column[contact]
        if at >= 0:
            seen = relative_motion(model, w, contact, trial)
            F = seen.first_axes * vec3(
                tableau.matched_push[w, at], tableau.matched_push[w, at + 1], tableau.matched_push[w, at + 2]
            )
            M = vec3(tableau.matched_push[w, at + 3], tableau.matched_push[w, at + 4], tableau.matched_push[w, at + 5])
            M = seen.first_axes * (wp.transpose(seen.by_turn) * M)
            a = model.elements[0].matched[0].first[contact]
            b = model.elements[0].matched[0].second[contact]
            for i in range(WRENCH):
                moves = body_of(model, contact, i)
                if moves >= 0:
                    shift = vec3(real(0.0))  # of B relative to A, at the point of the force
                    first_turn = vec3(real(0.0))
                    second_turn = vec3(real(0.0))
                    if i < 3:
                        shift = -unit(i)
                    elif i < 6:
                        first_turn = axis_of(seen.first_axes, i - 3)
                    elif i < 9:
                        shift = unit(i - 6)
                    else:
                        second_turn = axis_of(seen.second_axes, i - 9)
                    swung = wp.cross(second_turn, seen.second_arm)
                    dF = wp.cross(first_turn, F)
                    dM = wp.cross(first_turn, M)
                    first = wp.cross(shift + swung, F) + wp.cross(seen.first_arm, dF) + dM
                    first -= wp.cross(first_turn, wp.cross(seen.first_arm, F) + M)
                    second = wp.cross(swung, F) + wp.cross(seen.second_arm, dF) + dM
                    second -= wp.cross(second_turn, wp.cross(seen.second_arm, F) + M)
                    first = wp.transpose(seen.first_axes) * first
                    second = wp.transpose(seen.second_axes) * second
                    column = 6 * moves + i % 6
                    for c in range(3):
                        if a >= 0:
                            system.tangent[w, 6 * a + c, column] = system.tangent[w, 6 * a + c, column] + dF[c]
                            system.tangent[w, 6 * a + 3 + c, column] = (
                                system.tangent[w, 6 * a + 3 + c, column] + first[c]
                            )
                        if b >= 0:
                            system.tangent[w, 6 * b + c, column] = system.tangent[w, 6 * b + c, column] - dF[c]
                            system.tangent[w, 6 * b + 3 + c, column] = (
                                system.tangent[w, 6 * b + 3 + c, column] - second[c]
                            )
        contact += 1
