r"""The half-spaces of both bodies along the surface: weak displacements of a cell due to unit tractions, and due to a
unit pressure if the bodies are unlike.

A table like that of `patch.near`, for the half-width W of the attempt, by kind, distance in strips, source row, target
row; target rows extend `ring_rows` beyond the cells on either side, and strips RINGS. Kinds, of
e = u_A - u_B with x the distance along e_theta, z that along t_z from the load:

    0  e_1 by tau_1      1  e_2 by tau_2      2  e_1 by tau_2, e_2 by tau_1 (odd in x and in z)
    3  e_1 by p (odd in x)                    4  e_2 by p (odd in z)

Tractions open the gap by the transpose of the last two.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import PatchScratch, RollingScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.friction.cells import rubs_on_patch
from warpffrf_kernels.patch.near import first_level, level_shares
from warpffrf_kernels.patch.spline_tables import line_of

wp.set_module_options(MODULE_OPTIONS)

RINGS = 3  # strips around a patch with stored displacements: a cubic reaches two beyond the cells at a strip per step
KINDS, COUPLED_KINDS = 3, 5
STRIPS_AROUND = wp.constant(RINGS)


@wp.func
def shear_line(rows: int, rings: int) -> int:
    """Length of a line of the table: all target rows, padded to whole registers from the first cell on."""
    return line_of(wp.max(rows + 2 * rings, rings + line_of(rows)))


@wp.func
def shear_kinds(elements: Elements, pair: int) -> int:
    """Number of kinds of displacements in the table of a pair."""
    return KINDS + elements.rolling.coupled[pair] * (COUPLED_KINDS - KINDS)


# Sum of the levels of the table, `size` numbers.
@wp.func_native("""
    const double* const t = elements.rolling.shear.data + start;
    double* const out = shear_near.data + ((size_t)w * model.pairs.count + pair) * elements.rolling.shear_numbers;
    const double c0 = c[0], c1 = c[1], c2 = c[2], c3 = c[3];
    if (levels == 1) for (int e = WP_TILE_THREAD_IDX; e < size; e += WP_TILE_BLOCK_DIM) out[e] = c0 * t[e];
    else for (int e = WP_TILE_THREAD_IDX; e < size; e += WP_TILE_BLOCK_DIM)
        out[e] = c0 * t[e] + c1 * t[(size_t)size + e] + c2 * t[2 * (size_t)size + e] + c3 * t[3 * (size_t)size + e];
""")
def sum_shear_levels(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    start: int,
    size: int,
    levels: int,
    c: wp.vec4d,
    shear_near: wp.array(dtype=real),
): ...


@kernel
def lay_shear(run: Run, patch: PatchScratch, rolling: RollingScratch):
    """Per (world, pair), lanes over entries: the table at the W of the attempt, unless it is that of
    `shear_laid`."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    width = patch.patch_place[w, pair, 2]
    if rolling.shear_laid[w, pair, 0] == width:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    size = shear_kinds(elements, pair) * (elements.patches.columns[pair] + STRIPS_AROUND) * rows
    size *= shear_line(rows, elements.rolling.ring_rows[pair])
    start = elements.rolling.shear_start[pair] + first_level(elements, pair, width) * size
    scale = wp.pow(width, elements.patches.near_power[pair])
    sum_shear_levels(
        model, elements, w, pair, start, size, wp.min(elements.patches.near_levels[pair], 4),
        scale * level_shares(elements, pair, width), rolling.shear_near,
    )  # fmt: skip
    sync()
    if lane == 0:
        rolling.shear_laid[w, pair, 0] = width


# Weak displacements along the surface by tractions q[at], q[at + places] on A, and by pressures p, of `c_count` strips
# from `c_first` on, `r_count` of the target rows from `r_first` on: out[at_out + d apart + strip r_count + row].
# Native for contiguous inner loops.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8, columns = elements.patches.columns.data[pair];
    const int places = elements.patches.places, filled = (rows + 7) / 8 * 8, wide = (r_count + B - 1) / B * B;
    const size_t here = (size_t)w * model.pairs.count + pair, K = (size_t)(columns + reach) * rows * line;
    const double* const T = shear_near.data + here * elements.rolling.shear_numbers;
    const double* const q1 = q.data + here * 4 * places;
    const double* const q2 = q1 + places;
    const double* const load = p.data + here * places;
    const int coupled = elements.rolling.coupled.data[pair];
    double* const x = out.data + at_out;
    for (int e = B * WP_TILE_THREAD_IDX; e < c_count * wide; e += B * WP_TILE_BLOCK_DIM) {
        const int c = e / wide, r = e % wide;
        double s1[8] = {0.0}, s2[8] = {0.0};
        for (int d = 0; d < columns; ++d) {
            const int way = c + c_first - d, a = way < 0 ? -way : way;
            const double sign = way < 0 ? -1.0 : 1.0;
            const double* const row = T + (size_t)a * rows * line + r_first + r;
            for (int k = 0; k < rows; ++k) {
                const double t1 = q1[d * filled + k], t2 = q2[d * filled + k];
                const double* const h = row + (size_t)k * line;
                if (t1 != 0.0 || t2 != 0.0) {
                    const double o1 = sign * t1, o2 = sign * t2;
                    for (int i = 0; i < B; ++i) {
                        s1[i] += t1 * h[i] + o2 * h[2 * K + i];
                        s2[i] += t2 * h[K + i] + o1 * h[2 * K + i];
                    }
                }
                if (coupled != 0) {
                    const double f = load[d * filled + k], o = sign * f;
                    if (f != 0.0) for (int i = 0; i < B; ++i) {
                        s1[i] += o * h[3 * K + i]; s2[i] += f * h[4 * K + i];
                    }
                }
            }
        }
        for (int i = 0; i < B && r + i < r_count; ++i) {
            x[c * r_count + r + i] = s1[i]; x[apart + c * r_count + r + i] = s2[i];
        }
    }
    WP_TILE_SYNC();
""")
def near_along(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    rows: int,
    line: int,
    reach: int,
    c_first: int,
    c_count: int,
    r_first: int,
    r_count: int,
    shear_near: wp.array(dtype=real),
    q: wp.array(dtype=real),
    p: wp.array(dtype=real),
    out: wp.array(dtype=real),
    at_out: int,
    apart: int,
): ...


# Opening of the weak gaps by the half-spaces of unlike bodies due to tractions on A, added to value[at].
@wp.func_native("""
    const int columns = elements.patches.columns.data[pair], places = elements.patches.places;
    const int filled = (rows + 7) / 8 * 8;
    const size_t here = (size_t)w * model.pairs.count + pair, K = (size_t)(columns + reach) * rows * line;
    const double* const T = shear_near.data + here * elements.rolling.shear_numbers + 3 * K + rings;
    const double* const q1 = q.data + here * 4 * places;
    const double* const q2 = q1 + places;
    for (int m = WP_TILE_THREAD_IDX; m < columns * rows; m += WP_TILE_BLOCK_DIM) {
        const int c = m / rows, k = m % rows;
        double total = 0.0;
        for (int d = 0; d < columns; ++d) {
            const int way = d - c, a = way < 0 ? -way : way;
            const double* const h = T + ((size_t)a * rows + k) * line;
            const double *t1 = q1 + d * filled, *t2 = q2 + d * filled;
            double s1[8] = {0.0}, s2[8] = {0.0};
            for (int r = 0; r < filled; r += 8)
                for (int i = 0; i < 8; ++i) { s1[i] += t1[r + i] * h[r + i]; s2[i] += t2[r + i] * h[K + r + i]; }
            double odd = 0.0;
            for (int i = 0; i < 8; ++i) { odd += s1[i]; total += s2[i]; }
            total += way < 0 ? -odd : odd;
        }
        value.data[at + m] += total;
    }
    WP_TILE_SYNC();
""")
def open_near(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    rows: int,
    rings: int,
    line: int,
    reach: int,
    shear_near: wp.array(dtype=real),
    q: wp.array(dtype=real),
    value: wp.array(dtype=real),
    at: int,
): ...
