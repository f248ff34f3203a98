"""Control words and clock of a world, failure bits, kinds of rows and columns of the energy ledger."""

import warp as wp

from warpffrf_kernels.core.scalars import real


@wp.struct
class Control:
    """State of a world: flags and counts."""

    run: int  # 1 while the Newton loop of this world runs
    moved: int  # 1 if the retained coordinates changed since the last evaluation
    reassemble: int  # 1 if the grids moved relative to each other, so that every row of G is new
    iteration: int  # Newton iterations of this attempt
    inner: int  # active-set solves of this attempt
    changes: int  # nodes whose contact status changed in the last solve
    failure: int  # failure bits of this attempt
    slots: int  # rows of G in use
    fresh: int  # first row of G not yet assembled
    active: int  # active nodes
    mode: int  # DYNAMIC, STATIC, PROJECT, START or LOADING
    status: int  # failure bits that stopped this world permanently
    level: int  # the current step is the user's step / 2**level
    sub: int  # such steps done of the current user step
    step: int  # user steps done
    target: int  # user steps to do in this chunk
    saved: int  # rows written to the ring
    rejected: int  # rejected attempts so far
    worst: int  # largest number of iterations of an accepted step
    touched: int  # active nodes before the attempt, restored on rejection
    iterations: int  # Newton iterations of all accepted steps
    steps: int  # accepted steps
    reason: int  # failure bits of all rejected attempts
    pending: int  # iterations since the last saved row
    pending_solves: int
    spare: int  # sufficient capacity or number of slots, if there are too few
    edge: int  # 1 if a patch reached the end of a contact surface that covers only an arc
    attempt: int  # 1 if this world takes part in the attempt
    accept: int  # 1 if the attempt was accepted
    commit: int  # 1 if its result becomes history, friction above all: see `commit`
    record: int  # 1 if the accepted state is to be saved
    every: int  # save interval in user steps
    refresh: int  # 1 if the retained matrix is to be inverted again
    recenter: int  # 1 if the windows are to be placed again
    coarse: int  # steps less accurate than requested, accepted because they could not be halved again
    stale: int  # 1 if every cell slot is to be assembled again
    solves: int  # stick-slip factorisations so far
    factored: int  # free coordinates of the current stick-slip factorisation, 0 without one
    impulsive: int  # action of contact on dynamic local modes in this step and the next: see `impulsive_contact`
    repeated: int  # attempts repeated because of their contact or friction
    energy_bounded: int  # 1 if a static step must not increase the energy
    again: int  # 1 if the attempt repeats one with more impulsive pairs
    round: int  # rounds of the mean forces of impulsive pairs in this attempt
    even: int  # 1 if these means return the energy of their pairs
    reweighed: int  # 1 if their weights have changed since the rows of G were assembled
    impulses: int  # accepted steps in which a pair was impulsive and touched
    idle_steps: int  # the same with an idle pair
    shaken: int  # 1 if the previous step was impulsive, or halved after an impulsive one
    gaining_steps: int  # consecutive steps with too high a numerical line, see `energy_watch`
    trapezoidal: int  # 1 if the attempt uses the trapezoidal rule from true accelerations
    restart: int  # 1 if the attempt uses no old acceleration, see `joint_friction`
    friction_changed: int  # 1 if the friction state of a joint (stick, slip or its direction) changed in the attempt
    restarted_steps: int  # accepted steps that used no old acceleration
    proximal_level: int  # exponent that shortens the first proximal steps of a load step, see `proximal`


@wp.struct
class Coefficients:
    """Coefficients of generalized-alpha, see `motion`."""

    alpha_m: real
    alpha_f: real
    beta: real
    gamma: real
    acc: real  # d(acceleration)/d(displacement)
    vel: real  # d(velocity)/d(displacement)
    restart: real  # 1: the old algorithmic acceleration does not enter the increment


@wp.struct
class Clock:
    """Time and step of a world, and energy bounds of a run."""

    start_time: real
    user_step: real
    time: real
    h: real
    next_time: real
    move: real  # largest displacement of a static step [m]
    done_step: real  # size of the last accepted step
    tau: real  # longest proximal step of a load step, see `proximal`
    force: real  # largest force of a load step
    left: real  # inertia of the proximal step over the largest force: residual of the statics in a load step
    error: real  # local error of the attempt over the allowed one
    gained: real  # energy gained in impacts so far, each relative to the current energy, minus losses
    rise: real  # energy gained in a static step over the largest change of a ledger line
    most: real  # largest energy of the run so far [J] of all lines except the potential
    made: real  # spurious energy, see `energy_watch`
    least: real  # minimum so far of the energy created by the pairs
    noise: real  # round-off level of the created energy
    retained: Coefficients  # bodies and the modes integrated with them
    local: Coefficients  # local modes integrated separately


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
GAIN = wp.constant(2048)  # spurious energy exceeds the limit, see `energy_watch`
PASSED = wp.constant(4096)  # a patch with friction has advanced by more than its own length
LEAPT = wp.constant(8192)  # two surfaces have passed each other without contact, see `missed_contact`
NOT_AT_REST = wp.constant(16384)  # a load step that has not come to rest, see `proximal`
TRACTIONS = wp.constant(32768)  # stick and slip of the cells have not settled, see `rolling.traction_solve`
TOO_HOT = wp.constant(65536)  # a film beyond the temperatures of its oil, see `films.heat`
ROOM = wp.constant(1024)  # more slots are needed than allocated: `Engine` allocates more and repeats the attempt

# --- values of `Control.impulsive`, and of each pair's
SMOOTH = wp.constant(0)
IMPULSIVE = wp.constant(1)  # its force keeps no history
IDLE = wp.constant(2)  # nor is it judged: a pair of negligible energy, see `impulsive_means`

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

# --- sizes of local buffers in native snippets; the scene compiler refuses what does not fit
MOST_COUPLED_COLUMNS = 512  # retained columns a gap depends on
MOST_STENCIL = 256  # nodes of the second grid under a node of the first
