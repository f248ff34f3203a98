r"""How the pressures answer to a change of the tractions: by the motion that both share.

With ds the change of the pressures of the active set, dtau that of the tractions, H the outer flexibility, L_n and L
the gradients of gaps and weak slips by the outer coordinates, V_n = H L_n^T and V = H L^T, a linearised step is

    opened + G_c ds + N^T dtau = 0,        r + N ds + K dtau in the law of friction,        N = L H L_n^T.

Pressures are solved for first, tractions with these. Where a body is held by little but the contact, H is large, and K
with it: tractions that lift it by a hair's breadth seem to move it freely, though the contact would not let them; each
iteration the pressures take back what the tractions did, and the iteration converges slowly, as
L H L_n^T G_c^-1 L_n H L^T K^-1, which grows with the square of the step. So the answer of the pressures is condensed,

    ds = -X (V dtau),      X = G_c^-1 L_n,      V' = V - V_n X V,      K' = K - N G_c^-1 N^T = G + L V',

with the active set as it is: the Schur complement of a positive semidefinite matrix, which is one. What the tractions
do to the gaps by the local and global modes is left to the iteration. Bounds do not follow the answer either: this
changes how fast a step is found, not what it converges to.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, axpy, dot, real, sync

wp.set_module_options(MODULE_OPTIONS)


COUNT = wp.constant(0)  # active slots that X was made for
RENEWED = wp.constant(1)  # 1 where X and V' are new in this iteration


@wp.func
def is_new(
    model: Model,
    w: int,
    n: int,
    ctl: wp.array2d(dtype=int),
    order: wp.array2d(dtype=int),
    answer_order: wp.array2d(dtype=int),
    answer_state: wp.array2d(dtype=int),
) -> int:
    """1 where there are fresh cells, or the active set is not the one that X was made for."""
    if ctl[w, k.FRESH_CELLS] != ctl[w, k.CELLS] or n != answer_state[w, COUNT]:
        return 1
    a = int(0)
    while a < n:
        if order[w, a] != answer_order[w, a]:
            return 1
        a += 1
    return 0


# X = (U^T U)^-1 L_n over all outer columns, lanes over the columns; U as `contact_solve.factor_and_solve` left it.
@wp.func_native("""
    const int cap = model.slot_capacity, ld = cap + 1, N = model.outer_count, width = model.coupled_capacity;
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double* U = factor.data + (size_t)w * cap * ld;
    const int* list = order.data + (size_t)w * cap;
    double* X = answer.data + (size_t)w * cap * N;
    for (int i = 0; i < n; ++i) {
        double* __restrict x = X + (size_t)i * N;
        const int pair = slot_mode.data[((size_t)w * cap + list[i]) * 2];
        const int* c = model.coupled.data + (size_t)pair * width;
        const double* l = L.data + ((size_t)w * cap + list[i]) * width;
        for (int q = lane; q < N; q += lanes) x[q] = 0.0;
        for (int q = 0; q < model.coupled_count.data[pair]; ++q) if (c[q] % lanes == lane) x[c[q]] += l[q];
        for (int j = 0; j < i; ++j) { const double m = U[(size_t)j * ld + i]; const double* y = X + (size_t)j * N;
            for (int q = lane; q < N; q += lanes) x[q] -= m * y[q]; }
        const double scale = 1.0 / U[(size_t)i * ld + i];
        for (int q = lane; q < N; q += lanes) x[q] *= scale;
    }
    for (int i = n - 1; i >= 0; --i) {
        double* __restrict x = X + (size_t)i * N;
        for (int j = i + 1; j < n; ++j) { const double m = U[(size_t)i * ld + j]; const double* y = X + (size_t)j * N;
            for (int q = lane; q < N; q += lanes) x[q] -= m * y[q]; }
        const double scale = 1.0 / U[(size_t)i * ld + i];
        for (int q = lane; q < N; q += lanes) x[q] *= scale;
    }
    WP_TILE_SYNC();
""")
def answer_of(
    model: Model,
    w: int,
    n: int,
    order: wp.array2d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    factor: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    answer: wp.array(dtype=real),
): ...


@wp.kernel
def answer_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    active: wp.array3d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    order: wp.array2d(dtype=int),
    factor: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    V: wp.array(dtype=real),
    cell_V: wp.array(dtype=real),
    answer: wp.array(dtype=real),
    answer_order: wp.array2d(dtype=int),
    answer_state: wp.array2d(dtype=int),
    motion: wp.array(dtype=real),
    held_V: wp.array(dtype=real),
):
    """Per world: X of the active slots, in the order of the last solve, P = V_n X (`motion`), and V' = V - P V of all
    lines of the cells; kept while slots, cells and the active set stay."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.CHANGES] != 0:
        return
    n = int(0)  # the first slots of `order` are the active ones
    slot = int(0)
    while slot < ctl[w, k.SLOTS]:
        if active[w, slot_mode[w, slot, 0], slot_mode[w, slot, 1]] != 0:
            n += 1
        slot += 1
    renewed = is_new(model, w, n, ctl, order, answer_order, answer_state)
    sync()
    if lane == 0:
        answer_state[w, COUNT] = n
        answer_state[w, RENEWED] = renewed
    if renewed == 0:
        return
    a = lane
    while a < n:
        answer_order[w, a] = order[w, a]
        a += wp.block_dim()
    answer_of(model, w, n, order, slot_mode, factor, L, answer)
    N = model.outer_count
    c = lane
    while c < N * N:
        motion[w * N * N + c] = real(0.0)
        c += wp.block_dim()
    sync()
    a = int(0)
    while a < n:
        start = (w * model.slot_capacity + order[w, a]) * N
        r = int(0)
        while r < N:
            axpy(N, V[start + r], answer, (w * model.slot_capacity + a) * N, motion, (w * N + r) * N)
            r += 1
        a += 1
    sync()
    i = int(0)
    while i < 2 * ctl[w, k.CELLS]:
        line = (w * 2 * model.cell_capacity + i) * N
        r = lane
        while r < N:
            held_V[line + r] = cell_V[line + r] - dot(N, motion, (w * N + r) * N, cell_V, line)
            r += wp.block_dim()
        i += 1


@wp.kernel
def press_with_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    answer: wp.array(dtype=real),
    answer_order: wp.array2d(dtype=int),
    answer_state: wp.array2d(dtype=int),
    cell_V: wp.array(dtype=real),
    weight: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
    base: wp.array2d(dtype=real),
    moved: wp.array(dtype=real),
    pressure: wp.array3d(dtype=real),
):
    """Per world: the pressures with their answer to the tractions found, none below zero."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.CHANGES] != 0:
        return
    N = model.outer_count
    c = lane
    while c < N:
        moved[w * N + c] = real(0.0)
        c += wp.block_dim()
    sync()
    i = int(0)
    while i < 2 * ctl[w, k.CELLS]:
        change = tau[w, i] - base[w, i]
        if change != real(0.0):
            axpy(N, change, cell_V, (w * 2 * model.cell_capacity + i) * N, moved, w * N)
        i += 1
    sync()
    a = lane
    while a < answer_state[w, COUNT]:
        slot = answer_order[w, a]
        pair = slot_mode[w, slot, 0]
        m = slot_mode[w, slot, 1]
        change = -dot(N, answer, (w * model.slot_capacity + a) * N, moved, w * N)
        pressure[w, pair, m] = wp.max(pressure[w, pair, m] + change / weight[w, pair], real(0.0))
        a += wp.block_dim()
