"""Pretension: a joint coordinate pulled by a given force, and locked at its current value from a given time on.

Each has one row s, a spring row without stiffness. Until it is locked its law is lambda = F(t), independent of s: in
the form of springs (`rows`), multiplied by a softness E,

    C dx - E dlambda = -E (F - lambda),

where C dx should be absent. With E SOFT times the compliance of the row it is a millionth of the rest, which is also
the relative error of an iteration of Newton's method. When locked it is a constraint, s = s_lock, with HELD times its
compliance as softness, which changes no solution and makes the matrix regular if several rows constrain the same
coordinate (as in `joint_friction`; HELD_AT_REST in static steps, whose inertia is far below the stiffness that
constrains the body).

The attempt that begins at the time `lock_at` or later, and ends later, is the first with s_lock, the value of s at its
start: so in any state, static or in motion, the length does not jump. If s moves there, locking stops it like an
impact, and if it is about to move its acceleration jumps: the attempt and the next one use no old accelerations
(`joint_friction`), otherwise the force would alternate from step to step.
"""

import warp as wp

from warpffrf_kernels.constraints.joint_friction import HELD, HELD_AT_REST, NOTHING, SOFT, row_compliance
from warpffrf_kernels.constraints.rows import evaluate_signal
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import is_static, is_whole
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS
from warpffrf_kernels.core.scratch import Residuals
from warpffrf_kernels.core.state import LoadState, PretensionState

wp.set_module_options(MODULE_OPTIONS)

SAME_TIME = wp.constant(wp.float64(1.0e-9))  # of the step: accumulated round-off of times that should agree


@kernel
def tighten(run: Run, loads: LoadState, residuals: Residuals, pretension: PretensionState):
    """Lanes over pretensions: whether they are locked in this attempt, and the defect and softness of their rows."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    e = lane
    while e < model.elements[0].pretensions.count:
        row = model.elements[0].pretensions.row[e]
        if run.ctl[w].iteration == 0:
            residuals.holds[w, e] = pretension.locked[w, e]
            residuals.held_at[w, e] = pretension.locked_at[w, e]
            lock_at = model.elements[0].pretensions.lock_at[e]
            slack = SAME_TIME * run.clk[w].h
            steps = is_whole(run.ctl, w) or run.ctl[w].mode == k.STATIC
            if (
                pretension.locked[w, e] == 0
                and steps
                and run.clk[w].time >= lock_at - slack
                and run.clk[w].next_time > lock_at + slack
            ):
                residuals.holds[w, e] = int(1)
                residuals.held_at[w, e] = loads.stretch[w, row]
        yields = wp.max(NOTHING, row_compliance(model, run, w, row, residuals))
        if residuals.holds[w, e] != 0:
            residuals.defect[w, row] = residuals.coordinate[w, row] - residuals.held_at[w, e]
            residuals.softness[w, row] = HELD * yields
            if is_static(run.ctl, w):
                residuals.softness[w, row] = HELD_AT_REST * yields
        else:
            force = evaluate_signal(model, model.elements[0].pretensions.signal[e], run.clk[w].next_time, 0)
            residuals.defect[w, row] = SOFT * yields * (force - loads.lam[w, row])
            residuals.softness[w, row] = SOFT * yields
        e += wp.block_dim()


@kernel
def stop_lengths(run: Run, pretension: PretensionState, residuals: Residuals):
    """Per world: an attempt that locks a length requires steps without old accelerations, itself and the next."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].mode != k.DYNAMIC:
        return
    e = int(0)
    while e < model.elements[0].pretensions.count:
        if residuals.holds[w, e] != pretension.locked[w, e]:
            run.ctl[w].friction_changed = 1
        e += 1


@kernel
def keep_lengths(run: Run, residuals: Residuals, pretension: PretensionState):
    """Lanes over pretensions: stores the lengths that an accepted attempt has locked."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0:
        return
    e = lane
    while e < model.elements[0].pretensions.count:
        pretension.locked[w, e] = residuals.holds[w, e]
        pretension.locked_at[w, e] = residuals.held_at[w, e]
        e += wp.block_dim()
