"""Slip of the cells in a step, and the forces, energy and work of their tractions.

The slip is the rigid-body slip of the surfaces over the whole step plus the change of the difference of their elastic
displacements at the same material point of the first body. The work of friction in a step is sum tau.S with the
tractions at its end, never positive: the iteration leaves a residual slip of either sign in sticking cells; its work is
booked if negative, otherwise it is part of the contact grid's line. The contact energy includes tau.e/2 with the part
of e due to the local modes.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.control import Clock
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.lanes import most, totals, values
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real
from warpffrf_kernels.core.scratch import Residuals
from warpffrf_kernels.core.state import FrictionState
from warpffrf_kernels.friction.cell_shares import line_of
from warpffrf_kernels.friction.cells import cell_at, rubs_on_grid
from warpffrf_kernels.normal.pair_forces import modal_line
from warpffrf_kernels.surfaces.fields import clear_field

wp.set_module_options(MODULE_OPTIONS)

# Tractions are converged to this many times the tolerance of forces and gaps (of the largest bound): forces and moments
# of the present tractions are balanced to that tolerance itself.
TRACTION_SLACK = wp.constant(wp.float64(100.0))
OPEN = wp.constant(0)
STICK = wp.constant(1)
SLIP = wp.constant(2)


@wp.func
def before_at(
    model: Model, w: int, pair: int, rows: int, m: int, geometry: ContactGeometry, friction: FrictionState
) -> int:
    """Cell of the window of the last accepted step at the same material point; -1 outside that window."""
    A = model.pairs.first[pair]
    moved = geometry.center[w, pair, 0] - friction.history_center[w, pair]
    turn = model.surfaces.turn[A]
    if turn > 0:
        moved = moved - turn * int(wp.floor(real(moved) / real(turn) + real(0.5)))
    column = m / rows + moved
    if column < 0 or column >= model.window.columns:
        return -1
    return column * rows + m % rows


@kernel
def slide_cells(run: Run, geometry: ContactGeometry, cells: FrictionCells, friction: FrictionState):
    """Per (world, pair), lanes over cells: slip of the step [m]. Material without a history, from beyond the last
    window, has the rigid slip only."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_grid(model, pair):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    H = model.window.half
    m = (geometry.window[w, pair, 0] + H) * rows + lane
    while m < (geometry.window[w, pair, 1] + H + 1) * rows:
        old = before_at(model, w, pair, rows, m, geometry, friction)
        for d in range(2):
            i = cell_at(rows, m, d)
            value = cells.rigid_slip[w, pair, i]
            if old >= 0:
                value += cells.elastic[w, pair, i] - friction.elastic_before[w, pair, cell_at(rows, old, d)]
            cells.slip[w, pair, i] = value
        m += wp.block_dim()


@kernel
def clear_modes(run: Run, friction_modal: wp.array(dtype=real)):
    """Per (world, pair): clears the load of tractions on the modes of A and B."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    clear_field(lane, model.pairs.most_modes, modal_line(model, w, pair), friction_modal)


@kernel
def load_tractions(
    run: Run, geometry: ContactGeometry, cells: FrictionCells, friction: FrictionState,
    friction_modal: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, pair): adds the load of the tractions on the modes of A, then of B."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_grid(model, pair):
        return
    trial = modal_line(model, w, pair)
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    modes_a = model.surfaces.modal_count[A]
    m = (geometry.window[w, pair, 0] + model.window.half) * rows
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        for d in range(2):
            f = cells.cell_area[w, pair, m] * friction.traction[w, pair, cell_at(rows, m, d)]
            line = line_of(model, A, geometry.center[w, pair, 0] + m / rows - model.window.half, d * rows + m % rows)
            if f != real(0.0) and line >= 0:
                at = model.surfaces.shear_start[A] + line * modes_a
                axpy(modes_a, f, model.surfaces.mode_tangent, at, friction_modal, trial)
        m += 1
    B = model.pairs.second[pair]
    if model.surfaces.shear_start[B] >= 0:
        rows_b = model.surfaces.rows[B]
        modes = model.surfaces.modal_count[B]
        i = int(0)
        while i < 2 * model.window.second_columns * rows_b:
            f = cells.second_force[w, pair, i]
            if f != real(0.0):
                column = geometry.center[w, pair, 1] - model.window.second_half + i / (2 * rows_b)
                line = line_of(model, B, column, i % (2 * rows_b))
                if line >= 0:
                    at = model.surfaces.shear_start[B] + line * modes
                    axpy(modes, f, model.surfaces.mode_tangent, at, friction_modal, trial + modes_a)
            i += 1


@wp.func
def creep_softness(model: Model, clk: wp.array(dtype=Clock), w: int, pair: int, bound: real) -> real:
    """Slip of the step per traction that the regularised law adds [m/Pa]: h v_slip / (mu p)."""
    return clk[w].h * model.pairs.slip_velocity[pair] / bound


@kernel
def add_friction(
    run: Run, geometry: ContactGeometry, cells: FrictionCells, friction: FrictionState, residuals: Residuals
):
    """Per world, lanes over cells: wrench, elastic energy and work of the tractions of every pair, and their defect
    with respect to their slip, as a fraction of the largest bound of all pairs: slips have a round-off of 1e-17 m,
    which cannot be resolved by a pair whose bound is 1e-7 of another's, and the traction of an idle roller is
    negligible, as in the force balance.

    A traction is correct if it is the projection of tau - (slip + k tau)/c onto the disc of its bound, for any c > 0; k
    is the softness of entering cells and of a regularised law. With c = k + own, own the displacement per traction of
    the cell itself, the defect is that of an isolated cell: a smaller c overstates it if the law is soft.
    """
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    largest = real(0.0)
    defect = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        rubs = model.pairs.friction[pair] > real(0.0)
        sums = values(real(0.0))  # wrench, energy, work
        if lane == 0:
            for i in range(6):
                sums[i] = geometry.pair_wrench[w, pair, i]
        rows = model.surfaces.rows[model.pairs.first[pair]]
        m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
        while rubs and m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
            i_1 = cell_at(rows, m, 0)
            i_2 = cell_at(rows, m, 1)
            t_1 = friction.traction[w, pair, i_1]
            t_2 = friction.traction[w, pair, i_2]
            cells.traction_base[w, pair, i_1] = t_1
            cells.traction_base[w, pair, i_2] = t_2
            cells.cell_state[w, pair, m] = OPEN
            b = cells.bound[w, pair, m]
            if b > real(0.0):
                largest = wp.max(largest, b)
                area = cells.cell_area[w, pair, m]
                for i in range(6):
                    sums[i] += t_1 * cells.cell_wrench[w, pair, i_1, i] + t_2 * cells.cell_wrench[w, pair, i_2, i]
                sums[6] += (
                    real(0.5)
                    * area
                    * (t_1 * cells.elastic_local[w, pair, i_1] + t_2 * cells.elastic_local[w, pair, i_2])
                )
                s_1 = cells.slip[w, pair, i_1]
                s_2 = cells.slip[w, pair, i_2]
                sums[7] += area * wp.min(t_1 * s_1 + t_2 * s_2, real(0.0))
                soft = creep_softness(model, run.clk, w, pair, b) + cells.late[w, pair, m]
                c = cells.cell_own[w, pair, m] + soft
                y_1 = t_1 - (s_1 + soft * t_1) / c
                y_2 = t_2 - (s_2 + soft * t_2) / c
                size = wp.sqrt(y_1 * y_1 + y_2 * y_2)
                cells.cell_state[w, pair, m] = STICK
                if size > b:
                    y_1 = y_1 * b / size
                    y_2 = y_2 * b / size
                    cells.cell_state[w, pair, m] = SLIP
                defect = wp.max(defect, wp.max(wp.abs(y_1 - t_1), wp.abs(y_2 - t_2)))
            m += wp.block_dim()
        if rubs:
            sums = totals(sums)
        if lane == 0:
            for i in range(6):
                cells.normal_wrench[w, pair, i] = geometry.pair_wrench[w, pair, i]
                geometry.pair_wrench[w, pair, i] = sums[i]
            friction.elastic_energy[w, pair, 1] = sums[6]
            cells.friction_work[w, pair, 0] = sums[7]
        pair += 1
    largest = most(largest)
    defect = most(defect)
    if lane == 0 and largest > real(0.0):
        residuals.gap_defect[w, 0] = wp.max(residuals.gap_defect[w, 0], defect / (largest * TRACTION_SLACK))
