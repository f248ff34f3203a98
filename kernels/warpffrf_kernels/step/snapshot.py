"""Snapshot of the state that an attempt changes, restored if the attempt is rejected.

Active sets, pressures, tractions and patch positions: a halved or repeated attempt starts best from the accepted ones.
The arrays are declared (`restored` in `core.declaration`); they are flat here, pair by pair, world by world. There is
one kernel per type, as kernel arrays have one type.
"""

import warp as wp

from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def is_meant(ctl: wp.array(dtype=Control), w: int, rejected: int) -> bool:
    """Whether world w takes part in the attempt, and, if `rejected` is 1, has it rejected."""
    return ctl[w].attempt != 0 and (rejected == 0 or ctl[w].accept == 0)


@kernel
def copy_reals(run: Run, rejected: int, source: wp.array(dtype=real), target: wp.array(dtype=real)):
    """Per (world, pair), lanes over entries: before an attempt, or if it is `rejected`."""
    w, pair, lane = wp.tid()
    if not is_meant(run.ctl, w, rejected):
        return
    pairs = run.models[w].pairs.count
    count = source.shape[0] / (run.ctl.shape[0] * pairs)
    first = (w * pairs + pair) * count
    i = lane
    while i < count:
        target[first + i] = source[first + i]
        i += wp.block_dim()


@kernel
def copy_integers(run: Run, rejected: int, source: wp.array(dtype=int), target: wp.array(dtype=int)):
    """The same for integers."""
    w, pair, lane = wp.tid()
    if not is_meant(run.ctl, w, rejected):
        return
    pairs = run.models[w].pairs.count
    count = source.shape[0] / (run.ctl.shape[0] * pairs)
    first = (w * pairs + pair) * count
    i = lane
    while i < count:
        target[first + i] = source[first + i]
        i += wp.block_dim()
