r"""Moments of lumped contacts: resistance to rolling, and to pivoting about the normal.

At a point with the force F along its normal n, where body 1 rotates relative to body 2 with omega = omega_1 - omega_2,

    omega_r = omega - (n . omega) n,      omega_s = (n . omega) n        (rolling, pivoting)
    M = -m_r(|omega_r|) omega_r/|omega_r| - m_s(|omega_s|) omega_s/|omega_s|        on body 1, -M on body 2,

each with a linear rise from rest up to a bound,

    m(w) = min(c F^p, d F^q w).

c, p, d and q are those of the contact (`warpffrf.model.moments`): a lever e has c = e, p = 1. Neither moment has a
potential or a history; the power -M . omega = sum m w >= 0 is booked as friction, a mean of both ends of a step. Like
regularised friction they are evaluated at the velocities at the end of the step. In static steps there is no rotation,
and both are zero.

If an iteration moves a part from its bound past rest to the opposite bound, the next one would move it back, and so on:
in that case the moment follows its slope for one iteration, which leads to the solution. The first iteration includes
the bound, unlike that of friction (`forces`): rolling elements are at it all the time, and a moment without bound would
require more friction than available.

**Tangent.** With dF, dn and d(omega) of a small motion from `forces`,

    d(omega_r) = T d(omega) - (n . omega) dn - (dn . omega) n,      T = 1 - n n^T,
    d(omega_s) = (dn . omega + n . d(omega)) n + (n . omega) dn,

and for each part w e = omega_x: below the bound dM = -d (q F^(q-1) dF omega_x + F^q d(omega_x)), at it dM = -c (p
F^(p-1) dF e + F^p/w (1 - e e^T) d(omega_x)).
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.cone import change_at_bound
from warpffrf_kernels.core.contact_scratch import LumpedContacts
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import LumpedState
from warpffrf_kernels.lumped.forces import RUBBED, Load, tangential

wp.set_module_options(MODULE_OPTIONS)

ROLLING = wp.constant(0)
PIVOTING = wp.constant(1)


@wp.struct
class Moment:
    """Moment on the first body at a point, and data of its tangent: omega, and which parts are at their bound."""

    total: vec3
    turning: vec3
    rolls_on: int
    pivots_on: int


@wp.func
def part_of(turning: vec3, n: vec3, kind: int) -> vec3:
    """omega_r or omega_s."""
    if kind == ROLLING:
        return tangential(n, turning)
    return wp.dot(n, turning) * n


@wp.func
def bound_of(model: Model, i: int, kind: int, force: real) -> real:
    """c F^p [N m]."""
    power = model.elements[0].moments.bound_power[i, kind]
    return model.elements[0].moments.bound[i, kind] * wp.pow(force, power)


@wp.func
def slope_of(model: Model, i: int, kind: int, force: real) -> real:
    """d F^q [N m s/rad]."""
    power = model.elements[0].moments.slope_power[i, kind]
    return model.elements[0].moments.slope[i, kind] * wp.pow(force, power)


@kernel
def find_moments(
    run: Run, trial: Trial, lumped: LumpedState, lumps: LumpedContacts, lumped_load: wp.array2d(dtype=Load),
    lumped_moment: wp.array2d(dtype=Moment),
):  # fmt: skip
    """Per (world, point with moments): moments at the trial state, and their dissipation."""
    w, i = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    place = model.elements[0].moments.place[i]
    contact = model.elements[0].lumped.contact[place]
    load = lumped_load[w, place]
    before = lumped_moment[w, i]  # of the last iteration
    out = Moment()
    one = model.surfaces.body[model.elements[0].lumped.first[contact]]
    two = model.surfaces.body[model.elements[0].lumped.second[contact]]
    if one >= 0:
        out.turning = trial.axes[w, one] * trial.omega1[w, one]
    if two >= 0:
        out.turning = out.turning - trial.axes[w, two] * trial.omega1[w, two]
    if load.force > real(0.0) and run.ctl[w].mode != k.STATIC:
        for kind in range(2):
            part = part_of(out.turning, load.touch.n, kind)
            speed = wp.length(part)
            slope = slope_of(model, i, kind, load.force)
            bound = bound_of(model, i, kind, load.force)
            beyond = before.rolls_on
            if kind == PIVOTING:
                beyond = before.pivots_on
            past = run.ctl[w].iteration > 0 and beyond != 0
            past = past and wp.dot(part, part_of(before.turning, load.touch.n, kind)) < real(0.0)
            if slope * speed > bound and not past:
                slope = bound / speed
                if kind == ROLLING:
                    out.rolls_on = 1
                else:
                    out.pivots_on = 1
            out.total = out.total - slope * part
    power = -wp.dot(out.total, out.turning)
    lumped.lumped_power[w, 1, place, RUBBED] = lumped.lumped_power[w, 1, place, RUBBED] + power
    if run.ctl[w].mode != k.LOADING:  # there are no velocities
        lumps.lumped_taken[w, place, RUBBED] = lumps.lumped_taken[w, place, RUBBED] + real(0.5) * run.clk[w].h * power
    lumped_moment[w, i] = out


@wp.func
def change_of(model: Model, i: int, load: Load, moment: Moment, force: real, n: vec3, turning: vec3) -> vec3:
    """dM on the first body due to dF, dn and d(omega)."""
    total = vec3(real(0.0))
    pivoting = wp.dot(load.touch.n, moment.turning)
    along = wp.dot(n, moment.turning)
    for kind in range(2):
        part = part_of(moment.turning, load.touch.n, kind)
        change = tangential(load.touch.n, turning) - pivoting * n - along * load.touch.n
        beyond = moment.rolls_on
        if kind == PIVOTING:
            change = (along + wp.dot(load.touch.n, turning)) * load.touch.n + pivoting * n
            beyond = moment.pivots_on
        if beyond == 0:
            slope = slope_of(model, i, kind, load.force)
            power = model.elements[0].moments.slope_power[i, kind]
            total -= slope * (change + (power * force / load.force) * part)
        else:
            bound = bound_of(model, i, kind, load.force)
            power = model.elements[0].moments.bound_power[i, kind]
            total -= change_at_bound(part, bound, change, bound * power * force / load.force)
    return total
