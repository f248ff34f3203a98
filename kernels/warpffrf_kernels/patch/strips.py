r"""Products of a compliance by half-spaces, and of its preconditioner, with what loads the cells of a patch.

K is block Toeplitz along the strips (`warpffrf.online.compile.strips`): with x_c the pressures or tractions of strip c,
sums e_c = x_c + x_c' and differences d_c = x_c' - x_c of opposite strips,

    C_k = sum_c cos(omega_k s_c) e_c,      S_k = sum_c sin(omega_k s_c) d_c,      s_c the distance from the middle,

are the transforms of x about the middle, real and imaginary (-S_k) part. Pressures displace evenly in both directions,
so both parts are multiplied by the same real blocks M_k. Tractions have two components, the first of which is divided
by i to the same end, and so is what they displace. The transforms are two small matrix products: one of 26 x 20 cells
takes 285 thousand operations with two components instead of two million.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.kinematics.closest_point import has_cells
from warpffrf_kernels.patch.near import end_constant, first_level, level_shares
from warpffrf_kernels.patch.spline_tables import line_of

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def waves_of(columns: int) -> int:
    """Frequencies of K: of a transform of length 2 columns."""
    return columns + 1


@wp.func
def inverse_waves_of(columns: int) -> int:
    """Frequencies of the preconditioner: of a transform of length 1.25 columns + 3."""
    return ((5 * columns) / 4 + 3) / 2 + 1


@wp.func
def wave_numbers(columns: int, waves: int) -> int:
    """Length of the wave tables of `waves` frequencies."""
    return 4 * waves * ((columns + 1) / 2)


# y = K x over the places (component, strip, row filled up) of a patch, with blocks M_k from `at_table` on, times
# `scale`; one component, or two. Native for contiguous inner loops; lanes over the numbers of each stage.
@wp.func_native("""
#ifdef __CUDACC__
    typedef double part; const int B = 1;
#else
    typedef double part __attribute__((vector_size(64), aligned(8))); const int B = 8;
#endif
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int half = (columns + 1) / 2, line = (rows + 7) / 8 * 8, W = components * line;
    const double *cosine = wave.data + at_wave, *sine = cosine + waves * half;
    const double *back_cosine = sine + waves * half, *back_sine = back_cosine + waves * half;
    const double *M = table.data + at_table, *X = x.data + at_x;
    double *even = work.data + at_work, *odd = even + half * W, *re = odd + half * W, *im = re + waves * W;
    double *to_re = im + waves * W, *to_im = to_re + waves * W, *Y = y.data + at_y;
    WP_TILE_SYNC();
    for (int e = B * lane; e < half * W; e += B * lanes) {
        const int c = e / W, j = e % W;
        const double *first = X + (size_t)(j / line) * places + j % line + c * line;
        const part *near = (const part*)first, *far = (const part*)(first + (columns - 1 - 2 * c) * line);
        part *sum = (part*)(even + e), *apart = (part*)(odd + e);
        sum[0] = 2 * c == columns - 1 ? near[0] : near[0] + far[0]; apart[0] = far[0] - near[0];
    }
    WP_TILE_SYNC();
    for (int e = B * lane; e < (waves + 1) / 2 * W; e += B * lanes) {  // two frequencies at once
        const int k = e / W * 2, j = e % W, l = k + 1 < waves ? k + 1 : k;
        part C = {0.0}, S = {0.0}, D = {0.0}, T = {0.0};
        for (int c = 0; c < half; ++c) {
            const part *a = (const part*)(even + c * W + j), *b = (const part*)(odd + c * W + j);
            C += cosine[k * half + c] * a[0]; S += sine[k * half + c] * b[0];
            D += cosine[l * half + c] * a[0]; T += sine[l * half + c] * b[0];
        }
        part *re_k = (part*)(re + k * W + j), *im_k = (part*)(im + k * W + j);
        part *re_l = (part*)(re + l * W + j), *im_l = (part*)(im + l * W + j);
        const bool over = components == 2 && j < line;  // the first of two components is divided by i
        re_k[0] = over ? -S : C; im_k[0] = over ? -C : -S; re_l[0] = over ? -T : D; im_l[0] = over ? -D : -T;
    }
    WP_TILE_SYNC();
    for (int e = B * lane; e < waves * W; e += B * lanes) {
        const int k = e / W, j = e % W;
        part C = {0.0}, S = {0.0}, D = {0.0}, T = {0.0};
        const double *p = re + k * W, *q = im + k * W, *m = M + (size_t)k * W * W + j;
        for (int d = 0; d < components * line; d += line) {
            for (int r = d; r < d + rows; r += 2) {  // chains of sums wait for each other
                const part *one = (const part*)(m + (size_t)r * W), *two = (const part*)(m + (size_t)(r + 1) * W);
                C += p[r] * one[0]; S += q[r] * one[0];
                if (r + 1 < d + rows) { D += p[r + 1] * two[0]; T += q[r + 1] * two[0]; }
            }
        }
        C += D; S += T;
        const bool over = components == 2 && j < line;
        part *to_re_k = (part*)(to_re + e), *to_im_k = (part*)(to_im + e);
        to_re_k[0] = over ? -S : C; to_im_k[0] = over ? C : S;
    }
    WP_TILE_SYNC();
    for (int e = B * lane; e < (half + 1) / 2 * W; e += B * lanes) {  // two pairs of strips at once
        const int c = e / W * 2, j = e % W, d = c + 1 < half ? c + 1 : c;
        part C = {0.0}, S = {0.0}, D = {0.0}, T = {0.0};
        for (int k = 0; k < waves; ++k) {
            const part *real_k = (const part*)(to_re + k * W + j), *imag_k = (const part*)(to_im + k * W + j);
            C += back_cosine[k * half + c] * real_k[0]; S += back_sine[k * half + c] * imag_k[0];
            D += back_cosine[k * half + d] * real_k[0]; T += back_sine[k * half + d] * imag_k[0];
        }
        double *low = Y + (size_t)(j / line) * places + j % line + c * line, *next = low + (d - c) * line;
        part *y_c = (part*)low, *across_c = (part*)(low + (columns - 1 - 2 * c) * line);
        part *y_d = (part*)next, *across_d = (part*)(next + (columns - 1 - 2 * d) * line);
        across_c[0] = scale * (C - S); y_c[0] = scale * (C + S);
        across_d[0] = scale * (D - T); y_d[0] = scale * (D + T);
    }
    WP_TILE_SYNC();
""")
def multiply_strips(
    components: int,
    columns: int,
    rows: int,
    places: int,
    waves: int,
    scale: real,
    wave: wp.array(dtype=real),
    at_wave: int,
    table: wp.array(dtype=real),
    at_table: int,
    x: wp.array(dtype=real),
    at_x: int,
    work: wp.array(dtype=real),
    at_work: int,
    y: wp.array(dtype=real),
    at_y: int,
): ...


# Sum of the levels of the blocks, `size` numbers of `table` from `start` on.
@wp.func_native("""
    const double* const t = table.data + start;
    double* const out = out_table.data + at;
    const double c0 = c[0], c1 = c[1], c2 = c[2], c3 = c[3];
    const size_t n = size;
    if (levels == 1) for (int e = WP_TILE_THREAD_IDX; e < size; e += WP_TILE_BLOCK_DIM) out[e] = c0 * t[e];
    else for (int e = WP_TILE_THREAD_IDX; e < size; e += WP_TILE_BLOCK_DIM)
        out[e] = c0 * t[e] + c1 * t[n + e] + c2 * t[2 * n + e] + c3 * t[3 * n + e];
""")
def sum_levels(
    table: wp.array(dtype=real),
    start: int,
    size: int,
    levels: int,
    c: wp.vec4d,
    out_table: wp.array(dtype=real),
    at: int,
): ...


@wp.func
def nearest_level(elements: Elements, pair: int, width: real) -> int:
    """The level of the near field nearest to W."""
    levels = elements.patches.near_levels[pair]
    if levels == 1:
        return 0
    x = (wp.log(width) - elements.patches.near_first[pair]) / elements.patches.near_step[pair]
    return wp.clamp(int(wp.floor(x + real(0.5))), 0, levels - 1)


@wp.func
def spectrum_at(model: Model, elements: Elements, w: int, pair: int) -> int:
    """Start of the blocks of a pair at the W of the attempt."""
    return (w * model.pairs.count + pair) * elements.patches.spectrum_numbers


@kernel
def lay_spectrum(run: Run, geometry: ContactGeometry, patch: PatchScratch):
    """Per (world, pair of family 2), lanes over entries: the blocks of the pressures' K at the W of the attempt, unless
    they are those of `patch_laid`, and the contribution of distant ends, for all cells the same."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    width = patch.patch_place[w, pair, 2]
    if lane == 0:
        patch.patch_ends[w, pair] = real(0.0)
        if elements.patches.follows[pair] != 0:
            strip = real(2.0) * width / real(elements.patches.columns[pair])
            z = patch.patch_place[w, pair, 1]
            ends = end_constant(model, elements, pair, z, width * elements.patches.aspect[pair])
            patch.patch_ends[w, pair] = ends * strip * width * strip * width
    if patch.patch_laid[w, pair] == width:
        return
    line = line_of(model.surfaces.rows[model.pairs.first[pair]])
    size = waves_of(elements.patches.columns[pair]) * line * line
    sum_levels(
        elements.patches.spectrum, elements.patches.spectrum_start[pair] + first_level(elements, pair, width) * size,
        size, wp.min(elements.patches.near_levels[pair], 4),
        wp.pow(width, elements.patches.near_power[pair]) * level_shares(elements, pair, width), patch.patch_spectrum,
        spectrum_at(model, elements, w, pair),
    )  # fmt: skip
    sync()
    if lane == 0:
        patch.patch_laid[w, pair] = width


@wp.func
def multiply_pressures(
    model: Model, elements: Elements, w: int, pair: int, patch: PatchScratch, x: wp.array(dtype=real),
    y: wp.array(dtype=real),
):  # fmt: skip
    """y = K of the half-spaces times x, both at the places of all pairs."""
    columns = elements.patches.columns[pair]
    here = w * model.pairs.count + pair
    places = elements.patches.places
    multiply_strips(
        1, columns, model.surfaces.rows[model.pairs.first[pair]], places, waves_of(columns), real(1.0),
        elements.patches.wave, elements.patches.wave_start[pair], patch.patch_spectrum,
        spectrum_at(model, elements, w, pair), x, here * places, patch.patch_work,
        here * elements.patches.strip_numbers, y, here * places,
    )  # fmt: skip


@wp.func
def inverse_at(model: Model, elements: Elements, pair: int, width: real) -> int:
    """Start of the pressures' preconditioner of a pair at W: its diagonal, then its blocks."""
    line = line_of(model.surfaces.rows[model.pairs.first[pair]])
    size = line + inverse_waves_of(elements.patches.columns[pair]) * line * line
    return elements.patches.inverse_start[pair] + nearest_level(elements, pair, width) * size


@wp.func
def multiply_inverse(
    model: Model, elements: Elements, w: int, pair: int, patch: PatchScratch, x: wp.array(dtype=real),
    y: wp.array(dtype=real),
):  # fmt: skip
    """y = the preconditioner times x, both at the places of all pairs."""
    columns = elements.patches.columns[pair]
    here = w * model.pairs.count + pair
    places = elements.patches.places
    rows = model.surfaces.rows[model.pairs.first[pair]]
    width = patch.patch_place[w, pair, 2]
    multiply_strips(
        1, columns, rows, places, inverse_waves_of(columns), wp.pow(width, -elements.patches.near_power[pair]),
        elements.patches.wave, elements.patches.wave_start[pair] + wave_numbers(columns, waves_of(columns)),
        elements.patches.inverse, inverse_at(model, elements, pair, width) + line_of(rows), x, here * places,
        patch.patch_work, here * elements.patches.strip_numbers, y, here * places,
    )  # fmt: skip
