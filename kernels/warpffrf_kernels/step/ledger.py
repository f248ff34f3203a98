"""The energy ledger of an attempt.

With E the energy of the state (kinetic, strain of the modes, contact of pairs and lumped, potential of gravity and
springs) every step books

    work of forces    sum (F_0 + F_1)/2 . (x_1 - x_0)           drive   -(lambda_0 + lambda_1)/2 (s_1 - s_0)
                      and of pretensions -(lambda_0 + lambda_1)/2 (c_1 - c_0), in static steps -lambda_1 (c_1 - c_0)
    damping           sum c (x_1 - x_0)^2/h of dampers and modal damping, never negative: what the trapezoidal rule
                      takes at any step; of dampers with a characteristic G, (G(v_0) + G(v_1))/2 (x_1 - x_0), which
                      is that too, in steps that forget G(v_1) (x_1 - x_0); what damped layers take
    friction          sum tau_1 . S: the tractions at the end of the step times the slip over it, never positive;
                      what joints (`joint_friction`), lumped contacts, films and laps lose by friction
    contact grid      dE_contact of pairs + (work of their forces on bodies and modes, trapezoidal; of pairs that are
                      impulsive in the step of their mean force) - friction
    numerical         what is left of dE: negative where the integrator dissipates.

A load step (`proximal`) books like a step in time, but for damping, of which it has none; its numerical line is what
the trapezoidal rule errs by over the step. A start, and a step towards a first static state, open the books.

A proximal step towards a static state must not end higher than it began, dE no more than the work of forces: Newton's
method would go to a maximum as well as to a minimum. Of a load step it is the work of the loads at its end, under which
the new equilibrium lies lower than the old one.
"""

import warp as wp

from warpffrf_kernels.constraints.characteristics import characteristic
from warpffrf_kernels.constraints.forces import group_energy
from warpffrf_kernels.constraints.rows import evaluate_signal
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.integration import is_static
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.lumped.forces import DAMPED, RUBBED
from warpffrf_kernels.normal.pair_forces import mean_of, pair_work

wp.set_module_options(MODULE_OPTIONS)

STILL = wp.constant(
    wp.float64(1.0e-12)
)  # of the largest force times the scene's length: what round-off of places works
# of the inertia of a proximal step that goes through the whole scene: where nothing acts, round-off works less
IDLE = wp.constant(wp.float64(1.0e-14))
UNSEEN = wp.constant(wp.float64(1.0e-8))  # of the energies: what joints work that close to the tolerance of 1e-9


@wp.kernel
def balance_energy(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    v1: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
    q1: wp.array2d(dtype=real),
    qd1: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
    lam0: wp.array2d(dtype=real),
    lam: wp.array2d(dtype=real),
    coordinate: wp.array2d(dtype=real),
    stretch: wp.array2d(dtype=real),
    drive_rate: wp.array3d(dtype=real),
    applied: wp.array3d(dtype=vec3),
    applied_at: wp.array3d(dtype=vec3),
    load: wp.array3d(dtype=real),
    load_on_modes: wp.array3d(dtype=real),
    impulsive: wp.array2d(dtype=int),
    theta: wp.array2d(dtype=real),
    pair_force: wp.array4d(dtype=real),
    pair_modal: wp.array4d(dtype=real),
    friction_force: wp.array4d(dtype=real),
    friction_modal: wp.array4d(dtype=real),
    pair_energy: wp.array3d(dtype=real),
    elastic_energy: wp.array3d(dtype=real),
    pair_loss: wp.array2d(dtype=real),
    extra_energy: wp.array2d(dtype=real),
    membrane_amplitude: wp.array2d(dtype=real),
    friction_work: wp.array3d(dtype=real),
    slip_loss: wp.array2d(dtype=real),
    lumped_energy: wp.array3d(dtype=real),
    lumped_taken: wp.array3d(dtype=real),
    film_energy: wp.array3d(dtype=real),
    film_taken: wp.array3d(dtype=real),
    lap_energy: wp.array2d(dtype=real),
    lap_stored: wp.array2d(dtype=real),
    lap_taken: wp.array3d(dtype=real),
    clk: inout(wp.array(dtype=Clock)),
    energy: inout(wp.array3d(dtype=real)),
):
    """Per world: the ledger of the trial state, energy[w, 1], from that of the accepted one, energy[w, 0]; of a static
    step whether it went downhill, `RISE`."""
    w = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0:
        return
    half = real(0.5)
    h = clk[w].h
    kinetic = real(0.0)
    strain = real(0.0)
    potential = real(0.0)
    damping = real(0.0)
    force_work = real(0.0)
    last_work = real(0.0)  # of the loads at the end
    drive_work = real(0.0)
    held_work = real(0.0)
    contact_work = real(0.0)
    heaviest = real(0.0)
    b = int(0)
    while b < model.bodies.count:
        heaviest = wp.max(heaviest, model.bodies.mass[b])
        kinetic += half * model.bodies.mass[b] * wp.dot(v1[w, b], v1[w, b])
        kinetic += half * wp.dot(omega1[w, b], model.bodies.inertia[b] * omega1[w, b]) + extra_energy[w, b]
        potential -= model.bodies.mass[b] * wp.dot(model.gravity, r1[w, b])
        for c in range(3):
            force_work += half * (load[w, 0, 6 * b + c] + load[w, 1, 6 * b + c]) * dx[w, b][c]
            force_work += half * (load[w, 0, 6 * b + 3 + c] + load[w, 1, 6 * b + 3 + c]) * psi[w, b][c]
            last_work += load[w, 1, 6 * b + c] * dx[w, b][c] + load[w, 1, 6 * b + 3 + c] * psi[w, b][c]
        b += 1
    n = int(0)
    while n < model.modes.count:
        kinetic += half * qd1[w, n] * qd1[w, n]
        strain += half * model.modes.stiffness[n] * q1[w, n] * q1[w, n]
        damping += model.modes.damping[n] * dq[w, n] * dq[w, n] / h
        force_work += half * (load_on_modes[w, 0, n] + load_on_modes[w, 1, n]) * dq[w, n]
        last_work += load_on_modes[w, 1, n] * dq[w, n]
        n += 1
    square = int(0)
    while square < model.membrane.count:
        strain += half * membrane_amplitude[w, square] * membrane_amplitude[w, square]
        square += 1
    row = int(0)
    while row < model.rows.count:
        if model.rows.rigid[row] == 0:
            change = coordinate[w, row] - model.rows.reference[row]
            potential += half * model.rows.stiffness[row] * change * change + model.rows.preload[row] * change
            step = coordinate[w, row] - stretch[w, row]
            damping += model.rows.damping[row] * step * step / h
            if model.rows.elastic[row] >= 0:
                potential += characteristic(model, model.rows.elastic[row], change)[2]
            if model.rows.viscous[row] >= 0:
                drag = characteristic(model, model.rows.viscous[row], drive_rate[w, 1, row])[0]
                drag_before = drag
                if ctl[w].forget == 0:
                    drag_before = characteristic(model, model.rows.viscous[row], drive_rate[w, 0, row])[0]
                damping += half * (drag_before + drag) * step
        else:
            held_work -= half * (lam0[w, row] + lam[w, row]) * (coordinate[w, row] - stretch[w, row])
        if model.rows.rigid[row] != 0 and model.rows.signal[row] >= 0:
            s0 = evaluate_signal(model, model.rows.signal[row], clk[w].time, 0)
            s1 = evaluate_signal(model, model.rows.signal[row], clk[w].next_time, 0)
            drive_work -= half * (lam0[w, row] + lam[w, row]) * (s1 - s0)
        row += 1
    e = int(0)
    while e < model.elements[0].pretensions.count:
        row = model.elements[0].pretensions.row[e]
        pull = half * (lam0[w, row] + lam[w, row])
        if ctl[w].mode == k.STATIC:  # the force has a potential there
            pull = lam[w, row]
        force_work -= pull * (coordinate[w, row] - stretch[w, row])
        last_work -= lam[w, row] * (coordinate[w, row] - stretch[w, row])
        e += 1
    groups = group_energy(model, w, h, coordinate, stretch)
    potential += groups[0]
    damping += groups[1]
    force_work += groups[2]
    last_work += groups[2]
    if ctl[w].mode == k.LOADING:
        damping = real(0.0)
    i = int(0)
    while i < model.forces.count:
        f = half * (applied[w, 0, i] + applied[w, 1, i])
        force_work += wp.dot(f, applied_at[w, 1, i] - applied_at[w, 0, i])
        last_work += wp.dot(applied[w, 1, i], applied_at[w, 1, i] - applied_at[w, 0, i])
        i += 1
    contact = real(0.0)
    lost = real(0.0)
    friction = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        mean = half
        if impulsive[w, pair] != 0:
            mean = theta[w, pair]
        before = pair_work(model, w, pair, 0, pair_force, pair_modal, dx, psi, dq)
        after = pair_work(model, w, pair, 1, pair_force, pair_modal, dx, psi, dq)
        contact += pair_energy[w, pair, 1]
        lost += pair_loss[w, pair]
        if model.capacity.cells > 0:
            before += pair_work(model, w, pair, 0, friction_force, friction_modal, dx, psi, dq)
            after += pair_work(model, w, pair, 1, friction_force, friction_modal, dx, psi, dq)
            contact += elastic_energy[w, pair, 1]
            friction += friction_work[w, pair, 0]
        contact_work += mean_of(mean, before, after)
        pair += 1
    of_pairs = energy[w, 0, k.CONTACT]  # what of the accepted contact energy they have
    place = int(0)
    while place < model.elements[0].lumped.places:
        of_pairs -= lumped_energy[w, 0, place]
        place += 1
    film = int(0)
    while film < model.elements[0].films[0].count:
        of_pairs -= film_energy[w, 0, film]
        film += 1
    group = int(0)
    while group < model.elements[0].laps[0].count:
        of_pairs -= lap_energy[w, group]
        group += 1
    grid = contact - of_pairs + contact_work - friction
    place = int(0)
    while place < model.elements[0].lumped.places:
        contact += lumped_energy[w, 1, place]
        damping += lumped_taken[w, place, DAMPED]
        friction -= lumped_taken[w, place, RUBBED]
        place += 1
    film = int(0)
    while film < model.elements[0].films[0].count:
        contact += film_energy[w, 1, film]
        damping += film_taken[w, film, 0]
        friction -= film_taken[w, film, 1]
        film += 1
    group = int(0)
    while group < model.elements[0].laps[0].count:
        contact += lap_stored[w, group]
        friction -= lap_taken[w, group, 0]
        grid -= lap_taken[w, group, 1]
        group += 1
    joint = int(0)
    while joint < model.elements[0].joint_frictions.count:
        friction -= slip_loss[w, joint]
        joint += 1
    energy[w, 1, k.KINETIC] = kinetic
    energy[w, 1, k.STRAIN] = strain
    energy[w, 1, k.CONTACT] = contact
    energy[w, 1, k.POTENTIAL] = potential
    total = kinetic + strain + contact + potential
    before = energy[w, 0, k.KINETIC] + energy[w, 0, k.STRAIN] + energy[w, 0, k.CONTACT] + energy[w, 0, k.POTENTIAL]
    numerical = total - before - force_work - drive_work + damping - grid - friction
    clk[w].rise = real(0.0)
    if ctl[w].mode == k.STATIC:
        last_work = force_work
    if is_static(ctl, w) and ctl[w].steps > 0:
        largest = wp.max(wp.abs(strain - energy[w, 0, k.STRAIN]), wp.abs(potential - energy[w, 0, k.POTENTIAL]))
        largest = wp.max(largest, wp.max(wp.abs(contact - energy[w, 0, k.CONTACT]), wp.abs(last_work)))
        largest = wp.max(largest, wp.abs(held_work))
        stored = strain + contact + potential - energy[w, 0, k.STRAIN] - energy[w, 0, k.CONTACT]
        stored -= energy[w, 0, k.POTENTIAL] + last_work + held_work
        unseen = UNSEEN * (wp.abs(strain) + wp.abs(potential) + wp.abs(contact))
        if ctl[w].mode == k.LOADING:
            unseen = wp.max(unseen, STILL * clk[w].force * model.length)
            unseen = wp.max(unseen, IDLE * heaviest * clk[w].outer.acc * model.length * model.length)
        if stored > unseen:
            clk[w].rise = stored / largest
    if ctl[w].mode != k.DYNAMIC and ctl[w].mode != k.LOADING:  # a start or a static step opens the books
        force_work = real(0.0)
        drive_work = real(0.0)
        damping = real(0.0)
        grid = real(0.0)
        friction = real(0.0)
        numerical = real(0.0)
        lost = real(0.0)
    energy[w, 1, k.FORCE_WORK] = energy[w, 0, k.FORCE_WORK] + force_work
    energy[w, 1, k.DRIVE_WORK] = energy[w, 0, k.DRIVE_WORK] + drive_work
    energy[w, 1, k.DAMPING] = energy[w, 0, k.DAMPING] + damping + lost
    energy[w, 1, k.CONTACT_GRID] = energy[w, 0, k.CONTACT_GRID] + grid + lost
    energy[w, 1, k.NUMERICAL] = energy[w, 0, k.NUMERICAL] + numerical
    energy[w, 1, k.FRICTION] = energy[w, 0, k.FRICTION] + friction
