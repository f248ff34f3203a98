r"""Cells that the patch reaches during a step: their resistance to the rest of the step.

Slip is counted over the whole step. Material that the patch reaches after the part 1 - phi of the step slides freely
until then; only the later slip is resisted. With the other tractions linear in time and its own growing from zero at
that moment, the elastic slip until contact is (1 - phi) (e_1 - e_0 - c tau), c tau the displacement by the cell's own
traction, and the rigid one (1 - phi) s_r.
"No slip since contact" is then, divided by phi,

    s + k tau = 0,      k = (1 - phi)/phi c,      s the slip of the whole step:

a softness on the diagonal, zero for a cell that was under pressure all the time, and so large for one just reached that
it carries no traction yet. Its work is tau.s = -k tau^2, so it never supplies energy.

What one cell gains, the others lose, so the displacement far away, common to all of them, must not count:
c = 2 (D_mm - D_mn) area, n the cell behind. The patch advances by a columns in the step, and its edge is d columns
ahead of the node: then (1 - phi)/phi = a/d - 1. The pressure of the last node grows in proportion to the distance of
the edge beyond it, up to 0.91 of its neighbour's a column later (half-planes of 5 to 12 cells in a half-width, every
phase). A cell's front makes contact half a column before its node; 1/8 is added to d. The factor 2 and the 1/8 are
measured: with them the error of Carter's force is 0.5 % at eight cells in a half-width, at every phase of the grid and
at up to two cells per step; with cells that count the whole step it is 1 to 6 % high, depending on the phase, and
3 to 7 % at two (docs/studies/carter.md).

A node that was under pressure before is not reached anew, whatever the computed advance (which may jump if there are
two patches). The advance along the rows is not known: cells reached in that direction count the whole step.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.model import AT_POINTS, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.state import ContactState, FrictionState
from warpffrf_kernels.friction.cell_forces import before_at
from warpffrf_kernels.friction.cells import rubs_on_grid
from warpffrf_kernels.friction.traction_bounds import pressed
from warpffrf_kernels.kinematics.line_of_centres import wrap
from warpffrf_kernels.surfaces.responses import own_load, place_in_table

wp.set_module_options(MODULE_OPTIONS)

COLUMNS_PER_RATIO = wp.constant(wp.float64(1.1))  # edge beyond the last node, over its pressure's ratio to the next
BOTH = wp.constant(wp.float64(2.0))  # what a cell gains, its neighbour loses
AHEAD = wp.constant(wp.float64(0.125))  # columns; between the contact of the node, 0, and that of the cell's front, 1/2
# columns: a cell that the edge has not reached resists like one it has passed by this much, so a stationary patch
# (advances of less) is not affected and gross sliding still loads every cell
JUST_REACHED = wp.constant(wp.float64(0.02))


@wp.func
def advanced_columns(model: Model, w: int, pair: int, geometry: ContactGeometry, friction: FrictionState) -> real:
    """Columns of the first grid by which the patch has advanced since the end of the last step."""
    at = real(0.5) * (geometry.phase[w, pair, 4] + geometry.phase[w, pair, 6])
    if model.pairs.family[pair] == AT_POINTS:
        at = geometry.nearest[w, pair, 0]
    advanced = at - friction.history_phase[w, pair]
    A = model.pairs.first[pair]
    if model.surfaces.turn[A] > 0:
        advanced = wrap(advanced, real(model.surfaces.turn[A]), real(0.0))
    return advanced


@wp.func
def response_between(
    model: Model, w: int, pair: int, m: int, n: int, geometry: ContactGeometry, cells: FrictionCells
) -> real:
    """Circumferential displacement of both surfaces' local modes, mean over cell n, due to a circumferential unit force
    on cell m of the same row [m/N]."""
    rows = model.surfaces.rows[model.pairs.first[pair]]
    origin = geometry.center[w, pair, 0] - model.window.half
    total = real(0.0)
    table = model.responses.tangential[own_load(model, 2 * pair)]
    at = place_in_table(model, table, origin + m / rows, m % rows, origin + n / rows)
    if at >= 0:
        total = model.responses.number[at + n % rows]
    if model.surfaces.shear_start[model.pairs.second[pair]] < 0:
        return total
    table_b = model.responses.tangential[own_load(model, 2 * pair + 1)]
    origin_b = geometry.center[w, pair, 1] - model.window.second_half
    shares = model.window.share_columns * model.window.share_rows
    i = int(0)
    while i < shares:
        j = int(0)
        while cells.share[w, pair, m, i] != real(0.0) and j < shares:
            if cells.share[w, pair, n, j] != real(0.0):
                source = origin_b + cells.share_at[w, pair, m, 0] + i / model.window.share_rows
                target = origin_b + cells.share_at[w, pair, n, 0] + j / model.window.share_rows
                line = cells.share_at[w, pair, m, 1] + i % model.window.share_rows
                at = place_in_table(model, table_b, source, line, target)
                if at >= 0:
                    at += cells.share_at[w, pair, n, 1] + j % model.window.share_rows
                    total += cells.share[w, pair, m, i] * cells.share[w, pair, n, j] * model.responses.number[at]
            j += 1
        i += 1
    return total


@wp.func
def lag_of_touch(
    model: Model, w: int, pair: int, m: int, advanced: real, low: int, high: int, contact: ContactState,
    cells: FrictionCells, geometry: ContactGeometry,
) -> real:  # fmt: skip
    """(1 - phi)/phi = a/d - 1 of cell m, at least 0."""
    ahead = model.surfaces.rows[model.pairs.first[pair]]
    if advanced < real(0.0):
        ahead = -ahead
    # the last node under pressure ahead of the cell, or the one behind it
    last = m
    d = real(0.0)
    if not (pressed(model, w, pair, m, low, high, contact, cells, geometry) > real(0.0)):
        last = m - ahead
        d = real(-1.0)
    here = pressed(model, w, pair, last, low, high, contact, cells, geometry)
    if not (here > real(0.0)):
        return real(0.0)  # outside the patch
    following = pressed(model, w, pair, last + ahead, low, high, contact, cells, geometry)
    while following > real(0.0):
        last += ahead
        d += real(1.0)
        if d > wp.abs(advanced):
            return real(0.0)
        here = following
        following = pressed(model, w, pair, last + ahead, low, high, contact, cells, geometry)
    behind = pressed(model, w, pair, last - ahead, low, high, contact, cells, geometry)
    ratio = real(1.0)
    if behind > real(0.0):
        ratio = wp.min(COLUMNS_PER_RATIO * here / behind, real(1.0))
    d += ratio + AHEAD
    return wp.max(wp.abs(advanced) / wp.max(d, JUST_REACHED) - real(1.0), real(0.0))


@kernel
def soften_late(
    run: Run, geometry: ContactGeometry, friction: FrictionState, contact: ContactState, cells: FrictionCells,
    of_state: int,
):  # fmt: skip
    """Per (world, pair), lanes over cells: the softness `late` [m/Pa] of the loaded cells. last_normal: zero if the
    last step ended without contact; the patch then has no previous position. apart: D_mm - D_mn of the cells requested
    since the bodies have moved, -1 for the others."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not rubs_on_grid(model, pair):
        return
    if (of_state != 0 and run.ctl[w].moved == 0) or (of_state == 0 and run.ctl[w].changes != 0):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    low = (geometry.window[w, pair, 0] + model.window.half) * rows
    high = (geometry.window[w, pair, 1] + model.window.half + 1) * rows - 1
    advanced = real(0.0)
    if wp.length(friction.contact_normal[w, pair]) > real(0.0):
        advanced = advanced_columns(model, w, pair, geometry, friction)
    m = lane
    while m < model.window.columns * rows:
        soft = real(0.0)
        if of_state != 0:
            cells.apart[w, pair, m] = real(-1.0)
        if cells.bound[w, pair, m] > real(0.0) and advanced != real(0.0):
            old = before_at(model, w, pair, rows, m, geometry, friction)
            touched = int(0)
            if old >= 0:
                touched = friction.pressed_before[w, pair, old]
            lag = real(0.0)
            if touched == 0:
                lag = lag_of_touch(model, w, pair, m, advanced, low, high, contact, cells, geometry)
            n = m - rows
            if (advanced < real(0.0) or n < low) and m + rows <= high:
                n = m + rows
            if lag > real(0.0) and n >= low:
                if cells.apart[w, pair, m] < real(0.0):
                    own = response_between(model, w, pair, m, m, geometry, cells)
                    less = own - response_between(model, w, pair, m, n, geometry, cells)
                    cells.apart[w, pair, m] = wp.max(less, real(0.0))
                soft = BOTH * cells.apart[w, pair, m] * cells.cell_area[w, pair, m] * lag
        cells.late[w, pair, m] = soft
        m += wp.block_dim()


@kernel
def keep_pressed(run: Run, geometry: ContactGeometry, contact: ContactState, friction: FrictionState):
    """Per (world, pair), lanes over cells: nodes under pressure at the end of an accepted step, for the next one."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].accept == 0 or not rubs_on_grid(model, pair):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    m = lane
    while m < model.window.columns * rows:
        o = m / rows - model.window.half
        inside = o >= geometry.window[w, pair, 0] and o <= geometry.window[w, pair, 1]
        friction.pressed_before[w, pair, m] = 0
        if inside and contact.active[w, pair, m] != 0 and contact.pressure[w, pair, m] > real(0.0):
            friction.pressed_before[w, pair, m] = 1
        m += wp.block_dim()
