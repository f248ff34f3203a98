"""Step control at the end of an attempt: accept it, halve or double the step, or repeat it differently.

A step is accepted if its Newton loop converged, everything is finite, and its local error is allowed (`local_error`).
Otherwise it is halved (levels are powers of two of the user's step, so time stays exact), and doubled again when the
steps are accurate. A rejected attempt restores multipliers and contact (`contact_snapshot`). An attempt in which a pair
oscillates, or its history creates energy, is repeated at the same step with that pair impulsive (`impulsive_contact`).
If the friction state of a joint cannot persist, the attempt is repeated without old accelerations, and so is the step
after it (`joint_friction`). A load step is halved like a step in time, and taken with shorter proximal steps if halving
does not suffice (`proximal`).

In scenes with dynamic local modes an attempt in which contact is not calm, or the integrator gains more than the energy
tolerance, is repeated with all pairs impulsive until it is calm.

The energy gain of the *integrator* in stiff modes after an impact is limited by halving. This applies to steps that
open or close a contact, are part of an impact (contact and motion exchange much of their energy in it), are impulsive
while any pair touches, or follow such a step at its size or halved. Each may gain `energy_tolerance` of the current
energy, and all together MOST_GAINED; each may gain half of the remainder of that, if this is less. With dynamic local
modes, where no pair is judged, the gain or loss of contact is included; if a lumped contact is part of the impact, the
loss of the integrator is included: nothing else limits it if the only compliance is the law of the contact. A lumped
contact that bounces is limited likewise by its own energy (`lumped.bounces`), independent of the energy of motion along
its surfaces: the limit applies to its gain minus losses in steps in which all of them together gain. Contacts with a
force below PRESSES of the largest one are exempt. Elsewhere a step is halved if impulsive pairs create more than
`energy_tolerance` of the current energy for every mean of their forces: contact was too sudden for the step.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import LumpedContacts
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import is_static, is_whole
from warpffrf_kernels.core.lanes import most, mosts, totals, values
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact, RetainedSystem, Trial
from warpffrf_kernels.core.state import ContactState, LumpedState
from warpffrf_kernels.lumped.bounces import SWUNG
from warpffrf_kernels.lumped.forces import AT_HAND, GAINED
from warpffrf_kernels.normal.pair_forces import is_closed

wp.set_module_options(MODULE_OPTIONS)

# of the energy tolerance: a step of second order with a defect below 1/2^3 of it may be doubled
QUIET = wp.constant(wp.float64(0.125))
# of the largest force of a lumped contact: contacts below it are judged by the total current energy only
PRESSES = wp.constant(wp.float64(0.05))
# rad: of the highest mode, a step that resolves all modes
RESOLVED = wp.constant(wp.float64(0.1))
# of the current energy, gained in all impacts together: a step may gain half of the remainder, ...
MOST_GAINED = wp.constant(wp.float64(0.01))
# ... but always this part of the energy tolerance, or steps would be halved for round-off
LEAST_GAIN = wp.constant(wp.float64(0.0625))
# rounds of a load step in which sticking friction replaces what held a body before (`proximal`), except for ...
SLIDES = wp.constant(4)
DRAGS = wp.constant(wp.float64(1.0e-4))  # ... this part of the largest force
# a load step at the maximum halving level starts with a proximal step shorter by 100 to at most this power
LARGEST_LEVEL = wp.constant(4)
# of the largest change of an energy: a static step with a larger rise approaches a maximum; below, changes cancel and
# the contact grids are visible
UPHILL = wp.constant(wp.float64(1.0e-2))


@kernel
def decide(
    run: Run, trial: Trial, contact: ContactState, impulses: ImpulsiveContact, lumped: LumpedState,
    lumps: LumpedContacts, system: RetainedSystem,
):  # fmt: skip
    """Accept or reject the attempt, and choose the next step: lanes over pairs, places and bodies, then the first."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0:
        return
    closing = real(0.0)  # of flags: 1 if it is so for any pair or place
    touched = real(0.0)
    resting = real(0.0)
    struck_now = real(0.0)
    restless = real(0.0)
    wanted = real(0.0)
    made = real(0.0)
    pair = lane
    while pair < model.pairs.count:
        before = is_closed(contact.pair_force, w, pair, 0)
        after = is_closed(contact.pair_force, w, pair, 1)
        if before != after and contact.impulsive[w, pair] != k.IDLE:
            closing = real(1.0)
        if before or after:
            touched = real(1.0)
            if contact.impulsive[w, pair] == k.IDLE:
                resting = real(1.0)
            if contact.impulsive[w, pair] == k.IMPULSIVE:
                struck_now = real(1.0)
                made += impulses.created_now[w, pair]
        if model.modes.dynamic_count > 0 and impulses.unsettled[w, pair] != 0:
            restless = real(1.0)
        if impulses.wanted[w, pair] != 0:
            wanted = real(1.0)
        pair += wp.block_dim()
    bouncing = real(0.0)  # 1 if a lumped contact is part of an impact
    bounced = real(0.0)
    pressed = real(0.0)
    given = real(0.0)
    place = lane
    while place < model.elements[0].lumped.places:
        before = lumped.lumped_force[w, 0, place] > real(0.0)
        after = lumped.lumped_force[w, 1, place] > real(0.0)
        if before != after:
            bouncing = real(1.0)
        bounced += lumped.lumped_energy[w, 1, place] - lumped.lumped_energy[w, 0, place]
        given += lumps.lumped_taken[w, place, GAINED]
        pressed = wp.max(pressed, wp.max(lumped.lumped_force[w, 0, place], lumped.lumped_force[w, 1, place]))
        place += wp.block_dim()
    flags = mosts(values(closing, touched, resting, struck_now, restless, wanted, bouncing, pressed))
    sums = totals(values(made, bounced, given, real(0.0), real(0.0), real(0.0), real(0.0), real(0.0)))
    given = sums[2]
    pressed = flags[7]
    share = real(0.0)  # gain of a bouncing lumped contact over its allowed gain
    place = lane
    while place < model.elements[0].lumped.places:
        own = lumps.lumped_taken[w, place, AT_HAND]
        if (
            own > real(0.0)
            and wp.max(lumped.lumped_force[w, 0, place], lumped.lumped_force[w, 1, place]) >= PRESSES * pressed
        ):
            kept = lumped.lumped_gained[w, 0, place]
            gain = lumps.lumped_taken[w, place, GAINED]
            gain = wp.min(given, wp.min(gain, kept + gain))
            spare = wp.max(real(0.5) * (MOST_GAINED - kept / own), LEAST_GAIN * model.limits.energy_tolerance)
            share = wp.max(share, gain / (own * wp.min(model.limits.energy_tolerance, spare)))
        place += wp.block_dim()
    move = real(0.0)
    b = lane
    while b < model.bodies.count:
        move = wp.max(move, wp.length(trial.dx[w, b]))
        b += wp.block_dim()
    share = most(share)
    move = most(move)
    if lane != 0:
        return
    total = real(0.0)
    for line in range(k.LINES):
        total += run.energy[w, 1, line]
    if not wp.isfinite(total):
        run.ctl[w].failure = run.ctl[w].failure | k.NOT_FINITE
    event = int(wp.max(flags[0], flags[6]))
    touching = int(flags[1])
    idle = int(flags[2])
    impulse = int(flags[3])
    calm = 1 - int(flags[4])
    again = int(flags[5])
    struck = int(flags[6])
    made = sums[0]
    bounced = sums[1]
    dynamic = run.ctl[w].mode == k.DYNAMIC
    loading = run.ctl[w].mode == k.LOADING
    run.ctl[w].commit = 0
    defect = run.energy[w, 1, k.NUMERICAL] - run.energy[w, 0, k.NUMERICAL]
    defect += run.energy[w, 1, k.CONTACT_GRID] - run.energy[w, 0, k.CONTACT_GRID]
    hand = real(0.0)
    for side in range(2):
        at_hand = run.energy[w, side, k.KINETIC] + run.energy[w, side, k.STRAIN] + run.energy[w, side, k.CONTACT]
        hand = wp.max(hand, at_hand)
    stored = run.energy[w, 1, k.CONTACT] - run.energy[w, 0, k.CONTACT]
    moving = run.energy[w, 1, k.KINETIC] - run.energy[w, 0, k.KINETIC]
    swung = real(0.0)
    if stored * moving < real(0.0):  # both grow if a load presses a part that a drive accelerates
        swung = wp.min(wp.abs(stored), wp.abs(moving))
    integrated = run.energy[w, 1, k.NUMERICAL] - run.energy[w, 0, k.NUMERICAL]
    impact = event != 0 or swung > SWUNG * hand or run.ctl[w].shaken != 0
    if not impact and run.ctl[w].impulsive == k.IMPULSIVE and touching != 0:
        impact = True
        defect = integrated
    if model.modes.dynamic_count == 0:  # contact is judged pair by pair
        defect = integrated
    if dynamic and run.ctl[w].failure == 0 and impact:
        left = wp.max(real(0.5) * (MOST_GAINED - run.clk[w].gained), LEAST_GAIN * model.limits.energy_tolerance)
        if wp.abs(bounced) > SWUNG * hand:
            struck = int(1)
        seen = model.modes.dynamic_count > 0 or struck != 0
        lost = seen and defect < -model.limits.energy_tolerance * hand
        if run.ctl[w].impulsive == k.IMPULSIVE and run.clk[w].h * model.modes.top_frequency <= RESOLVED:
            lost = False  # due to the motion of the faces: see `impulsive_contact`
        if lost or defect > wp.min(model.limits.energy_tolerance, left) * hand:
            run.ctl[w].failure = run.ctl[w].failure | k.ENERGY
    if dynamic and run.ctl[w].failure == 0 and share > real(1.0):
        run.ctl[w].failure = run.ctl[w].failure | k.ENERGY
    if dynamic and run.ctl[w].again != 0 and made > model.limits.energy_tolerance * hand:  # no mean balances it
        run.ctl[w].failure = run.ctl[w].failure | k.ENERGY
    if is_static(run.ctl, w) and run.ctl[w].energy_bounded != 0 and run.clk[w].rise > UPHILL:
        run.ctl[w].failure = run.ctl[w].failure | k.ENERGY
    if dynamic and run.clk[w].error > real(1.0):
        run.ctl[w].failure = run.ctl[w].failure | k.STEP_ERROR
    failure = run.ctl[w].failure
    bearable = (failure | k.ENERGY | k.STEP_ERROR) == (k.ENERGY | k.STEP_ERROR)
    if dynamic and failure == 0 and run.ctl[w].friction_changed != 0 and run.ctl[w].restart == 0:
        run.ctl[w].restart = 1
        run.ctl[w].repeated = run.ctl[w].repeated + 1
        run.ctl[w].active = run.ctl[w].touched
        return
    if (
        dynamic
        and model.modes.dynamic_count > 0
        and bearable
        and run.ctl[w].impulsive == k.SMOOTH
        and (calm == 0 or (touching != 0 and integrated > model.limits.energy_tolerance * hand))
    ):
        run.ctl[w].impulsive = k.IMPULSIVE
        run.ctl[w].repeated = run.ctl[w].repeated + 1
        run.ctl[w].active = run.ctl[w].touched
        return
    if dynamic and bearable and again != 0:
        pair = int(0)
        while pair < model.pairs.count:
            if impulses.wanted[w, pair] != 0:
                contact.impulsive[w, pair] = k.IMPULSIVE
                impulses.theta[w, pair] = real(0.5)
            pair += 1
        run.ctl[w].again = 1
        run.ctl[w].repeated = run.ctl[w].repeated + 1
        run.ctl[w].active = run.ctl[w].touched
        return
    run.ctl[w].again = 0
    deep = run.ctl[w].level >= model.limits.max_level
    if dynamic and deep and failure != 0 and bearable:
        run.ctl[w].coarse = run.ctl[w].coarse + failure / k.STEP_ERROR
        failure = 0  # finest level allowed: the ledger and the report show the remaining error
    if (failure & k.ROOM) != 0:  # the same attempt is repeated with more capacity
        run.ctl[w].status = k.ROOM
        run.ctl[w].active = run.ctl[w].touched
        return
    if failure != 0:
        run.ctl[w].rejected = run.ctl[w].rejected + 1
        run.ctl[w].reason = run.ctl[w].reason | failure
        slides = loading and deep and run.ctl[w].round >= SLIDES and system.hold_force[w] > DRAGS
        # shorter steps do not increase friction; the failure mode of a body that slides away is not informative
        if slides:
            failure = k.NOT_AT_REST
        if loading and deep and run.ctl[w].proximal_level < LARGEST_LEVEL and not slides:
            run.ctl[w].proximal_level = run.ctl[w].proximal_level + 1
        elif not (dynamic or loading) or deep or (dynamic and (failure & k.SINGULAR) != 0):
            run.ctl[w].status = failure
            if deep:
                run.ctl[w].status = failure | k.UNDERFLOW
        else:
            run.ctl[w].level = run.ctl[w].level + 1
            run.ctl[w].sub = 2 * run.ctl[w].sub
        run.ctl[w].active = run.ctl[w].touched
        return
    run.ctl[w].accept = 1
    if is_whole(run.ctl, w):
        run.ctl[w].commit = 1
    if dynamic:
        run.ctl[w].impulses = run.ctl[w].impulses + impulse
        run.ctl[w].idle_steps = run.ctl[w].idle_steps + idle
        run.ctl[w].restarted_steps = run.ctl[w].restarted_steps + run.ctl[w].restart
        run.ctl[w].restart = run.ctl[
            w
        ].friction_changed  # the remainder of the old friction must not enter the next step either
        if model.modes.dynamic_count == 0 and (impulse != 0 or run.ctl[w].level == 0):
            run.ctl[w].shaken = impulse
    run.ctl[w].steps = run.ctl[w].steps + 1
    run.ctl[w].iterations = run.ctl[w].iterations + run.ctl[w].iteration
    run.ctl[w].pending = run.ctl[w].pending + run.ctl[w].iteration
    run.ctl[w].worst = wp.max(run.ctl[w].worst, run.ctl[w].iteration)
    run.clk[w].time = run.clk[w].next_time
    run.clk[w].done_step = run.clk[w].h
    if not dynamic:
        run.clk[w].move = move
    if not dynamic and not loading:
        run.ctl[w].step = run.ctl[w].step + 1
        if run.ctl[w].mode != k.STATIC:
            run.clk[w].time = run.clk[w].start_time
        return
    if loading:
        run.ctl[w].proximal_level = wp.max(run.ctl[w].proximal_level - 1, 0)
    if run.ctl[w].impulsive == k.IMPULSIVE and calm != 0 and touching != 0:
        run.ctl[w].impulsive = k.SMOOTH
    if dynamic and impact and hand > real(0.0):
        run.clk[w].gained = wp.max(run.clk[w].gained + defect / hand, real(0.0))
    run.ctl[w].sub = run.ctl[w].sub + 1
    if run.ctl[w].level > 0:
        quiet = event == 0 and wp.abs(defect) <= QUIET * model.limits.energy_tolerance * hand
        # halved for films that were too fast, whose energy does not characterise the step
        if model.elements[0].films[0].count > 0 and touching == 0 and struck == 0:
            quiet = event == 0
        if run.clk[w].error > real(0.0):  # halved only for its error
            # at twice the step it would be half of the allowed error
            quiet = event == 0 and run.clk[w].error <= real(0.5) * QUIET
        if share > QUIET:
            quiet = False
        if loading:
            quiet = True
        if quiet and run.ctl[w].sub % 2 == 0:  # one level at a time
            run.ctl[w].level = run.ctl[w].level - 1
            run.ctl[w].sub = run.ctl[w].sub / 2
    whole = int(1)
    level = int(0)
    while level < run.ctl[w].level:
        whole = whole * 2
        level += 1
    if run.ctl[w].sub >= whole:
        run.ctl[w].sub = 0
        run.ctl[w].step = run.ctl[w].step + 1
        if run.ctl[w].step % run.ctl[w].every == 0:
            run.ctl[w].record = 1


@kernel
def count_attempts(run: Run):
    """Lanes over all worlds: whether any world has steps left in this chunk, and attempts left."""
    one, lane = wp.tid()
    running = real(0.0)
    w = lane
    while w < run.ctl.shape[0]:
        run.budget[w] = run.budget[w] - 1
        if run.ctl[w].status == 0 and run.ctl[w].step < run.ctl[w].target and run.budget[w] > 0:
            running = real(1.0)
        w += wp.block_dim()
    running = most(running)
    if lane == 0:
        run.more[0] = int(running)
