r"""The half-space of both bodies under a patch: weak displacement of a cell under a unit pressure on another one.

Cells are equal across, so that it depends on the distance in strips, and on both rows: a table of every pair for the
half-widths W of its levels, in powers of which it varies slowly,

    near[d, r, r'](W) = W^p sum_l c_l(ln W) table[l, d, r, r'],        c cubic, through the four levels around,

with p = 2 along a line and 3, exactly, where rows grow with W: there one level is all. What ends add far from the cells
is then a constant, the sum over the ends of strength over distance.
"""

import warp as wp

from warpffrf_kernels.core.access import out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def level_shares(elements: Elements, pair: int, width: real) -> wp.vec4d:
    """c of the four levels from `first_level` on."""
    if elements.patches.near_levels[pair] < 4:
        return wp.vec4d(real(1.0), real(0.0), real(0.0), real(0.0))
    x = (wp.log(width) - elements.patches.near_first[pair]) / elements.patches.near_step[pair]
    u = x - real(first_level(elements, pair, width))
    a = u
    b = u - real(1.0)
    c = u - real(2.0)
    d = u - real(3.0)
    return wp.vec4d(-b * c * d / real(6.0), a * c * d / real(2.0), -a * b * d / real(2.0), a * b * c / real(6.0))


@wp.func
def first_level(elements: Elements, pair: int, width: real) -> int:
    """The first of the four levels around W."""
    levels = elements.patches.near_levels[pair]
    if levels < 4:
        return 0
    x = (wp.log(width) - elements.patches.near_first[pair]) / elements.patches.near_step[pair]
    return wp.clamp(int(wp.floor(x)) - 1, 0, levels - 4)


@wp.func
def end_constant(model: Model, elements: Elements, pair: int, z: real) -> real:
    """What the ends add [1/(Pa m) per unit force] to the patch around z of A, of both bodies."""
    total = real(0.0)
    i = elements.patches.end_start[pair]
    while i < elements.patches.end_start[pair + 1]:
        total += elements.patches.end_strength[i] / wp.abs(z - elements.patches.end_z[i])
        i += 1
    return total


@wp.kernel
def lay_near(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    patch_place: wp.array3d(dtype=real),
    patch_near: out(wp.array3d(dtype=real)),
):
    """Per (world, pair of family 2), lanes over entries: the table at the W of the attempt."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].moved == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    width = patch_place[w, pair, 2]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    columns = elements.patches.columns[pair]
    size = columns * rows * rows
    c = level_shares(elements, pair, width)
    start = elements.patches.near_start[pair] + first_level(elements, pair, width) * size
    levels = wp.min(elements.patches.near_levels[pair], 4)
    power = elements.patches.near_power[pair]
    scale = wp.pow(width, power)
    strip = real(2.0) * width / real(columns)
    ends = real(0.0)
    if elements.patches.follows[pair] != 0:
        ends = end_constant(model, elements, pair, patch_place[w, pair, 1])
    first_row = elements.patches.row_start[pair]
    e = lane
    while e < size:
        total = real(0.0)
        level = int(0)
        while level < levels:
            total += c[level] * elements.patches.near[start + level * size + e]
            level += 1
        total *= scale
        if ends != real(0.0):
            seen = strip * width * elements.patches.row_length[first_row + (e / rows) % rows]
            loaded = strip * width * elements.patches.row_length[first_row + e % rows]
            total += ends * seen * loaded
        patch_near[w, pair, e] = total
        e += wp.block_dim()


# near[|c - c'|, r, r'] summed with pressures: weak displacement of cell m by the pressures of the active cells. Native
# for contiguous inner loops over rows.
@wp.func_native("""
    const size_t p0 = (size_t)w * model.pairs.count + pair;
    const double* table = patch_near.data + p0 * numbers;
    const double* p = pressure.data + p0 * hats;
    const int column = m / rows, row = m % rows;
    double total = 0.0;
    for (int c = 0; c < columns; ++c) {
        const double* line = table + ((size_t)(c < column ? column - c : c - column) * rows + row) * rows;
        const double* q = p + (size_t)c * rows;
        double sum = 0.0;
        for (int r = 0; r < rows; ++r) sum += line[r] * q[r];
        total += sum;
    }
    return total;
""")
def near_sum(
    model: Model,
    w: int,
    pair: int,
    m: int,
    rows: int,
    columns: int,
    hats: int,
    numbers: int,
    patch_near: wp.array3d(dtype=real),
    pressure: wp.array3d(dtype=real),
) -> real: ...
