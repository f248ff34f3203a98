r"""What laps do to bodies and modes, and their tangent in the outer system.

Forces f on the coordinates z are B^T f on motions of the bodies, B the gradients of the rigid part (`motion`), and f
itself on modes. As the cells follow the motion, f changes by T_zz dz, T_zz the block of the tableau (never positive),
so the tangent of the residual is -B^T T_zz B, and what turning forces and arms add; the turn of J_l is left out.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, sync, vec3
from warpffrf_kernels.laps.loops import add_columns, take
from warpffrf_kernels.laps.motion import RIGID, WRENCH, axis_of, relative_motion, unit
from warpffrf_kernels.laps.tableau import columns_of, lines_of, respond, slots_at, table_at, unknowns_of
from warpffrf_kernels.laps.words import RANK

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def body_of(model: Model, lap: int, i: int) -> int:
    """Of motion i of a lap's bodies; -1 the ground."""
    if i < 6:
        return model.elements[0].laps[0].first[lap]
    return model.elements[0].laps[0].second[lap]


@wp.kernel
def push_laps(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    lap_gradient: wp.array4d(dtype=real),
    lap_push: wp.array2d(dtype=real),
    residual: changed(wp.array2d(dtype=real)),
    modal_residual: changed(wp.array2d(dtype=real)),
):
    """Per world: subtract the forces of all laps from the residuals of their bodies and of the modes."""
    w = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    lap = int(0)
    while lap < model.elements[0].laps[0].laps:
        at = model.elements[0].laps[0].rigid_column[lap]
        if at >= 0:
            for i in range(WRENCH):
                b = body_of(model, lap, i)
                if b >= 0:
                    force = real(0.0)
                    for c in range(RIGID):
                        force += lap_gradient[w, lap, c, i] * lap_push[w, at + c]
                    residual[w, 6 * b + i % 6] = residual[w, 6 * b + i % 6] - force
        lap += 1
    at = int(0)
    while at < model.elements[0].laps[0].column_start[model.elements[0].laps[0].count]:
        mode = model.elements[0].laps[0].column_mode[at]
        if mode >= 0:
            modal_residual[w, mode] = modal_residual[w, mode] - lap_push[w, at]
        at += 1


@wp.func
def gradient_of(
    model: Model, w: int, lap: int, c: int, body: int, i: int, lap_gradient: wp.array4d(dtype=real)
) -> real:
    """Change of coordinate c of a lap by motion i of a body."""
    sum = real(0.0)
    if model.elements[0].laps[0].first[lap] == body:
        sum += lap_gradient[w, lap, c, i]
    if model.elements[0].laps[0].second[lap] == body:
        sum += lap_gradient[w, lap, c, 6 + i]
    return sum


@wp.kernel
def stiffen_by_laps(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    lap_words: wp.array3d(dtype=int),
    lap_gradient: wp.array4d(dtype=real),
    lap_table: wp.array(dtype=real),
    lap_slot: wp.array2d(dtype=int),
    lap_place: wp.array(dtype=int),
    lap_active: wp.array(dtype=int),
    lap_rows: wp.array(dtype=real),
    lap_units: wp.array(dtype=real),
    lap_maps: wp.array(dtype=mat33),
    lap_factor: wp.array(dtype=real),
    lap_pivot: wp.array(dtype=int),
    lap_weight: inout(wp.array(dtype=real)),
    lap_stiffness: inout(wp.array(dtype=real)),
    lap_followed: inout(wp.array(dtype=real)),
    tangent: changed(wp.array3d(dtype=real)),
):
    """Per world, lanes over the outer columns of each group: -B^T T_zz B."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0 or ctl[w].refresh == 0:
        return
    group = int(0)
    while group < model.elements[0].laps[0].count:
        n = unknowns_of(model, group)
        all = lines_of(model, group)
        columns = columns_of(model, group)
        square = w * model.elements[0].laps[0].square_start[model.elements[0].laps[0].count]
        square += model.elements[0].laps[0].square_start[group]
        base = table_at(model, w, group) + n
        slots = slots_at(model, w, group)
        c = int(0)
        while c < columns:
            if lane == 0:
                respond(
                    model, w, group, n + c, lap_table, lap_words, lap_slot, lap_place, lap_active, lap_rows, lap_units,
                    lap_maps, lap_factor, lap_pivot, lap_weight,
                )  # fmt: skip
            take(columns, lap_table, base + (n + c) * all, lap_stiffness, square + c * columns)
            sync()
            add_columns(
                columns, lap_words[w, group, RANK], lap_active, slots, lap_weight, slots, lap_table, base, all,
                lap_stiffness, square + c * columns,
            )  # fmt: skip
            sync()
            c += 1
        first_lap = model.elements[0].laps[0].lap_start[group]
        last_lap = model.elements[0].laps[0].lap_start[group + 1]
        first_column = model.elements[0].laps[0].column_start[group]
        start = model.elements[0].laps[0].outer_start[group]
        count = model.elements[0].laps[0].outer_start[group + 1] - start
        followed = w * model.elements[0].laps[0].followed_start[model.elements[0].laps[0].count]
        followed += model.elements[0].laps[0].followed_start[group]
        j = lane
        while j < count:
            at = followed + j * columns
            column = model.elements[0].laps[0].outer[start + j]
            own = model.elements[0].laps[0].outer_column[start + j]
            a = int(0)
            while a < columns:
                lap_followed[at + a] = real(0.0)
                a += 1
            if own >= 0:
                a = int(0)
                while a < columns:
                    lap_followed[at + a] = lap_stiffness[square + own * columns + a]
                    a += 1
            else:
                lap = first_lap
                while lap < last_lap:
                    rigid = model.elements[0].laps[0].rigid_column[lap] - first_column
                    if rigid >= 0:
                        for c in range(RIGID):
                            g = gradient_of(model, w, lap, c, column / 6, column % 6, lap_gradient)
                            if g != real(0.0):
                                a = int(0)
                                while a < columns:
                                    more = g * lap_stiffness[square + (rigid + c) * columns + a]
                                    lap_followed[at + a] = lap_followed[at + a] + more
                                    a += 1
                    lap += 1
            i = int(0)
            while i < count:
                line = model.elements[0].laps[0].outer[start + i]
                other = model.elements[0].laps[0].outer_column[start + i]
                sum = real(0.0)
                if other >= 0:
                    sum = lap_followed[at + other]
                else:
                    lap = first_lap
                    while lap < last_lap:
                        rigid = model.elements[0].laps[0].rigid_column[lap] - first_column
                        if rigid >= 0:
                            for c in range(RIGID):
                                g = gradient_of(model, w, lap, c, line / 6, line % 6, lap_gradient)
                                sum += g * lap_followed[at + rigid + c]
                        lap += 1
                tangent[w, line, column] = tangent[w, line, column] - sum
                i += 1
            j += wp.block_dim()
        sync()
        group += 1


@wp.kernel
def turn_laps(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    lap_push: wp.array2d(dtype=real),
    tangent: changed(wp.array3d(dtype=real)),
):
    """Per world: forces of laps turn with their first body, and their arms move."""
    w = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0 or ctl[w].refresh == 0:
        return
    lap = int(0)
    while lap < model.elements[0].laps[0].laps:
        at = model.elements[0].laps[0].rigid_column[lap]
        if at >= 0:
            seen = relative_motion(model, w, lap, r1, axes)
            F = seen.first_axes * vec3(lap_push[w, at], lap_push[w, at + 1], lap_push[w, at + 2])
            M = vec3(lap_push[w, at + 3], lap_push[w, at + 4], lap_push[w, at + 5])
            M = seen.first_axes * (wp.transpose(seen.by_turn) * M)
            a = model.elements[0].laps[0].first[lap]
            b = model.elements[0].laps[0].second[lap]
            for i in range(WRENCH):
                moves = body_of(model, lap, i)
                if moves >= 0:
                    shift = vec3(real(0.0))  # of B beside A, at the place of the force
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
                            tangent[w, 6 * a + c, column] = tangent[w, 6 * a + c, column] + dF[c]
                            tangent[w, 6 * a + 3 + c, column] = tangent[w, 6 * a + 3 + c, column] + first[c]
                        if b >= 0:
                            tangent[w, 6 * b + c, column] = tangent[w, 6 * b + c, column] - dF[c]
                            tangent[w, 6 * b + 3 + c, column] = tangent[w, 6 * b + 3 + c, column] - second[c]
        lap += 1
