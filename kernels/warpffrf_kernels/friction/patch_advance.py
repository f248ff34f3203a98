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

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.model import AT_POINTS
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import FrictionState
from warpffrf_kernels.friction.cells import rubs_on_grid
from warpffrf_kernels.kinematics.closest_point import settle, view_of
from warpffrf_kernels.kinematics.line_of_centres import wrap

wp.set_module_options(MODULE_OPTIONS)


@kernel
def follow_patch(run: Run, trial: Trial, geometry: ContactGeometry, friction: FrictionState, cells: FrictionCells):
    """Per (world, pair with friction), after an accepted attempt: columns `advanced` (signed), the largest since the
    last saved row, and the place now: column and z [m] on the first surface (z of pairs at points alone)."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].accept == 0 or not rubs_on_grid(model, pair):
        return
    A = model.pairs.first[pair]
    before = friction.history_phase[w, pair]
    at = real(0.5) * (geometry.phase[w, pair, 4] + geometry.phase[w, pair, 6])
    now = at
    if model.pairs.family[pair] == AT_POINTS:
        at = geometry.nearest[w, pair, 0]
        B = model.pairs.second[pair]
        now = settle(model, A, B, view_of(model, w, pair, trial), before, friction.history_z[w, pair])
        friction.history_z[w, pair] = geometry.nearest[w, pair, 1]
    way = now - before
    if model.surfaces.turn[A] > 0:
        way = wrap(way, real(model.surfaces.turn[A]), real(0.0))
    friction.history_phase[w, pair] = at
    cells.advanced[w, pair] = way
    if is_whole(run.ctl, w):
        friction.most_advanced[w, pair] = wp.max(friction.most_advanced[w, pair], wp.abs(way))
    else:
        friction.most_advanced[w, pair] = real(0.0)
