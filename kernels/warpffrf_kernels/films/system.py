r"""The linear system of a film, and its condensed contribution to the bodies.

Unknown are, for each function whose pressure is not given, the pressure p if the film is full, else its cavity D; and
the pressures a of asperities in contact, with the equation a = P(-h) of their own. With G the opening at the nodes due
to pressures, and z the coupled columns, motions of both bodies and the global modes of the first,

    dh = L dz + between (G dp - Phi dq),

a linearised step of a film, and its forces P^T p on these columns, read

    R + J dx + B dz = 0,      J = A + (dR/dh) G on full functions, -(a_0 m + T) on cavitated ones,      B = (dR/dh) L,
    S dz = -r + P^T dx,       dx = -J^-1 (R + B dz),

so that bodies and modes have the stiffness P^T J^-1 B and the force -P^T J^-1 R. The asymmetry of J causes the whirl of
shafts. Cavitated functions carry no load, and are eliminated first: their columns have entries of their neighbours
only. The rotation of normals with the motion is neglected in S: c/R relative to the rest.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.scratch import RetainedSystem
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
    MOMENT,
    NORMAL,
    PRESSED,
    PRESSURE,
    REYNOLDS,
    SECOND_MOMENT,
    STIFFNESS,
)
from warpffrf_kernels.films.second_surface import write_second
from warpffrf_kernels.films.unknowns import (
    RIGID,
    add_scaled,
    columns_of,
    line_length,
    lines_of,
    matrix_at,
    retained_column,
    system_at,
    vector_at,
)
from warpffrf_kernels.linear.general_elimination import eliminate, solve_again

wp.set_module_options(MODULE_OPTIONS)


# Zero the entries of a line at the first `thin` unknowns of the order, by one lane.
@wp.func_native("""
    double* __restrict q = line.data + at; const int* p = place.data + start;
    for (int i = 0; i < n; ++i) q[i] = p[i] < thin ? 0.0 : q[i];
""")
def clear_thin(n: int, place: wp.array(dtype=int), start: int, thin: int, line: wp.array(dtype=real), at: int): ...


# y[at + place] = x[from], by one lane.
@wp.func_native("""
    double* q = y.data + at; const double* v = x.data + start_x; const int* p = place.data + start;
    for (int i = 0; i < n; ++i) q[p[i]] = v[i];
""")
def put_in_order(
    n: int,
    x: wp.array(dtype=real),
    start_x: int,
    place: wp.array(dtype=int),
    start: int,
    y: wp.array(dtype=real),
    at: int,
): ...


@wp.func
def put_rigid(matrix: wp.array(dtype=real), at: int, n: vec3, first: vec3, second: vec3):
    """Entries of the rigid columns: n at both bodies, with its moments about their centres of mass."""
    for c in range(3):
        matrix[at + c] = n[c]
        matrix[at + 3 + c] = first[c]
        matrix[at + 6 + c] = -n[c]
        matrix[at + 9 + c] = second[c]


@wp.func
def is_thin(model: Model, w: int, film: int, i: int, films: FilmState, oil: FilmScratch) -> bool:
    """Whether the column of unknown i is almost empty outside its own line: a cavity, or asperities out of contact."""
    n = model.elements[0].films[0].unknowns[film]
    if i >= n:
        return oil.film_rough[w, model.elements[0].films[0].node_start[film] + i - n] == 0
    f = model.elements[0].films[0].function_of[model.elements[0].films[0].unknown_start[film] + i]
    return films.film_full[w, 1, model.elements[0].films[0].function_start[film] + f] == 0


@wp.func
def order_unknowns(model: Model, w: int, film: int, lane: int, films: FilmState, oil: FilmScratch) -> int:
    """Position of each unknown in the elimination: thin ones first, cavities in the circumferential order of the flow,
    which leaves almost no entries in their columns. Returns the number of thin unknowns."""
    lines = lines_of(model, film)
    start = system_at(model, w, film)
    sync()
    thin = int(0)
    i = int(0)
    while i < lines:
        if is_thin(model, w, film, i, films, oil):
            thin += 1
        i += 1
    if lane == 0:
        backwards = oil.film_carried[w, model.elements[0].films[0].function_start[film], 0] < real(0.0)
        place = int(0)
        rest = thin
        i = int(0)
        while i < lines:
            if is_thin(model, w, film, i, films, oil):
                oil.film_order[start + i] = place
                if backwards:
                    oil.film_order[start + i] = thin - 1 - place
                place += 1
            else:
                oil.film_order[start + i] = rest
                rest += 1
            i += 1
    sync()
    return thin


@wp.func
def write_flow(model: Model, w: int, film: int, i: int, row: int, thin: int, films: FilmState, oil: FilmScratch):
    """Line of the oil balance of unknown i, without R; `row` is zero."""
    n = model.elements[0].films[0].unknowns[film]
    lines = lines_of(model, film)
    modes = model.elements[0].films[0].modes[film]
    columns = columns_of(model, film)
    first = model.elements[0].films[0].function_start[film]
    functions = model.elements[0].films[0].function_start[film + 1] - first
    first_unknown = model.elements[0].films[0].unknown_start[film]
    rule = model.elements[0].films[0].rule[film]
    f = model.elements[0].films[0].function_of[first_unknown + i]
    near = model.elements[0].films[0].near_start[first + f]
    # derivatives by the gap at the nodes (film_wide) and by the rigid columns, and the load on them
    j = near
    while j < model.elements[0].films[0].near_start[first + f + 1]:
        oil.film_wide[w, j] = real(0.0)
        j += 1
    pushes = films.film_full[w, 1, first + f] != 0
    if rule == HALF and films.film_pressure[w, 1, first + f] < real(0.0):
        pushes = False
    gap_n = vec3(real(0.0))
    gap_first = vec3(real(0.0))
    gap_second = vec3(real(0.0))
    push_n = vec3(real(0.0))
    push_first = vec3(real(0.0))
    push_second = vec3(real(0.0))
    e = model.elements[0].films[0].entry_start[first + f]
    while e < model.elements[0].films[0].entry_start[first + f + 1]:
        g = model.elements[0].films[0].entry_point[e]
        a = model.elements[0].films[0].entry_slot[e]
        x = model.elements[0].films[0].slope_around[g, a]
        z = model.elements[0].films[0].slope_along[g, a]
        v = model.elements[0].films[0].value[g, a]
        by_gap = x * oil.film_line[w, g, AROUND_BY_GAP] + z * oil.film_line[w, g, ALONG_BY_GAP]
        by_gap += v * oil.film_line[w, g, FILLING_BY_GAP]
        for c in range(4):
            at = near + model.elements[0].films[0].entry_near[e, c]
            oil.film_wide[w, at] = oil.film_wide[w, at] + by_gap * model.elements[0].films[0].between[g, c]
        push = v * model.elements[0].films[0].weight[g]
        if not pushes or (rule == HALF and oil.film_line[w, g, PRESSURE] <= real(0.0)):
            push = real(0.0)
        n_there = vector_at(oil.film_line, w, g, NORMAL)
        first_there = vector_at(oil.film_line, w, g, MOMENT)
        second_there = vector_at(oil.film_line, w, g, SECOND_MOMENT)
        gap_n += by_gap * n_there
        gap_first += by_gap * first_there
        gap_second += by_gap * second_there
        push_n += push * n_there
        push_first += push * first_there
        push_second += push * second_there
        e += 1
    put_rigid(oil.film_matrix, row + lines + 1, gap_n, gap_first, gap_second)
    put_rigid(oil.film_matrix, row + lines + 1 + columns, push_n, push_first, push_second)
    # deformation: opening by the pressures, and by the global modes
    j = near
    while j < model.elements[0].films[0].near_start[first + f + 1]:
        m = model.elements[0].films[0].near[j]
        line = model.elements[0].films[0].compliance_start[film] + m * lines
        add_scaled(lines, oil.film_wide[w, j], model.elements[0].films[0].compliance, line, oil.film_matrix, row)
        line = model.elements[0].films[0].shape_start[film] + m * modes
        add_scaled(
            modes, -oil.film_wide[w, j], model.elements[0].films[0].shape, line, oil.film_matrix,
            row + lines + 1 + RIGID,
        )  # fmt: skip
        j += 1
    if rule == HALF:
        j = int(0)
        while j < n:
            if films.film_pressure[w, 1, first + model.elements[0].films[0].function_of[first_unknown + j]] < real(0.0):
                oil.film_matrix[row + j] = real(0.0)
            j += 1
    # flow and content by the pressures of the functions at the same points
    e = model.elements[0].films[0].entry_start[first + f]
    while e < model.elements[0].films[0].entry_start[first + f + 1]:
        g = model.elements[0].films[0].entry_point[e]
        a = model.elements[0].films[0].entry_slot[e]
        x = model.elements[0].films[0].slope_around[g, a]
        z = model.elements[0].films[0].slope_along[g, a]
        v = model.elements[0].films[0].value[g, a]
        wide = oil.film_line[w, g, CONDUCTANCE]
        by_value = x * oil.film_line[w, g, AROUND_BY_PRESSURE] + z * oil.film_line[w, g, ALONG_BY_PRESSURE]
        by_value += v * oil.film_line[w, g, FILLING_BY_PRESSURE]
        z *= oil.film_line[w, g, EVENNESS]
        s = int(0)
        while s < model.elements[0].films[0].function.shape[1]:
            other = model.elements[0].films[0].function[g, s]
            if other >= 0:
                j = model.elements[0].films[0].unknown_of[first + other]
                if j >= 0:
                    flow = x * model.elements[0].films[0].slope_around[g, s]
                    flow += z * model.elements[0].films[0].slope_along[g, s]
                    entry = wide * flow + by_value * model.elements[0].films[0].value[g, s]
                    oil.film_matrix[row + j] = oil.film_matrix[row + j] + entry
            s += 1
        e += 1
    # load on the global modes
    m = int(0)
    while m < modes and pushes:
        at = model.elements[0].films[0].moment_start[film] + m * functions + f
        oil.film_matrix[row + lines + 1 + columns + RIGID + m] = -model.elements[0].films[0].moment[at]
        m += 1
    # cavities: their own outflow, and the inflow from neighbours
    clear_thin(lines, oil.film_order, system_at(model, w, film), thin, oil.film_matrix, row)
    if films.film_full[w, 1, first + f] == 0:
        oil.film_matrix[row + i] = -holding(model, w, film, first + f, oil)
    if rule != REYNOLDS:
        for c in range(4):
            other = neighbour(model, first + f, c)
            if other >= 0:
                j = model.elements[0].films[0].unknown_of[first + other]
                if j >= 0 and films.film_full[w, 1, first + other] == 0:
                    comes = inflow(model, w, first, first + f, c, oil.film_carried)
                    oil.film_matrix[row + j] = oil.film_matrix[row + j] + comes


@wp.func
def write_asperities(model: Model, w: int, film: int, m: int, row: int, thin: int, oil: FilmScratch):
    """Line of the asperities at node m, da + P' dh = P - a, without the right-hand side; `row` is zero."""
    n = model.elements[0].films[0].unknowns[film]
    lines = lines_of(model, film)
    modes = model.elements[0].films[0].modes[film]
    columns = columns_of(model, film)
    first = model.elements[0].films[0].function_start[film]
    grid_node = model.elements[0].films[0].node_start[film] + m
    stiff = oil.film_node_line[w, grid_node, STIFFNESS]
    line = model.elements[0].films[0].compliance_start[film] + m * lines
    add_scaled(lines, stiff, model.elements[0].films[0].compliance, line, oil.film_matrix, row)
    line = model.elements[0].films[0].shape_start[film] + m * modes
    add_scaled(modes, -stiff, model.elements[0].films[0].shape, line, oil.film_matrix, row + lines + 1 + RIGID)
    clear_thin(lines, oil.film_order, system_at(model, w, film), thin, oil.film_matrix, row)
    put_rigid(
        oil.film_matrix, row + lines + 1, stiff * vector_at(oil.film_node_line, w, grid_node, 0),
        stiff * vector_at(oil.film_node_line, w, grid_node, 3), stiff * vector_at(oil.film_node_line, w, grid_node, 6),
    )  # fmt: skip
    oil.film_matrix[row + n + m] = oil.film_matrix[row + n + m] + real(1.0)
    f = first + model.elements[0].films[0].node_function[grid_node]
    push_n = vec3(real(0.0))
    push_first = vec3(real(0.0))
    push_second = vec3(real(0.0))
    e = model.elements[0].films[0].entry_start[f]
    while e < model.elements[0].films[0].entry_start[f + 1]:
        g = model.elements[0].films[0].entry_point[e]
        v = model.elements[0].films[0].value[g, model.elements[0].films[0].entry_slot[e]]
        push = v * model.elements[0].films[0].weight[g]
        push_n += push * vector_at(oil.film_line, w, g, NORMAL)
        push_first += push * vector_at(oil.film_line, w, g, MOMENT)
        push_second += push * vector_at(oil.film_line, w, g, SECOND_MOMENT)
        e += 1
    put_rigid(oil.film_matrix, row + lines + 1 + columns, push_n, push_first, push_second)
    rough = model.elements[0].films[0].rough[film]
    c = int(0)
    while c < modes:
        at = model.elements[0].films[0].rough_moment_start[film] + c * rough + m
        oil.film_matrix[row + lines + 1 + columns + RIGID + c] = -model.elements[0].films[0].rough_moment[at]
        c += 1


@wp.func
def rest_of(model: Model, w: int, film: int, i: int, oil: FilmScratch, films: FilmState) -> real:
    """R of unknown i."""
    n = model.elements[0].films[0].unknowns[film]
    if i >= n:
        grid_node = model.elements[0].films[0].node_start[film] + i - n
        return films.film_asperity[w, 1, grid_node] - oil.film_node_line[w, grid_node, PRESSED]
    f = model.elements[0].films[0].function_of[model.elements[0].films[0].unknown_start[film] + i]
    return oil.film_rest[w, model.elements[0].films[0].function_start[film] + f]


@kernel
def assemble_film(run_of_run: Run, films: FilmState, oil: FilmScratch, film_stiffness: wp.array(dtype=real)):
    """Per (world, film), lanes over lines: J, B and P if the retained matrix is renewed, with J^-1 B; then J^-1 R."""
    w, film, lane = wp.tid()
    model = run_of_run.models[w]
    if run_of_run.ctl[w].run == 0 or run_of_run.ctl[w].moved == 0:
        return
    n = model.elements[0].films[0].unknowns[film]
    rough = model.elements[0].films[0].rough[film]
    lines = lines_of(model, film)
    columns = columns_of(model, film)
    stride = line_length(model, film)
    base = matrix_at(model, w, film)
    run = system_at(model, w, film)
    grid_node = model.elements[0].films[0].node_start[film]
    second = model.elements[0].films[0].second_nodes[film] > 0
    bad = int(0)
    if run_of_run.ctl[w].refresh != 0:
        # asperities in contact, and the order of elimination
        i = lane
        while i < rough:
            oil.film_rough[w, grid_node + i] = 0
            if films.film_asperity[w, 1, grid_node + i] > real(0.0) or oil.film_node_line[
                w, grid_node + i, PRESSED
            ] > real(0.0):
                oil.film_rough[w, grid_node + i] = 1
            i += wp.block_dim()
        thin = order_unknowns(model, w, film, lane, films, oil)
        # lines of J, R, B, P, and a reordered copy for the factorisation
        i = lane
        while i < lines:
            row = base + i * stride
            j = int(0)
            while j < stride:
                oil.film_matrix[row + j] = real(0.0)
                j += 1
            if second and (i < n or oil.film_rough[w, grid_node + i - n] != 0):
                stiff = real(0.0)
                if i >= n:
                    stiff = oil.film_node_line[w, grid_node + i - n, STIFFNESS]
                write_second(model, w, film, i, row, oil, stiff)
            if i < n:
                write_flow(model, w, film, i, row, thin, films, oil)
            elif oil.film_rough[w, grid_node + i - n] != 0:
                write_asperities(model, w, film, i - n, row, thin, oil)
            else:
                oil.film_matrix[row + i] = real(1.0)
            oil.film_matrix[row + lines] = rest_of(model, w, film, i, oil, films)
            sorted = base + oil.film_order[run + i] * stride
            put_in_order(lines, oil.film_matrix, row, oil.film_order, run, oil.film_factor, sorted)
            j = lines
            while j < lines + 1 + columns:
                oil.film_factor[sorted + j] = oil.film_matrix[row + j]
                j += 1
            i += wp.block_dim()
        sync()
        bad = eliminate(oil.film_factor, base, stride, lines, columns + 1, thin, oil.film_pivots, run)
        # solution J^-1 R and J^-1 B in the original order
        i = lane
        while i < lines:
            row = base + i * stride
            sorted = base + oil.film_order[run + i] * stride
            oil.film_solution[run + i] = oil.film_factor[sorted + lines]
            j = lines + 1
            while j < lines + 1 + columns:
                oil.film_matrix[row + j] = oil.film_factor[sorted + j]
                j += 1
            i += wp.block_dim()
        sync()
        # stiffness P^T J^-1 B
        square = w * model.elements[0].films[0].square_start[model.elements[0].films[0].count]
        square += model.elements[0].films[0].square_start[film]
        c = lane
        while c < columns:
            d = int(0)
            while d < columns:
                film_stiffness[square + c * columns + d] = real(0.0)
                d += 1
            i = int(0)
            while i < lines:
                row = base + i * stride + lines + 1
                push = oil.film_matrix[row + columns + c]
                if push != real(0.0):
                    add_scaled(columns, push, oil.film_matrix, row, film_stiffness, square + c * columns)
                i += 1
            c += wp.block_dim()
    else:
        # unchanged matrix: J^-1 R with the stored factor
        i = lane
        while i < lines:
            rest = rest_of(model, w, film, i, oil, films)
            oil.film_change[run + oil.film_order[run + i]] = rest
            i += wp.block_dim()
        solve_again(oil.film_factor, base, stride, lines, oil.film_pivots, run, oil.film_change, run)
        i = lane
        while i < lines:
            oil.film_solution[run + i] = oil.film_change[run + oil.film_order[run + i]]
            i += wp.block_dim()
        sync()
    # force P^T J^-1 R
    c = lane
    while c < columns:
        push = real(0.0)
        i = int(0)
        while i < lines:
            push += oil.film_matrix[base + i * stride + lines + 1 + columns + c] * oil.film_solution[run + i]
            i += 1
        oil.film_push[w, model.elements[0].films[0].column_start[film] + c] = push
        c += wp.block_dim()
    if bad != 0 and lane == 0:
        run_of_run.ctl[w].failure = run_of_run.ctl[w].failure | k.SINGULAR


@kernel
def stiffen_by_films(run: Run, oil: FilmScratch, system: RetainedSystem):
    """Per world: add the condensed contribution of all films to the retained system."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    film = int(0)
    while film < model.elements[0].films[0].count:
        columns = columns_of(model, film)
        c = int(0)
        while c < columns:
            i = retained_column(model, film, c)
            if i >= 0:
                system.rhs[w, i] = (
                    system.rhs[w, i] - oil.film_push[w, model.elements[0].films[0].column_start[film] + c]
                )
                d = int(0)
                while d < columns and run.ctl[w].refresh != 0:
                    j = retained_column(model, film, d)
                    if j >= 0:
                        at = model.elements[0].films[0].square_start[film] + c * columns + d
                        system.tangent[w, i, j] = system.tangent[w, i, j] + oil.film_stiffness[w, at]
                    d += 1
            c += 1
        film += 1
