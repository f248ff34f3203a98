"""Coupling of pairs by the condensed or local modes of the bodies that they share.

(M + F) ds = b of `contact_solve`, with F the blocks of G between pairs and M the system without them, is solved by
conjugate gradients from the solution without F, with M as preconditioner. Each step costs a solve with the present
factors.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactSolve
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact, RetainedSystem
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.lagged import lags
from warpffrf_kernels.normal.pair_elimination import LEFT_START, eliminated, put_pressures

wp.set_module_options(MODULE_OPTIONS)

EXACT = wp.constant(wp.float64(1.0e-16))  # of the energy of the first correction: tolerance of the gradients
GRADIENTS = wp.constant(100)  # maximum number of steps; the rest stays in the gaps for the Newton iteration


# y += F x over the first n places: displacements due to the pressures of each pair on the others. Lanes over the
# places. The slots of a pair ascend and are mostly consecutive, so lines are read in contiguous runs.
@wp.func_native("""
    const int cap = model.capacity.slots, pairs = model.pairs.count;
    const int* list = order.data + (size_t)w * cap;
    const double* x = krylov.data + start; double* y = krylov.data + end;
    const int* blocks = block.data + (size_t)w * pairs * 4;
    const int *body = model.surfaces.body.data;
    const int* first = model.pairs.first.data, *second = model.pairs.second.data;
    WP_TILE_SYNC();
    for (int pair = 0; pair < pairs; ++pair) {
        const int* b = blocks + 4 * pair;
        for (int i = b[0] + WP_TILE_THREAD_IDX; i < b[0] + b[1]; i += WP_TILE_BLOCK_DIM) {
            const double* g = G.data + ((size_t)w * cap + list[i]) * cap; double sum = 0.0;
            for (int other = 0; other < pairs; ++other) {
                const int *o = blocks + 4 * other;
    const int* l = list + o[0]; const int m = o[1]; const double* v = x + o[0];
                if (other == pair || m == 0) continue;
                const int p = body[first[pair]], q = body[second[pair]];  // the first is never the ground
                const int r = body[first[other]], s = body[second[other]];
                if (p != r && p != s && (q < 0 || (q != r && q != s))) continue;
                if (l[m - 1] - l[0] == m - 1) {
                    const double* run = g + l[0];
                    double part[4] = {0.0}; int j = 0;  // chains of sums wait for each other
                    for (; j + 3 < m; j += 4) for (int c = 0; c < 4; ++c) part[c] += run[j + c] * v[j + c];
                    for (; j < m; ++j) sum += run[j] * v[j];
                    sum += (part[0] + part[1]) + (part[2] + part[3]);
                } else for (int j = 0; j < m; ++j) sum += g[l[j]] * v[j];
            }
            y[i] += sum;
        }
    }
    WP_TILE_SYNC();
""")
def add_between(
    model: Model,
    w: int,
    n: int,
    G: wp.array3d(dtype=real),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    krylov: wp.array(dtype=real),
    start: int,
    end: int,
): ...


@wp.func
def inner(n: int, x: wp.array(dtype=real), a: int, b: int) -> real:
    """x[a:] . x[b:] of n numbers, the same in every lane."""
    total = dot(n, x, a, x, b)
    sync()
    return total


@kernel
def solve_between(
    run: Run, fields: ContactFields, normal: ContactSolve, impulses: ImpulsiveContact, system: RetainedSystem,
    contact: ContactState, patterns: wp.array(dtype=Pattern),
):  # fmt: skip
    """Per world: retained increments and pressures with the coupling of pairs by local modes, by conjugate gradients
    from the solution without it."""
    w, lane = wp.tid()
    model = run.models[w]
    count = normal.block[w, 0, LEFT_START]
    if run.ctl[w].run == 0 or count == 0 or lags(model, run.ctl, w):
        return
    cap = model.capacity.slots
    N = model.retained.count
    at = w * cap
    residual = w * 4 * cap  # r, M^-1 r, the direction p and M p
    answer = residual + cap
    path = residual + 2 * cap
    image = residual + 3 * cap
    i = lane
    while i < count:
        normal.krylov[residual + i] = real(0.0)
        normal.krylov[path + i] = -normal.solution[at + i]
        normal.krylov[image + i] = real(0.0)
        i += wp.block_dim()
    i = lane
    while i < N:
        normal.krylov_path[w * N + i] = real(0.0)
        i += wp.block_dim()
    add_between(model, w, count, normal.soft, normal.order, normal.block, normal.krylov, path, residual)  # r = -F x
    reference = real(0.0)
    before = real(0.0)
    step = int(0)
    while step < GRADIENTS:
        i = lane
        while i < count:
            normal.krylov[answer + i] = normal.krylov[residual + i]
            i += wp.block_dim()
        i = lane
        while i < N:
            normal.krylov_rhs[w * N + i] = real(0.0)
            i += wp.block_dim()
        sync()
        eliminated(
            model, patterns[0], w, lane, 0, 0, normal, system, normal.krylov, answer, normal.krylov_rhs, normal.krylov_z
        )
        product = inner(count, normal.krylov, residual, answer)
        if step == 0:
            reference = product
        if not (product > EXACT * reference):
            break
        share = real(0.0)
        if step > 0:
            share = product / before
        before = product
        i = lane
        while i < count:
            if step == 0:
                normal.krylov[path + i] = real(0.0)
            normal.krylov[path + i] = normal.krylov[answer + i] + share * normal.krylov[path + i]
            normal.krylov[image + i] = normal.krylov[residual + i] + share * normal.krylov[image + i]
            i += wp.block_dim()
        i = lane
        while i < N:
            normal.krylov_path[w * N + i] = normal.krylov_z[w * N + i] + share * normal.krylov_path[w * N + i]
            i += wp.block_dim()
        sync()
        # the image by M is carried along; that by F is added for the step and subtracted again
        i = lane
        while i < count:
            normal.krylov[answer + i] = normal.krylov[image + i]
            i += wp.block_dim()
        sync()
        add_between(model, w, count, normal.soft, normal.order, normal.block, normal.krylov, path, answer)
        length = product / inner(count, normal.krylov, path, answer)
        i = lane
        while i < count:
            normal.solution[at + i] = normal.solution[at + i] + length * normal.krylov[path + i]
            normal.krylov[residual + i] = normal.krylov[residual + i] - length * normal.krylov[answer + i]
            i += wp.block_dim()
        i = lane
        while i < N:
            system.z[w * N + i] = system.z[w * N + i] + length * normal.krylov_path[w * N + i]
            i += wp.block_dim()
        sync()
        step += 1
    put_pressures(model, w, lane, count, fields, normal, impulses, contact)
