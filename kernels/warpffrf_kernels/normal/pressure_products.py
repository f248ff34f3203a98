r"""Products with the compliance of the pressures, (G + F) ds (`pressure_solve`): blocks between pairs of nodes have the
matrix G; all others are the displacements of the fields (`patch.fields`), and J sigma^-1 J^T ds of the condensed modes.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve, PatchScratch
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.linear.block_elimination import follow_columns
from warpffrf_kernels.normal.pair_elimination import COUNT, START, lines_at
from warpffrf_kernels.normal.pair_forces import surface_of
from warpffrf_kernels.patch.fields import displace_patch, load_patch, sum_lines
from warpffrf_kernels.patch.preconditioner import to_places
from warpffrf_kernels.patch.spline_tables import line_of

wp.set_module_options(MODULE_OPTIONS)

ACTIVE = wp.constant(0)  # what a product reads: the active slots,
LEFT = wp.constant(2)  # or those that have left the set; columns of `block`
VECTORS = wp.constant(7)  # of a world in `krylov`


# y += G x of the active slots of pairs with a matrix, x of the slots in the columns `read` of `block`: `own` of the
# same pair, and of those `beside`. Lanes over the places. The slots of a pair ascend and are mostly consecutive, so
# lines are read in contiguous runs.
@wp.func_native("""
    const int cap = model.capacity.slots, pairs = model.pairs.count;
    const int* list = order.data + (size_t)w * cap;
    const double* given = x.data + at_x; double* out = y.data + at_y;
    const int* blocks = block.data + (size_t)w * pairs * 4;
    const int *body = model.surfaces.body.data, *family = model.pairs.family.data, *matrix = model.pairs.matrix.data;
    const int* first = model.pairs.first.data, *second = model.pairs.second.data;
    WP_TILE_SYNC();
    for (int pair = 0; pair < pairs; ++pair) {
        if (!matrix[pair]) continue;
        const int* b = blocks + 4 * pair;
        for (int i = b[0] + WP_TILE_THREAD_IDX; i < b[0] + b[1]; i += WP_TILE_BLOCK_DIM) {
            const double* g = G.data + ((size_t)w * cap + list[i]) * cap; double sum = 0.0;
            for (int other = 0; other < pairs; ++other) {
                const int* o = blocks + 4 * other + read; const int m = o[1];
                if (m == 0 || (other == pair ? !own : family[pair] == patch || family[other] == patch)) continue;
                const int* l = list + o[0]; const double* v = given + o[0];
                const int p = body[first[pair]], q = body[second[pair]];  // the first is never the ground
                const int r = body[first[other]], s = body[second[other]];
                if (other != pair && (!beside || (p != r && p != s && (q < 0 || (q != r && q != s))))) continue;
                if (l[m - 1] - l[0] == m - 1) {
                    const double* run = g + l[0];
                    double part[4] = {0.0}; int j = 0;  // chains of sums wait for each other
                    for (; j + 3 < m; j += 4) for (int c = 0; c < 4; ++c) part[c] += run[j + c] * v[j + c];
                    for (; j < m; ++j) sum += run[j] * v[j];
                    sum += (part[0] + part[1]) + (part[2] + part[3]);
                } else for (int j = 0; j < m; ++j) sum += g[l[j]] * v[j];
            }
            out[i] += sum;
        }
    }
    WP_TILE_SYNC();
""")
def add_nodes(
    model: Model,
    w: int,
    read: int,
    own: int,
    beside: int,
    patch: int,
    G: wp.array3d(dtype=real),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    x: wp.array(dtype=real),
    at_x: int,
    y: wp.array(dtype=real),
    at_y: int,
): ...


# Loads on the modes of a pair, out[at_out:], due to x of n slots from place `start` of `order` on: J^T x. Lanes over
# the modes.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.most_modes;
    const int* list = order.data + (size_t)w * cap + start;
    WP_TILE_SYNC();
    for (int m = WP_TILE_THREAD_IDX; m < width; m += WP_TILE_BLOCK_DIM) {
        double sum = 0.0;
        for (int i = 0; i < n; ++i) sum += J.data[((size_t)w * cap + list[i]) * width + m] * x.data[at_x + i];
        out.data[at_out + m] = sum;
    }
    WP_TILE_SYNC();
""")
def load_modes_of_slots(
    model: Model,
    w: int,
    start: int,
    n: int,
    order: wp.array2d(dtype=int),
    J: wp.array(dtype=real),
    x: wp.array(dtype=real),
    at_x: int,
    out: wp.array(dtype=real),
    at_out: int,
): ...


# y[at_y + i] += J delta of n slots from place `start` of `order` on. Lanes over the slots.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.most_modes;
    const int* list = order.data + (size_t)w * cap + start;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) {
        double sum = 0.0;
        const double* j = J.data + ((size_t)w * cap + list[i]) * width;
        for (int m = 0; m < width; ++m) sum += j[m] * delta.data[at + m];
        y.data[at_y + i] += sum;
    }
    WP_TILE_SYNC();
""")
def follow_modes_of_slots(
    model: Model,
    w: int,
    start: int,
    n: int,
    order: wp.array2d(dtype=int),
    J: wp.array(dtype=real),
    delta: wp.array(dtype=real),
    at: int,
    y: wp.array(dtype=real),
    at_y: int,
): ...


# y[at_y + i] += weight (u of the cell less the opening at its place) + yield x[at_x + i], the last where x is of the
# same slots (`same`). Lanes over the n slots.
@wp.func_native("""
    const int cap = model.capacity.slots;
    const int* place = slot_place.data + (size_t)w * cap + start;
    const size_t here = (size_t)w * model.pairs.count + pair;
    const int *list = order.data + (size_t)w * cap + start, *slots = slot_node.data + (size_t)w * cap * 2;
    const double *u = shift.data + here * model.window.grid_nodes, *o = opening.data + here * elements.patches.places;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM)
        y.data[at_y + i] += weight * (u[slots[2 * list[i] + 1]] - o[place[i]])
            + (same ? slot_yield.data[(size_t)w * cap + start + i] * x.data[at_x + i] : 0.0);
    WP_TILE_SYNC();
""")
def open_cells(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    start: int,
    n: int,
    same: int,
    weight: real,
    order: wp.array2d(dtype=int),
    slot_node: wp.array3d(dtype=int),
    slot_place: wp.array2d(dtype=int),
    slot_yield: wp.array2d(dtype=real),
    shift: wp.array(dtype=real),
    opening: wp.array(dtype=real),
    x: wp.array(dtype=real),
    at_x: int,
    y: wp.array(dtype=real),
    at_y: int,
): ...


@wp.func
def modes_line(model: Model, w: int, pair: int) -> int:
    """Start of the modes of a pair in `pair_line`."""
    return (w * model.pairs.count + pair) * model.pairs.most_modes


@wp.func
def load_pair_modes(
    model: Model, w: int, pair: int, lane: int, read: int, normal: ContactSolve, patch: PatchScratch,
    impulses: ImpulsiveContact, x: wp.array(dtype=real), at_x: int,
):  # fmt: skip
    """pair_line: J^T x of a pair, added to the loads on modes."""
    line = modes_line(model, w, pair)
    which = 2 * w
    if model.pairs.family[pair] == PATCH:
        places = model.elements[0].patches.places
        rows = model.surfaces.rows[model.pairs.first[pair]]
        number = model.elements[0].patches.columns[pair] * line_of(rows)
        m = lane
        while m < model.pairs.most_modes:
            # J is minus the weight times the loads of unit pressures, x the weight times the pressures
            normal.pair_line[line + m] = -impulses.weight[w, pair] * impulses.weight[w, pair] * dot(
                number, patch.far_gradient, (line + m) * places, patch.solve_pressure,
                (w * model.pairs.count + pair) * places,
            )  # fmt: skip
            m += wp.block_dim()
        sync()
    else:
        which += 1
        start = normal.block[w, pair, read + START]
        load_modes_of_slots(
            model, w, start, normal.block[w, pair, read + COUNT], normal.order, normal.J, x, at_x + start,
            normal.pair_line, line,
        )  # fmt: skip
    at = int(0)
    for side in range(2):
        s = surface_of(model, pair, side)
        m = lane
        while m < model.surfaces.modal_count[s]:
            mode = which * model.modes.count + model.surfaces.modal_start[s] + m
            normal.mode_load[mode] = normal.mode_load[mode] + normal.pair_line[line + at + m]
            m += wp.block_dim()
        sync()
        at += model.surfaces.modal_count[s]


@wp.func
def move_pair_modes(
    model: Model, w: int, pair: int, lane: int, own: int, beside: int, normal: ContactSolve,
    receptance: wp.array2d(dtype=real),
):  # fmt: skip
    """pair_line, on entry J^T x: motions of the condensed modes of a pair's bodies due to these loads (`own`), and due
    to those of other pairs (`beside`), which G of nodes contains of other nodes."""
    line = modes_line(model, w, pair)
    at = int(0)
    for side in range(2):
        s = surface_of(model, pair, side)
        m = lane
        while m < model.surfaces.modal_count[s]:
            mode = model.surfaces.modal_start[s] + m
            load = real(own) * normal.pair_line[line + at + m]
            if beside != 0:
                load += normal.mode_load[2 * w * model.modes.count + mode]
                if model.pairs.family[pair] == PATCH:
                    load += normal.mode_load[(2 * w + 1) * model.modes.count + mode] - normal.pair_line[line + at + m]
            normal.pair_line[line + at + m] = receptance[w, mode] * load
            m += wp.block_dim()
        at += model.surfaces.modal_count[s]
    sync()


@wp.func(inline=False)
def add_cells(
    model: Model, w: int, lane: int, read: int, own: int, beside: int, normal: ContactSolve, patch: PatchScratch,
    geometry: ContactGeometry, impulses: ImpulsiveContact, x: wp.array(dtype=real), at_x: int,
    y: wp.array(dtype=real), at_y: int,
):  # fmt: skip
    """y += G x (`own`), with the yield of layers, of the active cells of patches without a matrix; F x (`beside`) of
    all, and the motion of active nodes by the modes that these load."""
    elements = model.elements[0]
    m = lane
    while m < 2 * model.modes.count:
        normal.mode_load[2 * w * model.modes.count + m] = real(0.0)
        m += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        if model.pairs.family[pair] == PATCH:
            start = normal.block[w, pair, read + START]
            to_places(
                model, elements, w, pair, start, normal.block[w, pair, read + COUNT],
                real(1.0) / impulses.weight[w, pair], normal.slot_place, normal.slot_scale, x, at_x + start, 1,
                patch.solve_pressure,
            )  # fmt: skip
            load_patch(model, elements, w, pair, patch, patch.solve_pressure, patch.solve_load)
        load_pair_modes(model, w, pair, lane, read, normal, patch, impulses, x, at_x)
        pair += 1
    pair = int(0)
    while pair < model.pairs.count:
        start = normal.block[w, pair, START]
        n = normal.block[w, pair, COUNT]
        if n > 0 and (beside != 0 or model.pairs.matrix[pair] == 0):  # `own` with a matrix: `add_nodes`
            moved = own * int(model.pairs.matrix[pair] == 0)
            move_pair_modes(model, w, pair, lane, moved, beside, normal, impulses.contact_receptance)
            line = modes_line(model, w, pair)
            if model.pairs.family[pair] == PATCH:
                places = elements.patches.places
                here = w * model.pairs.count + pair
                rows = model.surfaces.rows[model.pairs.first[pair]]
                modes = int(0)
                for side in range(2):
                    modes += model.surfaces.modal_count[surface_of(model, pair, side)]
                sum_lines(
                    elements.patches.columns[pair] * line_of(rows), modes, normal.pair_line, line, patch.far_gradient,
                    line * places, places, patch.solve_opening, here * places,
                )  # fmt: skip
                displace_patch(
                    model, elements, w, pair, moved, beside, patch, geometry, patch.solve_pressure, patch.solve_load,
                    patch.solve_field, patch.solve_place, patch.solve_shift,
                )  # fmt: skip
                open_cells(
                    model, elements, w, pair, start, n, moved * int(read == ACTIVE), impulses.weight[w, pair],
                    normal.order, normal.slot_node, normal.slot_place, normal.slot_yield, patch.solve_shift,
                    patch.solve_opening, x, at_x + start, y, at_y + start,
                )  # fmt: skip
            else:
                follow_modes_of_slots(
                    model, w, start, n, normal.order, normal.J, normal.pair_line, line, y, at_y + start
                )
        pair += 1


@wp.func(inline=False)
def add_product(
    model: Model, w: int, lane: int, read: int, own: int, beside: int, normal: ContactSolve, patch: PatchScratch,
    geometry: ContactGeometry, impulses: ImpulsiveContact, x: wp.array(dtype=real), at_x: int,
    y: wp.array(dtype=real), at_y: int,
):  # fmt: skip
    """y += G x (`own`) and F x (`beside`) of the active slots, x of those in the columns `read` of `block`. G of pairs
    with a matrix only of slots that have left the set: of active ones, the elimination is exact."""
    if model.pairs.dense != 0 and (read != ACTIVE or beside != 0):
        add_nodes(
            model, w, read, own * int(read != ACTIVE), beside, PATCH, normal.soft, normal.order, normal.block, x, at_x,
            y, at_y,
        )  # fmt: skip
    if model.elements[0].patches.count > 0 and (beside != 0 or model.pairs.matrix_free != 0):
        add_cells(model, w, lane, read, own, beside, normal, patch, geometry, impulses, x, at_x, y, at_y)


@wp.func
def follow_retained(
    model: Model, w: int, part: real, normal: ContactSolve, z: wp.array(dtype=real), y: wp.array(dtype=real), at: int
):
    """y += part L z of the active slots of pairs without a matrix."""
    pair = int(0)
    while pair < model.pairs.count:
        start = normal.block[w, pair, START]
        n = normal.block[w, pair, COUNT]
        if n > 0 and model.pairs.matrix[pair] == 0:
            follow_columns(model, w, pair, n, part, normal.borders, lines_at(model, w, start), z, y, at + start)
        pair += 1
