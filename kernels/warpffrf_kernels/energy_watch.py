"""Energy from nowhere: what the pairs and the integrator have made so far, and the end of a run that goes on like that.

Where a pair is open, all that its contact has taken is given back, and what it has `created`
(`impulsive_means.judge_pairs`) it has made or lost. While it is closed its energy also changes with the phases of the
grids, and most of that comes back: what it holds is left in doubt, and made is what it has given to the motion beyond.
A run in which that has risen by more than `most_made` of the largest energy (of all lines but the potential) above its
least ends there.

The numerical line of the ledger is the error of the integrator. It goes up and down with the motion, and is as large as
the energy where a drive begins to move a machine at rest; so it counts, with what the pairs have made, where it stays
too high for PATIENCE steps in a row.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.access import inout
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


PATIENCE = wp.constant(30)  # steps: a drive that begins has moved the machine by then


@wp.kernel
def watch_energy(
    models: wp.array(dtype=Model),
    energy: wp.array3d(dtype=real),
    pair_energy: wp.array3d(dtype=real),
    created: wp.array2d(dtype=real),
    made: inout(wp.array2d(dtype=real)),
    ctl: inout(wp.array2d(dtype=int)),
    clk: inout(wp.array2d(dtype=real)),
):
    """Per world, after an accepted step: `made` (W, pairs), what each pair has created beyond doubt."""
    w = wp.tid()
    model = models[0]
    if ctl[w, k.ACCEPT] == 0 or ctl[w, k.MODE] != k.DYNAMIC:
        return
    line = int(0)
    while line < k.LINES:
        if line != k.POTENTIAL and line != k.NUMERICAL and line != k.CONTACT_GRID:
            clk[w, k.MOST] = wp.max(clk[w, k.MOST], wp.abs(energy[w, 0, line]))
        line += 1
    by_pairs = real(0.0)
    pair = int(0)
    while pair < model.pair_count:
        doubt = pair_energy[w, pair, 0]
        made[w, pair] = wp.clamp(made[w, pair], created[w, pair] - doubt, created[w, pair] + doubt)
        by_pairs += made[w, pair]
        pair += 1
    clk[w, k.LEAST] = wp.min(clk[w, k.LEAST], by_pairs)
    rise = by_pairs - clk[w, k.LEAST]
    total = by_pairs + energy[w, 0, k.NUMERICAL]
    clk[w, k.MADE] = wp.max(rise, total)
    if model.most_made == real(0.0):
        return
    limit = wp.max(model.most_made * clk[w, k.MOST], clk[w, k.NOISE])
    if ctl[w, k.SUB] == 0:  # a whole step
        ctl[w, k.SPELL] = ctl[w, k.SPELL] + 1
    if total <= limit:
        ctl[w, k.SPELL] = 0
    if rise > limit or ctl[w, k.SPELL] > PATIENCE:
        ctl[w, k.STATUS] = ctl[w, k.STATUS] | k.GAIN
