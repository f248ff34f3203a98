"""Assembly of rows of the local compliance G: within a pair, and between pairs that load the same body.

Within a pair G_ij is as in `contact_compliance`. Two nodes i and j of different pairs are coupled by a body that both
pairs load: by its modes that are not condensed, through the retained unknowns; by the other modes, through
J_i sigma^-1 J_j^T; and by its local modes. With psi_i^s the load of a node on surface s,

    G_ij += sum over s, t of psi_j^t . (D_ts psi_i^s),

exactly, with all nodes of both stencils: a load lumped at its node makes G indefinite if the patches of two pairs lie
within some columns of each other. D_ts psi_i^s is computed once per node over the window of the other pair and read by
all nodes of that pair.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.normal.pair_forces import surface_of
from warpffrf_kernels.surfaces.responses import first_column, load_of, place_of_load

wp.set_module_options(MODULE_OPTIONS)


# Row `slot` of G for the slots of the same pair up to itself, and its mirror. Native for
# contiguous inner loops like `axpy`; not measured separately.
@wp.func_native("""
    const int pair = slot_node.data[((size_t)w * model.capacity.slots + slot) * 2];
    const int m = slot_node.data[((size_t)w * model.capacity.slots + slot) * 2 + 1];
    const int A = model.pairs.first.data[pair], B = model.pairs.second.data[pair];
    const int own_table = model.responses.normal.data[model.responses.load_start.data[2 * pair]];
    const int rows = model.surfaces.rows.data[A], block = model.responses.source_block.data[own_table];
    const int reach = model.responses.reach.data[own_table], width_a = model.responses.width.data[own_table];
    const int SC = model.window.stencil_columns, SR = model.window.stencil_rows;
    const int rows_b = model.surfaces.rows.data[B], width = model.pairs.most_modes, cap = model.capacity.slots;
    const double* DA = model.responses.number.data + model.responses.start.data[own_table];
    const size_t grid_node = (size_t)(w * model.pairs.count + pair) * model.window.grid_nodes + m;
    const double* l = stencil.data + grid_node * SC * SR;
    const int* at = stencil_at.data + grid_node * 2;
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
        if (slot_node.data[((size_t)w * cap + j) * 2] != pair) continue;
        double g = 0.0, f = 0.0;
        {
            const int mj = slot_node.data[((size_t)w * cap + j) * 2 + 1];
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
    slot_node: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    scratch: wp.array(dtype=real),
    G: wp.array3d(dtype=real),
): ...


# Entries of row `slot` of G for the preceding slots that belong to other pairs, by the condensed modes.
# Native like `couple`.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.most_modes;
    const int* const slots = slot_node.data + (size_t)w * cap * 2;
    const double* own = J.data + ((size_t)w * cap + slot) * width;
    const double* s = receptance.data + (size_t)w * model.modes.count;
    const int *first = model.pairs.first.data, *second = model.pairs.second.data;
    for (int j = WP_TILE_THREAD_IDX; j < slot; j += WP_TILE_BLOCK_DIM) {
        if (slots[2 * j] == slots[2 * slot] || model.pairs.family.data[slots[2 * j]] == patch) continue;
        double g = 0.0;
        for (int a = 0, at_a = 0; a < 2; ++a) {
            const int sa = (a ? second : first)[slots[2 * slot]], count = model.surfaces.modal_count.data[sa];
            for (int b = 0, at_b = 0; b < 2; ++b) {
                const int sb = (b ? second : first)[slots[2 * j]];
                if (model.surfaces.body.data[sa] >= 0 && model.surfaces.body.data[sa] == model.surfaces.body.data[sb]) {
                    const double *p = own + at_a, *q = J.data + ((size_t)w * cap + j) * width + at_b;
                    const double* r = s + model.surfaces.modal_start.data[sa];
                    double sum[4] = {0.0}; int n = 0;  // chains of sums wait for each other
                    for (; n + 3 < count; n += 4) for (int c = 0; c < 4; ++c) sum[c] += p[n + c] * r[n + c] * q[n + c];
                    for (; n < count; ++n) g += p[n] * r[n] * q[n];
                    g += (sum[0] + sum[1]) + (sum[2] + sum[3]);
                }
                at_b += model.surfaces.modal_count.data[sb];
            }
            at_a += count;
        }
        G.data[((size_t)w * cap + slot) * cap + j] = g;
    }
""")
def couple_others(
    model: Model,
    w: int,
    slot: int,
    patch: int,
    slot_node: wp.array3d(dtype=int),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    G: wp.array3d(dtype=real),
): ...


@kernel
def assemble(run: Run, geometry: ContactGeometry, normal: ContactSolve, impulses: ImpulsiveContact):
    """Per world: rows of G of the new slots, within their pairs."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        if model.pairs.family[pair] != PATCH:
            couple(
                model, w, slot, geometry.center[w, pair, 0] - model.window.half, normal.slot_node, geometry.stencil,
                geometry.stencil_at, normal.T, normal.J, impulses.contact_receptance, normal.scaled_modes, normal.G,
            )  # fmt: skip
        slot += 1


# The mirror of rows `fresh` to `slots` of G between pairs, eight at a time, because columns are far apart in memory.
# Lanes over the columns of these rows.
@wp.func_native("""
    const int cap = model.capacity.slots; const int* pair = slot_node.data + (size_t)w * cap * 2;
    double* g = G.data + (size_t)w * cap * cap;
    for (int s = fresh; s < slots; s += 8) {
        const int end = s + 8 < slots ? s + 8 : slots;
        for (int j = WP_TILE_THREAD_IDX; j < end - 1; j += WP_TILE_BLOCK_DIM)
            for (int i = j < s ? s : j + 1; i < end; ++i)
                if (pair[2 * i] != pair[2 * j]) g[(size_t)j * cap + i] = g[(size_t)i * cap + j];
    }
    WP_TILE_SYNC();
""")
def mirror_between(
    model: Model, w: int, fresh: int, slots: int, slot_node: wp.array3d(dtype=int), G: wp.array3d(dtype=real)
): ...


@wp.func
def lay_out(
    model: Model, w: int, m: int, loads: int, reads: int, low: int, columns: int, geometry: ContactGeometry, start: int,
    normal: ContactSolve,
):  # fmt: skip
    """Adds the displacement due to the load of node m on side `loads` to `field`: `columns` columns of the window of
    side `reads`, from `low` on."""
    pair = loads / 2
    table = model.responses.normal[load_of(model, reads, loads)]
    count = columns * model.responses.target_lines[table]
    target = first_column(model, w, reads, geometry.center) + low
    middle = target + columns / 2
    origin = first_column(model, w, loads, geometry.center)
    if loads % 2 == 0:
        rows = model.responses.source_lines[table]
        at = place_of_load(model, table, origin + m / rows, m % rows, target, middle)
        if at >= 0:
            axpy(count, real(1.0), model.responses.number, at, normal.field_beside, start)
    else:
        along = model.responses.width[table] * model.responses.target_lines[table]  # stride of lines
        c = int(0)
        while c < model.window.stencil_columns:
            at = place_of_load(model, table, origin + geometry.stencil_at[w, pair, m, 0] + c, 0, target, middle)
            r = int(0)
            while at >= 0 and r < model.window.stencil_rows:
                weight = geometry.stencil[w, pair, m, c * model.window.stencil_rows + r]
                if weight != real(0.0):
                    line = at + (geometry.stencil_at[w, pair, m, 1] + r) * along
                    axpy(count, weight, model.responses.number, line, normal.field_beside, start)
                r += 1
            c += 1


@kernel
def assemble_between(run: Run, geometry: ContactGeometry, normal: ContactSolve, impulses: ImpulsiveContact):
    """Per world: rows of G of the new slots, between pairs, by condensed modes and by local modes."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    start = w * wp.max(model.window.grid_nodes, model.window.nodes)
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots:
        if model.pairs.family[normal.slot_node[w, slot, 0]] != PATCH:  # cells of a patch: `pressure_solve`
            couple_others(model, w, slot, PATCH, normal.slot_node, normal.J, impulses.contact_receptance, normal.G)
        slot += 1
    sync()
    mirror_between(model, w, run.ctl[w].fresh, run.ctl[w].slots, normal.slot_node, normal.G)
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        m = normal.slot_node[w, slot, 1]
        for side in range(2):
            loads = 2 * pair + side
            n = model.responses.load_start[loads]  # sides on one body load each other
            while n < model.responses.load_start[loads + 1]:
                reads = model.responses.load_side[n]
                other = reads / 2
                if other == pair:
                    n += 1
                    continue
                ratio = impulses.weight[w, pair] / impulses.weight[w, other]
                rows = model.surfaces.rows[surface_of(model, other, reads % 2)]
                rows_a = model.surfaces.rows[model.pairs.first[other]]
                first = geometry.window[w, other, 0] + model.window.half
                last = geometry.window[w, other, 1] + model.window.half
                low = first
                columns = last - first + 1
                if reads % 2 != 0:
                    low = geometry.second_window[w, other, 0]
                    columns = geometry.second_window[w, other, 1] - low + 1
                i = lane
                while i < columns * rows:
                    normal.field_beside[start + i] = real(0.0)
                    i += wp.block_dim()
                sync()
                lay_out(model, w, m, loads, reads, low, columns, geometry, start, normal)
                sync()
                grid_node = first * rows_a + lane
                while grid_node < (last + 1) * rows_a:
                    j = normal.slot_of[w, other, grid_node]
                    if j >= 0 and j < slot:
                        g = real(0.0)
                        if reads % 2 == 0:
                            g = normal.field_beside[start + grid_node - low * rows]
                        else:
                            e = int(0)
                            while e < model.window.stencil_columns * model.window.stencil_rows:
                                part = geometry.stencil[w, other, grid_node, e]
                                if part != real(0.0):
                                    column = (
                                        geometry.stencil_at[w, other, grid_node, 0]
                                        + e / model.window.stencil_rows
                                        - low
                                    )
                                    row = geometry.stencil_at[w, other, grid_node, 1] + e % model.window.stencil_rows
                                    if column >= 0 and column < columns:
                                        g += part * normal.field_beside[start + column * rows + row]
                                e += 1
                        normal.G[w, slot, j] = normal.G[w, slot, j] + g * ratio
                        normal.G[w, j, slot] = normal.G[w, j, slot] + g / ratio
                    grid_node += wp.block_dim()
                sync()
                n += 1
        slot += 1
