"""The end of an attempt with impulsive pairs: rates with them, and what the integrator remembers of pairs (see
`impulsive_contact`)."""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.integration import EXACT, OUTER, coefficients_of, rule_of
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.impulsive.impulsive_contact import (
    kappa_of,
    mode_share,
    outer_share,
    slip_of,
)
from warpffrf_kernels.normal.pair_forces import is_closed, mean_of, modal_place, surface_of, whole

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def filtered(clk: wp.array(dtype=Clock), w: int, rule: int, before: real, after: real, memory: real) -> real:
    """Memory at the end of a usual step of a coordinate that steps by `rule`; where it steps EXACT it is the force."""
    if rule == EXACT:
        return after
    c = coefficients_of(clk, w, rule)
    am = c.alpha_m
    af = c.alpha_f
    return ((real(1.0) - af) * after + af * before - am * memory) / (real(1.0) - am)


@wp.func
def memory_after(
    model: Model,
    clk: wp.array(dtype=Clock),
    w: int,
    pair: int,
    rule: int,
    impulsive: wp.array2d(dtype=int),
    pair_force: wp.array4d(dtype=real),
    before: real,
    after: real,
    memory: real,
) -> real:
    """Memory of a component of a pair's force at the end of the attempt. After an impulsive step it is the force there,
    and what generalized-alpha is ahead of it by where contact goes on."""
    if impulsive[w, pair] == 0:
        return filtered(clk, w, rule, before, after, memory)
    if not is_closed(pair_force, w, pair, 1):
        return real(0.0)
    ahead = real(0.0)
    if model.modes.dynamic_count == 0 and is_closed(pair_force, w, pair, 0):
        c = coefficients_of(clk, w, rule)
        ahead = (c.alpha_m - c.alpha_f) * (after - before)
    return after + ahead


@wp.kernel
def finish_rates(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    impulsive: wp.array2d(dtype=int),
    theta: wp.array2d(dtype=real),
    pair_force: wp.array4d(dtype=real),
    pair_modal: wp.array4d(dtype=real),
    friction_force: wp.array4d(dtype=real),
    friction_modal: wp.array4d(dtype=real),
    memory: wp.array4d(dtype=real),
    modal_memory: wp.array4d(dtype=real),
    friction_memory: wp.array4d(dtype=real),
    modal_friction_memory: wp.array4d(dtype=real),
    v1: changed(wp.array2d(dtype=vec3)),
    v1_rate: changed(wp.array2d(dtype=vec3)),
    omega1: changed(wp.array2d(dtype=vec3)),
    omega1_rate: changed(wp.array2d(dtype=vec3)),
    qd1: changed(wp.array2d(dtype=real)),
    qd1_rate: changed(wp.array2d(dtype=real)),
    v_rest: out(wp.array2d(dtype=vec3)),
    omega_rest: out(wp.array2d(dtype=vec3)),
    qd_rest: out(wp.array2d(dtype=real)),
):
    """Per world: velocities and accelerations of an attempt with the impulsive pairs in them, and `rest`, what its
    algorithmic accelerations have beside the formula's."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0 or ctl[w].mode != k.DYNAMIC:
        return
    part = outer_share(model, clk, w)
    kappa = kappa_of(clk[w].outer, part)
    slip = slip_of(clk[w].h, clk[w].outer, part)
    zero = vec3(real(0.0), real(0.0), real(0.0))
    b = lane
    while b < model.bodies.count:
        f = zero  # the mean
        t = zero
        f_1 = zero  # at the end
        t_1 = zero
        f_m = zero  # remembered
        t_m = zero
        pair = int(0)
        while pair < model.pairs.count:
            if impulsive[w, pair] != 0:
                for i in range(2):
                    surface = surface_of(model, pair, i)
                    if model.surfaces.body[surface] == b:
                        for c in range(6):
                            o = 6 * i + c
                            before = whole(model, pair_force, friction_force, w, pair, 0, o)
                            after = whole(model, pair_force, friction_force, w, pair, 1, o)
                            remembered = whole(model, memory, friction_memory, w, pair, 0, o)
                            kept = memory_after(
                                model, clk, w, pair, OUTER, impulsive, pair_force, before, after, remembered
                            )
                            mean = mean_of(theta[w, pair], before, after)
                            if c < 3:
                                f[c] = f[c] + mean
                                f_1[c] = f_1[c] + after
                                f_m[c] = f_m[c] + kept
                            else:
                                t[c - 3] = t[c - 3] + mean
                                t_1[c - 3] = t_1[c - 3] + after
                                t_m[c - 3] = t_m[c - 3] + kept
            pair += 1
        ease = real(1.0) / model.bodies.mass[b]
        soft = wp.inverse(model.bodies.inertia[b])
        v1[w, b] = v1[w, b] + slip * ease * f
        omega1[w, b] = omega1[w, b] + slip * (soft * t)
        v1_rate[w, b] = v1_rate[w, b] + ease * (f_1 - kappa * f)
        omega1_rate[w, b] = omega1_rate[w, b] + soft * (t_1 - kappa * t)
        v_rest[w, b] = ease * (f_m - part * f)
        omega_rest[w, b] = soft * (t_m - part * t)
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        of_mode = mode_share(model, ctl, clk, w, n)
        rule = rule_of(model, ctl, clk, w, n)
        own = coefficients_of(clk, w, rule)
        rest = real(0.0)
        pair = int(0)
        while pair < model.pairs.count:
            i = modal_place(model, pair, n)
            if impulsive[w, pair] != 0 and i >= 0 and rule != EXACT:  # an exact step needs no correction
                before = whole(model, pair_modal, friction_modal, w, pair, 0, i)
                after = whole(model, pair_modal, friction_modal, w, pair, 1, i)
                remembered = whole(model, modal_memory, modal_friction_memory, w, pair, 0, i)
                mean = mean_of(theta[w, pair], before, after)
                kept = memory_after(model, clk, w, pair, rule, impulsive, pair_force, before, after, remembered)
                qd1[w, n] = qd1[w, n] + slip_of(clk[w].h, own, of_mode) * mean
                qd1_rate[w, n] = qd1_rate[w, n] + after - kappa_of(own, of_mode) * mean
                rest += kept - of_mode * mean
            pair += 1
        qd_rest[w, n] = rest
        n += wp.block_dim()


@wp.func
def keep_forces(
    model: Model,
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    w: int,
    pair: int,
    lane: int,
    impulsive: wp.array2d(dtype=int),
    pair_force: wp.array4d(dtype=real),
    force: wp.array4d(dtype=real),
    modal: wp.array4d(dtype=real),
    memory: wp.array4d(dtype=real),
    modal_memory: wp.array4d(dtype=real),
):
    """Memory of the forces of a pair, and its accepted loads of the modes; `pair_force` says what is closed."""
    dynamic = ctl[w].mode == k.DYNAMIC
    i = lane
    while i < 12:
        kept = force[w, pair, 1, i]  # a start, whose algorithmic accelerations are the true ones
        if dynamic:
            kept = memory_after(
                model, clk, w, pair, OUTER, impulsive, pair_force, force[w, pair, 0, i], kept,
                memory[w, pair, 0, i],
            )  # fmt: skip
        memory[w, pair, 0, i] = kept
        i += wp.block_dim()
    at = int(0)
    for side in range(2):
        surface = surface_of(model, pair, side)
        n = lane
        while n < model.surfaces.modal_count[surface]:
            o = at + n
            kept = modal[w, pair, 1, o]
            if dynamic:
                rule = rule_of(model, ctl, clk, w, model.surfaces.modal_start[surface] + n)
                kept = memory_after(
                    model, clk, w, pair, rule, impulsive, pair_force, modal[w, pair, 0, o], kept,
                    modal_memory[w, pair, 0, o],
                )  # fmt: skip
            modal_memory[w, pair, 0, o] = kept
            modal[w, pair, 0, o] = modal[w, pair, 1, o]
            n += wp.block_dim()
        at += model.surfaces.modal_count[surface]


@wp.kernel
def keep_memory(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    impulsive: wp.array2d(dtype=int),
    created: wp.array2d(dtype=real),
    pair_force: inout(wp.array4d(dtype=real)),
    pair_modal: inout(wp.array4d(dtype=real)),
    friction_force: inout(wp.array4d(dtype=real)),
    friction_modal: inout(wp.array4d(dtype=real)),
    pair_energy: inout(wp.array3d(dtype=real)),
    elastic_energy: inout(wp.array3d(dtype=real)),
    memory: inout(wp.array4d(dtype=real)),
    modal_memory: inout(wp.array4d(dtype=real)),
    friction_memory: inout(wp.array4d(dtype=real)),
    modal_friction_memory: inout(wp.array4d(dtype=real)),
    created_so_far: inout(wp.array2d(dtype=real)),
):
    """Per (world, pair), lanes over the modes of its bodies: forces, energies and memory of an accepted attempt."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].accept == 0 or ctl[w].mode == k.PROJECT:
        return
    dynamic = ctl[w].mode == k.DYNAMIC
    keep_forces(model, ctl, clk, w, pair, lane, impulsive, pair_force, pair_force, pair_modal, memory, modal_memory)
    if model.capacity.cells > 0:
        keep_forces(
            model, ctl, clk, w, pair, lane, impulsive, pair_force, friction_force, friction_modal, friction_memory,
            modal_friction_memory,
        )  # fmt: skip
    sync()
    if lane == 0:
        for i in range(12):
            pair_force[w, pair, 0, i] = pair_force[w, pair, 1, i]
            if model.capacity.cells > 0:
                friction_force[w, pair, 0, i] = friction_force[w, pair, 1, i]
        pair_energy[w, pair, 0] = pair_energy[w, pair, 1]
        elastic_energy[w, pair, 0] = elastic_energy[w, pair, 1]
        if dynamic:
            created_so_far[w, pair] = created_so_far[w, pair] + created[w, pair]
