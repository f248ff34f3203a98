"""Spurious energy: energy created so far by the pairs and the integrator, and the end of a run in which it grows.

When a pair is open, all energy stored in its contact has been returned, and the energy that it has `created`
(`impulsive_means.judge_pairs`) is known. While it is closed, its energy also changes with the phases of the grids, and
most of that is recovered: the stored energy is the uncertainty, and only the excess over it counts as created. A run
ends if this sum has risen above its minimum by more than `gain_limit` of the largest energy (of all lines except the
potential).

The numerical line of the ledger is the error of the integrator. It oscillates with the motion, and is as large as the
energy when a drive starts to move a machine from rest; so it counts, together with the energy created by the pairs,
only if it stays too high for PATIENCE steps in a row.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lanes import total
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.state import ContactState

wp.set_module_options(MODULE_OPTIONS)


PATIENCE = wp.constant(30)  # steps: a starting drive has moved the machine by then


@kernel
def watch_energy(run: Run, contact: ContactState):
    """Per world after an accepted step, lanes over pairs: `made` (W, pairs), the energy that each certainly created."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or run.ctl[w].mode != k.DYNAMIC:
        return
    by_pairs = real(0.0)
    pair = lane
    while pair < model.pairs.count:
        doubt = contact.pair_energy[w, pair, 0]
        contact.made[w, pair] = wp.clamp(
            contact.made[w, pair], contact.created[w, pair] - doubt, contact.created[w, pair] + doubt
        )
        by_pairs += contact.made[w, pair]
        pair += wp.block_dim()
    by_pairs = total(by_pairs)
    if lane != 0:
        return
    line = int(0)
    while line < k.LINES:
        if line != k.POTENTIAL and line != k.NUMERICAL and line != k.CONTACT_GRID:
            run.clk[w].most = wp.max(run.clk[w].most, wp.abs(run.energy[w, 0, line]))
        line += 1
    run.clk[w].least = wp.min(run.clk[w].least, by_pairs)
    rise = by_pairs - run.clk[w].least
    made = by_pairs + run.energy[w, 0, k.NUMERICAL]
    run.clk[w].made = wp.max(rise, made)
    if model.limits.gain_limit == real(0.0):
        return
    limit = wp.max(model.limits.gain_limit * run.clk[w].most, run.clk[w].noise)
    if run.ctl[w].sub == 0:  # a whole step
        run.ctl[w].gaining_steps = run.ctl[w].gaining_steps + 1
    if made <= limit:
        run.ctl[w].gaining_steps = 0
    if rise > limit or run.ctl[w].gaining_steps > PATIENCE:
        run.ctl[w].status = run.ctl[w].status | k.GAIN
