"""Rows of the local compliance G assembled: within a pair, and between pairs that load the same body.

Within a pair G_ij is as in `contact_compliance`. Two hats i and j of different pairs feel each other through the global
modes of a body that both pairs load, J_i sigma^-1 J_j^T over the modes of that body, and, where a surface serves both
pairs, through its local modes, which `shared_assembly` adds.
"""

import warp as wp

from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# Row `slot` of G against the slots of the same pair up to itself (0 for those of others), and its mirror. Native for
# contiguous inner loops like `axpy`; not measured separately.
@wp.func_native("""
    const int pair = slot_hat.data[((size_t)w * model.capacity.slots + slot) * 2];
    const int m = slot_hat.data[((size_t)w * model.capacity.slots + slot) * 2 + 1];
    const int A = model.pairs.first.data[pair], B = model.pairs.second.data[pair];
    const int rows = model.surfaces.rows.data[A], block = model.surfaces.block.data[A];
    const int reach = model.surfaces.reach.data[A], width_a = block + 2 * reach;
    const int SC = model.window.stencil_columns, SR = model.window.stencil_rows;
    const int rows_b = model.surfaces.rows.data[B], width = model.pairs.most_modes, cap = model.capacity.slots;
    const double* DA = model.surfaces.self_compliance.data + model.surfaces.lag_start.data[A];
    const size_t hat = (size_t)(w * model.pairs.count + pair) * model.window.hats + m;
    const double* l = stencil.data + hat * SC * SR;
    const int* at = stencil_at.data + hat * 2;
    const double* Ji = J.data + ((size_t)w * cap + slot) * width;
    const int first_a = model.surfaces.modal_start.data[A], count_a = model.surfaces.modal_count.data[A];
    const int first_b = model.surfaces.modal_start.data[B], count_b = model.surfaces.modal_count.data[B];
    const double* s = receptance.data + (size_t)w * model.modes.count;
    const int own = origin + m / rows;
    double weight[256]; int node[256], count = 0;
    double* scaled = scratch.data + (size_t)w * width;
    WP_TILE_SYNC();
    for (int n = WP_TILE_THREAD_IDX; n < count_a + count_b; n += WP_TILE_BLOCK_DIM)
        scaled[n] = Ji[n] * s[n < count_a ? first_a + n : first_b + n - count_a];
    WP_TILE_SYNC();
    for (int c = 0; c < SC; ++c) for (int r = 0; r < SR; ++r)
        if (l[c * SR + r] != 0.0) { weight[count] = l[c * SR + r]; node[count++] = (at[0] + c) * rows_b + at[1] + r; }
    for (int j = WP_TILE_THREAD_IDX; j <= slot; j += WP_TILE_BLOCK_DIM) {
        double g = 0.0, f = 0.0;
        if (slot_hat.data[((size_t)w * cap + j) * 2] == pair) {
            const int mj = slot_hat.data[((size_t)w * cap + j) * 2 + 1];
            const int other = origin + mj / rows, part = ((other % block) + block) % block;
            const int target = own - (other - part) + reach;
            g = DA[((size_t)(part * rows + mj % rows) * width_a + target) * rows + m % rows];
            const double* t = T.data + ((size_t)w * cap + j) * model.window.nodes;
            for (int e = 0; e < count; ++e) g += weight[e] * t[node[e]];
            const double* Jj = J.data + ((size_t)w * cap + j) * width;
            int n = 0; const int all = count_a + count_b;
            if (all >= 16) {  // as in `dot`
                double sum[16] = {0.0};
                for (; n + 15 < all; n += 16) for (int c = 0; c < 16; ++c) sum[c] += scaled[n + c] * Jj[n + c];
                for (int c = 0; c < 16; ++c) f += sum[c];
            }
            for (; n < all; ++n) f += scaled[n] * Jj[n];
        }
        G.data[((size_t)w * cap + slot) * cap + j] = g + f; G.data[((size_t)w * cap + j) * cap + slot] = g + f;
    }
""")
def couple(
    model: Model,
    w: int,
    slot: int,
    origin: int,
    slot_hat: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    scratch: wp.array(dtype=real),
    G: wp.array3d(dtype=real),
): ...


# Entries of row `slot` of G with the slots before it that belong to other pairs, and their mirror. The row of
# J sigma^-1 is the one that `couple` has left in `scratch`. Native like `couple`.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.most_modes;
    const int* const slots = slot_hat.data + (size_t)w * cap * 2;
    const double* scaled = scratch.data + (size_t)w * width;
    for (int j = WP_TILE_THREAD_IDX; j < slot; j += WP_TILE_BLOCK_DIM) {
        if (slots[2 * j] == slots[2 * slot]) continue;
        double g = 0.0;
        for (int a = 0, at_a = 0; a < 2; ++a) {
            const int sa = 2 * slots[2 * slot] + a, count = model.surfaces.modal_count.data[sa];
            for (int b = 0, at_b = 0; b < 2; ++b) {
                const int sb = 2 * slots[2 * j] + b;
                if (model.surfaces.body.data[sa] >= 0 && model.surfaces.body.data[sa] == model.surfaces.body.data[sb]) {
                    const double *p = scaled + at_a, *q = J.data + ((size_t)w * cap + j) * width + at_b;
                    for (int n = 0; n < count; ++n) g += p[n] * q[n];
                }
                at_b += model.surfaces.modal_count.data[sb];
            }
            at_a += count;
        }
        G.data[((size_t)w * cap + slot) * cap + j] = g; G.data[((size_t)w * cap + j) * cap + slot] = g;
    }
""")
def couple_others(
    model: Model,
    w: int,
    slot: int,
    slot_hat: wp.array3d(dtype=int),
    J: wp.array(dtype=real),
    scratch: wp.array(dtype=real),
    G: wp.array3d(dtype=real),
): ...


@wp.kernel
def assemble(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    scratch: inout(wp.array(dtype=real)),
    G: out(wp.array3d(dtype=real)),
):
    """Per world: rows of G of the fresh slots."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    slot = ctl[w].fresh
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        couple(
            model, w, slot, center[w, pair, 0] - model.window.half, slot_hat, stencil, stencil_at,
            T, J, receptance, scratch, G,
        )  # fmt: skip
        if model.pairs.count > 1:
            couple_others(model, w, slot, slot_hat, J, scratch, G)
        slot += 1
