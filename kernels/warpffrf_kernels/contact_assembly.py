"""Rows of the local compliance G assembled: within a pair, and between pairs that load the same body or surface.

Within a pair G_ij is as in `contact_compliance`. Two hats i and j of different pairs feel each other through the global
modes of a body that both pairs load, J_i sigma^-1 J_j^T over the modes of that body, and, where a surface s serves both
pairs, through its local modes: psi_i^s D_s psi_j^s with psi^s the load of a hat on that surface. A hat of a first grid
is looked up in the weak tables of `shared_surface`; that of a second grid acts there with its whole load at the node
nearest to its middle. The patches of two pairs lie apart, so that this is off by the square of a hat over their
distance; the gaps themselves are exact (`shared_surface`), G only steers the iteration.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# Row `slot` of G against the slots of the same pair up to itself (0 for those of others), and its mirror. Native for
# contiguous inner loops like `axpy`; not measured separately.
@wp.func_native("""
    const int pair = slot_mode.data[((size_t)w * model.slot_capacity + slot) * 2];
    const int m = slot_mode.data[((size_t)w * model.slot_capacity + slot) * 2 + 1];
    const int A = model.pair_first.data[pair], B = model.pair_second.data[pair];
    const int rows = model.surface_rows.data[A], block = model.surface_block.data[A];
    const int reach = model.surface_reach.data[A], width_a = block + 2 * reach;
    const int SC = model.stencil_columns, SR = model.stencil_rows;
    const int rows_b = model.surface_rows.data[B], width = model.pair_modes, cap = model.slot_capacity;
    const double* DA = model.self_compliance.data + model.surface_lag_start.data[A];
    const size_t mode = (size_t)(w * model.pair_count + pair) * model.mode_capacity + m;
    const double* l = stencil.data + mode * SC * SR;
    const int* at = stencil_at.data + mode * 2;
    const double* Ji = J.data + ((size_t)w * cap + slot) * width;
    const int first_a = model.surface_modal_start.data[A], count_a = model.surface_modal_count.data[A];
    const int first_b = model.surface_modal_start.data[B], count_b = model.surface_modal_count.data[B];
    const double* s = receptance.data + (size_t)w * model.modal_count;
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
        if (slot_mode.data[((size_t)w * cap + j) * 2] == pair) {
            const int mj = slot_mode.data[((size_t)w * cap + j) * 2 + 1];
            const int other = origin + mj / rows, part = ((other % block) + block) % block;
            const int target = own - (other - part) + reach;
            g = DA[((size_t)(part * rows + mj % rows) * width_a + target) * rows + m % rows];
            const double* t = T.data + ((size_t)w * cap + j) * model.node_capacity;
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
    slot_mode: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    scratch: wp.array(dtype=real),
    G: wp.array3d(dtype=real),
): ...


# Entries of row `slot` of G with the slots before it that belong to other pairs, and their mirror; after `couple`,
# whose row of J sigma^-1 is still in `scratch`. Native like `couple`.
@wp.func_native("""
    const int cap = model.slot_capacity, width = model.pair_modes, P = model.pair_count;
    const int SC = model.stencil_columns, SR = model.stencil_rows;
    const int* const slots = slot_mode.data + (size_t)w * cap * 2;
    const double* scaled = scratch.data + (size_t)w * width;
    // a hat on its two surfaces: column over full turns, row, and how much of the table's entry it takes
    int column[2][2], row[2][2]; double part[2][2];
    for (int j = WP_TILE_THREAD_IDX; j < slot; j += WP_TILE_BLOCK_DIM) {
        if (slots[2 * j] == slots[2 * slot]) continue;
        double g = 0.0;
        bool placed = false;
        for (int a = 0, at_a = 0; a < 2; ++a) {
            const int sa = 2 * slots[2 * slot] + a, count = model.surface_modal_count.data[sa];
            for (int b = 0, at_b = 0; b < 2; ++b) {
                const int sb = 2 * slots[2 * j] + b;
                if (model.surface_body.data[sa] >= 0 && model.surface_body.data[sa] == model.surface_body.data[sb]) {
                    const double *p = scaled + at_a, *q = J.data + ((size_t)w * cap + j) * width + at_b;
                    for (int n = 0; n < count; ++n) g += p[n] * q[n];
                    for (int n = model.neighbour_start.data[sa]; n < model.neighbour_start.data[sa + 1]; ++n) {
                        if (model.neighbour.data[n] != sb) continue;
                        for (int e = 0; e < 2 && !placed; ++e) {  // of hat i and of hat j
                            const int pair = slots[2 * (e ? j : slot)], m = slots[2 * (e ? j : slot) + 1];
                            const int rows = model.surface_rows.data[2 * pair];
                            const int* c = center.data + ((size_t)w * P + pair) * 3;
                            column[e][0] = c[0] - model.half_window + m / rows; row[e][0] = m % rows; part[e][0] = 1.0;
                            const size_t mode = (size_t)(w * P + pair) * model.mode_capacity + m;
                            const double* l = stencil.data + mode * SC * SR;
                            double sum = 0.0, x = 0.0, y = 0.0;
                            for (int u = 0; u < SC; ++u) for (int v = 0; v < SR; ++v) {
                                sum += l[u * SR + v]; x += u * l[u * SR + v]; y += v * l[u * SR + v];
                            }
                            part[e][1] = sum;
                            const double middle = sum > 0.0 ? 1.0 / sum : 0.0;
                            column[e][1] = c[1] - model.second_half_window + stencil_at.data[mode * 2]
                                           + (int)(x * middle + 0.5);
                            row[e][1] = stencil_at.data[mode * 2 + 1] + (int)(y * middle + 0.5);
                        }
                        placed = true;
                        const int turn = model.surface_turn.data[sa], block = model.surface_block.data[sa];
                        const int rows = model.surface_rows.data[sa], reach = model.surface_reach.data[sa];
                        const int target = column[0][a];
                        int source = column[1][b];
                        if (turn > 0) {  // the way round that is shorter
                            int d = (((source - target) % turn) + turn) % turn;
                            if (2 * d > turn) d -= turn;
                            source = target + d;
                        } else if (source < 0 || source >= block || target < 0 || target >= block) continue;
                        const int own = ((source % block) + block) % block;
                        const size_t at = ((size_t)own * rows + row[1][b]) * (block + 2 * reach)
                                          + target - (source - own) + reach;
                        g += part[0][a] * part[1][b]
                             * model.shared_compliance.data[model.neighbour_table.data[n] + at * rows + row[0][a]];
                    }
                }
                at_b += model.surface_modal_count.data[sb];
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
    center: wp.array3d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    J: wp.array(dtype=real),
    scratch: wp.array(dtype=real),
    G: wp.array3d(dtype=real),
): ...


@wp.kernel
def assemble(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    center: wp.array3d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    scratch: wp.array(dtype=real),
    G: wp.array3d(dtype=real),
):
    """Per world: rows of G of the fresh slots."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0:
        return
    slot = ctl[w, k.FRESH]
    while slot < ctl[w, k.SLOTS]:
        pair = slot_mode[w, slot, 0]
        couple(
            model, w, slot, center[w, pair, 0] - model.half_window, slot_mode, stencil, stencil_at,
            T, J, receptance, scratch, G,
        )  # fmt: skip
        if model.pair_count > 1:
            couple_others(model, w, slot, center, slot_mode, stencil, stencil_at, J, scratch, G)
        slot += 1
