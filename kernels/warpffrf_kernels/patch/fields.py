"""What opens the gaps of cells: global modes and local displacement of both bodies, and what the cells load.

Spline numbers of a pair stand in two halves, one a side, (columns of the far window, rows): loads P^T A p [N], their
displacement S times the loads, and that of the modes. A cell reads what it loads, with the same weights.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, mat33, real, sync, vec3
from warpffrf_kernels.kinematics.closest_point import least_place, view_of
from warpffrf_kernels.normal.pair_forces import modal_line
from warpffrf_kernels.patch.far_splines import beside_block, far_block, turned_column
from warpffrf_kernels.patch.near import near_sum
from warpffrf_kernels.patch.place import extent_of

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def real_side(elements: Elements, pair: int, side: int) -> int:
    """The surface with a mesh that a side of a pair loads; -1 where it is rigid."""
    s = elements.patches.first[pair]
    if side == 1:
        s = elements.patches.second[pair]
    if elements.patches.far_of[s] < 0:
        return -1
    return s


@wp.func
def half_of(model: Model, elements: Elements, w: int, pair: int, side: int) -> int:
    """Where the spline numbers of a side begin."""
    return ((w * model.pairs.count + pair) * 2 + side) * elements.patches.far_nodes


@wp.func
def read_splines(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    m: int,
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    field: wp.array(dtype=real),
) -> real:
    """A_i P u of a cell, both sides."""
    total = real(0.0)
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            rows = model.surfaces.rows[s]
            at = side * model.window.hats + m
            start = half_of(model, elements, w, pair, side)
            start += (far_at[w, pair, at, 0] - far_window[w, pair, side, 0]) * rows + far_at[w, pair, at, 1]
            taps = wp.min(rows, 3)
            for i in range(3):
                j = int(0)
                while j < taps:
                    total += far_weight[w, pair, at, 3 * i + j] * field[start + i * rows + j]
                    j += 1
    return total


@wp.kernel
def modal_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    amplitude: wp.array(dtype=real),
    of_state: int,
    far_modes: inout(wp.array(dtype=real)),
    first_field: out(wp.array3d(dtype=real)),
):
    """Per (world, pair of family 2), lanes over splines, then cells: weak displacement by the global modes of both
    bodies."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or (of_state != 0 and ctl[w].moved == 0) or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            rows = model.surfaces.rows[s]
            modes = model.surfaces.modal_count[s]
            first = w * model.modes.count + model.surfaces.modal_start[s]
            start = half_of(model, elements, w, pair, side)
            n = lane
            while n < far_window[w, pair, side, 1] * rows:
                column = turned_column(model, s, far_window[w, pair, side, 0] + n / rows)
                value = real(0.0)
                if column >= 0:
                    at = elements.patches.mode_start[elements.patches.far_of[s]] + (column * rows + n % rows) * modes
                    value = dot(modes, elements.patches.mode, at, amplitude, first)
                far_modes[start + n] = value
                n += wp.block_dim()
    sync()
    cells = elements.patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
    m = lane
    while m < cells:
        first_field[w, pair, m] = read_splines(model, elements, w, pair, m, far_at, far_weight, far_window, far_modes)
        m += wp.block_dim()


@wp.kernel
def load_splines(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    far_load: inout(wp.array(dtype=real)),
):
    """Per (world, pair of family 2): loads of the splines of both sides under the present pressures [N]."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    for side in range(2):
        start = half_of(model, elements, w, pair, side)
        n = lane
        while n < elements.patches.far_nodes:
            far_load[start + n] = real(0.0)
            n += wp.block_dim()
    sync()
    if lane != 0:
        return
    cells = elements.patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            rows = model.surfaces.rows[s]
            start = half_of(model, elements, w, pair, side)
            m = int(0)
            while m < cells:
                if active[w, pair, m] != 0:
                    p = pressure[w, pair, m]
                    at = side * model.window.hats + m
                    place = start + (far_at[w, pair, at, 0] - far_window[w, pair, side, 0]) * rows
                    place += far_at[w, pair, at, 1]
                    for i in range(3):
                        j = int(0)
                        while j < wp.min(rows, 3):
                            q = place + i * rows + j
                            far_load[q] = far_load[q] + p * far_weight[w, pair, at, 3 * i + j]
                            j += 1
                m += 1


@wp.kernel
def local_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    pressure: wp.array3d(dtype=real),
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    far_load: wp.array(dtype=real),
    patch_near: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
    far_field: inout(wp.array(dtype=real)),
    first_local: out(wp.array(dtype=real)),
):
    """Per (world, pair of family 2), lanes over splines, then cells: weak displacement of both bodies, near field and
    far field, under the present pressures. pressure: 0 where inactive."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            rows = model.surfaces.rows[s]
            width = elements.patches.far_columns[elements.patches.far_of[s]] * rows
            start = half_of(model, elements, w, pair, side)
            n = lane
            while n < far_window[w, pair, side, 1] * rows:
                target = turned_column(model, s, far_window[w, pair, side, 0] + n / rows)
                value = real(0.0)
                c = int(0)
                while target >= 0 and c < far_window[w, pair, side, 1]:
                    source = turned_column(model, s, far_window[w, pair, side, 0] + c)
                    if source >= 0:
                        at = far_block(model, elements, s, target, source) + (n % rows) * width
                        value += dot(rows, elements.patches.far, at, far_load, start + c * rows)
                    c += 1
                e = elements.patches.beside_start[2 * pair + side]
                while target >= 0 and e < elements.patches.beside_start[2 * pair + side + 1]:
                    other = elements.patches.beside_side[e] / 2
                    there = elements.patches.beside_side[e] % 2
                    lines = model.surfaces.rows[real_side(elements, other, there)]
                    table = elements.patches.beside_table[e]
                    stride = elements.patches.table_source[table] * lines
                    loads = half_of(model, elements, w, other, there)
                    c = int(0)
                    while c < far_window[w, other, there, 1]:
                        column = far_window[w, other, there, 0] + c
                        source = turned_column(model, real_side(elements, other, there), column)
                        if source >= 0:
                            at = beside_block(model, elements, table, rows, lines, target, source)
                            value += dot(
                                lines, elements.patches.beside, at + (n % rows) * stride, far_load, loads + c * lines
                            )
                        c += 1
                    e += 1
                far_field[start + n] = value
                n += wp.block_dim()
    sync()
    rows = model.surfaces.rows[model.pairs.first[pair]]
    columns = elements.patches.columns[pair]
    m = lane
    while m < columns * rows:
        value = near_sum(model, w, pair, m, rows, columns, model.window.hats, patch_near.shape[2], patch_near, pressure)
        value += elements.patches.layer[pair] * area[w, pair, m] * pressure[w, pair, m]
        value += read_splines(model, elements, w, pair, m, far_at, far_weight, far_window, far_field)
        first_local[(w * model.pairs.count + pair) * model.window.hats + m] = value
        m += wp.block_dim()


@wp.kernel
def load_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    far_window: wp.array4d(dtype=int),
    far_load: wp.array(dtype=real),
    pair_modal: inout(wp.array(dtype=real)),
):
    """Per (world, pair of family 2): load of the contact pressures on the modes of A, then of B."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].moved == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    trial = modal_line(model, w, pair)
    i = lane
    while i < model.pairs.most_modes:
        pair_modal[trial + i] = real(0.0)
        i += wp.block_dim()
    sync()
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            rows = model.surfaces.rows[s]
            modes = model.surfaces.modal_count[s]
            start = half_of(model, elements, w, pair, side)
            n = int(0)
            while n < far_window[w, pair, side, 1] * rows:
                f = far_load[start + n]
                column = turned_column(model, s, far_window[w, pair, side, 0] + n / rows)
                if f != real(0.0) and column >= 0:
                    at = elements.patches.mode_start[elements.patches.far_of[s]] + (column * rows + n % rows) * modes
                    axpy(modes, -f, elements.patches.mode, at, pair_modal, trial)
                n += 1
        trial += model.surfaces.modal_count[model.pairs.first[pair]]


@wp.kernel
def guard_patches(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    patch_place: wp.array3d(dtype=real),
    gap_defect: changed(wp.array2d(dtype=real)),
):
    """Per world: a patch that has reached the outermost strips is not balanced, as W has to grow."""
    w = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    elements = model.elements[0]
    pair = int(0)
    while pair < model.pairs.count:
        if model.pairs.family[pair] == PATCH:
            width = patch_place[w, pair, 2]
            rows = model.surfaces.rows[model.pairs.first[pair]]
            found = extent_of(elements, w, pair, rows, width, active, pressure)
            if found.reaches != 0 and width < elements.patches.most_width[pair]:
                gap_defect[w, 0] = wp.max(gap_defect[w, 0], real(1.0))
        pair += 1


@wp.kernel
def measure_patches(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    nearest: wp.array3d(dtype=real),
    station: out(wp.array4d(dtype=real)),
):
    """Per (world, pair of family 2), where a state is recorded: smallest undeformed gap and nearest column, where
    `record` looks for them."""
    w, pair = wp.tid()
    model = models[0]
    if ctl[w].record == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    A = elements.patches.first[pair]
    B = elements.patches.second[pair]
    view = view_of(model, w, pair, r1, axes)
    place = least_place(model, A, B, view, nearest[w, pair, 0], nearest[w, pair, 1])
    rows = model.surfaces.rows[model.pairs.first[pair]]
    for end in range(2):
        s = end * ((rows - 1) * model.quadrature.z_points - 1)
        station[w, pair, s, 0] = place[0]
        station[w, pair, s, 1] = nearest[w, pair, 0]


@wp.kernel
def record_patches(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    patch_place: wp.array3d(dtype=real),
    saved_patch: out(wp.array4d(dtype=real)),
):
    """Per (world, pair): where the patch of family 2 lies, and its half-width."""
    w, pair = wp.tid()
    model = models[0]
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % saved_patch.shape[1]
    for i in range(4):
        value = real(0.0)
        if model.pairs.family[pair] == PATCH:
            value = patch_place[w, pair, i]
        saved_patch[w, at, pair, i] = value


@wp.kernel
def sum_patches_second(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
    more_wrench: wp.array4d(dtype=real),
    second_wrench: out(wp.array3d(dtype=real)),
):
    """Per (world, pair of family 2): force on B and its moment about A's centre of mass."""
    w, pair = wp.tid()
    model = models[0]
    if ctl[w].record == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    cells = elements.patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
    for i in range(6):
        total = real(0.0)
        m = int(0)
        while m < cells:
            if active[w, pair, m] != 0:
                total -= pressure[w, pair, m] * (wrench[w, pair, m, i] + more_wrench[w, pair, m, i])
            m += 1
        second_wrench[w, pair, i] = total
