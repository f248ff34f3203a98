"""Elimination of the active slots pair by pair, and solution of the retained system with their Schur complements.

Equations and names: `contact_solve`. Nodes of a grid, and cells of small patches, are eliminated by the factor U of
their block of G. Cells of other patches have no matrix: in its place, M (`patch.preconditioner`) is close to the
inverse of G, with Z = M L in place of G^-1 L,

    (A + L^T Z) z = rhs + Z^T b,      ds = M b - Z z,

which is a preconditioner of the system (`pressure_solve`) that satisfies A z - L^T ds = rhs exactly.

If rows of G are kept from step to step (`compliance_reuse`), cells have grown since they were computed, all by the same
factor s = W/W_made, and G by s^2 up to small changes. With G the stored rows

    L z + s^2 G ds = b   <=>   (L/s) z + G y = b/s,      ds = y/s,      L^T ds = (L/s)^T y,

so lines and right-hand sides are multiplied by `row_scale` = 1/s, and the result as well.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import (
    ContactFields,
    ContactGeometry,
    ContactSolve,
    LayerScratch,
    PatchScratch,
)
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lanes import total
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.linear import block_elimination
from warpffrf_kernels.linear.retained_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.compliance_reuse import WIDTH
from warpffrf_kernels.patch.preconditioner import eliminate_patch, place_slots, precondition_patch

wp.set_module_options(MODULE_OPTIONS)

START = wp.constant(0)  # columns of `block`: first active slot of a pair in `order`
COUNT = wp.constant(1)  # their number
LEFT_START = wp.constant(2)  # the same for slots that have left the set
LEFT_COUNT = wp.constant(3)

NOTHING = wp.constant(0)  # parts of an elimination that are reused
FACTOR = wp.constant(1)
LINES = wp.constant(2)


@kernel
def order_slots(run: Run, contact: ContactState, fields: ContactFields, normal: ContactSolve, patch: PatchScratch):
    """Per world, lanes over pairs: the active slots, pair by pair, then those that have left the set; and the parts of
    the elimination that are reused from the last solution with the same rows of G: U (FACTOR), with unchanged L and
    retained matrix also W, W^T W and its factor (LINES)."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    same = int(NOTHING)
    if run.ctl[w].fresh == run.ctl[w].slots and model.elements[0].layers.count == 0:
        same = int(FACTOR)
        if run.ctl[w].refresh == 0 or run.ctl[w].moved == 0:
            same = int(LINES)
    count = int(0)
    if same != NOTHING:
        count = normal.block[w, 0, LEFT_START]
    sync()
    pair = lane
    while pair < model.pairs.count:
        normal.block[w, pair, COUNT] = 0
        normal.block[w, pair, LEFT_COUNT] = 0
        normal.row_scale[w, pair] = real(1.0)
        if model.elements[0].patches.lasting != 0:
            normal.row_scale[w, pair] = patch.patch_made[w, pair, WIDTH] / contact.patch_width[w, pair]
        pair += wp.block_dim()
    slot = int(0)
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        m = normal.slot_node[w, slot, 1]
        if pair % wp.block_dim() == lane:
            if contact.active[w, pair, m] != 0:
                normal.block[w, pair, COUNT] = normal.block[w, pair, COUNT] + 1
            elif fields.base[w, pair, m] != real(0.0):
                normal.block[w, pair, LEFT_COUNT] = normal.block[w, pair, LEFT_COUNT] + 1
        slot += 1
    sync()
    active = int(0)
    if lane == 0:
        at = int(0)
        for kind in range(2):
            pair = int(0)
            while pair < model.pairs.count:
                normal.block[w, pair, 2 * kind + START] = at
                at += normal.block[w, pair, 2 * kind + COUNT]
                normal.block[w, pair, 2 * kind + COUNT] = 0
                pair += 1
            if kind == 0:
                active = at
    if int(total(real(active))) != count:
        same = int(NOTHING)
    slot = int(0)
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        m = normal.slot_node[w, slot, 1]
        kind = int(-1)
        if pair % wp.block_dim() == lane:
            if contact.active[w, pair, m] != 0:
                kind = int(0)
            elif fields.base[w, pair, m] != real(0.0):
                kind = int(1)
        if kind >= 0:
            n = normal.block[w, pair, 2 * kind + COUNT]
            place = normal.block[w, pair, 2 * kind + START] + n
            if kind == 0 and same != NOTHING and normal.order[w, place] != slot:
                same = int(NOTHING)
            normal.order[w, place] = slot
            normal.block[w, pair, 2 * kind + COUNT] = n + 1
        slot += 1
    changed = total(real(same == NOTHING))
    if changed > real(0.0):
        same = int(NOTHING)
    if lane == 0:
        normal.kept[w] = same


# Gathers the block of G of n slots from place `start` of `order` on into the lines and columns of these places.
@wp.func_native("""
    const int cap = model.capacity.slots;
    double* U = factor.data + ((size_t)w * cap + start) * cap + start;
    const int* list = order.data + (size_t)w * cap + start;
    for (int i = 0; i < n; ++i) {
        const double* g = G.data + ((size_t)w * cap + list[i]) * cap;
        for (int j = i + WP_TILE_THREAD_IDX; j < n; j += WP_TILE_BLOCK_DIM) U[(size_t)i * cap + j] = g[list[j]];
    }
    WP_TILE_SYNC();
""")
def gather_block(
    model: Model,
    w: int,
    start: int,
    n: int,
    G: wp.array3d(dtype=real),
    order: wp.array2d(dtype=int),
    factor: wp.array(dtype=real),
): ...


# Copies the lines of L of n slots from place `start` of `order` on, times `scale`, to their places in `out`.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.coupled_capacity;
    const int count = model.pairs.coupled_count.data[pair];
    const int* list = order.data + (size_t)w * cap + start;
    for (int i = 0; i < n; ++i) {
        const double* l = L.data + ((size_t)w * cap + list[i]) * width;
        double* x = out.data + ((size_t)w * cap + start + i) * width;
        for (int c = WP_TILE_THREAD_IDX; c < count; c += WP_TILE_BLOCK_DIM) x[c] = scale * l[c];
    }
    WP_TILE_SYNC();
""")
def gather_lines(
    model: Model,
    w: int,
    pair: int,
    start: int,
    n: int,
    scale: real,
    L: wp.array3d(dtype=real),
    order: wp.array2d(dtype=int),
    out: wp.array(dtype=real),
): ...


@wp.func
def block_at(model: Model, w: int, start: int) -> int:
    """First entry of the factor of the places from `start` on; its lines have the length of the slot capacity."""
    return (w * model.capacity.slots + start) * model.capacity.slots + start


@wp.func
def lines_at(model: Model, w: int, start: int) -> int:
    """First entry of the lines W of the places from `start` on."""
    return (w * model.capacity.slots + start) * model.pairs.coupled_capacity


@kernel
def place_cells(
    run: Run, normal: ContactSolve, patch: PatchScratch, geometry: ContactGeometry, layers: LayerScratch
):  # fmt: skip
    """Per (world, pair of family 2): places, yields and factors of the preconditioner of its active slots, and of those
    that have left the set."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or model.pairs.family[pair] != PATCH:
        return
    for kind in range(2):
        place_slots(
            model, w, pair, normal.block[w, pair, 2 * kind + START], normal.block[w, pair, 2 * kind + COUNT], patch,
            geometry, layers, normal,
        )  # fmt: skip


@kernel
def eliminate_pairs(run: Run, normal: ContactSolve, patch: PatchScratch):
    """Per (world, pair): L in the order of the slots; U, W and W^T W of the active nodes, or Z and L^T Z of the active
    cells, unless they are `kept`."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    start = normal.block[w, pair, START]
    n = normal.block[w, pair, COUNT]
    gather_lines(
        model, w, pair, normal.block[w, pair, LEFT_START], normal.block[w, pair, LEFT_COUNT], real(1.0), normal.L,
        normal.order, normal.borders,
    )  # fmt: skip
    if n == 0 or normal.kept[w] == LINES:
        return
    width = model.pairs.coupled_capacity
    coupled = model.pairs.coupled_count[pair]
    gather_lines(model, w, pair, start, n, real(1.0), normal.L, normal.order, normal.borders)
    if model.pairs.matrix[pair] == 0:
        eliminate_patch(model, w, pair, lane, start, n, patch, normal)
        return
    cap = model.capacity.slots
    at = block_at(model, w, start)
    line = lines_at(model, w, start)
    if normal.kept[w] == NOTHING:
        gather_block(model, w, start, n, normal.soft, normal.order, normal.factor)
        if block_elimination.factor(normal.factor, at, cap, n) != 0 and lane == 0:
            run.ctl[w].failure = run.ctl[w].failure | k.INDEFINITE
    gather_lines(model, w, pair, start, n, normal.row_scale[w, pair], normal.L, normal.order, normal.W)
    block_elimination.forward_lines(normal.factor, at, cap, n, normal.W, line, width, coupled)
    block_elimination.square_of(
        n, normal.W, line, width, coupled, normal.square, (w * model.pairs.count + pair) * width * width
    )


# A + sum W^T W, entries of the pattern.
@wp.func_native("""
    const int N = model.retained.count, width = model.pairs.coupled_capacity;
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double* A = tangent.data + (size_t)w * N * N;
    double* a = bordered.data + (size_t)w * N * N;
    for (int i = lane; i < N; i += lanes)
        for (int e = p.entry_start.data[i]; e < p.entry_start.data[i + 1]; ++e) {
            const size_t at = (size_t)i * N + p.entry_column.data[e];
            a[at] = A[at];
        }
    WP_TILE_SYNC();
    for (int pair = 0; pair < model.pairs.count; ++pair) {
        if (block.data[((size_t)w * model.pairs.count + pair) * block.shape[2] + 1] == 0) continue;
        const int count = model.pairs.coupled_count.data[pair];
        const int* column = model.pairs.coupled.data + (size_t)pair * width;
        const double* s = square.data + ((size_t)w * model.pairs.count + pair) * width * width;
        for (int c = 0; c < count; ++c)
            for (int d = lane; d < count; d += lanes) {
                const double value = s[(size_t)c * width + d];
                if (value != 0.0) a[(size_t)column[c] * N + column[d]] += value;
            }
        WP_TILE_SYNC();
    }
""")
def add_borders(
    model: Model,
    p: Pattern,
    w: int,
    tangent: wp.array3d(dtype=real),
    block: wp.array3d(dtype=int),
    square: wp.array(dtype=real),
    bordered: wp.array3d(dtype=real),
): ...


@wp.func
def eliminated(
    model: Model, p: Pattern, w: int, lane: int, renew: int, held: int, normal: ContactSolve, patch: PatchScratch,
    system: RetainedSystem, x: wp.array(dtype=real), at: int, right: wp.array(dtype=real),
    z: wp.array(dtype=real),
) -> int:  # fmt: skip
    """Solution of the system by pairs. On entry, x from `at` on is the right-hand side of the places; on return, their
    changes of pressure. z: retained increments for `right`. Returns 1 if the retained matrix is singular."""
    cap = model.capacity.slots
    pair = int(0)
    while pair < model.pairs.count:
        start = normal.block[w, pair, START]
        n = normal.block[w, pair, COUNT]
        if n > 0 and model.pairs.matrix[pair] == 0:
            precondition_patch(model, w, pair, start, n, patch, normal, x, at + start, x, at + start, 1)
            block_elimination.push_columns(
                model, w, pair, n, normal.borders, lines_at(model, w, start), x, at + start, right
            )
        elif n > 0:
            block_elimination.forward(normal.factor, block_at(model, w, start), cap, n, x, at + start)
            block_elimination.push_columns(model, w, pair, n, normal.W, lines_at(model, w, start), x, at + start, right)
        pair += 1
    bad = solve(
        model, p, w, lane, renew, normal.bordered, right, system.hold, held, system.scaling, system.pivots,
        system.sparse_factor, system.sparse_vector, system.sparse_lines, system.fallback, system.elimination,
        system.inverse_transposed, z,
    )  # fmt: skip
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        start = normal.block[w, pair, START]
        n = normal.block[w, pair, COUNT]
        if n > 0:
            block_elimination.follow_columns(
                model, w, pair, n, real(-1.0), normal.W, lines_at(model, w, start), z, x, at + start
            )
            if model.pairs.matrix[pair] != 0:
                block_elimination.backward(normal.factor, block_at(model, w, start), cap, n, x, at + start)
        pair += 1
    return bad
