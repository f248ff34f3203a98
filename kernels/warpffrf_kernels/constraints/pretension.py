"""Pretension: a joint coordinate that is pulled by a given force, and held where it is from some time on.

Each has one row s, a spring row without stiffness. Until it is locked its law is lambda = F(t), which does not ask for
s: in the form of springs (`rows`), multiplied by a softness E,

    C dx - E dlambda = -E (F - lambda),

where C dx should not be. With E SOFT times the compliance of the row it is a millionth of the rest, and an iteration of
Newton's method loses no more than that by it. Locked it is a constraint, s = s_lock, with HELD times its compliance as
softness, which changes no solution and makes the matrix regular where several hold the same (as in `joint_friction`;
HELD_AT_REST in static steps, whose inertia is far below what holds the body).

The attempt that begins at the time `lock_at` or later, and ends later, is the first with s_lock, the value of s where
it begins: so whatever a state is, static or in motion, its length does not jump. If s moves there, locking stops it, as
an impact does, and if it is about to move its acceleration jumps: the attempt and the one after it remember no
accelerations (`joint_friction`), else the force would alternate from step to step.
"""

import warp as wp

from warpffrf_kernels.constraints.joint_friction import HELD, HELD_AT_REST, NOTHING, SOFT, row_compliance
from warpffrf_kernels.constraints.rows import evaluate_signal
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.integration import is_static, is_whole
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)

SAME_TIME = wp.constant(wp.float64(1.0e-9))  # of the step: what sums of steps leave of times that were meant to agree


@wp.kernel
def tighten(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    lam: wp.array2d(dtype=real),
    coordinate: wp.array2d(dtype=real),
    stretch: wp.array2d(dtype=real),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    locked: wp.array2d(dtype=int),
    locked_at: wp.array2d(dtype=real),
    holds: inout(wp.array2d(dtype=int)),
    held_at: inout(wp.array2d(dtype=real)),
    defect: out(wp.array2d(dtype=real)),
    softness: out(wp.array2d(dtype=real)),
):
    """Lanes over pretensions: whether they hold their length in this attempt, and the defect and softness of their
    rows."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    e = lane
    while e < model.elements[0].pretensions.count:
        row = model.elements[0].pretensions.row[e]
        if ctl[w].iteration == 0:
            holds[w, e] = locked[w, e]
            held_at[w, e] = locked_at[w, e]
            lock_at = model.elements[0].pretensions.lock_at[e]
            slack = SAME_TIME * clk[w].h
            steps = is_whole(ctl, w) or ctl[w].mode == k.STATIC
            if locked[w, e] == 0 and steps and clk[w].time >= lock_at - slack and clk[w].next_time > lock_at + slack:
                holds[w, e] = int(1)
                held_at[w, e] = stretch[w, row]
        yields = wp.max(NOTHING, row_compliance(model, clk, w, row, C, C_modal, receptance))
        if holds[w, e] != 0:
            defect[w, row] = coordinate[w, row] - held_at[w, e]
            softness[w, row] = HELD * yields
            if is_static(ctl, w):
                softness[w, row] = HELD_AT_REST * yields
        else:
            force = evaluate_signal(model, model.elements[0].pretensions.signal[e], clk[w].next_time, 0)
            defect[w, row] = SOFT * yields * (force - lam[w, row])
            softness[w, row] = SOFT * yields
        e += wp.block_dim()


@wp.kernel
def stop_lengths(
    models: wp.array(dtype=Model),
    locked: wp.array2d(dtype=int),
    holds: wp.array2d(dtype=int),
    ctl: inout(wp.array(dtype=Control)),
):
    """Per world: an attempt that locks a length asks to be one that forgets, and the next with it."""
    w = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0 or ctl[w].mode != k.DYNAMIC:
        return
    e = int(0)
    while e < model.elements[0].pretensions.count:
        if holds[w, e] != locked[w, e]:
            ctl[w].turned = 1
        e += 1


@wp.kernel
def keep_lengths(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    holds: wp.array2d(dtype=int),
    held_at: wp.array2d(dtype=real),
    locked: out(wp.array2d(dtype=int)),
    locked_at: out(wp.array2d(dtype=real)),
):
    """Lanes over pretensions: what an accepted attempt has locked."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].accept == 0:
        return
    e = lane
    while e < model.elements[0].pretensions.count:
        locked[w, e] = holds[w, e]
        locked_at[w, e] = held_at[w, e]
        e += wp.block_dim()
