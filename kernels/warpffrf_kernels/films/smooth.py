r"""A film as its smooth functions see it: forces and amounts of r functions, between its own lines and the bodies.

With x of the film's system (`films.system`), the r smooth functions Phi on the grid of its first surface, opened by y,
exert and receive

    x = -T^-1 (R + U y),      f = V^T x = -f_0 - K y,      K = V^T T^-1 U,      f_0 = V^T T^-1 R,      U = (dR/dh) Phi,
    y = C f + Z z,

z the coupled columns, C the smooth compliance of both surfaces and Z what columns open: with s_n and s_m the
coefficients of the normal and its moments about the centre of mass of the first body, in its axes, z of the bodies open

    s_n.(A_a^T dr_a) + s_m.dpsi_a - s_n.(A_a^T dr_b) - (A_b^T ((r_a - r_b) x A_a s_n + A_a s_m)).dpsi_b,

which are those of the gap at a point of A. Then

    f = -(1 + K C)^-1 (f_0 + K Z z).

With the loads P of x, force and torque on A in its axes and on modes, which act on the columns as D^T P^T x, D the same
combination of the six as that of s_n and s_m above, the bodies receive

    D^T P^T x = -D^T (P^T T^-1 R - P^T T^-1 U C (1 + K C)^-1 f_0) - D^T P^T T^-1 U (Z - C (1 + K C)^-1 K Z) z,

a force and a stiffness. Of a compliant second surface, which moves, the smooth functions S Phi_B at the stations, S the
seats, follow those of the first, with their forces F^T S Phi_B by the nodal forces F of the lines; what its compliance
is beside them, N_B, gives the near part S N_B S^T F. All of this is of the last renewal.
"""

import warp as wp

from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync, vec3
from warpffrf_kernels.films.seats import seat_node, seat_part
from warpffrf_kernels.films.sides import Sides
from warpffrf_kernels.films.unknowns import RIGID, add_scaled, column_of, columns_of, line_at, lines_of, smooth_of
from warpffrf_kernels.linear.general_elimination import eliminate

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def smooth_at(model: Model, w: int, film: int) -> int:
    """Start of what each smooth function of a film has one of."""
    return (w * model.elements[0].films[0].count + film) * model.elements[0].films[0].most_smooth


@wp.func
def port_at(model: Model, w: int, film: int) -> int:
    """Start of the lines of `film_port`, 3 r long."""
    return 3 * model.elements[0].films[0].most_smooth * smooth_at(model, w, film)


@wp.func
def motion_at(model: Model, w: int, film: int) -> int:
    """Start of the lines of Z, one per smooth function."""
    return model.elements[0].films[0].most_columns * smooth_at(model, w, film)


@wp.func
def load_at(model: Model, w: int, film: int) -> int:
    """Start of the lines of P^T T^-1 U and P^T T^-1 R, one per load, r + 1 long."""
    most = (model.elements[0].films[0].most_smooth + 1) * model.elements[0].films[0].most_columns
    return (w * model.elements[0].films[0].count + film) * most


@wp.func
def yielded(model: Model, film: int, a: int, forces: wp.array(dtype=real), at: int) -> real:
    """C f of smooth function a."""
    r = smooth_of(model, film)
    line = model.elements[0].films[0].smooth_compliance_start[film] + a * r
    return dot(r, model.elements[0].films[0].smooth_compliance, line, forces, at)


@wp.func
def move_second(model: Model, w: int, film: int, lane: int, oil: FilmScratch):
    """Smooth functions and near part of a compliant second surface at the stations, where they are; lanes over
    stations, then lines."""
    more = model.elements[0].films[0].second_smooth_count[film]
    second_nodes = model.elements[0].films[0].second_nodes[film]
    rows = model.elements[0].films[0].grid_rows[film]
    columns = model.elements[0].films[0].grid_columns[film]
    turns = model.elements[0].films[0].turns[film] != 0
    width = model.elements[0].films[0].width[film]
    force = model.elements[0].films[0].nodal_force_start[film]
    seats = model.elements[0].films[0].seat_start[film]  # of points, then of nodes
    own = seats + model.elements[0].films[0].station_seat[film]
    seats += model.elements[0].films[0].point_start[film + 1] - model.elements[0].films[0].point_start[film]
    stations = model.elements[0].films[0].station_start[film + 1] - model.elements[0].films[0].station_start[film]
    station_rows = model.elements[0].films[0].station_rows[film]
    count = model.elements[0].films[0].count
    moved = w * model.elements[0].films[0].moved_start[count] + model.elements[0].films[0].moved_start[film]
    near = w * model.elements[0].films[0].moved_close_start[count]
    near += model.elements[0].films[0].moved_close_start[film]
    reach = model.elements[0].films[0].reach[film]
    around = (2 * reach + 5) * rows
    m = lane
    while m < stations:
        room = w * model.elements[0].films[0].moved_room_start[count]
        room += model.elements[0].films[0].moved_room_start[film] + m * around
        i = int(0)
        while i < more:
            oil.film_moved[moved + m * more + i] = real(0.0)
            i += 1
        for c in range(4):
            part = seat_part(oil.film_seat_at, w, own + m, c)
            line = seat_node(oil.film_seat, w, own + m, c)
            start = model.elements[0].films[0].second_smooth_start[film] + line * more
            add_scaled(more, part, model.elements[0].films[0].second_smooth, start, oil.film_moved, moved + m * more)
        i = int(0)
        while i < around:  # S N_B S^T of the nodes around
            column = m / station_rows + i / rows - reach - 2
            if turns:
                column = (column + columns) % columns
            total = real(0.0)
            if column >= 0 and column < columns:
                other = seats + column * rows + i % rows
                for c in range(4):
                    part = seat_part(oil.film_seat_at, w, own + m, c)
                    line = model.elements[0].films[0].second_near_start[film]
                    line += seat_node(oil.film_seat, w, own + m, c) * second_nodes
                    if part != real(0.0):
                        for d in range(4):
                            there = seat_part(oil.film_seat_at, w, other, d)
                            at = line + seat_node(oil.film_seat, w, other, d)
                            total += part * there * model.elements[0].films[0].second_near[at]
            oil.film_moved_room[room + i] = total
            i += 1
        i = int(0)
        while i < (2 * reach + 3) * width:  # times F
            column = m / station_rows + i / width - reach - 1
            if turns:
                column = (column + columns) % columns
            total = real(0.0)
            if column >= 0 and column < columns:
                j = line_at(model, film, column, i % width)
                if j >= 0:
                    total = dot(
                        3 * rows, model.elements[0].films[0].nodal_force, force + j * 3 * rows, oil.film_moved_room,
                        room + i / width * rows,
                    )  # fmt: skip
            oil.film_moved_close[near + m * (2 * reach + 3) * width + i] = total
            i += 1
        m += wp.block_dim()
    sync()
    loads = w * model.elements[0].films[0].moved_load_start[count] + model.elements[0].films[0].moved_load_start[film]
    j = lane
    while j < lines_of(model, film):
        i = int(0)
        while i < more:
            oil.film_moved_load[loads + j * more + i] = real(0.0)
            i += 1
        i = int(0)
        while i < 3 * rows:
            column = column_of(model, film, j) + i / rows - 1
            if turns:
                column = (column + columns) % columns
            if column >= 0 and column < columns:
                other = seats + column * rows + i % rows
                for c in range(4):
                    part = model.elements[0].films[0].nodal_force[force + j * 3 * rows + i]
                    part *= seat_part(oil.film_seat_at, w, other, c)
                    start = model.elements[0].films[0].second_smooth_start[film]
                    start += seat_node(oil.film_seat, w, other, c) * more
                    add_scaled(
                        more, part, model.elements[0].films[0].second_smooth, start, oil.film_moved_load,
                        loads + j * more,
                    )  # fmt: skip
            i += 1
        j += wp.block_dim()
    sync()


@wp.func
def on_column(loads: vec3, moments: vec3, sides: Sides, c: int) -> real:
    """What a force and a torque on A in its axes are on a rigid column: D."""
    if c >= 3 and c < 6:
        return moments[c - 3]
    along = sides.turn_a * loads
    if c < 3:
        return along[c]
    if c < 9:
        return -along[c - 6]
    turned = wp.transpose(sides.turn_b) * (wp.cross(sides.from_b, along) + sides.turn_a * moments)
    return -turned[c - 9]


@wp.func
def write_motion(model: Model, w: int, film: int, lane: int, sides: Sides, oil: FilmScratch):
    """Z, lanes over smooth functions."""
    first = model.elements[0].films[0].smooth_count[film]
    modes = model.elements[0].films[0].modes[film]
    second_modes = model.elements[0].films[0].second_modes[film]
    columns = columns_of(model, film)
    a = lane
    while a < smooth_of(model, film):
        line = motion_at(model, w, film) + a * columns
        c = int(0)
        while c < columns:
            oil.film_motion[line + c] = real(0.0)
            c += 1
        if a < first:
            at = model.elements[0].films[0].smooth_motion_start[film] + a * (6 + modes)
            along = vec3(real(0.0))
            moment = vec3(real(0.0))
            for c in range(3):
                along[c] = model.elements[0].films[0].smooth_motion[at + c]
                moment[c] = model.elements[0].films[0].smooth_motion[at + 3 + c]
            for c in range(RIGID):
                oil.film_motion[line + c] = on_column(along, moment, sides, c)
            m = int(0)
            while m < modes:
                oil.film_motion[line + RIGID + m] = model.elements[0].films[0].smooth_motion[at + 6 + m]
                m += 1
        else:
            at = model.elements[0].films[0].second_smooth_motion_start[film] + (a - first) * second_modes
            m = int(0)
            while m < second_modes:
                oil.film_motion[line + RIGID + modes + m] = model.elements[0].films[0].second_smooth_motion[at + m]
                m += 1
        a += wp.block_dim()
    sync()


@wp.func
def condense(model: Model, w: int, film: int, lane: int, oil: FilmScratch) -> int:
    """From K, in the second part of `film_port`: (1 + K C)^-1 K and (1 + K C)^-1. Lanes over lines. 1 if singular."""
    r = smooth_of(model, film)
    port = port_at(model, w, film)
    own = model.elements[0].films[0].smooth_compliance_start[film]
    a = lane
    while a < r:
        line = port + a * 3 * r
        b = int(0)
        while b < r:
            oil.film_port[line + b] = dot(
                r, oil.film_port, line + r, model.elements[0].films[0].smooth_compliance, own + b * r
            )  # C is symmetric
            oil.film_port[line + 2 * r + b] = real(0.0)
            b += 1
        oil.film_port[line + a] = oil.film_port[line + a] + real(1.0)
        oil.film_port[line + 2 * r + a] = real(1.0)
        a += wp.block_dim()
    sync()
    return eliminate(oil.film_port, port, 3 * r, r, 2 * r, oil.film_port_pivots, smooth_at(model, w, film))


@wp.func
def stiffness_of(
    model: Model, w: int, film: int, lane: int, sides: Sides, oil: FilmScratch, film_stiffness: wp.array(dtype=real)
):
    """D^T P^T T^-1 U (Z - C (1 + K C)^-1 K Z), lanes over its columns."""
    r = smooth_of(model, film)
    columns = columns_of(model, film)
    port = port_at(model, w, film)
    motion = motion_at(model, w, film)
    at = smooth_at(model, w, film)
    square = w * model.elements[0].films[0].square_start[model.elements[0].films[0].count]
    square += model.elements[0].films[0].square_start[film]
    d = int(0)
    while d < columns:
        # forces on smooth functions by a column, then their amounts
        a = lane
        while a < r:
            total = real(0.0)
            b = int(0)
            while b < r:
                total += oil.film_port[port + a * 3 * r + r + b] * oil.film_motion[motion + b * columns + d]
                b += 1
            oil.film_force[at + a] = total
            a += wp.block_dim()
        sync()
        a = lane
        while a < r:
            yields = yielded(model, film, a, oil.film_force, at)
            oil.film_opened_smooth[at + a] = oil.film_motion[motion + a * columns + d] - yields
            a += wp.block_dim()
        sync()
        c = lane
        while c < columns:
            film_stiffness[square + c * columns + d] = push_on(model, w, film, c, sides, oil, oil.film_opened_smooth)
            c += wp.block_dim()
        sync()
        d += 1


@wp.func
def push_on(
    model: Model, w: int, film: int, c: int, sides: Sides, oil: FilmScratch, amounts: wp.array(dtype=real)
) -> real:
    """Force on column c by T^-1 U and these amounts of the smooth functions."""
    r = smooth_of(model, film)
    at = smooth_at(model, w, film)
    start = load_at(model, w, film)
    if c >= RIGID:
        return dot(r, oil.film_load, start + (c - 6) * (r + 1), amounts, at)
    force = vec3(real(0.0))
    moment = vec3(real(0.0))
    for k in range(3):
        force[k] = dot(r, oil.film_load, start + k * (r + 1), amounts, at)
        moment[k] = dot(r, oil.film_load, start + (3 + k) * (r + 1), amounts, at)
    return on_column(force, moment, sides, c)


@wp.func
def push_by_rest(model: Model, w: int, film: int, lane: int, sides: Sides, oil: FilmScratch):
    """Force of the film on its columns by R alone, from f_0 in `film_amount`. Lanes over functions, then columns."""
    r = smooth_of(model, film)
    columns = columns_of(model, film)
    at = smooth_at(model, w, film)
    a = lane
    while a < r:
        line = port_at(model, w, film) + a * 3 * r + 2 * r
        oil.film_force[at + a] = dot(r, oil.film_port, line, oil.film_amount, at)
        a += wp.block_dim()
    sync()
    a = lane
    while a < r:
        oil.film_opened_smooth[at + a] = -yielded(model, film, a, oil.film_force, at)
        a += wp.block_dim()
    sync()
    start = load_at(model, w, film) + r
    c = lane
    while c < columns:
        push = push_on(model, w, film, c, sides, oil, oil.film_opened_smooth)
        if c >= RIGID:
            push += oil.film_load[start + (c - 6) * (r + 1)]
        else:
            force = vec3(real(0.0))
            moment = vec3(real(0.0))
            for k in range(3):
                force[k] = oil.film_load[start + k * (r + 1)]
                moment[k] = oil.film_load[start + (3 + k) * (r + 1)]
            push += on_column(force, moment, sides, c)
        oil.film_push[w, model.elements[0].films[0].column_start[film] + c] = push
        c += wp.block_dim()
