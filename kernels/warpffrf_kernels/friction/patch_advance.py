"""Advance of the patch of a pair with friction in a step, in columns of the first grid.

A cell that enters the patch within a step has the creep of the whole step, so the patch should advance by at most one
column per step. The position of the patch is the point where the surfaces are nearest: with parallel-axes kinematics
the phase of the line of centres, otherwise the point found by `closest_point`. That point is the global minimum, and if
a pair has two patches it may jump from one to the other while neither moves. The patch is therefore tracked: starting
from its position at the end of the last step, the minimum of the gap is located at the poses of this step, in the same
section; the distance between the two is the advance. The next step starts from the global minimum, in whichever patch
it lies.

The largest advance since the last saved row is kept with the state, so none is missed if not all steps are saved.
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
    last saved row, and the present position: column and z [m] on the first surface (z only for closest-point pairs)."""
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
