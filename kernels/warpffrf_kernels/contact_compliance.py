"""Rows of the local compliance G = Psi^T (C_A + C_B) Psi on the modes in play ("slots"), assembled once each.

With the hat compliance D of each surface (`u = D f`, both in hats) and the stencil l_j, the load of the second surface under a unit
pressure hat j of the first:

    G_ij = (M D_A M)_ij + l_i . (D_B l_j) + J_i sigma^-1 J_j^T,      J_i = [-(M Phi_A)_i, -l_i Phi_B].

The last term condenses the global modes: their tangent sigma is diagonal (`receptance` = 1/sigma), so it costs modes x slots^2 / 2. `M D_A M` is
precomputed; `T_j = D_B l_j` is kept, because it also gives the displacement of the second surface at every node of the window.
A slot stays assembled until the grids move against each other, so an active set that changes pays for the change only.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def take_slots(
    model: Model,
    ctl: wp.array2d(dtype=int),
    active: wp.array3d(dtype=int),
    area: wp.array3d(dtype=real),
    phase: wp.array3d(dtype=real),
    slot_of: wp.array3d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
):
    """Per world: a slot for each active mode that has none; all slots are given back first when the grids have moved."""
    w = wp.tid()
    if ctl[w, k.RUN] == 0:
        return
    capacity = model.mode_capacity
    if ctl[w, k.REASSEMBLE] != 0:
        ctl[w, k.SLOTS] = 0
        pair = int(0)
        while pair < model.pair_count:
            m = int(0)
            while m < capacity:
                slot_of[w, pair, m] = -1
                m += 1
            for i in range(4):
                phase[w, pair, i] = phase[w, pair, 4 + i]
            pair += 1
        ctl[w, k.REASSEMBLE] = 0
    count = ctl[w, k.SLOTS]
    ctl[w, k.FRESH] = count
    number = int(0)
    pair = int(0)
    while pair < model.pair_count:
        m = int(0)
        while m < capacity:
            if active[w, pair, m] != 0 and area[w, pair, m] == real(0.0):
                active[w, pair, m] = 0
            if active[w, pair, m] != 0:
                number += 1
                if slot_of[w, pair, m] < 0:
                    if count < model.slot_capacity:
                        slot_of[w, pair, m] = count
                        slot_mode[w, count, 0] = pair
                        slot_mode[w, count, 1] = m
                    count += 1
            m += 1
        pair += 1
    if count > model.slot_capacity:
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.CAPACITY
        ctl[w, k.SPARE] = wp.max(ctl[w, k.SPARE], count)
        ctl[w, k.RUN] = 0
        count = model.slot_capacity
    ctl[w, k.SLOTS] = count
    ctl[w, k.ACTIVE] = number


# T_j over the columns of the second surface that the window can touch. Lanes over (slot, column).
# Measured against the same loops in Warp's Python: the whole step is about twice as fast.
@wp.func_native("""
    const int rows = model.surface_rows.data[B], block = model.surface_block.data[B], sectors = model.surface_sectors.data[B];
    const int turn = model.surface_turn.data[B], side = block * rows, SC = model.stencil_columns, SR = model.stencil_rows;
    const double* D = model.compliance.data + model.surface_lag_start.data[B];
    const double* l = stencil.data + ((size_t)(w * model.pair_count + pair) * model.mode_capacity + m) * SC * SR;
    const int* at = stencil_at.data + ((size_t)(w * model.pair_count + pair) * model.mode_capacity + m) * 2;
    double* t = T.data + ((size_t)w * model.slot_capacity + slot) * model.node_capacity + (size_t)column * rows;
    for (int z = 0; z < rows; ++z) t[z] = 0.0;
    int target = origin + column;
    if (turn > 0) target = ((target % turn) + turn) % turn;
    else if (target < 0 || target >= model.surface_columns.data[B]) return;
    const int tb = target / block, tc = target % block;
    for (int c = 0; c < SC; ++c) {
        int source = origin + at[0] + c;
        if (turn > 0) source = ((source % turn) + turn) % turn;
        else if (source < 0 || source >= model.surface_columns.data[B]) continue;
        int lag = source / block - tb;
        if (lag < 0) lag += sectors;
        const double* d = D + ((size_t)lag * side + (size_t)(source % block) * rows) * side + tc * rows;
        for (int r = 0; r < SR; ++r) {
            const int row = at[1] + r;
            const double weight = l[c * SR + r];
            if (row >= rows || weight == 0.0) continue;
            const double* x = d + (size_t)row * side;
            for (int z = 0; z < rows; ++z) t[z] += weight * x[z];
        }
    }
""")
def spread(
    model: Model,
    w: int,
    pair: int,
    B: int,
    slot: int,
    m: int,
    column: int,
    origin: int,
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array3d(dtype=real),
): ...


@wp.kernel
def respond(
    model: Model,
    ctl: wp.array2d(dtype=int),
    center: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array3d(dtype=real),
):
    """Lanes over (fresh slot, column of the second surface): T_j = D_B l_j."""
    w, lane = wp.tid()
    if ctl[w, k.RUN] == 0:
        return
    fresh = ctl[w, k.FRESH]
    columns = model.second_columns
    i = lane
    while i < (ctl[w, k.SLOTS] - fresh) * columns:
        slot = fresh + i / columns
        column = i % columns
        pair = slot_mode[w, slot, 0]
        if column >= second_window[w, pair, 0] and column <= second_window[w, pair, 1]:
            spread(
                model, w, pair, model.pair_second[pair], slot, slot_mode[w, slot, 1], column,
                center[w, pair, 1] - model.second_half_window, stencil, stencil_at, T,
            )  # fmt: skip
        i += wp.block_dim()


@wp.func
def node_of(model: Model, surface: int, column: int, row: int) -> int:
    """Flat grid node of a column counted over full turns; -1 where the grid has none."""
    turn = model.surface_turn[surface]
    c = column
    if turn > 0:
        c = ((column % turn) + turn) % turn
    if c < 0 or c >= model.surface_columns[surface]:
        return -1
    return c * model.surface_rows[surface] + row


@wp.kernel
def modal_rows(
    model: Model,
    ctl: wp.array2d(dtype=int),
    center: wp.array3d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    J: wp.array3d(dtype=real),
):
    """Lanes over (fresh slot, mode of the pair): gradient of the weak gap by the global modes of A, then of B."""
    w, lane = wp.tid()
    if ctl[w, k.RUN] == 0:
        return
    fresh = ctl[w, k.FRESH]
    width = model.pair_modes
    i = lane
    while i < (ctl[w, k.SLOTS] - fresh) * width:
        slot = fresh + i / width
        n = i % width
        pair = slot_mode[w, slot, 0]
        m = slot_mode[w, slot, 1]
        A = model.pair_first[pair]
        B = model.pair_second[pair]
        body_a = model.surface_body[A]
        body_b = model.surface_body[B]
        modes_a = model.modal_start[body_a + 1] - model.modal_start[body_a]
        modes_b = model.modal_start[body_b + 1] - model.modal_start[body_b]
        value = real(0.0)
        if n < modes_a:
            rows = model.surface_rows[A]
            column = m / rows
            node = node_of(model, A, center[w, pair, 0] + column - model.half_window, m - column * rows)
            if node >= 0:
                value = -model.mode_moment[model.surface_mode_start[A] + node * modes_a + n]
        elif n < modes_a + modes_b:
            base = center[w, pair, 1] - model.second_half_window + stencil_at[w, pair, m, 0]
            c = int(0)
            while c < model.stencil_columns:
                r = int(0)
                while r < model.stencil_rows:
                    row = stencil_at[w, pair, m, 1] + r
                    if row < model.surface_rows[B]:
                        node = node_of(model, B, base + c, row)
                        if node >= 0:
                            value -= (
                                stencil[w, pair, m, c * model.stencil_rows + r]
                                * model.mode_normal[model.surface_mode_start[B] + node * modes_b + n - modes_a]
                            )
                    r += 1
                c += 1
        J[w, slot, n] = value
        i += wp.block_dim()


# Row `slot` of G against the slots up to itself, and its mirror.
@wp.func_native("""
    const int pair = slot_mode.data[((size_t)w * model.slot_capacity + slot) * 2];
    const int m = slot_mode.data[((size_t)w * model.slot_capacity + slot) * 2 + 1];
    const int A = model.pair_first.data[pair], B = model.pair_second.data[pair];
    const int rows = model.surface_rows.data[A], block = model.surface_block.data[A], sectors = model.surface_sectors.data[A];
    const int turn = model.surface_turn.data[A], side = block * rows, SC = model.stencil_columns, SR = model.stencil_rows;
    const int rows_b = model.surface_rows.data[B], width = model.pair_modes, cap = model.slot_capacity;
    const double* DA = model.self_compliance.data + model.surface_lag_start.data[A];
    const size_t mode = (size_t)(w * model.pair_count + pair) * model.mode_capacity + m;
    const double* l = stencil.data + mode * SC * SR;
    const int* at = stencil_at.data + mode * 2;
    const double* Ji = J.data + ((size_t)w * cap + slot) * width;
    const int first_a = model.modal_start.data[model.surface_body.data[A]];
    const int count_a = model.modal_start.data[model.surface_body.data[A] + 1] - first_a;
    const int first_b = model.modal_start.data[model.surface_body.data[B]];
    const int count_b = model.modal_start.data[model.surface_body.data[B] + 1] - first_b;
    const double* s = receptance.data + (size_t)w * model.modal_count;
    int own = origin + m / rows;
    if (turn > 0) own = ((own % turn) + turn) % turn;
    for (int j = WP_TILE_THREAD_IDX; j <= slot; j += WP_TILE_BLOCK_DIM) {
        if (slot_mode.data[((size_t)w * cap + j) * 2] != pair) { G.data[((size_t)w * cap + slot) * cap + j] = 0.0;
            G.data[((size_t)w * cap + j) * cap + slot] = 0.0; local.data[((size_t)w * cap + slot) * cap + j] = 0.0;
            local.data[((size_t)w * cap + j) * cap + slot] = 0.0; continue; }
        const int mj = slot_mode.data[((size_t)w * cap + j) * 2 + 1];
        int other = origin + mj / rows;
        if (turn > 0) other = ((other % turn) + turn) % turn;
        int lag = own / block - other / block;
        if (lag < 0) lag += sectors;
        double g = DA[((size_t)lag * side + (own % block) * rows + m % rows) * side + (other % block) * rows + mj % rows];
        const double* t = T.data + ((size_t)w * cap + j) * model.node_capacity + (size_t)at[0] * rows_b + at[1];
        for (int c = 0; c < SC; ++c, t += rows_b)
            for (int r = 0; r < SR; ++r) if (l[c * SR + r] != 0.0) g += l[c * SR + r] * t[r];
        local.data[((size_t)w * cap + slot) * cap + j] = g; local.data[((size_t)w * cap + j) * cap + slot] = g;
        const double* Jj = J.data + ((size_t)w * cap + j) * width;
        for (int n = 0; n < count_a; ++n) g += Ji[n] * Jj[n] * s[first_a + n];
        for (int n = 0; n < count_b; ++n) g += Ji[count_a + n] * Jj[count_a + n] * s[first_b + n];
        G.data[((size_t)w * cap + slot) * cap + j] = g; G.data[((size_t)w * cap + j) * cap + slot] = g;
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
    T: wp.array3d(dtype=real),
    J: wp.array3d(dtype=real),
    receptance: wp.array2d(dtype=real),
    local: wp.array3d(dtype=real),
    G: wp.array3d(dtype=real),
): ...


@wp.kernel
def assemble(
    model: Model,
    ctl: wp.array2d(dtype=int),
    center: wp.array3d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array3d(dtype=real),
    J: wp.array3d(dtype=real),
    receptance: wp.array2d(dtype=real),
    local: wp.array3d(dtype=real),
    G: wp.array3d(dtype=real),
):
    """Per world: rows of G of the fresh slots; `local` is the part of the local modes alone."""
    w, lane = wp.tid()
    if ctl[w, k.RUN] == 0:
        return
    slot = ctl[w, k.FRESH]
    while slot < ctl[w, k.SLOTS]:
        pair = slot_mode[w, slot, 0]
        couple(
            model, w, slot, center[w, pair, 0] - model.half_window, slot_mode, stencil, stencil_at,
            T, J, receptance, local, G,
        )  # fmt: skip
        slot += 1


@wp.kernel
def outer_rows(
    model: Model,
    ctl: wp.array2d(dtype=int),
    axes: wp.array2d(dtype=mat33),
    r1: wp.array2d(dtype=vec3),
    wrench: wp.array4d(dtype=real),
    slot_mode: wp.array3d(dtype=int),
    J: wp.array3d(dtype=real),
    receptance: wp.array2d(dtype=real),
    C_modal: wp.array3d(dtype=real),
    inverse: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    V: wp.array3d(dtype=real),
):
    """Lanes over slots: gradient L of the gap by rigid coordinates and multipliers, and V = inverse . L.

    L = [d gap/d(rigid), -J sigma^-1 C_modal^T], over the columns in `coupled` of the pair.
    """
    w, lane = wp.tid()
    if ctl[w, k.RUN] == 0:
        return
    first = ctl[w, k.FRESH]
    if ctl[w, k.MOVED] != 0:
        first = 0
    slot = first + lane
    while slot < ctl[w, k.SLOTS]:
        pair = slot_mode[w, slot, 0]
        m = slot_mode[w, slot, 1]
        A = model.surface_body[model.pair_first[pair]]
        B = model.surface_body[model.pair_second[pair]]
        f = vec3(wrench[w, pair, m, 0], wrench[w, pair, m, 1], wrench[w, pair, m, 2])
        t = vec3(wrench[w, pair, m, 3], wrench[w, pair, m, 4], wrench[w, pair, m, 5])
        t_a = wp.transpose(axes[w, A]) * t
        t_b = wp.transpose(axes[w, B]) * (t + wp.cross(r1[w, A] - r1[w, B], f))
        for i in range(3):
            L[w, slot, i] = f[i]
            L[w, slot, 3 + i] = t_a[i]
            L[w, slot, 6 + i] = -f[i]
            L[w, slot, 9 + i] = -t_b[i]
        first_a = model.modal_start[A]
        count_a = model.modal_start[A + 1] - first_a
        first_b = model.modal_start[B]
        count_b = model.modal_start[B + 1] - first_b
        count = model.coupled_count[pair]
        c = int(12)
        while c < count:
            row = model.coupled[pair, c] - 6 * model.body_count
            value = real(0.0)
            n = int(0)
            while n < count_a:
                value -= J[w, slot, n] * C_modal[w, row, first_a + n] * receptance[w, first_a + n]
                n += 1
            n = int(0)
            while n < count_b:
                value -= J[w, slot, count_a + n] * C_modal[w, row, first_b + n] * receptance[w, first_b + n]
                n += 1
            L[w, slot, c] = value
            c += 1
        i = int(0)
        while i < model.outer_count:
            value = real(0.0)
            c = int(0)
            while c < count:
                value += inverse[w, i, model.coupled[pair, c]] * L[w, slot, c]
                c += 1
            V[w, slot, i] = value
            i += 1
        slot += wp.block_dim()
