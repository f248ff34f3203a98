"""Unknowns of a film and the columns that it is coupled to: their number, and the offsets of their entries.

Columns are the motions of both bodies, six each, then the global modes of the first, then those of a deformable second
body.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.films.sampling import MOMENT, NORMAL, SECOND_MOMENT

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
def line_length(model: Model, film: int) -> int:
    """Length of a line: J, R, B, P."""
    return lines_of(model, film) + 1 + 2 * columns_of(model, film)


@wp.func
def system_at(model: Model, w: int, film: int) -> int:
    """Start of the arrays with one entry per unknown, flat."""
    total = model.elements[0].films[0].system_start[model.elements[0].films[0].count]
    return w * total + model.elements[0].films[0].system_start[film]


@wp.func
def matrix_at(model: Model, w: int, film: int) -> int:
    total = model.elements[0].films[0].matrix_start[model.elements[0].films[0].count]
    return w * total + model.elements[0].films[0].matrix_start[film]


@wp.func
def vector_at(numbers: wp.array3d(dtype=real), w: int, place: int, c: int) -> vec3:
    """Three of the values of a point."""
    return vec3(numbers[w, place, c], numbers[w, place, c + 1], numbers[w, place, c + 2])


@wp.func
def opened_by_column(film_line: wp.array3d(dtype=real), w: int, g: int, c: int) -> real:
    """L of a rigid column at a point."""
    if c < 3:
        return film_line[w, g, NORMAL + c]
    if c < 6:
        return film_line[w, g, MOMENT + c - 3]
    if c < 9:
        return -film_line[w, g, NORMAL + c - 6]
    return film_line[w, g, SECOND_MOMENT + c - 9]


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
