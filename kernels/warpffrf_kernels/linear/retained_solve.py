"""Solution of the retained system by a sparse factorisation with precomputed pattern and order.

The matrix is factored by blocks, in an order found when the scene was compiled (`sparse_factor`;
`warpffrf.online.compile.retained_pattern` explains why no pivot is sought outside a block).

A new factor is verified: |A z - rhs| is measured in the equilibrated system and corrected once if it exceeds
CORRECT_ABOVE of |z| + |rhs|. If a pivot is too small or the residual stays above REFUSE_ABOVE, the dense inverse is
used until the matrix is renewed, and counted. It is also used if a static state constrains free motions, which are not
part of the pattern. Step times of both: bench/README.md.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import is_static
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.linear.sparse_factor import Pattern, factorise, residual_of, solve_factored

wp.set_module_options(MODULE_OPTIONS)

PIVOT_TOLERANCE = wp.constant(wp.float64(1.0e-13))  # of the equilibrated matrix: below, a row is linearly dependent
CORRECT_ABOVE = wp.constant(wp.float64(1.0e-13))  # some hundred times round-off: usual with pivots inside blocks
REFUSE_ABOVE = wp.constant(wp.float64(1.0e-10))  # below the tolerance of the Newton iteration, 1e-9
DENSE = wp.constant(0)  # column of `fallback`: 1 while the dense inverse is used
COUNT = wp.constant(1)  # number of its uses


# Inverse of the equilibrated matrix, with n n^T of each constrained free motion n, by Gauss-Jordan elimination in
# place, with row pivoting; rows stay contiguous. Native for contiguous inner loops like `axpy`; not measured
# separately. Returns 1 if a pivot is below `tolerance`.
@wp.func_native("""
    const int n = model.retained.count, rigid = model.retained.row_offset, moving = 6 * model.bodies.count;
    const int L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    double* a = work.data + (size_t)w * n * n;
    double* scale = scaling.data + (size_t)w * n;
    int* swapped = pivots.data + (size_t)w * n;
    const double* A = tangent.data + (size_t)w * n * n;
    for (int e = L; e < n * n; e += NL) a[e] = 0.0;
    WP_TILE_SYNC();
    for (int i = L; i < n; i += NL) {
        for (int e = p.entry_start.data[i]; e < p.entry_start.data[i + 1]; ++e) {
            const size_t at = (size_t)i * n + p.entry_column.data[e];
            a[at] = A[at];
        }
        for (int h = 0; i < moving && h < held; ++h) {
            const double* d = hold.data + ((size_t)w * moving + h) * moving;
            if (d[i] != 0.0) for (int j = 0; j < moving; ++j) a[(size_t)i * n + j] += d[i] * d[j];
        }
    }
    WP_TILE_SYNC();
    for (int i = L; i < n; i += NL) {
        const double d = ::fabs(a[(size_t)i * n + i]);
        scale[i] = i < rigid && d > 0.0 ? 1.0 / ::sqrt(d) : 1.0;
    }
    WP_TILE_SYNC();
    for (int i = rigid + L; i < n; i += NL) {
        double big = 0.0;
        for (int j = 0; j < rigid; ++j) {
            const double entry = ::fabs(a[(size_t)i * n + j]) * scale[j];
            if (entry > big) big = entry;
        }
        if (big == 0.0) big = ::sqrt(::fabs(a[(size_t)i * n + i]));
        scale[i] = big > 0.0 ? 1.0 / big : 1.0;
    }
    WP_TILE_SYNC();
    for (int e = L; e < n * n; e += NL) a[e] *= scale[e / n] * scale[e % n];
    WP_TILE_SYNC();
    int bad = 0;
    for (int c = 0; c < n; ++c) {
        int best = c;
        for (int i = c + 1; i < n; ++i) if (::fabs(a[(size_t)i * n + c]) > ::fabs(a[(size_t)best * n + c])) best = i;
        WP_TILE_SYNC();
        double* u = a + (size_t)c * n;
        if (L == 0) swapped[c] = best;
        double* x = a + (size_t)best * n;
        if (best != c) for (int j = L; j < n; j += NL) { const double t = u[j]; u[j] = x[j]; x[j] = t; }
        WP_TILE_SYNC();
        double pivot = u[c];
        if (!(::fabs(pivot) > tolerance)) { bad = 1; pivot = 1.0; }
        WP_TILE_SYNC();
        const double r = 1.0 / pivot;
        for (int j = L; j < n; j += NL) u[j] = j == c ? r : u[j] * r;
        WP_TILE_SYNC();
        for (int i = 0; i < n; ++i) {
            double* __restrict y = a + (size_t)i * n; const double m = y[c];
            WP_TILE_SYNC();
            if (i == c || m == 0.0) continue;
            if (L == 0) y[c] = 0.0;
            WP_TILE_SYNC();
            for (int j = L; j < n; j += NL) y[j] -= m * u[j];
        }
        WP_TILE_SYNC();
    }
    for (int c = n - 1; c >= 0; --c) { const int q = swapped[c]; if (q == c) continue;
        for (int i = L; i < n; i += NL) { double* x = a + (size_t)i * n; const double t = x[c]; x[c] = x[q]; x[q] = t; }
        WP_TILE_SYNC(); }
    for (int e = L; e < n * n; e += NL) {
        const int i = e / n, j = e % n;
        inverse_transposed.data[(size_t)w * n * n + (size_t)j * n + i] = a[e] * scale[i] * scale[j];
    }
    WP_TILE_SYNC();
    return bad;
""")
def invert(
    model: Model,
    p: Pattern,
    w: int,
    tolerance: real,
    tangent: wp.array3d(dtype=real),
    hold: wp.array3d(dtype=real),
    held: int,
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    inverse_transposed: wp.array(dtype=real),
) -> int: ...


@wp.func
def apply_inverse(
    model: Model,
    w: int,
    lane: int,
    rhs: wp.array(dtype=real),
    inverse_transposed: wp.array(dtype=real),
    z: wp.array(dtype=real),
):
    """z[w] = H rhs[w]; one block per world."""
    N = model.retained.count
    i = lane
    while i < N:
        z[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    j = int(0)
    while j < N:
        axpy(N, rhs[w * N + j], inverse_transposed, (w * N + j) * N, z, w * N)
        j += 1


@wp.func
def held_motions(ctl: wp.array(dtype=Control), w: int, hold_count: wp.array(dtype=int)) -> int:
    """Number of free motions constrained in a static step."""
    if not is_static(ctl, w):
        return 0
    return hold_count[w]


@wp.func
def solve(
    model: Model,
    p: Pattern,
    w: int,
    lane: int,
    renew: int,
    matrix: wp.array3d(dtype=real),
    right: wp.array(dtype=real),
    hold: wp.array3d(dtype=real),
    held: int,
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    factor: wp.array(dtype=real),
    vector: wp.array(dtype=real),
    lines: wp.array(dtype=real),
    fallback: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    inverse_transposed: wp.array(dtype=real),
    z: wp.array(dtype=real),
) -> int:
    """z[w] = matrix^-1 right[w], with a new factor if `renew` is set; returns 1 if the matrix is singular."""
    N = model.retained.count
    i = lane
    while i < N:
        z[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    dense = fallback[w, DENSE]
    if renew != 0:
        dense = 1
        if held == 0:
            dense = factorise(
                model, p, w, wp.block_dim(), PIVOT_TOLERANCE, matrix, scaling, pivots, factor, lines, vector
            )
    if dense == 0:
        solve_factored(p, w, factor, scaling, pivots, right, w * N, vector, z)
        if renew != 0:
            off = residual_of(p, w, matrix, scaling, right, z, vector)
            if off > CORRECT_ABOVE:
                solve_factored(p, w, factor, scaling, pivots, vector, (2 * w + 1) * N, vector, z)
                off = residual_of(p, w, matrix, scaling, right, z, vector)
            if not (off <= REFUSE_ABOVE):
                dense = 1
    sync()
    bad = int(0)
    if renew != 0:
        if dense != 0:
            bad = invert(model, p, w, PIVOT_TOLERANCE, matrix, hold, held, scaling, pivots, work, inverse_transposed)
        if lane == 0:
            fallback[w, DENSE] = dense
            if held == 0:
                fallback[w, COUNT] = fallback[w, COUNT] + dense
    if dense != 0:
        apply_inverse(model, w, lane, right, inverse_transposed, z)
    return bad


@kernel
def solve_retained(run: Run, system: RetainedSystem, patterns: wp.array(dtype=Pattern), rhs: wp.array(dtype=real)):
    """Per world: a new factor if the matrix is to be renewed, then z; for scenes without contact."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    bad = solve(
        model, patterns[0], w, lane, run.ctl[w].refresh, system.tangent, rhs, system.hold,
        held_motions(run.ctl, w, system.hold_count), system.scaling, system.pivots, system.sparse_factor,
        system.sparse_vector, system.sparse_lines, system.fallback, system.elimination, system.inverse_transposed,
        system.z,
    )  # fmt: skip
    if bad != 0 and lane == 0:
        run.ctl[w].failure = run.ctl[w].failure | k.SINGULAR
