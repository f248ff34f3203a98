r"""The half-space of both bodies under a patch: weak displacement of a cell due to a unit pressure on another one.

Cells have equal widths, so it depends on the distance in strips and on both rows: a table for every pair at the
half-widths W of its levels; apart from a power of W it varies slowly,

    near[d, r, r'](W) = W^p sum_l c_l(ln W) table[l, d, r, r'],        c cubic, through the four adjacent levels,

with p = 2 along a line and 3, exactly, if rows grow with W: then a single level suffices. The contribution of ends far
from the cells is then a constant, the sum over the ends of strength over distance.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def cubic_shares(u: real) -> wp.vec4d:
    """Weights of values at 0, 1, 2 and 3 in the cubic through them at u."""
    a = u
    b = u - real(1.0)
    c = u - real(2.0)
    d = u - real(3.0)
    return wp.vec4d(-b * c * d / real(6.0), a * c * d / real(2.0), -a * b * d / real(2.0), a * b * c / real(6.0))


@wp.func
def level_shares(elements: Elements, pair: int, width: real) -> wp.vec4d:
    """c of the four levels from `first_level` on."""
    if elements.patches.near_levels[pair] < 4:
        return wp.vec4d(real(1.0), real(0.0), real(0.0), real(0.0))
    x = (wp.log(width) - elements.patches.near_first[pair]) / elements.patches.near_step[pair]
    return cubic_shares(x - real(first_level(elements, pair, width)))


@wp.func
def first_level(elements: Elements, pair: int, width: real) -> int:
    """The first of the four levels adjacent to W."""
    levels = elements.patches.near_levels[pair]
    if levels < 4:
        return 0
    x = (wp.log(width) - elements.patches.near_first[pair]) / elements.patches.near_step[pair]
    return wp.clamp(int(wp.floor(x)) - 1, 0, levels - 4)


@wp.func
def end_constant(model: Model, elements: Elements, pair: int, z: real, least: real) -> real:
    """Contribution of the ends of both bodies [1/(Pa m) per unit force] to the patch around z of A; nearer than `least`
    [m] to an end, its contribution at that distance."""
    total = real(0.0)
    i = elements.patches.end_start[pair]
    while i < elements.patches.end_start[pair + 1]:
        total += elements.patches.end_strength[i] / wp.max(wp.abs(z - elements.patches.end_z[i]), least)
        i += 1
    return total


# Sum of the levels of the table, LINE numbers of a line at a time; target rows are padded with zeros. Native for
# contiguous inner loops.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8, line = (rows + 7) / 8 * 8, size = columns * rows * rows;
    const double c0 = c[0], c1 = c[1], c2 = c[2], c3 = c[3];
    const double* const length = elements.patches.row_length.data + elements.patches.row_start.data[pair];
    double* const out = patch_near.data + ((size_t)w * model.pairs.count + pair) * patch_near.shape[2];
    for (int e = B * WP_TILE_THREAD_IDX; e < columns * rows * line; e += B * WP_TILE_BLOCK_DIM) {
        const int r = e % line, count = r + B < rows ? B : rows - r;
        const double* const t = elements.patches.near.data + start + (size_t)(e / line) * rows + r;
        double sum[8] = {0.0};
        if (levels == 1) for (int i = 0; i < count; ++i) sum[i] = c0 * t[i];
        else if (count == 8) {
            for (int i = 0; i < 8; ++i)
                sum[i] = c0 * t[i] + c1 * t[size + i] + c2 * t[2 * size + i] + c3 * t[3 * size + i];
        } else for (int i = 0; i < count; ++i)
            sum[i] = c0 * t[i] + c1 * t[size + i] + c2 * t[2 * size + i] + c3 * t[3 * size + i];
        if (ends != 0.0) {
            const double loaded = ends * length[e / line % rows];
            for (int i = 0; i < count; ++i) sum[i] += loaded * length[r + i];
        }
        for (int i = 0; i < B; ++i) out[e + i] = sum[i];
    }
""")
def sum_levels(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    rows: int,
    columns: int,
    start: int,
    levels: int,
    c: wp.vec4d,
    ends: real,
    patch_near: wp.array3d(dtype=real),
): ...


@kernel
def lay_near(run: Run, patch: PatchScratch):
    """Per (world, pair of family 2), lanes over entries: the table at the W of the attempt, unless it is that of
    `patch_laid`."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    width = patch.patch_place[w, pair, 2]
    ends = real(0.0)
    if elements.patches.follows[pair] != 0:
        ends = end_constant(model, elements, pair, patch.patch_place[w, pair, 1], width * elements.patches.aspect[pair])
    if patch.patch_laid[w, pair, 0] == width and patch.patch_laid[w, pair, 1] == ends:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    columns = elements.patches.columns[pair]
    scale = wp.pow(width, elements.patches.near_power[pair])
    start = elements.patches.near_start[pair] + first_level(elements, pair, width) * columns * rows * rows
    strip = real(2.0) * width / real(columns)
    sum_levels(
        model, elements, w, pair, rows, columns, start, wp.min(elements.patches.near_levels[pair], 4),
        scale * level_shares(elements, pair, width), ends * strip * width * strip * width, patch.patch_near,
    )  # fmt: skip
    sync()
    if lane == 0:
        patch.patch_laid[w, pair, 0] = width
        patch.patch_laid[w, pair, 1] = ends
