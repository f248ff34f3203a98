"""Position and width of the patch of a pair, and its active cells.

Cells are `columns` equal strips across, over the width 2 W around the point where the surfaces are nearest, by rows
along the meridian of the first surface. Rows of a *line* contact are fixed; rows of a short contact (`follows`) are
centred on the nearest point and grow with W, so the cells keep their shape.

W follows the pressures of the state at the start of the attempt: `span` times the half-width b, which is twice the root
of the second moment of a strip's pressure, or sqrt(5) times that of a whole ellipse. (The extent of the active set
would jump from cell to cell, and the force with it.) Without pressure, W is the width of the overlap of the surfaces.
Within an attempt W changes only if the patch reaches the outermost strips, or fills less than half of them. Pressures
are transferred from old cells to new ones by linear interpolation.

Cells move and grow with the patch, so the pressure of each changes little, and smoothly, from step to step. An attempt
therefore starts with p_n + (h/h_n)(p_n - p_(n-1)), cell by cell, if W is nearly unchanged and the change does not
reverse the previous one: second order in the step, whereas p_n alone is first order. This is the initial guess of the
iteration, not its result.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact, Trial
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.kinematics.closest_point import (
    View,
    gap_at,
    has_cells,
    may_reach,
    scan,
    settle,
    view_of,
    wrap_column,
)
from warpffrf_kernels.kinematics.line_of_centres import FARTHEST, PHASE_TOLERANCE
from warpffrf_kernels.normal.compliance_reuse import BEGUN, OLDER, are_near
from warpffrf_kernels.patch.cells import row_column
from warpffrf_kernels.surfaces.helical import twist_of
from warpffrf_kernels.surfaces.smooth import radius_of
from warpffrf_kernels.surfaces.surface import EXTRUDED, foot_of, local_point

wp.set_module_options(MODULE_OPTIONS)

LINE_MOMENT = wp.constant(wp.float64(2.0))  # b over the root of the second moment of a strip's pressure
POINT_MOMENT = wp.constant(wp.float64(2.2360679774997896))  # sqrt 5, for an ellipse
COUNTED = wp.constant(wp.float64(0.05))  # of the largest line load: rows with less are ignored for b
# Of the peak: less in the outermost strips is the tail of a layer (asperities without a limit), and may be cut off.
FELT = wp.constant(wp.float64(1.0e-3))
CONTENT = wp.constant(wp.float64(0.99))  # of the wanted W: pressures in the outermost strips are then what is cut off
SETTLING = wp.constant(3)  # iterations in which W may shrink
FASTEST = wp.constant(wp.float64(1.6))  # change of W from one attempt to the next
GROWTH = wp.constant(wp.float64(3.0))  # of W if the outermost strips are under pressure
# of W: permitted deviation during the energy search for a static state; other cells would change the energy by 1e-3
LOOSE = wp.constant(wp.float64(0.2))
SPARSE = wp.constant(wp.float64(0.5))  # of the strips: a patch on fewer is regridded within an attempt
STEADY = wp.constant(wp.float64(1.0e-9))  # relative change of W that counts as zero
# relative change of W in a step up to which pressures are extrapolated cell by cell: more is an impact, or a first step
ALIKE = wp.constant(wp.float64(0.05))
LONGER = wp.constant(wp.float64(2.0))  # of the last step: maximum extrapolation of a change of pressure


@wp.struct
class Extent:
    """Cells under pressure: their number, half-width b [m] by moments, wanted W [m], number of strips from first to
    last, and whether the patch reaches the outermost strips and requires more."""

    count: int
    half_width: real
    wanted: real
    strips: int
    reaches: int


@wp.func
def peak_of(elements: Elements, w: int, pair: int, rows: int, contact: ContactState) -> real:
    """Largest pressure of the cells of a pair [Pa]."""
    peak = real(0.0)
    m = int(0)
    while m < elements.patches.columns[pair] * rows:
        if contact.active[w, pair, m] != 0:
            peak = wp.max(peak, contact.pressure[w, pair, m])
        m += 1
    return peak


@wp.func
def extent_of(elements: Elements, w: int, pair: int, rows: int, width: real, contact: ContactState) -> Extent:
    """Extent of the active cells of a pair, whose strips are 2 `width`/columns wide."""
    columns = elements.patches.columns[pair]
    strip = real(2.0) * width / real(columns)
    found = Extent()
    low = columns
    high = int(-1)
    bottom = rows
    top = int(-1)
    most = real(0.0)
    felt = FELT * peak_of(elements, w, pair, rows, contact)
    row = int(0)
    while row < rows:
        load = real(0.0)
        column = int(0)
        while column < columns:
            m = column * rows + row
            if contact.active[w, pair, m] != 0 and contact.pressure[w, pair, m] > real(0.0):
                found.count += 1
                load += contact.pressure[w, pair, m]
                if contact.pressure[w, pair, m] > felt:
                    low = wp.min(low, column)
                    high = wp.max(high, column)
                    bottom = wp.min(bottom, row)
                    top = wp.max(top, row)
            column += 1
        most = wp.max(most, load)
        row += 1
    if found.count == 0:
        return found
    found.strips = high - low + 1
    if low == 0 or high == columns - 1:
        found.reaches = 1
    total = real(0.0)
    first = real(0.0)
    second = real(0.0)
    along = real(0.0)
    along_second = real(0.0)
    row = int(0)
    while row < rows:
        sum0 = real(0.0)
        sum1 = real(0.0)
        sum2 = real(0.0)
        column = int(0)
        while column < columns:
            m = column * rows + row
            if contact.active[w, pair, m] != 0 and contact.pressure[w, pair, m] > real(0.0):
                p = contact.pressure[w, pair, m]
                x = (real(column) - real(0.5) * real(columns - 1)) * strip
                sum0 += p
                sum1 += p * x
                sum2 += p * x * x
            column += 1
        if elements.patches.follows[pair] != 0:
            weight = elements.patches.row_length[elements.patches.row_start[pair] + row]
            z = elements.patches.row_z[elements.patches.row_start[pair] + row]
            total += weight * sum0
            first += weight * sum1
            second += weight * sum2
            along += weight * sum0 * z
            along_second += weight * sum0 * z * z
        elif sum0 > COUNTED * most:
            mean = sum1 / sum0
            spread = wp.sqrt(wp.max(sum2 / sum0 - mean * mean, real(0.0)))
            # a strip's own extent, the only one of a patch of one strip
            b = wp.abs(mean) + wp.max(LINE_MOMENT * spread, real(0.5) * strip)
            found.half_width = wp.max(found.half_width, b)
        row += 1
    if elements.patches.follows[pair] != 0:
        mean = first / total
        spread = wp.sqrt(wp.max(second / total - mean * mean, real(0.0)))
        found.half_width = wp.abs(mean) + wp.max(POINT_MOMENT * spread, real(0.5) * strip)
        mean = along / total
        spread = wp.sqrt(wp.max(along_second / total - mean * mean, real(0.0)))
        aspect = elements.patches.aspect[pair]
        found.half_width = wp.max(found.half_width, width * (wp.abs(mean) + POINT_MOMENT * spread) / aspect)
        if bottom == 0 or top == rows - 1:
            found.reaches = 1
    found.wanted = elements.patches.span[pair] * found.half_width
    if found.reaches != 0 and width > CONTENT * found.wanted:
        found.reaches = 0
    return found


@wp.func
def overlap_width(
    model: Model, elements: Elements, pair: int, A: int, B: int, view: View, column: real, z: real
) -> real:
    """Half-width [m] over which the undeformed surfaces overlap; 0 if they do not."""
    g = gap_at(model, A, B, view, model.surfaces.theta[A] + column * model.surfaces.pitch[A], z)
    g -= elements.patches.begins[pair]
    if not g < real(0.0):
        return real(0.0)
    return wp.sqrt(-real(2.0) * g / elements.patches.curvature[pair])


@wp.func
def move_pressures(
    elements: Elements, w: int, pair: int, rows: int, ratio: real, contact: ContactState, patch: PatchScratch
):
    """Transfers pressures to strips `ratio` times as wide as before, and to rows that follow. A cell is active if the
    nearest old one was: additional active cells next to the old patch would leave the set again."""
    columns = elements.patches.columns[pair]
    passes = 1 + elements.patches.follows[pair]
    turn = int(0)
    while turn < passes:
        count = columns
        stride = rows
        if turn == 1:
            count = rows
            stride = int(1)
        m = int(0)
        while m < columns * rows:
            patch.patch_buffer[w, pair, m] = real(0.0)
            if contact.active[w, pair, m] != 0:
                patch.patch_buffer[w, pair, m] = contact.pressure[w, pair, m]
            m += 1
        m = int(0)
        while m < columns * rows:
            i = (m / stride) % count
            from_line = m - i * stride
            middle = real(0.5) * real(count - 1)
            f = middle + (real(i) - middle) * ratio
            j = int(wp.floor(f))
            u = f - real(j)
            low = real(0.0)
            high = real(0.0)
            if j >= 0 and j < count:
                low = patch.patch_buffer[w, pair, from_line + j * stride]
            if j + 1 >= 0 and j + 1 < count:
                high = patch.patch_buffer[w, pair, from_line + (j + 1) * stride]
            contact.active[w, pair, m] = 0
            contact.pressure[w, pair, m] = real(0.0)
            if (u < real(0.5) and low > real(0.0)) or (u >= real(0.5) and high > real(0.0)):
                contact.active[w, pair, m] = 1
                contact.pressure[w, pair, m] = (real(1.0) - u) * low + u * high
            m += 1
        turn += 1


@wp.func
def goes_on(run: Run, normal: ContactSolve, w: int, old: real, new: real) -> real:
    """Factor on the last step's change of pressure at the start of an attempt; 0 if it is not meaningful."""
    if (
        normal.lasting[w, BEGUN] == 0
        or run.ctl[w].again != 0
        or run.ctl[w].mode != k.DYNAMIC
        or not run.clk[w].done_step > real(0.0)
    ):
        return real(0.0)
    if wp.abs(new - old) > ALIKE * new:
        return real(0.0)
    return wp.min(run.clk[w].h / run.clk[w].done_step, LONGER)


@wp.func
def extrapolate(w: int, pair: int, cells: int, factor: real, contact: ContactState, patch: PatchScratch):
    """Adds the last change, times `factor`, to the pressures of active cells, unless the result is not positive."""
    m = int(0)
    while m < cells:
        if contact.active[w, pair, m] != 0:
            ahead = contact.pressure[w, pair, m] + factor * patch.patch_change[w, pair, m]
            if ahead > real(0.0):
                contact.pressure[w, pair, m] = ahead
        m += 1


@wp.func
def part(
    run: Run, w: int, pair: int, width: real, geometry: ContactGeometry, contact: ContactState, patch: PatchScratch
):  # fmt: skip
    """A pair without cells: an empty window, no splines, no pressures."""
    model = run.models[w]
    m = int(0)
    while m < model.window.grid_nodes:
        if contact.active[w, pair, m] != 0:
            contact.active[w, pair, m] = 0
            contact.pressure[w, pair, m] = real(0.0)
            run.ctl[w].reassemble = 1
        m += 1
    patch.patch_place[w, pair, 2] = width
    for side in range(2):
        patch.far_window[w, pair, side, 0] = 0
        patch.far_window[w, pair, side, 1] = 0
    geometry.window[w, pair, 0] = 0
    geometry.window[w, pair, 1] = -1


@kernel
def keep_change(
    run: Run, contact: ContactState, patch: PatchScratch, active_before: wp.array3d(dtype=int),
    pressure_before: wp.array3d(dtype=real), patch_width_before: wp.array2d(dtype=real),
):  # fmt: skip
    """Per (world, pair of family 2), of an accepted attempt: the change of the pressure of each cell, and whether it
    does not reverse the previous change."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or model.pairs.family[pair] != PATCH:
        return
    width = contact.patch_width[w, pair]
    alike = run.ctl[w].mode == k.DYNAMIC and wp.abs(width - patch_width_before[w, pair]) <= ALIKE * width
    both = real(0.0)
    m = int(0)
    while m < model.window.grid_nodes:
        change = real(0.0)
        if alike and contact.active[w, pair, m] != 0 and active_before[w, pair, m] != 0:
            change = contact.pressure[w, pair, m] - pressure_before[w, pair, m]
        both += change * patch.patch_change[w, pair, m]
        patch.patch_change[w, pair, m] = change
        m += 1
    patch.patch_steady[w, pair] = int(both >= real(0.0))


@kernel
def locate_patches(
    run: Run, trial: Trial, normal: ContactSolve, impulses: ImpulsiveContact, patch: PatchScratch,
    geometry: ContactGeometry, contact: ContactState,
):  # fmt: skip
    """Per (world, pair of family 2): nearest point, phases, W, and the transferred pressures.

    patch_place: column of A in the middle, z there [m], W [m], column of B opposite; the rest by `cells.hold_rows`.
    """
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    A = elements.patches.first[pair]
    B = elements.patches.second[pair]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    view = view_of(model, w, pair, trial)
    old = contact.patch_width[w, pair]
    least = elements.patches.least_width[pair]
    most = elements.patches.most_width[pair]
    # nearest point of the two surfaces, unless they are apart, and its columns on both
    if run.ctl[w].iteration == 0 or not has_cells(model, w, pair, geometry):
        reach = elements.patches.begins[pair] + real(0.5) * elements.patches.curvature[pair] * most * most
        near = model.surfaces.modal_count[A] > 0 or model.surfaces.modal_count[B] > 0
        if not near:
            near = may_reach(model, A, B, view, reach)
        if near:
            best = scan(model, w, pair, A, B, view, geometry)
            near = best < reach or model.surfaces.modal_count[A] > 0 or model.surfaces.modal_count[B] > 0
        if not near:
            part(run, w, pair, wp.max(old, least), geometry, contact, patch)
            return
    z = elements.patches.middle[pair]
    if elements.patches.follows[pair] != 0:
        z = geometry.nearest[w, pair, 1]
    x = settle(model, A, B, view, geometry.nearest[w, pair, 0], z)
    geometry.nearest[w, pair, 0] = x
    theta = model.surfaces.theta[A] + x * model.surfaces.pitch[A]
    foot = foot_of(model, B, view.at + view.turn * local_point(model, A, theta, z))
    x_b = real(0.0)
    if model.surfaces.rigid[B] == 0:
        x_b = (foot.theta - model.surfaces.theta[B]) / model.surfaces.pitch[B]
        middle = real(0.5) * real(model.surfaces.columns[B] - 1)
        if run.ctl[w].iteration > 0:  # stay on the branch of the first iteration
            middle = real(geometry.center[w, pair, 1])
        x_b = wrap_column(model, B, x_b, middle)
    if not (wp.abs(x) < FARTHEST and wp.abs(x_b) < FARTHEST):
        run.ctl[w].failure = run.ctl[w].failure | k.NOT_FINITE
        run.ctl[w].run = 0
        return

    # wanted W: from the active cells, or from the overlap of the undeformed surfaces if there are none
    m = int(0)
    while m < model.window.grid_nodes:  # left by a rejected attempt
        if contact.active[w, pair, m] != 0 and not wp.isfinite(contact.pressure[w, pair, m]):
            contact.active[w, pair, m] = 0
            contact.pressure[w, pair, m] = real(0.0)
        m += 1
    new = old
    if not old > real(0.0):
        new = least
    found = extent_of(elements, w, pair, rows, new, contact)
    if found.count == 0:
        overlap = overlap_width(model, elements, pair, A, B, view, x, z)
        if not overlap > real(0.0) and elements.patches.follows[pair] == 0:  # tilted axes may overlap elsewhere
            start = elements.patches.row_start[pair]
            lean = wp.sqrt(view.turn[0, 2] * view.turn[0, 2] + view.turn[1, 2] * view.turn[1, 2])
            lean *= elements.patches.row_z[start + rows - 1] - elements.patches.row_z[start]
            row = int(0)
            helix = model.surfaces.planar[A] == EXTRUDED and twist_of(model, A) != real(0.0)
            if not helix and gap_at(model, A, B, view, theta, z) - elements.patches.begins[pair] > lean:
                row = rows
            while row < rows:
                z_row = elements.patches.row_z[start + row]
                at_row = overlap_width(
                    model, elements, pair, A, B, view, row_column(model, A, B, view, x, z, z_row), z_row
                )
                overlap = wp.max(overlap, at_row)
                row += 1
        if overlap > new or overlap > real(0.0) and overlap < SPARSE * new:
            new = overlap
    elif run.ctl[w].iteration == 0:
        wanted = wp.clamp(found.wanted, new / FASTEST, new * FASTEST)
        if run.ctl[w].energy_bounded == 0 or wp.abs(wanted - new) > LOOSE * new:
            new = wanted
    elif found.reaches != 0:
        new = wp.min(GROWTH * new, found.wanted)
    elif real(found.strips) < SPARSE * real(elements.patches.columns[pair]) and run.ctl[w].iteration <= SETTLING:
        new = found.wanted
    new = wp.clamp(new, least, most)
    # pressures on the new cells: transferred to another W, or extrapolated from the last steps
    ahead = goes_on(run, normal, w, old, new)
    if patch.patch_steady[w, pair] == 0:
        ahead = real(0.0)
    if wp.abs(new - old) > STEADY * new:
        if found.count > 0 and ahead == real(0.0):
            move_pressures(elements, w, pair, rows, new / old, contact, patch)
        contact.patch_width[w, pair] = new
        if normal.lasting[w, OLDER] == 0:
            run.ctl[w].reassemble = 1
    if ahead > real(0.0):
        extrapolate(w, pair, elements.patches.columns[pair] * rows, ahead, contact, patch)

    # phases, and whether they differ enough from those of G to assemble it anew
    geometry.phase[w, pair, 4] = x
    geometry.phase[w, pair, 5] = x_b
    geometry.phase[w, pair, 6] = x
    geometry.phase[w, pair, 7] = x_b
    geometry.phase[w, pair, 10] = z / radius_of(model, A, z)
    geometry.phase[w, pair, 11] = foot.z / radius_of(model, A, z)
    largest = real(0.0)
    for i in range(2):
        largest = wp.max(largest, wp.abs(geometry.phase[w, pair, 4 + i] - geometry.phase[w, pair, i]))
        largest = wp.max(largest, wp.abs(geometry.phase[w, pair, 10 + i] - geometry.phase[w, pair, 8 + i]))
    if normal.lasting[w, OLDER] != 0:
        if not are_near(run, w, pair, new, impulses, patch):
            run.ctl[w].reassemble = 1
    elif largest > PHASE_TOLERANCE or run.ctl[w].iteration == 0:
        run.ctl[w].reassemble = 1
    patch.patch_place[w, pair, 0] = x
    patch.patch_place[w, pair, 1] = z
    patch.patch_place[w, pair, 2] = new
    patch.patch_place[w, pair, 3] = x_b
    geometry.center[w, pair, 0] = int(wp.floor(x + real(0.5)))
    geometry.center[w, pair, 1] = int(wp.floor(x_b + real(0.5)))
    geometry.center[w, pair, 2] = 0
    geometry.window[w, pair, 0] = -model.window.half
    geometry.window[w, pair, 1] = elements.patches.columns[pair] - 1 - model.window.half
