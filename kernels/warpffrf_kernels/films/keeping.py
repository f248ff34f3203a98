"""What films keep of an accepted attempt, and what of them is saved.

Rates by BDF2 have the fillings r h and voids of the two accepted steps before; an attempt that is rejected leaves them.
Equilibria and starts begin that history anew.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, sync, vec3
from warpffrf_kernels.films.flow import TAKEN
from warpffrf_kernels.films.sampling import (
    BY_ASPERITIES,
    FORCE,
    FORCE_MOMENT,
    GAP,
    SECOND_FORCE_MOMENT,
)
from warpffrf_kernels.films.sides import opened_with_second, sides_of
from warpffrf_kernels.surfaces.surface import axes_of

wp.set_module_options(MODULE_OPTIONS)

# --- numbers of a film that are saved: forces on A (world), moments about the centres of mass (world), then
SMALLEST = wp.constant(9)  # gap at a point, m
LARGEST = wp.constant(10)  # pressure, Pa
BY_PRESSURE = wp.constant(11)  # power that the flow by pressure, voids and feeds take, W
BY_SLIDING = wp.constant(12)  # that sliding takes, W
FED = wp.constant(13)  # oil that comes in through feeds, m3/s at the density rho_0
ENDS = wp.constant(14)  # oil that leaves at the ends, m3/s
VOIDS = wp.constant(15)  # volume of the voids over that of the gap
OIL = wp.constant(16)  # volume of the oil, of the density rho_0, m3
ROUGH = wp.constant(17)  # normal force of the asperities, N
ROUGHEST = wp.constant(18)  # largest pressure of theirs, Pa
NUMBERS = 19


@wp.kernel
def keep_film(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    film_mass_now: wp.array2d(dtype=real),
    film_pressure: inout(wp.array3d(dtype=real)),
    film_void: inout(wp.array3d(dtype=real)),
    film_full: inout(wp.array3d(dtype=int)),
    film_asperity: inout(wp.array3d(dtype=real)),
    film_energy: inout(wp.array3d(dtype=real)),
    film_mass: inout(wp.array3d(dtype=real)),
    film_power: inout(wp.array4d(dtype=real)),
    film_void_before: out(wp.array2d(dtype=real)),
    film_step: out(wp.array(dtype=real)),
):
    """Per (world, film), lanes over functions and points: the trial film becomes the accepted one; the tiny step of
    PROJECT leaves nothing, that of START its pressures."""
    w, film, lane = wp.tid()
    model = models[w]
    if ctl[w].accept == 0 or ctl[w].mode == k.PROJECT:
        return
    i = model.elements[0].films[0].function_start[film] + lane
    while i < model.elements[0].films[0].function_start[film + 1]:
        film_pressure[w, 0, i] = film_pressure[w, 1, i]
        film_full[w, 0, i] = film_full[w, 1, i]
        if ctl[w].mode != k.START:
            film_void_before[w, i] = film_void[w, 0, i]
            film_void[w, 0, i] = film_void[w, 1, i]
        i += wp.block_dim()
    m = model.elements[0].films[0].hat_start[film] + lane
    while m < model.elements[0].films[0].hat_start[film + 1]:
        film_asperity[w, 0, m] = film_asperity[w, 1, m]
        m += wp.block_dim()
    if ctl[w].mode != k.START:
        g = model.elements[0].films[0].point_start[film] + lane
        while g < model.elements[0].films[0].point_start[film + 1]:
            film_mass[w, 1, g] = film_mass[w, 0, g]
            film_mass[w, 0, g] = film_mass_now[w, g]
            g += wp.block_dim()
    if lane == 0:
        film_energy[w, 0, film] = film_energy[w, 1, film]
        for line in range(TAKEN):
            film_power[w, 0, film, line] = film_power[w, 1, film, line]
    if lane == 0 and film == 0:
        film_step[w] = real(0.0)
        if ctl[w].mode == k.DYNAMIC:
            film_step[w] = clk[w].h


@wp.kernel
def record_film(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    v1: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    film_pressure: wp.array3d(dtype=real),
    film_void: wp.array3d(dtype=real),
    film_asperity: wp.array3d(dtype=real),
    film_opened: wp.array2d(dtype=real),
    film_seat: wp.array3d(dtype=int),
    film_seat_at: wp.array3d(dtype=real),
    film_second_opened: wp.array(dtype=real),
    film_mass_now: wp.array2d(dtype=real),
    film_line: wp.array3d(dtype=real),
    film_sums: wp.array3d(dtype=real),
    film_rest: wp.array2d(dtype=real),
    film_power: wp.array4d(dtype=real),
    saved_film: out(wp.array4d(dtype=real)),
    saved_film_pressure: inout(wp.array3d(dtype=real)),
    saved_film_gap: out(wp.array3d(dtype=real)),
    saved_film_void: out(wp.array3d(dtype=real)),
    saved_film_asperity: out(wp.array3d(dtype=real)),
):
    """Per (world, film), lanes over hats: fields at the hats, and NUMBERS of the film."""
    w, film, lane = wp.tid()
    model = models[w]
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % saved_film.shape[1]
    static = int(0)
    if ctl[w].mode == k.STATIC:
        static = int(1)
    sides = sides_of(model, w, film, static, r1, axes, v1, omega1)
    first = model.elements[0].films[0].function_start[film]
    points = model.elements[0].films[0].point_start[film + 1] - model.elements[0].films[0].point_start[film]
    m = model.elements[0].films[0].hat_start[film] + lane
    while m < model.elements[0].films[0].hat_start[film + 1]:
        f = first + model.elements[0].films[0].hat_function[m]
        place = model.elements[0].films[0].hat_place[m]
        seat = points + m - model.elements[0].films[0].hat_start[film]
        seen = opened_with_second(model, w, film, sides, place, seat, film_seat, film_seat_at, film_second_opened)
        p = real(0.0)
        j = int(0)
        while j < model.elements[0].films[0].hat_support.shape[1]:
            there = model.elements[0].films[0].hat_support[m, j]
            if there >= 0:
                p += model.elements[0].films[0].hat_value[m, j] * film_pressure[w, 0, first + there]
            j += 1
        saved_film_pressure[w, at, m] = p
        saved_film_gap[w, at, m] = seen[0] + model.elements[0].films[0].hat_form[m] + film_opened[w, m]
        saved_film_void[w, at, m] = film_void[w, 0, f]
        saved_film_asperity[w, at, m] = film_asperity[w, 0, m]
        m += wp.block_dim()
    sync()
    if lane == 0:
        a = model.surfaces.body[model.elements[0].films[0].first[film]]
        b = model.surfaces.body[model.elements[0].films[0].second[film]]
        moment = vec3(real(0.0))
        second_moment = vec3(real(0.0))
        for c in range(3):
            saved_film[w, at, film, c] = film_sums[w, film, FORCE + c]
            moment[c] = film_sums[w, film, FORCE_MOMENT + c]
            second_moment[c] = film_sums[w, film, SECOND_FORCE_MOMENT + c]
        moment = axes_of(axes, w, a) * moment
        second_moment = axes_of(axes, w, b) * second_moment
        for c in range(3):
            saved_film[w, at, film, 3 + c] = moment[c]
            saved_film[w, at, film, 6 + c] = second_moment[c]
        least = real(1.0e300)
        space = real(0.0)
        filling = real(0.0)
        g = model.elements[0].films[0].point_start[film]
        while g < model.elements[0].films[0].point_start[film + 1]:
            least = wp.min(least, film_line[w, g, GAP])
            space += model.elements[0].films[0].weight[g] * film_line[w, g, GAP]
            filling += model.elements[0].films[0].weight[g] * film_mass_now[w, g]
            g += 1
        fed = real(0.0)
        ends = real(0.0)
        empty = real(0.0)
        i = first
        while i < model.elements[0].films[0].function_start[film + 1]:
            empty += model.elements[0].films[0].area[i] * film_void[w, 0, i]
            if model.elements[0].films[0].unknown_of[i] < 0:
                if model.elements[0].films[0].feeds[i] != 0:
                    fed += film_rest[w, i]
                else:
                    ends -= film_rest[w, i]
            i += 1
        saved_film[w, at, film, SMALLEST] = least
        saved_film[w, at, film, BY_PRESSURE] = film_power[w, 0, film, 0]
        saved_film[w, at, film, BY_SLIDING] = film_power[w, 0, film, 1]
        saved_film[w, at, film, FED] = fed
        saved_film[w, at, film, ENDS] = ends
        saved_film[w, at, film, VOIDS] = empty / space
        saved_film[w, at, film, OIL] = filling - empty
        roughest = real(0.0)
        largest = real(0.0)
        m = model.elements[0].films[0].hat_start[film]
        while m < model.elements[0].films[0].hat_start[film + 1]:
            roughest = wp.max(roughest, film_asperity[w, 0, m])
            largest = wp.max(largest, saved_film_pressure[w, at, m])
            m += 1
        saved_film[w, at, film, ROUGH] = film_sums[w, film, BY_ASPERITIES]
        saved_film[w, at, film, ROUGHEST] = roughest
        saved_film[w, at, film, LARGEST] = largest


@wp.kernel
def record_second(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    film_second_load: wp.array(dtype=real),
    saved_film_second: out(wp.array3d(dtype=real)),
):
    """Per (world, film), lanes over hats of the second surface, where it yields: their loads."""
    w, film, lane = wp.tid()
    model = models[w]
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % saved_film_second.shape[1]
    total = model.elements[0].films[0].second_hat_start[model.elements[0].films[0].count]
    m = model.elements[0].films[0].second_hat_start[film] + lane
    while m < model.elements[0].films[0].second_hat_start[film + 1]:
        saved_film_second[w, at, m] = film_second_load[w * total + m]
        m += wp.block_dim()
