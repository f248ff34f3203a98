r"""Balance of the oil of each function, and the forces of a film on both bodies.

Tested with the functions psi_i that the pressure is made of, with the points' weights, lumped voids of the area m_i,
and T D the voids that leave with U, upwind across the faces between functions (an M-matrix):

    R_i = sum_k [psi_i,x f_x + psi_i,z f_z + psi_i delta_t(r h)] - m_i delta_t D_i - (T D)_i,    f = r (k grad p - U h).

R vanishes where the pressure is unknown; where it is given, R is the oil that comes in there. With the *Reynolds* rule
voids do not travel, and what D stands for is no void but a slack of the equation.

Losses: the flow by pressure and the sliding take int k|grad p|^2 and int mu |u_B - u_A|^2/h, voids that close at a
pressure take what they could have given, -sum p_i (m_i delta_t D_i + (T D)_i), and feeds bring in sum p_i R_i.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync, vec3
from warpffrf_kernels.films.sampling import (
    FILLING,
    FLOW_ALONG,
    FLOW_AROUND,
    FORCE,
    FORCE_MOMENT,
    HALF,
    PRESSED,
    PULL,
    REYNOLDS,
    SECOND_FORCE_MOMENT,
    SHEAR,
    STORED,
    VISCOUS,
)

wp.set_module_options(MODULE_OPTIONS)

# of the scene's extent, over the step: what round-off of places leaves of a gap, some 1e-15 in axes that are oblique to
# the world's, over the tolerance of the iteration
ROUND_OFF = wp.constant(wp.float64(1.0e-6))
SMALL_PRESSURE = wp.constant(wp.float64(1.0e4))  # Pa: asperities that press less carry nothing
TAKEN = 2  # lines of the ledger: by pressure, voids and feeds; by sliding


@wp.func
def through(model: Model, w: int, first: int, i: int, way: int, film_carried: wp.array3d(dtype=real)) -> real:
    """m2/s, half of the sliding through the face behind function i, times its width."""
    other = model.elements[0].films[0].next_around[i]
    width = model.elements[0].films[0].face_around[i]
    if way == 1:
        other = model.elements[0].films[0].next_along[i]
        width = model.elements[0].films[0].face_along[i]
    return real(0.5) * width * (film_carried[w, i, way] + film_carried[w, first + other, way])


@wp.func
def neighbour(model: Model, i: int, n: int) -> int:
    """The n-th of four functions around function i, in the film, -1 for none."""
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
    """m2/s, from function i through the face to its n-th neighbour, negative where it comes from there."""
    other = neighbour(model, i, n)
    if other < 0:
        return real(0.0)
    if n == 0 or n == 2:
        return through(model, w, first, i, n / 2, film_carried)
    return -through(model, w, first, first + other, n / 2, film_carried)


@wp.func
def outflow(model: Model, w: int, first: int, i: int, film_carried: wp.array3d(dtype=real)) -> real:
    """m2/s, what voids of function i leave with over all faces: its own part of T."""
    total = real(0.0)
    for n in range(4):
        total += wp.max(leaving(model, w, first, i, n, film_carried), real(0.0))
    return total


@wp.func
def inflow(model: Model, w: int, first: int, i: int, n: int, film_carried: wp.array3d(dtype=real)) -> real:
    """m2/s, with what the voids of the n-th neighbour of function i come to it."""
    return wp.max(-leaving(model, w, first, i, n, film_carried), real(0.0))


@wp.func
def holding(
    model: Model,
    w: int,
    film: int,
    i: int,
    film_rates: wp.array2d(dtype=real),
    film_carried: wp.array3d(dtype=real),
) -> real:
    """m2/s: a_0 m_i and what leaves, the diagonal of what voids do."""
    first = model.elements[0].films[0].function_start[film]
    area = model.elements[0].films[0].area[i]
    return film_rates[w, 0] * area + outflow(model, w, first, i, film_carried)


@wp.kernel
def balance_film(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    film_pressure: wp.array3d(dtype=real),
    film_void: wp.array3d(dtype=real),
    film_void_before: wp.array2d(dtype=real),
    film_rates: wp.array2d(dtype=real),
    film_carried: wp.array3d(dtype=real),
    film_line: wp.array3d(dtype=real),
    film_pull: wp.array3d(dtype=real),
    film_asperity: wp.array3d(dtype=real),
    film_hat_line: wp.array3d(dtype=real),
    film_energy_now: wp.array2d(dtype=real),
    film_second_energy: wp.array2d(dtype=real),
    film_rest: inout(wp.array2d(dtype=real)),
    film_size: inout(wp.array2d(dtype=real)),
    film_refill: inout(wp.array2d(dtype=real)),
    film_sums: inout(wp.array3d(dtype=real)),
    film_off: out(wp.array2d(dtype=real)),
    film_power: out(wp.array4d(dtype=real)),
    film_energy: out(wp.array3d(dtype=real)),
):
    """Per (world, film), lanes over functions, then over sums: R, how large it is beside the flows, and the forces."""
    w, film, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    first = model.elements[0].films[0].function_start[film]
    end = model.elements[0].films[0].function_start[film + 1]
    travels = model.elements[0].films[0].rule[film] != REYNOLDS
    extent = model.length
    a = model.surfaces.body[model.elements[0].films[0].first[film]]
    b = model.surfaces.body[model.elements[0].films[0].second[film]]
    if a >= 0:
        extent = wp.max(extent, wp.length(r1[w, a]))
    if b >= 0:
        extent = wp.max(extent, wp.length(r1[w, b]))
    i = first + lane
    while i < end:
        flow = real(0.0)
        filling = real(0.0)
        size = real(0.0)
        e = model.elements[0].films[0].entry_start[i]
        while e < model.elements[0].films[0].entry_start[i + 1]:
            g = model.elements[0].films[0].entry_point[e]
            n = model.elements[0].films[0].entry_slot[e]
            x = model.elements[0].films[0].slope_around[g, n] * film_line[w, g, FLOW_AROUND]
            z = model.elements[0].films[0].slope_along[g, n] * film_line[w, g, FLOW_ALONG]
            flow += x + z
            size += wp.abs(x) + wp.abs(z)
            filling += model.elements[0].films[0].value[g, n] * film_line[w, g, FILLING]
            e += 1
        area = model.elements[0].films[0].area[i]
        own = film_rates[w, 0] * area * film_void[w, 1, i]
        refill = own
        if travels:
            refill += area * (film_rates[w, 1] * film_void[w, 0, i] + film_rates[w, 2] * film_void_before[w, i])
        refill += outflow(model, w, first, i, film_carried) * film_void[w, 1, i]
        for n in range(4):
            other = neighbour(model, i, n)
            if travels and other >= 0:
                refill -= inflow(model, w, first, i, n, film_carried) * film_void[w, 1, first + other]
        film_rest[w, i] = flow + filling - refill
        film_refill[w, i] = refill
        film_size[w, i] = size + wp.abs(filling) + ROUND_OFF * film_rates[w, 0] * area * extent
        i += wp.block_dim()
    c = lane
    while c < PULL:
        total = real(0.0)
        g = model.elements[0].films[0].point_start[film]
        while g < model.elements[0].films[0].point_start[film + 1]:
            total += film_pull[w, g, c]
            g += 1
        film_sums[w, film, c] = total
        c += wp.block_dim()
    sync()
    if lane == 0:
        worst = real(0.0)
        largest = real(0.0)
        sum = real(0.0)
        taken = real(0.0)
        i = first
        while i < end:
            largest = wp.max(largest, film_size[w, i])
            p = film_pressure[w, 1, i]
            if model.elements[0].films[0].unknown_of[i] >= 0:
                worst = wp.max(worst, wp.abs(film_rest[w, i]))
                if model.elements[0].films[0].rule[film] == HALF:
                    p = wp.max(p, real(0.0))
                taken -= p * film_refill[w, i]
            else:
                taken -= p * (film_rest[w, i] + film_refill[w, i])
            sum += film_rest[w, i]
            i += 1
        apart = real(0.0)  # of asperities and their law, beside the largest pressure
        most = SMALL_PRESSURE
        stored = film_sums[w, film, STORED]
        if model.elements[0].films[0].second_hats[film] > 0:
            m = model.elements[0].films[0].second_hat_start[film]
            while m < model.elements[0].films[0].second_hat_start[film + 1]:
                stored += film_second_energy[w, m]
                m += 1
        if model.elements[0].films[0].rough[film] > 0:
            m = model.elements[0].films[0].hat_start[film]
            while m < model.elements[0].films[0].hat_start[film + 1]:
                given = film_hat_line[w, m, PRESSED]
                apart = wp.max(apart, wp.abs(film_asperity[w, 1, m] - given))
                most = wp.max(most, given)
                stored += model.elements[0].films[0].hat_area[m] * film_energy_now[w, m]
                sum += given
                m += 1
        film_energy[w, 1, film] = stored
        film_off[w, film] = wp.max(worst / largest, apart / most) + real(0.0) * sum
        film_power[w, 1, film, 0] = film_sums[w, film, VISCOUS] + taken
        film_power[w, 1, film, 1] = film_sums[w, film, SHEAR]


@wp.kernel
def push_films(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    film_sums: wp.array3d(dtype=real),
    film_pressure: wp.array(dtype=real),
    film_asperity: wp.array(dtype=real),
    film_second_load: wp.array(dtype=real),
    residual: changed(wp.array2d(dtype=real)),
    modal_residual: changed(wp.array2d(dtype=real)),
    film_modal: out(wp.array2d(dtype=real)),
):
    """Per world: subtract the forces of all films from the residuals of their bodies and of the modes."""
    w = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    film = int(0)
    while film < model.elements[0].films[0].count:
        a = model.surfaces.body[model.elements[0].films[0].first[film]]
        b = model.surfaces.body[model.elements[0].films[0].second[film]]
        for c in range(3):
            if a >= 0:
                residual[w, 6 * a + c] = residual[w, 6 * a + c] - film_sums[w, film, FORCE + c]
                residual[w, 6 * a + 3 + c] = residual[w, 6 * a + 3 + c] - film_sums[w, film, FORCE_MOMENT + c]
            if b >= 0:
                residual[w, 6 * b + c] = residual[w, 6 * b + c] + film_sums[w, film, FORCE + c]
                residual[w, 6 * b + 3 + c] = residual[w, 6 * b + 3 + c] - film_sums[w, film, SECOND_FORCE_MOMENT + c]
        first = model.elements[0].films[0].function_start[film]
        functions = model.elements[0].films[0].function_start[film + 1] - first
        total = model.elements[0].films[0].function_start[model.elements[0].films[0].count]
        start = model.surfaces.modal_start[model.elements[0].films[0].first[film]]
        m = int(0)
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
            at = (2 * w + 1) * model.elements[0].films[0].hat_start[model.elements[0].films[0].count]
            at += model.elements[0].films[0].hat_start[film]
            outwards += dot(rough, model.elements[0].films[0].rough_moment, line, film_asperity, at)
            modal_residual[w, start + m] = modal_residual[w, start + m] + outwards
            film_modal[w, model.elements[0].films[0].column_start[film] + 12 + m] = -outwards
            m += 1
        hats = model.elements[0].films[0].second_hats[film]
        more = model.elements[0].films[0].second_modes[film]
        start = model.surfaces.modal_start[model.elements[0].films[0].second[film]]
        line = model.elements[0].films[0].second_shape_start[film]
        at = w * model.elements[0].films[0].second_hat_start[model.elements[0].films[0].count]
        at += model.elements[0].films[0].second_hat_start[film]
        c = int(0)
        while c < more:
            outwards = real(0.0)
            i = int(0)
            while i < hats:
                outwards += model.elements[0].films[0].second_shape[line + i * more + c] * film_second_load[at + i]
                i += 1
            modal_residual[w, start + c] = modal_residual[w, start + c] + outwards
            film_modal[w, model.elements[0].films[0].column_start[film] + 12 + m + c] = -outwards
            c += 1
        film += 1


@wp.kernel
def book_films(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    film_power: wp.array4d(dtype=real),
    film_taken: out(wp.array3d(dtype=real)),
):
    """Per world: energy [J] that films take in the attempt, by the trapezoidal rule."""
    w = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0:
        return
    half = real(0.5) * clk[w].h
    film = int(0)
    while film < model.elements[0].films[0].count:
        for line in range(TAKEN):
            film_taken[w, film, line] = half * (film_power[w, 0, film, line] + film_power[w, 1, film, line])
        film += 1
