"""Detection of convex surfaces that pass through each other in a step without contact at either end.

In a step that is long for the speed of two bodies, one may pass through the other without contact at either end of the
step. Each then lies on the opposite side of the other: the line between them has rotated by more than a right angle.
Such an attempt is rejected, and halved. For two bodies that pass by each other, the line rotates by little in a
sufficiently short step.

The line is the normal of a lumped contact, and for a pair the line between the origins of the two surfaces, in the
plane normal to the first one's axis unless it is a ball.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lanes import total
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import matrix
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, quat, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import ContactState, LumpedState, MotionState
from warpffrf_kernels.lumped.places import is_ball
from warpffrf_kernels.normal.pair_forces import is_closed
from warpffrf_kernels.surfaces.surface import axes_of, origin_of

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def convex(model: Model, s: int) -> bool:
    """Whether a body with surface s has an opposite side."""
    return model.surfaces.side[s] > real(0.0) and model.surfaces.planar[s] == 0


@wp.func
def axes_before(p: wp.array2d(dtype=quat), w: int, body: int) -> mat33:
    if body < 0:
        return wp.identity(n=3, dtype=real)
    return matrix(p[w, body])


@wp.func
def line_between(model: Model, first: int, second: int, r_1: vec3, A_1: mat33, r_2: vec3, A_2: mat33) -> vec3:
    """Vector from the origin of a surface to that of another, of bodies at r with axes A."""
    d = r_2 + A_2 * model.surfaces.origin[second] - r_1 - A_1 * model.surfaces.origin[first]
    if is_ball(model, first) != 0:
        return d
    frame = A_1 * model.surfaces.frame[first]
    axis = vec3(frame[0, 2], frame[1, 2], frame[2, 2])
    return d - wp.dot(axis, d) * axis


@kernel
def refuse_leaps_of_places(run: Run, lumped: LumpedState):
    """Per world, lanes over points: fail an attempt in which surfaces of a lumped contact passed through each other."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].mode != k.DYNAMIC:
        return
    leapt = real(0.0)
    place = lane
    while place < model.elements[0].lumped.places:
        contact = model.elements[0].lumped.contact[place]
        both = convex(model, model.elements[0].lumped.first[contact])
        both = both and convex(model, model.elements[0].lumped.second[contact])
        apart = lumped.lumped_force[w, 0, place] == real(0.0) and lumped.lumped_force[w, 1, place] == real(0.0)
        if both and apart and wp.dot(lumped.lumped_normal[w, 0, place], lumped.lumped_normal[w, 1, place]) < real(0.0):
            leapt = real(1.0)
        place += wp.block_dim()
    if total(leapt) > real(0.0) and lane == 0:
        run.ctl[w].failure = run.ctl[w].failure | k.LEAPT


@kernel
def refuse_leaps_of_pairs(run: Run, contact: ContactState, state: MotionState, trial: Trial):
    """Per world, lanes over pairs: fail an attempt in which the surfaces of a pair passed through each other."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].mode != k.DYNAMIC:
        return
    leapt = real(0.0)
    pair = lane
    while pair < model.pairs.count:
        first = model.pairs.first[pair]
        second = model.pairs.second[pair]
        if convex(model, first) and convex(model, second):
            b_1 = model.surfaces.body[first]
            b_2 = model.surfaces.body[second]
            before = line_between(
                model, first, second, origin_of(state.r, w, b_1), axes_before(state.p, w, b_1),
                origin_of(state.r, w, b_2), axes_before(state.p, w, b_2),
            )  # fmt: skip
            after = line_between(
                model, first, second, origin_of(trial.r1, w, b_1), axes_of(trial.axes, w, b_1),
                origin_of(trial.r1, w, b_2), axes_of(trial.axes, w, b_2),
            )  # fmt: skip
            if wp.dot(before, after) < real(0.0):
                if not is_closed(contact.pair_force, w, pair, 0) and not is_closed(contact.pair_force, w, pair, 1):
                    leapt = real(1.0)
        pair += wp.block_dim()
    if total(leapt) > real(0.0) and lane == 0:
        run.ctl[w].failure = run.ctl[w].failure | k.LEAPT
