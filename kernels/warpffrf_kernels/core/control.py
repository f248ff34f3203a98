"""Control words and clock of a world, the failure bits, and the kinds of rows and lines of the ledger."""

import warp as wp

from warpffrf_kernels.core.scalars import real


@wp.struct
class Control:
    """What a world is about: flags and counts."""

    run: int  # 1 while the Newton loop of this world goes on
    moved: int  # 1 when the outer coordinates changed since the last evaluation
    reassemble: int  # 1 when the grids moved against each other, so that every row of G is new
    iteration: int  # Newton iterations of this attempt
    inner: int  # active-set solves of this attempt
    changes: int  # hats that changed sides in the last solve
    failure: int  # failure bits of this attempt
    slots: int  # rows of G in use
    fresh: int  # first row of G not yet assembled
    active: int  # active hats
    mode: int  # DYNAMIC, STATIC, PROJECT, START or LOADING
    status: int  # failure bits that stopped this world for good
    level: int  # the step in use is the user's step / 2**level
    sub: int  # how many such steps of the current user step are done
    step: int  # user steps done
    target: int  # user steps to do in this chunk
    saved: int  # rows written to the ring
    rejected: int  # rejected attempts so far
    worst: int  # largest number of iterations of an accepted step
    touched: int  # active hats before the attempt, restored when it is rejected
    iterations: int  # Newton iterations, all accepted steps
    steps: int  # accepted steps
    reason: int  # failure bits of all rejected attempts
    pending: int  # iterations since the last saved row
    pending_solves: int
    spare: int  # capacity, or slots, that would do, where there are too few
    edge: int  # 1 when a patch ran onto the end of a contact surface that covers an arc only
    attempt: int  # 1 when this world takes part in the attempt
    accept: int  # 1 when the attempt was accepted
    commit: int  # 1 when what it has found is history from then on, friction above all: see `commit`
    record: int  # 1 when the accepted state is to be saved
    every: int  # save every so many user steps
    refresh: int  # 1 when the outer matrix is to be inverted anew
    recenter: int  # 1 when the windows are to be laid anew
    coarse: int  # steps less accurate than asked for, taken as they could not be halved again
    stale: int  # 1 when every cell slot is to be assembled anew
    solves: int  # factorisations of stick and slip so far
    factored: int  # free coordinates of the factorisation of stick and slip at hand, 0 without
    impulsive: int  # how contact acts on dynamic local modes in this step and the next: see `impulsive_contact`
    repeated: int  # attempts repeated because of what contact did in them
    downhill: int  # 1 when a static step must not end higher than it began
    again: int  # 1 when the attempt repeats one with more impulsive pairs
    round: int  # rounds of the mean forces of impulsive pairs in this attempt
    even: int  # 1 when these means give back the energy of their pairs
    reweighed: int  # 1 when their weights have changed since the rows of G were assembled
    impulses: int  # accepted steps in which a pair was impulsive and touched
    shaken: int  # 1 when the step before was impulsive, or halved after one that was
    spell: int  # steps in a row with a numerical line too high, see `energy_watch`
    trapezoidal: int  # 1 when the attempt acts by the trapezoidal rule from true accelerations
    forget: int  # 1 when the attempt is to remember no acceleration, see `joint_friction`
    turned: int  # 1 when friction in a joint has become another in the attempt: stick, slip, or its direction
    forgotten: int  # accepted steps that remembered no acceleration
    careful: int  # how much shorter the proximal steps of a load step begin, see `proximal`


@wp.struct
class Coefficients:
    """Of generalized-alpha, see `motion`."""

    alpha_m: real
    alpha_f: real
    beta: real
    gamma: real
    acc: real  # d(acceleration)/d(displacement)
    vel: real  # d(velocity)/d(displacement)
    forget: real  # 1: the old algorithmic acceleration has no part in the increment


@wp.struct
class Clock:
    """Time and step of a world, and what a run has had of energy."""

    start_time: real
    user_step: real
    time: real
    h: real
    next_time: real
    move: real  # largest displacement of a static step [m]
    done_step: real  # size of the last accepted step
    tau: real  # longest proximal step of a load step, see `proximal`
    force: real  # largest force of a load step
    left: real  # inertia of the proximal step over the largest force: what a load step has not balanced
    error: real  # local error of the attempt over the one allowed
    gained: real  # energy gained in impacts so far, each over the energy at hand, losses taken off
    rise: real  # what a static step gained in energy, over the largest change of a line of it
    most: real  # largest energy of the run so far [J] of all lines but the potential
    made: real  # energy that came from nowhere, see `energy_watch`
    least: real  # least of what the pairs have made so far
    noise: real  # of that: what is round-off
    outer: Coefficients  # bodies and the modes that step like them
    local: Coefficients  # local modes that step by themselves


# --- values of `Control.mode`
DYNAMIC = wp.constant(0)
STATIC = wp.constant(1)
START = wp.constant(2)
PROJECT = wp.constant(3)
LOADING = wp.constant(4)  # a load step: equilibrium under the loads at its end, see `proximal`

NOT_CONVERGED = wp.constant(1)
CYCLING = wp.constant(2)
CAPACITY = wp.constant(4)
NOT_FINITE = wp.constant(8)
UNDERFLOW = wp.constant(16)
SINGULAR = wp.constant(32)
ENERGY = wp.constant(64)
INDEFINITE = wp.constant(128)
STENCIL = wp.constant(256)
STEP_ERROR = wp.constant(512)
GAIN = wp.constant(2048)  # more energy has come from nowhere than allowed, see `energy_watch`
PASSED = wp.constant(4096)  # a patch with friction has advanced by more than its own length
LEAPT = wp.constant(8192)  # two surfaces have changed sides without a touch, see `leaps`
RESTLESS = wp.constant(16384)  # a load step that has not come to rest, see `proximal`
ROOM = wp.constant(1024)  # more slots are in play than there is room for: `Engine` makes more and tries again

# --- values of `Control.impulsive`
SMOOTH = wp.constant(0)
IMPULSIVE = wp.constant(1)  # its force keeps no memory

# --- constraint row kinds
TRANSLATION = wp.constant(0)
DIRECTION = wp.constant(1)
ANGLE = wp.constant(2)
DISTANCE = wp.constant(3)
SECOND_ANGLE = wp.constant(4)
BUSHING = wp.constant(5)
TWIST = wp.constant(6)

# --- columns of the energy ledger
KINETIC = wp.constant(0)
STRAIN = wp.constant(1)
CONTACT = wp.constant(2)
POTENTIAL = wp.constant(3)
FORCE_WORK = wp.constant(4)
DRIVE_WORK = wp.constant(5)
DAMPING = wp.constant(6)
CONTACT_GRID = wp.constant(7)
NUMERICAL = wp.constant(8)
FRICTION = wp.constant(9)
LINES = 10

# --- sizes of local buffers in native snippets; the compiler of scenes refuses what does not fit
MOST_COUPLED_COLUMNS = 512  # outer columns a gap depends on
MOST_STENCIL = 256  # nodes of the second grid under a hat of the first
