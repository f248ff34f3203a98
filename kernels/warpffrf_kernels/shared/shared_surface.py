"""Surfaces that serve several pairs: what the loads of the other pairs do to the gaps and cells of each.

Local modes belong to a surface, not to a pair. Where pairs p and q load the same surface s, the displacement on p's
side is that of both loads,

    u_p = D_s (f_p + f_q),

and `contact_fields` and `tangential_fields` know f_p alone. The part of f_q is added here, in whole: the tables are
applied to the present loads of every other pair. Hats of a first grid are loaded and read weakly (psi = M p), a second
one by nodes (psi = l s), so there are four tables for the normal part,

    reads first  : M D M of another first, M D of a second;      reads second : D M of a first, D of a second,

picked by `neighbour_table`; those of the tangential part are the surfaces' own (`surface_tt`, `surface_nt`,
`surface_tn`), whose weak side is that of the surface number they belong to. Columns count over full turns, so a source
is moved by whole turns to where it is nearest to the window; on a turn the tables hold half of it to either side.

The part of the others enters the matrix of the pressures (`shared_assembly`), but not that of the tractions: the Newton
iteration takes it in from one pass to the next.
"""

import warp as wp

from warpffrf_kernels.core.access import changed
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.friction.cell_shares import response_at
from warpffrf_kernels.normal.contact_compliance import place_in_table
from warpffrf_kernels.surfaces.neighbours import first_column, has_neighbours, nearest_turn

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def add_pressed(
    model: Model,
    w: int,
    surface: int,
    low: int,
    columns: int,
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    second_load: wp.array(dtype=real),
    start: int,
    field: wp.array(dtype=real),
):
    """Adds to `field` (from `start`, the columns `low` and following of the surface's window) the normal displacement
    by the pressures of the other pairs on it."""
    rows = model.surfaces.rows[surface]
    target = first_column(model, w, surface, center) + low
    middle = target + columns / 2
    n = model.shared.start[surface]
    while n < model.shared.start[surface + 1]:
        other = model.shared.neighbour[n]
        pair = other / 2
        origin = first_column(model, w, other, center)
        m = int(0)
        end = model.window.second_columns * rows
        if other % 2 == 0:
            m = (window[w, pair, 0] + model.window.half) * rows
            end = (window[w, pair, 1] + model.window.half + 1) * rows
        while m < end:
            load = real(0.0)
            if other % 2 == 0:
                if active[w, pair, m] != 0:
                    load = pressure[w, pair, m]
            else:
                load = second_load[(w * model.pairs.count + pair) * model.window.nodes + m]
            if load != real(0.0):
                source = nearest_turn(model, surface, origin + m / rows, middle)
                at = place_in_table(model, surface, source, m % rows, target)
                if at >= 0:
                    at += model.shared.table[n]
                    axpy(columns * rows, load, model.shared.compliance, at, field, start)
            m += 1
        n += 1


@wp.kernel
def share_pressures(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    second_load: wp.array(dtype=real),
    first_local: changed(wp.array(dtype=real)),
    second_local: changed(wp.array(dtype=real)),
):
    """Per (world, pair): adds what the pressures of other pairs on its surfaces do to the displacements by local
    modes."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or not has_neighbours(model, pair):
        return
    A = 2 * pair
    at = w * model.pairs.count + pair
    low = window[w, pair, 0] + model.window.half
    columns = window[w, pair, 1] - window[w, pair, 0] + 1
    start = at * model.window.hats + low * model.surfaces.rows[A]
    add_pressed(model, w, A, low, columns, center, window, active, pressure, second_load, start, first_local)
    low = second_window[w, pair, 0]
    columns = second_window[w, pair, 1] - low + 1
    start = at * model.window.nodes + low * model.surfaces.rows[A + 1]
    add_pressed(
        model, w, A + 1, low, columns, center, window, active, pressure, second_load, start, second_local
    )  # fmt: skip


@wp.func
def add_rubbed(
    model: Model,
    w: int,
    surface: int,
    low: int,
    columns: int,
    tangential: int,
    center: wp.array3d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
    second_force: wp.array3d(dtype=real),
    start: int,
    field: wp.array(dtype=real),
):
    """Adds to `field` the displacement by the tractions of the other pairs on the surface: with `tangential` the one
    along it (2 rows lines a column), else what its normal displacement opens the gaps by (rows lines)."""
    rows = model.surfaces.rows[surface]
    target = first_column(model, w, surface, center) + low
    middle = target + columns / 2
    n = model.shared.start[surface]
    while n < model.shared.start[surface + 1]:
        other = model.shared.neighbour[n]
        pair = other / 2
        if model.pairs.friction[pair] > real(0.0):
            origin = first_column(model, w, other, center)
            i = int(0)
            end = 2 * model.window.columns * rows
            if other % 2 != 0:
                end = 2 * model.window.second_columns * rows
            while i < end:
                force = real(0.0)
                if other % 2 == 0:
                    force = cell_area[w, pair, (i / (2 * rows)) * rows + i % rows] * traction[w, pair, i]
                else:
                    force = second_force[w, pair, i]
                if force != real(0.0):
                    source = nearest_turn(model, surface, origin + i / (2 * rows), middle)
                    line = i % (2 * rows)
                    if tangential != 0:
                        at = response_at(
                            model, surface, model.surfaces.tt_start[surface], source, line, 2 * rows, target, 2 * rows
                        )
                        if at >= 0:
                            axpy(2 * columns * rows, force, model.surfaces.tangential, at, field, start)
                    else:
                        at = response_at(
                            model, surface, model.surfaces.nt_start[surface], source, line, 2 * rows, target, rows
                        )
                        if at >= 0:
                            axpy(columns * rows, -force, model.surfaces.tangential, at, field, start)
                i += 1
        n += 1


@wp.kernel
def share_push(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
    second_force: wp.array3d(dtype=real),
    first_push: changed(wp.array(dtype=real)),
    second_push: changed(wp.array(dtype=real)),
):
    """Per (world, pair): adds what the tractions of other pairs on its surfaces open its gaps by, also of a pair
    without friction of its own."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].moved == 0 or not has_neighbours(model, pair):
        return
    A = 2 * pair
    at = w * model.pairs.count + pair
    if model.pairs.friction[pair] == real(0.0):
        i = lane
        while i < model.window.hats:
            first_push[at * model.window.hats + i] = real(0.0)
            i += wp.block_dim()
        i = lane
        while i < model.window.nodes:
            second_push[at * model.window.nodes + i] = real(0.0)
            i += wp.block_dim()
        sync()
    low = window[w, pair, 0] + model.window.half
    columns = window[w, pair, 1] - window[w, pair, 0] + 1
    start = at * model.window.hats + low * model.surfaces.rows[A]
    add_rubbed(model, w, A, low, columns, 0, center, cell_area, traction, second_force, start, first_push)
    low = second_window[w, pair, 0]
    columns = second_window[w, pair, 1] - low + 1
    start = at * model.window.nodes + low * model.surfaces.rows[A + 1]
    add_rubbed(
        model, w, A + 1, low, columns, 0, center, cell_area, traction, second_force, start, second_push
    )  # fmt: skip


@wp.func
def add_shifted(
    model: Model,
    w: int,
    surface: int,
    low: int,
    columns: int,
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    load: wp.array3d(dtype=real),
    start: int,
    field: wp.array(dtype=real),
):
    """Adds to `field` the displacement along the surface by the pressures of the other pairs on it (`pressure` on their
    first surfaces, `load` on their second ones)."""
    rows = model.surfaces.rows[surface]
    target = first_column(model, w, surface, center) + low
    middle = target + columns / 2
    n = model.shared.start[surface]
    while n < model.shared.start[surface + 1]:
        other = model.shared.neighbour[n]
        pair = other / 2
        origin = first_column(model, w, other, center)
        m = int(0)
        end = model.window.second_columns * rows
        if other % 2 == 0:
            m = (window[w, pair, 0] + model.window.half) * rows
            end = (window[w, pair, 1] + model.window.half + 1) * rows
        while m < end:
            p = real(0.0)
            if other % 2 == 0:
                p = pressure[w, pair, m]
            else:
                p = load[w, pair, m]
            if p != real(0.0):
                source = nearest_turn(model, surface, origin + m / rows, middle)
                at = response_at(
                    model, surface, model.surfaces.tn_start[other], source, m % rows, rows, target, 2 * rows
                )
                if at >= 0:
                    axpy(2 * columns * rows, -p, model.surfaces.tangential, at, field, start)
            m += 1
        n += 1


@wp.kernel
def share_shift(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    load: wp.array3d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
    second_force: wp.array3d(dtype=real),
    of_state: int,
    first_shift: changed(wp.array(dtype=real)),
    second_shift: changed(wp.array(dtype=real)),
):
    """Per (world, pair): adds what the other pairs on its surfaces displace its cells by; of the state by pressures and
    tractions, of a solve by the change of the pressures."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or model.pairs.friction[pair] == real(0.0) or not has_neighbours(model, pair):
        return
    if (of_state != 0 and ctl[w].moved == 0) or (of_state == 0 and ctl[w].changes != 0):
        return
    A = 2 * pair
    at = w * model.pairs.count + pair
    low = window[w, pair, 0] + model.window.half
    columns = window[w, pair, 1] - window[w, pair, 0] + 1
    start = 2 * (at * model.window.hats + low * model.surfaces.rows[A])
    add_shifted(model, w, A, low, columns, center, window, pressure, load, start, first_shift)
    if of_state != 0:
        add_rubbed(
            model, w, A, low, columns, 1, center, cell_area, traction, second_force, start, first_shift
        )  # fmt: skip
    if model.surfaces.shear_start[A + 1] < 0:
        return
    start = 2 * at * model.window.nodes
    columns = model.window.second_columns
    add_shifted(model, w, A + 1, 0, columns, center, window, pressure, load, start, second_shift)
    if of_state != 0:
        add_rubbed(
            model, w, A + 1, 0, columns, 1, center, cell_area, traction, second_force, start, second_shift
        )  # fmt: skip
