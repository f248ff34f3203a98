r"""Energy gained in a step by a lumped contact that bounces. For a point with the elastic force P at the approach a the
trapezoidal rule gains

    dU - (P_0 + P_1)/2 (a_1 - a_0),

U its elastic energy: a hardening law returns more than it stored in steps that do not resolve the bounce. The current
energy is that of the point alone, U or that of the motion along the normal, (da/h)^2/2 over the compliance of the two
bodies to a unit impulse there, 1/m + (x x n).J^-1.(x x n) of each as a free body: motion along the surfaces, in any
frame, does not contribute. A point bounces if motion and contact exchange more than SWUNG of it. Losses while the
surfaces approach are recovered while they separate: the sum of both is stored, down to the loss of all current energy,
and `decide` limits the increase per step.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.lumped.approach_laws import Push
from warpffrf_kernels.lumped.places import Side

wp.set_module_options(MODULE_OPTIONS)

# of the current energy, exchanged between motion and contact: such a step is part of an impact
SWUNG = wp.constant(wp.float64(0.01))


@wp.func
def ease_of(model: Model, side: Side, x: vec3, n: vec3) -> real:
    """Velocity along n at x due to a unit impulse there on the body of a surface, as a free body [1/kg]."""
    b = side.body
    if b < 0:
        return real(0.0)
    turn = wp.transpose(side.A) * wp.cross(x - side.r, n)
    return real(1.0) / model.bodies.mass[b] + wp.dot(turn, wp.inverse(model.bodies.inertia[b]) * turn)


@wp.func
def bounce_of(
    model: Model,
    first: Side,
    second: Side,
    x: vec3,
    n: vec3,
    before: Push,
    after: Push,
    move: real,
    rate: real,
    h: real,
) -> wp.vec3d:
    """For a point in contact: energy gained in a step [J], current energy [J], and 1 if it bounces, else 0. move:
    change of the approach [m]; rate: at the end of the step [m/s]."""
    change = after.energy - before.energy
    gain = change - real(0.5) * (before.force + after.force) * move
    speed = wp.max(wp.abs(rate), wp.abs(move) / h)
    motion = real(0.5) * speed * speed / (ease_of(model, first, x, n) + ease_of(model, second, x, n))
    hand = wp.max(motion, wp.max(before.energy, after.energy))
    bounces = real(0.0)
    if wp.min(motion, wp.abs(change)) > SWUNG * hand:
        bounces = real(1.0)
    return wp.vec3d(gain, hand, bounces)
