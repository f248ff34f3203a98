"""Columns of the two control arrays of a world: integers `ctl (W, CTL)` and reals `clk (W, CLK)`, and the failure
bits.
"""

import warp as wp

# --- integers
RUN = wp.constant(0)  # 1 while the Newton loop of this world goes on
MOVED = wp.constant(1)  # 1 when the outer coordinates changed since the last evaluation
REASSEMBLE = wp.constant(2)  # 1 when the grids moved against each other, so that every row of G is new
ITERATION = wp.constant(3)  # Newton iterations of this attempt
INNER = wp.constant(4)  # active-set solves of this attempt
CHANGES = wp.constant(5)  # modes that changed sides in the last solve
FAILURE = wp.constant(6)  # failure bits of this attempt
SLOTS = wp.constant(7)  # rows of G in use
FRESH = wp.constant(8)  # first row of G not yet assembled
ACTIVE = wp.constant(9)  # active modes
MODE = wp.constant(10)  # DYNAMIC, STATIC, PROJECT or START
STATUS = wp.constant(11)  # failure bits that stopped this world for good
LEVEL = wp.constant(12)  # the step in use is the user's step / 2**LEVEL
SUB = wp.constant(13)  # how many such steps of the current user step are done
STEP = wp.constant(14)  # user steps done
TARGET = wp.constant(15)  # user steps to do in this chunk
SAVED = wp.constant(16)  # rows written to the ring
REJECTED = wp.constant(17)  # rejected attempts so far
WORST = wp.constant(18)  # largest number of iterations of an accepted step
TOUCHED = wp.constant(19)  # active modes before the attempt, restored when it is rejected
ITERATIONS = wp.constant(21)  # Newton iterations, all accepted steps
STEPS = wp.constant(22)  # accepted steps
REASON = wp.constant(23)  # failure bits of all rejected attempts
PENDING = wp.constant(24)  # iterations since the last saved row
PENDING_SOLVES = wp.constant(25)
SPARE = wp.constant(26)  # capacity, or slots, that would do, where there are too few
EDGE = wp.constant(27)  # 1 when a patch ran onto the end of a contact surface that covers an arc only
ATTEMPT = wp.constant(28)  # 1 when this world takes part in the attempt
ACCEPT = wp.constant(29)  # 1 when the attempt was accepted
RECORD = wp.constant(30)  # 1 when the accepted state is to be saved
EVERY = wp.constant(31)  # save every so many user steps
REFRESH = wp.constant(32)  # 1 when the outer matrix is to be inverted anew
RECENTER = wp.constant(33)  # 1 when the windows are to be laid anew
COARSE = wp.constant(34)  # steps less accurate than asked for, taken as they could not be halved again
CELLS = wp.constant(35)  # cell slots of friction in use
FRESH_CELLS = wp.constant(36)  # first cell slot not yet assembled
STALE = wp.constant(37)  # 1 when every cell slot is to be assembled anew
SOLVES = wp.constant(38)  # factorisations of stick and slip so far
FACTORED = wp.constant(39)  # free coordinates of the factorisation of stick and slip at hand, 0 without
SUDDEN = wp.constant(40)  # how contact acts on dynamic local modes in this step and the next: see `impulsive_contact`
REPEATED = wp.constant(41)  # attempts repeated because of what contact did in them
DOWNHILL = wp.constant(42)  # 1 when a static step must not end higher than it began
AGAIN = wp.constant(43)  # 1 when the attempt repeats one with more impulsive pairs
ROUND = wp.constant(44)  # rounds of the mean forces of impulsive pairs in this attempt
EVEN = wp.constant(45)  # 1 when these means give back the energy of their pairs
REWEIGHED = wp.constant(46)  # 1 when their weights have changed since the rows of G were assembled
IMPULSES = wp.constant(47)  # accepted steps in which a pair was impulsive and touched
SHAKEN = wp.constant(48)  # 1 when the step before was impulsive, or halved after one that was
SPELL = wp.constant(49)  # steps in a row with a numerical line too high, see `energy_watch`
TRAPEZOIDAL = wp.constant(50)  # 1 when the attempt acts by the trapezoidal rule from true accelerations
CTL = 51

# --- reals
START_TIME = wp.constant(0)
USER_STEP = wp.constant(1)
TIME = wp.constant(2)
H = wp.constant(3)
NEXT_TIME = wp.constant(4)
ALPHA_M = wp.constant(5)
ALPHA_F = wp.constant(6)
BETA = wp.constant(7)
GAMMA = wp.constant(8)
ACC = wp.constant(9)  # d(acceleration)/d(displacement)
VEL = wp.constant(10)  # d(velocity)/d(displacement)
MOVE = wp.constant(11)  # largest displacement of a static step [m]
DONE_STEP = wp.constant(12)  # size of the last accepted step
ERROR = wp.constant(13)  # local error of the attempt over the accuracy asked for
LOCAL = wp.constant(14)  # ALPHA_M to VEL of the local modes that step by themselves
GAINED = wp.constant(20)  # energy gained in impacts so far, each over the energy at hand, losses taken off
RISE = wp.constant(21)  # what a static step gained in energy, over the largest change of a line of it
MOST = wp.constant(22)  # largest energy of the run so far [J] of all lines but the potential
MADE = wp.constant(23)  # energy that came from nowhere, see `energy_watch`
LEAST = wp.constant(24)  # least of what the pairs have made so far
NOISE = wp.constant(25)  # of that: what is round-off
CLK = 26

# --- values
DYNAMIC = wp.constant(0)
STATIC = wp.constant(1)
START = wp.constant(2)
PROJECT = wp.constant(3)

NOT_CONVERGED = wp.constant(1)
CYCLING = wp.constant(2)
CAPACITY = wp.constant(4)
NOT_FINITE = wp.constant(8)
UNDERFLOW = wp.constant(16)
SINGULAR = wp.constant(32)
ENERGY = wp.constant(64)
INDEFINITE = wp.constant(128)
STENCIL = wp.constant(256)
ACCURACY = wp.constant(512)
GAIN = wp.constant(2048)  # more energy has come from nowhere than allowed, see `energy_watch`
ROOM = wp.constant(1024)  # more slots are in play than there is room for: `Engine` makes more and tries again

# --- values of SUDDEN
SMOOTH = wp.constant(0)
IMPULSIVE = wp.constant(1)  # its force keeps no memory

# --- constraint row kinds
TRANSLATION = wp.constant(0)
DIRECTION = wp.constant(1)
ANGLE = wp.constant(2)
DISTANCE = wp.constant(3)
SECOND_ANGLE = wp.constant(4)
BUSHING = wp.constant(5)

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
