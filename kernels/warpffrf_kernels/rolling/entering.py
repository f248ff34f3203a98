r"""Cells of a patch that material enters during a step: the part of the step that they resist.

Slip is counted over the whole step, but material that enters the patch slides freely until contact. As in
`friction.entering_cells`, a softness k on the diagonal accounts for this; "no slip since contact" is

    s + k tau = 0,      k = 2 (g(0) - g(w)) lag,      lag = min(c, 1) max(max(c, 1)/d - 1, 0),

c the cells by which the patch advances, d those from the centre of a cell to the point of first contact, g(0) and g(w)
the displacement per traction of a cell and of its neighbour behind. For c >= 1 the lag is a/d - 1. Contact-fixed cells
stay under pressure while material passes: at smaller steps, the history interpolated between the last cell and the free
one beyond the edge contains c of the gain over a whole cell, though only d of that lies inside. The softness therefore
acts in every step, in proportion to c, and vanishes for a stationary patch.

The edge lies d_e cells beyond the centre of the last cell under pressure ahead, with r the ratio of its pressure to the
next one's, at most 0.75,

    d_e = -0.175 + 0.95 r + 0.6 r^2,      d = cells up to the last one + d_e + 0.35 - 0.15 min(c, 1).

A patch that advances by more than its length contains no previous material: the step is rejected, except for a pair
that carries less than MAY_PASS of the largest load of the scene. The length of a patch is proportional to the root of
its load; rollers that enter or leave the load zone, or are loaded by their weight only, would otherwise limit the step
of a whole bearing. The traction -s/k of a step that is accepted nevertheless has no transient: it is that of steady
rolling with an error of 5 to 25 % of mu p at one length, of up to 47 % at several (on half-planes, 4 to 9 cells in a
half-width); at most a fifth of that relative to the largest load of the scene.

Measured on half-planes (docs/studies/patch_rolling.md): Carter's force within 1 % of mu P from five cells in a
half-width on, 0.1 to 4 cells per step, at every phase; with cells that count the whole step it is 3 to 10 % high.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.state import ContactState, FrictionState
from warpffrf_kernels.friction.cells import rubs_on_patch
from warpffrf_kernels.kinematics.line_of_centres import wrap
from warpffrf_kernels.normal.pair_forces import load_share
from warpffrf_kernels.patch.cells import ROW_COLUMNS, row_place
from warpffrf_kernels.rolling.places import strip_columns
from warpffrf_kernels.rolling.shear import STRIPS_AROUND, shear_line

wp.set_module_options(MODULE_OPTIONS)

# Fitted to pressures of Hertz line contact computed on cells, for all phases of four and more in a half-width: the edge
# beyond the centre of the last cell, in cells, as a function of the ratio of its pressure to the next
EDGE = wp.constant(wp.vec3d(-0.175, 0.95, 0.6))
STEEPEST = wp.constant(wp.float64(0.75))
ALONE = wp.constant(wp.float64(0.5))  # the same for a row with one cell under pressure
OFFSET = wp.constant(wp.vec2d(0.35, -0.15))  # cells, measured with Carter's force
LEAST = wp.constant(wp.float64(0.02))  # cells: lower limit of d
MAY_PASS = wp.constant(wp.float64(0.2))  # of the largest load of a pair
BOTH = wp.constant(wp.float64(2.0))  # what a cell gains, its neighbour loses


@wp.func
def advance_of(
    model: Model, elements: Elements, w: int, pair: int, row: int, patch: PatchScratch, friction: FrictionState
) -> wp.vec2d:
    """Columns of the first grid, and z [m], by which a row of the patch has advanced over the first body since the end
    of the last step; zero without one. Rows of helical surfaces advance by different arcs."""
    if friction.ring_place[w, pair, 2] == real(0.0):
        return wp.vec2d(real(0.0), real(0.0))
    A = elements.patches.first[pair]
    way = patch.patch_place[w, pair, ROW_COLUMNS + row] - friction.ring_place[w, pair, ROW_COLUMNS + row]
    if model.surfaces.turn[A] > 0:
        way = wrap(way, real(model.surfaces.turn[A]), real(0.0))
    along = real(0.0)
    if elements.patches.follows[pair] != 0:
        along = patch.patch_place[w, pair, 1] - friction.ring_place[w, pair, 1]
    return wp.vec2d(way, along)


@wp.func
def cells_advanced(
    model: Model, elements: Elements, w: int, pair: int, row: int, patch: PatchScratch, friction: FrictionState
) -> wp.vec2d:
    """Cells by which a row of the patch has advanced, in columns or in rows, whichever is more, and 1 if it is in rows;
    zero if the last step ended without contact."""
    if wp.length(friction.contact_normal[w, pair]) == real(0.0):
        return wp.vec2d(real(0.0), real(0.0))
    advanced = advance_of(model, elements, w, pair, row, patch, friction)
    cells = advanced[0] / strip_columns(model, elements, w, pair, patch.patch_place)
    if elements.patches.follows[pair] != 0:
        up = advanced[1] / row_place(elements, pair, 0, patch.patch_place, w)[1]
        if wp.abs(up) > wp.abs(cells):
            return wp.vec2d(up, real(1.0))
    return wp.vec2d(cells, real(0.0))


@wp.func
def cells_to_edge(
    w: int, pair: int, column: int, row: int, ahead: int, across: int, columns: int, rows: int,
    bound: wp.array3d(dtype=real),
) -> real:  # fmt: skip
    """Cells from the centre of a cell under pressure to the edge of the patch ahead: `ahead` +1 or -1 in columns, or,
    with `across` 1, in rows."""
    last = int(0)
    here = bound[w, pair, column * rows + row]
    before = real(0.0)
    i = int(1)
    go = int(1)
    while go != 0:
        c = column + ahead * i
        r = row
        if across != 0:
            c = column
            r = row + ahead * i
        go = int(0)
        if c >= 0 and c < columns and r >= 0 and r < rows:
            next = bound[w, pair, c * rows + r]
            if next > real(0.0):
                before = here
                here = next
                last = i
                go = int(1)
        i += 1
    if last == 0:  # it is the last one: use its neighbour behind
        c = column - ahead
        r = row
        if across != 0:
            c = column
            r = row - ahead
        if c >= 0 and c < columns and r >= 0 and r < rows:
            before = bound[w, pair, c * rows + r]
    beyond = ALONE
    if before > real(0.0):
        ratio = wp.min(here / before, STEEPEST)
        beyond = EDGE[0] + EDGE[1] * ratio + EDGE[2] * ratio * ratio
    return real(last) + beyond


@kernel
def soften_entering(
    run: Run, patch: PatchScratch, friction: FrictionState, contact: ContactState, rubbing: FrictionCells,
    shear_near: wp.array3d(dtype=real), of_state: int,
):  # fmt: skip
    """Per (world, pair), lanes over cells: the softness `late` [m/Pa] of the loaded cells. last_normal: zero if the
    last step ended without contact; the patch then has no previous position."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not rubs_on_patch(model, pair):
        return
    if (of_state != 0 and run.ctl[w].moved == 0) or (of_state == 0 and run.ctl[w].changes != 0):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    columns = elements.patches.columns[pair]
    rings = elements.rolling.ring_rows[pair]
    line = shear_line(rows, rings)
    kind = (columns + STRIPS_AROUND) * rows * line
    if of_state != 0 and lane == 0 and is_whole(run.ctl, w):
        lengths = real(0.0)  # of the patch, by which it has advanced
        row = int(0)
        while row < rows:
            moved = cells_advanced(model, elements, w, pair, row, patch, friction)
            long = real(columns)
            if moved[1] != real(0.0):
                long = real(rows)
            lengths = wp.max(lengths, wp.abs(moved[0]) * elements.patches.span[pair] / long)
            row += 1
        if lengths > real(1.0) and load_share(model, w, pair, contact.pair_force) > MAY_PASS:
            run.ctl[w].failure = run.ctl[w].failure | k.PASSED  # none of its material was there before
    m = lane
    while m < columns * rows:
        soft = real(0.0)
        moved = cells_advanced(model, elements, w, pair, m % rows, patch, friction)
        across = int(moved[1])
        ahead = int(1)
        if moved[0] < real(0.0):
            ahead = int(-1)
        c = wp.abs(moved[0])
        part = wp.min(c, real(1.0))
        if c > real(0.0) and rubbing.bound[w, pair, m] > real(0.0):
            d = cells_to_edge(w, pair, m / rows, m % rows, ahead, across, columns, rows, rubbing.bound)
            d = wp.max(d + OFFSET[0] + OFFSET[1] * part, LEAST)
            lag = part * wp.max(wp.max(c, real(1.0)) / d - real(1.0), real(0.0))
            if lag > real(0.0):
                r = m % rows
                own = across * kind + r * line + rings
                beside = own + rows * line + r
                if across != 0:
                    beside = own + r - ahead
                gained = shear_near[w, pair, own + r] - shear_near[w, pair, beside]
                soft = BOTH * wp.max(gained, real(0.0)) * lag / rubbing.cell_area[w, pair, m]
        rubbing.late[w, pair, m] = soft
        m += wp.block_dim()
