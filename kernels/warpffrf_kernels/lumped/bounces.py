r"""What a step gains of a lumped contact that bounces. Of a place with the elastic force P at the approach a the
trapezoidal rule gains

    dU - (P_0 + P_1)/2 (a_1 - a_0),

U its elastic energy: a hardening law gives more than it took in steps that do not resolve the bounce. The energy at
hand is that of the place alone, U or that of the motion along the normal, (da/h)^2/2 over the compliance of the two
bodies to a unit impulse there, 1/m + (x x n).J^-1.(x x n) of each taken as free: whatever travels along the surfaces,
in whatever frame, has no part in it. A place bounces where the two exchange more than SWUNG of it. What is lost as the
surfaces close comes back as they part: the sum of both is kept, down to the loss of all that is at hand, and `decide`
limits what a step adds to it.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.lumped.approach_laws import Push
from warpffrf_kernels.lumped.places import Side

wp.set_module_options(MODULE_OPTIONS)

# of the energy at hand, exchanged between motion and contact: such a step is part of an impact
SWUNG = wp.constant(wp.float64(0.01))


@wp.func
def ease_of(model: Model, side: Side, x: vec3, n: vec3) -> real:
    """Velocity along n at x that a unit impulse there gives the body of a surface, taken as free [1/kg]."""
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
    """Of a place that touches: what a step gains of it [J], the energy at hand [J], and 1 where it bounces, else 0.
    move: change of the approach [m]; rate: at the end of the step [m/s]."""
    change = after.energy - before.energy
    gain = change - real(0.5) * (before.force + after.force) * move
    speed = wp.max(wp.abs(rate), wp.abs(move) / h)
    motion = real(0.5) * speed * speed / (ease_of(model, first, x, n) + ease_of(model, second, x, n))
    hand = wp.max(motion, wp.max(before.energy, after.energy))
    bounces = real(0.0)
    if wp.min(motion, wp.abs(change)) > SWUNG * hand:
        bounces = real(1.0)
    return wp.vec3d(gain, hand, bounces)
