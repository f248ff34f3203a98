"""The retained system: rigid coordinates and multipliers, with the global modes condensed.

With `sigma` the diagonal tangent of the modes, J their gradient of the weak gaps, C and C_m the gradients of the rows
with respect to rigid and modal coordinates, r, r_m the residuals and `opened` the weak gaps of the present state, all
with the contact forces of its pressures, the linearised step for the changes dx, dq, dlam, ds reads (x: rigid
coordinates and the modes that are not condensed, see `inertia`, q: the others)

    S dx + C^T dlam - L_r^T ds = -r,            sigma dq + C_m^T dlam - J^T ds = -r_m,
    C dx + C_m dq - E dlam = -c,                opened + L_r dx + J dq + G_local ds = 0 on the active set.

Eliminating dq leaves, for z = (dx, dlam),

    [ S   C^T                       ]         [ -r                      ]
    [ C   -C_m sigma^-1 C_m^T - E   ] z  =    [ -c + C_m sigma^-1 r_m   ]  + L^T ds,      L = [L_r, -J sigma^-1 C_m^T],

    opened - J sigma^-1 r_m + L z + G ds = 0,        G = G_local + J sigma^-1 J^T.

Only the structurally nonzero entries are assembled (`retained_pattern`), at their positions in a dense matrix, to which
`geometric_stiffness` and `inertia` add theirs. The contribution of contact is in `contact_solve`, the solution in
`retained_solve`.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import compliance, modal_line, pulled, side_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lanes import most
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, vec3
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import LoadState
from warpffrf_kernels.linear.sparse_factor import Pattern

wp.set_module_options(MODULE_OPTIONS)


@kernel
def pull(
    run: Run, loads: LoadState, residuals: Residuals, patterns: wp.array(dtype=Pattern),
    modal_residual: wp.array(dtype=real),
):  # fmt: skip
    """Per world, lanes over bodies, then over modes: r += C^T lambda, over the rows of each body."""
    w, lane = wp.tid()
    model = run.models[w]
    p = patterns[0]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    b = lane
    while b < model.bodies.count:
        at = p.row_start[b]
        while at < p.row_start[b + 1]:
            row = p.row[at]
            for i in range(6):
                residuals.residual[w, 6 * b + i] = (
                    residuals.residual[w, 6 * b + i] + residuals.C[w, row, 6 * b + i] * loads.lam[w, row]
                )
            at += 1
        b += wp.block_dim()
    b = int(0)
    while b < model.bodies.count:  # lanes over the modes of each body, which are contiguous
        at = p.row_start[b]
        first = model.bodies.modal_start[b]
        count = model.bodies.global_count[b]
        while at < p.row_start[b + 1]:
            if p.row_flexible[at] != 0:
                row = p.row[at]
                line = (w * model.rows.count + row) * model.modes.count + first
                axpy(count, loads.lam[w, row], residuals.C_modal, line, modal_residual, w * model.modes.count + first)
            at += 1
        b += 1


@wp.func
def entry_of_rows(model: Model, w: int, row: int, other: int, residuals: Residuals) -> real:
    """-C_m sigma^-1 C_m^T - E of two rows; E couples the rows of a group of springs, else it is diagonal."""
    total = -compliance(model, w, row, other, residuals)
    group = model.rows.group[row]
    if group >= 0 and group == model.rows.group[other]:
        first = model.groups.start[group]
        entry = 6 * (row - first) + other - first
        total -= residuals.flexibility[(w * model.groups.count + group) * 36 + entry]
    elif other == row:
        total -= residuals.softness[w, row]
    return total


@wp.func
def body_of(model: Model, column: int) -> int:
    """Body of a retained unknown, a motion or a mode."""
    if column < 6 * model.bodies.count:
        return column / 6
    return model.dense.body[column - 6 * model.bodies.count]


@kernel
def condense(
    run: Run, residuals: Residuals, system: RetainedSystem, patterns: wp.array(dtype=Pattern),
    modal_residual: wp.array(dtype=real),
):  # fmt: skip
    """Lanes over retained unknowns: rows of the condensed matrix (the blocks of bodies are assembled before), entries
    of the pattern only, and its right-hand side."""
    w, lane = wp.tid()
    model = run.models[w]
    p = patterns[0]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    rigid = 6 * model.bodies.count
    i = lane
    while i < model.retained.count:
        row = i - model.retained.row_offset
        if i < rigid:
            system.rhs[w, i] = -residuals.residual[w, i]
        elif row < 0:
            system.rhs[w, i] = -modal_residual[w * model.modes.count + model.dense.mode[i - rigid]]
        else:
            system.rhs[w, i] = -residuals.defect[w, row] + pulled(model, w, row, residuals, modal_residual)
        if run.ctl[w].refresh != 0:
            if row >= 0:
                for side in range(2):
                    b = side_of(model, row, side)
                    if b >= 0:
                        line = modal_line(model, w, row, b)
                        first = w * model.modes.count + model.bodies.modal_start[b]
                        n = int(0)
                        while n < model.bodies.global_count[b]:
                            system.C_receptance[line + n] = (
                                residuals.C_modal[line + n] * residuals.receptance[first + n]
                            )
                            n += 1
            at = p.entry_start[i]
            while at < p.entry_start[i + 1]:
                j = p.entry_column[at]
                other = j - model.retained.row_offset
                if row < 0 and other < 0:
                    if body_of(model, i) != body_of(model, j):  # geometric stiffness is added later
                        system.tangent[w, i, j] = real(0.0)
                elif row < 0 or other < 0:
                    line = wp.max(row, other)
                    column = wp.min(i, j)
                    if column < rigid:
                        system.tangent[w, i, j] = residuals.C[w, line, column]
                    else:
                        mode = model.dense.mode[column - rigid]
                        system.tangent[w, i, j] = residuals.C_modal[
                            (w * model.rows.count + line) * model.modes.count + mode
                        ]
                else:
                    entry = entry_of_rows(model, w, row, other, residuals)
                    system.tangent[w, i, j] = entry
                at += 1
        i += wp.block_dim()


@kernel
def advance_retained(run: Run, system: RetainedSystem, trial: Trial):
    """Per body: apply the Newton increments once the active set has converged."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    b = lane
    while b < model.bodies.count:
        o = w * model.retained.count + 6 * b
        trial.dx[w, b] = trial.dx[w, b] + vec3(system.z[o], system.z[o + 1], system.z[o + 2])
        trial.psi[w, b] = trial.psi[w, b] + trial.psi_inverse[w, b] * vec3(
            system.z[o + 3], system.z[o + 4], system.z[o + 5]
        )
        b += wp.block_dim()


@kernel
def advance_rest(run: Run, system: RetainedSystem, loads: LoadState, trial: Trial):
    """Lanes over rows and modes."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    i = lane
    while i < model.rows.count + model.modes.count:
        if i < model.rows.count:
            loads.lam[w, i] = loads.lam[w, i] + system.z[w * model.retained.count + model.retained.row_offset + i]
        else:
            n = i - model.rows.count
            trial.dq[w, n] = trial.dq[w, n] + system.modal_step[w * model.modes.count + n]
        i += wp.block_dim()


@kernel
def find_unbalanced(run: Run):
    """Lanes over all worlds: whether the iteration of any world continues."""
    one, lane = wp.tid()
    running = real(0.0)
    w = lane
    while w < run.ctl.shape[0]:
        running = wp.max(running, real(run.ctl[w].run))
        w += wp.block_dim()
    running = most(running)
    if lane == 0:
        run.running[0] = int(running)


@kernel
def count_iteration(run: Run):
    """Lanes over all worlds: iteration counters, and the condition of the loop."""
    one, lane = wp.tid()
    running = real(0.0)
    w = lane
    while w < run.ctl.shape[0]:
        if run.ctl[w].run != 0:
            run.ctl[w].moved = 0
            run.ctl[w].pending_solves = run.ctl[w].pending_solves + 1
            run.ctl[w].inner = run.ctl[w].inner + 1
            if run.ctl[w].changes == 0:
                run.ctl[w].moved = 1
                run.ctl[w].iteration = run.ctl[w].iteration + 1
                run.ctl[w].inner = 0
            elif run.ctl[w].reassemble != 0:
                run.ctl[w].moved = 1  # a window was widened: evaluate again, with the current pressures
            elif run.ctl[w].inner >= run.models[w].limits.max_inner + run.models[w].limits.max_guarded:
                run.ctl[w].failure = run.ctl[w].failure | k.CYCLING
                run.ctl[w].run = 0
            if run.ctl[w].failure != 0:
                run.ctl[w].run = 0
            running = wp.max(running, real(run.ctl[w].run))
        w += wp.block_dim()
    running = most(running)
    if lane == 0:
        run.running[0] = int(running)
