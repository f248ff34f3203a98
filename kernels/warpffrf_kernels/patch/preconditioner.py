r"""The preconditioner of the pressures of a patch: W of the half-spaces, masked to the active cells.

W has the inverse blocks of a periodic kernel (`warpffrf.online.compile.strips`), so P W P on the active cells P is
close to the inverse of their compliance, which far fields and modes only add smooth parts to. A layer adds its yield
E_i to the diagonal, A_i times its compliance or the tangent of its law (`layers.weak_layer`); with w_ii the diagonal of
W, its effect is V = P S W S P, S_i = (1 + E_i w_ii)^-1/2.

Far fields are a few times the half-spaces' answer to a uniform pressure, and little of others: of 388 cells of rollers,
the eigenvalues of V G are 1 to 4.9 with two of them above 3. With G the compliance, q the areas and z = V q, scaled to
z.(G z) = 1, the preconditioner is balanced (Mandel, 1993) by that one function, for which it is exact,

    M = z z^T + (1 - z y^T) V (1 - y z^T),      y = G z.

It is symmetric and positive definite. The retained stiffness L^T M L errs by 1e-3, with a layer as soft as the bodies
by 6 %, which is enough for what follows the tractions (`friction.receptance`); with V alone it is a few times too
large.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve, LayerScratch, PatchScratch
from warpffrf_kernels.core.model import CONSTANT, Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.linear.block_elimination import is_loaded, product_of_borders
from warpffrf_kernels.patch.strips import inverse_at, multiply_inverse

wp.set_module_options(MODULE_OPTIONS)


# Places, yields of a nonlinear layer and factors S_i of n slots from place `start` of `order` on; `layer`: compliance
# of a linear one; `part`: unit of W. Lanes over the slots.
@wp.func_native("""
    const int cap = model.capacity.slots, line = (rows + 7) / 8 * 8;
    const size_t here = (size_t)w * model.pairs.count + pair, first = (size_t)w * cap + start;
    const int *list = order.data + first, *slots = slot_node.data + (size_t)w * cap * 2;
    const double *size = area.data + here * model.window.grid_nodes, *own = inverse.data + at_own;
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) {
        const int m = slots[2 * list[i] + 1], r = m % rows;
        const double yielded = nonlinear ? tangent.data[(here * model.window.grid_nodes + m) * 9 + 4] : 0.0;
        slot_place.data[first + i] = m / rows * line + r;
        slot_yield.data[first + i] = yielded;
        slot_scale.data[first + i] = 1.0 / ::sqrt(1.0 + part * (layer * size[m] + yielded) * own[r]);
    }
    WP_TILE_SYNC();
""")
def find_places(
    model: Model,
    w: int,
    pair: int,
    rows: int,
    start: int,
    n: int,
    nonlinear: int,
    layer: real,
    part: real,
    inverse: wp.array(dtype=real),
    at_own: int,
    order: wp.array2d(dtype=int),
    slot_node: wp.array3d(dtype=int),
    area: wp.array3d(dtype=real),
    tangent: wp.array4d(dtype=real),
    slot_place: wp.array2d(dtype=int),
    slot_yield: wp.array2d(dtype=real),
    slot_scale: wp.array2d(dtype=real),
): ...


# x[at + i stride] of n slots from place `start` of `order` on, times `part`, or S_i if `part` is 0, to the places of
# their pair; zeros at others. Lanes over the places, then the slots.
@wp.func_native("""
    const size_t first = (size_t)w * model.capacity.slots + start;
    const int* place = slot_place.data + first;
    const double *given = x.data + at, *scale = slot_scale.data + first;
    double* q = placed.data + ((size_t)w * model.pairs.count + pair) * elements.patches.places;
    WP_TILE_SYNC();
    for (int e = WP_TILE_THREAD_IDX; e < elements.patches.places; e += WP_TILE_BLOCK_DIM) q[e] = 0.0;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM)
        q[place[i]] = (part != 0.0 ? part : scale[i]) * given[(size_t)i * stride];
    WP_TILE_SYNC();
""")
def to_places(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    start: int,
    n: int,
    part: real,
    slot_place: wp.array2d(dtype=int),
    slot_scale: wp.array2d(dtype=real),
    x: wp.array(dtype=real),
    at: int,
    stride: int,
    placed: wp.array(dtype=real),
): ...


# The reverse: y[at + i stride] = S_i times what is at the place of slot i.
@wp.func_native("""
    const size_t first = (size_t)w * model.capacity.slots + start;
    const int* place = slot_place.data + first;
    const double *q = placed.data + ((size_t)w * model.pairs.count + pair) * elements.patches.places;
    const double* scale = slot_scale.data + first;
    double* out = y.data + at;
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) out[(size_t)i * stride] = scale[i] * q[place[i]];
    WP_TILE_SYNC();
""")
def from_places(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    start: int,
    n: int,
    slot_place: wp.array2d(dtype=int),
    slot_scale: wp.array2d(dtype=real),
    placed: wp.array(dtype=real),
    y: wp.array(dtype=real),
    at: int,
    stride: int,
): ...


@wp.func
def place_slots(
    model: Model, w: int, pair: int, start: int, n: int, patch: PatchScratch, geometry: ContactGeometry,
    layers: LayerScratch, normal: ContactSolve,
):  # fmt: skip
    """Places, yields and factors S_i of n slots from place `start` of `order` on."""
    elements = model.elements[0]
    width = patch.patch_place[w, pair, 2]
    find_places(
        model, w, pair, model.surfaces.rows[model.pairs.first[pair]], start, n,
        int(elements.layers.kind[pair] != CONSTANT), elements.patches.layer[pair],
        wp.pow(width, -elements.patches.near_power[pair]), elements.patches.inverse,
        inverse_at(model, elements, pair, width), normal.order, normal.slot_node, geometry.area, layers.layer_tangent,
        normal.slot_place, normal.slot_yield, normal.slot_scale,
    )  # fmt: skip


# x[at_x + i stride] + part u[at_u + i], to y. Lanes over i.
@wp.func_native("""
    const double *given = x.data + at_x, *more = u.data + at_u; double* out = y.data + at_y;
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM)
        out[(size_t)i * stride] = given[(size_t)i * stride] + part * more[i];
    WP_TILE_SYNC();
""")
def shift(
    n: int,
    part: real,
    u: wp.array(dtype=real),
    at_u: int,
    x: wp.array(dtype=real),
    at_x: int,
    y: wp.array(dtype=real),
    at_y: int,
    stride: int,
): ...


# u . x, the same in every lane.
@wp.func_native("""
    const double *a = u.data + at_u, *b = x.data + at_x; double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += a[i] * b[(size_t)i * stride];
    WP_TILE_SYNC();
    return sum;
""")
def along(n: int, u: wp.array(dtype=real), at_u: int, x: wp.array(dtype=real), at_x: int, stride: int) -> real: ...


@wp.func
def precondition_patch(
    model: Model, w: int, pair: int, start: int, n: int, patch: PatchScratch, normal: ContactSolve,
    x: wp.array(dtype=real), at_x: int, y: wp.array(dtype=real), at_y: int, stride: int,
):  # fmt: skip
    """y = M x of n slots from place `start` of `order` on; both may be the same numbers."""
    z = 2 * w * model.capacity.slots + start
    opened = z + model.capacity.slots
    part = along(n, normal.uniform, z, x, at_x, stride)
    shift(n, -part, normal.uniform, opened, x, at_x, y, at_y, stride)
    precondition_near(model, w, pair, start, n, patch, normal, y, at_y, y, at_y, stride)
    part -= along(n, normal.uniform, opened, y, at_y, stride)
    shift(n, part, normal.uniform, z, y, at_y, y, at_y, stride)


@wp.func
def precondition_near(
    model: Model, w: int, pair: int, start: int, n: int, patch: PatchScratch, normal: ContactSolve,
    x: wp.array(dtype=real), at_x: int, y: wp.array(dtype=real), at_y: int, stride: int,
):  # fmt: skip
    """y = V x of n slots from place `start` of `order` on; both may be the same numbers."""
    elements = model.elements[0]
    to_places(
        model, elements, w, pair, start, n, real(0.0), normal.slot_place, normal.slot_scale, x, at_x, stride,
        patch.solve_pressure,
    )  # fmt: skip
    multiply_inverse(model, elements, w, pair, patch, patch.solve_pressure, patch.solve_place)
    from_places(
        model, elements, w, pair, start, n, normal.slot_place, normal.slot_scale, patch.solve_place, y, at_y, stride
    )


@wp.func(inline=False)
def eliminate_patch(
    model: Model, w: int, pair: int, lane: int, start: int, n: int, patch: PatchScratch, normal: ContactSolve
):  # fmt: skip
    """Z = M L of the slots of a pair, in W, and L^T Z."""
    width = model.pairs.coupled_capacity
    count = model.pairs.coupled_count[pair]
    at = (w * model.capacity.slots + start) * width
    c = int(0)
    while c < count:
        if is_loaded(n, width, normal.borders, at + c) != 0:
            precondition_patch(model, w, pair, start, n, patch, normal, normal.borders, at + c, normal.W, at + c, width)
        else:
            i = lane
            while i < n:
                normal.W[at + i * width + c] = real(0.0)
                i += wp.block_dim()
            sync()
        c += 1
    product_of_borders(
        n, width, count, at, normal.borders, normal.W, (w * model.pairs.count + pair) * width * width, normal.square
    )
