"""Steps of Newton's method for the tractions of all pairs (`rolling.traction_solve`), solved by blocks.

With D^ and L^ the lines of D and L (`cell_blocks`) reduced to the free coordinates of each pair, and B = M^-1,

    D^ x + L^ z = y,      B z = L^^T x   =>   W = U^-T L^,  (B + sum W^T W) z = sum W^T U^-T y,  x = U^-1 (U^-T y - W z)

with U^T U = D^. B + sum W^T W has the pattern of the retained matrix, and is factorised like it.
"""

import warp as wp

from warpffrf_kernels.core.friction_scratch import FrictionSolve, SlipSpeedSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT, FREE, block_of, borders_of, first_line, square_at
from warpffrf_kernels.linear import block_elimination
from warpffrf_kernels.linear.retained_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import add_borders

wp.set_module_options(MODULE_OPTIONS)

EVERY = wp.constant(2)  # values of `renew`: the factors of every pair,
CHANGED_ONES = wp.constant(1)  # or of those in which a cell has changed its kind


# Lines of D and L of a pair's free coordinates: two for a sticking cell, the one across its direction for a sliding
# cell. Returns their number; -1, and nothing changes, if no cell of the pair has changed its kind, unless `every`.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair;
    const int cap = 2 * model.capacity.cells, lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int width = model.pairs.coupled_capacity, coupled = model.pairs.coupled_count.data[pair];
    const double *A = D.data + here * cap * cap, *dir = direction.data + here * cap;
    const double *soft = softness.data + here * cap / 2, *slope = curvature.data + here * cap / 2;
    double *held = frozen.data + here * cap, *U = work.data + here * cap * cap;
    int *list = order.data + here * cap, *kind = sliding.data + here * cap;
    int m = 0, same = 1;
    for (int i = 0; i < count; ++i) if (kind[i] != kind[cap / 2 + i]) same = 0;
    WP_TILE_SYNC();
    if (same && !every) return -1;
    for (int i = 0; i < count; ++i) {  // every lane counts for itself, in the same order
        if (kind[i] == 0) continue;
        if (lane == 0) { list[m] = 2 * i; if (kind[i] == 1) list[m + 1] = 2 * i + 1; }
        m += kind[i] == 1 ? 2 : 1;
    }
    for (int i = lane; i < count; i += lanes) {
        kind[cap / 2 + i] = kind[i]; held[2 * i] = dir[2 * i]; held[2 * i + 1] = dir[2 * i + 1];
    }
    WP_TILE_SYNC();
    for (int u = lane; u < m; u += lanes) {
        const int p = list[u], i = p / 2;
        const int slide = kind[i] == 2, even = 2 * i;
        const double *a0 = A + (size_t)(slide ? even : p) * cap, *a1 = A + (size_t)(even + 1) * cap;
        const double t0 = slide ? -held[even + 1] : 1.0, t1 = slide ? held[even] : 0.0;
        double* row = U + (size_t)u * cap;
        for (int v = u; v < m; ++v) {
            const int q = list[v], j = q / 2;
            double g0, g1 = 0.0;
            if (kind[j] == 2) {
                const double c0 = -held[2 * j + 1], c1 = held[2 * j];
                g0 = a0[2 * j] * c0 + a0[2 * j + 1] * c1;
                if (slide) g1 = a1[2 * j] * c0 + a1[2 * j + 1] * c1;
            } else { g0 = a0[q]; if (slide) g1 = a1[q]; }
            row[v] = t0 * g0 + t1 * g1;
        }
        row[u] += soft[i] + (slide ? slope[i] : 0.0);
        const double *l0 = L.data + (here * cap + (slide ? even : p)) * width;
        const double* l1 = L.data + (here * cap + even + 1) * width;
        double* border = W.data + (here * cap + u) * width;
        for (int c = 0; c < coupled; ++c) border[c] = slide ? t0 * l0[c] + t1 * l1[c] : l0[c];
    }
    WP_TILE_SYNC();
    return m;
""")
def reduce_pair(
    model: Model,
    w: int,
    pair: int,
    count: int,
    every: int,
    D: wp.array(dtype=real),
    L: wp.array(dtype=real),
    softness: wp.array(dtype=real),
    direction: wp.array(dtype=real),
    curvature: wp.array(dtype=real),
    frozen: wp.array(dtype=real),
    order: wp.array(dtype=int),
    sliding: wp.array(dtype=int),
    work: wp.array(dtype=real),
    W: wp.array(dtype=real),
) -> int: ...


# Right-hand side of the free coordinates of a pair; for sliding cells along their *present* tangents (with those of an
# old factor the sliding force itself would count as an error). Lanes over the coordinates.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = 2 * model.capacity.cells;
    const double *r = slip.data + here * cap, *dir = direction.data + here * cap;
    const int *list = order.data + here * cap;
    const int* kind = sliding.data + here * cap;
    WP_TILE_SYNC();
    for (int u = WP_TILE_THREAD_IDX; u < m; u += WP_TILE_BLOCK_DIM) {
        const int p = list[u], i = p / 2;
        const double across = dir[2 * i + 1] * r[2 * i] - dir[2 * i] * r[2 * i + 1];
        solution.data[here * cap + u] = kind[i] == 2 ? across : -r[p];
    }
    WP_TILE_SYNC();
""")
def pose_reduced(
    model: Model,
    w: int,
    pair: int,
    m: int,
    slip: wp.array(dtype=real),
    direction: wp.array(dtype=real),
    order: wp.array(dtype=int),
    sliding: wp.array(dtype=int),
    solution: wp.array(dtype=real),
): ...


# Updates the tractions of a pair: sticking cells by the solution, sliding ones along their circles. Lanes over the
# cells, then the coordinates.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = 2 * model.capacity.cells;
    double* x = tau.data + here * cap;
    const double *y = solution.data + here * cap, *dir = direction.data + here * cap, *b = radius.data + here * cap / 2;
    const int *list = order.data + here * cap;
    const int* kind = sliding.data + here * cap;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) if (kind[i] == 0) x[2 * i] = x[2 * i + 1] = 0.0;
    for (int u = WP_TILE_THREAD_IDX; u < m; u += WP_TILE_BLOCK_DIM) {
        const int p = list[u], i = p / 2;
        if (kind[i] == 2) {
            const double t0 = b[i] * dir[2 * i] - y[u] * dir[2 * i + 1];
            const double t1 = b[i] * dir[2 * i + 1] + y[u] * dir[2 * i];
            const double scale = b[i] / ::sqrt(t0 * t0 + t1 * t1);
            x[2 * i] = t0 * scale; x[2 * i + 1] = t1 * scale;
        } else x[p] += y[u];
    }
    WP_TILE_SYNC();
""")
def move_cells(
    model: Model,
    w: int,
    pair: int,
    count: int,
    m: int,
    radius: wp.array(dtype=real),
    direction: wp.array(dtype=real),
    order: wp.array(dtype=int),
    sliding: wp.array(dtype=int),
    solution: wp.array(dtype=real),
    tau: wp.array(dtype=real),
): ...


@wp.func
def factor_pair(model: Model, w: int, pair: int, m: int, tangential: FrictionSolve) -> int:
    """U replaces D^, W replaces L^; 1 if the block is not definite."""
    stride = 2 * model.capacity.cells
    width = model.pairs.coupled_capacity
    coupled = model.pairs.coupled_count[pair]
    at = borders_of(model, w, pair)
    bad = block_elimination.factor(tangential.cell_U, block_of(model, w, pair), stride, m)
    block_elimination.forward_lines(
        tangential.cell_U, block_of(model, w, pair), stride, m, tangential.cell_W, at, width, coupled
    )
    block_elimination.square_of(
        m, tangential.cell_W, at, width, coupled, tangential.cell_square, square_at(model, w, pair)
    )
    return bad


@wp.func
def border_reduced(model: Model, p: Pattern, w: int, tangential: FrictionSolve, slopes: SlipSpeedSolve):
    """`retained` = `bordered` + sum W^T W."""
    add_borders(
        model, p, w, slopes.speed_bordered, tangential.cell_block, tangential.cell_square, tangential.cell_retained
    )


@wp.func
def solve_reduced(
    model: Model,
    p: Pattern,
    w: int,
    lane: int,
    renew: int,
    held: int,
    tangential: FrictionSolve,
    system: RetainedSystem,
) -> int:
    """x <- solution for the right-hand side x; `renew`: with new factors. 1 if the retained matrix is singular."""
    stride = 2 * model.capacity.cells
    i = lane
    while i < model.retained.count:
        tangential.cell_load[w * model.retained.count + i] = real(0.0)
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        if tangential.cell_block[w, pair, COUNT] > 0:
            m = tangential.cell_block[w, pair, FREE]
            line = first_line(model, w, pair)
            block_elimination.forward(
                tangential.cell_U, block_of(model, w, pair), stride, m, tangential.cell_solution, line
            )
            block_elimination.push_columns(
                model, w, pair, m, tangential.cell_W, borders_of(model, w, pair), tangential.cell_solution, line,
                tangential.cell_load,
            )  # fmt: skip
        pair += 1
    bad = solve(
        model, p, w, lane, renew, tangential.cell_retained, tangential.cell_load, system.hold, held,
        tangential.cell_scaling, tangential.cell_pivots, tangential.cell_factor, tangential.cell_vector,
        tangential.cell_lines, tangential.cell_fallback, tangential.cell_work, tangential.cell_inverse_transposed,
        tangential.cell_moved_retained,
    )  # fmt: skip
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        if tangential.cell_block[w, pair, COUNT] > 0:
            m = tangential.cell_block[w, pair, FREE]
            line = first_line(model, w, pair)
            block_elimination.follow_columns(
                model, w, pair, m, real(-1.0), tangential.cell_W, borders_of(model, w, pair),
                tangential.cell_moved_retained, tangential.cell_solution, line,
            )  # fmt: skip
            block_elimination.backward(
                tangential.cell_U, block_of(model, w, pair), stride, m, tangential.cell_solution, line
            )
        pair += 1
    return bad


@wp.func(inline=False)
def step_by_blocks(
    model: Model, p: Pattern, w: int, lane: int, renew: int, held: int, tangential: FrictionSolve,
    slopes: SlipSpeedSolve, system: RetainedSystem, radius: wp.array(dtype=real), softness: wp.array(dtype=real),
) -> int:  # fmt: skip
    """A step of Newton's method from the slips and kinds of the cells on, with new factors of the pairs where kinds
    have changed, or of EVERY pair. 1 if the system is not definite."""
    bad = int(0)
    if renew != 0:
        pair = int(0)
        while pair < model.pairs.count:
            m = reduce_pair(
                model, w, pair, tangential.cell_block[w, pair, COUNT], int(renew == EVERY), slopes.speed_D,
                slopes.speed_L, softness, tangential.cell_direction, tangential.cell_curvature, tangential.cell_frozen,
                tangential.cell_order, tangential.cell_sliding, tangential.cell_U, tangential.cell_W,
            )  # fmt: skip
            if m >= 0:
                bad += factor_pair(model, w, pair, m, tangential)
                if lane == 0:
                    tangential.cell_block[w, pair, FREE] = m
            pair += 1
        sync()
        border_reduced(model, p, w, tangential, slopes)
    pair = int(0)
    while pair < model.pairs.count:
        pose_reduced(
            model, w, pair, tangential.cell_block[w, pair, FREE], tangential.cell_slip, tangential.cell_direction,
            tangential.cell_order, tangential.cell_sliding, tangential.cell_solution,
        )  # fmt: skip
        pair += 1
    if bad == 0:
        bad = solve_reduced(model, p, w, lane, renew, held, tangential, system)
    if bad != 0:
        return 1
    pair = int(0)
    while pair < model.pairs.count:
        move_cells(
            model, w, pair, tangential.cell_block[w, pair, COUNT], tangential.cell_block[w, pair, FREE], radius,
            tangential.cell_direction, tangential.cell_order, tangential.cell_sliding, tangential.cell_solution,
            slopes.speed_tau,
        )  # fmt: skip
        pair += 1
    return 0
