r"""Slopes of the bounds of friction condensed into the compliance of the cells, K' = (K^-1 + s)^-1 (`slip_speed`).

Cells are condensed one after another,

    K -= K_i B K_i^T,      B = s (1 + s K_ii)^-1      (2 x 2, K_ii what those before have left),

and K^-1 + s is positive definite if and only if all the 1 + s K_ii are: the pivots of an elimination. As K stays in its
factors, D + L M L^T (`cell_blocks`), with b = s (1 + s D_ii)^-1,

    D -= D_i b D_i^T,      L -= D_i b L_i,      M -= M L_i^T B L_i M,      M^-1 += L_i^T b L_i.
"""

import warp as wp

from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, vec3
from warpffrf_kernels.friction.cell_blocks import COUNT, add_slips, block_of, borders_of, first_line
from warpffrf_kernels.friction.mobility import move_pair
from warpffrf_kernels.friction.pressure_answer import OPEN, RENEWED, ROUND
from warpffrf_kernels.friction.slip_speed import MARK, MILDER, SHORTER, share_of, speed_of

wp.set_module_options(MODULE_OPTIONS)

LEAST = wp.constant(wp.float64(0.1))  # of a pivot: with less, K' would be ten times K and the tangent of little use
ALIKE = wp.constant(wp.float64(0.05))  # of 1 + s K_ii: slopes that differ by less converge as fast
UNSETTLED = wp.constant(3)  # rounds after which slopes are no less than those of the chords between iterates


@wp.func
def stiff_enough(lines: int, row: int, slope: real, G: wp.array(dtype=real), at: int, stride: int) -> bool:
    """Would the local compliance of a pair alone, a block from `at` on, leave one solution, if all cells slid like the
    one with the line `row`?"""
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
    """Entries 00, 01, 11 of s (1 + s k)^-1, k symmetric, 2 x 2; zero where 1 + s k is not clearly positive."""
    p_00 = real(1.0) + s * k_00
    p_11 = real(1.0) + s * k_11
    det = p_00 * p_11 - s * s * k_01 * k_01
    if p_00 <= LEAST or p_11 <= LEAST or det <= LEAST * LEAST:
        return vec3(real(0.0), real(0.0), real(0.0))
    return vec3(s * p_11 / det, -s * s * k_01 / det, s * p_00 / det)


@wp.func
def condense(
    model: Model,
    w: int,
    lane: int,
    pair: int,
    lines: int,
    row: int,
    s: real,
    D: wp.array(dtype=real),
    L: wp.array(dtype=real),
    M: wp.array(dtype=real),
    bordered: wp.array(dtype=real),
    line: wp.array(dtype=real),
    border: wp.array(dtype=real),
    motion: wp.array(dtype=real),
) -> int:
    """Takes a slope s of the cell with the lines `row`, `row` + 1 of a pair into D, L, M and M^-1; returns 0, and
    nothing is done, where its pivot is not clearly positive. line, border and motion hold its lines of D, L and L M."""
    stride = 2 * model.capacity.cells
    width = model.pairs.coupled_capacity
    coupled = model.pairs.coupled_count[pair]
    N = model.outer.count
    start = block_of(model, w, pair) + row * stride
    edge = borders_of(model, w, pair) + row * width
    copy = w * 2 * stride
    copy_l = w * 2 * width
    copy_m = w * 2 * N
    sync()
    i = lane
    while i < 2 * lines:
        line[copy + (i % 2) * stride + i / 2] = D[start + (i % 2) * stride + i / 2]
        i += wp.block_dim()
    i = lane
    while i < 2 * coupled:
        border[copy_l + (i % 2) * width + i / 2] = L[edge + (i % 2) * width + i / 2]
        i += wp.block_dim()
    i = lane
    while i < 2 * N:
        motion[copy_m + i] = real(0.0)
        i += wp.block_dim()
    sync()
    for d in range(2):
        c = int(0)
        while c < coupled:
            value = border[copy_l + d * width + c]
            axpy(N, value, M, (w * N + model.pairs.coupled[pair, c]) * N, motion, copy_m + d * N)
            c += 1
    sync()
    q_00 = real(0.0)
    q_01 = real(0.0)
    q_11 = real(0.0)
    c = int(0)
    while c < coupled:
        column = copy_m + model.pairs.coupled[pair, c]
        q_00 += border[copy_l + c] * motion[column]
        q_01 += border[copy_l + c] * motion[column + N]
        q_11 += border[copy_l + width + c] * motion[column + N]
        c += 1
    d_00 = line[copy + row]
    d_01 = line[copy + row + 1]
    d_11 = line[copy + stride + row + 1]
    whole = sloped(s, d_00 + q_00, d_01 + q_01, d_11 + q_11)
    near = sloped(s, d_00, d_01, d_11)
    if whole[0] == real(0.0) or near[0] == real(0.0):
        return 0
    sync()
    subtract_pair(
        lines, lines, near[0], near[1], near[2], line, copy, stride, line, copy, stride, D, block_of(model, w, pair),
        stride,
    )  # fmt: skip
    subtract_pair(
        lines, coupled, near[0], near[1], near[2], line, copy, stride, border, copy_l, width, L,
        borders_of(model, w, pair), width,
    )  # fmt: skip
    subtract_pair(N, N, whole[0], whole[1], whole[2], motion, copy_m, N, motion, copy_m, N, M, w * N * N, N)
    c = int(0)
    while c < coupled:
        d = lane
        while d < coupled:
            x_0 = near[0] * border[copy_l + d] + near[1] * border[copy_l + width + d]
            x_1 = near[1] * border[copy_l + d] + near[2] * border[copy_l + width + d]
            value = border[copy_l + c] * x_0 + border[copy_l + width + c] * x_1
            if value != real(0.0):
                at = (w * N + model.pairs.coupled[pair, c]) * N + model.pairs.coupled[pair, d]
                bordered[at] = bordered[at] + value
            d += wp.block_dim()
        c += 1
    sync()
    return 1


@wp.func
def wanted_slope(model: Model, h: real, pair: int, b: real, area: real, speed: real, before: real, rounds: int) -> real:
    """s of a cell with the bound b of the largest mu, at its speed; of one that sticks only where mu rises. before: the
    speed of the round before."""
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
    model: Model,
    h: real,
    w: int,
    pair: int,
    i: int,
    m: int,
    rounds: int,
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    bound: wp.array3d(dtype=real),
    speed_slip: wp.array3d(dtype=real),
    speed_before: wp.array3d(dtype=real),
) -> real:
    """s of a slot; 0 where the coefficient is constant or nothing presses."""
    b = bound[w, pair, m]
    if model.elements[0].slip_speeds.pieces[pair] == 0 or b <= real(0.0):
        return real(0.0)
    area = cell_area[w, pair, m]
    speed = speed_of(h, w, pair, i, weight[w, pair] * area, speed_slip)
    return wanted_slope(model, h, pair, b, area, speed, speed_before[w, pair, i], rounds)


@wp.func
def has_changed(
    model: Model,
    h: real,
    w: int,
    rounds: int,
    cell_block: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    bound: wp.array3d(dtype=real),
    late: wp.array3d(dtype=real),
    diagonal: wp.array(dtype=real),
    speed_slip: wp.array3d(dtype=real),
    speed_before: wp.array3d(dtype=real),
    speed_slope: wp.array3d(dtype=real),
) -> bool:
    """Whether any slope is clearly another than that which is condensed, or a cell is late now."""
    changed = bool(False)
    pair = int(0)
    while pair < model.pairs.count:
        i = int(0)
        while model.elements[0].slip_speeds.pieces[pair] > 0 and i < cell_block[w, pair, COUNT]:
            m = cell_slot[w, pair, i]
            if bound[w, pair, m] > real(0.0):
                s = slope_of(
                    model, h, w, pair, i, m, rounds, weight, cell_area, bound, speed_slip, speed_before
                )  # fmt: skip
                held = speed_slope[w, pair, i]
                at = (first_line(model, w, pair) / 2 + i) * 3
                k_i = wp.max(diagonal[at], diagonal[at + 2])
                changed = changed or (late[w, pair, m] > real(0.0) and rounds == 0)
                changed = changed or wp.abs(s - held) * k_i > ALIKE * wp.max(real(1.0) + held * k_i, LEAST)
            i += 1
        pair += 1
    return changed


@wp.kernel
def condense_slopes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    cell_block: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    bound: wp.array3d(dtype=real),
    late: wp.array3d(dtype=real),
    G: wp.array(dtype=real),
    D: wp.array(dtype=real),
    L: wp.array(dtype=real),
    M: wp.array(dtype=real),
    diagonal: wp.array(dtype=real),
    bordered: wp.array(dtype=real),
    answer_state: wp.array2d(dtype=int),
    speed_slip: wp.array3d(dtype=real),
    speed_before: wp.array3d(dtype=real),
    speed_D: inout(wp.array(dtype=real)),
    speed_L: inout(wp.array(dtype=real)),
    speed_M: inout(wp.array(dtype=real)),
    speed_bordered: inout(wp.array(dtype=real)),
    speed_slope: inout(wp.array3d(dtype=real)),
    speed_line: inout(wp.array(dtype=real)),
    speed_border: inout(wp.array(dtype=real)),
    speed_motion: inout(wp.array(dtype=real)),
    speed_late: inout(wp.array2d(dtype=int)),
    steep: inout(wp.array3d(dtype=int)),
):
    """Per world: K' in its factors for the slips at hand. What softens a late cell is part of it here. It is made anew
    where K is, where cells are late, and where slopes have changed."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, OPEN] == 0:
        return
    h = clk[w].h
    N = model.outer.count
    stride = 2 * model.capacity.cells
    rounds = answer_state[w, ROUND]
    renew = rounds == 0 and (answer_state[w, RENEWED] != 0 or speed_late[w, 0] != 0)
    if not renew:
        renew = has_changed(
            model, h, w, rounds, cell_block, cell_slot, weight, cell_area, bound, late, diagonal, speed_slip,
            speed_before, speed_slope,
        )  # fmt: skip
    sync()
    if not renew:
        return
    i = lane
    while i < N * N:
        speed_M[w * N * N + i] = M[w * N * N + i]
        speed_bordered[w * N * N + i] = bordered[w * N * N + i]
        i += wp.block_dim()
    softened = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        lines = 2 * cell_block[w, pair, COUNT]
        start = block_of(model, w, pair)
        edge = borders_of(model, w, pair)
        i = lane
        while i < lines:
            j = int(0)
            while j < lines:
                speed_D[start + i * stride + j] = D[start + i * stride + j]
                j += 1
            c = int(0)
            while c < model.pairs.coupled_count[pair]:
                at = edge + i * model.pairs.coupled_capacity + c
                speed_L[at] = L[at]
                c += 1
            m = cell_slot[w, pair, i / 2]
            if model.elements[0].slip_speeds.pieces[pair] > 0:
                soft = cell_area[w, pair, m] * late[w, pair, m]
                speed_D[start + i * stride + i] = speed_D[start + i * stride + i] + soft
            i += wp.block_dim()
        i = int(0)
        while i < lines / 2:  # every lane looks for itself
            if model.elements[0].slip_speeds.pieces[pair] > 0 and late[w, pair, cell_slot[w, pair, i]] > real(0.0):
                softened = 1
            i += 1
        pair += 1
    if lane == 0:
        speed_late[w, 0] = softened
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        lines = 2 * cell_block[w, pair, COUNT]
        start = block_of(model, w, pair)
        i = int(0)
        while i < lines / 2:
            m = cell_slot[w, pair, i]
            s = slope_of(
                model, h, w, pair, i, m, rounds, weight, cell_area, bound, speed_slip, speed_before
            )  # fmt: skip
            if s != real(0.0):
                taken = condense(
                    model, w, lane, pair, lines, 2 * i, s, speed_D, speed_L, speed_M, speed_bordered, speed_line,
                    speed_border, speed_motion,
                )  # fmt: skip
                if taken == 0:
                    if lane == 0:
                        alone = stiff_enough(lines, 2 * i, s, G, start, stride)
                        alone = alone and stiff_enough(lines, 2 * i + 1, s, G, start, stride)
                        mark = SHORTER
                        if not alone:
                            mark = MILDER
                        steep[w, pair, MARK] = wp.max(steep[w, pair, MARK], mark)
                    s = real(0.0)
            sync()
            if lane == 0:
                speed_slope[w, pair, i] = s
            i += 1
        pair += 1
    sync()


@wp.kernel
def pose_slopes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    cell_block: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    bound: wp.array3d(dtype=real),
    answer_state: wp.array2d(dtype=int),
    right: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    speed_slip: wp.array3d(dtype=real),
    speed_slope: wp.array3d(dtype=real),
    speed_D: wp.array(dtype=real),
    speed_L: wp.array(dtype=real),
    speed_M: wp.array(dtype=real),
    speed_own: inout(wp.array(dtype=real)),
    speed_V: inout(wp.array(dtype=real)),
    speed_diagonal: out(wp.array(dtype=real)),
    speed_drive: inout(wp.array(dtype=real)),
    push: inout(wp.array(dtype=real)),
    turned: inout(wp.array(dtype=real)),
    speed_right: inout(wp.array(dtype=real)),
    speed_tau: out(wp.array(dtype=real)),
    radius: out(wp.array3d(dtype=real)),
    softness: out(wp.array3d(dtype=real)),
):
    """Per world: r_0', discs, a first guess of tau' and the blocks of the cells for the slips at hand."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, OPEN] == 0:
        return
    h = clk[w].h
    pair = int(0)
    while pair < model.pairs.count:
        count = cell_block[w, pair, COUNT]
        start = first_line(model, w, pair)
        i = lane
        while i < count:
            m = cell_slot[w, pair, i]
            s = real(0.0)
            if model.elements[0].slip_speeds.pieces[pair] > 0:
                scale = weight[w, pair] * cell_area[w, pair, m]
                b = bound[w, pair, m]
                s = speed_slope[w, pair, i]
                speed = speed_of(h, w, pair, i, scale, speed_slip)
                disc = weight[w, pair] * b * share_of(model, pair, speed)[0] - s * scale * h * speed
                radius[w, pair, i] = wp.max(disc, real(0.0))
                softness[w, pair, i] = real(0.0)
            for d in range(2):
                speed_tau[start + 2 * i + d] = tau[start + 2 * i + d] + s * speed_slip[w, pair, 2 * i + d]
                speed_drive[start + 2 * i + d] = s * right[start + 2 * i + d]
                speed_right[start + 2 * i + d] = right[start + 2 * i + d]
            i += wp.block_dim()
        if count > 0:
            move_pair(
                model, w, pair, 2 * count, speed_D, speed_L, speed_M, speed_own, speed_V, speed_diagonal
            )  # fmt: skip
        pair += 1
    sync()
    add_slips(
        model, w, lane, real(-1.0), cell_block, speed_D, speed_L, speed_M, speed_drive, push, turned, speed_right
    )  # fmt: skip
