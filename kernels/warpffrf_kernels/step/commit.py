"""End of an attempt: acceptance, step size, and what is kept of it or restored.

A step is accepted when its Newton loop converged, everything is finite, and its local error is allowed (`accuracy`).
Otherwise it is halved (levels are powers of two of the user's step, so time stays exact), and doubled again when it
goes well. A rejected attempt leaves multipliers and the contact (`contact_snapshot`) as it found them. An attempt in
which a pair swings, or its memory creates energy, is repeated at the same step with that pair impulsive
(`impulsive_contact`). One in which friction of a joint cannot stay what it was is repeated as a step that forgets, and
the step after it forgets too (`joint_friction`). A load step is halved like a step in time, and taken with shorter
proximal steps where that does not help (`proximal`).

In scenes with dynamic local modes an attempt in which contact is not calm, or the integrator gains more than the energy
tolerance, is repeated with all pairs impulsive, and so on until it is calm.

What the *integrator* gains of stiff modes that an impact has struck is limited by halving: steps that open or close a
contact, are part of an impact (contact and motion exchange much of their energy in it), are impulsive while anything
touches, or come next to such a step at its size or halved, may gain `energy_tolerance` of the energy at hand each, and
all together MOST_GAINED, each of them half of what is left of that, if this is less. With dynamic local modes, where no
pair is judged, what contact gains or loses counts as well; and where a lumped contact is part of the impact what the
integrator loses: nothing else limits that where all that yields is the law of the contact. A lumped contact that
bounces is limited alike by its own energy (`lumped.bounces`), which that of what travels along its surfaces does not
hide: what it gains, losses taken off, in steps in which all of them together gain. Those that press with less than
PRESSES of the largest force are not. Elsewhere a step is halved in which impulsive pairs create more than
`energy_tolerance` of the energy at hand, by whatever mean of their forces: contact came too suddenly for it.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.integration import EXACT, algorithmic, coefficients_of, is_static, is_whole, rule_of
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, quat, real, vec3
from warpffrf_kernels.lumped.bounces import SWUNG
from warpffrf_kernels.lumped.forces import AT_HAND, GAINED
from warpffrf_kernels.normal.pair_forces import is_closed

wp.set_module_options(MODULE_OPTIONS)

# of the energy tolerance: a step of second order with a defect below 1/2^3 of it may be doubled
QUIET = wp.constant(wp.float64(0.125))
# of the largest force of a lumped contact: those that press with less are judged by all energy at hand alone
PRESSES = wp.constant(wp.float64(0.05))
# rad: of the highest mode, a step that resolves all modes
RESOLVED = wp.constant(wp.float64(0.1))
# of the energy at hand, gained in all impacts together: a step may gain half of what is left of it, ...
MOST_GAINED = wp.constant(wp.float64(0.01))
# ... but this part of the energy tolerance always, or steps would be halved for round-off
LEAST_GAIN = wp.constant(wp.float64(0.0625))
# rounds of a load step in which friction that holds has taken over what held a body before (`proximal`), but for ...
SLIDES = wp.constant(4)
DRAGS = wp.constant(wp.float64(1.0e-4))  # ... this part of the largest force
# a load step that has been halved as often as allowed begins with a proximal step shorter by 100 to this power at most
MOST_CAREFUL = wp.constant(4)
# of the largest change of an energy: a static step that rises by more goes towards a maximum; below, changes cancel and
# the grids of contact show
UPHILL = wp.constant(wp.float64(1.0e-2))


@wp.kernel
def decide(
    models: wp.array(dtype=Model),
    energy: wp.array3d(dtype=real),
    dx: wp.array2d(dtype=vec3),
    pair_force: wp.array4d(dtype=real),
    restless: wp.array2d(dtype=int),
    wanted: wp.array2d(dtype=int),
    created: wp.array2d(dtype=real),
    lumped_force: wp.array3d(dtype=real),
    lumped_energy: wp.array3d(dtype=real),
    lumped_taken: wp.array3d(dtype=real),
    lumped_gained: wp.array3d(dtype=real),
    hold_force: wp.array(dtype=real),
    impulsive: inout(wp.array2d(dtype=int)),
    ctl: inout(wp.array(dtype=Control)),
    clk: inout(wp.array(dtype=Clock)),
):
    """Per world: accept or reject the attempt, and choose the next step."""
    w = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0:
        return
    total = real(0.0)
    for line in range(k.LINES):
        total += energy[w, 1, line]
    if not wp.isfinite(total):
        ctl[w].failure = ctl[w].failure | k.NOT_FINITE
    event = int(0)
    impulse = int(0)
    again = int(0)
    calm = int(1)
    touching = int(0)
    made = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        before = is_closed(pair_force, w, pair, 0)
        after = is_closed(pair_force, w, pair, 1)
        if before != after:
            event = int(1)
        if before or after:
            touching = int(1)
            if impulsive[w, pair] != 0:
                impulse = int(1)
                made += created[w, pair]
        if model.modes.dynamic_count > 0 and restless[w, pair] != 0:
            calm = int(0)
        if wanted[w, pair] != 0:
            again = int(1)
        pair += 1
    struck = int(0)  # 1 where a lumped contact is part of an impact
    bounced = real(0.0)
    pressed = real(0.0)
    given = real(0.0)
    place = int(0)
    while place < model.elements[0].lumped.places:
        before = lumped_force[w, 0, place] > real(0.0)
        after = lumped_force[w, 1, place] > real(0.0)
        if before != after:
            event = int(1)
            struck = int(1)
        bounced += lumped_energy[w, 1, place] - lumped_energy[w, 0, place]
        given += lumped_taken[w, place, GAINED]
        pressed = wp.max(pressed, wp.max(lumped_force[w, 0, place], lumped_force[w, 1, place]))
        place += 1
    share = real(0.0)  # gained of the energy of a lumped contact that bounces, over what it may gain
    place = int(0)
    while place < model.elements[0].lumped.places:
        own = lumped_taken[w, place, AT_HAND]
        if own > real(0.0) and wp.max(lumped_force[w, 0, place], lumped_force[w, 1, place]) >= PRESSES * pressed:
            kept = lumped_gained[w, 0, place]
            gain = lumped_taken[w, place, GAINED]
            gain = wp.min(given, wp.min(gain, kept + gain))
            spare = wp.max(real(0.5) * (MOST_GAINED - kept / own), LEAST_GAIN * model.limits.energy_tolerance)
            share = wp.max(share, gain / (own * wp.min(model.limits.energy_tolerance, spare)))
        place += 1
    dynamic = ctl[w].mode == k.DYNAMIC
    loading = ctl[w].mode == k.LOADING
    ctl[w].commit = 0
    defect = energy[w, 1, k.NUMERICAL] - energy[w, 0, k.NUMERICAL]
    defect += energy[w, 1, k.CONTACT_GRID] - energy[w, 0, k.CONTACT_GRID]
    hand = real(0.0)
    for side in range(2):
        at_hand = energy[w, side, k.KINETIC] + energy[w, side, k.STRAIN] + energy[w, side, k.CONTACT]
        hand = wp.max(hand, at_hand)
    stored = energy[w, 1, k.CONTACT] - energy[w, 0, k.CONTACT]
    moving = energy[w, 1, k.KINETIC] - energy[w, 0, k.KINETIC]
    swung = real(0.0)
    if stored * moving < real(0.0):  # both grow where a load presses what a drive speeds up
        swung = wp.min(wp.abs(stored), wp.abs(moving))
    integrated = energy[w, 1, k.NUMERICAL] - energy[w, 0, k.NUMERICAL]
    impact = event != 0 or swung > SWUNG * hand or ctl[w].shaken != 0
    if not impact and ctl[w].impulsive == k.IMPULSIVE and touching != 0:
        impact = True
        defect = integrated
    if model.modes.dynamic_count == 0:  # contact is judged pair by pair
        defect = integrated
    if dynamic and ctl[w].failure == 0 and impact:
        left = wp.max(real(0.5) * (MOST_GAINED - clk[w].gained), LEAST_GAIN * model.limits.energy_tolerance)
        if wp.abs(bounced) > SWUNG * hand:
            struck = int(1)
        seen = model.modes.dynamic_count > 0 or struck != 0
        lost = seen and defect < -model.limits.energy_tolerance * hand
        if ctl[w].impulsive == k.IMPULSIVE and clk[w].h * model.modes.top_frequency <= RESOLVED:
            lost = False  # it is the motion of the faces: see `impulsive_contact`
        if lost or defect > wp.min(model.limits.energy_tolerance, left) * hand:
            ctl[w].failure = ctl[w].failure | k.ENERGY
    if dynamic and ctl[w].failure == 0 and share > real(1.0):
        ctl[w].failure = ctl[w].failure | k.ENERGY
    if dynamic and ctl[w].again != 0 and made > model.limits.energy_tolerance * hand:  # no mean balances it
        ctl[w].failure = ctl[w].failure | k.ENERGY
    if is_static(ctl, w) and ctl[w].downhill != 0 and clk[w].rise > UPHILL:
        ctl[w].failure = ctl[w].failure | k.ENERGY
    if dynamic and clk[w].error > real(1.0):
        ctl[w].failure = ctl[w].failure | k.STEP_ERROR
    failure = ctl[w].failure
    bearable = (failure | k.ENERGY | k.STEP_ERROR) == (k.ENERGY | k.STEP_ERROR)
    if dynamic and failure == 0 and ctl[w].turned != 0 and ctl[w].forget == 0:
        ctl[w].forget = 1
        ctl[w].repeated = ctl[w].repeated + 1
        ctl[w].active = ctl[w].touched
        return
    if (
        dynamic
        and model.modes.dynamic_count > 0
        and bearable
        and ctl[w].impulsive == k.SMOOTH
        and (calm == 0 or (touching != 0 and integrated > model.limits.energy_tolerance * hand))
    ):
        ctl[w].impulsive = k.IMPULSIVE
        ctl[w].repeated = ctl[w].repeated + 1
        ctl[w].active = ctl[w].touched
        return
    if dynamic and bearable and again != 0:
        pair = int(0)
        while pair < model.pairs.count:
            impulsive[w, pair] = wp.max(impulsive[w, pair], wanted[w, pair])
            pair += 1
        ctl[w].again = 1
        ctl[w].repeated = ctl[w].repeated + 1
        ctl[w].active = ctl[w].touched
        return
    ctl[w].again = 0
    deep = ctl[w].level >= model.limits.max_level
    if dynamic and deep and failure != 0 and bearable:
        ctl[w].coarse = ctl[w].coarse + failure / k.STEP_ERROR
        failure = 0  # as fine as allowed: the ledger and the report show what is left
    if (failure & k.ROOM) != 0:  # the same attempt comes again, with more room
        ctl[w].status = k.ROOM
        ctl[w].active = ctl[w].touched
        return
    if failure != 0:
        ctl[w].rejected = ctl[w].rejected + 1
        ctl[w].reason = ctl[w].reason | failure
        slides = loading and deep and ctl[w].round >= SLIDES and hold_force[w] > DRAGS
        if slides:  # no shorter step makes friction hold more; how a body that runs away fails says nothing
            failure = k.RESTLESS
        if loading and deep and ctl[w].careful < MOST_CAREFUL and not slides:
            ctl[w].careful = ctl[w].careful + 1
        elif not (dynamic or loading) or deep or (dynamic and (failure & k.SINGULAR) != 0):
            ctl[w].status = failure
            if deep:
                ctl[w].status = failure | k.UNDERFLOW
        else:
            ctl[w].level = ctl[w].level + 1
            ctl[w].sub = 2 * ctl[w].sub
        ctl[w].active = ctl[w].touched
        return
    ctl[w].accept = 1
    if is_whole(ctl, w):
        ctl[w].commit = 1
    if dynamic:
        ctl[w].impulses = ctl[w].impulses + impulse
        ctl[w].forgotten = ctl[w].forgotten + ctl[w].forget
        ctl[w].forget = ctl[w].turned  # what the old friction has left is not for the step after it either
        if model.modes.dynamic_count == 0 and (impulse != 0 or ctl[w].level == 0):
            ctl[w].shaken = impulse
    ctl[w].steps = ctl[w].steps + 1
    ctl[w].iterations = ctl[w].iterations + ctl[w].iteration
    ctl[w].pending = ctl[w].pending + ctl[w].iteration
    ctl[w].worst = wp.max(ctl[w].worst, ctl[w].iteration)
    clk[w].time = clk[w].next_time
    clk[w].done_step = clk[w].h
    if not dynamic:
        move = real(0.0)
        b = int(0)
        while b < model.bodies.count:
            move = wp.max(move, wp.length(dx[w, b]))
            b += 1
        clk[w].move = move
    if not dynamic and not loading:
        ctl[w].step = ctl[w].step + 1
        if ctl[w].mode != k.STATIC:
            clk[w].time = clk[w].start_time
        return
    if loading:
        ctl[w].careful = wp.max(ctl[w].careful - 1, 0)
    if ctl[w].impulsive == k.IMPULSIVE and calm != 0 and touching != 0:
        ctl[w].impulsive = k.SMOOTH
    if dynamic and impact and hand > real(0.0):
        clk[w].gained = wp.max(clk[w].gained + defect / hand, real(0.0))
    ctl[w].sub = ctl[w].sub + 1
    if ctl[w].level > 0:
        quiet = event == 0 and wp.abs(defect) <= QUIET * model.limits.energy_tolerance * hand
        # halved for films that were too fast, whose energy says nothing of the step
        if model.elements[0].films[0].count > 0 and touching == 0 and struck == 0:
            quiet = event == 0
        if clk[w].error > real(0.0):  # a step that is halved for its error alone
            quiet = event == 0 and clk[w].error <= real(0.5) * QUIET  # doubled it would be half of what is allowed
        if share > QUIET:
            quiet = False
        if loading:
            quiet = True
        if quiet and ctl[w].sub % 2 == 0:  # one level at a time
            ctl[w].level = ctl[w].level - 1
            ctl[w].sub = ctl[w].sub / 2
    whole = int(1)
    level = int(0)
    while level < ctl[w].level:
        whole = whole * 2
        level += 1
    if ctl[w].sub >= whole:
        ctl[w].sub = 0
        ctl[w].step = ctl[w].step + 1
        if ctl[w].step % ctl[w].every == 0:
            ctl[w].record = 1


@wp.kernel
def keep_bodies(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    p1: wp.array2d(dtype=quat),
    v1: wp.array2d(dtype=vec3),
    v1_rate: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    omega1_rate: wp.array2d(dtype=vec3),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
    clk: wp.array(dtype=Clock),
    v_alg0: wp.array2d(dtype=vec3),
    omega_alg0: wp.array2d(dtype=vec3),
    v_rest: wp.array2d(dtype=vec3),
    omega_rest: wp.array2d(dtype=vec3),
    r: out(wp.array2d(dtype=vec3)),
    p: out(wp.array2d(dtype=quat)),
    v: inout(wp.array2d(dtype=vec3)),
    v_rate: out(wp.array2d(dtype=vec3)),
    v_alg: out(wp.array2d(dtype=vec3)),
    omega: inout(wp.array2d(dtype=vec3)),
    omega_rate: out(wp.array2d(dtype=vec3)),
    omega_alg: out(wp.array2d(dtype=vec3)),
    turned: inout(wp.array2d(dtype=real)),
):
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].accept == 0:
        return
    b = lane
    while b < r.shape[1]:
        mode = ctl[w].mode
        acc = v1_rate[w, b]
        spin_rate = omega1_rate[w, b]
        if mode == k.DYNAMIC or mode == k.STATIC or mode == k.LOADING:
            r[w, b] = r1[w, b]
            p[w, b] = p1[w, b]
        h = clk[w].h
        a_t = algorithmic(h, clk[w].outer, dx[w, b], v[w, b], v_alg0[w, b])
        a_r = algorithmic(h, clk[w].outer, psi[w, b], omega[w, b], omega_alg0[w, b])
        if mode == k.DYNAMIC and model.pairs.count > 0:
            a_t += v_rest[w, b]
            a_r += omega_rest[w, b]
        if mode == k.START:
            a_t = acc
            a_r = spin_rate
        if mode == k.DYNAMIC or mode == k.START:
            v_rate[w, b] = acc
            omega_rate[w, b] = spin_rate
            v_alg[w, b] = a_t
            omega_alg[w, b] = a_r
        if mode == k.DYNAMIC or mode == k.PROJECT:
            v[w, b] = v1[w, b]
            omega[w, b] = omega1[w, b]
        if mode == k.DYNAMIC:
            turned[w, b] = wp.max(turned[w, b], wp.length(omega1[w, b]))
        if mode == k.START:  # PROJECT found the velocity at the end of its tiny step: back to its beginning
            v[w, b] = v[w, b] - h * v1_rate[w, b]
            omega[w, b] = omega[w, b] - h * omega1_rate[w, b]
        b += wp.block_dim()


@wp.kernel
def keep_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    q1: wp.array2d(dtype=real),
    qd1: wp.array2d(dtype=real),
    qd1_rate: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
    qd_alg0: wp.array2d(dtype=real),
    qd_rest: wp.array2d(dtype=real),
    q: out(wp.array2d(dtype=real)),
    qd: inout(wp.array2d(dtype=real)),
    qd_rate: out(wp.array2d(dtype=real)),
    qd_alg: out(wp.array2d(dtype=real)),
    modal_load: inout(wp.array3d(dtype=real)),
):
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].accept == 0:
        return
    n = lane
    while n < q.shape[1]:
        mode = ctl[w].mode
        modal_load[w, 0, n] = modal_load[w, 1, n]
        if mode == k.DYNAMIC or mode == k.STATIC or mode == k.LOADING:
            q[w, n] = q1[w, n]
        h = clk[w].h
        rule = rule_of(model, ctl, clk, w, n)
        a = algorithmic(h, coefficients_of(clk, w, rule), vec3(dq[w, n]), vec3(qd[w, n]), vec3(qd_alg0[w, n]))[0]
        rate = qd1_rate[w, n]
        if mode == k.DYNAMIC and model.pairs.count > 0:
            a += qd_rest[w, n]
        if mode == k.START or rule == EXACT:
            a = rate
        if mode == k.DYNAMIC or mode == k.START:
            qd_rate[w, n] = rate
            qd_alg[w, n] = a
        if mode == k.DYNAMIC or mode == k.PROJECT:
            qd[w, n] = qd1[w, n]
        if mode == k.START:
            qd[w, n] = qd[w, n] - h * qd1_rate[w, n]
        n += wp.block_dim()


@wp.kernel
def keep_rest(
    models: wp.array(dtype=Model),
    coordinate: wp.array2d(dtype=real),
    ctl: wp.array(dtype=Control),
    lam: inout(wp.array2d(dtype=real)),
    lam0: inout(wp.array2d(dtype=real)),
    stretch: out(wp.array2d(dtype=real)),
    drive_rate: inout(wp.array3d(dtype=real)),
    applied: inout(wp.array3d(dtype=vec3)),
    applied_at: inout(wp.array3d(dtype=vec3)),
    load: inout(wp.array3d(dtype=real)),
    load_on_modes: inout(wp.array3d(dtype=real)),
    energy: inout(wp.array3d(dtype=real)),
):
    """Per world: what is left to take over, or to restore after a rejection."""
    w = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0:
        return
    accept = ctl[w].accept != 0 and ctl[w].mode != k.PROJECT  # whose multipliers are impulses over the tiny step
    row = int(0)
    while row < model.rows.count:
        if accept:
            lam0[w, row] = lam[w, row]
            drive_rate[w, 0, row] = drive_rate[w, 1, row]
            stretch[w, row] = coordinate[w, row]
        else:
            lam[w, row] = lam0[w, row]
        row += 1
    if not accept:
        return
    i = int(0)
    while i < model.forces.count:
        applied[w, 0, i] = applied[w, 1, i]
        applied_at[w, 0, i] = applied_at[w, 1, i]
        i += 1
    i = int(0)
    while i < 6 * model.bodies.count:
        load[w, 0, i] = load[w, 1, i]
        i += 1
    i = int(0)
    while i < model.modes.count:
        load_on_modes[w, 0, i] = load_on_modes[w, 1, i]
        i += 1
    for line in range(k.LINES):
        energy[w, 0, line] = energy[w, 1, line]


@wp.kernel
def count_attempts(ctl: wp.array(dtype=Control), budget: inout(wp.array(dtype=int)), more: out(wp.array(dtype=int))):
    """One thread for all worlds: does any still have steps to do in this chunk, and attempts left?"""
    running = int(0)
    w = int(0)
    while w < ctl.shape[0]:
        budget[w] = budget[w] - 1
        if ctl[w].status == 0 and ctl[w].step < ctl[w].target and budget[w] > 0:
            running = 1
        w += 1
    more[0] = running
