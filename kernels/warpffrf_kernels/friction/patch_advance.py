"""How far the patch of a pair with friction advances in a step, in columns of the first grid.

A cell that enters the patch within a step is charged with the creep of the whole step, so the patch should advance by
one column a step at most. Where the patch is, is where the surfaces are nearest: on the line of centres its phase, else
the place that `closest_point` finds. That place is the nearest of all, and where one pair touches in two patches it may
pass from one to the other while neither moves. So the patch is followed: from its place at the end of the last step,
the minimum of the gap is looked for again at the poses of this one, in the same section; the way between the two is
what the patch advanced. The next step starts from the nearest place of all, whichever patch that is.

The largest advance since the last saved row is kept with the state, so that none is missed where not all are saved.
"""

import warp as wp

from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.model import AT_POINTS, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.friction.cells import rubs_on_grid
from warpffrf_kernels.kinematics.closest_point import settle, view_of
from warpffrf_kernels.kinematics.line_of_centres import wrap

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def follow_patch(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    phase: wp.array3d(dtype=real),
    nearest: wp.array3d(dtype=real),
    history_phase: inout(wp.array2d(dtype=real)),
    history_z: inout(wp.array2d(dtype=real)),
    most_advanced: inout(wp.array2d(dtype=real)),
    advanced: out(wp.array2d(dtype=real)),
):
    """Per (world, pair with friction), after an accepted attempt: columns `advanced` (signed), the largest since the
    last saved row, and the place now: column and z [m] on the first surface (z of pairs at points alone)."""
    w, pair = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0 or ctl[w].accept == 0 or not rubs_on_grid(model, pair):
        return
    A = model.pairs.first[pair]
    before = history_phase[w, pair]
    at = real(0.5) * (phase[w, pair, 4] + phase[w, pair, 6])
    now = at
    if model.pairs.family[pair] == AT_POINTS:
        at = nearest[w, pair, 0]
        B = model.pairs.second[pair]
        now = settle(model, A, B, view_of(model, w, pair, r1, axes), before, history_z[w, pair])
        history_z[w, pair] = nearest[w, pair, 1]
    way = now - before
    if model.surfaces.turn[A] > 0:
        way = wrap(way, real(model.surfaces.turn[A]), real(0.0))
    history_phase[w, pair] = at
    advanced[w, pair] = way
    if is_whole(ctl, w):
        most_advanced[w, pair] = wp.max(most_advanced[w, pair], wp.abs(way))
    else:
        most_advanced[w, pair] = real(0.0)
