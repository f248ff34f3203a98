r"""Slopes of the bounds of friction condensed into the compliance of the cells, K' = (K^-1 + s)^-1 (`slip_speed`).

Cells are condensed one after another,

    K -= K_i B K_i^T,      B = s (1 + s K_ii)^-1      (2 x 2, K_ii after elimination of the previous cells),

and K^-1 + s is positive definite if and only if all the 1 + s K_ii are: the pivots of an elimination. Since K is stored
as factors, D + L M L^T (`cell_blocks`), with b = s (1 + s D_ii)^-1,

    D -= D_i b D_i^T,      L -= D_i b L_i,      M -= M L_i^T B L_i M,      M^-1 += L_i^T b L_i.
"""

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, SlipSpeedSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.friction.cell_blocks import COUNT, add_slips, block_of, borders_of, first_line
from warpffrf_kernels.friction.pressure_response import OPEN, RENEWED, ROUND
from warpffrf_kernels.friction.receptance import find_diagonal
from warpffrf_kernels.friction.slip_speed import MARK, MILDER, SHORTER, share_of, speed_of

wp.set_module_options(MODULE_OPTIONS)

LEAST = wp.constant(wp.float64(0.1))  # of a pivot: with less, K' would be ten times K and the tangent of little use
ALIKE = wp.constant(wp.float64(0.05))  # of 1 + s K_ii: slopes that differ by less converge as fast
UNSETTLED = wp.constant(3)  # rounds after which slopes are at least those of the chords between iterates


@wp.func
def stiff_enough(lines: int, row: int, slope: real, G: wp.array(dtype=real), at: int, stride: int) -> bool:
    """Whether the local compliance of a pair alone, a block from `at` on, leaves a unique solution if all cells slide
    like the one with the line `row`."""
    all = real(0.0)
    j = row % 2
    while j < lines:
        all += wp.abs(G[at + row * stride + j])
        j += 2
    return real(1.0) + slope * all > LEAST


# x[i] -= C_i B y over n lines of `width` numbers, C_i two numbers of each of `column`'s lines, y two lines: lanes over
# the lines.
@wp.func_native("""
    const double *c0 = columns.data + at_columns, *c1 = c0 + stride_columns;
    const double *y0 = y.data + at_y, *y1 = y0 + stride_y;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) {
        double* __restrict row = x.data + at_x + (size_t)i * stride_x;
        const double a = c0[i] * b_00 + c1[i] * b_01, c = c0[i] * b_01 + c1[i] * b_11;
        for (int j = 0; j < width; ++j) row[j] -= a * y0[j] + c * y1[j];
    }
    WP_TILE_SYNC();
""")
def subtract_pair(
    n: int,
    width: int,
    b_00: real,
    b_01: real,
    b_11: real,
    columns: wp.array(dtype=real),
    at_columns: int,
    stride_columns: int,
    y: wp.array(dtype=real),
    at_y: int,
    stride_y: int,
    x: wp.array(dtype=real),
    at_x: int,
    stride_x: int,
): ...


@wp.func
def sloped(s: real, k_00: real, k_01: real, k_11: real) -> vec3:
    """Entries 00, 01, 11 of s (1 + s k)^-1, k symmetric, 2 x 2; zero if 1 + s k is not clearly positive."""
    p_00 = real(1.0) + s * k_00
    p_11 = real(1.0) + s * k_11
    det = p_00 * p_11 - s * s * k_01 * k_01
    if p_00 <= LEAST or p_11 <= LEAST or det <= LEAST * LEAST:
        return vec3(real(0.0), real(0.0), real(0.0))
    return vec3(s * p_11 / det, -s * s * k_01 / det, s * p_00 / det)


@wp.func
def condense(
    model: Model, w: int, lane: int, pair: int, lines: int, row: int, s: real, slopes: SlipSpeedSolve,
    bordered: wp.array(dtype=real),
) -> int:  # fmt: skip
    """Condenses a slope s of the cell with the lines `row`, `row` + 1 of a pair into D, L, M and M^-1. Returns 0
    without any change if its pivot is not clearly positive. line, border and motion hold its lines of D, L and L M."""
    stride = 2 * model.capacity.cells
    width = model.pairs.coupled_capacity
    coupled = model.pairs.coupled_count[pair]
    N = model.retained.count
    start = block_of(model, w, pair) + row * stride
    edge = borders_of(model, w, pair) + row * width
    copy = w * 2 * stride
    copy_l = w * 2 * width
    copy_m = w * 2 * N
    sync()
    i = lane
    while i < 2 * lines:
        slopes.speed_line[copy + (i % 2) * stride + i / 2] = slopes.speed_D[start + (i % 2) * stride + i / 2]
        i += wp.block_dim()
    i = lane
    while i < 2 * coupled:
        slopes.speed_border[copy_l + (i % 2) * width + i / 2] = slopes.speed_L[edge + (i % 2) * width + i / 2]
        i += wp.block_dim()
    i = lane
    while i < 2 * N:
        slopes.speed_motion[copy_m + i] = real(0.0)
        i += wp.block_dim()
    sync()
    for d in range(2):
        c = int(0)
        while c < coupled:
            value = slopes.speed_border[copy_l + d * width + c]
            axpy(
                N, value, slopes.speed_M, (w * N + model.pairs.coupled[pair, c]) * N, slopes.speed_motion,
                copy_m + d * N,
            )  # fmt: skip
            c += 1
    sync()
    q_00 = real(0.0)
    q_01 = real(0.0)
    q_11 = real(0.0)
    c = int(0)
    while c < coupled:
        column = copy_m + model.pairs.coupled[pair, c]
        q_00 += slopes.speed_border[copy_l + c] * slopes.speed_motion[column]
        q_01 += slopes.speed_border[copy_l + c] * slopes.speed_motion[column + N]
        q_11 += slopes.speed_border[copy_l + width + c] * slopes.speed_motion[column + N]
        c += 1
    d_00 = slopes.speed_line[copy + row]
    d_01 = slopes.speed_line[copy + row + 1]
    d_11 = slopes.speed_line[copy + stride + row + 1]
    whole = sloped(s, d_00 + q_00, d_01 + q_01, d_11 + q_11)
    near = sloped(s, d_00, d_01, d_11)
    if whole[0] == real(0.0) or near[0] == real(0.0):
        return 0
    sync()
    subtract_pair(
        lines, lines, near[0], near[1], near[2], slopes.speed_line, copy, stride, slopes.speed_line, copy, stride,
        slopes.speed_D, block_of(model, w, pair), stride,
    )  # fmt: skip
    subtract_pair(
        lines, coupled, near[0], near[1], near[2], slopes.speed_line, copy, stride, slopes.speed_border, copy_l, width,
        slopes.speed_L, borders_of(model, w, pair), width,
    )  # fmt: skip
    subtract_pair(
        N, N, whole[0], whole[1], whole[2], slopes.speed_motion, copy_m, N, slopes.speed_motion, copy_m, N,
        slopes.speed_M, w * N * N, N,
    )  # fmt: skip
    c = int(0)
    while c < coupled:
        d = lane
        while d < coupled:
            x_0 = near[0] * slopes.speed_border[copy_l + d] + near[1] * slopes.speed_border[copy_l + width + d]
            x_1 = near[1] * slopes.speed_border[copy_l + d] + near[2] * slopes.speed_border[copy_l + width + d]
            value = slopes.speed_border[copy_l + c] * x_0 + slopes.speed_border[copy_l + width + c] * x_1
            if value != real(0.0):
                at = (w * N + model.pairs.coupled[pair, c]) * N + model.pairs.coupled[pair, d]
                bordered[at] = bordered[at] + value
            d += wp.block_dim()
        c += 1
    sync()
    return 1


@wp.func
def wanted_slope(model: Model, h: real, pair: int, b: real, area: real, speed: real, before: real, rounds: int) -> real:
    """s of a cell with the bound b of the largest mu, at its speed; for a sticking cell only if mu rises. before: the
    speed of the previous round."""
    at = share_of(model, pair, speed)
    s = at[1]
    if rounds >= UNSETTLED and speed != before:
        s = wp.max(s, (share_of(model, pair, before)[0] - at[0]) / (before - speed))
    if speed > real(0.0):
        s = wp.min(s, at[0] / speed)
    else:
        s = wp.max(s, real(0.0))
    return b * s / (h * area)


@wp.func
def slope_of(
    model: Model, h: real, w: int, pair: int, i: int, m: int, rounds: int, impulses: ImpulsiveContact,
    cells: FrictionCells, slopes: SlipSpeedSolve,
) -> real:  # fmt: skip
    """s of a slot; 0 if the coefficient is constant or the pressure is zero."""
    b = cells.bound[w, pair, m]
    if model.elements[0].slip_speeds.pieces[pair] == 0 or b <= real(0.0):
        return real(0.0)
    area = cells.cell_area[w, pair, m]
    speed = speed_of(h, w, pair, i, impulses.weight[w, pair] * area, slopes.speed_slip)
    return wanted_slope(model, h, pair, b, area, speed, slopes.speed_before[w, pair, i], rounds)


@wp.func
def has_changed(
    model: Model, h: real, w: int, rounds: int, tangential: FrictionSolve, impulses: ImpulsiveContact,
    cells: FrictionCells, slopes: SlipSpeedSolve,
) -> bool:  # fmt: skip
    """Whether any slope differs clearly from the condensed one, or a cell is now late."""
    changed = bool(False)
    pair = int(0)
    while pair < model.pairs.count:
        i = int(0)
        while model.elements[0].slip_speeds.pieces[pair] > 0 and i < tangential.cell_block[w, pair, COUNT]:
            m = tangential.cell_slot[w, pair, i]
            if cells.bound[w, pair, m] > real(0.0):
                s = slope_of(model, h, w, pair, i, m, rounds, impulses, cells, slopes)
                held = slopes.speed_slope[w, pair, i]
                at = (first_line(model, w, pair) / 2 + i) * 3
                k_i = wp.max(tangential.cell_diagonal[at], tangential.cell_diagonal[at + 2])
                changed = changed or (cells.late[w, pair, m] > real(0.0) and rounds == 0)
                changed = changed or wp.abs(s - held) * k_i > ALIKE * wp.max(real(1.0) + held * k_i, LEAST)
            i += 1
        pair += 1
    return changed


@kernel
def condense_slopes(
    run: Run, tangential: FrictionSolve, impulses: ImpulsiveContact, cells: FrictionCells, slopes: SlipSpeedSolve,
    bordered: wp.array(dtype=real), speed_bordered: wp.array(dtype=real),
):  # fmt: skip
    """Per world: K' as factors for the present slips. The softness of late cells is included. It is recomputed if K is
    new, if cells are late, and if slopes have changed."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, OPEN] == 0:
        return
    h = run.clk[w].h
    N = model.retained.count
    stride = 2 * model.capacity.cells
    rounds = tangential.answer_state[w, ROUND]
    renew = rounds == 0 and (tangential.answer_state[w, RENEWED] != 0 or slopes.speed_late[w, 0] != 0)
    if not renew:
        renew = has_changed(model, h, w, rounds, tangential, impulses, cells, slopes)
    sync()
    if not renew:
        return
    i = lane
    while i < N * N:
        slopes.speed_M[w * N * N + i] = tangential.friction_receptance[w * N * N + i]
        speed_bordered[w * N * N + i] = bordered[w * N * N + i]
        i += wp.block_dim()
    softened = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        lines = 2 * tangential.cell_block[w, pair, COUNT]
        start = block_of(model, w, pair)
        edge = borders_of(model, w, pair)
        i = lane
        while i < lines:
            j = int(0)
            while j < lines:
                slopes.speed_D[start + i * stride + j] = tangential.cell_D[start + i * stride + j]
                j += 1
            c = int(0)
            while c < model.pairs.coupled_count[pair]:
                at = edge + i * model.pairs.coupled_capacity + c
                slopes.speed_L[at] = tangential.cell_bordered[at]
                c += 1
            m = tangential.cell_slot[w, pair, i / 2]
            if model.elements[0].slip_speeds.pieces[pair] > 0:
                soft = cells.cell_area[w, pair, m] * cells.late[w, pair, m]
                slopes.speed_D[start + i * stride + i] = slopes.speed_D[start + i * stride + i] + soft
            i += wp.block_dim()
        i = int(0)
        while i < lines / 2:  # every lane checks this itself
            if model.elements[0].slip_speeds.pieces[pair] > 0 and cells.late[
                w, pair, tangential.cell_slot[w, pair, i]
            ] > real(0.0):
                softened = 1
            i += 1
        pair += 1
    if lane == 0:
        slopes.speed_late[w, 0] = softened
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        lines = 2 * tangential.cell_block[w, pair, COUNT]
        start = block_of(model, w, pair)
        i = int(0)
        while i < lines / 2:
            m = tangential.cell_slot[w, pair, i]
            s = slope_of(model, h, w, pair, i, m, rounds, impulses, cells, slopes)
            if s != real(0.0):
                taken = condense(model, w, lane, pair, lines, 2 * i, s, slopes, speed_bordered)
                if taken == 0:
                    if lane == 0:
                        alone = stiff_enough(lines, 2 * i, s, tangential.cell_G, start, stride)
                        alone = alone and stiff_enough(lines, 2 * i + 1, s, tangential.cell_G, start, stride)
                        mark = SHORTER
                        if not alone:
                            mark = MILDER
                        cells.steep[w, pair, MARK] = wp.max(cells.steep[w, pair, MARK], mark)
                    s = real(0.0)
            sync()
            if lane == 0:
                slopes.speed_slope[w, pair, i] = s
            i += 1
        pair += 1
    sync()


@kernel
def pose_slopes(
    run: Run, tangential: FrictionSolve, impulses: ImpulsiveContact, cells: FrictionCells, slopes: SlipSpeedSolve
):
    """Per world: r_0', discs, an initial guess of tau' and the blocks of the cells for the present slips."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, OPEN] == 0:
        return
    h = run.clk[w].h
    pair = int(0)
    while pair < model.pairs.count:
        count = tangential.cell_block[w, pair, COUNT]
        start = first_line(model, w, pair)
        i = lane
        while i < count:
            m = tangential.cell_slot[w, pair, i]
            s = real(0.0)
            if model.elements[0].slip_speeds.pieces[pair] > 0:
                scale = impulses.weight[w, pair] * cells.cell_area[w, pair, m]
                b = cells.bound[w, pair, m]
                s = slopes.speed_slope[w, pair, i]
                speed = speed_of(h, w, pair, i, scale, slopes.speed_slip)
                disc = impulses.weight[w, pair] * b * share_of(model, pair, speed)[0] - s * scale * h * speed
                tangential.cell_radius[w, pair, i] = wp.max(disc, real(0.0))
                tangential.cell_softness[w, pair, i] = real(0.0)
            for d in range(2):
                slopes.speed_tau[start + 2 * i + d] = (
                    tangential.cell_tau[start + 2 * i + d] + s * slopes.speed_slip[w, pair, 2 * i + d]
                )
                slopes.speed_drive[start + 2 * i + d] = s * tangential.cell_right[start + 2 * i + d]
                slopes.speed_right[start + 2 * i + d] = tangential.cell_right[start + 2 * i + d]
            i += wp.block_dim()
        if count > 0:
            find_diagonal(
                model, w, pair, 2 * count, slopes.speed_D, slopes.speed_L, slopes.speed_M, slopes.speed_own,
                slopes.speed_diagonal,
            )  # fmt: skip
        pair += 1
    sync()
    add_slips(
        model, w, lane, real(-1.0), tangential, slopes.speed_D, slopes.speed_L, slopes.speed_M, slopes.speed_drive,
        slopes.speed_right,
    )  # fmt: skip
