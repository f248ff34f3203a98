r"""Tractions of the cells: simultaneous stick-slip solution of all cells, for given bounds.

With r(tau) = r_0 + K tau the weak slips due to the tractions, K symmetric positive definite (`cell_compliance`) and all
other unknowns condensed, Coulomb's law in every cell i reads

    |tau_i| <= b_i,     r_i = 0 where |tau_i| < b_i,     r_i = -lambda_i tau_i, lambda_i >= 0 where |tau_i| = b_i,

the conditions of the strictly convex problem min tau.K tau/2 + r_0.tau over discs: its solution exists and is unique
(Panagiotopoulos; Kalker's tangential problem). The regularised law adds `area h v_slip/b_i` to the diagonal, a cell
that the patch has reached during the step its softness (`bounds`).

A few sweeps of projected Gauss-Seidel over 2 x 2 blocks, which always decrease the objective, identify the sticking
cells; a semismooth Newton method then converges quadratically. With y_i = tau_i - r_i/c (c the block's stiffness) a
cell sticks if |y_i| <= b_i and is free in both directions. A sliding cell is put on its circle, tau = b d + alpha t
with d = y/|y| and t across it, and keeps the free coordinate alpha: t.r + lambda alpha = 0 with lambda = -r.d/b, so the
reduced matrix stays symmetric positive definite.

With K = D + L M L^T, D of blocks (`cell_blocks`), the reduced system K dtau = -r is, with the retained increments z due
to the tractions,

    D dtau + L z = -r,      B z = L^T dtau,      B = M^-1,

so it has the form of that of the pressures (`contact_solve`) and is solved in the same way: the free coordinates of
each pair are eliminated separately, and B + sum W^T W is sparse.

If Newton's method does not converge, an interior-point method approaches the solution (`interior_point`). Sweeps are
the last resort.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionSolve, SlipSpeedSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT, FREE, move_retained
from warpffrf_kernels.friction.friction_cone import CHANGED, judge_cells
from warpffrf_kernels.friction.interior_point import come_near
from warpffrf_kernels.friction.reduced_system import factor_reduced, solve_reduced
from warpffrf_kernels.linear.retained_solve import held_motions
from warpffrf_kernels.linear.sparse_factor import Pattern

wp.set_module_options(MODULE_OPTIONS)

SLOW = wp.constant(wp.float64(0.1))  # of the previous defect: an old factor that leaves more is recomputed
SETTLED = wp.constant(wp.float64(1.0e-12))  # of the largest bound: below the tolerance of the retained iteration
SWEEPS = wp.constant(3)  # of Gauss-Seidel before Newton
MORE_SWEEPS = wp.constant(20)  # if Newton has not converged after the interior-point method either
NEWTON = wp.constant(12)  # iterations between two rounds of sweeps
ROUNDS = wp.constant(20)  # of sweeps and Newton iterations
NEAR = wp.constant(wp.float64(1.0e-6))  # of the largest bound: first interior-point run; the second: SETTLED


# A sweep over the cells of a pair: each takes its optimal traction with the others fixed, the point of its disc at
# which its 2 x 2 problem is minimal. `turned` are the retained increments; the change of their loads by the sweep is
# returned in `push`. By one lane: Gauss-Seidel is sequential.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair;
    const int cap = 2 * model.capacity.cells, width = model.pairs.coupled_capacity, n = 2 * count;
    const int coupled = model.pairs.coupled_count.data[pair];
    const int* column = model.pairs.coupled.data + (size_t)pair * width;
    const double *A = D.data + here * cap * cap, *l = L.data + here * cap * width, *v = V.data + here * cap * width;
    const double *r0 = right.data + here * cap, *b = radius.data + here * cap / 2;
    const double *soft = softness.data + here * cap / 2, *block = diagonal.data + here * cap / 2 * 3;
    double *x = tau.data + here * cap, *sum = push.data + (size_t)w * model.retained.count;
    const double* z = turned.data + (size_t)w * model.retained.count;
    double picked[512], change[512];  // MOST_COUPLED_COLUMNS
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) {
        for (int c = 0; c < coupled; ++c) { picked[c] = z[column[c]]; change[c] = 0.0; }
        for (int i = 0; i < count; ++i) {
            const int p = 2 * i;
            const double *a0 = A + (size_t)p * cap, *a1 = a0 + cap, *l0 = l + (size_t)p * width, *l1 = l0 + width;
            double t0 = 0.0, t1 = 0.0;
            if (b[i] > 0.0) {
                double s0[8] = {0.0}, s1[8] = {0.0}, r_0 = r0[p], r_1 = r0[p + 1]; int j = 0;
                for (; j + 7 < n; j += 8) for (int c = 0; c < 8; ++c) {
                    s0[c] += a0[j + c] * x[j + c]; s1[c] += a1[j + c] * x[j + c];
                }
                for (; j < n; ++j) { r_0 += a0[j] * x[j]; r_1 += a1[j] * x[j]; }
                for (int c = 0; c < 8; ++c) { r_0 += s0[c]; r_1 += s1[c]; }
                for (int c = 0; c < coupled; ++c) { r_0 += l0[c] * picked[c]; r_1 += l1[c] * picked[c]; }
                const double k01 = block[3 * i + 1], k00 = block[3 * i] + soft[i], k11 = block[3 * i + 2] + soft[i];
                // y = K_ii tau - r without the soft part: the block's own right-hand side
                const double y0 = block[3 * i] * x[p] + k01 * x[p + 1] - r_0;
                const double y1 = k01 * x[p] + block[3 * i + 2] * x[p + 1] - r_1;
                const double det = k00 * k11 - k01 * k01;
                t0 = (k11 * y0 - k01 * y1) / det; t1 = (k00 * y1 - k01 * y0) / det;
                // (K + lambda) tau = y on the circle: Newton on 1/|tau|, monotone; g = tau.(K + lambda)^-1 tau
                if (t0 * t0 + t1 * t1 > b[i] * b[i]) {
                    double lambda = 0.0;
                    for (int it = 0; it < 30; ++it) {
                        const double m00 = k00 + lambda, m11 = k11 + lambda, d = m00 * m11 - k01 * k01;
                        t0 = (m11 * y0 - k01 * y1) / d; t1 = (m00 * y1 - k01 * y0) / d;
                        const double size = ::sqrt(t0 * t0 + t1 * t1);
                        if (size <= b[i] * (1.0 + 1e-14)) break;
                        const double g = (m11 * t0 * t0 - 2.0 * k01 * t0 * t1 + m00 * t1 * t1) / d;
                        lambda += (size - b[i]) / b[i] * size * size / g;
                    }
                    const double scale = b[i] / ::sqrt(t0 * t0 + t1 * t1);
                    t0 *= scale; t1 *= scale;
                }
            }
            const double e0 = t0 - x[p], e1 = t1 - x[p + 1];
            const double *v0 = v + (size_t)p * width, *v1 = v0 + width;
            if (e0 != 0.0 || e1 != 0.0) for (int c = 0; c < coupled; ++c) {
                picked[c] += v0[c] * e0 + v1[c] * e1; change[c] += l0[c] * e0 + l1[c] * e1;
            }
            x[p] = t0; x[p + 1] = t1;
        }
        for (int c = 0; c < coupled; ++c) if (change[c] != 0.0) sum[column[c]] += change[c];
    }
    WP_TILE_SYNC();
""")
def sweep_pair(
    model: Model,
    w: int,
    pair: int,
    count: int,
    D: wp.array(dtype=real),
    L: wp.array(dtype=real),
    V: wp.array(dtype=real),
    diagonal: wp.array(dtype=real),
    right: wp.array(dtype=real),
    radius: wp.array(dtype=real),
    softness: wp.array(dtype=real),
    turned: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    push: wp.array(dtype=real),
): ...


@wp.func
def sweep_cells(
    model: Model, w: int, lane: int, sweeps: int, tangential: FrictionSolve, slopes: SlipSpeedSolve,
    radius: wp.array(dtype=real), softness: wp.array(dtype=real),
):  # fmt: skip
    """Gauss-Seidel over the cells of all pairs, with the retained increments due to all tractions."""
    N = model.retained.count
    move_retained(
        model, w, lane, tangential, slopes.speed_L, slopes.speed_M, slopes.speed_tau, tangential.cell_moved_retained
    )
    for _sweep in range(sweeps):
        pair = int(0)
        while pair < model.pairs.count:
            count = tangential.cell_block[w, pair, COUNT]
            if count > 0:
                i = lane
                while i < N:
                    tangential.cell_load[w * N + i] = real(0.0)
                    i += wp.block_dim()
                sync()
                sweep_pair(
                    model, w, pair, count, slopes.speed_D, slopes.speed_L, slopes.speed_V, slopes.speed_diagonal,
                    slopes.speed_right, radius, softness, tangential.cell_moved_retained, slopes.speed_tau,
                    tangential.cell_load,
                )  # fmt: skip
                c = int(0)
                while c < N:
                    if tangential.cell_load[w * N + c] != real(0.0):
                        axpy(
                            N, tangential.cell_load[w * N + c], slopes.speed_M, (w * N + c) * N,
                            tangential.cell_moved_retained, w * N,
                        )  # fmt: skip
                    c += 1
                sync()
            pair += 1


# Lines of D and L of a pair's free coordinates: two for a sticking cell, the one across its direction for a sliding
# cell. Returns their number.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair;
    const int cap = 2 * model.capacity.cells, lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int width = model.pairs.coupled_capacity, coupled = model.pairs.coupled_count.data[pair];
    const double *A = D.data + here * cap * cap, *dir = direction.data + here * cap;
    const double *soft = softness.data + here * cap / 2, *slope = curvature.data + here * cap / 2;
    double *held = frozen.data + here * cap, *U = work.data + here * cap * cap;
    int *list = order.data + here * cap, *kind = sliding.data + here * cap;
    int m = 0;
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


@kernel
def solve_tractions(
    run: Run, slopes: SlipSpeedSolve, system: RetainedSystem, tangential: FrictionSolve,
        patterns: wp.array(dtype=Pattern),
    radius: wp.array(dtype=real), softness: wp.array(dtype=real),
):  # fmt: skip
    """Per world: the tractions tau of all slots, from an initial guess, for r = right + K tau + softness tau and discs
    of `radius`. If the problem does not converge, the attempt fails.

    The factors of the last solution are reused as long as no cell changes its state and each iteration reduces the
    defect to a tenth: within a step the matrix hardly changes.
    """
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    held = held_motions(run.ctl, w, system.hold_count)
    free = run.ctl[w].factored
    sync()
    turn = int(0)
    n = int(0)
    before = real(0.0)
    defect = judge_cells(model, w, lane, tangential, slopes, radius, softness)
    while turn < ROUNDS and defect > SETTLED:
        changed = tangential.cell_outcome[w, CHANGED] != real(0.0)
        # without good factors: sweeps first, then twice the interior-point method, then sweeps again
        poor = free == 0 or changed or (n > 0 and defect > NEAR)  # all may slide back and forth
        if poor and n % NEWTON == 0:
            if turn == 1 or turn == 2:
                wanted = SETTLED
                if turn == 1:
                    wanted = NEAR
                steps = come_near(
                    model, patterns[0], w, lane, wanted, held, tangential, slopes, radius, softness, system
                )
                free = 0
                if lane == 0:
                    run.ctl[w].solves = run.ctl[w].solves + steps
            else:
                sweeps = SWEEPS
                if turn > 0:
                    sweeps = MORE_SWEEPS
                sweep_cells(model, w, lane, sweeps, tangential, slopes, radius, softness)
            turn += 1
            defect = judge_cells(model, w, lane, tangential, slopes, radius, softness)
            changed = tangential.cell_outcome[w, CHANGED] != real(0.0)
        # semismooth Newton step, with new factors if states changed or convergence is slow
        renew = int(0)
        bad = int(0)
        if free == 0 or changed or (before > real(0.0) and defect > SLOW * before):
            renew = 1
            free = int(0)
            pair = int(0)
            while pair < model.pairs.count:
                m = reduce_pair(
                    model, w, pair, tangential.cell_block[w, pair, COUNT], slopes.speed_D, slopes.speed_L, softness,
                    tangential.cell_direction, tangential.cell_curvature, tangential.cell_frozen, tangential.cell_order,
                    tangential.cell_sliding, tangential.cell_U, tangential.cell_W,
                )  # fmt: skip
                if lane == 0:
                    tangential.cell_block[w, pair, FREE] = m
                free += m
                pair += 1
            sync()
            bad = factor_reduced(model, patterns[0], w, tangential, slopes)
            if lane == 0:
                run.ctl[w].solves = run.ctl[w].solves + 1
        pair = int(0)
        while pair < model.pairs.count:
            pose_reduced(
                model, w, pair, tangential.cell_block[w, pair, FREE], tangential.cell_slip, tangential.cell_direction,
                tangential.cell_order, tangential.cell_sliding, tangential.cell_solution,
            )  # fmt: skip
            pair += 1
        if bad == 0:
            bad = solve_reduced(model, patterns[0], w, lane, renew, held, tangential, system)
        if bad != 0:
            if lane == 0:
                run.ctl[w].failure = run.ctl[w].failure | k.INDEFINITE
                run.ctl[w].factored = 0
            return
        pair = int(0)
        while pair < model.pairs.count:
            move_cells(
                model, w, pair, tangential.cell_block[w, pair, COUNT], tangential.cell_block[w, pair, FREE], radius,
                tangential.cell_direction, tangential.cell_order, tangential.cell_sliding, tangential.cell_solution,
                slopes.speed_tau,
            )  # fmt: skip
            pair += 1
        before = defect
        defect = judge_cells(model, w, lane, tangential, slopes, radius, softness)
        n += 1
        if n > ROUNDS * NEWTON:
            turn = ROUNDS
    if lane == 0:
        run.ctl[w].factored = free
        if defect > SETTLED:
            run.ctl[w].failure = run.ctl[w].failure | k.CYCLING
