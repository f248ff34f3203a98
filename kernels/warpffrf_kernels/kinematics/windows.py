"""Window of a pair: the columns of the first grid that are evaluated, for all pairs.

The active set is stored in the contact frame: pressures stay at the patch while the material moves through it. The
window contains the active columns and MARGIN more on each side, at most the widest window that was allocated.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import AT_POINTS, PATCH
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.kinematics.closest_point import NOWHERE

wp.set_module_options(MODULE_OPTIONS)

MARGIN = wp.constant(3)  # columns evaluated beyond the active ones


@kernel
def open_window(run: Run, geometry: ContactGeometry, contact: ContactState):
    """Per (world, pair): moves the active set of the last attempt to the current patch, and sets the columns to
    evaluate: the active ones, those where the surfaces are nearest (on the line of centres at both ends of the width,
    at points `nearest` and `touched`) and MARGIN more on each side, relative to the centre column.

    A pair whose sampled gaps would only have been shifted (`locate`) is sampled again if the windows of another pair
    were placed again: its own may have grown.
    """
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].recenter == 0 or model.pairs.family[pair] == PATCH:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    H = model.window.half
    if geometry.center[w, pair, 2] != 0:
        geometry.center[w, pair, 2] = 0
        s = int(0)
        while s < (rows - 1) * model.quadrature.z_points:
            geometry.station[w, pair, s, 8] = geometry.station[w, pair, s, 0]
            s += 1
    offset = real(0.5) * (geometry.phase[w, pair, 4] + geometry.phase[w, pair, 6]) - real(geometry.center[w, pair, 0])
    shift = int(wp.floor(offset - contact.patch_offset[w, pair] + real(0.5))) * rows
    contact.patch_offset[w, pair] = offset
    size = model.window.columns * rows
    n = int(0)
    while shift != 0 and n < size:
        to = n
        if shift > 0:
            to = size - 1 - n
        source = to - shift
        contact.active[w, pair, to] = 0
        contact.pressure[w, pair, to] = real(0.0)
        if source >= 0 and source < size:
            contact.active[w, pair, to] = contact.active[w, pair, source]
            contact.pressure[w, pair, to] = contact.pressure[w, pair, source]
        n += 1
    low = int(0)
    high = int(0)
    found = int(0)
    m = int(0)
    while m < model.window.columns * rows:
        if contact.active[w, pair, m] != 0 and not wp.isfinite(
            contact.pressure[w, pair, m]
        ):  # left by a rejected attempt
            contact.active[w, pair, m] = 0
            contact.pressure[w, pair, m] = real(0.0)
        if contact.active[w, pair, m] != 0:
            o = m / rows - H
            if found == 0:
                low = o
            high = o
            found = int(1)
        m += 1
    one = geometry.phase[w, pair, 4]
    other = geometry.phase[w, pair, 6]
    if model.pairs.family[pair] == AT_POINTS:
        one = geometry.nearest[w, pair, 0]
        other = one
    first = int(wp.floor(wp.min(one, other) + real(0.5)))
    last = int(wp.floor(wp.max(one, other) + real(0.5)))
    if model.pairs.family[pair] == AT_POINTS and geometry.touched[w, pair, 0] != NOWHERE:
        first = wp.min(first, geometry.touched[w, pair, 0])
        last = wp.max(last, geometry.touched[w, pair, 1])
    first = wp.clamp(first - geometry.center[w, pair, 0], -H, H)
    last = wp.clamp(last - geometry.center[w, pair, 0], -H, H)
    if found == 0:
        low = first
        high = last
    low = wp.min(low, first)
    high = wp.max(high, last)
    geometry.window[w, pair, 0] = wp.max(low - MARGIN, -H)
    geometry.window[w, pair, 1] = wp.min(high + MARGIN, H)
