r"""Solution for the pressures: products with their compliance, and a Krylov method where the elimination is not exact.

The system of `contact_solve`, with F the blocks of G between pairs, reads

    A z - L^T ds = rhs,      L z + (G + F) ds = b.

`pair_elimination` satisfies the first line exactly, and the second one, too, for pairs with a matrix and without F. It
is the preconditioner M of an iteration that adds increments (M y, and those of z that belong to it), so that only the
second line has a residual:

    y - T y,      T y = G M y + L z(M y),      y itself where the elimination is exact.

Blocks F are many and small, 0.01 of G for steel rings, so an iteration leaves them out, and is repeated with what they
add to the residual. Where that does not halve it, as if patches of soft bodies lie close together, T has them as well.

With the weights w of impulsive pairs the blocks of local modes between pairs are F_ij w_i/w_j: not symmetric where an
idle pair touches next to one that is pressed, so the method is that of van der Vorst (BiCGStab, 1992), on the right.
Symmetric blocks in their place would not agree with the gaps by which the active set is corrected: cells at the edge of
a patch would enter and leave it indefinitely.

An idle roller carries a millionth of what its neighbours do, and its contacts have to be balanced, too: an iteration
ends where the residual of every pair is less than a fraction of its own right-hand side, or is round-off.

Products: `pressure_products`.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry, ContactSolve, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync, weighted
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.linear.retained_solve import held_motions
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import (
    COUNT,
    LEFT_COUNT,
    LEFT_START,
    LINES,
    START,
    add_borders,
    eliminated,
)
from warpffrf_kernels.normal.pair_forces import surface_of
from warpffrf_kernels.normal.pressure_products import ACTIVE, LEFT, VECTORS, add_cells, add_product, follow_retained
from warpffrf_kernels.patch.preconditioner import precondition_near

wp.set_module_options(MODULE_OPTIONS)

REDUCTION = wp.constant(wp.float64(1.0e-5))  # of the residual: the rest is left to the next iteration
EXACT = wp.constant(wp.float64(1.0e-10))  # the same of a set that is corrected for long: signs decide about cells
PATIENCE = wp.constant(4)  # solutions before
PASSES = wp.constant(20)  # iterations without F
TINY = wp.constant(wp.float64(1.0e-300))
MOST = wp.constant(60)  # steps; the rest stays in the gaps for the Newton iteration


@wp.func
def inner(n: int, x: wp.array(dtype=real), a: int, y: wp.array(dtype=real), b: int) -> real:
    """x[a:] . y[b:] of n numbers, the same in every lane."""
    total = dot(n, x, a, y, b)
    sync()
    return total


@kernel
def answer_uniform(
    run: Run, normal: ContactSolve, patch: PatchScratch, geometry: ContactGeometry, impulses: ImpulsiveContact
):  # fmt: skip
    """Per world: the pressures of each pair without a matrix that answer a uniform gap, and the gap due to them
    (`patch.preconditioner`), unless they are `kept`."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or normal.kept[w] == LINES:
        return
    z = 2 * w * model.capacity.slots
    y = z + model.capacity.slots
    pair = int(0)
    while pair < model.pairs.count:
        start = normal.block[w, pair, START]
        n = normal.block[w, pair, COUNT]
        if n > 0 and model.pairs.matrix[pair] == 0:
            i = start + lane
            while i < start + n:
                size = geometry.area[w, pair, normal.slot_node[w, normal.order[w, i], 1]]
                normal.uniform[z + i] = size
                normal.uniform[y + i] = real(0.0)
                i += wp.block_dim()
            sync()
            precondition_near(
                model, w, pair, start, n, patch, normal, normal.uniform, z + start, normal.uniform, z + start, 1
            )
        pair += 1
    add_cells(model, w, lane, ACTIVE, 1, 0, normal, patch, geometry, impulses, normal.uniform, z, normal.uniform, y)
    pair = int(0)
    while pair < model.pairs.count:
        start = normal.block[w, pair, START]
        n = normal.block[w, pair, COUNT]
        if n > 0 and model.pairs.matrix[pair] == 0:
            size = inner(n, normal.uniform, z + start, normal.uniform, y + start)
            scale = real(0.0)
            if size > real(0.0):
                scale = real(1.0) / wp.sqrt(size)
            elif lane == 0:  # or not a number
                run.ctl[w].failure = run.ctl[w].failure | k.INDEFINITE
            i = start + lane
            while i < start + n:
                normal.uniform[z + i] = scale * normal.uniform[z + i]
                normal.uniform[y + i] = scale * normal.uniform[y + i]
                i += wp.block_dim()
            sync()
        pair += 1


@kernel
def pose_pressures(
    run: Run, system: RetainedSystem, fields: ContactFields, normal: ContactSolve, patch: PatchScratch,
    geometry: ContactGeometry, impulses: ImpulsiveContact, residuals: Residuals, patterns: wp.array(dtype=Pattern),
    modal_residual: wp.array(dtype=real),
):  # fmt: skip
    """Per world: the retained matrix of the elimination, unless it is `kept` too, and both right-hand sides with the
    slots that leave the set."""
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
    cap = model.capacity.slots
    active = normal.block[w, 0, LEFT_START]  # the preceding places are those of active slots
    last = model.pairs.count - 1
    all = normal.block[w, last, LEFT_START] + normal.block[w, last, LEFT_COUNT]
    i = active + lane
    while i < all:
        pair = normal.slot_node[w, normal.order[w, i], 0]
        node = normal.slot_node[w, normal.order[w, i], 1]
        normal.solution[w * cap + i] = impulses.weight[w, pair] * fields.base[w, pair, node]
        i += wp.block_dim()
    sync()
    i = lane
    while i < active:
        normal.right[w * cap + i] = real(0.0)
        i += wp.block_dim()
    sync()
    if all > active:
        add_product(
            model, w, lane, LEFT, 1, model.pairs.beside, normal, patch, geometry, impulses, normal.solution, w * cap,
            normal.right, w * cap,
        )  # fmt: skip
        pair = int(0)
        while pair < model.pairs.count:
            start = normal.block[w, pair, LEFT_START]
            n = normal.block[w, pair, LEFT_COUNT]
            if n > 0:
                release(model, w, pair, lane, start, n, normal)
            pair += 1
    sync()
    i = lane
    while i < active:
        a = normal.order[w, i]
        pair = normal.slot_node[w, a, 0]
        total = -impulses.weight[w, pair] * fields.opened[w, pair, normal.slot_node[w, a, 1]]
        line = (w * cap + a) * model.pairs.most_modes
        for side in range(2):
            surface = surface_of(model, pair, side)
            modes = w * model.modes.count + model.surfaces.modal_start[surface]
            n = model.surfaces.modal_count[surface]
            total += weighted(n, normal.J, line, residuals.receptance, modes, modal_residual, modes)
            line += n
        scale = normal.row_scale[w, pair]
        normal.right[w * cap + i] = normal.right[w * cap + i] / scale + scale * total
        i += wp.block_dim()


@wp.func
def release(model: Model, w: int, pair: int, lane: int, start: int, n: int, normal: ContactSolve):
    """Takes what slots that have left the set carried off the right-hand side of the retained coordinates. Lanes over
    the columns; columns that are named twice have zeros."""
    c = lane
    while c < model.pairs.coupled_count[pair]:
        total = real(0.0)
        i = int(0)
        while i < n:
            line = (w * model.capacity.slots + start + i) * model.pairs.coupled_capacity
            total += normal.borders[line + c] * normal.solution[w * model.capacity.slots + start + i]
            i += 1
        if total != real(0.0):
            column = model.pairs.coupled[pair, c]
            normal.bordered_rhs[w, column] = normal.bordered_rhs[w, column] - total
        c += wp.block_dim()
    sync()


@wp.func
def copy(n: int, lane: int, x: wp.array(dtype=real), a: int, b: int):
    """x[b:] = x[a:] of n numbers. Lanes over them."""
    i = lane
    while i < n:
        x[b + i] = x[a + i]
        i += wp.block_dim()
    sync()


@wp.func(inline=False)
def image_of(
    model: Model, p: Pattern, w: int, lane: int, count: int, beside: int, source: int, answer: int, image: int,
    normal: ContactSolve, patch: PatchScratch, geometry: ContactGeometry, impulses: ImpulsiveContact,
    system: RetainedSystem,
):  # fmt: skip
    """krylov[answer:] = M of krylov[source:], its retained increments in `krylov_z`, and krylov[image:] = T of it."""
    i = lane
    while i < model.retained.count:
        normal.krylov_rhs[w * model.retained.count + i] = real(0.0)
        i += wp.block_dim()
    i = lane
    while i < count:
        normal.krylov[answer + i] = normal.krylov[source + i]
        normal.krylov[image + i] = real(0.0)
        if model.pairs.matrix[normal.slot_node[w, normal.order[w, i], 0]] != 0:  # their elimination is exact
            normal.krylov[image + i] = normal.krylov[source + i]
        i += wp.block_dim()
    sync()
    eliminated(
        model, p, w, lane, 0, 0, normal, patch, system, normal.krylov, answer, normal.krylov_rhs,
        normal.krylov_z,
    )  # fmt: skip
    sync()
    add_product(
        model, w, lane, ACTIVE, 1, beside, normal, patch, geometry, impulses, normal.krylov, answer, normal.krylov,
        image,
    )  # fmt: skip
    follow_retained(model, w, real(1.0), normal, normal.krylov_z, normal.krylov, image)


@wp.func
def step_along(
    model: Model, w: int, lane: int, count: int, length: real, normal: ContactSolve, answer: int, residual: int,
    image: int, x: wp.array(dtype=real), z: wp.array(dtype=real),
):  # fmt: skip
    """A step along krylov[answer:], `length` times as long, whose image is krylov[image:]."""
    i = lane
    while i < count:
        at = w * model.capacity.slots + i
        x[at] = x[at] + length * normal.krylov[answer + i]
        normal.krylov[residual + i] = normal.krylov[residual + i] - length * normal.krylov[image + i]
        i += wp.block_dim()
    i = w * model.retained.count + lane
    while i < (w + 1) * model.retained.count:
        z[i] = z[i] + length * normal.krylov_z[i]
        i += wp.block_dim()
    sync()


@wp.func(inline=False)
def find_residual(
    model: Model, w: int, lane: int, count: int, normal: ContactSolve, patch: PatchScratch, geometry: ContactGeometry,
    impulses: ImpulsiveContact, right: wp.array(dtype=real), x: wp.array(dtype=real), z: wp.array(dtype=real),
):  # fmt: skip
    """The residual of the elimination, the first of the vectors, without F."""
    at = w * model.capacity.slots
    residual = VECTORS * at
    i = lane
    while i < count:
        normal.krylov[residual + i] = real(0.0)
        i += wp.block_dim()
    sync()
    add_product(model, w, lane, ACTIVE, 1, 0, normal, patch, geometry, impulses, x, at, normal.krylov, residual)
    follow_retained(model, w, real(1.0), normal, z, normal.krylov, residual)
    i = lane
    while i < count:
        if model.pairs.matrix[normal.slot_node[w, normal.order[w, i], 0]] == 0:
            normal.krylov[residual + i] = right[at + i] - normal.krylov[residual + i]
        i += wp.block_dim()
    sync()


@wp.func(inline=False)
def take_beside(
    model: Model, w: int, lane: int, count: int, normal: ContactSolve, patch: PatchScratch, geometry: ContactGeometry,
    impulses: ImpulsiveContact, x: wp.array(dtype=real),
):  # fmt: skip
    """Takes F times the change of x since the last call off the residual, the first of the vectors; the last of them is
    x then."""
    at = w * model.capacity.slots
    residual = VECTORS * at
    image = residual + 3 * model.capacity.slots
    known = residual + (VECTORS - 1) * model.capacity.slots
    i = lane
    while i < count:
        normal.krylov[image + i] = real(0.0)
        normal.krylov[known + i] = normal.krylov[known + i] - x[at + i]
        i += wp.block_dim()
    sync()
    add_product(
        model, w, lane, ACTIVE, 0, 1, normal, patch, geometry, impulses, normal.krylov, known, normal.krylov, image
    )
    i = lane
    while i < count:
        normal.krylov[residual + i] = normal.krylov[residual + i] + normal.krylov[image + i]
        normal.krylov[known + i] = x[at + i]
        i += wp.block_dim()
    sync()


@wp.func
def allow(model: Model, w: int, lane: int, fraction: real, normal: ContactSolve, x: wp.array(dtype=real), at: int):
    """Each pair may leave a residual of this fraction of x[at:]."""
    pair = int(0)
    while pair < model.pairs.count:
        start = at + normal.block[w, pair, START]
        size = fraction * fraction * inner(normal.block[w, pair, COUNT], x, start, x, start)
        if lane == 0:
            normal.krylov_least[w, pair] = wp.max(normal.krylov_least[w, pair], size)
        pair += 1
    sync()


@wp.func
def excess(model: Model, w: int, normal: ContactSolve) -> real:
    """The largest square of a pair's residual, the first of the vectors, over what it may leave; the same in every
    lane."""
    most = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        at = w * VECTORS * model.capacity.slots + normal.block[w, pair, START]
        size = inner(normal.block[w, pair, COUNT], normal.krylov, at, normal.krylov, at)
        if size > real(0.0):
            most = wp.max(most, size / wp.max(normal.krylov_least[w, pair], TINY))
        pair += 1
    return most


@wp.func(inline=False)
def iterate(
    model: Model, p: Pattern, w: int, lane: int, count: int, beside: int, normal: ContactSolve, patch: PatchScratch,
    geometry: ContactGeometry, impulses: ImpulsiveContact, system: RetainedSystem, x: wp.array(dtype=real),
    z: wp.array(dtype=real),
):  # fmt: skip
    """x and z with a residual that pairs may leave, from that in the first of the vectors on."""
    cap = model.capacity.slots
    residual = w * VECTORS * cap
    shadow = residual + cap  # the first residual
    path = residual + 2 * cap
    image = residual + 3 * cap  # of the path
    answer = residual + 4 * cap  # M of the path, or of the residual
    second = residual + 5 * cap  # image of the latter
    copy(count, lane, normal.krylov, residual, shadow)
    copy(count, lane, normal.krylov, residual, path)
    product = inner(count, normal.krylov, residual, normal.krylov, residual)
    step = int(0)
    while step < MOST and product != real(0.0) and excess(model, w, normal) > real(1.0):
        image_of(model, p, w, lane, count, beside, path, answer, image, normal, patch, geometry, impulses, system)
        along = inner(count, normal.krylov, shadow, normal.krylov, image)
        if along == real(0.0):
            break
        length = product / along
        step_along(model, w, lane, count, length, normal, answer, residual, image, x, z)
        if excess(model, w, normal) <= real(1.0):
            break
        image_of(model, p, w, lane, count, beside, residual, answer, second, normal, patch, geometry, impulses, system)
        square = inner(count, normal.krylov, second, normal.krylov, second)
        part = real(0.0)
        if square > real(0.0):
            part = inner(count, normal.krylov, second, normal.krylov, residual) / square
        step_along(model, w, lane, count, part, normal, answer, residual, second, x, z)
        before = product
        product = inner(count, normal.krylov, shadow, normal.krylov, residual)
        kept = real(0.0)
        if part != real(0.0):
            kept = product / before * length / part
        i = lane
        while i < count:
            normal.krylov[path + i] = normal.krylov[residual + i] + kept * (
                normal.krylov[path + i] - part * normal.krylov[image + i]
            )
            i += wp.block_dim()
        sync()
        step += 1


@wp.func
def complete(
    model: Model, p: Pattern, w: int, lane: int, count: int, coupled: int, reduction: real, normal: ContactSolve,
    patch: PatchScratch, geometry: ContactGeometry, impulses: ImpulsiveContact, system: RetainedSystem,
    right: wp.array(dtype=real), x: wp.array(dtype=real), z: wp.array(dtype=real),
):  # fmt: skip
    """x and z, on entry those of the elimination, with a residual of each pair of less than `reduction` of its first
    one, or of its right-hand side, or EXACT of all of them."""
    at = w * model.capacity.slots
    residual = VECTORS * at
    known = residual + (VECTORS - 1) * model.capacity.slots
    round_off = EXACT * EXACT * inner(count, right, at, right, at)
    i = lane
    while i < model.pairs.count:
        normal.krylov_least[w, i] = round_off
        i += wp.block_dim()
    sync()
    find_residual(model, w, lane, count, normal, patch, geometry, impulses, right, x, z)
    allow(model, w, lane, reduction, normal, right, at)
    allow(model, w, lane, reduction, normal, normal.krylov, residual)
    if coupled == 0:
        iterate(model, p, w, lane, count, 0, normal, patch, geometry, impulses, system, x, z)
        return
    i = lane
    while i < count:
        normal.krylov[known + i] = real(0.0)
        i += wp.block_dim()
    sync()
    take_beside(model, w, lane, count, normal, patch, geometry, impulses, x)
    allow(model, w, lane, reduction, normal, normal.krylov, residual)
    beside = int(0)
    fall = real(1.0)  # of the square of the residual, by the last iteration
    size = excess(model, w, normal)
    turn = int(0)
    while size > real(1.0) and turn < PASSES:
        before = size
        iterate(model, p, w, lane, count, beside, normal, patch, geometry, impulses, system, x, z)
        if beside != 0 or fall * before <= real(1.0):  # the residual would be less
            return
        take_beside(model, w, lane, count, normal, patch, geometry, impulses, x)
        size = excess(model, w, normal)
        fall = size / before
        if fall > real(0.25):
            beside = 1
        turn += 1


@wp.func
def solve_system(
    model: Model, p: Pattern, w: int, lane: int, renew: int, held: int, coupled: int, normal: ContactSolve,
    patch: PatchScratch, geometry: ContactGeometry, impulses: ImpulsiveContact, system: RetainedSystem,
    right: wp.array(dtype=real), rhs: wp.array(dtype=real), x: wp.array(dtype=real), z: wp.array(dtype=real),
    reduction: real,
) -> int:  # fmt: skip
    """Changes x of the pressures of the active slots and retained increments z; `coupled`: with F. 1 if the retained
    matrix is singular."""
    count = normal.block[w, 0, LEFT_START]
    at = w * model.capacity.slots
    i = lane
    while i < count:
        x[at + i] = right[at + i]
        i += wp.block_dim()
    sync()
    bad = eliminated(model, p, w, lane, renew, held, normal, patch, system, x, at, rhs, z)
    sync()
    if count > 0 and (coupled != 0 or model.pairs.matrix_free != 0):
        complete(model, p, w, lane, count, coupled, reduction, normal, patch, geometry, impulses, system, right, x, z)
    return bad


@kernel
def solve_pressures(
    run: Run, fields: ContactFields, normal: ContactSolve, patch: PatchScratch, geometry: ContactGeometry,
    impulses: ImpulsiveContact, system: RetainedSystem, contact: ContactState, patterns: wp.array(dtype=Pattern),
    bordered_rhs: wp.array(dtype=real),
):  # fmt: skip
    """Per world: the retained increments, and pressures of the active set. The factor of the retained matrix is that of
    the last solution if it is `kept`."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    reduction = REDUCTION
    if run.ctl[w].inner > PATIENCE:
        reduction = EXACT
    bad = solve_system(
        model, patterns[0], w, lane, int(normal.kept[w] != LINES), held_motions(run.ctl, w, system.hold_count),
        model.pairs.beside, normal, patch, geometry, impulses, system, normal.right, bordered_rhs, normal.solution,
        system.z, reduction,
    )  # fmt: skip
    if bad != 0 and lane == 0:
        run.ctl[w].failure = run.ctl[w].failure | k.SINGULAR
    i = lane
    while i < normal.block[w, 0, LEFT_START]:
        pair = normal.slot_node[w, normal.order[w, i], 0]
        m = normal.slot_node[w, normal.order[w, i], 1]
        contact.pressure[w, pair, m] = (
            fields.base[w, pair, m]
            + normal.row_scale[w, pair] * normal.solution[w * model.capacity.slots + i] / impulses.weight[w, pair]
        )
        i += wp.block_dim()
