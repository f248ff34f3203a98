r"""Compliance of the cells of a patch that may carry friction, like `friction.cell_compliance` for other cells.

In the weak slips and the tractions of the slots of a pair

    G = half-spaces + (A P) (S_tt + Phi_t sigma^-1 Phi_t^T) (A P)^T of A + Q (the same of B) Q^T,
    J = [A P Phi_tA, -Q A P Phi_tB].

A line of G is gathered from the displacement of the splines of both sides due to a cell's unit tractions.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import PatchScratch, RollingScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals
from warpffrf_kernels.friction.cell_blocks import COUNT, FRESH, block_of, first_line
from warpffrf_kernels.friction.cell_compliance import mirror_lines
from warpffrf_kernels.friction.cells import rubs_on_patch
from warpffrf_kernels.patch.spline_tables import real_side
from warpffrf_kernels.rolling.shear import STRIPS_AROUND, shear_line
from warpffrf_kernels.rolling.spline_tables import table_along, trace_along

wp.set_module_options(MODULE_OPTIONS)


@kernel
def modes_of_cells(
    run: Run, tangential: FrictionSolve, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    impulses: ImpulsiveContact,
):  # fmt: skip
    """Per (world, pair), lanes over modes: gradient J of the weak slip with respect to the global modes of A, then of
    B, times the weight of the pair, and its transpose; for the new slots, at the start of an attempt for all."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    nodes = elements.patches.far_nodes
    count_a = model.surfaces.modal_count[model.pairs.first[pair]]
    slot = int(0)
    if run.ctl[w].iteration > 0:
        slot = tangential.cell_block[w, pair, FRESH]
    while slot < tangential.cell_block[w, pair, COUNT]:
        m = tangential.cell_slot[w, pair, slot]
        start = (first_line(model, w, pair) + 2 * slot) * model.pairs.most_modes
        i = lane
        while i < model.pairs.most_modes:
            side = int(0)
            n = i
            if i >= count_a:
                side = int(1)
                n = i - count_a
            s = real_side(elements, pair, side)
            v_1 = real(0.0)
            v_2 = real(0.0)
            if s >= 0 and n < model.surfaces.modal_count[s]:
                rows = model.surfaces.rows[s]
                at = side * model.window.grid_nodes + m
                line = trace_along(model, elements, w, pair, side) + n * 2 * nodes
                line += (patch.far_at[w, pair, at, 0] - patch.far_window[w, pair, side, 0]) * rows + patch.far_at[
                    w, pair, at, 1
                ]
                for a in range(3):
                    b = int(0)
                    while b < wp.min(rows, 3):
                        f = patch.far_weight[w, pair, at, 3 * a + b]
                        v_1 += f * rolling.rub_trace[line + a * rows + b]
                        v_2 += f * rolling.rub_trace[line + nodes + a * rows + b]
                        b += 1
            u_1 = v_1
            u_2 = v_2
            if side == 1:
                u_1 = -(cells.cell_turn[w, pair, m, 0] * v_1 + cells.cell_turn[w, pair, m, 1] * v_2)
                u_2 = -(cells.cell_turn[w, pair, m, 2] * v_1 + cells.cell_turn[w, pair, m, 3] * v_2)
            tangential.cell_J[start + i] = impulses.weight[w, pair] * u_1
            tangential.cell_J[start + model.pairs.most_modes + i] = impulses.weight[w, pair] * u_2
            tangential.cell_JT[w, pair, i, 2 * slot] = impulses.weight[w, pair] * u_1
            tangential.cell_JT[w, pair, i, 2 * slot + 1] = impulses.weight[w, pair] * u_2
            i += wp.block_dim()
        slot += 1


# S_tt + weight^2 Phi_t sigma^-1 Phi_t^T of one side, lines of 2 nodes: lanes over the lines.
@wp.func_native("""
    const int nodes = elements.patches.far_nodes, modes = model.surfaces.modal_count.data[s];
    const double* const own = receptance.data + (size_t)w * model.modes.count + model.surfaces.modal_start.data[s];
    const double* const trace = rub_trace.data + trace_start;
    for (int e = WP_TILE_THREAD_IDX; e < 2 * nodes; e += WP_TILE_BLOCK_DIM) {
        if (e % nodes >= count) continue;
        const double* const t = rub_table.data + table_start + (size_t)e * 3 * nodes;
        double* const out = rub_soft.data + soft_start + (size_t)e * 2 * nodes;
        for (int d = 0; d < 2; ++d) for (int k = 0; k < count; ++k) out[d * nodes + k] = t[d * nodes + k];
        for (int m = 0; m < modes; ++m) {
            const double* const u = trace + (size_t)m * 2 * nodes;
            const double f = weight * weight * own[m] * u[e];
            for (int d = 0; d < 2; ++d) for (int k = 0; k < count; ++k) out[d * nodes + k] += f * u[d * nodes + k];
        }
    }
    WP_TILE_SYNC();
""")
def soften_splines(
    model: Model,
    elements: Elements,
    w: int,
    s: int,
    count: int,
    weight: real,
    table_start: int,
    trace_start: int,
    soft_start: int,
    rub_table: wp.array(dtype=real),
    rub_trace: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    rub_soft: wp.array(dtype=real),
): ...


# Displacement of the splines of one side due to a unit traction of cell m along direction d of A, (direction, spline):
# `stride` numbers of a line of `soft`, from `start` on, of which `offset` begin; lanes over the splines.
@wp.func_native("""
    const int nodes = elements.patches.far_nodes, taps = rows < 3 ? rows : 3;
    const size_t here = (size_t)w * model.pairs.count + pair, grid_nodes = model.window.grid_nodes;
    const size_t p = (here * 2 + side) * grid_nodes + m;
    const int* const at = far_at.data + 2 * p;
    const double* const q = far_weight.data + 9 * p;
    const double* const turn = cell_turn.data + (here * grid_nodes + m) * 4;
    const int first = (at[0] - far_window.data[2 * (here * 2 + side)]) * rows + at[1];
    double* const out = line.data + at_line;
    for (int k = WP_TILE_THREAD_IDX; k < count; k += WP_TILE_BLOCK_DIM) {
        double s0 = 0.0, s1 = 0.0;
        for (int e = 0; e < 2; ++e) {
            const double f = side == 0 ? (e == d ? 1.0 : 0.0) : -turn[2 * d + e];
            if (f == 0.0) continue;
            for (int a = 0; a < 3; ++a) for (int b = 0; b < taps; ++b) {
                const double x = f * q[3 * a + b];
                const double* const from = soft.data + start + (size_t)(e * nodes + first + a * rows + b) * 2 * nodes;
                s0 += x * from[k]; s1 += x * from[nodes + k];
            }
        }
        out[k] = s0; out[nodes + k] = s1;
    }
    WP_TILE_SYNC();
""")
def displaced_splines(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    rows: int,
    count: int,
    m: int,
    d: int,
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    cell_turn: wp.array4d(dtype=real),
    soft: wp.array(dtype=real),
    start: int,
    line: wp.array(dtype=real),
    at_line: int,
): ...


# y[at + 2 j + d] += weak displacement along d of the first `count` active cells due to the displacement of the splines
# of one side; lanes over the cells.
@wp.func_native("""
    const int nodes = elements.patches.far_nodes, taps = rows < 3 ? rows : 3, grid_nodes = model.window.grid_nodes;
    const size_t here = (size_t)w * model.pairs.count + pair;
    const int* const mine = cell_slot.data + here * model.capacity.cells;
    const int first = far_window.data[2 * (here * 2 + side)];
    const double* const u = line.data + at_line;
    for (int j = WP_TILE_THREAD_IDX; j < count; j += WP_TILE_BLOCK_DIM) {
        const int m = mine[j];
        const size_t p = here * 2 * grid_nodes + side * grid_nodes + m;
        const int n = (far_at.data[2 * p] - first) * rows + far_at.data[2 * p + 1];
        const double* const q = far_weight.data + 9 * p;
        double v0 = 0.0, v1 = 0.0;
        for (int a = 0; a < 3; ++a) for (int b = 0; b < taps; ++b) {
            const double x = q[3 * a + b];
            v0 += x * u[n + a * rows + b]; v1 += x * u[nodes + n + a * rows + b];
        }
        if (side != 0) {
            const double* const turn = cell_turn.data + (here * grid_nodes + m) * 4;
            const double u0 = turn[0] * v0 + turn[1] * v1, u1 = turn[2] * v0 + turn[3] * v1;
            v0 = -u0; v1 = -u1;
        }
        y.data[at + 2 * j] += v0; y.data[at + 2 * j + 1] += v1;
    }
    WP_TILE_SYNC();
""")
def add_on_cells(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    rows: int,
    count: int,
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    cell_turn: wp.array4d(dtype=real),
    line: wp.array(dtype=real),
    at_line: int,
    y: wp.array(dtype=real),
    at: int,
): ...


# Lines 2 slot, 2 slot + 1 of G by the half-spaces, columns of the slots up to itself. Lanes over the slots.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, columns = elements.patches.columns.data[pair];
    const size_t here = (size_t)w * model.pairs.count + pair, K = (size_t)(columns + reach) * rows * line;
    const int* const mine = cell_slot.data + here * model.capacity.cells;
    const double* const T = shear_near.data + here * elements.rolling.shear_numbers + rings;
    const int c = mine[slot] / rows, k = mine[slot] % rows;
    double* const g0 = G.data + (here * cap + 2 * slot) * cap;
    double* const g1 = g0 + cap;
    for (int j = WP_TILE_THREAD_IDX; j <= slot; j += WP_TILE_BLOCK_DIM) {
        const int way = mine[j] / rows - c, a = way < 0 ? -way : way;
        const double* const h = T + ((size_t)a * rows + k) * line + mine[j] % rows;
        const double both = way < 0 ? -h[2 * K] : h[2 * K];
        g0[2 * j] = h[0]; g0[2 * j + 1] = both; g1[2 * j] = both; g1[2 * j + 1] = h[K];
    }
    WP_TILE_SYNC();
""")
def lay_near_lines(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    slot: int,
    rows: int,
    rings: int,
    line: int,
    reach: int,
    cell_slot: wp.array3d(dtype=int),
    shear_near: wp.array(dtype=real),
    G: wp.array(dtype=real),
): ...


@kernel
def assemble_patch_cells(
    run: Run, tangential: FrictionSolve, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    impulses: ImpulsiveContact, residuals: Residuals,
):  # fmt: skip
    """Per (world, pair): lines of the compliance of the new slots, without the retained coordinates."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or not rubs_on_patch(model, pair):
        return
    if model.elements[0].rolling.strips != 0:
        return
    if tangential.cell_block[w, pair, FRESH] == tangential.cell_block[w, pair, COUNT]:
        return
    elements = model.elements[0]
    nodes = elements.patches.far_nodes
    here = w * model.pairs.count + pair
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            soften_splines(
                model, elements, w, s, patch.far_window[w, pair, side, 1] * model.surfaces.rows[s],
                impulses.weight[w, pair], table_along(model, elements, w, pair, side, 0),
                trace_along(model, elements, w, pair, side), (here * 2 + side) * 2 * nodes * 2 * nodes,
                rolling.rub_table, rolling.rub_trace, residuals.receptance, rolling.rub_soft,
            )  # fmt: skip
    lines = 2 * model.capacity.cells
    rows = model.surfaces.rows[model.pairs.first[pair]]
    rings = elements.rolling.ring_rows[pair]
    slot = tangential.cell_block[w, pair, FRESH]
    while slot < tangential.cell_block[w, pair, COUNT]:
        lay_near_lines(
            model, elements, w, pair, slot, rows, rings, shear_line(rows, rings), STRIPS_AROUND, tangential.cell_slot,
            rolling.shear_near, tangential.cell_G,
        )  # fmt: skip
        for d in range(2):
            for side in range(2):
                s = real_side(elements, pair, side)
                if s >= 0:
                    count = patch.far_window[w, pair, side, 1] * model.surfaces.rows[s]
                    at = here * 4 * nodes + side * 2 * nodes
                    displaced_splines(
                        model, elements, w, pair, side, model.surfaces.rows[s], count,
                        tangential.cell_slot[w, pair, slot], d, patch.far_at, patch.far_weight, patch.far_window,
                        cells.cell_turn, rolling.rub_soft, (here * 2 + side) * 2 * nodes * 2 * nodes, rolling.rub_line,
                        at,
                    )  # fmt: skip
                    add_on_cells(
                        model, elements, w, pair, side, model.surfaces.rows[s], slot + 1, patch.far_at,
                        patch.far_weight, patch.far_window, tangential.cell_slot, cells.cell_turn, rolling.rub_line, at,
                        tangential.cell_G, block_of(model, w, pair) + (2 * slot + d) * lines,
                    )  # fmt: skip
        mirror_lines(model, w, pair, 2 * slot, tangential.cell_G)
        slot += 1
