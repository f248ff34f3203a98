"""History of films after an accepted attempt, and saved values.

Rates by BDF2 use the film content r h and the cavities of the two previous accepted steps; a rejected attempt leaves
them unchanged. Equilibria and starts restart that history.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.films import HEATS
from warpffrf_kernels.core.ring import SavedFilms
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.flow import TAKEN
from warpffrf_kernels.films.sampling import BY_ASPERITIES, FORCE, FORCE_MOMENT, GAP, SECOND_FORCE_MOMENT
from warpffrf_kernels.films.sides import opened_with_second, sides_of
from warpffrf_kernels.surfaces.surface import axes_of

wp.set_module_options(MODULE_OPTIONS)

# --- saved values of a film: forces on A (world), moments about the centres of mass (world), then
SMALLEST = wp.constant(9)  # gap at a point, m
LARGEST = wp.constant(10)  # pressure, Pa
BY_PRESSURE = wp.constant(11)  # power dissipated by pressure flow, cavities and feeds, W
BY_SLIDING = wp.constant(12)  # power dissipated by sliding, W
FED = wp.constant(13)  # oil supplied by feeds, m3/s at the density rho_0
ENDS = wp.constant(14)  # oil that leaves at the ends, m3/s
VOIDS = wp.constant(15)  # volume of the cavities over that of the gap
OIL = wp.constant(16)  # volume of the oil, at the density rho_0, m3
ROUGH = wp.constant(17)  # normal force of the asperities, N
ROUGHEST = wp.constant(18)  # their largest pressure, Pa


@kernel
def keep_film(run: Run, oil: FilmScratch, films: FilmState):
    """Per (world, film), lanes over functions and points: the trial film becomes the accepted one; the tiny step of
    PROJECT is not stored, that of START stores its pressures."""
    w, film, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or run.ctl[w].mode == k.PROJECT:
        return
    i = model.elements[0].films[0].function_start[film] + lane
    while i < model.elements[0].films[0].function_start[film + 1]:
        films.film_pressure[w, 0, i] = films.film_pressure[w, 1, i]
        films.film_full[w, 0, i] = films.film_full[w, 1, i]
        if run.ctl[w].mode != k.START:
            films.film_void_before[w, i] = films.film_void[w, 0, i]
            films.film_void[w, 0, i] = films.film_void[w, 1, i]
        i += wp.block_dim()
    m = model.elements[0].films[0].node_start[film] + lane
    while m < model.elements[0].films[0].node_start[film + 1]:
        films.film_asperity[w, 0, m] = films.film_asperity[w, 1, m]
        m += wp.block_dim()
    if run.ctl[w].mode != k.START:
        g = model.elements[0].films[0].point_start[film] + lane
        while g < model.elements[0].films[0].point_start[film + 1]:
            films.film_mass[w, 1, g] = films.film_mass[w, 0, g]
            films.film_mass[w, 0, g] = oil.film_mass_now[w, g]
            g += wp.block_dim()
    if lane == 0:
        films.film_energy[w, 0, film] = films.film_energy[w, 1, film]
        for c in range(HEATS):
            films.film_heat[w, 0, film, c] = films.film_heat[w, 1, film, c]
        for line in range(TAKEN):
            films.film_power[w, 0, film, line] = films.film_power[w, 1, film, line]
    if lane == 0 and film == 0:
        films.film_step[w] = real(0.0)
        if run.ctl[w].mode == k.DYNAMIC:
            films.film_step[w] = run.clk[w].h


@kernel
def record_film(run: Run, trial: Trial, films: FilmState, oil: FilmScratch, saved: SavedFilms):
    """Per (world, film), lanes over nodes: fields at the nodes, and NUMBERS of the film."""
    w, film, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_film.shape[1]
    static = int(0)
    if run.ctl[w].mode == k.STATIC:
        static = int(1)
    sides = sides_of(model, w, film, static, trial)
    first = model.elements[0].films[0].function_start[film]
    points = model.elements[0].films[0].point_start[film + 1] - model.elements[0].films[0].point_start[film]
    m = model.elements[0].films[0].node_start[film] + lane
    while m < model.elements[0].films[0].node_start[film + 1]:
        f = first + model.elements[0].films[0].node_function[m]
        place = model.elements[0].films[0].node_place[m]
        seat = points + m - model.elements[0].films[0].node_start[film]
        seen = opened_with_second(model, w, film, sides, place, seat, oil)
        p = real(0.0)
        j = int(0)
        while j < model.elements[0].films[0].node_support.shape[1]:
            there = model.elements[0].films[0].node_support[m, j]
            if there >= 0:
                p += model.elements[0].films[0].node_value[m, j] * films.film_pressure[w, 0, first + there]
            j += 1
        saved.saved_film_pressure[w, at, m] = p
        saved.saved_film_gap[w, at, m] = seen[0] + model.elements[0].films[0].node_form[m] + oil.film_opened[w, m]
        saved.saved_film_void[w, at, m] = films.film_void[w, 0, f]
        saved.saved_film_asperity[w, at, m] = films.film_asperity[w, 0, m]
        m += wp.block_dim()
    m = model.elements[0].films[0].heat_start[film] + lane
    while m < model.elements[0].films[0].heat_start[film + 1]:
        saved.saved_film_temperature[w, at, m] = films.film_temperature[w, m]
        m += wp.block_dim()
    sync()
    if lane == 0:
        for c in range(HEATS):
            saved.saved_film_heat[w, at, film, c] = films.film_heat[w, 0, film, c]
        a = model.surfaces.body[model.elements[0].films[0].first[film]]
        b = model.surfaces.body[model.elements[0].films[0].second[film]]
        moment = vec3(real(0.0))
        second_moment = vec3(real(0.0))
        for c in range(3):
            saved.saved_film[w, at, film, c] = oil.film_sums[w, film, FORCE + c]
            moment[c] = oil.film_sums[w, film, FORCE_MOMENT + c]
            second_moment[c] = oil.film_sums[w, film, SECOND_FORCE_MOMENT + c]
        moment = axes_of(trial.axes, w, a) * moment
        second_moment = axes_of(trial.axes, w, b) * second_moment
        for c in range(3):
            saved.saved_film[w, at, film, 3 + c] = moment[c]
            saved.saved_film[w, at, film, 6 + c] = second_moment[c]
        least = real(1.0e300)
        space = real(0.0)
        filling = real(0.0)
        g = model.elements[0].films[0].point_start[film]
        while g < model.elements[0].films[0].point_start[film + 1]:
            least = wp.min(least, oil.film_line[w, g, GAP])
            space += model.elements[0].films[0].weight[g] * oil.film_line[w, g, GAP]
            filling += model.elements[0].films[0].weight[g] * oil.film_mass_now[w, g]
            g += 1
        fed = real(0.0)
        ends = real(0.0)
        empty = real(0.0)
        i = first
        while i < model.elements[0].films[0].function_start[film + 1]:
            empty += model.elements[0].films[0].area[i] * films.film_void[w, 0, i]
            if model.elements[0].films[0].unknown_of[i] < 0:
                if model.elements[0].films[0].feeds[i] != 0:
                    fed += oil.film_rest[w, i]
                else:
                    ends -= oil.film_rest[w, i]
            i += 1
        saved.saved_film[w, at, film, SMALLEST] = least
        saved.saved_film[w, at, film, BY_PRESSURE] = films.film_power[w, 0, film, 0]
        saved.saved_film[w, at, film, BY_SLIDING] = films.film_power[w, 0, film, 1]
        saved.saved_film[w, at, film, FED] = fed
        saved.saved_film[w, at, film, ENDS] = ends
        saved.saved_film[w, at, film, VOIDS] = empty / space
        saved.saved_film[w, at, film, OIL] = filling - empty
        roughest = real(0.0)
        largest = real(0.0)
        m = model.elements[0].films[0].node_start[film]
        while m < model.elements[0].films[0].node_start[film + 1]:
            roughest = wp.max(roughest, films.film_asperity[w, 0, m])
            largest = wp.max(largest, saved.saved_film_pressure[w, at, m])
            m += 1
        saved.saved_film[w, at, film, ROUGH] = oil.film_sums[w, film, BY_ASPERITIES]
        saved.saved_film[w, at, film, ROUGHEST] = roughest
        saved.saved_film[w, at, film, LARGEST] = largest


@kernel
def record_second(run: Run, oil: FilmScratch, saved: SavedFilms):
    """Per (world, film), lanes over nodes of a deformable second surface: their loads."""
    w, film, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_film_second.shape[1]
    total = model.elements[0].films[0].second_node_start[model.elements[0].films[0].count]
    m = model.elements[0].films[0].second_node_start[film] + lane
    while m < model.elements[0].films[0].second_node_start[film + 1]:
        saved.saved_film_second[w, at, m] = oil.film_second_load[w * total + m]
        m += wp.block_dim()
