"""Increments of films with those of bodies and modes, their common step length, and the active set.

The set changes once per iteration: a full function whose pressure becomes negative is cavitated from then on, and a
cavitated one whose cavity becomes negative is full. No gap may fall below CLOSEST of the smallest gap, by its change
according to the linear system.
"""

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.lanes import total
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.lines import HALF_BAND, SEAM
from warpffrf_kernels.films.sampling import GAP
from warpffrf_kernels.films.smooth import motion_at, port_at, smooth_at, yielded
from warpffrf_kernels.films.unknowns import (
    acts,
    columns_of,
    line_length,
    lines_of,
    matrix_at,
    places_at,
    retained_column,
    smooth_of,
    system_at,
)

wp.set_module_options(MODULE_OPTIONS)

CLOSEST = wp.constant(wp.float64(0.2))  # of the smallest gap: lower bound after an iteration
NO_VOID = wp.constant(wp.float64(1.0e-13))  # of the clearance: round-off of a cavity


@kernel
def limit_films(run_of_run: Run, films: FilmState, oil: FilmScratch, system: RetainedSystem):
    """Per world: dx of all films with the retained increments, and the step length for which no gap closes."""
    w, lane = wp.tid()
    model = run_of_run.models[w]
    if run_of_run.ctl[w].run == 0 or run_of_run.ctl[w].changes != 0:
        return
    part = real(1.0)
    retained = w * model.retained.count
    modal = w * model.modes.count
    film = int(0)
    while film < model.elements[0].films[0].count:
        r = smooth_of(model, film)
        first = model.elements[0].films[0].smooth_count[film]
        count = model.elements[0].films[0].count
        columns = columns_of(model, film)
        run = system_at(model, w, film)
        at = smooth_at(model, w, film)
        # openings of the columns by the retained increments, forces on the smooth functions, then their amounts
        a = lane
        while a < r:
            opened = real(0.0)
            c = int(0)
            while c < columns:
                i = retained_column(model, film, c)
                if i >= 0:
                    opened += oil.film_motion[motion_at(model, w, film) + a * columns + c] * system.z[retained + i]
                c += 1
            oil.film_amount[at + a] = opened
            a += wp.block_dim()
        sync()
        a = lane
        while a < r:
            line = port_at(model, w, film) + a * 3 * r + r
            oil.film_force[at + a] = -oil.film_force[at + a] - dot(r, oil.film_port, line, oil.film_amount, at)
            a += wp.block_dim()
        sync()
        a = lane
        while a < r:
            oil.film_amount[at + a] = oil.film_amount[at + a] + yielded(model, film, a, oil.film_force, at)
            a += wp.block_dim()
        sync()
        # increments of the unknowns, and pressures that open gaps
        behind = 3 * oil.film_extent[w, film, HALF_BAND] + 1 + oil.film_extent[w, film, SEAM]
        i = lane
        while i < lines_of(model, film):
            change = real(0.0)
            place = oil.film_place[run + i]
            if place >= 0:
                row = matrix_at(model, w, film) + place * line_length(model, film) + behind
                change = -oil.film_matrix[row + r] - dot(r, oil.film_matrix, row, oil.film_amount, at)
            oil.film_change[run + i] = change
            if not acts(model, w, film, i, films, oil):
                change = real(0.0)
            oil.film_acting[run + i] = change
            i += wp.block_dim()
        sync()
        # opening at the stations, by pressures in the order of columns
        station = model.elements[0].films[0].station_start[film]
        rows = model.elements[0].films[0].station_rows[film]
        reach = model.elements[0].films[0].reach[film]
        width = model.elements[0].films[0].width[film]
        grid_columns = model.elements[0].films[0].grid_columns[film]
        places = places_at(model, w, film)
        i = lane
        while i < grid_columns * width:
            j = model.elements[0].films[0].line_at[model.elements[0].films[0].line_at_start[film] + i]
            oil.film_spread[places + i] = real(0.0)
            if j >= 0:
                oil.film_spread[places + i] = oil.film_acting[run + j]
            i += wp.block_dim()
        sync()
        m = lane
        while m < model.elements[0].films[0].station_start[film + 1] - station:
            line = model.elements[0].films[0].smooth_start[film] + m * first
            opened = dot(first, model.elements[0].films[0].smooth, line, oil.film_amount, at)
            moved = w * model.elements[0].films[0].moved_start[count]
            moved += model.elements[0].films[0].moved_start[film] + m * (r - first)
            if r > first:
                opened += dot(r - first, oil.film_moved, moved, oil.film_amount, at + first)
            moved = w * model.elements[0].films[0].moved_close_start[count]
            moved += model.elements[0].films[0].moved_close_start[film] + m * (2 * reach + 3) * width
            near = model.elements[0].films[0].close_start[film] + m * (2 * reach + 3) * width
            offset = int(0)
            while offset < 2 * reach + 3:
                column = m / rows + offset - reach - 1
                if model.elements[0].films[0].turns[film] != 0:
                    column = (column + grid_columns) % grid_columns
                if column >= 0 and column < grid_columns:
                    opened += dot(
                        width, model.elements[0].films[0].close, near + offset * width, oil.film_spread,
                        places + column * width,
                    )  # fmt: skip
                    if r > first:
                        opened += dot(
                            width,
                            oil.film_moved_close,
                            moved + offset * width,
                            oil.film_spread,
                            places + column * width,
                        )
                offset += 1
            oil.film_opening[w, station + m] = opened
            m += wp.block_dim()
        sync()
        # change of the gap at the points
        g = model.elements[0].films[0].point_start[film] + lane
        while g < model.elements[0].films[0].point_start[film + 1]:
            opened = real(0.0)
            for c in range(4):
                there = oil.film_opening[w, station + model.elements[0].films[0].station[g, c]]
                opened += model.elements[0].films[0].station_part[g, c] * there
            oil.film_ahead[w, g] = opened
            g += wp.block_dim()
        sync()
        # step length for which no gap falls below CLOSEST of the smallest one
        least = real(1.0e300)
        ahead = real(1.0e300)
        closing = real(0.0)
        g = model.elements[0].films[0].point_start[film]
        while g < model.elements[0].films[0].point_start[film + 1]:
            least = wp.min(least, oil.film_line[w, g, GAP])
            ahead = wp.min(ahead, oil.film_line[w, g, GAP] + oil.film_ahead[w, g])
            closing = wp.max(closing, -oil.film_ahead[w, g])
            g += 1
        if ahead < CLOSEST * least:
            part = wp.min(part, (real(1.0) - CLOSEST) * least / closing)
        film += 1
    sync()
    if lane == 0:
        oil.film_part[w] = part
    # all increments are reduced by the same factor
    if part < real(1.0):
        i = lane
        while i < model.retained.count:
            system.z[retained + i] = part * system.z[retained + i]
            i += wp.block_dim()
        i = lane
        while i < model.modes.count:
            system.modal_step[modal + i] = part * system.modal_step[modal + i]
            i += wp.block_dim()


@kernel
def take_film(run_of_run: Run, oil: FilmScratch, films: FilmState):
    """Per (world, film), lanes over unknowns: the allowed part of dx, and the resulting set."""
    w, film, lane = wp.tid()
    model = run_of_run.models[w]
    if run_of_run.ctl[w].run == 0 or run_of_run.ctl[w].changes != 0:
        return
    n = model.elements[0].films[0].unknowns[film]
    first = model.elements[0].films[0].function_start[film]
    first_unknown = model.elements[0].films[0].unknown_start[film]
    run = system_at(model, w, film)
    part = oil.film_part[w]
    none = -NO_VOID * model.elements[0].films[0].thickness[film]
    switched = real(0.0)
    i = lane
    while i < n:
        f = first + model.elements[0].films[0].function_of[first_unknown + i]
        change = oil.film_change[run + i]
        if films.film_full[w, 1, f] != 0:
            p = films.film_pressure[w, 1, f]
            if model.elements[0].films[0].voids[f] != 0 and p + change <= real(0.0):
                films.film_full[w, 1, f] = 0
                films.film_pressure[w, 1, f] = real(0.0)
                switched += real(1.0)
            else:
                films.film_pressure[w, 1, f] = p + part * change
        else:
            void = films.film_void[w, 1, f]
            if void + change < none:
                films.film_full[w, 1, f] = 1
                films.film_void[w, 1, f] = real(0.0)
                switched += real(1.0)
            else:
                films.film_void[w, 1, f] = void + part * change
        i += wp.block_dim()
    m = lane
    while m < model.elements[0].films[0].rough[film]:
        grid_node = model.elements[0].films[0].node_start[film] + m
        films.film_asperity[w, 1, grid_node] = wp.max(
            films.film_asperity[w, 1, grid_node] + part * oil.film_change[run + n + m], real(0.0)
        )
        m += wp.block_dim()
    switched = total(switched)
    if part < real(1.0):
        switched += real(1.0)
    if lane == 0:
        oil.film_changed[w, film] = int(switched)
