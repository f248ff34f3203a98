r"""The linear system of a film for the increments of its pressures and cavities.

Unknown are, for each function whose pressure is not given, the pressure p if the film is full, else its cavity D; and
the pressures a of asperities in contact, with the equation a = P(-h) of their own. With G the opening at the nodes due
to pressures, and z the coupled columns, motions of both bodies and the global modes of the first,

    dh = L dz + between (G dp - Phi dq),

a linearised step of a film, and its forces P^T p on these columns, read

    R + J dx + B dz = 0,      J = A + (dR/dh) G on full functions, -(a_0 m + T) on cavitated ones,      B = (dR/dh) L,
    S dz = -r + P^T dx.

R and P are exact; J and B are not, which costs iterations, no accuracy. G is parted into a near part N and r smooth
functions (`online.compile.films.smooth`),

    J = T + U C V^T,      T = A + (dR/dh) N within some columns,      U = (dR/dh) Phi,      B = U Z,

so that T is banded, lines ordered by columns: dx = -T^-1 (R + U y) of r + 1 right-hand sides, with the amounts y of the
smooth functions from an r by r system (`films.smooth`). P, unlike V Z, is exact: increments whose forces were not those
of their pressures would leave forces out of balance, by as much as the round-off of a gap is able to press.

The layout of the lines is in `films.lines`. Factors are kept while the set is unchanged and the residual decreases to
SLOW or less of the one before. The rotation of normals with the motion is neglected in S: c/R relative to the rest.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem, Trial
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.lines import BAND, HALF_BAND, SEAM, clear, place_of, rest_of, write_lines
from warpffrf_kernels.films.sides import sides_of
from warpffrf_kernels.films.smooth import (
    condense,
    load_at,
    move_second,
    port_at,
    push_by_rest,
    smooth_at,
    stiffness_of,
    write_motion,
)
from warpffrf_kernels.films.unknowns import (
    acts,
    add_scaled,
    columns_of,
    line_length,
    lines_of,
    loads_of,
    matrix_at,
    retained_column,
    smooth_of,
    system_at,
)
from warpffrf_kernels.linear.banded_elimination import eliminate_band, solve_band_again
from warpffrf_kernels.linear.general_elimination import eliminate, solve_again

wp.set_module_options(MODULE_OPTIONS)

SLOW = wp.constant(wp.float64(0.05))  # of the previous residual: above it the factors are not kept


@wp.func
def solve_seam(model: Model, w: int, film: int, lane: int, more: int, oil: FilmScratch) -> int:
    """The lines of the seam and their part in those of the band, for `more` right-hand sides. Returns 1 if singular."""
    half = oil.film_extent[w, film, HALF_BAND]
    band = oil.film_extent[w, film, BAND]
    seam = oil.film_extent[w, film, SEAM]
    stride = line_length(model, film)
    base = matrix_at(model, w, film)
    behind = 3 * half + 1
    q = lane
    while q < seam:
        row = base + (band + q) * stride
        s = int(0)
        while s < 2 * half:
            entry = oil.film_matrix[row + s]
            if entry != real(0.0):
                add_scaled(
                    seam + more,
                    -entry,
                    oil.film_matrix,
                    base + place_of(s, half, band) * stride + behind,
                    oil.film_matrix,
                    row + behind,
                )
            s += 1
        q += wp.block_dim()
    sync()
    run = system_at(model, w, film)
    bad = eliminate(oil.film_matrix, base + band * stride + behind, stride, seam, more, oil.film_pivots, run + band)
    i = lane
    while i < band:
        row = base + i * stride + behind
        q = int(0)
        while q < seam:
            entry = oil.film_matrix[row + q]
            if entry != real(0.0):
                add_scaled(
                    more,
                    -entry,
                    oil.film_matrix,
                    base + (band + q) * stride + behind + seam,
                    oil.film_matrix,
                    row + seam,
                )
            q += 1
        i += wp.block_dim()
    sync()
    return bad


@wp.func
def solve_rest(model: Model, w: int, film: int, lane: int, oil: FilmScratch, films: FilmState):
    """T^-1 R with the stored factors, into the lines' last column."""
    half = oil.film_extent[w, film, HALF_BAND]
    band = oil.film_extent[w, film, BAND]
    seam = oil.film_extent[w, film, SEAM]
    stride = line_length(model, film)
    base = matrix_at(model, w, film)
    run = system_at(model, w, film)
    i = lane
    while i < lines_of(model, film):
        place = oil.film_place[run + i]
        if place >= 0:
            oil.film_change[run + place] = oil.film_scale[run + i] * rest_of(model, w, film, i, oil, films)
        i += wp.block_dim()
    solve_band_again(oil.film_matrix, base, stride, band, half, oil.film_pivots, run, oil.film_change, run)
    q = lane
    while q < seam:
        row = base + (band + q) * stride
        s = int(0)
        while s < 2 * half:
            entry = oil.film_matrix[row + s]
            if entry != real(0.0):
                part = entry * oil.film_change[run + place_of(s, half, band)]
                oil.film_change[run + band + q] = oil.film_change[run + band + q] - part
            s += 1
        q += wp.block_dim()
    sync()
    behind = 3 * half + 1
    solve_again(
        oil.film_matrix, base + band * stride + behind, stride, seam, oil.film_pivots, run + band, oil.film_change,
        run + band,
    )  # fmt: skip
    i = lane
    while i < band:
        entry = dot(seam, oil.film_matrix, base + i * stride + behind, oil.film_change, run + band)
        oil.film_change[run + i] = oil.film_change[run + i] - entry
        i += wp.block_dim()
    sync()
    r = smooth_of(model, film)
    i = lane
    while i < band + seam:
        oil.film_matrix[base + i * stride + behind + seam + r] = oil.film_change[run + i]
        i += wp.block_dim()
    sync()


@wp.func
def sum_loads(model: Model, w: int, film: int, lane: int, whole: int, films: FilmState, oil: FilmScratch):
    """f_0 into `film_amount`, P^T T^-1 R into `film_load`, and, if `whole`, K into the second part of `film_port` and
    P^T T^-1 U. Lanes over smooth functions, then loads."""
    r = smooth_of(model, film)
    first = model.elements[0].films[0].smooth_count[film]
    moved = w * model.elements[0].films[0].moved_load_start[model.elements[0].films[0].count]
    moved += model.elements[0].films[0].moved_load_start[film]
    loads = loads_of(model, film)
    to = load_at(model, w, film)
    run = system_at(model, w, film)
    port = port_at(model, w, film)
    at = smooth_at(model, w, film)
    a = lane
    while a < r:
        oil.film_amount[at + a] = real(0.0)
        if whole != 0:
            clear(r, oil.film_port, port + a * 3 * r + r)
        a += wp.block_dim()
    a = lane
    while a < loads:
        oil.film_load[to + a * (r + 1) + r] = real(0.0)
        if whole != 0:
            clear(r, oil.film_load, to + a * (r + 1))
        a += wp.block_dim()
    i = int(0)
    while i < lines_of(model, film):
        place = oil.film_place[run + i]
        if place >= 0:
            if acts(model, w, film, i, films, oil):
                row = matrix_at(model, w, film) + place * line_length(model, film)
                row += 3 * oil.film_extent[w, film, HALF_BAND] + 1 + oil.film_extent[w, film, SEAM]
                load = model.elements[0].films[0].smooth_load_start[film] + i * first
                a = lane
                while a < r:
                    part = real(0.0)
                    if a < first:
                        part = model.elements[0].films[0].smooth_load[load + a]
                    else:
                        part = oil.film_moved_load[moved + i * (r - first) + a - first]
                    oil.film_amount[at + a] = oil.film_amount[at + a] + part * oil.film_matrix[row + r]
                    if whole != 0:
                        add_scaled(r, part, oil.film_matrix, row, oil.film_port, port + a * 3 * r + r)
                    a += wp.block_dim()
                a = lane
                while a < loads:
                    part = oil.film_matrix[row + r + 1 + a]
                    line = to + a * (r + 1)
                    if whole != 0:
                        add_scaled(r + 1, part, oil.film_matrix, row, oil.film_load, line)
                    else:
                        oil.film_load[line + r] = oil.film_load[line + r] + part * oil.film_matrix[row + r]
                    a += wp.block_dim()
        i += 1
    sync()


@kernel
def assemble_film(
    run_of_run: Run, trial: Trial, films: FilmState, oil: FilmScratch, film_stiffness: wp.array(dtype=real)
):
    """Per (world, film), lanes over lines: T^-1 R, T^-1 U and the stiffness if the retained matrix is renewed, else
    T^-1 R alone, and the force on the columns."""
    w, film, lane = wp.tid()
    model = run_of_run.models[w]
    if run_of_run.ctl[w].run == 0 or run_of_run.ctl[w].moved == 0:
        return
    renewed = int(0)
    if run_of_run.ctl[w].refresh != 0:
        if oil.film_changed[w, film] != 0 or oil.film_off[w, film] > SLOW * oil.film_off_before[w, film]:
            renewed = int(1)
    bad = int(0)
    if renewed != 0:
        if model.elements[0].films[0].second_smooth_count[film] > 0:
            move_second(model, w, film, lane, oil)
        write_lines(model, w, film, lane, films, oil)
        more = smooth_of(model, film) + 1
        bad = eliminate_band(
            oil.film_matrix, matrix_at(model, w, film), line_length(model, film), oil.film_extent[w, film, BAND],
            oil.film_extent[w, film, HALF_BAND], oil.film_extent[w, film, SEAM] + more, oil.film_pivots,
            system_at(model, w, film),
        )  # fmt: skip
        bad = bad | solve_seam(model, w, film, lane, more, oil)
    else:
        solve_rest(model, w, film, lane, oil, films)
    sum_loads(model, w, film, lane, renewed, films, oil)
    static = int(0)
    if run_of_run.ctl[w].mode == k.STATIC:
        static = int(1)
    sides = sides_of(model, w, film, static, trial)
    if renewed != 0:
        write_motion(model, w, film, lane, sides, oil)
        bad = bad | condense(model, w, film, lane, oil)
        stiffness_of(model, w, film, lane, sides, oil, film_stiffness)
    push_by_rest(model, w, film, lane, sides, oil)
    if lane == 0:
        oil.film_off_before[w, film] = oil.film_off[w, film]
    if bad != 0 and lane == 0:
        run_of_run.ctl[w].failure = run_of_run.ctl[w].failure | k.SINGULAR


@kernel
def stiffen_by_films(run: Run, oil: FilmScratch, system: RetainedSystem):
    """Per world, lanes over rows: add the condensed contribution of all films to the retained system."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    film = int(0)
    while film < model.elements[0].films[0].count:
        columns = columns_of(model, film)
        c = int(0)
        while c < columns:
            i = retained_column(model, film, c)
            if i >= 0 and i % wp.block_dim() == lane:
                system.rhs[w, i] = (
                    system.rhs[w, i] - oil.film_push[w, model.elements[0].films[0].column_start[film] + c]
                )
                d = int(0)
                while d < columns and run.ctl[w].refresh != 0:
                    j = retained_column(model, film, d)
                    if j >= 0:
                        at = model.elements[0].films[0].square_start[film] + c * columns + d
                        system.tangent[w, i, j] = system.tangent[w, i, j] + oil.film_stiffness[w, at]
                    d += 1
            c += 1
        film += 1
