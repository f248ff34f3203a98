"""Positions of a film on a deformable second surface: the four grid nodes around a point ("seat"), and the opening.

The second surface B has its own contact grid, over which the points of A, on which the film is defined, move. The seat
of a point is a cell of that grid, and u and v are the coordinates in it, from 0 to 1 between the cell's columns and
rows. Shape functions at an end of the grid extend beyond it by one cell, so that there is no jump for a point entering
there; farther away B is rigid. Seats of a film are those of its points, then those of A's nodes.
"""

import warp as wp

from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.struct
class Seat:
    """Lower nodes of both columns of a cell, counted within B; position in it, beyond 0 and 1 at an end."""

    low: int
    right: int
    u: real
    v: real


@wp.func
def seat_on(model: Model, film: int, theta: real, z: real) -> Seat:
    """The seat of a point of B's chart."""
    columns = model.elements[0].films[0].second_grid[film, 0]
    rows = model.elements[0].films[0].second_grid[film, 1]
    cells = columns - 1
    x = (theta - model.elements[0].films[0].second_pitch[film, 0]) / model.elements[0].films[0].second_pitch[film, 1]
    turn = model.elements[0].films[0].second_pitch[film, 2]
    if turn > real(0.0):
        x -= turn * wp.floor(x / turn)
        if model.elements[0].films[0].second_grid[film, 2] != 0:
            cells = columns
        elif x - real(cells) > turn - x:
            x -= turn
    i = wp.clamp(int(wp.floor(x)), 0, cells - 1)
    first = model.elements[0].films[0].second_row_start[film]
    low = int(0)
    high = rows - 1
    while high - low > 1:
        middle = (low + high) / 2
        if z >= model.elements[0].films[0].second_row[first + middle]:
            low = middle
        else:
            high = middle
    start = model.elements[0].films[0].second_row[first + low]
    found = Seat()
    found.low = i * rows + low
    found.right = ((i + 1) % columns) * rows + low
    found.u = x - real(i)
    found.v = (z - start) / (model.elements[0].films[0].second_row[first + low + 1] - start)
    return found


@wp.func
def node_at(x: real, end: int) -> real:
    """Value at x of the shape function of one `end`, 0 or 1, of a cell from 0 to 1."""
    return wp.max(real(1.0) - wp.abs(x - real(end)), real(0.0))


@wp.func
def node_slope(x: real, end: int) -> real:
    """Its slope."""
    away = x - real(end)
    if wp.abs(away) >= real(1.0):
        return real(0.0)
    if away < real(0.0) or (away == real(0.0) and end == 1):
        return real(1.0)
    return real(-1.0)


@wp.func
def seat_node(seats: wp.array3d(dtype=int), w: int, seat: int, c: int) -> int:
    """The c-th of the four nodes of a seat, counted within B."""
    return seats[w, seat, c / 2] + c % 2


@wp.func
def seat_part(places: wp.array3d(dtype=real), w: int, seat: int, c: int) -> real:
    """Its value there."""
    return node_at(places[w, seat, 0], c / 2) * node_at(places[w, seat, 1], c % 2)


@wp.func
def opened_at_seat(model: Model, film: int, w: int, seat: int, oil: FilmScratch, opened: wp.array(dtype=real)) -> vec3:
    """Opening by B at a seat [m], and its slopes by theta and z of B's chart; `opened`: at its nodes, flat."""
    first = w * model.elements[0].films[0].second_node_start[model.elements[0].films[0].count]
    first += model.elements[0].films[0].second_node_start[film]
    rows = model.elements[0].films[0].second_grid[film, 1]
    row = model.elements[0].films[0].second_row_start[film] + oil.film_seat[w, seat, 0] % rows
    length = model.elements[0].films[0].second_row[row + 1] - model.elements[0].films[0].second_row[row]
    pitch = model.elements[0].films[0].second_pitch[film, 1]
    u = oil.film_seat_at[w, seat, 0]
    v = oil.film_seat_at[w, seat, 1]
    found = vec3(real(0.0))
    for c in range(4):
        there = opened[first + seat_node(oil.film_seat, w, seat, c)]
        across = node_at(u, c / 2)
        along = node_at(v, c % 2)
        found += there * vec3(
            across * along, node_slope(u, c / 2) * along / pitch, across * node_slope(v, c % 2) / length
        )
    return found
