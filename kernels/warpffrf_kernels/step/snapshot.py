"""State that an attempt changes while it looks for its end, kept and put back where the attempt is rejected.

Active sets, pressures, tractions and where the patch was: a halved or repeated attempt begins best from what was right.
Which arrays these are is declared (`restored` in `core.declaration`); they are flat here, worlds one behind the other.
"""

import warp as wp

from warpffrf_kernels.core.access import out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def remember_reals(ctl: wp.array(dtype=Control), now: wp.array(dtype=real), before: out(wp.array(dtype=real))):
    """Per world, lanes over entries: the array before an attempt."""
    w, lane = wp.tid()
    if ctl[w].attempt == 0:
        return
    count = now.shape[0] / ctl.shape[0]
    i = lane
    while i < count:
        before[w * count + i] = now[w * count + i]
        i += wp.block_dim()


@wp.kernel
def remember_integers(ctl: wp.array(dtype=Control), now: wp.array(dtype=int), before: out(wp.array(dtype=int))):
    """The same of integers."""
    w, lane = wp.tid()
    if ctl[w].attempt == 0:
        return
    count = now.shape[0] / ctl.shape[0]
    i = lane
    while i < count:
        before[w * count + i] = now[w * count + i]
        i += wp.block_dim()


@wp.kernel
def restore_reals(ctl: wp.array(dtype=Control), before: wp.array(dtype=real), now: out(wp.array(dtype=real))):
    """Per world, lanes over entries: the array as a rejected attempt found it."""
    w, lane = wp.tid()
    if ctl[w].attempt == 0 or ctl[w].accept != 0:
        return
    count = now.shape[0] / ctl.shape[0]
    i = lane
    while i < count:
        now[w * count + i] = before[w * count + i]
        i += wp.block_dim()


@wp.kernel
def restore_integers(ctl: wp.array(dtype=Control), before: wp.array(dtype=int), now: out(wp.array(dtype=int))):
    """The same of integers."""
    w, lane = wp.tid()
    if ctl[w].attempt == 0 or ctl[w].accept != 0:
        return
    count = now.shape[0] / ctl.shape[0]
    i = lane
    while i < count:
        now[w * count + i] = before[w * count + i]
        i += wp.block_dim()
