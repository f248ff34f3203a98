r"""Free coordinates of the tractions of cells, and products restricted to them.

Each slot has a frame, 8 numbers: a direction d, whether tractions along and across it are free, the compliances Lambda
that are added along and across it, and the scales S of the preconditioner along and across it,

    S = (1 + W_ii Lambda)^-1/2,

W_ii the diagonal of the preconditioner of the half-spaces. In Newton's method a sticking cell is free in both
directions, a sliding one across its direction, with its softness and lambda added; in the interior-point method all
loaded cells are free, with lambda along and across, and lambda |tau|^2/c more along.
"""

import warp as wp

from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# Frames of the slots of a pair: of Newton's method by kind (0 no traction, 1 sticks, 2 slides along `direction`), or
# inside the discs (`slope` lambda) with `by_slope`. `own`: diagonal of the preconditioner, times `scale`. Lanes over
# the slots.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const int line = (rows + 7) / 8 * 8;
    const double *dir = direction.data + here * 2 * cap, *x = tau.data + here * 2 * cap;
    const double *soft = softness.data + here * cap, *b = radius.data + here * cap;
    const double* curve = curvature.data + here * cap;
    const double *lambda = slope.data + here * cap, *inverse = own.data + at_own;
    const int *kind = sliding.data + here * 2 * cap, *slot = cell_slot.data + here * cap;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        double* f = frame.data + (here * cap + i) * 8;
        const int r = slot[i] % rows;
        double d0 = 1.0, d1 = 0.0, along = 0.0, across = 0.0, p = soft[i], q = soft[i];
        if (by_slope) {
            if (b[i] > 0.0) {
                const double size2 = x[2 * i] * x[2 * i] + x[2 * i + 1] * x[2 * i + 1], size = ::sqrt(size2);
                along = across = 1.0; p += lambda[i]; q += lambda[i];
                if (size > 0.0) {
                    d0 = x[2 * i] / size; d1 = x[2 * i + 1] / size;
                    p += lambda[i] * 2.0 * size2 / (b[i] * b[i] - size2);
                }
            }
        } else if (kind[i] == 1) along = across = 1.0;
        else if (kind[i] == 2) { across = 1.0; d0 = dir[2 * i]; d1 = dir[2 * i + 1]; q += curve[i]; }
        const double mean = 0.5 * scale * (inverse[r] + inverse[line + r]);
        f[0] = d0; f[1] = d1; f[2] = along; f[3] = across; f[4] = p; f[5] = q;
        f[6] = along / ::sqrt(1.0 + mean * p); f[7] = across / ::sqrt(1.0 + mean * q);
    }
    WP_TILE_SYNC();
""")
def frame_cells(
    model: Model,
    w: int,
    pair: int,
    count: int,
    rows: int,
    by_slope: int,
    scale: real,
    own: wp.array(dtype=real),
    at_own: int,
    cell_slot: wp.array3d(dtype=int),
    sliding: wp.array(dtype=int),
    direction: wp.array(dtype=real),
    curvature: wp.array(dtype=real),
    slope: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    radius: wp.array(dtype=real),
    softness: wp.array(dtype=real),
    frame: wp.array(dtype=real),
): ...


# Whether the frames of Newton's method of a pair still hold: the same kinds, directions with at least this
# cosine, added compliances within a fraction of the diagonal of the system.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const int line = (rows + 7) / 8 * 8;
    const double *dir = direction.data + here * 2 * cap, *curve = curvature.data + here * cap;
    const double *soft = softness.data + here * cap, *inverse = own.data + at_own;
    const int *kind = sliding.data + here * 2 * cap, *slot = cell_slot.data + here * cap;
    WP_TILE_SYNC();
    for (int i = 0; i < count; ++i) {  // every lane for itself
        const double* f = frame.data + (here * cap + i) * 8;
        const int found = f[2] != 0.0 ? 1 : f[3] != 0.0 ? 2 : 0, r = slot[i] % rows;
        if (found != kind[i]) return 0;
        if (found == 0) continue;
        if (found == 2 && f[0] * dir[2 * i] + f[1] * dir[2 * i + 1] < cosine) return 0;
        const double mean = 0.5 * scale * (inverse[r] + inverse[line + r]);
        const double change = soft[i] + (found == 2 ? curve[i] : 0.0) - f[5];
        if (::fabs(change) * mean > fraction * (1.0 + mean * f[5])) return 0;
    }
    return 1;
""")
def frames_hold(
    model: Model,
    w: int,
    pair: int,
    count: int,
    rows: int,
    cosine: real,
    fraction: real,
    scale: real,
    own: wp.array(dtype=real),
    at_own: int,
    cell_slot: wp.array3d(dtype=int),
    sliding: wp.array(dtype=int),
    direction: wp.array(dtype=real),
    curvature: wp.array(dtype=real),
    softness: wp.array(dtype=real),
    frame: wp.array(dtype=real),
) -> int: ...


# Right-hand side of Newton's method: -slip of a sticking cell, of a sliding one that across its *present* direction,
# across that of its frame. Lanes over the slots.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const double *r = slip.data + here * 2 * cap, *dir = direction.data + here * 2 * cap;
    const int* kind = sliding.data + here * 2 * cap;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        const double* f = frame.data + (here * cap + i) * 8; double* out = residual.data + (here * cap + i) * 2;
        const double across = dir[2 * i + 1] * r[2 * i] - dir[2 * i] * r[2 * i + 1];
        out[0] = kind[i] == 1 ? -r[2 * i] : kind[i] == 2 ? -across * f[1] : 0.0;
        out[1] = kind[i] == 1 ? -r[2 * i + 1] : kind[i] == 2 ? across * f[0] : 0.0;
    }
    WP_TILE_SYNC();
""")
def pose_framed(
    model: Model,
    w: int,
    pair: int,
    count: int,
    direction: wp.array(dtype=real),
    sliding: wp.array(dtype=int),
    slip: wp.array(dtype=real),
    frame: wp.array(dtype=real),
    residual: wp.array(dtype=real),
): ...


# place = S x of the slots of a pair, on A, zero elsewhere. x has `stride` numbers from one line to the next.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const int line = (rows + 7) / 8 * 8, places = elements.patches.places, lane = WP_TILE_THREAD_IDX;
    const int* slot = cell_slot.data + here * cap;
    double* out = place.data + here * 2 * places;
    WP_TILE_SYNC();
    for (int e = lane; e < 2 * places; e += WP_TILE_BLOCK_DIM) out[e] = 0.0;
    WP_TILE_SYNC();
    for (int i = lane; i < count; i += WP_TILE_BLOCK_DIM) {
        const double *f = frame.data + (here * cap + i) * 8, *v = x.data + at_x + (size_t)2 * i * stride;
        const double a = f[6] * (f[0] * v[0] + f[1] * v[stride]), b = f[7] * (f[0] * v[stride] - f[1] * v[0]);
        const int e = slot[i] / rows * line + slot[i] % rows;
        out[e] = a * f[0] - b * f[1]; out[places + e] = a * f[1] + b * f[0];
    }
    WP_TILE_SYNC();
""")
def place_scaled(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    count: int,
    rows: int,
    cell_slot: wp.array3d(dtype=int),
    frame: wp.array(dtype=real),
    x: wp.array(dtype=real),
    at_x: int,
    stride: int,
    place: wp.array(dtype=real),
): ...


# y = S of what is at places, likewise.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const int line = (rows + 7) / 8 * 8, places = elements.patches.places;
    const int* slot = cell_slot.data + here * cap;
    const double* u = place.data + here * 2 * places;
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        const double* f = frame.data + (here * cap + i) * 8; double* v = y.data + at_y + (size_t)2 * i * stride;
        const int e = slot[i] / rows * line + slot[i] % rows;
        const double a = f[6] * (f[0] * u[e] + f[1] * u[places + e]), b = f[7] * (f[0] * u[places + e] - f[1] * u[e]);
        v[0] = a * f[0] - b * f[1]; v[stride] = a * f[1] + b * f[0];
    }
    WP_TILE_SYNC();
""")
def take_scaled(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    count: int,
    rows: int,
    cell_slot: wp.array3d(dtype=int),
    frame: wp.array(dtype=real),
    place: wp.array(dtype=real),
    y: wp.array(dtype=real),
    at_y: int,
    stride: int,
): ...


# v <- v + Lambda x in the free coordinates, zero in the others. Lanes over the slots.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        const double *f = frame.data + (here * cap + i) * 8, *q = x.data + (here * cap + i) * 2;
        double* y = v.data + (here * cap + i) * 2;
        double a = f[0] * y[0] + f[1] * y[1], b = f[0] * y[1] - f[1] * y[0];
        a = f[2] * (a + f[4] * (f[0] * q[0] + f[1] * q[1])); b = f[3] * (b + f[5] * (f[0] * q[1] - f[1] * q[0]));
        y[0] = a * f[0] - b * f[1]; y[1] = a * f[1] + b * f[0];
    }
    WP_TILE_SYNC();
""")
def restrict(
    model: Model,
    w: int,
    pair: int,
    count: int,
    frame: wp.array(dtype=real),
    x: wp.array(dtype=real),
    v: wp.array(dtype=real),
): ...


# Tractions x at places on A. Lanes over the places, then the slots.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const int line = (rows + 7) / 8 * 8, places = elements.patches.places;
    const int* slot = cell_slot.data + here * cap;
    double* out = place.data + here * 2 * places;
    WP_TILE_SYNC();
    for (int e = WP_TILE_THREAD_IDX; e < 2 * places; e += WP_TILE_BLOCK_DIM) out[e] = 0.0;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        const int e = slot[i] / rows * line + slot[i] % rows;
        out[e] = x.data[(here * cap + i) * 2]; out[places + e] = x.data[(here * cap + i) * 2 + 1];
    }
    WP_TILE_SYNC();
""")
def place_cells(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    count: int,
    rows: int,
    cell_slot: wp.array3d(dtype=int),
    x: wp.array(dtype=real),
    place: wp.array(dtype=real),
): ...


# y += part of the weak slips at places. Lanes over the slots.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const int line = (rows + 7) / 8 * 8, places = elements.patches.places;
    const int* slot = cell_slot.data + here * cap;
    const double* u = place.data + here * 2 * places;
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        const int e = slot[i] / rows * line + slot[i] % rows;
        y.data[(here * cap + i) * 2] += part * u[e]; y.data[(here * cap + i) * 2 + 1] += part * u[places + e];
    }
    WP_TILE_SYNC();
""")
def take_cells(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    count: int,
    rows: int,
    part: real,
    cell_slot: wp.array3d(dtype=int),
    place: wp.array(dtype=real),
    y: wp.array(dtype=real),
): ...


# load = forces on the splines of one side (direction, spline) due to tractions x of the slots: x on A, -Q^T x on B. One
# lane scatters the tractions of each cell; of many, each gathers those of its splines, in the same order.
@wp.func_native("""
    const int nodes = elements.patches.far_nodes, taps = rows < 3 ? rows : 3, cap = model.capacity.cells;
    const size_t here = (size_t)w * model.pairs.count + pair, grid_nodes = model.window.grid_nodes;
    const int* const slot = cell_slot.data + here * cap;
    const int first = far_window.data[2 * (here * 2 + side)];
    double* const out = load.data + at_load;
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    WP_TILE_SYNC();
    for (int n = lane; n < nodes; n += lanes) out[n] = out[nodes + n] = 0.0;
    WP_TILE_SYNC();
    for (int i = 0; i < cells; ++i) {
        const int m = slot[i];
        const size_t p = (here * 2 + side) * grid_nodes + m;
        const int at = (far_at.data[2 * p] - first) * rows + far_at.data[2 * p + 1];
        const double* const f = far_weight.data + 9 * p;
        double a = x.data[(here * cap + i) * 2], b = x.data[(here * cap + i) * 2 + 1];
        if (side != 0) {
            const double* q = cell_turn.data + (here * grid_nodes + m) * 4;
            const double g = -(q[0] * a + q[2] * b); b = -(q[1] * a + q[3] * b); a = g;
        }
        for (int c = 0; c < 3; ++c) for (int r = 0; r < taps; ++r) {
            const int n = at + c * rows + r;
            if (lanes > 1 && n % lanes != lane) continue;
            out[n] += f[3 * c + r] * a; out[nodes + n] += f[3 * c + r] * b;
        }
    }
    WP_TILE_SYNC();
""")
def load_splines_of(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    cells: int,
    rows: int,
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    cell_turn: wp.array4d(dtype=real),
    x: wp.array(dtype=real),
    load: wp.array(dtype=real),
    at_load: int,
): ...


# y += part of the weak slips due to displacements of the splines of one side: of A, less Q that of B. Lanes over the
# slots.
@wp.func_native("""
    const int nodes = elements.patches.far_nodes, taps = rows < 3 ? rows : 3, cap = model.capacity.cells;
    const size_t here = (size_t)w * model.pairs.count + pair, grid_nodes = model.window.grid_nodes;
    const int* const slot = cell_slot.data + here * cap;
    const int first = far_window.data[2 * (here * 2 + side)];
    const double* const u = field.data + at_field;
    for (int i = WP_TILE_THREAD_IDX; i < cells; i += WP_TILE_BLOCK_DIM) {
        const int m = slot[i];
        const size_t p = (here * 2 + side) * grid_nodes + m;
        const int at = (far_at.data[2 * p] - first) * rows + far_at.data[2 * p + 1];
        const double* const f = far_weight.data + 9 * p;
        double a = 0.0, b = 0.0;
        for (int c = 0; c < 3; ++c) for (int r = 0; r < taps; ++r) {
            const int n = at + c * rows + r;
            a += f[3 * c + r] * u[n]; b += f[3 * c + r] * u[nodes + n];
        }
        if (side != 0) {
            const double* q = cell_turn.data + (here * grid_nodes + m) * 4;
            const double g = -(q[0] * a + q[1] * b); b = -(q[2] * a + q[3] * b); a = g;
        }
        y.data[(here * cap + i) * 2] += part * a; y.data[(here * cap + i) * 2 + 1] += part * b;
    }
    WP_TILE_SYNC();
""")
def read_splines_of(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    cells: int,
    rows: int,
    part: real,
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    cell_turn: wp.array4d(dtype=real),
    field: wp.array(dtype=real),
    at_field: int,
    y: wp.array(dtype=real),
): ...


# out[direction, spline] = S_tt and modes times the forces of one side.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8, line = (count + 7) / 8 * 8 < nodes ? (count + 7) / 8 * 8 : nodes;
    const size_t stride = 2 * (size_t)nodes;
    WP_TILE_SYNC();
    for (int e = B * WP_TILE_THREAD_IDX; e < 2 * line; e += B * WP_TILE_BLOCK_DIM) {
        const int d = e / line, j = e % line;
        double sum[8] = {0.0};
        for (int k = 0; k < 2; ++k) {
            const double *from = soft.data + start + k * nodes * stride + d * nodes + j;
            const double* f = load.data + at_load + k * nodes;
            for (int n = 0; n < count; ++n)
                for (int i = 0; i < B; ++i) sum[i] += f[n] * from[n * stride + i];
        }
        for (int i = 0; i < B; ++i) out.data[at + d * nodes + j + i] = sum[i];
    }
    WP_TILE_SYNC();
""")
def soften_side(
    count: int,
    nodes: int,
    load: wp.array(dtype=real),
    at_load: int,
    soft: wp.array(dtype=real),
    start: int,
    out: wp.array(dtype=real),
    at: int,
): ...


# Tractions of a pair after a step of Newton's method: sticking ones changed by `step`, sliding ones on their circles by
# what `step` is across the direction of their frames.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    double* x = tau.data + here * 2 * cap;
    const double *y = step.data + here * 2 * cap, *dir = direction.data + here * 2 * cap, *b = radius.data + here * cap;
    const int* kind = sliding.data + here * 2 * cap;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        const int p = 2 * i;
        const double* f = frame.data + (here * cap + i) * 8;
        if (kind[i] == 0) x[p] = x[p + 1] = 0.0;
        else if (kind[i] == 1) { x[p] += y[p]; x[p + 1] += y[p + 1]; }
        else {
            const double a = f[0] * y[p + 1] - f[1] * y[p];
            const double t0 = b[i] * dir[p] - a * dir[p + 1], t1 = b[i] * dir[p + 1] + a * dir[p];
            const double scale = b[i] / ::sqrt(t0 * t0 + t1 * t1);
            x[p] = t0 * scale; x[p + 1] = t1 * scale;
        }
    }
    WP_TILE_SYNC();
""")
def move_framed(
    model: Model,
    w: int,
    pair: int,
    count: int,
    radius: wp.array(dtype=real),
    direction: wp.array(dtype=real),
    sliding: wp.array(dtype=int),
    frame: wp.array(dtype=real),
    step: wp.array(dtype=real),
    tau: wp.array(dtype=real),
): ...
