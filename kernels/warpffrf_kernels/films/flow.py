r"""Oil balance of each shape function, and the forces of a film on both bodies.

Tested with the pressure shape functions psi_i, with the points' weights, lumped cavities of the area m_i, and T
D the cavity outflow with U, upwind across the faces between functions (an M-matrix):

    R_i = sum_k [psi_i,x f_x + psi_i,z f_z + psi_i delta_t(r h)] - m_i delta_t D_i - (T D)_i,    f = r (k grad p - U h).

R vanishes where the pressure is unknown; where it is given, R is the oil supplied there. With the *Reynolds* rule
cavities are not convected, and D is not a cavity but a slack of the equation.

Losses: pressure flow and sliding dissipate int k|grad p|^2 and int mu |u_B - u_A|^2/h, cavities that close at a
pressure dissipate the work they could have returned, -sum p_i (m_i delta_t D_i + (T D)_i), and feeds supply sum p_i
R_i.
"""

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.lanes import mosts, totals, values
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, mat33, real, sync, vec3
from warpffrf_kernels.core.scratch import Residuals, Trial
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.sampling import (
    FILLING,
    FLOW_ALONG,
    FLOW_AROUND,
    FORCE,
    FORCE_MOMENT,
    HALF,
    PRESSED,
    REYNOLDS,
    SECOND_FORCE_MOMENT,
    SHEAR,
    STORED,
    VISCOUS,
)
from warpffrf_kernels.surfaces.surface import axes_of, origin_of

wp.set_module_options(MODULE_OPTIONS)

# of the scene's extent, over the step: round-off of positions in a gap, some 1e-15 in axes that are oblique to the
# world's, over the tolerance of the iteration
ROUND_OFF = wp.constant(wp.float64(1.0e-6))
SMALL_PRESSURE = wp.constant(wp.float64(1.0e4))  # Pa: lower asperity pressures are negligible
TAKEN = 2  # columns of the dissipation: by pressure, cavities and feeds; by sliding


@wp.func
def through(model: Model, w: int, first: int, i: int, way: int, film_carried: wp.array3d(dtype=real)) -> real:
    """m2/s, half of the sliding through the face after function i, times its width."""
    other = model.elements[0].films[0].next_around[i]
    width = model.elements[0].films[0].face_around[i]
    if way == 1:
        other = model.elements[0].films[0].next_along[i]
        width = model.elements[0].films[0].face_along[i]
    return real(0.5) * width * (film_carried[w, i, way] + film_carried[w, first + other, way])


@wp.func
def neighbour(model: Model, i: int, n: int) -> int:
    """The n-th of four neighbours of function i, in the film, -1 for none."""
    found = model.elements[0].films[0].next_around[i]
    if n == 1:
        found = model.elements[0].films[0].before_around[i]
    elif n == 2:
        found = model.elements[0].films[0].next_along[i]
    elif n == 3:
        found = model.elements[0].films[0].before_along[i]
    return found


@wp.func
def leaving(model: Model, w: int, first: int, i: int, n: int, film_carried: wp.array3d(dtype=real)) -> real:
    """m2/s, from function i through the face to its n-th neighbour, negative for inflow."""
    other = neighbour(model, i, n)
    if other < 0:
        return real(0.0)
    if n == 0 or n == 2:
        return through(model, w, first, i, n / 2, film_carried)
    return -through(model, w, first, first + other, n / 2, film_carried)


@wp.func
def outflow(model: Model, w: int, first: int, i: int, film_carried: wp.array3d(dtype=real)) -> real:
    """m2/s, outflow of the cavities of function i over all faces: its own part of T."""
    total = real(0.0)
    for n in range(4):
        total += wp.max(leaving(model, w, first, i, n, film_carried), real(0.0))
    return total


@wp.func
def inflow(model: Model, w: int, first: int, i: int, n: int, film_carried: wp.array3d(dtype=real)) -> real:
    """m2/s, inflow of cavities from the n-th neighbour to function i."""
    return wp.max(-leaving(model, w, first, i, n, film_carried), real(0.0))


@wp.func
def holding(model: Model, w: int, film: int, i: int, oil: FilmScratch) -> real:
    """m2/s: a_0 m_i plus the outflow, the diagonal for cavities."""
    first = model.elements[0].films[0].function_start[film]
    area = model.elements[0].films[0].area[i]
    return oil.film_rates[w, 0] * area + outflow(model, w, first, i, oil.film_carried)


# Add flow and filling of function i at its points to `rest`, and the magnitudes of both to `size`. One lane.
@wp.func_native(f"""
    const int some = slope_around.shape[1];
    double flow = 0.0, filling = 0.0, all = 0.0;
    for (int e = begin; e < end; ++e) {{
        const size_t at = (size_t)point.data[e] * some + slot.data[e];
        const double* L = line.data + ((size_t)w * line.shape[1] + point.data[e]) * line.shape[2];
        const double x = slope_around.data[at] * L[{int(FLOW_AROUND)}], z = slope_along.data[at] * L[{int(FLOW_ALONG)}];
        flow += x + z;
        all += ::fabs(x) + ::fabs(z);
        filling += value.data[at] * L[{int(FILLING)}];
    }}
    rest.data[(size_t)w * rest.shape[1] + i] += flow + filling;
    size.data[(size_t)w * size.shape[1] + i] += all + ::fabs(filling);
""")
def balance_points(
    begin: int,
    end: int,
    point: wp.array(dtype=int),
    slot: wp.array(dtype=int),
    slope_around: wp.array2d(dtype=real),
    slope_along: wp.array2d(dtype=real),
    value: wp.array2d(dtype=real),
    line: wp.array3d(dtype=real),
    w: int,
    i: int,
    rest: wp.array2d(dtype=real),
    size: wp.array2d(dtype=real),
): ...


# sums[w, film, c] = sum of values[w, first + g, c] over the points, point by point; lanes over columns.
@wp.func_native("""
    const int lanes = WP_TILE_BLOCK_DIM, width = values.shape[2];
    const double* x = values.data + ((size_t)w * values.shape[1] + first) * width;
    double* y = sums.data + ((size_t)w * sums.shape[1] + film) * sums.shape[2];
    if (lanes == 1 && width <= 16) {
        double s[16] = {0.0};
        for (int g = 0; g < points; ++g)
            for (int c = 0; c < width; ++c) s[c] += x[(size_t)g * width + c];
        for (int c = 0; c < width; ++c) y[c] = s[c];
    } else
        for (int c = WP_TILE_THREAD_IDX; c < width; c += lanes) {
            double s = 0.0;
            for (int g = 0; g < points; ++g) s += x[(size_t)g * width + c];
            y[c] = s;
        }
""")
def sum_points(
    points: int, values: wp.array3d(dtype=real), w: int, first: int, sums: wp.array3d(dtype=real), film: int
): ...


@wp.func
def turn_sums(w: int, film: int, turn_a: mat33, turn_b: mat33, from_b: vec3, oil: FilmScratch):
    """Forces into the world; the torque about B's centre of mass, opposite to that on A about the same point."""
    force = vec3(real(0.0))
    moment = vec3(real(0.0))
    for c in range(3):
        force[c] = oil.film_sums[w, film, FORCE + c]
        moment[c] = oil.film_sums[w, film, FORCE_MOMENT + c]
    force = turn_a * force
    second = wp.transpose(turn_b) * (wp.cross(from_b, force) + turn_a * moment)
    for c in range(3):
        oil.film_sums[w, film, FORCE + c] = force[c]
        oil.film_sums[w, film, SECOND_FORCE_MOMENT + c] = -second[c]


@kernel
def balance_film(run: Run, trial: Trial, films: FilmState, oil: FilmScratch):
    """Per (world, film), lanes over functions, then over sums: R, its size relative to the flows, and the forces."""
    w, film, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    first = model.elements[0].films[0].function_start[film]
    end = model.elements[0].films[0].function_start[film + 1]
    travels = model.elements[0].films[0].rule[film] != REYNOLDS
    extent = model.length
    a = model.surfaces.body[model.elements[0].films[0].first[film]]
    b = model.surfaces.body[model.elements[0].films[0].second[film]]
    from_b = origin_of(trial.r1, w, a) - origin_of(trial.r1, w, b)
    if a >= 0:
        extent = wp.max(extent, wp.length(trial.r1[w, a]))
    if b >= 0:
        extent = wp.max(extent, wp.length(trial.r1[w, b]))
    i = first + lane
    while i < end:
        area = model.elements[0].films[0].area[i]
        oil.film_rest[w, i] = real(0.0)
        oil.film_size[w, i] = ROUND_OFF * oil.film_rates[w, 0] * area * extent
        balance_points(
            model.elements[0].films[0].entry_start[i], model.elements[0].films[0].entry_start[i + 1],
            model.elements[0].films[0].entry_point, model.elements[0].films[0].entry_slot,
            model.elements[0].films[0].slope_around, model.elements[0].films[0].slope_along,
            model.elements[0].films[0].value, oil.film_line, w, i, oil.film_rest, oil.film_size,
        )  # fmt: skip
        own = oil.film_rates[w, 0] * area * films.film_void[w, 1, i]
        refill = own
        if travels:
            refill += area * (
                oil.film_rates[w, 1] * films.film_void[w, 0, i] + oil.film_rates[w, 2] * films.film_void_before[w, i]
            )
        refill += outflow(model, w, first, i, oil.film_carried) * films.film_void[w, 1, i]
        for n in range(4):
            other = neighbour(model, i, n)
            if travels and other >= 0:
                refill -= inflow(model, w, first, i, n, oil.film_carried) * films.film_void[w, 1, first + other]
        oil.film_rest[w, i] = oil.film_rest[w, i] - refill
        oil.film_refill[w, i] = refill
        i += wp.block_dim()
    begin = model.elements[0].films[0].point_start[film]
    sum_points(model.elements[0].films[0].point_start[film + 1] - begin, oil.film_pull, w, begin, oil.film_sums, film)
    sync()
    if lane == 0:
        turn_sums(w, film, axes_of(trial.axes, w, a), axes_of(trial.axes, w, b), from_b, oil)
    worst = real(0.0)
    largest = real(0.0)
    sum = real(0.0)
    taken = real(0.0)
    i = first + lane
    while i < end:
        largest = wp.max(largest, oil.film_size[w, i])
        p = films.film_pressure[w, 1, i]
        if model.elements[0].films[0].unknown_of[i] >= 0:
            worst = wp.max(worst, wp.abs(oil.film_rest[w, i]))
            if model.elements[0].films[0].rule[film] == HALF:
                p = wp.max(p, real(0.0))
            taken -= p * oil.film_refill[w, i]
        else:
            taken -= p * (oil.film_rest[w, i] + oil.film_refill[w, i])
        sum += oil.film_rest[w, i]
        i += wp.block_dim()
    apart = real(0.0)  # difference of asperity pressure and law, relative to the largest pressure
    pressed = SMALL_PRESSURE
    stored = real(0.0)
    if lane == 0:
        stored = oil.film_sums[w, film, STORED]
    if model.elements[0].films[0].second_nodes[film] > 0:
        m = model.elements[0].films[0].second_node_start[film] + lane
        while m < model.elements[0].films[0].second_node_start[film + 1]:
            stored += oil.film_second_energy[w, m]
            m += wp.block_dim()
    if model.elements[0].films[0].rough[film] > 0:
        m = model.elements[0].films[0].node_start[film] + lane
        while m < model.elements[0].films[0].node_start[film + 1]:
            given = oil.film_node_line[w, m, PRESSED]
            apart = wp.max(apart, wp.abs(films.film_asperity[w, 1, m] - given))
            pressed = wp.max(pressed, given)
            stored += model.elements[0].films[0].node_area[m] * oil.film_energy_now[w, m]
            sum += given
            m += wp.block_dim()
    sums = totals(values(sum, taken, stored, real(0.0), real(0.0), real(0.0), real(0.0), real(0.0)))
    tops = mosts(values(worst, largest, apart, pressed, real(0.0), real(0.0), real(0.0), real(0.0)))
    if lane == 0:
        films.film_energy[w, 1, film] = sums[2]
        oil.film_off[w, film] = wp.max(tops[0] / tops[1], tops[2] / tops[3]) + real(0.0) * sums[0]
        films.film_power[w, 1, film, 0] = oil.film_sums[w, film, VISCOUS] + sums[1]
        films.film_power[w, 1, film, 1] = oil.film_sums[w, film, SHEAR]


@kernel
def push_films(
    run: Run, oil: FilmScratch, residuals: Residuals, film_pressure: wp.array(dtype=real),
    film_asperity: wp.array(dtype=real),
):  # fmt: skip
    """Per world, lanes over bodies, then over modes: subtract the forces of all films from their residuals."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    film = int(0)
    while film < model.elements[0].films[0].count:
        a = model.surfaces.body[model.elements[0].films[0].first[film]]
        b = model.surfaces.body[model.elements[0].films[0].second[film]]
        for c in range(3):
            if a >= 0 and a % wp.block_dim() == lane:
                residuals.residual[w, 6 * a + c] = residuals.residual[w, 6 * a + c] - oil.film_sums[w, film, FORCE + c]
                residuals.residual[w, 6 * a + 3 + c] = (
                    residuals.residual[w, 6 * a + 3 + c] - oil.film_sums[w, film, FORCE_MOMENT + c]
                )
            if b >= 0 and b % wp.block_dim() == lane:
                residuals.residual[w, 6 * b + c] = residuals.residual[w, 6 * b + c] + oil.film_sums[w, film, FORCE + c]
                residuals.residual[w, 6 * b + 3 + c] = (
                    residuals.residual[w, 6 * b + 3 + c] - oil.film_sums[w, film, SECOND_FORCE_MOMENT + c]
                )
        first = model.elements[0].films[0].function_start[film]
        functions = model.elements[0].films[0].function_start[film + 1] - first
        total = model.elements[0].films[0].function_start[model.elements[0].films[0].count]
        start = model.surfaces.modal_start[model.elements[0].films[0].first[film]]
        m = lane
        while m < model.elements[0].films[0].modes[film]:
            line = model.elements[0].films[0].moment_start[film] + m * functions
            at = (2 * w + 1) * total + first
            outwards = real(0.0)
            if model.elements[0].films[0].rule[film] == HALF:
                i = int(0)
                while i < functions:
                    outwards += model.elements[0].films[0].moment[line + i] * wp.max(film_pressure[at + i], real(0.0))
                    i += 1
            else:
                outwards = dot(functions, model.elements[0].films[0].moment, line, film_pressure, at)
            rough = model.elements[0].films[0].rough[film]
            line = model.elements[0].films[0].rough_moment_start[film] + m * rough
            at = (2 * w + 1) * model.elements[0].films[0].node_start[model.elements[0].films[0].count]
            at += model.elements[0].films[0].node_start[film]
            outwards += dot(rough, model.elements[0].films[0].rough_moment, line, film_asperity, at)
            residuals.modal_residual[w, start + m] = residuals.modal_residual[w, start + m] + outwards
            oil.film_modal[w, model.elements[0].films[0].column_start[film] + 12 + m] = -outwards
            m += wp.block_dim()
        modes = model.elements[0].films[0].modes[film]
        grid_nodes = model.elements[0].films[0].second_nodes[film]
        more = model.elements[0].films[0].second_modes[film]
        start = model.surfaces.modal_start[model.elements[0].films[0].second[film]]
        line = model.elements[0].films[0].second_shape_start[film]
        at = w * model.elements[0].films[0].second_node_start[model.elements[0].films[0].count]
        at += model.elements[0].films[0].second_node_start[film]
        c = lane
        while c < more:
            outwards = real(0.0)
            i = int(0)
            while i < grid_nodes:
                outwards += model.elements[0].films[0].second_shape[line + i * more + c] * oil.film_second_load[at + i]
                i += 1
            residuals.modal_residual[w, start + c] = residuals.modal_residual[w, start + c] + outwards
            oil.film_modal[w, model.elements[0].films[0].column_start[film] + 12 + modes + c] = -outwards
            c += wp.block_dim()
        film += 1


@kernel
def book_films(run: Run, films: FilmState, oil: FilmScratch):
    """Per world, lanes over films: energy [J] dissipated by films in the attempt, by the trapezoidal rule."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0:
        return
    half = real(0.5) * run.clk[w].h
    film = lane
    while film < model.elements[0].films[0].count:
        for line in range(TAKEN):
            oil.film_taken[w, film, line] = half * (
                films.film_power[w, 0, film, line] + films.film_power[w, 1, film, line]
            )
        film += wp.block_dim()
