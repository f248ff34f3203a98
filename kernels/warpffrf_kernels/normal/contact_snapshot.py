"""The contact as an attempt finds it, kept and put back: active sets, pressures, and where the patch was.

A rejected attempt has changed all of them; a halved or repeated one begins best from a set that was right.
"""

import warp as wp

from warpffrf_kernels.core.access import out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def remember_contact(
    ctl: wp.array(dtype=Control),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    patch_offset: wp.array2d(dtype=real),
    active_before: out(wp.array3d(dtype=int)),
    pressure_before: out(wp.array3d(dtype=real)),
    offset_before: out(wp.array2d(dtype=real)),
):
    """Per (world, pair), lanes over hats: the active set and the pressures before an attempt."""
    w, pair, lane = wp.tid()
    if ctl[w].attempt == 0:
        return
    m = lane
    while m < active.shape[2]:
        active_before[w, pair, m] = active[w, pair, m]
        pressure_before[w, pair, m] = pressure[w, pair, m]
        m += wp.block_dim()
    if lane == 0:
        offset_before[w, pair] = patch_offset[w, pair]


@wp.kernel
def restore_contact(
    ctl: wp.array(dtype=Control),
    active_before: wp.array3d(dtype=int),
    pressure_before: wp.array3d(dtype=real),
    offset_before: wp.array2d(dtype=real),
    active: out(wp.array3d(dtype=int)),
    pressure: out(wp.array3d(dtype=real)),
    patch_offset: out(wp.array2d(dtype=real)),
):
    """Per (world, pair), lanes over hats: a rejected attempt leaves the contact as it found it, so that the halved one
    begins from a set that was right.
    """
    w, pair, lane = wp.tid()
    if ctl[w].attempt == 0 or ctl[w].accept != 0:
        return
    m = lane
    while m < active.shape[2]:
        active[w, pair, m] = active_before[w, pair, m]
        pressure[w, pair, m] = pressure_before[w, pair, m]
        m += wp.block_dim()
    if lane == 0:
        patch_offset[w, pair] = offset_before[w, pair]
