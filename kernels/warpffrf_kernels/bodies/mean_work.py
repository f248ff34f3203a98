r"""Forces along quadratic coordinates, whose mean over a step does the work of their potential exactly.

A coordinate c(q) = a.q + q.B q/2 with gradient g = a + B q, and a force f along it, load the modes with f g. Over a
step from q_0 to q_1, with d = q_1 - q_0,

    c_1 - c_0 = (g_0 + g_1)/2 . d,

so that the force (f_0 + f_1)/2 (g_0 + g_1)/2 does the work (f_0 + f_1)/2 (c_1 - c_0): the change of c^2/2 if f = c (the
squares of the membrane energy, c = e_r, g = y_r), that of the energy of a linear spring, and zero if a joint constrains
c. It is a discrete gradient (O. Gonzalez, J. Nonlinear Sci. 6, 1996) in closed form, since only quadratic coordinates
occur. The mean of the forces themselves, which the integrator uses, differs from it by

    C = (f_0 + f_1)/2 (g_0 + g_1)/2 - (f_0 g_0 + f_1 g_1)/2 = -(f_1 - f_0) (g_1 - g_0)/4,

of second order in the step: without C the energy of a plate that vibrates at twice its thickness oscillates by some per
cent at thirty steps per period.

**Modified step.** A force Y, and the corresponding y in the algorithmic acceleration, are added so that the mean of the
increment of velocity, v_1 - v_0 = h ((1 - gamma) a_0 + gamma a_1), contains C (`motion`):

    (1 - gamma) y_0 + gamma y_1 = C,      (1 - alpha_f) Y_1 + alpha_f Y_0 = (1 - alpha_m) y_1 + alpha_m y_0.

If the method uses the mean of the forces at both ends (generalized-alpha with rho_inf = 1, the trapezoidal rule), d = h
(v_0 + v_1)/2, and the energy of a body without gyroscopic terms is conserved to the tolerance of the iteration. If it
dissipates, the gain is the oscillating error of a linear oscillator.

The coordinates here are those of bodies stiffened by loads: the squares of the membrane energy, and the motion of
interfaces under the forces of rows (joints, drives, springs). Other nonlinear terms, above all rotation, and applied
forces that change are integrated without this correction. The tangent of Y_1 makes u_r y_r^T + s_r L_r of y_r y_r^T +
e_r L_r, u = y_1 - KAPPA (y_1 - y_0)/4 and s alike, KAPPA = dY_1/dC; for interfaces it contains the part due to
multipliers.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import line_of, marker_of
from warpffrf_kernels.bodies.membrane import slope_line
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import share_of_miss
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import LoadState

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def pull_of_rows(model: Model, w: int, interface: int, c: int, loads: LoadState, residuals: Residuals) -> real:
    """Component c of the load of all rows on an interface, body axes."""
    total = real(0.0)
    row = int(0)
    while row < model.rows.count:
        for side in range(2):
            if model.markers.interface[marker_of(model, row, side)] == interface:
                total += loads.lam[w, row] * residuals.row_pull[w, 2 * row + side, c]
        row += 1
    return total


@kernel
def change_pulls(run: Run, loads: LoadState, residuals: Residuals, trial: Trial):
    """Lanes over interfaces: change of their row loads in the attempt."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    f = lane
    while f < model.interfaces.count:
        for c in range(6):
            trial.pull_change[w, f, c] = pull_of_rows(model, w, f, c, loads, residuals) - loads.interface_pull[w, f, c]
        f += wp.block_dim()


@kernel
def add_mean_work(run: Run, trial: Trial, loads: LoadState, residuals: Residuals):
    """Lanes over dense modes: y_1 and Y_1, and Y_1 added to the unbalanced forces; only in time steps that use old
    accelerations."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    rule = run.clk[w].retained
    one = real(1.0)
    quarter = real(0.25)
    whole = share_of_miss(run, w) != real(0.0)
    d = lane
    while d < model.dense.count:
        b = model.dense.body[d]
        i = d - model.bodies.dense_start[b]
        trial.lag1[w, 0, d] = real(0.0)
        trial.lag1[w, 1, d] = real(0.0)
        if whole and i < model.bodies.inertia_count[b]:
            miss = real(0.0)
            s = model.bodies.square_start[b]
            while s < model.bodies.square_start[b + 1]:
                at = slope_line(model, w, s) + i
                change = trial.membrane_amplitude[w, s] - trial.membrane_amplitude0[w, s]
                miss -= quarter * change * (trial.membrane_slope[at] - trial.membrane_slope0[at])
                s += 1
            f = int(0)
            while f < model.interfaces.count:
                if model.interfaces.body[f] == b and model.interfaces.stiffening_start[f] >= 0:
                    for c in range(6):
                        at = line_of(model, w, f) + c * model.interfaces.width + i
                        miss -= quarter * trial.pull_change[w, f, c] * (trial.slope[at] - trial.slope0[at])
                f += 1
            old = loads.lag[w, 0, d]
            if run.ctl[w].trapezoidal != 0:  # from the true accelerations
                old = loads.lag[w, 1, d]
            new = (miss - (one - rule.gamma) * old) / rule.gamma
            force = (one - rule.alpha_m) * new + rule.alpha_m * old - rule.alpha_f * loads.lag[w, 1, d]
            trial.lag1[w, 0, d] = new
            trial.lag1[w, 1, d] = force / (one - rule.alpha_f)
            m = model.dense.mode[d]
            residuals.modal_residual[w, m] = residuals.modal_residual[w, m] + trial.lag1[w, 1, d]
        d += wp.block_dim()


@kernel
def couple_pulls(run: Run, trial: Trial, residuals: Residuals, system: RetainedSystem):
    """Lanes over dense modes: dY_1 with respect to the multipliers of rows."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0:
        return
    part = real(0.25) * share_of_miss(run, w)
    d = lane
    while part != real(0.0) and d < model.dense.count:
        b = model.dense.body[d]
        i = d - model.bodies.dense_start[b]
        row = int(0)
        while row < model.rows.count and i < model.bodies.inertia_count[b]:
            total = real(0.0)
            for side in range(2):
                marker = marker_of(model, row, side)
                f = model.markers.interface[marker]
                if f >= 0 and model.markers.body[marker] == b and model.interfaces.stiffening_start[f] >= 0:
                    for c in range(6):
                        pull = residuals.row_pull[w, 2 * row + side, c]
                        if pull != real(0.0):  # most are zero along the axes of the body
                            at = line_of(model, w, f) + c * model.interfaces.width + i
                            total += pull * (trial.slope[at] - trial.slope0[at])
            if total != real(0.0):
                line = 6 * model.bodies.count + d
                column = model.retained.row_offset + row
                system.tangent[w, line, column] = system.tangent[w, line, column] - part * total
            row += 1
        d += wp.block_dim()


@kernel
def keep_lags(run: Run, trial: Trial, loads: LoadState):
    """Lanes over dense modes: y and Y of an accepted attempt."""
    w, lane = wp.tid()
    if run.ctl[w].accept == 0 or run.ctl[w].mode == k.PROJECT:
        return
    d = lane
    while d < loads.lag.shape[2]:
        for i in range(2):
            loads.lag[w, i, d] = trial.lag1[w, i, d]
        d += wp.block_dim()


@kernel
def keep_pulls(run: Run, loads: LoadState, residuals: Residuals):
    """Lanes over interfaces: load of the rows at the end of an accepted attempt."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or run.ctl[w].mode == k.PROJECT:
        return
    f = lane
    while f < model.interfaces.count:
        for c in range(6):
            loads.interface_pull[w, f, c] = pull_of_rows(model, w, f, c, loads, residuals)
        f += wp.block_dim()
