r"""Compliance of the cells that may carry friction ("cell slots"), with all other unknowns condensed.

In the weak slip S_k = area_k s_k and the tractions tau_l, two directions each, rows 2 i + d of slot i:

    G = area_k [D_tt^A]_kl area_l + (area Q o) D_tt^B (area Q o)^T + J sigma^-1 J^T,
    J_k = area_k [Phi_tA, -Q o Phi_tB]_k,      L = [dS/d(rigid), -J sigma^-1 C^T],

as in `contact_compliance` for the pressures: symmetric, and positive definite if the cells are no finer than the mesh.
Each pair has its own block of G, which stays assembled until the grids move relative to each other. The response of the
pressures (`pressure_response`) is added once their active set has converged, if cells or this set are new. Cells of
different pairs are coupled through the retained coordinates (`cell_blocks`), but not through local or condensed modes,
which the Newton iteration accounts for.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve
from warpffrf_kernels.core.lanes import before, share, total
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem, Trial
from warpffrf_kernels.friction.cell_blocks import COUNT, FRESH, block_of, first_line, is_fresh
from warpffrf_kernels.friction.cell_shares import add_on_shares, line_of
from warpffrf_kernels.friction.cells import cell_at, rubs_on_grid
from warpffrf_kernels.friction.tangential_fields import second_high, second_low
from warpffrf_kernels.linear.block_elimination import add_lines
from warpffrf_kernels.normal.contact_compliance import retained_row, short_of
from warpffrf_kernels.normal.pair_forces import surface_of
from warpffrf_kernels.surfaces.responses import own_load, place_in_table

wp.set_module_options(MODULE_OPTIONS)

ROUND_OFF = wp.constant(wp.float64(1.0e-14))  # of a cosine: tangents of parallel rollers are parallel up to this


@wp.func
def new_cells(w: int, pair: int, first: int, end: int, cells: FrictionCells, tangential: FrictionSolve) -> int:
    """Active cells without a slot among those of a lane."""
    count = int(0)
    m = first
    while m < end:
        if cells.bound[w, pair, m] > real(0.0) and tangential.cell_slot_of[w, pair, m] < 0:
            count += 1
        m += 1
    return count


@kernel
def take_cells(run: Run, cells: FrictionCells, tangential: FrictionSolve):
    """Per world, lanes over cells: assigns a slot in its pair's block to each active cell without one. All slots are
    released first if the grids have moved, or if cells that are no longer under pressure occupy slots that others
    need."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    capacity = model.window.grid_nodes
    first = share(capacity, lane)
    end = share(capacity, lane + 1)
    stale = run.ctl[w].stale
    pair = int(0)
    while pair < model.pairs.count and stale == 0:
        if model.pairs.friction[pair] > real(0.0):
            found = new_cells(w, pair, first, end, cells, tangential)
            if tangential.cell_block[w, pair, COUNT] + int(total(real(found))) > model.capacity.cells:
                stale = 1
        pair += 1
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        fresh = tangential.cell_block[w, pair, COUNT]
        if stale != 0:
            fresh = 0
            m = first
            while m < end:
                tangential.cell_slot_of[w, pair, m] = -1
                m += 1
        found = int(0)
        if model.pairs.friction[pair] > real(0.0):
            found = new_cells(w, pair, first, end, cells, tangential)
            at = fresh + before(found)
            m = first
            while m < end and found > 0:
                if cells.bound[w, pair, m] > real(0.0) and tangential.cell_slot_of[w, pair, m] < 0:
                    if at < model.capacity.cells:
                        tangential.cell_slot_of[w, pair, m] = at
                        tangential.cell_slot[w, pair, at] = m
                        kind = (w * model.pairs.count + pair) * 2 * model.capacity.cells + at
                        tangential.cell_sliding[kind] = 0  # unknown
                    at += 1
                m += 1
        count = fresh + int(total(real(found)))
        if lane == 0:
            tangential.cell_block[w, pair, FRESH] = fresh
            if count > fresh:
                run.ctl[w].factored = 0  # the factor lacks the new slots
            if count > model.capacity.cells:
                run.ctl[w].failure = run.ctl[w].failure | short_of(model)
                run.ctl[w].spare = wp.max(run.ctl[w].spare, model.capacity.slots * count / model.capacity.cells + 1)
                run.ctl[w].run = 0
                count = model.capacity.cells
            tangential.cell_block[w, pair, COUNT] = count
        pair += 1
    if lane == 0:
        run.ctl[w].stale = 0


@kernel
def cell_modes(
    run: Run, geometry: ContactGeometry, tangential: FrictionSolve, cells: FrictionCells, impulses: ImpulsiveContact
):
    """Per (world, pair): gradient J of the weak slip of the new slots with respect to the global modes of A, then of B,
    times the weight of the pair, and its transpose."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or not rubs_on_grid(model, pair):
        return
    slot = tangential.cell_block[w, pair, FRESH]
    while slot < tangential.cell_block[w, pair, COUNT]:
        m = tangential.cell_slot[w, pair, slot]
        A = model.pairs.first[pair]
        B = model.pairs.second[pair]
        rows = model.surfaces.rows[A]
        area = impulses.weight[w, pair] * cells.cell_area[w, pair, m]
        modes_a = model.surfaces.modal_count[A]
        start = (first_line(model, w, pair) + 2 * slot) * model.pairs.most_modes
        i = lane
        while i < 2 * model.pairs.most_modes:
            tangential.cell_J[start + i] = real(0.0)
            i += wp.block_dim()
        sync()
        for d in range(2):
            line = line_of(model, A, geometry.center[w, pair, 0] + m / rows - model.window.half, d * rows + m % rows)
            if line >= 0:
                at = model.surfaces.shear_start[A] + line * modes_a
                axpy(
                    modes_a, area, model.surfaces.mode_tangent, at, tangential.cell_J,
                    start + d * model.pairs.most_modes,
                )  # fmt: skip
        if model.surfaces.shear_start[B] >= 0:
            rows_b = model.surfaces.rows[B]
            modes_b = model.surfaces.modal_count[B]
            base = geometry.center[w, pair, 1] - model.window.second_half + cells.share_at[w, pair, m, 0]
            c = int(0)
            while c < model.window.share_columns:
                q = int(0)
                while q < model.window.share_rows:
                    part = -area * cells.share[w, pair, m, c * model.window.share_rows + q]
                    if part != real(0.0):
                        for e in range(2):
                            line = line_of(model, B, base + c, e * rows_b + cells.share_at[w, pair, m, 1] + q)
                            if line >= 0:
                                at = model.surfaces.shear_start[B] + line * modes_b
                                for d in range(2):
                                    axpy(
                                        modes_b, part * cells.cell_turn[w, pair, m, 2 * d + e],
                                        model.surfaces.mode_tangent, at, tangential.cell_J,
                                        start + d * model.pairs.most_modes + modes_a,
                                    )  # fmt: skip
                    q += 1
                c += 1
        sync()
        i = lane
        while i < 2 * model.pairs.most_modes:
            n = i % model.pairs.most_modes
            tangential.cell_JT[w, pair, n, 2 * slot + i / model.pairs.most_modes] = tangential.cell_J[start + i]
            i += wp.block_dim()
        slot += 1


# Lines 2 slot, 2 slot + 1 of G by the local modes of the first body, columns of the slots up to itself. Lanes over the
# slots.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells;
    const size_t here = (size_t)w * model.pairs.count + pair, cells = here * model.window.grid_nodes;
    const int* mine = cell_slot.data + here * model.capacity.cells;
    const int table = model.responses.tangential.data[model.responses.load_start.data[2 * pair]];
    const int rows = model.surfaces.rows.data[model.pairs.first.data[pair]];
    const int period = model.responses.source_block.data[table];
    const int reach = model.responses.reach.data[table], wide = model.responses.width.data[table];
    const double* DA = model.responses.number.data + model.responses.start.data[table];
    const int m = mine[slot], column = origin + m / rows, row = m % rows;
    double *g0 = G.data + (here * cap + 2 * slot) * cap, *g1 = g0 + cap;
    WP_TILE_SYNC();
    for (int j = WP_TILE_THREAD_IDX; j <= slot; j += WP_TILE_BLOCK_DIM) {
        const int mj = mine[j], column_j = origin + mj / rows, row_j = mj % rows;
        const int part = ((column_j % period) + period) % period, target = column - (column_j - part) + reach;
        const double scale = cell_area.data[cells + m] * cell_area.data[cells + mj];
        for (int e = 0; e < 2; ++e) {
            const double* d = DA + (((size_t)part * 2 * rows + e * rows + row_j) * wide + target) * 2 * rows + row;
            g0[2 * j + e] = scale * d[0]; g1[2 * j + e] = scale * d[rows];
        }
    }
    WP_TILE_SYNC();
""")
def couple_first(
    model: Model,
    w: int,
    pair: int,
    slot: int,
    origin: int,
    cell_slot: wp.array3d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    G: wp.array(dtype=real),
): ...


# Columns of G that correspond to the lines `line` and `line` + 1, up to these.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells;
    double* g = G.data + ((size_t)w * model.pairs.count + pair) * cap * cap;
    WP_TILE_SYNC();
    for (int j = WP_TILE_THREAD_IDX; j < line; j += WP_TILE_BLOCK_DIM)
        for (int d = 0; d < 2; ++d) g[(size_t)j * cap + line + d] = g[(size_t)(line + d) * cap + j];
    WP_TILE_SYNC();
""")
def mirror_lines(model: Model, w: int, pair: int, line: int, G: wp.array(dtype=real)): ...


@wp.func
def scale_modes(
    model: Model, w: int, pair: int, lane: int, J: wp.array(dtype=real), start: int, residuals: Residuals,
    tangential: FrictionSolve, at: int,
) -> int:  # fmt: skip
    """Line of J from `start` on times sigma^-1, over the modes of both bodies of a pair, to `scratch`; returns their
    number."""
    all = int(0)
    for side in range(2):
        surface = surface_of(model, pair, side)
        first = w * model.modes.count + model.surfaces.modal_start[surface]
        n = lane
        while n < model.surfaces.modal_count[surface]:
            tangential.cell_scaled[at + all + n] = J[start + all + n] * residuals.receptance[first + n]
            n += wp.block_dim()
        all += model.surfaces.modal_count[surface]
    sync()
    return all


@wp.func
def shift_second(
    model: Model, w: int, pair: int, m: int, lane: int, low: int, high: int, origin_b: int, cells: FrictionCells,
    tangential: FrictionSolve,
):  # fmt: skip
    """Displacement of the second surface's cells, columns `low` to `high` of its window, due to unit tractions on cell
    m in its two directions, (2, 2 node_capacity) flat: area D_tt^B (Q o)^T."""
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    table = model.responses.tangential[own_load(model, 2 * pair + 1)]
    base = (w * model.pairs.count + pair) * 4 * model.window.nodes
    count = (high - low + 1) * 2 * rows_b
    i = lane
    while i < 4 * model.window.nodes:
        tangential.cell_shift[base + i] = real(0.0)
        i += wp.block_dim()
    sync()
    c = int(0)
    while c < model.window.share_columns:
        q = int(0)
        while q < model.window.share_rows:
            part = cells.cell_area[w, pair, m] * cells.share[w, pair, m, c * model.window.share_rows + q]
            if part != real(0.0):
                for e in range(2):
                    line = e * rows_b + cells.share_at[w, pair, m, 1] + q
                    at = place_in_table(
                        model, table, origin_b + cells.share_at[w, pair, m, 0] + c, line, origin_b + low
                    )
                    if at >= 0:
                        for d in range(2):
                            turned = cells.cell_turn[w, pair, m, 2 * d + e]
                            if wp.abs(turned) > ROUND_OFF:
                                start = base + d * 2 * model.window.nodes + low * 2 * rows_b
                                axpy(count, part * turned, model.responses.number, at, tangential.cell_shift, start)
            q += 1
        c += 1
    sync()


@kernel
def assemble_cells(
    run: Run, geometry: ContactGeometry, tangential: FrictionSolve, cells: FrictionCells, residuals: Residuals,
    cell_JT: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, pair): lines of the compliance of the new slots, without the retained coordinates."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or not rubs_on_grid(model, pair):
        return
    low = second_low(model, w, pair, geometry.second_window)
    high = second_high(model, w, pair, geometry.second_window)
    flexible = model.surfaces.shear_start[model.pairs.second[pair]] >= 0
    lines = 2 * model.capacity.cells
    width = model.pairs.most_modes
    line = 2 * tangential.cell_block[w, pair, FRESH]
    while line < 2 * tangential.cell_block[w, pair, COUNT]:
        if line % 2 == 0:
            couple_first(
                model, w, pair, line / 2, geometry.center[w, pair, 0] - model.window.half, tangential.cell_slot,
                cells.cell_area, tangential.cell_G,
            )  # fmt: skip
            if flexible:
                origin_b = geometry.center[w, pair, 1] - model.window.second_half
                shift_second(
                    model, w, pair, tangential.cell_slot[w, pair, line / 2], lane, low, high, origin_b, cells,
                    tangential,
                )  # fmt: skip
        at = block_of(model, w, pair) + line * lines
        if flexible:
            field = ((w * model.pairs.count + pair) * 4 + 2 * (line % 2)) * model.window.nodes
            add_on_shares(
                model, w, pair, line / 2 + 1, real(1.0), tangential.cell_slot, cells.cell_area, cells.cell_turn,
                cells.share, cells.share_at, tangential.cell_shift, field, tangential.cell_G, at,
            )  # fmt: skip
        scaled = (w * model.pairs.count + pair) * 2 * width
        start = (first_line(model, w, pair) + line) * width
        modes = scale_modes(model, w, pair, lane, tangential.cell_J, start, residuals, tangential, scaled)
        by_mode = (w * model.pairs.count + pair) * width * lines
        add_lines(
            modes, 2 * (line / 2 + 1), tangential.cell_scaled, scaled, cell_JT, by_mode, lines, tangential.cell_G, at
        )
        if line % 2 == 1:
            mirror_lines(model, w, pair, line - 1, tangential.cell_G)
        line += 1


@kernel
def retained_cells(
    run: Run, trial: Trial, cells: FrictionCells, impulses: ImpulsiveContact, tangential: FrictionSolve,
    system: RetainedSystem,
):  # fmt: skip
    """Per (world, pair): gradient L of the weak slip with respect to the coupled retained columns times the weight of
    the pair, at the start of an attempt and if any pair has new slots."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if (
        run.ctl[w].run == 0
        or run.ctl[w].changes != 0
        or not (run.ctl[w].iteration == 0 or is_fresh(model, w, tangential.cell_block))
    ):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    line = int(0)
    while line < 2 * tangential.cell_block[w, pair, COUNT]:
        at = cell_at(rows, tangential.cell_slot[w, pair, line / 2], line % 2)
        f = vec3(
            cells.cell_wrench[w, pair, at, 0], cells.cell_wrench[w, pair, at, 1], cells.cell_wrench[w, pair, at, 2]
        )
        t = vec3(
            cells.cell_wrench[w, pair, at, 3], cells.cell_wrench[w, pair, at, 4], cells.cell_wrench[w, pair, at, 5]
        )
        number = first_line(model, w, pair) + line
        retained_row(
            model, w, pair, lane, f, t, trial, impulses, tangential.cell_J, number * model.pairs.most_modes, system,
            number * model.pairs.coupled_capacity, tangential.cell_L,
        )  # fmt: skip
        line += 1
