r"""Lines of the linear system of a film (`films.system`): their places, and their entries T, U, R and P.

Where columns go around, the lines of as many of them, the seam, are eliminated last, as a dense block. A line of the
band at place i has its entries at i - half to i + 2 half, then those of the seam, U, R, and P; a line of the seam has
those of the first and of the last `half` places in the place of the band. The asymmetry of J causes the whirl of
shafts. Lines are scaled by their largest entry, as those of oil and asperities have different units.
"""

import warp as wp

from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.flow import holding, inflow, neighbour
from warpffrf_kernels.films.sampling import (
    ALONG_BY_GAP,
    ALONG_BY_PRESSURE,
    AROUND_BY_GAP,
    AROUND_BY_PRESSURE,
    CONDUCTANCE,
    EVENNESS,
    FILLING_BY_GAP,
    FILLING_BY_PRESSURE,
    HALF,
    NORMAL,
    PRESSED,
    PRESSURE,
    REYNOLDS,
    STIFFNESS,
)
from warpffrf_kernels.films.seats import seat_node, seat_part
from warpffrf_kernels.films.unknowns import (
    acts,
    add_scaled,
    column_of,
    line_at,
    line_length,
    loads_of,
    matrix_at,
    places_at,
    room_at,
    smooth_of,
    system_at,
)

wp.set_module_options(MODULE_OPTIONS)

HALF_BAND = wp.constant(0)  # of film_extent
BAND = wp.constant(1)
SEAM = wp.constant(2)


# x[at : at + n] *= a, by one lane; a is one over their largest magnitude, and returned. Zeros stay.
@wp.func_native("""
    double* __restrict v = x.data + at; double most = 0.0;
    for (int i = 0; i < n; ++i) { const double size = ::fabs(v[i]); most = size > most ? size : most; }
    const double r = most > 0.0 ? 1.0 / most : 1.0;
    for (int i = 0; i < n + more; ++i) v[i] *= r;
    return r;
""")
def scale_line(n: int, more: int, x: wp.array(dtype=real), at: int) -> real: ...


# Entries of a line of the oil balance from those of its points, by one lane: derivatives by the gap at the stations
# into wide, from near on, and by the pressures of the functions at the same points into room, from at on.
@wp.func_native(f"""
    const int some = function.shape[1];
    for (int e = begin; e < end; ++e) {{
        const int g = point.data[e], a = slot.data[e];
        const double* L = line.data + ((size_t)w * line.shape[1] + g) * line.shape[2];
        const double *x = slope_around.data + (size_t)g * some, *z = slope_along.data + (size_t)g * some;
        const double *v = value.data + (size_t)g * some, *part = between.data + (size_t)g * 4;
        double* h = wide.data + (size_t)w * wide.shape[1] + near;
        const double by_gap = x[a] * L[{int(AROUND_BY_GAP)}] + z[a] * L[{int(ALONG_BY_GAP)}]
            + v[a] * L[{int(FILLING_BY_GAP)}];
        for (int c = 0; c < 4; ++c) h[entry_near.data[(size_t)e * 4 + c]] += by_gap * part[c];
        const double by_x = x[a] * L[{int(CONDUCTANCE)}], by_z = z[a] * L[{int(CONDUCTANCE)}] * L[{int(EVENNESS)}];
        const double by_value = x[a] * L[{int(AROUND_BY_PRESSURE)}] + z[a] * L[{int(ALONG_BY_PRESSURE)}]
            + v[a] * L[{int(FILLING_BY_PRESSURE)}];
        const int* other = entry_room.data + (size_t)e * some;
        for (int s = 0; s < some; ++s)
            if (other[s] >= 0) room.data[at + other[s]] += by_x * x[s] + by_z * z[s] + by_value * v[s];
    }}
""")
def add_points(
    begin: int,
    end: int,
    point: wp.array(dtype=int),
    slot: wp.array(dtype=int),
    entry_near: wp.array2d(dtype=int),
    entry_room: wp.array2d(dtype=int),
    function: wp.array2d(dtype=int),
    slope_around: wp.array2d(dtype=real),
    slope_along: wp.array2d(dtype=real),
    value: wp.array2d(dtype=real),
    between: wp.array2d(dtype=real),
    line: wp.array3d(dtype=real),
    w: int,
    wide: wp.array2d(dtype=real),
    near: int,
    room: wp.array(dtype=real),
    at: int,
): ...


# Add x, from at on, to the entries of the line at place i that are at the places of a column; -1: none. One lane.
@wp.func_native("""
    for (int s = 0; s < n; ++s) {
        const int j = place.data[start + s];
        if (j < 0) continue;
        int to = j - i + half;
        if (j >= band) to = 3 * half + 1 + j - band;
        else if (i >= band) to = j < half ? j : j - band + 2 * half;  // a line of the seam
        a.data[row + to] += x.data[at + s];
    }
""")
def add_column(
    n: int,
    x: wp.array(dtype=real),
    at: int,
    place: wp.array(dtype=int),
    start: int,
    i: int,
    half: int,
    band: int,
    a: wp.array(dtype=real),
    row: int,
): ...


# x[at : at + n] = 0, by one lane.
@wp.func_native("for (int i = 0; i < n; ++i) x.data[at + i] = 0.0;")
def clear(n: int, x: wp.array(dtype=real), at: int): ...


@wp.func
def place_lines(model: Model, w: int, film: int, lane: int, oil: FilmScratch):
    """Places of the lines, column by column from behind the seam, and half the band. Asperities out of contact have
    none, and no increment."""
    if lane == 0:
        n = model.elements[0].films[0].unknowns[film]
        node = model.elements[0].films[0].node_start[film]
        start = system_at(model, w, film)
        columns = model.elements[0].films[0].grid_columns[film]
        reach = model.elements[0].films[0].reach[film]
        seam = reach * model.elements[0].films[0].turns[film]
        places = places_at(model, w, film)
        place = int(0)
        half = int(0)
        band = int(0)
        c = int(0)
        while c < columns:
            if c == columns - seam:
                band = place
            oil.film_opening_place[places + c] = place  # room of other numbers: the first place of a column
            column = (model.elements[0].films[0].seam[film] + seam + c) % columns
            s = int(0)
            while s < model.elements[0].films[0].width[film]:
                i = line_at(model, film, column, s)
                if i >= 0:
                    oil.film_place[start + i] = -1
                    if i < n or oil.film_rough[w, node + i - n] != 0:
                        oil.film_place[start + i] = place
                        place += 1
                s += 1
            if c < columns - seam:
                # lines of the columns that a line of this one reaches back to, and of those that reach into the seam
                before = oil.film_opening_place[places + wp.max(c - reach, 0)]
                last = oil.film_opening_place[places + wp.max(c - reach + 1, 0)]
                half = wp.max(half, wp.max(place - before - 1, place - last))
            c += 1
        if seam == 0:
            band = place
        oil.film_extent[w, film, HALF_BAND] = half
        oil.film_extent[w, film, BAND] = band
        oil.film_extent[w, film, SEAM] = place - band
    sync()


@wp.func
def add_at(model: Model, w: int, film: int, row: int, i: int, j: int, value: real, oil: FilmScratch):
    """Add to the entry of unknown j in the line of unknown i, which begins at `row`."""
    run = system_at(model, w, film)
    room = room_at(model, w, film, i)
    oil.film_room[room] = value
    add_column(
        1, oil.film_room, room, oil.film_place, run + j, oil.film_place[run + i], oil.film_extent[w, film, HALF_BAND],
        oil.film_extent[w, film, BAND], oil.film_matrix, row,
    )  # fmt: skip


@wp.func
def add_columns(
    model: Model, w: int, film: int, i: int, row: int, reach: int, places: wp.array(dtype=int), room: int,
    oil: FilmScratch,
):  # fmt: skip
    """Add the entries of `reach` columns on either side from `room` on to the line of unknown i, at these places."""
    width = model.elements[0].films[0].width[film]
    columns = model.elements[0].films[0].grid_columns[film]
    start = places_at(model, w, film)
    offset = int(0)
    while offset < 2 * reach + 1:
        column = column_of(model, film, i) + offset - reach
        if model.elements[0].films[0].turns[film] != 0:
            column = (column + columns) % columns
        if column >= 0 and column < columns:
            add_column(
                width, oil.film_room, room + offset * width, places, start + column * width,
                oil.film_place[system_at(model, w, film) + i], oil.film_extent[w, film, HALF_BAND],
                oil.film_extent[w, film, BAND], oil.film_matrix, row,
            )  # fmt: skip
        offset += 1


@wp.func
def add_opening(model: Model, w: int, film: int, i: int, row: int, station: int, by_gap: real, oil: FilmScratch):
    """Contribution of the opening at a station to the line of unknown i: near part to its room, smooth part to U."""
    width = model.elements[0].films[0].width[film]
    around = (2 * model.elements[0].films[0].reach[film] + 1) * width
    columns = model.elements[0].films[0].grid_columns[film]
    r = model.elements[0].films[0].smooth_count[film]
    offset = column_of(model, film, i) - station / model.elements[0].films[0].station_rows[film]
    if offset > 1:
        offset -= columns
    if offset < -1:
        offset += columns
    start = model.elements[0].films[0].close_start[film]
    start += station * (around + 2 * width) + (offset + 1) * width
    add_scaled(around, by_gap, model.elements[0].films[0].close, start, oil.film_room, room_at(model, w, film, i))
    behind = row + 3 * oil.film_extent[w, film, HALF_BAND] + 1 + oil.film_extent[w, film, SEAM]
    start = model.elements[0].films[0].smooth_start[film] + station * r
    add_scaled(r, by_gap, model.elements[0].films[0].smooth, start, oil.film_matrix, behind)
    more = model.elements[0].films[0].second_smooth_count[film]
    if more > 0:
        start = w * model.elements[0].films[0].moved_close_start[model.elements[0].films[0].count]
        start += model.elements[0].films[0].moved_close_start[film]
        start += station * (around + 2 * width) + (offset + 1) * width
        add_scaled(around, by_gap, oil.film_moved_close, start, oil.film_room, room_at(model, w, film, i))
        start = w * model.elements[0].films[0].moved_start[model.elements[0].films[0].count]
        start += model.elements[0].films[0].moved_start[film] + station * more
        add_scaled(more, by_gap, oil.film_moved, start, oil.film_matrix, behind + r)


@wp.func
def write_flow(model: Model, w: int, film: int, i: int, row: int, films: FilmState, oil: FilmScratch):
    """Line of the oil balance of unknown i, without R; `row` and its room are zero."""
    first = model.elements[0].films[0].function_start[film]
    f = model.elements[0].films[0].function_of[model.elements[0].films[0].unknown_start[film] + i]
    near = model.elements[0].films[0].near_start[first + f]
    room = room_at(model, w, film, i)
    reach = model.elements[0].films[0].reach[film]
    own = room + (2 * reach + 1) * model.elements[0].films[0].width[film]
    j = near
    while j < model.elements[0].films[0].near_start[first + f + 1]:
        oil.film_wide[w, j] = real(0.0)
        j += 1
    add_points(
        model.elements[0].films[0].entry_start[first + f], model.elements[0].films[0].entry_start[first + f + 1],
        model.elements[0].films[0].entry_point, model.elements[0].films[0].entry_slot,
        model.elements[0].films[0].entry_near, model.elements[0].films[0].entry_room,
        model.elements[0].films[0].function, model.elements[0].films[0].slope_around,
        model.elements[0].films[0].slope_along, model.elements[0].films[0].value,
        model.elements[0].films[0].station_part,
        oil.film_line, w, oil.film_wide, near, oil.film_room, own,
    )  # fmt: skip
    # deformation: opening by the pressures
    j = near
    while j < model.elements[0].films[0].near_start[first + f + 1]:
        add_opening(model, w, film, i, row, model.elements[0].films[0].near[j], oil.film_wide[w, j], oil)
        j += 1
    add_columns(model, w, film, i, row, reach, oil.film_opening_place, room, oil)
    add_columns(model, w, film, i, row, 1, oil.film_pressing_place, own, oil)
    # cavities: their own outflow, and the inflow from neighbours
    if films.film_full[w, 1, first + f] == 0:
        add_at(model, w, film, row, i, i, -holding(model, w, film, first + f, oil), oil)
    if model.elements[0].films[0].rule[film] != REYNOLDS:
        for c in range(4):
            other = neighbour(model, first + f, c)
            if other >= 0:
                j = model.elements[0].films[0].unknown_of[first + other]
                if j >= 0 and films.film_full[w, 1, first + other] == 0:
                    comes = inflow(model, w, first, first + f, c, oil.film_carried)
                    add_at(model, w, film, row, i, j, comes, oil)


@wp.func
def write_asperities(model: Model, w: int, film: int, i: int, row: int, films: FilmState, oil: FilmScratch):
    """Line of the asperities of unknown i, da + P' dh = P - a, without the right-hand side; zero before."""
    node = i - model.elements[0].films[0].unknowns[film]
    stiff = oil.film_node_line[w, model.elements[0].films[0].node_start[film] + node, STIFFNESS]
    add_opening(model, w, film, i, row, node, stiff, oil)
    reach = model.elements[0].films[0].reach[film]
    add_columns(model, w, film, i, row, reach, oil.film_opening_place, room_at(model, w, film, i), oil)
    add_at(model, w, film, row, i, i, real(1.0), oil)


@wp.func
def rest_of(model: Model, w: int, film: int, i: int, oil: FilmScratch, films: FilmState) -> real:
    """R of unknown i."""
    n = model.elements[0].films[0].unknowns[film]
    if i >= n:
        grid_node = model.elements[0].films[0].node_start[film] + i - n
        return films.film_asperity[w, 1, grid_node] - oil.film_node_line[w, grid_node, PRESSED]
    f = model.elements[0].films[0].function_of[model.elements[0].films[0].unknown_start[film] + i]
    return oil.film_rest[w, model.elements[0].films[0].function_start[film] + f]


@wp.func
def write_loads(model: Model, w: int, film: int, i: int, at: int, films: FilmState, oil: FilmScratch):
    """P of unknown i, from `at` on, which is zero: force and torque on A in its axes, and on the modes."""
    if not acts(model, w, film, i, films, oil):
        return
    n = model.elements[0].films[0].unknowns[film]
    modes = model.elements[0].films[0].modes[film]
    second_modes = model.elements[0].films[0].second_modes[film]
    first = model.elements[0].films[0].function_start[film]
    functions = model.elements[0].films[0].function_start[film + 1] - first
    half = model.elements[0].films[0].rule[film] == HALF
    f = first
    if i < n:
        f += model.elements[0].films[0].function_of[model.elements[0].films[0].unknown_start[film] + i]
    else:
        f += model.elements[0].films[0].node_function[model.elements[0].films[0].node_start[film] + i - n]
    force = vec3(real(0.0))
    moment = vec3(real(0.0))
    e = model.elements[0].films[0].entry_start[f]
    while e < model.elements[0].films[0].entry_start[f + 1]:
        g = model.elements[0].films[0].entry_point[e]
        push = model.elements[0].films[0].value[g, model.elements[0].films[0].entry_slot[e]]
        push *= model.elements[0].films[0].weight[g]
        if i < n and half and oil.film_line[w, g, PRESSURE] <= real(0.0):
            push = real(0.0)
        normal = vec3(oil.film_line[w, g, NORMAL], oil.film_line[w, g, NORMAL + 1], oil.film_line[w, g, NORMAL + 2])
        force += push * normal
        moment += push * wp.cross(model.elements[0].films[0].point_place[g], normal)
        e += 1
    for c in range(3):
        oil.film_matrix[at + c] = force[c]
        oil.film_matrix[at + 3 + c] = moment[c]
    m = int(0)
    while m < modes:
        load = real(0.0)
        if i < n:
            start = model.elements[0].films[0].moment_start[film] + m * functions
            load = model.elements[0].films[0].moment[start + f - first]
        else:
            start = model.elements[0].films[0].rough_moment_start[film] + m * model.elements[0].films[0].rough[film]
            load = model.elements[0].films[0].rough_moment[start + i - n]
        oil.film_matrix[at + 6 + m] = -load
        m += 1
    if second_modes > 0:
        e = model.elements[0].films[0].press_entry_start[f]
        while e < model.elements[0].films[0].press_entry_start[f + 1]:
            seat = model.elements[0].films[0].press_seat[model.elements[0].films[0].press_entry[e]]
            seat += model.elements[0].films[0].seat_start[film]
            for c in range(4):
                part = model.elements[0].films[0].press_entry_value[e] * seat_part(oil.film_seat_at, w, seat, c)
                line = model.elements[0].films[0].second_shape_start[film]
                line += seat_node(oil.film_seat, w, seat, c) * second_modes
                add_scaled(
                    second_modes, -part, model.elements[0].films[0].second_shape, line, oil.film_matrix, at + 6 + modes
                )
            e += 1


@wp.func
def write_lines(model: Model, w: int, film: int, lane: int, films: FilmState, oil: FilmScratch):
    """Places and lines of T, U and R; lanes over lines."""
    n = model.elements[0].films[0].unknowns[film]
    rough = model.elements[0].films[0].rough[film]
    run = system_at(model, w, film)
    stride = line_length(model, film)
    node = model.elements[0].films[0].node_start[film]
    r = smooth_of(model, film)
    i = lane
    while i < rough:
        oil.film_rough[w, node + i] = 0
        if films.film_asperity[w, 1, node + i] > real(0.0) or oil.film_node_line[w, node + i, PRESSED] > real(0.0):
            oil.film_rough[w, node + i] = 1
        i += wp.block_dim()
    sync()
    place_lines(model, w, film, lane, oil)
    places = places_at(model, w, film)
    i = lane
    while i < model.elements[0].films[0].grid_columns[film] * model.elements[0].films[0].width[film]:
        j = model.elements[0].films[0].line_at[model.elements[0].films[0].line_at_start[film] + i]
        opening = int(-1)
        pressing = int(-1)
        if j >= 0:
            if j < n:
                f = model.elements[0].films[0].function_of[model.elements[0].films[0].unknown_start[film] + j]
                if films.film_full[w, 1, model.elements[0].films[0].function_start[film] + f] != 0:
                    pressing = oil.film_place[run + j]
            if acts(model, w, film, j, films, oil):
                opening = oil.film_place[run + j]
        oil.film_opening_place[places + i] = opening
        oil.film_pressing_place[places + i] = pressing
        i += wp.block_dim()
    sync()
    seam = oil.film_extent[w, film, SEAM]
    behind = 3 * oil.film_extent[w, film, HALF_BAND] + 1 + seam
    i = lane
    while i < n + rough:
        place = oil.film_place[run + i]
        if place >= 0:
            row = matrix_at(model, w, film) + place * stride
            clear(behind + r + 1 + loads_of(model, film), oil.film_matrix, row)
            most = model.elements[0].films[0].most_room
            clear(most, oil.film_room, room_at(model, w, film, i))
            if i < n:
                write_flow(model, w, film, i, row, films, oil)
            else:
                write_asperities(model, w, film, i, row, films, oil)
            oil.film_matrix[row + behind + r] = rest_of(model, w, film, i, oil, films)
            oil.film_scale[run + i] = scale_line(behind, r + 1, oil.film_matrix, row)
            write_loads(model, w, film, i, row + behind + r + 1, films, oil)
        i += wp.block_dim()
    sync()


@wp.func
def place_of(s: int, half: int, band: int) -> int:
    """Place in the band of the s-th entry of a line of the seam."""
    if s < half:
        return s
    return s - 2 * half + band
