"""End of an attempt with impulsive pairs: rates including them, and the integrator's memory of pairs (see
`impulsive_contact`)."""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.control import Clock
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import EXACT, OUTER, coefficients_of, rule_of
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, Trial
from warpffrf_kernels.core.state import ContactState, FrictionState
from warpffrf_kernels.impulsive.impulsive_contact import kappa_of, mode_share, retained_share, slip_of
from warpffrf_kernels.normal.pair_forces import is_closed, mean_of, modal_place, surface_of, whole

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def filtered(clk: wp.array(dtype=Clock), w: int, rule: int, before: real, after: real, memory: real) -> real:
    """Memory at the end of a usual step of a coordinate that steps by `rule`; for EXACT it is the force."""
    if rule == EXACT:
        return after
    c = coefficients_of(clk, w, rule)
    am = c.alpha_m
    af = c.alpha_f
    return ((real(1.0) - af) * after + af * before - am * memory) / (real(1.0) - am)


@wp.func
def memory_after(
    model: Model, run: Run, w: int, pair: int, rule: int, contact: ContactState, before: real, after: real, memory: real
) -> real:
    """Memory of a component of a pair's force at the end of the attempt. After an impulsive step it is the final force,
    plus the lead of generalized-alpha over it if contact persists."""
    if contact.impulsive[w, pair] == 0:
        return filtered(run.clk, w, rule, before, after, memory)
    if not is_closed(contact.pair_force, w, pair, 1):
        return real(0.0)
    ahead = real(0.0)
    if model.modes.dynamic_count == 0 and is_closed(contact.pair_force, w, pair, 0):
        c = coefficients_of(run.clk, w, rule)
        ahead = (c.alpha_m - c.alpha_f) * (after - before)
    return after + ahead


@kernel
def finish_rates(run: Run, contact: ContactState, impulses: ImpulsiveContact, friction: FrictionState, trial: Trial):
    """Per world: velocities and accelerations of an attempt including the impulsive pairs, and `rest`, the difference
    of its algorithmic accelerations from the formula's."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].mode != k.DYNAMIC:
        return
    part = retained_share(model, run.clk, w)
    kappa = kappa_of(run.clk[w].retained, part)
    slip = slip_of(run.clk[w].h, run.clk[w].retained, part)
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
            if contact.impulsive[w, pair] != 0:
                for i in range(2):
                    surface = surface_of(model, pair, i)
                    if model.surfaces.body[surface] == b:
                        for c in range(6):
                            o = 6 * i + c
                            before = whole(model, contact.pair_force, friction.friction_force, w, pair, 0, o)
                            after = whole(model, contact.pair_force, friction.friction_force, w, pair, 1, o)
                            remembered = whole(model, contact.memory, friction.friction_memory, w, pair, 0, o)
                            kept = memory_after(model, run, w, pair, OUTER, contact, before, after, remembered)
                            mean = mean_of(impulses.theta[w, pair], before, after)
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
        trial.v1[w, b] = trial.v1[w, b] + slip * ease * f
        trial.omega1[w, b] = trial.omega1[w, b] + slip * (soft * t)
        trial.v1_rate[w, b] = trial.v1_rate[w, b] + ease * (f_1 - kappa * f)
        trial.omega1_rate[w, b] = trial.omega1_rate[w, b] + soft * (t_1 - kappa * t)
        impulses.v_rest[w, b] = ease * (f_m - part * f)
        impulses.omega_rest[w, b] = soft * (t_m - part * t)
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        of_mode = mode_share(model, run, w, n)
        rule = rule_of(model, run, w, n)
        own = coefficients_of(run.clk, w, rule)
        rest = real(0.0)
        pair = int(0)
        while pair < model.pairs.count:
            i = modal_place(model, pair, n)
            if contact.impulsive[w, pair] != 0 and i >= 0 and rule != EXACT:  # an exact step requires no correction
                before = whole(model, contact.pair_modal, friction.friction_modal, w, pair, 0, i)
                after = whole(model, contact.pair_modal, friction.friction_modal, w, pair, 1, i)
                remembered = whole(model, contact.modal_memory, friction.modal_friction_memory, w, pair, 0, i)
                mean = mean_of(impulses.theta[w, pair], before, after)
                kept = memory_after(model, run, w, pair, rule, contact, before, after, remembered)
                trial.qd1[w, n] = trial.qd1[w, n] + slip_of(run.clk[w].h, own, of_mode) * mean
                trial.qd1_rate[w, n] = trial.qd1_rate[w, n] + after - kappa_of(own, of_mode) * mean
                rest += kept - of_mode * mean
            pair += 1
        impulses.qd_rest[w, n] = rest
        n += wp.block_dim()


@wp.func
def keep_forces(
    model: Model, run: Run, w: int, pair: int, lane: int, contact: ContactState, force: wp.array4d(dtype=real),
    modal: wp.array4d(dtype=real), memory: wp.array4d(dtype=real), modal_memory: wp.array4d(dtype=real),
):  # fmt: skip
    """Memory of the forces of a pair, and its accepted loads of the modes; `pair_force` defines which are closed."""
    dynamic = run.ctl[w].mode == k.DYNAMIC
    i = lane
    while i < 12:
        kept = force[w, pair, 1, i]  # a start, whose algorithmic accelerations are the true ones
        if dynamic:
            kept = memory_after(model, run, w, pair, OUTER, contact, force[w, pair, 0, i], kept, memory[w, pair, 0, i])
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
                rule = rule_of(model, run, w, model.surfaces.modal_start[surface] + n)
                kept = memory_after(
                    model, run, w, pair, rule, contact, modal[w, pair, 0, o], kept, modal_memory[w, pair, 0, o]
                )
            modal_memory[w, pair, 0, o] = kept
            modal[w, pair, 0, o] = modal[w, pair, 1, o]
            n += wp.block_dim()
        at += model.surfaces.modal_count[surface]


@kernel
def keep_memory(run: Run, contact: ContactState, impulses: ImpulsiveContact, friction: FrictionState):
    """Per (world, pair), lanes over the modes of its bodies: forces, energies and memory of an accepted attempt."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or run.ctl[w].mode == k.PROJECT:
        return
    dynamic = run.ctl[w].mode == k.DYNAMIC
    keep_forces(
        model, run, w, pair, lane, contact, contact.pair_force, contact.pair_modal, contact.memory, contact.modal_memory
    )
    if model.capacity.cells > 0:
        keep_forces(
            model, run, w, pair, lane, contact, friction.friction_force, friction.friction_modal,
            friction.friction_memory, friction.modal_friction_memory,
        )  # fmt: skip
    sync()
    if lane == 0:
        for i in range(12):
            contact.pair_force[w, pair, 0, i] = contact.pair_force[w, pair, 1, i]
            if model.capacity.cells > 0:
                friction.friction_force[w, pair, 0, i] = friction.friction_force[w, pair, 1, i]
        contact.pair_energy[w, pair, 0] = contact.pair_energy[w, pair, 1]
        friction.elastic_energy[w, pair, 0] = friction.elastic_energy[w, pair, 1]
        if dynamic:
            contact.created[w, pair] = contact.created[w, pair] + impulses.created_now[w, pair]
