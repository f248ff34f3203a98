"""Receptance M = (A + W^T W)^-1 of the retained coordinates, and its effect on tractions.

It is computed for the columns that pairs with friction are coupled to, since no others are loaded, with the sparse
factor of the last solution, if the response of the pressures is new (`pressure_response`): the retained matrix hardly
changes within a step. For a pair, V = L M over its coupled columns is the effect of the tractions of a cell on the
other cells of its pair through the retained coordinates.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactSolve
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT
from warpffrf_kernels.friction.pressure_response import RENEWED
from warpffrf_kernels.linear.retained_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def is_pushed(model: Model, c: int) -> bool:
    """Whether tractions load retained column c."""
    pair = int(0)
    while pair < model.pairs.count:
        i = int(0)
        while model.pairs.friction[pair] > real(0.0) and i < model.pairs.coupled_count[pair]:
            if model.pairs.coupled[pair, i] == c:
                return True
            i += 1
        pair += 1
    return False


@kernel
def invert_retained(
    run: Run, tangential: FrictionSolve, normal: ContactSolve, system: RetainedSystem, patterns: wp.array(dtype=Pattern)
):
    """Per world: M, column by column with the factor of the last solution, if Y is new."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, RENEWED] == 0:
        return
    N = model.retained.count
    i = lane
    while i < N:
        tangential.friction_receptance_rhs[w * N + i] = real(0.0)
        i += wp.block_dim()
    c = int(0)
    while c < N:
        sync()
        if is_pushed(model, c):
            if lane == 0:
                tangential.friction_receptance_rhs[w * N + c] = real(1.0)
            sync()
            solve(
                model, patterns[0], w, lane, 0, normal.bordered, tangential.friction_receptance_rhs, system.hold, 0,
                system.scaling, system.pivots, system.sparse_factor, system.sparse_vector, system.sparse_lines,
                system.fallback, system.elimination, system.inverse_transposed, tangential.friction_receptance_column,
            )  # fmt: skip
            sync()
            i = lane
            while i < N:
                tangential.friction_receptance[(w * N + c) * N + i] = tangential.friction_receptance_column[w * N + i]
                i += wp.block_dim()
            if lane == 0:
                tangential.friction_receptance_rhs[w * N + c] = real(0.0)
        else:
            i = lane
            while i < N:
                tangential.friction_receptance[(w * N + c) * N + i] = real(0.0)
                i += wp.block_dim()
        c += 1


# The 2 x 2 blocks D + L M L^T of the cells of a pair; `own`: M between its coupled columns, scratch. Lanes over the
# cells.
@wp.func_native("""
    const int width = model.pairs.coupled_capacity, stride = 2 * model.capacity.cells, N = model.retained.count;
    const int count = model.pairs.coupled_count.data[pair], lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int* column = model.pairs.coupled.data + (size_t)pair * width;
    const size_t here = (size_t)w * model.pairs.count + pair;
    double* m0 = own.data + here * width * width;
    for (int c = 0; c < count; ++c) {
        const double* row = M.data + ((size_t)w * N + column[c]) * N;
        for (int d = lane; d < count; d += lanes) m0[(size_t)c * width + d] = row[column[d]];
    }
    WP_TILE_SYNC();
    for (int i = lane; i < lines / 2; i += lanes) {
        const double *l0 = L.data + (here * stride + 2 * i) * width, *l1 = l0 + width;
        const double* d = D.data + (here * stride + 2 * i) * stride + 2 * i;
        double k00 = d[0], k01 = d[1], k11 = d[stride + 1], u[512], v[512];  // MOST_COUPLED_COLUMNS
        for (int e = 0; e < count; ++e) u[e] = v[e] = 0.0;
        for (int c = 0; c < count; ++c) {
            const double* a = m0 + (size_t)c * width; const double p = l0[c], q = l1[c];
            if (p != 0.0 || q != 0.0) for (int e = 0; e < count; ++e) { u[e] += p * a[e]; v[e] += q * a[e]; }
        }
        for (int e = 0; e < count; ++e) { k00 += u[e] * l0[e]; k01 += u[e] * l1[e]; k11 += v[e] * l1[e]; }
        double* k = diagonal.data + (here * stride / 2 + i) * 3;
        k[0] = k00; k[1] = k01; k[2] = k11;
    }
    WP_TILE_SYNC();
""")
def find_diagonal(
    model: Model,
    w: int,
    pair: int,
    lines: int,
    D: wp.array(dtype=real),
    L: wp.array(dtype=real),
    M: wp.array(dtype=real),
    own: wp.array(dtype=real),
    diagonal: wp.array(dtype=real),
): ...


@kernel
def diagonal_blocks(run: Run, tangential: FrictionSolve):
    """Per (world, pair): effect of the tractions of each cell on its own slip, if new."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    lines = 2 * tangential.cell_block[w, pair, COUNT]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, RENEWED] == 0 or lines == 0:
        return
    find_diagonal(
        model, w, pair, lines, tangential.cell_D, tangential.cell_bordered, tangential.friction_receptance,
        tangential.friction_receptance_own, tangential.cell_diagonal,
    )  # fmt: skip
