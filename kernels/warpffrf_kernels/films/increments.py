"""Increments of films with those of bodies and modes, their common step length, and the active set.

The set changes once per iteration: a full function whose pressure becomes negative is cavitated from then on, and a
cavitated one whose cavity becomes negative is full. No gap may fall below CLOSEST of the smallest gap.
"""

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.sampling import GAP, HALF, at_point
from warpffrf_kernels.films.seats import opened_at_seat
from warpffrf_kernels.films.second_surface import loads_at
from warpffrf_kernels.films.unknowns import (
    RIGID,
    columns_of,
    line_length,
    lines_of,
    matrix_at,
    opened_by_column,
    retained_column,
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
        n = model.elements[0].films[0].unknowns[film]
        modes = model.elements[0].films[0].modes[film]
        columns = columns_of(model, film)
        stride = line_length(model, film)
        base = matrix_at(model, w, film)
        first = model.elements[0].films[0].function_start[film]
        first_unknown = model.elements[0].films[0].unknown_start[film]
        lines = lines_of(model, film)
        run = system_at(model, w, film)
        rule = model.elements[0].films[0].rule[film]
        # increments of the unknowns, and change of the pressures that deform
        i = lane
        while i < lines:
            change = -oil.film_solution[run + i]
            c = int(0)
            while c < columns:
                at = retained_column(model, film, c)
                if at >= 0:
                    change -= oil.film_matrix[base + i * stride + lines + 1 + c] * system.z[retained + at]
                c += 1
            oil.film_change[run + i] = change
            if i < n:
                f = first + model.elements[0].films[0].function_of[first_unknown + i]
                p = films.film_pressure[w, 1, f]
                if films.film_full[w, 1, f] == 0:
                    change = real(0.0)
                elif rule == HALF:
                    change = wp.max(p + change, real(0.0)) - wp.max(p, real(0.0))
            oil.film_acting[run + i] = change
            i += wp.block_dim()
        sync()
        first_node = model.elements[0].films[0].node_start[film]
        # opening of the first surface at its nodes
        m = lane
        while m < model.elements[0].films[0].node_start[film + 1] - first_node:
            line = model.elements[0].films[0].compliance_start[film] + m * lines
            opened = dot(lines, model.elements[0].films[0].compliance, line, oil.film_acting, run)
            c = int(0)
            while c < modes:
                at = model.elements[0].films[0].shape_start[film] + m * modes + c
                opened -= (
                    model.elements[0].films[0].shape[at] * system.z[retained + retained_column(model, film, RIGID + c)]
                )
                c += 1
            oil.film_opening[w, first_node + m] = opened
            m += wp.block_dim()
        grid_nodes = model.elements[0].films[0].second_nodes[film]
        start = w * model.elements[0].films[0].second_node_start[model.elements[0].films[0].count]
        start += model.elements[0].films[0].second_node_start[film]
        # opening of the second surface at its nodes
        m = lane
        while m < grid_nodes:
            opened = dot(lines, oil.film_second_yield, loads_at(model, w, film) + m * lines, oil.film_acting, run)
            c = RIGID + modes
            while c < columns:
                at = model.elements[0].films[0].second_shape_start[film] + m * (columns - RIGID - modes) + c
                opened -= (
                    model.elements[0].films[0].second_shape[at - RIGID - modes]
                    * system.z[retained + retained_column(model, film, c)]
                )
                c += 1
            oil.film_second_ahead[start + m] = opened
            m += wp.block_dim()
        sync()
        # change of the gap at the points
        g = model.elements[0].films[0].point_start[film] + lane
        while g < model.elements[0].films[0].point_start[film + 1]:
            opened = at_point(model, g, oil.film_opening, w, first_node)
            if grid_nodes > 0:
                seat = model.elements[0].films[0].seat_start[film] + g - model.elements[0].films[0].point_start[film]
                opened += opened_at_seat(model, film, w, seat, oil, oil.film_second_ahead)[0]
            for c in range(RIGID):
                at = retained_column(model, film, c)
                if at >= 0:
                    opened += opened_by_column(oil.film_line, w, g, c) * system.z[retained + at]
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
    i = lane
    while i < n:
        f = first + model.elements[0].films[0].function_of[first_unknown + i]
        oil.film_switch[w, first_unknown + i] = 0
        change = oil.film_change[run + i]
        if films.film_full[w, 1, f] != 0:
            p = films.film_pressure[w, 1, f]
            if model.elements[0].films[0].voids[f] != 0 and p + change <= real(0.0):
                films.film_full[w, 1, f] = 0
                films.film_pressure[w, 1, f] = real(0.0)
                oil.film_switch[w, first_unknown + i] = 1
            else:
                films.film_pressure[w, 1, f] = p + part * change
        else:
            void = films.film_void[w, 1, f]
            if void + change < none:
                films.film_full[w, 1, f] = 1
                films.film_void[w, 1, f] = real(0.0)
                oil.film_switch[w, first_unknown + i] = 1
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
    sync()
    if lane == 0:
        any = int(0)
        if part < real(1.0):
            any = int(1)
        i = int(0)
        while i < n:
            any += oil.film_switch[w, first_unknown + i]
            i += 1
        oil.film_changed[w, film] = any
