r"""Slips of the cells of a patch in a step: the previous displacement of the material that is now in a cell.

The elastic displacement e at the end of a step is stored on the cells and RINGS strips (and rows, if these move) around
them, with the position of the patch on the first body. In the next step the material at the centre x of a cell is
located there, and e interpolated by cubics in both directions,

    slip = rigid slip + e(x, now) - e_before(x) + growth,

positions of material counted on the first body. Rows that are fixed to the material need no interpolation. Around the
cells, e is that of the half-spaces, exactly; its smooth remainder is extrapolated linearly from the outermost cells;
positions beyond are treated as the outermost stored ones. Linear interpolation would dissipate the history: a traction
locked into the patch keeps half of its peak after ten cells at a tenth of a cell per step.

**Work.** For the material in a cell, friction uses the mean of the traction at its previous and its present position,
times its slip: with S_0 the slip of the material that was in a cell before, e interpolated at its present position,

    W = (sum over cells tau.S + sum over cells of before tau_0.S_0)/2 <= 0.

In steady rolling over a half-space this is exactly the work that creep takes from the bodies: with e = G tau, G
symmetric and translation invariant, the elastic parts of the two sums cancel. With the tractions at the end alone a
tenth to a half of it would be missing, in proportion to the advance in a step, because tractions fall towards the
trailing edge, where material slips.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve, PatchScratch, RollingScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.state import ContactState, FrictionState
from warpffrf_kernels.friction.cells import cell_at, rubs_on_patch
from warpffrf_kernels.kinematics.closest_point import has_cells
from warpffrf_kernels.patch.cells import row_place
from warpffrf_kernels.patch.place import ALIKE, goes_on
from warpffrf_kernels.rolling.entering import advance_of
from warpffrf_kernels.rolling.places import strip_columns
from warpffrf_kernels.rolling.shear import STRIPS_AROUND, near_along, shear_line
from warpffrf_kernels.surfaces.smooth import radius_of, slope_of

wp.set_module_options(MODULE_OPTIONS)


@wp.struct
class Reading:
    """Cubic weights of four neighbours from `first` on."""

    first: int
    share: wp.vec4d


@wp.func
def read_at(place: real, count: int) -> Reading:
    """Weights at a `place` counted in `count` entries; beyond them as at the end."""
    found = Reading()
    x = wp.clamp(place, real(0.0), real(count - 1))
    first = wp.clamp(int(wp.floor(x)) - 1, 0, wp.max(count - 4, 0))
    a = x - real(first)
    b = a - real(1.0)
    c = a - real(2.0)
    d = a - real(3.0)
    found.first = first
    found.share = wp.vec4d(-b * c * d / real(6.0), a * c * d / real(2.0), -a * b * d / real(2.0), a * b * c / real(6.0))
    return found


@wp.func
def way_of(model: Model, elements: Elements, pair: int, z: real, advanced: wp.vec2d) -> wp.vec2d:
    """Path [m] of the first body's material through the patch, along (e_theta, t_z): opposite to the patch's
    advance."""
    A = elements.patches.first[pair]
    slope = slope_of(model, A, z)
    return wp.vec2d(
        -advanced[0] * model.surfaces.pitch[A] * radius_of(model, A, z) * model.surfaces.side[A],
        -advanced[1] * wp.sqrt(real(1.0) + slope * slope),
    )


@kernel
def slide_patch_cells(
    run: Run, patch: PatchScratch, friction: FrictionState, cells: FrictionCells, rolling: RollingScratch
):
    """Per (world, pair), lanes over cells: slip of the step [m]; without a history the rigid-body slip."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    columns = elements.patches.columns[pair]
    rings = elements.rolling.ring_rows[pair]
    wide = columns + 2 * STRIPS_AROUND
    high = rows + 2 * rings
    strip = strip_columns(model, elements, w, pair, patch.patch_place)
    known = friction.ring_place[w, pair, 2] > real(0.0)
    before = strip
    if known:
        before = strip_columns(model, elements, w, pair, friction.ring_place)
    m = lane
    while m < columns * rows:
        i_1 = cell_at(rows, m, 0)
        i_2 = cell_at(rows, m, 1)
        s_1 = cells.rigid_slip[w, pair, i_1]
        s_2 = cells.rigid_slip[w, pair, i_2]
        if known:
            advanced = advance_of(model, elements, w, pair, m % rows, patch, friction)
            way = way_of(model, elements, pair, patch.patch_place[w, pair, 1], advanced)
            x = advanced[0] + (real(m / rows) - real(0.5) * real(columns - 1)) * strip
            across = read_at(x / before + real(0.5) * real(wide - 1), wide)
            row = m % rows
            along = Reading()
            along.first = row
            along.share = wp.vec4d(real(1.0), real(0.0), real(0.0), real(0.0))
            if rings > 0:
                z = row_place(elements, pair, row, patch.patch_place, w)[0] - friction.ring_place[w, pair, 1]
                pitch = row_place(elements, pair, row, friction.ring_place, w)[1]
                along = read_at(z / pitch + real(0.5) * real(high - 1), high)
            u_1 = real(0.0)
            u_2 = real(0.0)
            for i in range(4):
                for j in range(4):
                    share = across.share[i] * along.share[j]
                    if share != real(0.0):
                        at = (across.first + i) * high + along.first + j
                        u_1 += share * friction.ring_slip[w, pair, at]
                        u_2 += share * friction.ring_slip[w, pair, wide * high + at]
            s_1 += cells.elastic[w, pair, i_1] - u_1
            s_2 += cells.elastic[w, pair, i_2] - u_2
            if cells.cell_area[w, pair, m] > real(0.0):
                growth = (
                    rolling.weak_grown[(w * model.pairs.count + pair) * model.window.grid_nodes + m]
                    / cells.cell_area[w, pair, m]
                )
                s_1 += way[0] * growth
                s_2 += way[1] * growth
        cells.slip[w, pair, i_1] = s_1
        cells.slip[w, pair, i_2] = s_2
        m += wp.block_dim()


@kernel
def mean_work(
    run: Run, patch: PatchScratch, friction: FrictionState, cells: FrictionCells, rolling: RollingScratch,
    traction_before: wp.array3d(dtype=real),
):  # fmt: skip
    """Per (world, pair): work of friction by the mean of the tractions before and after, from that by those after."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    if friction.ring_place[w, pair, 2] == real(0.0):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    columns = elements.patches.columns[pair]
    strip = strip_columns(model, elements, w, pair, patch.patch_place)
    before = strip_columns(model, elements, w, pair, friction.ring_place)
    rings = elements.rolling.ring_rows[pair]
    high = rows + 2 * rings
    wide = columns + 2 * STRIPS_AROUND
    grown = (w * model.pairs.count + pair) * model.window.grid_nodes
    scale = friction.ring_place[w, pair, 2] / patch.patch_place[w, pair, 2]
    if elements.patches.follows[pair] != 0:
        scale = scale * scale
    total = real(0.0)
    m = int(0)
    while m < columns * rows:
        t_1 = traction_before[w, pair, cell_at(rows, m, 0)]
        t_2 = traction_before[w, pair, cell_at(rows, m, 1)]
        area = cells.cell_area[w, pair, m]
        if area > real(0.0) and (t_1 != real(0.0) or t_2 != real(0.0)):
            advanced = advance_of(model, elements, w, pair, m % rows, patch, friction)
            way = way_of(model, elements, pair, patch.patch_place[w, pair, 1], advanced)
            x = (real(m / rows) - real(0.5) * real(columns - 1)) * before - advanced[0]
            across = read_at(x / strip + real(0.5) * real(columns - 1), columns)
            along = Reading()
            along.first = m % rows
            along.share = wp.vec4d(real(1.0), real(0.0), real(0.0), real(0.0))
            if elements.patches.follows[pair] != 0:
                z = row_place(elements, pair, m % rows, friction.ring_place, w)[0] - patch.patch_place[w, pair, 1]
                pitch = row_place(elements, pair, m % rows, patch.patch_place, w)[1]
                along = read_at(z / pitch + real(0.5) * real(rows - 1), rows)
            at = (m / rows + STRIPS_AROUND) * high + m % rows + rings
            s_1 = way[0] * rolling.weak_grown[grown + m] / area - friction.ring_slip[w, pair, at]
            s_2 = way[1] * rolling.weak_grown[grown + m] / area - friction.ring_slip[w, pair, wide * high + at]
            for i in range(4):
                for j in range(4):
                    share = across.share[i] * along.share[j]
                    if share != real(0.0):
                        cell = (across.first + i) * rows + along.first + j
                        i_1 = cell_at(rows, cell, 0)
                        i_2 = cell_at(rows, cell, 1)
                        s_1 += share * (cells.elastic[w, pair, i_1] + cells.rigid_slip[w, pair, i_1])
                        s_2 += share * (cells.elastic[w, pair, i_2] + cells.rigid_slip[w, pair, i_2])
            total += scale * area * (t_1 * s_1 + t_2 * s_2)
        m += 1
    cells.friction_work[w, pair, 0] = wp.min(real(0.5) * (cells.friction_work[w, pair, 0] + total), real(0.0))


@wp.func
def smooth_at(
    w: int, pair: int, rows: int, c: int, r: int, d: int, base: int, grid_nodes: int, cells: FrictionCells,
    rolling: RollingScratch,
) -> real:  # fmt: skip
    """Part of e of a cell that is not due to the half-spaces [m]."""
    m = c * rows + r
    area = cells.cell_area[w, pair, m]
    if not (area > real(0.0)):
        return real(0.0)
    return cells.elastic[w, pair, cell_at(rows, m, d)] - rolling.near_shift[base + d * grid_nodes + m] / area


@kernel
def keep_rings(
    run: Run, geometry: ContactGeometry, patch: PatchScratch, rubbing: FrictionCells, rolling: RollingScratch,
    friction: FrictionState, patch_pressure: wp.array(dtype=real), ring_slip: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, pair), lanes over cells: the history of an accepted step. friction_record: power, creep (2), rolling
    velocity."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].accept == 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    columns = elements.patches.columns[pair]
    rings = elements.rolling.ring_rows[pair]
    wide = columns + 2 * STRIPS_AROUND
    high = rows + 2 * rings
    grid_nodes = model.window.grid_nodes
    here = w * model.pairs.count + pair
    start = here * 2 * elements.rolling.ring_cells
    near_along(
        model, elements, w, pair, rows, shear_line(rows, rings), STRIPS_AROUND, -STRIPS_AROUND, wide, 0, high,
        rolling.shear_near, rolling.place_traction, patch_pressure, ring_slip, start, wide * high,
    )  # fmt: skip
    strip = real(2.0) * patch.patch_place[w, pair, 2] / real(columns)
    base = here * 2 * grid_nodes
    e = lane
    while e < wide * high:
        c = e / high - STRIPS_AROUND
        r = e % high - rings
        c_in = wp.clamp(c, 0, columns - 1)
        r_in = wp.clamp(r, 0, rows - 1)
        for d in range(2):
            at = start + d * wide * high + e
            if c == c_in and r == r_in:
                ring_slip[at] = rubbing.elastic[w, pair, cell_at(rows, c * rows + r, d)]
            else:
                value = smooth_at(w, pair, rows, c_in, r_in, d, base, grid_nodes, rubbing, rolling)
                if c != c_in:
                    inner = c_in + wp.sign(c_in - c)
                    value += real(wp.abs(c - c_in)) * (
                        smooth_at(w, pair, rows, c_in, r_in, d, base, grid_nodes, rubbing, rolling)
                        - smooth_at(w, pair, rows, inner, r_in, d, base, grid_nodes, rubbing, rolling)
                    )
                if r != r_in:
                    inner = r_in + wp.sign(r_in - r)
                    value += real(wp.abs(r - r_in)) * (
                        smooth_at(w, pair, rows, c_in, r_in, d, base, grid_nodes, rubbing, rolling)
                        - smooth_at(w, pair, rows, c_in, inner, d, base, grid_nodes, rubbing, rolling)
                    )
                size = strip * row_place(elements, pair, r_in, patch.patch_place, w)[1]
                ring_slip[at] = ring_slip[at] / size + value
        e += wp.block_dim()
    sync()
    if lane == 0:
        h = run.clk[w].done_step
        advanced = advance_of(model, elements, w, pair, rows / 2, patch, friction)
        way = way_of(model, elements, pair, patch.patch_place[w, pair, 1], advanced)
        cells = wp.abs(advanced[0]) / strip_columns(model, elements, w, pair, patch.patch_place)
        if elements.patches.follows[pair] != 0:
            up = wp.abs(advanced[1]) / row_place(elements, pair, 0, patch.patch_place, w)[1]
            cells = wp.max(cells, up)
        if is_whole(run.ctl, w):
            friction.most_advanced[w, pair] = wp.max(friction.most_advanced[w, pair], cells)
        else:
            friction.most_advanced[w, pair] = real(0.0)
        friction.history_phase[w, pair] = patch.patch_place[w, pair, 0]
        entry = int(0)
        while entry < friction.ring_place.shape[2]:
            friction.ring_place[w, pair, entry] = patch.patch_place[w, pair, entry]
            entry += 1
        if not has_cells(model, w, pair, geometry):
            friction.ring_place[w, pair, 2] = real(0.0)
        force = vec3(
            rubbing.normal_wrench[w, pair, 0], rubbing.normal_wrench[w, pair, 1], rubbing.normal_wrench[w, pair, 2]
        )
        friction.contact_normal[w, pair] = vec3(real(0.0), real(0.0), real(0.0))
        if wp.length(force) > real(0.0):
            friction.contact_normal[w, pair] = -wp.normalize(force)
        for c in range(4):
            rubbing.friction_record[w, pair, c] = real(0.0)
        if is_whole(run.ctl, w) and h > real(0.0):
            # of the material in the middle of the patch half way through the step
            gone = real(0.5) * advanced[0] / strip_columns(model, elements, w, pair, patch.patch_place)
            across = read_at(real(0.5) * real(columns - 1) - gone, columns)
            middle = real(0.5) * real(rows - 1)
            if elements.patches.follows[pair] != 0:
                middle -= real(0.5) * advanced[1] / row_place(elements, pair, 0, patch.patch_place, w)[1]
            along = read_at(middle, rows)
            creep = real(0.0)
            lateral = real(0.0)
            for i in range(4):
                for j in range(4):
                    share = across.share[i] * along.share[j] / h
                    m = (across.first + i) * rows + along.first + j
                    creep += share * rubbing.rigid_slip[w, pair, cell_at(rows, m, 0)]
                    lateral += share * rubbing.rigid_slip[w, pair, cell_at(rows, m, 1)]
            rubbing.friction_record[w, pair, 0] = -rubbing.friction_work[w, pair, 0] / h
            rubbing.friction_record[w, pair, 1] = creep
            rubbing.friction_record[w, pair, 2] = lateral
            rubbing.friction_record[w, pair, 3] = way[0] / h - real(0.5) * creep


@kernel
def extrapolate_tractions(
    run: Run, normal: ContactSolve, contact: ContactState, friction: FrictionState, rolling: RollingScratch,
    patch_width_before: wp.array2d(dtype=real),
):  # fmt: skip
    """Per (world, pair), lanes over cells, before the first iteration: adds the last change to the tractions of cells
    under pressure, as `place.extrapolate` to their pressures."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].iteration != 0 or not rubs_on_patch(model, pair):
        return
    if rolling.traction_steady[w, pair] == 0:
        return
    factor = goes_on(run, normal, w, patch_width_before[w, pair], contact.patch_width[w, pair])
    rows = model.surfaces.rows[model.pairs.first[pair]]
    m = lane
    while m < model.elements[0].patches.columns[pair] * rows:
        if contact.active[w, pair, m] != 0:
            for d in range(2):
                i = cell_at(rows, m, d)
                friction.traction[w, pair, i] = (
                    friction.traction[w, pair, i] + factor * rolling.traction_change[w, pair, i]
                )
        m += wp.block_dim()


@kernel
def keep_traction_change(
    run: Run, contact: ContactState, friction: FrictionState, rolling: RollingScratch,
    active_before: wp.array3d(dtype=int), traction_before: wp.array3d(dtype=real),
    patch_width_before: wp.array2d(dtype=real),
):  # fmt: skip
    """Per (world, pair), of an accepted attempt: the change of the tractions of each cell, and whether it does not
    reverse the previous change, as `place.keep_change`."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or not rubs_on_patch(model, pair):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    width = contact.patch_width[w, pair]
    alike = run.ctl[w].mode == k.DYNAMIC and wp.abs(width - patch_width_before[w, pair]) <= ALIKE * width
    both = real(0.0)
    m = int(0)
    while m < model.elements[0].patches.columns[pair] * rows:
        kept = alike and contact.active[w, pair, m] != 0 and active_before[w, pair, m] != 0
        for d in range(2):
            i = cell_at(rows, m, d)
            change = real(0.0)
            if kept:
                change = friction.traction[w, pair, i] - traction_before[w, pair, i]
            both += change * rolling.traction_change[w, pair, i]
            rolling.traction_change[w, pair, i] = change
        m += 1
    rolling.traction_steady[w, pair] = int(both >= real(0.0))
