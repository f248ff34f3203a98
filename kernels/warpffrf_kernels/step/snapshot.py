"""State that an attempt changes while it looks for its end, kept and put back where the attempt is rejected.

Active sets, pressures, tractions and where the patch was: a halved or repeated attempt begins best from what was right.
Which arrays these are is declared (`restored` in `core.declaration`); they are flat here, each pair's part behind that
of the pair before, world by world. There is a kernel a type, as arrays of kernels have one.
"""

import warp as wp

from warpffrf_kernels.core.access import out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def is_meant(ctl: wp.array(dtype=Control), w: int, rejected: int) -> bool:
    """Whether world w takes part in the attempt, and, where `rejected` is 1, has it rejected."""
    return ctl[w].attempt != 0 and (rejected == 0 or ctl[w].accept == 0)


@wp.kernel
def copy_reals(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    rejected: int,
    source: wp.array(dtype=real),
    target: out(wp.array(dtype=real)),
):
    """Per (world, pair), lanes over entries: before an attempt, or where it is `rejected`."""
    w, pair, lane = wp.tid()
    if not is_meant(ctl, w, rejected):
        return
    pairs = models[w].pairs.count
    count = source.shape[0] / (ctl.shape[0] * pairs)
    first = (w * pairs + pair) * count
    i = lane
    while i < count:
        target[first + i] = source[first + i]
        i += wp.block_dim()


@wp.kernel
def copy_integers(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    rejected: int,
    source: wp.array(dtype=int),
    target: out(wp.array(dtype=int)),
):
    """The same of integers."""
    w, pair, lane = wp.tid()
    if not is_meant(ctl, w, rejected):
        return
    pairs = models[w].pairs.count
    count = source.shape[0] / (ctl.shape[0] * pairs)
    first = (w * pairs + pair) * count
    i = lane
    while i < count:
        target[first + i] = source[first + i]
        i += wp.block_dim()
