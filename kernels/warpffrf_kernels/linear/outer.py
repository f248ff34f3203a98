"""The outer system: rigid coordinates and multipliers, with the global modes condensed.

With `sigma` the diagonal tangent of the modes, J their gradient of the weak gaps, C and C_m the gradients of the rows
by rigid and modal coordinates, r, r_m the residuals and `opened` the weak gaps of the present state, all with the
contact forces of its pressures, the linearised step for the changes dx, dq, dlam, ds reads (x: rigid coordinates and
the modes that are not condensed, see `inertia`, q: the others)

    S dx + C^T dlam - L_r^T ds = -r,            sigma dq + C_m^T dlam - J^T ds = -r_m,
    C dx + C_m dq - E dlam = -c,                opened + L_r dx + J dq + G_local ds = 0 on the active set.

Eliminating dq leaves, for z = (dx, dlam),

    [ S   C^T                       ]         [ -r                      ]
    [ C   -C_m sigma^-1 C_m^T - E   ] z  =    [ -c + C_m sigma^-1 r_m   ]  + L^T ds,      L = [L_r, -J sigma^-1 C_m^T],

    opened - J sigma^-1 r_m + L z + G ds = 0,        G = G_local + J sigma^-1 J^T.

Only the entries that can differ from zero are assembled (`outer_pattern`), in their places of a dense matrix, where
`geometric_stiffness` and `inertia` add theirs. What contact adds is in `contact_solve`, the solution in `outer_solve`.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import compliance, modal_line, pulled, side_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, mat33, real, vec3
from warpffrf_kernels.linear.sparse_factor import Pattern

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def pull(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array(dtype=Control),
    lam: wp.array2d(dtype=real),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    residual: changed(wp.array2d(dtype=real)),
    modal_residual: changed(wp.array(dtype=real)),
):
    """Per world, lanes over bodies, then over modes: r += C^T lambda, over the rows of each body."""
    w, lane = wp.tid()
    model = models[w]
    p = patterns[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    b = lane
    while b < model.bodies.count:
        at = p.row_start[b]
        while at < p.row_start[b + 1]:
            row = p.row[at]
            for i in range(6):
                residual[w, 6 * b + i] = residual[w, 6 * b + i] + C[w, row, 6 * b + i] * lam[w, row]
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
                axpy(count, lam[w, row], C_modal, line, modal_residual, w * model.modes.count + first)
            at += 1
        b += 1


@wp.func
def entry_of_rows(
    model: Model,
    w: int,
    row: int,
    other: int,
    C_modal: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    softness: wp.array2d(dtype=real),
    flexibility: wp.array(dtype=real),
) -> real:
    """-C_m sigma^-1 C_m^T - E of two rows; E couples the rows of a group of springs, else it is diagonal."""
    total = -compliance(model, w, row, other, C_modal, receptance)
    group = model.rows.group[row]
    if group >= 0 and group == model.rows.group[other]:
        first = model.groups.start[group]
        entry = 6 * (row - first) + other - first
        total -= flexibility[(w * model.groups.count + group) * 36 + entry]
    elif other == row:
        total -= softness[w, row]
    return total


@wp.func
def body_of(model: Model, column: int) -> int:
    """The body that an outer unknown is of, a motion or a mode."""
    if column < 6 * model.bodies.count:
        return column / 6
    return model.dense.body[column - 6 * model.bodies.count]


@wp.kernel
def condense(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array(dtype=Control),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    softness: wp.array2d(dtype=real),
    flexibility: wp.array(dtype=real),
    defect: wp.array2d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array(dtype=real),
    tangent: out(wp.array3d(dtype=real)),
    rhs: out(wp.array2d(dtype=real)),
    C_receptance: out(wp.array(dtype=real)),
):
    """Lanes over outer unknowns: rows of the condensed matrix (blocks of bodies are there already), entries of the
    pattern only, and its right-hand side."""
    w, lane = wp.tid()
    model = models[w]
    p = patterns[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    rigid = 6 * model.bodies.count
    i = lane
    while i < model.outer.count:
        row = i - model.outer.row_offset
        if i < rigid:
            rhs[w, i] = -residual[w, i]
        elif row < 0:
            rhs[w, i] = -modal_residual[w * model.modes.count + model.dense.mode[i - rigid]]
        else:
            rhs[w, i] = -defect[w, row] + pulled(model, w, row, C_modal, receptance, modal_residual)
        if ctl[w].refresh != 0:
            if row >= 0:
                for side in range(2):
                    b = side_of(model, row, side)
                    if b >= 0:
                        line = modal_line(model, w, row, b)
                        first = w * model.modes.count + model.bodies.modal_start[b]
                        n = int(0)
                        while n < model.bodies.global_count[b]:
                            C_receptance[line + n] = C_modal[line + n] * receptance[first + n]
                            n += 1
            at = p.entry_start[i]
            while at < p.entry_start[i + 1]:
                j = p.entry_column[at]
                other = j - model.outer.row_offset
                if row < 0 and other < 0:
                    if body_of(model, i) != body_of(model, j):  # geometric stiffness comes later
                        tangent[w, i, j] = real(0.0)
                elif row < 0 or other < 0:
                    line = wp.max(row, other)
                    column = wp.min(i, j)
                    if column < rigid:
                        tangent[w, i, j] = C[w, line, column]
                    else:
                        mode = model.dense.mode[column - rigid]
                        tangent[w, i, j] = C_modal[(w * model.rows.count + line) * model.modes.count + mode]
                else:
                    entry = entry_of_rows(model, w, row, other, C_modal, receptance, softness, flexibility)
                    tangent[w, i, j] = entry
                at += 1
        i += wp.block_dim()


@wp.kernel
def advance_outer(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    z: wp.array(dtype=real),
    psi_inverse: wp.array2d(dtype=mat33),
    dx: inout(wp.array2d(dtype=vec3)),
    psi: inout(wp.array2d(dtype=vec3)),
):
    """Per body: apply the Newton increments once the active set has settled."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    b = lane
    while b < model.bodies.count:
        o = w * model.outer.count + 6 * b
        dx[w, b] = dx[w, b] + vec3(z[o], z[o + 1], z[o + 2])
        psi[w, b] = psi[w, b] + psi_inverse[w, b] * vec3(z[o + 3], z[o + 4], z[o + 5])
        b += wp.block_dim()


@wp.kernel
def advance_rest(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    z: wp.array(dtype=real),
    modal_step: wp.array(dtype=real),
    lam: inout(wp.array2d(dtype=real)),
    dq: inout(wp.array2d(dtype=real)),
):
    """Lanes over rows and modes."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    i = lane
    while i < model.rows.count + model.modes.count:
        if i < model.rows.count:
            lam[w, i] = lam[w, i] + z[w * model.outer.count + model.outer.row_offset + i]
        else:
            n = i - model.rows.count
            dq[w, n] = dq[w, n] + modal_step[w * model.modes.count + n]
        i += wp.block_dim()


@wp.kernel
def find_unbalanced(ctl: wp.array(dtype=Control), any_running: out(wp.array(dtype=int))):
    """One thread for all worlds: whether the iteration of any goes on."""
    running = int(0)
    w = int(0)
    while w < ctl.shape[0]:
        running += ctl[w].run
        w += 1
    any_running[0] = running


@wp.kernel
def count_iteration(
    models: wp.array(dtype=Model),
    ctl: inout(wp.array(dtype=Control)),
    any_running: out(wp.array(dtype=int)),
):
    """One thread for all worlds: bookkeeping of the loop, and its condition."""
    running = int(0)
    w = int(0)
    while w < ctl.shape[0]:
        if ctl[w].run != 0:
            ctl[w].moved = 0
            ctl[w].pending_solves = ctl[w].pending_solves + 1
            ctl[w].inner = ctl[w].inner + 1
            if ctl[w].changes == 0:
                ctl[w].moved = 1
                ctl[w].iteration = ctl[w].iteration + 1
                ctl[w].inner = 0
            elif ctl[w].reassemble != 0:
                ctl[w].moved = 1  # a window was widened: evaluate again, with the pressures found so far
            elif ctl[w].inner >= models[w].limits.max_inner + models[w].limits.max_guarded:
                ctl[w].failure = ctl[w].failure | k.CYCLING
                ctl[w].run = 0
            if ctl[w].failure != 0:
                ctl[w].run = 0
            running += ctl[w].run
        w += 1
    any_running[0] = running
