"""The membrane energy of bodies: the stretch of their fibres of second order in the modes, as squares.

    V4 = 1/2 sum_r e_r^2,      y_r = L_r q,      e_r = q.y_r/2,
    unbalanced force on the modes   sum_r e_r y_r,      tangent   sum_r y_r y_r^T + e_r L_r,

the L_r symmetric forms over the modes of a body that carry inertia, dense unknowns of the retained system (`inertia`).
A square is one form of one body; its y_r is a line of `membrane_slope`. Neither the force nor the first part of the
tangent is ever that of a spring that pushes.
"""

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import share_of_miss
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real
from warpffrf_kernels.core.scratch import Residuals, Trial

wp.set_module_options(MODULE_OPTIONS)


# z[at_z : at_z + n] += a x[at_x : at_x + n] + b y[at_y : at_y + n], by one lane
@wp.func_native("""
    double* __restrict p = z.data + at_z;
    const double* __restrict s = x.data + at_x; const double* __restrict t = y.data + at_y;
    for (int i = 0; i < n; ++i) p[i] += a * s[i] + b * t[i];
""")
def add_lines(
    n: int,
    a: real,
    x: wp.array(dtype=real),
    at_x: int,
    b: real,
    y: wp.array(dtype=real),
    at_y: int,
    z: wp.array(dtype=real),
    at_z: int,
): ...


@wp.func
def slope_line(model: Model, w: int, square: int) -> int:
    """Start of y_r of a square in `membrane_slope`, flat."""
    return w * model.membrane.lines + model.membrane.line_start[square]


@kernel
def stretch_fibres(
    run: Run, q1: wp.array(dtype=real), membrane_slope: wp.array(dtype=real),
    membrane_amplitude: wp.array2d(dtype=real),
):  # fmt: skip
    """Lanes over squares: y_r and e_r."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    s = lane
    while s < model.membrane.count:
        b = model.membrane.body[s]
        count = model.bodies.inertia_count[b]
        modes = w * model.modes.count + model.bodies.modal_start[b]
        line = slope_line(model, w, s)
        i = int(0)
        while i < count:
            membrane_slope[line + i] = real(0.0)
            i += 1
        i = int(0)
        while i < count:  # the form is symmetric: whole lines are added, without dependent sums
            form = model.membrane.table_start[s] + i * count
            axpy(count, q1[modes + i], model.membrane.table, form, membrane_slope, line)
            i += 1
        membrane_amplitude[w, s] = real(0.5) * dot(count, membrane_slope, line, q1, modes)
        s += wp.block_dim()


@kernel
def add_membrane_forces(run: Run, trial: Trial, residuals: Residuals):
    """Lanes over dense modes: unbalanced forces."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    d = lane
    while d < model.dense.count:
        b = model.dense.body[d]
        i = d - model.bodies.dense_start[b]
        if i < model.bodies.inertia_count[b]:
            total = real(0.0)
            s = model.bodies.square_start[b]
            while s < model.bodies.square_start[b + 1]:
                total += trial.membrane_amplitude[w, s] * trial.membrane_slope[slope_line(model, w, s) + i]
                s += 1
            m = model.dense.mode[d]
            residuals.modal_residual[w, m] = residuals.modal_residual[w, m] + total
        d += wp.block_dim()


@kernel
def stiffen_membranes(run: Run, trial: Trial, tangent: wp.array(dtype=real)):
    """Lanes over dense modes: their lines of the tangent, including the mean work (`mean_work`)."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0:
        return
    part = real(0.25) * share_of_miss(run, w)
    d = lane
    N = model.retained.count
    while d < model.dense.count:
        b = model.dense.body[d]
        i = d - model.bodies.dense_start[b]
        count = model.bodies.inertia_count[b]
        if i < count:
            at = (w * N + 6 * model.bodies.count + d) * N + 6 * model.bodies.count + model.bodies.dense_start[b]
            s = model.bodies.square_start[b]
            while s < model.bodies.square_start[b + 1]:
                line = slope_line(model, w, s)
                form = model.membrane.table_start[s] + i * count
                u = trial.membrane_slope[line + i]
                e = trial.membrane_amplitude[w, s]
                if part != real(0.0):
                    u -= part * (u - trial.membrane_slope0[line + i])
                    e -= part * (e - trial.membrane_amplitude0[w, s])
                add_lines(count, u, trial.membrane_slope, line, e, model.membrane.table, form, tangent, at)
                s += 1
        d += wp.block_dim()
