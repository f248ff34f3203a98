"""Coupling of pairs by the condensed or local modes of the bodies that they share.

(M + F) ds = b of `contact_solve`, with F the blocks of G between pairs and M the system without them, is solved from
the solution without F with M as preconditioner. With the weights w of impulsive pairs the blocks of local modes are
F_ij w_i/w_j: not symmetric where an idle pair touches next to one that is pressed, so the method is that of van der
Vorst (BiCGStab, 1992), on the right:

    (1 + F M^-1) y = b,      ds = M^-1 y.

Symmetric ones in their place would not agree with the gaps by which the active set is corrected: cells at the edge of a
patch would enter and leave it indefinitely. Each step costs two solves with the present factors.
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

EXACT = wp.constant(wp.float64(1.0e-18))  # of the square of the first residual
MOST = wp.constant(60)  # steps; the rest stays in the gaps for the Newton iteration


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


@wp.func
def copy(n: int, lane: int, x: wp.array(dtype=real), a: int, b: int):
    """x[b:] = x[a:] of n numbers. Lanes over them."""
    i = lane
    while i < n:
        x[b + i] = x[a + i]
        i += wp.block_dim()
    sync()


@wp.func
def without_coupling(
    model: Model, p: Pattern, w: int, lane: int, normal: ContactSolve, system: RetainedSystem, answer: int
):  # fmt: skip
    """krylov[answer:] = M^-1 of itself, and its retained increments in `krylov_z`."""
    i = lane
    while i < model.retained.count:
        normal.krylov_rhs[w * model.retained.count + i] = real(0.0)
        i += wp.block_dim()
    sync()
    eliminated(model, p, w, lane, 0, 0, normal, system, normal.krylov, answer, normal.krylov_rhs, normal.krylov_z)
    sync()


@wp.func
def step_along(
    model: Model, w: int, lane: int, count: int, length: real, normal: ContactSolve, system: RetainedSystem,
    answer: int, residual: int, image: int,
):  # fmt: skip
    """A step along krylov[answer:], `length` times as long, whose image is krylov[image:]."""
    i = lane
    while i < count:
        at = w * model.capacity.slots + i
        normal.solution[at] = normal.solution[at] + length * normal.krylov[answer + i]
        normal.krylov[residual + i] = normal.krylov[residual + i] - length * normal.krylov[image + i]
        i += wp.block_dim()
    i = w * model.retained.count + lane
    while i < (w + 1) * model.retained.count:
        system.z[i] = system.z[i] + length * normal.krylov_z[i]
        i += wp.block_dim()
    sync()


@kernel
def solve_between(
    run: Run, fields: ContactFields, normal: ContactSolve, impulses: ImpulsiveContact, system: RetainedSystem,
    contact: ContactState, patterns: wp.array(dtype=Pattern),
):  # fmt: skip
    """Per world: retained increments and pressures with the coupling of pairs by local modes, from the solution without
    it."""
    w, lane = wp.tid()
    model = run.models[w]
    count = normal.block[w, 0, LEFT_START]
    if run.ctl[w].run == 0 or count == 0 or lags(model, run.ctl, w):
        return
    cap = model.capacity.slots
    at = w * cap
    residual = w * 6 * cap
    shadow = residual + cap  # the first residual
    path = residual + 2 * cap
    image = residual + 3 * cap  # of the path
    answer = residual + 4 * cap  # M^-1 of the path, or of the residual
    second = residual + 5 * cap  # image of the latter
    i = lane
    while i < count:
        normal.krylov[residual + i] = real(0.0)
        normal.krylov[answer + i] = -normal.solution[at + i]
        i += wp.block_dim()
    add_between(model, w, count, normal.soft, normal.order, normal.block, normal.krylov, answer, residual)  # r = -F x
    copy(count, lane, normal.krylov, residual, shadow)
    copy(count, lane, normal.krylov, residual, path)
    size = inner(count, normal.krylov, residual, residual)
    least = EXACT * size
    product = size
    step = int(0)
    while step < MOST and size > least and product != real(0.0):
        copy(count, lane, normal.krylov, path, answer)
        copy(count, lane, normal.krylov, path, image)
        without_coupling(model, patterns[0], w, lane, normal, system, answer)
        add_between(model, w, count, normal.soft, normal.order, normal.block, normal.krylov, answer, image)
        along = inner(count, normal.krylov, shadow, image)
        if along == real(0.0):
            break
        length = product / along
        step_along(model, w, lane, count, length, normal, system, answer, residual, image)
        copy(count, lane, normal.krylov, residual, answer)
        copy(count, lane, normal.krylov, residual, second)
        without_coupling(model, patterns[0], w, lane, normal, system, answer)
        add_between(model, w, count, normal.soft, normal.order, normal.block, normal.krylov, answer, second)
        square = inner(count, normal.krylov, second, second)
        part = real(0.0)
        if square > real(0.0):
            part = inner(count, normal.krylov, second, residual) / square
        step_along(model, w, lane, count, part, normal, system, answer, residual, second)
        size = inner(count, normal.krylov, residual, residual)
        before = product
        product = inner(count, normal.krylov, shadow, residual)
        kept = real(0.0)
        if part != real(0.0):
            kept = product / before * length / part
        i = lane
        while i < count:
            normal.krylov[path + i] = normal.krylov[residual + i] + kept * (
                normal.krylov[path + i] - part * normal.krylov[image + i]
            )
            i += wp.block_dim()
        sync()
        step += 1
    put_pressures(model, w, lane, count, fields, normal, impulses, contact)
