"""Elimination of the active nodes pair by pair, and solution of the retained system with their Schur complements.

Equations and names: `contact_solve`. If rows of G are kept from step to step (`compliance_reuse`), cells have grown
since they were computed, all by the same factor s = W/W_made, and G by s^2 up to small changes. With G the stored rows

    L z + s^2 G ds = b   <=>   (L/s) z + G y = b/s,      ds = y/s,      L^T ds = (L/s)^T y,

so lines and right-hand sides are multiplied by `row_scale` = 1/s, and the result as well.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactFields, ContactSolve, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, weighted
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.linear import block_elimination
from warpffrf_kernels.linear.retained_solve import held_motions, solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.compliance_reuse import WIDTH
from warpffrf_kernels.normal.lagged import lags
from warpffrf_kernels.normal.pair_forces import surface_of

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
    """Per world: the active slots, pair by pair, then those that have left the set; and the parts of the elimination
    that are reused from the last solution with the same rows of G: U (FACTOR), with unchanged L and retained matrix
    also W, W^T W and its factor (LINES)."""
    w = wp.tid()
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
    pair = int(0)
    while pair < model.pairs.count:
        normal.block[w, pair, COUNT] = 0
        normal.block[w, pair, LEFT_COUNT] = 0
        normal.row_scale[w, pair] = real(1.0)
        if model.pairs.family[pair] == PATCH:
            normal.row_scale[w, pair] = patch.patch_made[w, pair, WIDTH] / contact.patch_width[w, pair]
        pair += 1
    slot = int(0)
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        m = normal.slot_node[w, slot, 1]
        if contact.active[w, pair, m] != 0:
            normal.block[w, pair, COUNT] = normal.block[w, pair, COUNT] + 1
        elif fields.base[w, pair, m] != real(0.0):
            normal.block[w, pair, LEFT_COUNT] = normal.block[w, pair, LEFT_COUNT] + 1
        slot += 1
    at = int(0)
    for kind in range(2):
        pair = int(0)
        while pair < model.pairs.count:
            normal.block[w, pair, 2 * kind + START] = at
            at += normal.block[w, pair, 2 * kind + COUNT]
            normal.block[w, pair, 2 * kind + COUNT] = 0
            pair += 1
        if kind == 0 and at != count:
            same = int(NOTHING)
    slot = int(0)
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        m = normal.slot_node[w, slot, 1]
        kind = int(-1)
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


# Copies the lines of L of n slots from place `start` of `order` on, times `scale`, to W.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.coupled_capacity;
    const int count = model.pairs.coupled_count.data[pair];
    const int* list = order.data + (size_t)w * cap + start;
    for (int i = 0; i < n; ++i) {
        const double* l = L.data + ((size_t)w * cap + list[i]) * width;
        double* x = W.data + ((size_t)w * cap + start + i) * width;
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
    W: wp.array(dtype=real),
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
def eliminate_pairs(run: Run, normal: ContactSolve):
    """Per (world, pair): U, W and W^T W of the active nodes, unless they are `kept`."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    n = normal.block[w, pair, COUNT]
    if run.ctl[w].run == 0 or n == 0 or normal.kept[w] == LINES:
        return
    start = normal.block[w, pair, START]
    cap = model.capacity.slots
    width = model.pairs.coupled_capacity
    coupled = model.pairs.coupled_count[pair]
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


@kernel
def pose_pressures(
    run: Run, system: RetainedSystem, fields: ContactFields, normal: ContactSolve, impulses: ImpulsiveContact,
    residuals: Residuals, patterns: wp.array(dtype=Pattern), modal_residual: wp.array(dtype=real),
):  # fmt: skip
    """Per world: A + sum W^T W, unless it is `kept` too, and both right-hand sides with the nodes that leave the
    set."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    if normal.kept[w] != LINES:
        add_borders(model, patterns[0], w, system.tangent, normal.block, normal.square, normal.bordered)
    i = lane
    while i < model.retained.count:
        normal.bordered_rhs[w, i] = system.rhs[w, i]
        i += wp.block_dim()
    sync()
    last = model.pairs.count - 1
    first_left = normal.block[w, 0, LEFT_START]
    lefts = normal.block[w, last, LEFT_START] + normal.block[w, last, LEFT_COUNT] - first_left
    i = lane
    while i < first_left:  # the preceding places are those of active slots
        a = normal.order[w, i]
        pair = normal.slot_node[w, a, 0]
        total = -impulses.weight[w, pair] * fields.opened[w, pair, normal.slot_node[w, a, 1]]
        e = int(0)
        while e < lefts:
            slot = normal.order[w, first_left + e]
            other = normal.slot_node[w, slot, 0]
            if other == pair or (model.pairs.beside != 0 and not lags(model, run.ctl, w)):
                s = real(1.0) / (normal.row_scale[w, pair] * normal.row_scale[w, other])
                total += (
                    s
                    * normal.soft[w, a, slot]
                    * impulses.weight[w, other]
                    * fields.base[w, other, normal.slot_node[w, slot, 1]]
                )
            e += 1
        line = (w * model.capacity.slots + a) * model.pairs.most_modes
        for side in range(2):
            surface = surface_of(model, pair, side)
            modes = w * model.modes.count + model.surfaces.modal_start[surface]
            n = model.surfaces.modal_count[surface]
            total += weighted(n, normal.J, line, residuals.receptance, modes, modal_residual, modes)
            line += n
        normal.right[w, i] = normal.row_scale[w, pair] * total
        i += wp.block_dim()
    if lane != 0:
        return
    e = int(0)
    while e < lefts:
        slot = normal.order[w, first_left + e]
        pair = normal.slot_node[w, slot, 0]
        change = -impulses.weight[w, pair] * fields.base[w, pair, normal.slot_node[w, slot, 1]]
        c = int(0)
        while c < model.pairs.coupled_count[pair]:
            column = model.pairs.coupled[pair, c]
            normal.bordered_rhs[w, column] = normal.bordered_rhs[w, column] + change * normal.L[w, slot, c]
            c += 1
        e += 1


@wp.func
def eliminated(
    model: Model, p: Pattern, w: int, lane: int, renew: int, held: int, normal: ContactSolve, system: RetainedSystem,
    x: wp.array(dtype=real), at: int, right: wp.array(dtype=real), z: wp.array(dtype=real),
) -> int:  # fmt: skip
    """Solution of the system by blocks. On entry, x from `at` on is the right-hand side of the places; on return, their
    changes of pressure. z: retained increments for `right`. Returns 1 if the retained matrix is singular."""
    cap = model.capacity.slots
    pair = int(0)
    while pair < model.pairs.count:
        start = normal.block[w, pair, START]
        n = normal.block[w, pair, COUNT]
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
        block_elimination.follow_columns(
            model, w, pair, n, real(-1.0), normal.W, lines_at(model, w, start), z, x, at + start
        )
        block_elimination.backward(normal.factor, block_at(model, w, start), cap, n, x, at + start)
        pair += 1
    return bad


@wp.func
def put_pressures(
    model: Model, w: int, lane: int, count: int, fields: ContactFields, normal: ContactSolve,
    impulses: ImpulsiveContact, contact: ContactState,
):  # fmt: skip
    """Pressures of the active slots from their changes."""
    i = lane
    while i < count:
        pair = normal.slot_node[w, normal.order[w, i], 0]
        m = normal.slot_node[w, normal.order[w, i], 1]
        contact.pressure[w, pair, m] = (
            fields.base[w, pair, m]
            + normal.row_scale[w, pair] * normal.solution[w * model.capacity.slots + i] / impulses.weight[w, pair]
        )
        i += wp.block_dim()


@kernel
def solve_pressures(
    run: Run, fields: ContactFields, normal: ContactSolve, impulses: ImpulsiveContact, system: RetainedSystem,
    contact: ContactState, patterns: wp.array(dtype=Pattern), bordered_rhs: wp.array(dtype=real),
):  # fmt: skip
    """Per world: the retained increments, and pressures of the active set, without the coupling of pairs by local
    modes. The factor of the retained matrix is that of the last solution if it is `kept`."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    at = w * model.capacity.slots
    count = normal.block[w, 0, LEFT_START]
    i = lane
    while i < count:
        normal.solution[at + i] = normal.right[w, i]
        i += wp.block_dim()
    sync()
    bad = eliminated(
        model, patterns[0], w, lane, int(normal.kept[w] != LINES), held_motions(run.ctl, w, system.hold_count), normal,
        system, normal.solution, at, bordered_rhs, system.z,
    )  # fmt: skip
    if bad != 0 and lane == 0:
        run.ctl[w].failure = run.ctl[w].failure | k.SINGULAR
    put_pressures(model, w, lane, count, fields, normal, impulses, contact)
