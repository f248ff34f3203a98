r"""Means of impulsive pairs: the theta with which contact returns its energy, and the choice of impulsive pairs.

**The mean.** The force of an impulsive pair (`impulsive_contact`) acts through the step as its mean (1 - theta) f_0 +
theta f_1. With d the motion in the step, W = f.d of the normal forces, and E the energy of the pair's contact,

    created = (1 - theta) W_0 + theta W_1 + E_1 - E_0 + dissipation of a damped layer = 0,

a discrete gradient of E. E is a convex function of the gaps, f its negative gradient, so E_1 - E_0 lies between -W_0
and -W_1: theta is in [0, 1]. While the active set is unchanged it is 1/2; for a spring that closes after the part 1 -
rho of the motion it is rho/2. Contact returns the energy that it has received, for any step and any stiffness, pair by
pair, however light a body is compared with others: a bounce within a step or less ends with the velocity given by
momentum and energy, without step halving. Friction acts through the same mean and is not part of the balance; it
dissipates.

theta is found in rounds: the Newton loop converges with one, then the next is chosen (`balance_means`), if the pair
*swings*: stores or releases more than SWING of its contact energy. Otherwise theta stays 1/2: E then also changes
because the patch moves over the grids, which no mean of forces compensates. Such a change may be more than any theta in
[0, 1] balances, if a body is carried along a deformed surface until contact: forces act along undeformed normals and do
not resist. Then theta is 1, which supplies the least energy to the motion. A step that must end uses the end of its
bracket on which energy is lost.

**When.** A pair is impulsive in a step that it begins open: without forces at its beginning there is no memory to
remove, and if it stays open both kinds of step are the same. A step in which it swings, or in which the memory of its
force does more work than the trapezoidal rule by OWN of the pair's own energy (contact energy, or kinetic energy along
the force), is repeated as an impulsive one (`judge_pairs`), with a search that begins at theta 1/2.

**Idle pairs.** Pairs that a chain of bodies and pairs connects form a group: all contacts of a bearing, pockets of its
cage included. A pair whose own energy is below NEGLIGIBLE of the contact energy of its group is impulsive from the
start, with theta 1 and without a search or a repetition: it never gains energy, and loses little compared with contacts
that carry load. Otherwise the idle rollers of a bearing, which bounce under their own weight, would cost every step a
repetition and a few rounds. Energies of other groups are not considered: a light body that bounces where nothing else
is pressed has its search, however much energy the machine has. The energy of an idle pair may be negative: the
deformation of the body by its neighbours does work on its pressures.

**Local modes with inertia** leave almost no compliance to contact (D_rest), and a force that stops a face within a step
would chatter on it. There theta is 1, the force at the end: E is convex, so no energy is gained and a face may lose all
of its own kinetic energy, which decreases with the number of modes. Scenes with such modes treat all pairs as impulsive
together, from the repetition of a step in which the nodal forces change by more than CALM of their sum, or in which the
integrator gains more than the energy tolerance, until contact is calm (`find_unsettled`); the gate of `step_control`
applies to both.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import OUTER
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, Trial
from warpffrf_kernels.core.state import ContactState, FrictionState, MotionState
from warpffrf_kernels.impulsive.impulsive_contact import energy_about, is_idle, mode_kappa, retained_kappa, weight_of
from warpffrf_kernels.impulsive.impulsive_memory import filtered
from warpffrf_kernels.normal.pair_forces import (
    body_mobility,
    body_work,
    is_closed,
    mean_of,
    modal_mobility,
    modal_place,
    modal_work,
    pair_work,
    surface_of,
    whole,
)

wp.set_module_options(MODULE_OPTIONS)

# of the larger contact force: a step in which the nodal forces change by more does not resolve them
CALM = wp.constant(wp.float64(0.5))
# of a pair's own energy: what a step in which it stays closed may create; more than the movement of a patch of a few
# columns over the grids creates
OWN = wp.constant(wp.float64(2.0e-3))
SMALL = wp.constant(wp.float64(0.02))  # of the contact energy of its group, if its own is less
# of the larger contact energy: a pair that stores or releases more than that does so not because of the grids
SWING = wp.constant(wp.float64(0.5))
# of a pair's own energy: target loss of the mean force of an impulsive step, and its tolerance: it creates none
LOST = wp.constant(wp.float64(1.0e-4))
MISSED = wp.constant(wp.float64(1.0001e-4))  # plus round-off
MOST_ROUNDS = wp.constant(12)  # of theta; then the end of the bracket with a loss is used


@wp.func
def kinetic_along(model: Model, w: int, pair: int, contact: ContactState, state: MotionState) -> real:
    """Kinetic energy [J] of the motion along the force of a pair, before or after the attempt, of the bodies alone or
    with their modes, the largest: with stiff modes the motion of the bodies is a small part of that along a force."""
    energy = real(0.0)
    for side in range(2):
        power = body_work(model, w, pair, side, contact.pair_force, state.v, state.omega)
        mobility = body_mobility(model, w, pair, side, contact.pair_force)
        if mobility > real(0.0):
            energy = wp.max(energy, real(0.5) * power * power / mobility)
        power += modal_work(model, w, pair, side, contact.pair_modal, state.qd)
        mobility += modal_mobility(model, w, pair, side, contact.pair_modal)
        if mobility > real(0.0):
            energy = wp.max(energy, real(0.5) * power * power / mobility)
    return energy


@wp.func
def own_energy(model: Model, w: int, pair: int, contact: ContactState, state: MotionState) -> real:
    """Of a pair: contact energy, or the initial kinetic energy along its force in the step, the largest."""
    approach = kinetic_along(model, w, pair, contact, state)
    return wp.max(approach, wp.max(contact.pair_energy[w, pair, 0], contact.pair_energy[w, pair, 1]))


@wp.func
def swings(pair_energy: wp.array3d(dtype=real), w: int, pair: int) -> bool:
    """Whether a pair stores or releases most of its contact energy in the attempt."""
    before = pair_energy[w, pair, 0]
    after = pair_energy[w, pair, 1]
    return wp.abs(after - before) > SWING * wp.max(wp.abs(before), wp.abs(after))


@wp.func
def has_converged(ctl: wp.array(dtype=Control), w: int) -> bool:
    """Whether the iteration of a world has just converged, with means of impulsive pairs that may need a search."""
    return ctl[w].attempt != 0 and ctl[w].run == 0 and ctl[w].failure == 0 and ctl[w].even == 0


@kernel
def balance_means(
    run: Run, state: MotionState, trial: Trial, contact: ContactState, friction: FrictionState,
    impulses: ImpulsiveContact, residuals: Residuals,
):  # fmt: skip
    """Per world whose iteration has just converged: theta of the impulsive pairs that do not return their energy, and
    another round of the loop with them. `pair_loss`: dissipation of a damped layer.

    bracket: the lower and the upper end, the energy that the pair creates with the one (positive) and the other
    (negative), 0 if unknown.
    """
    w = wp.tid()
    model = run.models[w]
    if not has_converged(run.ctl, w):
        return
    # an attempt that is not a repetition is repeated if a pair swings
    if run.ctl[w].mode != k.DYNAMIC or run.ctl[w].again == 0 or run.ctl[w].round > MOST_ROUNDS:
        run.ctl[w].even = 1
        return
    kappa = retained_kappa(model, run.clk, w)
    changed = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        if contact.impulsive[w, pair] != 0 and swings(contact.pair_energy, w, pair):
            before = pair_work(model, w, pair, 0, contact.pair_force, contact.pair_modal, trial)
            after = pair_work(model, w, pair, 1, contact.pair_force, contact.pair_modal, trial)
            stored = contact.pair_energy[w, pair, 1] - contact.pair_energy[w, pair, 0] + impulses.pair_loss[w, pair]
            at = impulses.theta[w, pair]
            own = own_energy(model, w, pair, contact, state)
            excess = mean_of(at, before, after) + stored + LOST * own
            to = at
            if is_idle(model, w, pair, own, contact.pair_energy):
                to = real(1.0)
            elif wp.abs(excess) > MISSED * own:
                side = int(0)
                if excess < real(0.0):
                    side = 1
                narrow(impulses.bracket, w, pair, side, at, excess)
                force = real(0.0)
                ease = real(0.5) * run.clk[w].h * run.clk[w].h
                if contact.pair_energy[w, pair, 0] == real(0.0):
                    force = wp.sqrt(
                        body_mobility(model, w, pair, 1, contact.pair_force)
                        + modal_mobility(model, w, pair, 1, contact.pair_modal)
                    )
                elif contact.pair_energy[w, pair, 1] == real(0.0):
                    force = wp.sqrt(
                        body_mobility(model, w, pair, 0, contact.pair_force)
                        + modal_mobility(model, w, pair, 0, contact.pair_modal)
                    )
                to = next_theta(impulses.bracket, w, pair, at, excess, force, before, after, stored, ease)
            if run.ctl[w].round == MOST_ROUNDS:
                to = at
                if excess > MISSED * own:
                    to = impulses.bracket[w, pair, 1]
            if to != at:
                changed = int(1)
                impulses.theta[w, pair] = to
                impulses.weight[w, pair] = weight_of(kappa, to)
                # its part of the balance
                for side in range(2):
                    surface = surface_of(model, pair, side)
                    b = model.surfaces.body[surface]
                    if b >= 0:
                        for c in range(6):
                            i = 6 * side + c
                            change = whole(model, contact.pair_force, friction.friction_force, w, pair, 1, i)
                            change -= whole(model, contact.pair_force, friction.friction_force, w, pair, 0, i)
                            residuals.residual[w, 6 * b + c] = (
                                residuals.residual[w, 6 * b + c] - kappa * (to - at) * change
                            )
                    n = int(0)
                    while n < model.surfaces.modal_count[surface]:
                        m = model.surfaces.modal_start[surface] + n
                        i = modal_place(model, pair, m)
                        change = whole(model, contact.pair_modal, friction.friction_modal, w, pair, 1, i)
                        change -= whole(model, contact.pair_modal, friction.friction_modal, w, pair, 0, i)
                        own_kappa = mode_kappa(model, run, w, m)
                        residuals.modal_residual[w, m] = residuals.modal_residual[w, m] - own_kappa * (to - at) * change
                        n += 1
        pair += 1
    if changed == 0:
        run.ctl[w].even = 1
        return
    run.ctl[w].round = run.ctl[w].round + 1
    run.ctl[w].run = 1
    run.ctl[w].reweighed = 1
    run.ctl[w].stale = 1
    run.ctl[w].refresh = 1  # the retained matrix contains the weights, and what is condensed into it too


@wp.func
def narrow(bracket: wp.array3d(dtype=real), w: int, pair: int, side: int, at: real, excess: real):
    """Moves one end of the bracket. If the same end moves twice in succession, the energy known at the other end is
    scaled, so that it moves too (Anderson and Bjoerck 1973)."""
    if bracket[w, pair, 4] == real(side) and bracket[w, pair, 2 + side] != real(0.0):
        scale = real(1.0) - excess / bracket[w, pair, 2 + side]
        if scale <= real(0.0):
            scale = real(0.5)
        bracket[w, pair, 3 - side] = scale * bracket[w, pair, 3 - side]
    bracket[w, pair, side] = at
    bracket[w, pair, 2 + side] = excess
    bracket[w, pair, 4] = real(side)


@wp.func
def next_theta(
    bracket: wp.array3d(dtype=real),
    w: int,
    pair: int,
    at: real,
    excess: real,
    force: real,
    before: real,
    after: real,
    stored: real,
    ease: real,
) -> real:
    """Next theta between the ends of the bracket (the upper one if it must be larger): where a spring between two
    masses that closes or opens would return its energy; for one that stays closed from W_1 - W_0 (`after - before`),
    the effect of a change of theta, whether the motion or the mean force is prescribed. From the second round on by the
    secant, except for one that opens, for which the formula is then known.

    With F the size of the changing force (M^-1 the metric), d the motion along it and x F the mean, a motion without
    contact loses or gains c x F, c = h^2/2 (`ease`) if no joint constrains the bodies, in the second round from the
    observed change. A spring of stiffness k = F/delta that closes (x = theta, E_1 = F delta/2) stores x F d where c k
    (d - delta) x^2 + (d + c x_0 F) x = (delta + c x_0 F)/2, x_0 its present value; one that opens (x = 1 - theta) has
    released E_0 where c F x^2 + (d - c x_0 F) x = E_0/F.
    """
    low = bracket[w, pair, 0]
    high = bracket[w, pair, 1]
    gain = bracket[w, pair, 2]
    loss = bracket[w, pair, 3]
    last = bracket[w, pair, 7]
    change = excess - bracket[w, pair, 8]
    bracket[w, pair, 7] = at
    bracket[w, pair, 8] = excess
    to = real(0.5) * (low + high)
    if gain > real(0.0) and loss < real(0.0):
        to = low + (high - low) * gain / (gain - loss)
    guess = real(-1.0)
    opens = force > real(0.0) and before + after > real(0.0)
    if last >= real(0.0) and not opens and change != real(0.0):
        guess = at - excess * (at - last) / change
        if loss == real(0.0) and guess > high:
            return high
    elif force == real(0.0) and after < before:
        guess = at - excess / (after - before)
    if guess > low and guess < high:
        return guess
    if force > real(0.0):
        done = before + after
        x = at
        if opens:
            x = real(1.0) - at
        d = wp.abs(done) / force
        c = ease
        known = bracket[w, pair, 5]
        if known >= real(0.0) and x * force != known:
            found = wp.abs((d - bracket[w, pair, 6]) / (x * force - known))
            if found > real(0.0):
                c = found
        bracket[w, pair, 5] = x * force
        bracket[w, pair, 6] = d
        moved = c * x * force
        by_spring = real(-1.0)
        if opens:
            by_spring = real(1.0) - root(c * force, d - moved, wp.abs(stored) / force)
        else:
            deep = real(2.0) * stored / force
            stiff = force * force / (real(2.0) * stored)
            by_spring = root(c * stiff * wp.max(d - deep, real(0.0)), d + moved, real(0.5) * (deep + moved))
        if by_spring > low and by_spring < high:
            to = by_spring
    return to


@wp.func
def root(a: real, b: real, c: real) -> real:
    """The positive x of a x^2 + b x = c, for a >= 0 and c > 0."""
    under = wp.sqrt(b * b + real(4.0) * a * c)
    if b > real(0.0):
        return real(2.0) * c / (b + under)
    return (under - b) / (real(2.0) * a)


@kernel
def judge_pairs(run: Run, contact: ContactState, impulses: ImpulsiveContact, trial: Trial, state: MotionState):
    """Per (world, pair): the energy that its contact creates in the attempt, and whether it is to be repeated as
    impulsive: if it is not idle, and swings and its mean was not searched, or its memory creates more than OWN of its
    own energy.

    Created is the work of the effective normal force in the step, plus the change of the contact energy, plus the
    dissipation of damped layers. Local modes with inertia may step exactly, with other forces: nothing is judged there.
    """
    w, pair = wp.tid()
    model = run.models[w]
    impulses.wanted[w, pair] = 0
    impulses.created_now[w, pair] = real(0.0)
    if run.ctl[w].attempt == 0 or run.ctl[w].mode != k.DYNAMIC or model.modes.dynamic_count > 0:
        return
    if not is_closed(contact.pair_force, w, pair, 0) and not is_closed(contact.pair_force, w, pair, 1):
        return
    before = pair_work(model, w, pair, 0, contact.pair_force, contact.pair_modal, trial)
    after = pair_work(model, w, pair, 1, contact.pair_force, contact.pair_modal, trial)
    worked = mean_of(run.clk[w].retained.gamma, before, after)
    if contact.impulsive[w, pair] != 0:
        worked = mean_of(impulses.theta[w, pair], before, after)
    elif run.ctl[w].trapezoidal == 0:
        recalled = pair_work(model, w, pair, 0, contact.memory, contact.modal_memory, trial)
        ahead = filtered(run.clk, w, OUTER, before, after, recalled)
        worked = mean_of(run.clk[w].retained.gamma, recalled, ahead)
    total = worked + contact.pair_energy[w, pair, 1] - contact.pair_energy[w, pair, 0] + impulses.pair_loss[w, pair]
    own = own_energy(model, w, pair, contact, state)
    noticed = OWN * wp.max(own, SMALL * energy_about(model, w, pair, contact.pair_energy))
    swung = swings(contact.pair_energy, w, pair)
    if is_idle(model, w, pair, own, contact.pair_energy):
        if contact.impulsive[w, pair] != 0:
            contact.impulsive[w, pair] = k.IDLE
    elif contact.impulsive[w, pair] == 0:
        if swung or worked - mean_of(real(0.5), before, after) > noticed:
            impulses.wanted[w, pair] = 1
    elif swung and run.ctl[w].again == 0:
        impulses.wanted[w, pair] = 1
    impulses.created_now[w, pair] = total


@kernel
def find_unsettled(
    run: Run, geometry: ContactGeometry, contact: ContactState, impulses: ImpulsiveContact,
    pressure_before: wp.array3d(dtype=real), patch_offset_before: wp.array2d(dtype=real),
):  # fmt: skip
    """Per (world, pair): 1 if the nodal forces changed by more than CALM in the attempt (the sum of |change|). If the
    window was moved, the previous nodes are those that `line_of_centres.open_window` transferred to it.
    """
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0:
        return
    shift = int(wp.floor(contact.patch_offset[w, pair] - patch_offset_before[w, pair] + real(0.5)))
    shift = shift * model.surfaces.rows[model.pairs.first[pair]]
    change = real(0.0)
    before = real(0.0)
    after = real(0.0)
    m = int(0)
    while m < model.window.grid_nodes:
        weight = wp.max(geometry.area[w, pair, m], real(0.0))
        p0 = real(0.0)
        if m - shift >= 0 and m - shift < model.window.grid_nodes:
            p0 = weight * pressure_before[w, pair, m - shift]
        p1 = weight * contact.pressure[w, pair, m]
        change += wp.abs(p1 - p0)
        before += p0
        after += p1
        m += 1
    impulses.unsettled[w, pair] = 0
    if change > CALM * wp.max(before, after):
        impulses.unsettled[w, pair] = 1
