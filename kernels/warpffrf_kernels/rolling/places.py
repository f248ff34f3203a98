"""Contact-fixed cells: positions on both bodies, rigid-body slip, bounds.

As in `friction.cells`, except for the positions: the centres of the patch's strips and rows. Pressures and tractions
are both constant on a cell, so its bound is mu times its own pressure.

**Light patches.** Friction of a pair that carried less than LIGHT of the largest load in the last step acts on the cell
in the middle of its patch alone, with the bound mu times the whole load: an idle roller keeps its torque and its slip
at the cost of two unknowns, and only the distribution of a negligible traction is lost.

**Rolling moment.** The wrench of a pressure has no torque about the axles of bodies of revolution (`contact_wrench`),
which is correct for pressures centred on a patch. Tractions between unlike bodies shift them by an arm x of the force N
along e_theta. The surfaces are flat there, and pressure acts along the common normal c: a couple N x t_z on the first
body, the opposite on the second, in addition to the wrench. Its power on both, V N x/R* in rolling with the relative
radius R*, is the power of the pressures on the displacements due to the tractions while material passes: with gaps
g = g_0 + G p + N^T tau = 0 on the patch, g_0' = x/R*, and G symmetric and translation invariant,

    int p (N^T tau)' dx = -int p g_0' dx = -N x/R*.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import ContactState, FrictionState, MotionState
from warpffrf_kernels.friction.cells import cell_at, find_cell, keep_cell, look, rubs_on_patch
from warpffrf_kernels.kinematics.closest_point import has_cells
from warpffrf_kernels.normal.pair_forces import load_share
from warpffrf_kernels.patch.cells import ROW_COLUMNS, row_place
from warpffrf_kernels.rolling.shear import shear_line
from warpffrf_kernels.surfaces.smooth import radius_of

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def strip_columns(model: Model, elements: Elements, w: int, pair: int, patch_place: wp.array3d(dtype=real)) -> real:
    """Width of a strip in columns of the first surface's grid."""
    A = elements.patches.first[pair]
    around = model.surfaces.pitch[A] * radius_of(model, A, patch_place[w, pair, 1])
    return real(2.0) * patch_place[w, pair, 2] / (real(elements.patches.columns[pair]) * around)


# Permitted change before the compliance of the cells is recomputed: it is used as a tangent only, never for residuals.
# It varies with the second or third power of W; far fields, a sixth of it, vary over the columns of the mesh.
SAME_WIDTH = wp.constant(wp.float64(2.0e-3))
SAME_PLACE = wp.constant(wp.float64(0.5))  # columns
LIGHT = wp.constant(wp.float64(0.01))  # of the largest load: friction acts on one cell of a patch with less
SAME_NORMAL = wp.constant(wp.float64(1.0e-2))  # rad: gradients with respect to the bodies' motion rotate with it


@kernel
def open_patch_cells(run: Run, friction: FrictionState, patch: PatchScratch, cells: FrictionCells):
    """Per (world, pair): whether the compliance of the cells is to be reassembled. cell_phase: position of the patch at
    the last assembly, the step size, on which the part of the modes depends, and the normal."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    width = patch.patch_place[w, pair, 2]
    off = wp.abs(patch.patch_place[w, pair, 0] - cells.cell_phase[w, pair, 0]) / SAME_PLACE
    off = wp.max(off, wp.abs(patch.patch_place[w, pair, 3] - cells.cell_phase[w, pair, 3]) / SAME_PLACE)
    off = wp.max(off, wp.abs(patch.patch_place[w, pair, 1] - cells.cell_phase[w, pair, 1]) / (SAME_PLACE * width))
    off = wp.max(off, wp.abs(width - cells.cell_phase[w, pair, 2]) / (SAME_WIDTH * width))
    normal = friction.contact_normal[w, pair]
    for i in range(3):
        off = wp.max(off, wp.abs(normal[i] - cells.cell_phase[w, pair, 5 + i]) / SAME_NORMAL)
    if not (off < real(1.0)) or cells.cell_phase[w, pair, 4] != run.clk[w].h:
        run.ctl[w].stale = 1
        for i in range(4):
            cells.cell_phase[w, pair, i] = patch.patch_place[w, pair, i]
            cells.cell_phase[w, pair, 5 + wp.min(i, 2)] = normal[wp.min(i, 2)]
        cells.cell_phase[w, pair, 4] = run.clk[w].h


@kernel
def place_patch_cells(
    run: Run, state: MotionState, trial: Trial, friction: FrictionState, patch: PatchScratch, geometry: ContactGeometry,
    cells: FrictionCells, shear_near: wp.array3d(dtype=real),
):  # fmt: skip
    """Per (world, pair), lanes over cells: area (0 without an opposite surface), rotation, wrench, displacement by a
    unit traction of their own, rigid slip; and the couple of a unit pressure that acts along the common normal."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    if not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    A = elements.patches.first[pair]
    B = elements.patches.second[pair]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    columns = elements.patches.columns[pair]
    strip = strip_columns(model, elements, w, pair, patch.patch_place)
    middle = model.surfaces.theta[A] + patch.patch_place[w, pair, 0] * model.surfaces.pitch[A]
    s = look(model, w, A, B, state, trial, friction.contact_normal[w, pair], middle, patch.patch_place[w, pair, 1])
    rings = elements.rolling.ring_rows[pair]
    line = shear_line(rows, rings)
    way = real(2.0) * patch.patch_place[w, pair, 2] / real(columns)
    m = lane
    while m < columns * rows:
        x = patch.patch_place[w, pair, ROW_COLUMNS + m % rows]
        x += (real(m / rows) - real(0.5) * real(columns - 1)) * strip
        z = row_place(elements, pair, m % rows, patch.patch_place, w)[0]
        found = find_cell(model, A, B, s, model.surfaces.theta[A] + x * model.surfaces.pitch[A], z)
        size = geometry.area[w, pair, m]
        if is_whole(run.ctl, w):  # without tractions the pressures are centred
            arm = model.surfaces.side[A] * (real(m / rows) - real(0.5) * real(columns - 1)) * way
            for i in range(3):
                geometry.more_wrench[w, pair, m, 3 + i] = (
                    geometry.more_wrench[w, pair, m, 3 + i] + size * arm * found.u_2[i]
                )
        keep_cell(w, pair, rows, m, size, found, cells)
        own = real(0.0)
        if size > real(0.0):
            own = shear_near[w, pair, (m % rows) * line + rings + m % rows] / size
        cells.cell_own[w, pair, m] = own
        m += wp.block_dim()


@wp.func
def pressure_of(w: int, pair: int, m: int, geometry: ContactGeometry, contact: ContactState) -> real:
    """Pressure [Pa] of a cell; 0 if it is open, has no opposite surface, or is drawn."""
    if contact.active[w, pair, m] == 0 or not (geometry.area[w, pair, m] > real(0.0)):
        return real(0.0)
    return wp.max(contact.pressure[w, pair, m], real(0.0))


@kernel
def bound_patch_cells(
    run: Run, contact: ContactState, geometry: ContactGeometry, rubbing: FrictionCells, friction: FrictionState,
    clip: int,
):  # fmt: skip
    """Per (world, pair), lanes over cells: the bounds mu p [Pa] of the present pressures; with `clip`, tractions are
    cut to them. Friction acts in time steps and load steps only."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not rubs_on_patch(model, pair):
        return
    if (clip != 0 and run.ctl[w].moved == 0) or (clip == 0 and run.ctl[w].changes != 0):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    cells = model.elements[0].patches.columns[pair] * rows
    middle = (model.elements[0].patches.columns[pair] / 2) * rows + rows / 2
    light = load_share(model, w, pair, contact.pair_force) < LIGHT and geometry.area[w, pair, middle] > real(0.0)
    m = lane
    while m < model.window.grid_nodes:
        value = real(0.0)
        if m < cells and is_whole(run.ctl, w):
            if light and m == middle:
                cell = int(0)
                while cell < cells:
                    value += pressure_of(w, pair, cell, geometry, contact) * geometry.area[w, pair, cell]
                    cell += 1
                value *= model.pairs.friction[pair] / geometry.area[w, pair, m]
            elif not light:
                value = model.pairs.friction[pair] * pressure_of(w, pair, m, geometry, contact)
        rubbing.bound[w, pair, m] = value
        if clip != 0 and m < cells:
            i = cell_at(rows, m, 0)
            j = cell_at(rows, m, 1)
            size = wp.sqrt(
                friction.traction[w, pair, i] * friction.traction[w, pair, i]
                + friction.traction[w, pair, j] * friction.traction[w, pair, j]
            )
            if not (size <= value):
                share = real(0.0)
                if size > real(0.0) and wp.isfinite(size):
                    share = value / size
                for d in range(2):
                    at = cell_at(rows, m, d)
                    stress = real(0.0)
                    if share > real(0.0):
                        stress = share * friction.traction[w, pair, at]
                    friction.traction[w, pair, at] = stress
        m += wp.block_dim()
