r"""Deformable second surface of a film: its opening due to the pressure.

The film is defined on A's grid. Its pressure acts in the opposite direction on B at the same points x_k, whose seats
S_k on B's grid (`seats`) change as the surfaces slide. By virtual work they are loads on B's nodes, which open the gap,

    f = sum_k w_k (p_k + a_k) S_k,        h_k += S_k.(D_B f - Phi_B q_B).

Where pressures are profiles at few points, these would load some of B's nodes and omit others: there the forces of A's
nodes, M p, act at the seats of these nodes. In either case a *load point* loads a seat, with an area for each function.
D_B is the compliance of B's local modes and Phi_B the normal displacement of its global ones. Slopes of this along B's
chart rotate the direction of the pressure (`sides.tilted`).
"""

import warp as wp

from warpffrf_kernels.core.control import STATIC
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.sampling import HALF
from warpffrf_kernels.films.seats import seat_node, seat_on, seat_part
from warpffrf_kernels.films.sides import sides_of
from warpffrf_kernels.surfaces.smooth import smooth_foot

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def place_of_seat(model: Model, film: int, seat: int) -> vec3:
    """Position of the seat-th seat of a film: points, then nodes."""
    point = model.elements[0].films[0].point_start[film]
    points = model.elements[0].films[0].point_start[film + 1] - point
    if seat < points:
        return model.elements[0].films[0].point_place[point + seat]
    return model.elements[0].films[0].node_place[model.elements[0].films[0].node_start[film] + seat - points]


@kernel
def load_second(run_of_run: Run, trial: Trial, films: FilmState, oil: FilmScratch):
    """Per (world, film), lanes over seats, then nodes of B: their positions, f, and the opening due to it."""
    w, film, lane = wp.tid()
    model = run_of_run.models[w]
    grid_nodes = model.elements[0].films[0].second_nodes[film]
    if run_of_run.ctl[w].run == 0 or run_of_run.ctl[w].moved == 0 or grid_nodes == 0:
        return
    static = int(0)
    if run_of_run.ctl[w].mode == STATIC:
        static = int(1)
    sides = sides_of(model, w, film, static, trial)
    s = model.elements[0].films[0].second[film]
    first = model.elements[0].films[0].function_start[film]
    first_node = model.elements[0].films[0].node_start[film]
    start = model.elements[0].films[0].seat_start[film]
    i = lane
    while i < model.elements[0].films[0].seat_start[film + 1] - start:
        y = sides.turn * place_of_seat(model, film, i) + sides.shift
        at = smooth_foot(model, s, y)
        seat = seat_on(model, film, at.theta, at.z)
        oil.film_seat[w, start + i, 0] = seat.low
        oil.film_seat[w, start + i, 1] = seat.right
        oil.film_seat_at[w, start + i, 0] = seat.u
        oil.film_seat_at[w, start + i, 1] = seat.v
        i += wp.block_dim()
    half = model.elements[0].films[0].rule[film] == HALF
    press = model.elements[0].films[0].press_start[film]
    presses = model.elements[0].films[0].press_start[film + 1] - press
    i = press + lane
    while i < press + presses:
        load = real(0.0)
        j = int(0)
        while j < model.elements[0].films[0].press_function.shape[1]:
            f = model.elements[0].films[0].press_function[i, j]
            if f >= 0:
                p = films.film_pressure[w, 1, first + f]
                if half:
                    p = wp.max(p, real(0.0))
                if model.elements[0].films[0].rough[film] > 0:
                    p += films.film_asperity[w, 1, first_node + f]  # functions are nodes then
                load += model.elements[0].films[0].press_value[i, j] * p
            j += 1
        oil.film_press_load[w, i] = load
        i += wp.block_dim()
    second_node = model.elements[0].films[0].second_node_start[film]
    run = w * model.elements[0].films[0].second_node_start[model.elements[0].films[0].count] + second_node
    i = lane
    while i < grid_nodes:
        oil.film_second_load[run + i] = real(0.0)
        i += wp.block_dim()
    sync()
    i = press
    while i < press + presses:  # the loads of a node are added by one lane, in a fixed order
        on = start + model.elements[0].films[0].press_seat[i]
        for c in range(4):
            grid_node = seat_node(oil.film_seat, w, on, c)
            if grid_node % wp.block_dim() == lane:
                load = seat_part(oil.film_seat_at, w, on, c) * oil.film_press_load[w, i]
                oil.film_second_load[run + grid_node] = oil.film_second_load[run + grid_node] + load
        i += 1
    sync()
    modes = model.elements[0].films[0].second_modes[film]
    modal = w * model.modes.count + model.surfaces.modal_start[s]
    i = lane
    while i < grid_nodes:
        row = model.elements[0].films[0].second_compliance_start[film] + i * grid_nodes
        local = dot(grid_nodes, model.elements[0].films[0].second_compliance, row, oil.film_second_load, run)
        oil.film_second_energy[w, second_node + i] = real(0.5) * local * oil.film_second_load[run + i]
        line = model.elements[0].films[0].second_shape_start[film] + i * modes
        oil.film_second_opened[run + i] = local - dot(
            modes, model.elements[0].films[0].second_shape, line, trial.q1, modal
        )
        i += wp.block_dim()
