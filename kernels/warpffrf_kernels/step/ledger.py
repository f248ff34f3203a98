"""The energy ledger of an attempt.

With E the energy of the state (kinetic, strain of the modes, contact of pairs and lumped, potential of gravity and
springs) every step books

    work of forces    sum (F_0 + F_1)/2 . (x_1 - x_0)           drive   -(lambda_0 + lambda_1)/2 (s_1 - s_0)
                      and of pretensions -(lambda_0 + lambda_1)/2 (c_1 - c_0), in static steps -lambda_1 (c_1 - c_0)
    damping           sum c (x_1 - x_0)^2/h of dampers and modal damping, never negative: the dissipation of the
                      trapezoidal rule at any step; of dampers with a characteristic G, (G(v_0) + G(v_1))/2 (x_1 - x_0),
                      likewise, in steps without old accelerations G(v_1) (x_1 - x_0); the loss of damped layers
    friction          sum tau_1 . S: the tractions at the end of the step times the slip over it, never positive;
                      frictional loss of joints (`joint_friction`), lumped contacts, films and joint interfaces
    contact grid      dE_contact of pairs + (work of their forces on bodies and modes, trapezoidal; of pairs that are
                      impulsive in the step of their mean force) - friction
    numerical         remainder of dE: negative if the integrator dissipates.

A load step (`proximal`) is booked like a step in time, but without damping; its numerical line is the error of the
trapezoidal rule over the step. A start, and a step towards a first static state, initialise the ledger.

A proximal step towards a static state must not increase the energy: dE no more than the work of forces, since Newton's
method converges to maxima as well as to minima. For a load step this is the work of the loads at its end, under which
the new equilibrium has a lower energy than the old one.
"""

import warp as wp

from warpffrf_kernels.constraints.characteristics import characteristic
from warpffrf_kernels.constraints.forces import group_energy
from warpffrf_kernels.constraints.rows import evaluate_signal
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import LumpedContacts
from warpffrf_kernels.core.declaration import kernel_in_place
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.integration import is_static
from warpffrf_kernels.core.lanes import most, total, totals, values
from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, Trial
from warpffrf_kernels.core.state import ContactState, FilmState, FrictionState, LoadState, LumpedState, MatchedState
from warpffrf_kernels.lumped.forces import DAMPED, RUBBED
from warpffrf_kernels.normal.pair_forces import body_work, mean_of, surface_of

wp.set_module_options(MODULE_OPTIONS)

STILL = wp.constant(
    wp.float64(1.0e-12)
)  # of the largest force times the scene's length: work of the round-off of positions
# of the inertia of a proximal step through the whole scene: the work of round-off is smaller where no force acts
IDLE = wp.constant(wp.float64(1.0e-14))
UNSEEN = wp.constant(wp.float64(1.0e-8))  # of the energies: work of joints that satisfy the tolerance of 1e-9


@wp.func
def lane_work(
    model: Model, w: int, pair: int, side: int, force: wp.array4d(dtype=real), modal: wp.array4d(dtype=real),
    trial: Trial, lane: int,
) -> real:  # fmt: skip
    """The part of a lane of `pair_work`: every so many modes, the first one also the motion of the bodies."""
    found = real(0.0)
    at = int(0)
    for i in range(2):
        surface = surface_of(model, pair, i)
        n = lane
        while n < model.surfaces.modal_count[surface]:
            found += modal[w, pair, side, at + n] * trial.dq[w, model.surfaces.modal_start[surface] + n]
            n += wp.block_dim()
        at += model.surfaces.modal_count[surface]
    if lane == 0:
        found = body_work(model, w, pair, side, force, trial.dx, trial.psi) + found
    return found


@wp.func
def close_ledger(run: Run, model: Model, w: int, of_motion: values, of_contact: values, heaviest: real):
    """By one lane: the lines of a world from the sums of its parts."""
    kinetic = of_motion[0]
    strain = of_motion[1]
    potential = of_motion[2]
    force_work = of_motion[3]
    last_work = of_motion[4]
    drive_work = of_motion[5]
    held_work = of_motion[6]
    contact = of_contact[0]
    lost = of_contact[1]
    friction = of_contact[2]
    grid = of_contact[3]
    damping = of_contact[4]
    run.energy[w, 1, k.KINETIC] = kinetic
    run.energy[w, 1, k.STRAIN] = strain
    run.energy[w, 1, k.CONTACT] = contact
    run.energy[w, 1, k.POTENTIAL] = potential
    total = kinetic + strain + contact + potential
    before = (
        run.energy[w, 0, k.KINETIC]
        + run.energy[w, 0, k.STRAIN]
        + run.energy[w, 0, k.CONTACT]
        + run.energy[w, 0, k.POTENTIAL]
    )
    numerical = total - before - force_work - drive_work + damping - grid - friction
    run.clk[w].rise = real(0.0)
    if run.ctl[w].mode == k.STATIC:
        last_work = force_work
    if is_static(run.ctl, w) and run.ctl[w].steps > 0:
        largest = wp.max(wp.abs(strain - run.energy[w, 0, k.STRAIN]), wp.abs(potential - run.energy[w, 0, k.POTENTIAL]))
        largest = wp.max(largest, wp.max(wp.abs(contact - run.energy[w, 0, k.CONTACT]), wp.abs(last_work)))
        largest = wp.max(largest, wp.abs(held_work))
        stored = strain + contact + potential - run.energy[w, 0, k.STRAIN] - run.energy[w, 0, k.CONTACT]
        stored -= run.energy[w, 0, k.POTENTIAL] + last_work + held_work
        unseen = UNSEEN * (wp.abs(strain) + wp.abs(potential) + wp.abs(contact))
        if run.ctl[w].mode == k.LOADING:
            unseen = wp.max(unseen, STILL * run.clk[w].force * model.length)
            unseen = wp.max(unseen, IDLE * heaviest * run.clk[w].retained.acc * model.length * model.length)
        if stored > unseen:
            run.clk[w].rise = stored / largest
    if run.ctl[w].mode != k.DYNAMIC and run.ctl[w].mode != k.LOADING:  # a start or a static step initialises the ledger
        force_work = real(0.0)
        drive_work = real(0.0)
        damping = real(0.0)
        grid = real(0.0)
        friction = real(0.0)
        numerical = real(0.0)
        lost = real(0.0)
    run.energy[w, 1, k.FORCE_WORK] = run.energy[w, 0, k.FORCE_WORK] + force_work
    run.energy[w, 1, k.DRIVE_WORK] = run.energy[w, 0, k.DRIVE_WORK] + drive_work
    run.energy[w, 1, k.DAMPING] = run.energy[w, 0, k.DAMPING] + damping + lost
    run.energy[w, 1, k.CONTACT_GRID] = run.energy[w, 0, k.CONTACT_GRID] + grid + lost
    run.energy[w, 1, k.NUMERICAL] = run.energy[w, 0, k.NUMERICAL] + numerical
    run.energy[w, 1, k.FRICTION] = run.energy[w, 0, k.FRICTION] + friction


@kernel_in_place
def balance_energy(
    run: Run, trial: Trial, loads: LoadState, residuals: Residuals, pairs: ContactState, impulses: ImpulsiveContact,
    rubbed: FrictionState, cells: FrictionCells, lumped: LumpedState, lumps: LumpedContacts, films: FilmState,
    oil: FilmScratch, matched: MatchedState, tableau: MatchedScratch, q1: wp.array2d(dtype=real),
):  # fmt: skip
    """Lanes over the parts of each kind: the ledger of the trial state, energy[w, 1], from that of the accepted one,
    energy[w, 0]; for a static step the relative energy gain, `RISE`."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0:
        return
    half = real(0.5)
    h = run.clk[w].h
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
    b = lane
    while b < model.bodies.count:
        heaviest = wp.max(heaviest, model.bodies.mass[b])
        kinetic += half * model.bodies.mass[b] * wp.dot(trial.v1[w, b], trial.v1[w, b])
        kinetic += (
            half * wp.dot(trial.omega1[w, b], model.bodies.inertia[b] * trial.omega1[w, b]) + trial.extra_energy[w, b]
        )
        potential -= model.bodies.mass[b] * wp.dot(model.gravity, trial.r1[w, b])
        for c in range(3):
            force_work += half * (loads.load[w, 0, 6 * b + c] + loads.load[w, 1, 6 * b + c]) * trial.dx[w, b][c]
            force_work += (
                half * (loads.load[w, 0, 6 * b + 3 + c] + loads.load[w, 1, 6 * b + 3 + c]) * trial.psi[w, b][c]
            )
            last_work += (
                loads.load[w, 1, 6 * b + c] * trial.dx[w, b][c] + loads.load[w, 1, 6 * b + 3 + c] * trial.psi[w, b][c]
            )
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        kinetic += half * trial.qd1[w, n] * trial.qd1[w, n]
        strain += half * model.modes.stiffness[n] * q1[w, n] * q1[w, n]
        damping += model.modes.damping[n] * trial.dq[w, n] * trial.dq[w, n] / h
        force_work += half * (loads.load_on_modes[w, 0, n] + loads.load_on_modes[w, 1, n]) * trial.dq[w, n]
        last_work += loads.load_on_modes[w, 1, n] * trial.dq[w, n]
        n += wp.block_dim()
    square = lane
    while square < model.membrane.count:
        strain += half * trial.membrane_amplitude[w, square] * trial.membrane_amplitude[w, square]
        square += wp.block_dim()
    row = lane
    while row < model.rows.count:
        if model.rows.rigid[row] == 0:
            change = residuals.coordinate[w, row] - model.rows.reference[row]
            potential += half * model.rows.stiffness[row] * change * change + model.rows.preload[row] * change
            step = residuals.coordinate[w, row] - loads.stretch[w, row]
            damping += model.rows.damping[row] * step * step / h
            if model.rows.elastic[row] >= 0:
                potential += characteristic(model, model.rows.elastic[row], change)[2]
            if model.rows.viscous[row] >= 0:
                drag = characteristic(model, model.rows.viscous[row], loads.drive_rate[w, 1, row])[0]
                drag_before = drag
                if run.ctl[w].restart == 0:
                    drag_before = characteristic(model, model.rows.viscous[row], loads.drive_rate[w, 0, row])[0]
                damping += half * (drag_before + drag) * step
        else:
            held_work -= (
                half * (loads.lam0[w, row] + loads.lam[w, row]) * (residuals.coordinate[w, row] - loads.stretch[w, row])
            )
        if model.rows.rigid[row] != 0 and model.rows.signal[row] >= 0:
            s0 = evaluate_signal(model, model.rows.signal[row], run.clk[w].time, 0)
            s1 = evaluate_signal(model, model.rows.signal[row], run.clk[w].next_time, 0)
            drive_work -= half * (loads.lam0[w, row] + loads.lam[w, row]) * (s1 - s0)
        row += wp.block_dim()
    e = lane
    while e < model.elements[0].pretensions.count:
        row = model.elements[0].pretensions.row[e]
        pull = half * (loads.lam0[w, row] + loads.lam[w, row])
        if run.ctl[w].mode == k.STATIC:  # the force has a potential there
            pull = loads.lam[w, row]
        force_work -= pull * (residuals.coordinate[w, row] - loads.stretch[w, row])
        last_work -= loads.lam[w, row] * (residuals.coordinate[w, row] - loads.stretch[w, row])
        e += wp.block_dim()
    groups = vec3(real(0.0))
    g = lane
    while g < model.groups.count:
        groups += group_energy(model, w, g, h, residuals, loads)
        g += wp.block_dim()
    potential += groups[0]
    damping += groups[1]
    force_work += groups[2]
    last_work += groups[2]
    if run.ctl[w].mode == k.LOADING:
        damping = real(0.0)
    i = lane
    while i < model.external[0].forces.count:
        f = half * (loads.applied[w, 0, i] + loads.applied[w, 1, i])
        force_work += wp.dot(f, loads.applied_at[w, 1, i] - loads.applied_at[w, 0, i])
        last_work += wp.dot(loads.applied[w, 1, i], loads.applied_at[w, 1, i] - loads.applied_at[w, 0, i])
        i += wp.block_dim()
    contact = real(0.0)
    lost = real(0.0)
    friction = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:  # lanes over the modes of each
        mean = half
        if pairs.impulsive[w, pair] != 0:
            mean = impulses.theta[w, pair]
        before = lane_work(model, w, pair, 0, pairs.pair_force, pairs.pair_modal, trial, lane)
        after = lane_work(model, w, pair, 1, pairs.pair_force, pairs.pair_modal, trial, lane)
        if model.capacity.cells > 0:
            before += lane_work(model, w, pair, 0, rubbed.friction_force, rubbed.friction_modal, trial, lane)
            after += lane_work(model, w, pair, 1, rubbed.friction_force, rubbed.friction_modal, trial, lane)
        if lane == 0:
            contact += pairs.pair_energy[w, pair, 1]
            lost += impulses.pair_loss[w, pair]
            if model.capacity.cells > 0:
                contact += rubbed.elastic_energy[w, pair, 1]
                friction += cells.friction_work[w, pair, 0]
        contact_work += mean_of(mean, before, after)
        pair += 1
    of_pairs = real(0.0)  # the part of the accepted contact energy due to the pairs
    if lane == 0:
        of_pairs = run.energy[w, 0, k.CONTACT]
    place = lane
    while place < model.elements[0].lumped.places:
        of_pairs -= lumped.lumped_energy[w, 0, place]
        place += wp.block_dim()
    film = lane
    while film < model.elements[0].films[0].count:
        of_pairs -= films.film_energy[w, 0, film]
        film += wp.block_dim()
    group = lane
    while group < model.elements[0].matched[0].count:
        of_pairs -= matched.matched_energy[w, group]
        group += wp.block_dim()
    of_motion = totals(
        values(kinetic, strain, potential, force_work, last_work, drive_work, held_work, contact_work)
    )  # fmt: skip
    of_pairs = total(of_pairs)
    grid = real(0.0)
    if lane == 0:  # the other lanes add to what it has
        grid = contact - of_pairs + of_motion[7] - friction
    place = lane
    while place < model.elements[0].lumped.places:
        contact += lumped.lumped_energy[w, 1, place]
        damping += lumps.lumped_taken[w, place, DAMPED]
        friction -= lumps.lumped_taken[w, place, RUBBED]
        place += wp.block_dim()
    film = lane
    while film < model.elements[0].films[0].count:
        contact += films.film_energy[w, 1, film]
        damping += oil.film_taken[w, film, 0]
        friction -= oil.film_taken[w, film, 1]
        film += wp.block_dim()
    group = lane
    while group < model.elements[0].matched[0].count:
        contact += tableau.matched_stored[w, group]
        friction -= tableau.matched_taken[w, group, 0]
        grid -= tableau.matched_taken[w, group, 1]
        group += wp.block_dim()
    joint = lane
    while joint < model.elements[0].joint_frictions.count:
        friction -= residuals.slip_loss[w, joint]
        joint += wp.block_dim()
    of_contact = totals(values(contact, lost, friction, grid, damping, real(0.0), real(0.0), real(0.0)))
    heaviest = most(heaviest)
    if lane == 0:
        close_ledger(run, model, w, of_motion, of_contact, heaviest)
