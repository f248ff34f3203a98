"""Unknowns of a film and the columns that it is coupled to: their number, and the offsets of their entries.

Columns are the motions of both bodies, six each, then the global modes of the first, then those of a deformable second
body.
"""

import warp as wp

from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.sampling import HALF

wp.set_module_options(MODULE_OPTIONS)

RIGID = wp.constant(12)  # coupled columns before those of modes


# y[at : at + n] += a * x[start : start + n], by one lane.
@wp.func_native("""
    double* __restrict q = y.data + at; const double* __restrict p = x.data + start;
    for (int i = 0; i < n; ++i) q[i] += a * p[i];
""")
def add_scaled(n: int, a: real, x: wp.array(dtype=real), start: int, y: wp.array(dtype=real), at: int): ...


@wp.func
def lines_of(model: Model, film: int) -> int:
    """Unknowns of a film: pressures or cavities, then pressures of asperities."""
    return model.elements[0].films[0].unknowns[film] + model.elements[0].films[0].rough[film]


@wp.func
def columns_of(model: Model, film: int) -> int:
    return RIGID + model.elements[0].films[0].modes[film] + model.elements[0].films[0].second_modes[film]


@wp.func
def smooth_of(model: Model, film: int) -> int:
    """Smooth functions of both surfaces, r."""
    return model.elements[0].films[0].smooth_count[film] + model.elements[0].films[0].second_smooth_count[film]


@wp.func
def loads_of(model: Model, film: int) -> int:
    """Loads of a pressure: force and torque on the first body, then on the modes of both."""
    return columns_of(model, film) - 6


@wp.func
def line_length(model: Model, film: int) -> int:
    """Length of a line of the system: band, seam, U, R and P."""
    seam = (
        model.elements[0].films[0].reach[film]
        * model.elements[0].films[0].turns[film]
        * model.elements[0].films[0].width[film]
    )
    right = smooth_of(model, film) + 1 + loads_of(model, film)
    return 3 * model.elements[0].films[0].most_band[film] + 1 + seam + right


@wp.func
def line_at(model: Model, film: int, column: int, place: int) -> int:
    """Unknown at a place of a column, -1 for none."""
    start = model.elements[0].films[0].line_at_start[film]
    return model.elements[0].films[0].line_at[start + column * model.elements[0].films[0].width[film] + place]


@wp.func
def column_of(model: Model, film: int, i: int) -> int:
    """Column of unknown i."""
    columns = model.elements[0].films[0].grid_columns[film]
    n = model.elements[0].films[0].unknowns[film]
    start = model.elements[0].films[0].node_start[film]
    if i >= n:
        return (i - n) / ((model.elements[0].films[0].node_start[film + 1] - start) / columns)
    first = model.elements[0].films[0].function_start[film]
    functions = model.elements[0].films[0].function_start[film + 1] - first
    f = model.elements[0].films[0].function_of[model.elements[0].films[0].unknown_start[film] + i]
    return f / (functions / columns)


@wp.func
def acts(model: Model, w: int, film: int, i: int, films: FilmState, oil: FilmScratch) -> bool:
    """Whether unknown i is a pressure that opens gaps and loads the bodies."""
    n = model.elements[0].films[0].unknowns[film]
    if i >= n:
        return oil.film_rough[w, model.elements[0].films[0].node_start[film] + i - n] != 0
    f = model.elements[0].films[0].function_start[film]
    f += model.elements[0].films[0].function_of[model.elements[0].films[0].unknown_start[film] + i]
    if films.film_full[w, 1, f] == 0:
        return False
    return model.elements[0].films[0].rule[film] != HALF or films.film_pressure[w, 1, f] >= real(0.0)


@wp.func
def system_at(model: Model, w: int, film: int) -> int:
    """Start of the arrays with one entry per unknown, flat."""
    total = model.elements[0].films[0].system_start[model.elements[0].films[0].count]
    return w * total + model.elements[0].films[0].system_start[film]


@wp.func
def room_at(model: Model, w: int, film: int, i: int) -> int:
    """Start of the room of unknown i: entries of `reach` columns on either side, then of one."""
    return (system_at(model, w, film) + i) * model.elements[0].films[0].most_room


@wp.func
def places_at(model: Model, w: int, film: int) -> int:
    """Start of the arrays with one entry per place of a column, flat."""
    return w * model.elements[0].films[0].line_at.shape[0] + model.elements[0].films[0].line_at_start[film]


@wp.func
def matrix_at(model: Model, w: int, film: int) -> int:
    total = model.elements[0].films[0].matrix_start[model.elements[0].films[0].count]
    return w * total + model.elements[0].films[0].matrix_start[film]


@wp.func
def retained_column(model: Model, film: int, c: int) -> int:
    """Retained unknown of a coupled column, -1 for the ground."""
    body = model.surfaces.body[model.elements[0].films[0].first[film]]
    modes = model.elements[0].films[0].modes[film]
    if c >= RIGID + modes:
        other = model.surfaces.body[model.elements[0].films[0].second[film]]
        return 6 * model.bodies.count + model.bodies.dense_start[other] + c - RIGID - modes
    if c >= RIGID:
        return 6 * model.bodies.count + model.bodies.dense_start[body] + c - RIGID
    at = c
    if c >= 6:
        body = model.surfaces.body[model.elements[0].films[0].second[film]]
        at = c - 6
    if body < 0:
        return -1
    return 6 * body + at
