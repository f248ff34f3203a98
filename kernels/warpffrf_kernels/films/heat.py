r"""Temperature of a film, averaged across the gap, after each accepted step (`warpffrf.model.films.heat`).

At node i, with F_ij the flow of oil [m3/s] to its neighbours j, s_i >= 0 what is supplied there (R of `flow`), m_i the
content [m3], and g_i = k sum_k w psi_i (1 - D/h)/h [W/K],

    m_i (T_i - T_i^0)/dt + sum_j max(-F_ij, 0) (T_i - T_j) + s_i (T_i - T_s)
        = [P_i - g_i (w_A + w_B)]/(rho c),

P_i the heat of the points that the node's function has. The flows through the faces between nodes are those of the oil
balance: from i to the next node j the part of f in the cells between them, - sum_k psi_j,x f_x, of that with both
functions on one row, less the cavities carried along. Their sum is R_i, exactly, so that temperatures lie between those
of supply, walls and before (an M-matrix), but for the heat generated; and summed over all nodes

    generated = carried away + conducted to A and B + stored,
    carried away = rho c [sum_out |R_i| (T_i - T_s) - sum_in R_i (T_in - T_s) + replaced at feeds],
    stored = rho c sum_i [m_i (T_i - T_i^0)/dt + dm_i/dt (T_i - T_s)],

relative to the supply T_s. The columns of the grid are solved in order, in both directions, each as a tridiagonal
system along the axis: exact for flows around that do not return, repeated for others.

In motions viscosities are those of the step's beginning (stable up to steps of about four passages of the oil). In
equilibria nothing is stored, and P_i depends on T_i as the viscosity does, to first order.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.state import FilmState
from warpffrf_kernels.films.flow import through
from warpffrf_kernels.films.sampling import FILLING, FLOW_ALONG, FLOW_AROUND, GAP, SHEAR, VISCOUS

wp.set_module_options(MODULE_OPTIONS)

COLDEST = wp.constant(wp.float64(-60.0))  # degC, of the table, as in `warpffrf.model.films.heat`
STEP = wp.constant(wp.float64(0.5))  # K
ENTRIES = wp.constant(721)
HOTTEST = wp.constant(wp.float64(300.0))  # degC: a film beyond runs away

# --- numbers of a film's heat, `Films.heat`
CAPACITY = wp.constant(0)
CONDUCTIVITY = wp.constant(1)
SUPPLY = wp.constant(2)
WALLS = wp.constant(3)
CARRY_OVER = wp.constant(5)
HELD = wp.constant(6)

# --- columns of `Films.heat_table`: of the viscosity, then of alpha; after its ENTRIES rows one for each node of the
# film, with the deviation of both walls [K] from their means
THINNING = wp.constant(0)

# --- values of a film, `FilmState.film_heat`
GENERATED = wp.constant(0)  # W
CARRIED = wp.constant(1)  # W
TO_A = wp.constant(2)  # W
TO_B = wp.constant(3)  # W
STORED = wp.constant(4)  # W
INLET = wp.constant(5)  # degC, of oil entering at feeds and leading edges
CHANGE = wp.constant(6)  # K, largest change in the last step
LEAVING = wp.constant(7)  # m3/s through the edges of a pad
LEAVING_HEAT = wp.constant(8)  # K m3/s, times its temperature

# --- values of a node
AROUND = wp.constant(0)  # m3/s to the next node around
ALONG = wp.constant(1)  # m3/s to the next node along
POWER = wp.constant(2)  # W
CONDUCTANCE = wp.constant(3)  # W/K
CONTENT = wp.constant(4)  # m3
GROWTH = wp.constant(5)  # m3/s
BEFORE = wp.constant(6)  # degC
RATIO = wp.constant(7)  # elimination of a column
SOLUTION = wp.constant(8)
ALPHA = wp.constant(9)  # of A, of B

MOST_SWEEPS = wp.constant(40)
SETTLED = wp.constant(wp.float64(1.0e-9))  # K, largest change in two sweeps


@wp.func
def table_at(model: Model, film: int, temperature: real, column: int) -> real:
    """Of the oil at a mean temperature: THINNING, ln of its viscosity over that at the reference temperature, or alpha
    of a wall."""
    at = wp.clamp((temperature - COLDEST) / STEP, real(0.0), real(ENTRIES - 1))
    n = wp.min(int(at), ENTRIES - 2)
    start = model.elements[0].films[0].heat_table_start[film]
    low = model.elements[0].films[0].heat_table[start + n, column]
    high = model.elements[0].films[0].heat_table[start + n + 1, column]
    return low + (at - real(n)) * (high - low)


@wp.func
def wall_at(model: Model, film: int, m: int, wall: int) -> real:
    """degC of wall A (0) or B (1) at node m of a film: its mean, and the deviation in the rows after the table."""
    row = model.elements[0].films[0].heat_table_start[film] + ENTRIES + m
    return model.elements[0].films[0].heat[film, WALLS + wall] + model.elements[0].films[0].heat_table[row, wall]


@wp.func
def conducted(model: Model, film: int, m: int, alpha: real, temperature: real, wall: int) -> real:
    """w [K] of wall A (0) or B (1) at node m of a film, 0 of an adiabatic one."""
    held = model.elements[0].films[0].heat[film, HELD + wall]
    both = held * model.elements[0].films[0].heat[film, HELD + 1 - wall]
    T = wall_at(model, film, m, wall)
    across = both * (wall_at(model, film, m, 1 - wall) - T)
    return held * (across + alpha * (temperature - T - real(0.5) * across))


@wp.func
def is_end(model: Model, i: int) -> int:
    """1 at a node of the first or last row that no feed supplies: oil enters there from the surroundings."""
    if model.elements[0].films[0].feeds[i] != 0:
        return 0
    if model.elements[0].films[0].next_along[i] < 0 or model.elements[0].films[0].before_along[i] < 0:
        return 1
    return 0


@wp.func
def is_edge(model: Model, i: int) -> int:
    """1 at a node of the first or last column of an arc or plane that no feed supplies."""
    if model.elements[0].films[0].feeds[i] != 0:
        return 0
    if model.elements[0].films[0].next_around[i] < 0 or model.elements[0].films[0].before_around[i] < 0:
        return 1
    return 0


@wp.func
def supplied(model: Model, w: int, i: int, oil: FilmScratch) -> real:
    """R [m3/s] of a node with a given pressure, negative where oil leaves; 0 of the others."""
    if model.elements[0].films[0].unknown_of[i] >= 0:
        return real(0.0)
    return oil.film_rest[w, i]


@wp.func
def entering(model: Model, w: int, film: int, i: int, inlet: real) -> real:
    """degC, of oil supplied at node i."""
    if is_end(model, i) != 0:
        return model.elements[0].films[0].heat[film, SUPPLY]
    return inlet


@wp.func
def gather(model: Model, w: int, film: int, i: int, n: int, films: FilmState, oil: FilmScratch):
    """Flows, heat, conductance and content of node i, at line n."""
    first = model.elements[0].films[0].function_start[film]
    around = real(0.0)
    along = real(0.0)
    power = real(0.0)
    conductance = real(0.0)
    content = real(0.0)
    growth = real(0.0)
    void = films.film_void[w, 1, i]
    e = model.elements[0].films[0].entry_start[i]
    while e < model.elements[0].films[0].entry_start[i + 1]:
        g = model.elements[0].films[0].entry_point[e]
        slot = model.elements[0].films[0].entry_slot[e]
        value = model.elements[0].films[0].value[g, slot]
        around += wp.min(model.elements[0].films[0].slope_around[g, slot], real(0.0)) * oil.film_line[w, g, FLOW_AROUND]
        along += wp.min(model.elements[0].films[0].slope_along[g, slot], real(0.0)) * oil.film_line[w, g, FLOW_ALONG]
        h = oil.film_line[w, g, GAP]
        weight = model.elements[0].films[0].weight[g] * value
        power += value * (oil.film_pull[w, g, VISCOUS] + oil.film_pull[w, g, SHEAR])
        conductance += weight * wp.clamp(real(1.0) - void / h, real(0.0), real(1.0)) / h
        content += weight * oil.film_mass_now[w, g]
        growth += value * oil.film_line[w, g, FILLING]
        e += 1
    area = model.elements[0].films[0].area[i]
    content -= area * void
    growth -= area * (
        oil.film_rates[w, 0] * void
        + oil.film_rates[w, 1] * films.film_void[w, 0, i]
        + oil.film_rates[w, 2] * films.film_void_before[w, i]
    )
    if model.elements[0].films[0].unknown_of[i] >= 0:
        power -= films.film_pressure[w, 1, i] * oil.film_refill[w, i]
    after = model.elements[0].films[0].next_around[i]
    if after >= 0:
        u = through(model, w, first, i, 0, oil.film_carried)
        around -= wp.max(u, real(0.0)) * void + wp.min(u, real(0.0)) * films.film_void[w, 1, first + after]
    after = model.elements[0].films[0].next_along[i]
    if after >= 0:
        u = through(model, w, first, i, 1, oil.film_carried)
        along -= wp.max(u, real(0.0)) * void + wp.min(u, real(0.0)) * films.film_void[w, 1, first + after]
    oil.film_heat_line[w, n, AROUND] = around
    oil.film_heat_line[w, n, ALONG] = along
    oil.film_heat_line[w, n, POWER] = power
    oil.film_heat_line[w, n, CONDUCTANCE] = model.elements[0].films[0].heat[film, CONDUCTIVITY] * conductance
    oil.film_heat_line[w, n, CONTENT] = wp.max(content, real(0.0))
    oil.film_heat_line[w, n, GROWTH] = growth
    oil.film_heat_line[w, n, BEFORE] = films.film_temperature[w, n]
    for wall in range(2):
        oil.film_heat_line[w, n, ALPHA + wall] = table_at(model, film, films.film_temperature[w, n], 1 + wall)


@wp.func
def arriving(model: Model, w: int, i: int, n: int, nodes: int, way: int, oil: FilmScratch) -> real:
    """m3/s from the neighbour of node i, at line n, before it around (0), after it (1), before it along (2), after it
    (3); `nodes`: line n less the number of the node in its film."""
    if way == 0 and model.elements[0].films[0].before_around[i] >= 0:
        return wp.max(oil.film_heat_line[w, nodes + model.elements[0].films[0].before_around[i], AROUND], real(0.0))
    if way == 1 and model.elements[0].films[0].next_around[i] >= 0:
        return wp.max(-oil.film_heat_line[w, n, AROUND], real(0.0))
    if way == 2 and model.elements[0].films[0].before_along[i] >= 0:
        return wp.max(oil.film_heat_line[w, nodes + model.elements[0].films[0].before_along[i], ALONG], real(0.0))
    if way == 3 and model.elements[0].films[0].next_along[i] >= 0:
        return wp.max(-oil.film_heat_line[w, n, ALONG], real(0.0))
    return real(0.0)


@wp.func
def next_to(model: Model, i: int, way: int) -> int:
    """That neighbour, in its film."""
    found = model.elements[0].films[0].before_around[i]
    if way == 1:
        found = model.elements[0].films[0].next_around[i]
    elif way == 2:
        found = model.elements[0].films[0].before_along[i]
    elif way == 3:
        found = model.elements[0].films[0].next_along[i]
    return found


@wp.func
def kept_part(model: Model, film: int, first: int, i: int, other: int) -> real:
    """Fraction of the oil coming from node `other` that continues at node i: less than 1 where it arrives at a feed."""
    if model.elements[0].films[0].feeds[i] != 0 and model.elements[0].films[0].feeds[first + other] == 0:
        return model.elements[0].films[0].heat[film, CARRY_OVER]
    return real(1.0)


@wp.func
def softening(model: Model, w: int, film: int, n: int, static: int, oil: FilmScratch) -> real:
    """W/K by which the heat of a node falls with its temperature; 0 in motions, which take viscosities as they were."""
    if static == 0:
        return real(0.0)
    T = oil.film_heat_line[w, n, BEFORE]
    slope = (table_at(model, film, T, THINNING) - table_at(model, film, T + STEP, THINNING)) / STEP
    return wp.max(oil.film_heat_line[w, n, POWER], real(0.0)) * slope


@wp.func
def solve_column(
    model: Model, w: int, film: int, column: int, rate: real, static: int, inlet: real, films: FilmState,
    oil: FilmScratch,
) -> real:  # fmt: skip
    """Temperatures of a column with its neighbours at theirs; the largest change [K]. rate [1/s]: 1/dt, 0 at rest."""
    first = model.elements[0].films[0].function_start[film]
    nodes = model.elements[0].films[0].heat_start[film]
    rows = model.elements[0].films[0].grid_rows[film]
    rho_c = model.elements[0].films[0].heat[film, CAPACITY]
    ratio = real(0.0)
    solution = real(0.0)
    r = int(0)
    while r < rows:
        m = column * rows + r
        i = first + m
        n = nodes + m
        conductance = oil.film_heat_line[w, n, CONDUCTANCE] / rho_c
        power = oil.film_heat_line[w, n, POWER] / rho_c
        before = oil.film_heat_line[w, n, BEFORE]
        supply = wp.max(supplied(model, w, i, oil), real(0.0))
        held = oil.film_heat_line[w, n, CONTENT] * rate
        diagonal = held + supply
        right = held * before + supply * entering(model, w, film, i, inlet) + power
        for wall in range(2):
            alpha = oil.film_heat_line[w, n, ALPHA + wall]
            diagonal += conductance * model.elements[0].films[0].heat[film, HELD + wall] * alpha
            right -= conductance * conducted(model, film, m, alpha, real(0.0), wall)
        slope = softening(model, w, film, n, static, oil) / rho_c
        diagonal += slope
        right += slope * before
        low = real(0.0)
        high = real(0.0)
        for way in range(4):
            flow = arriving(model, w, i, n, nodes, way, oil)
            if flow > real(0.0):
                other = next_to(model, i, way)
                part = kept_part(model, film, first, i, other)
                diagonal += flow
                right += (real(1.0) - part) * flow * inlet
                if way < 2:
                    right += part * flow * films.film_temperature[w, nodes + other]
                elif way == 2:
                    low = part * flow
                else:
                    high = part * flow
        if not diagonal > real(0.0):
            diagonal = real(1.0)
            right = films.film_temperature[w, n]
        pivot = diagonal - low * ratio
        ratio = high / pivot
        solution = (right + low * solution) / pivot
        oil.film_heat_line[w, n, RATIO] = ratio
        oil.film_heat_line[w, n, SOLUTION] = solution
        r += 1
    change = real(0.0)
    solution = real(0.0)
    r = rows - 1
    while r >= 0:
        n = nodes + column * rows + r
        solution = oil.film_heat_line[w, n, SOLUTION] + oil.film_heat_line[w, n, RATIO] * solution
        change = wp.max(change, wp.abs(solution - films.film_temperature[w, n]))
        films.film_temperature[w, n] = solution
        r -= 1
    return change


@wp.func
def inlet_of(model: Model, w: int, film: int, films: FilmState, oil: FilmScratch) -> real:
    """degC, of the oil that enters at feeds and edges: the supply, mixed with what leaves the film upstream."""
    supply = model.elements[0].films[0].heat[film, SUPPLY]
    upstream = model.elements[0].films[0].heat_upstream[film]
    if upstream < 0:
        return supply
    needed = real(0.0)
    i = model.elements[0].films[0].function_start[film]
    while i < model.elements[0].films[0].function_start[film + 1]:
        if is_end(model, i) == 0:
            needed += wp.max(supplied(model, w, i, oil), real(0.0))
        i += 1
    leaving = films.film_heat[w, 0, upstream, LEAVING]
    if not (needed > real(0.0) and leaving > real(0.0)):
        return supply
    hot = films.film_heat[w, 0, upstream, LEAVING_HEAT] / leaving
    part = wp.min(model.elements[0].films[0].heat[film, CARRY_OVER] * leaving / needed, real(1.0))
    return supply + part * (hot - supply)


@wp.func
def book_heat(
    model: Model, w: int, film: int, rate: real, static: int, inlet: real, films: FilmState, oil: FilmScratch
):  # fmt: skip
    """The balance of a film."""
    first = model.elements[0].films[0].function_start[film]
    nodes = model.elements[0].films[0].heat_start[film]
    rho_c = model.elements[0].films[0].heat[film, CAPACITY]
    supply = model.elements[0].films[0].heat[film, SUPPLY]
    for c in range(LEAVING_HEAT + 1):
        films.film_heat[w, 1, film, c] = real(0.0)
    n = nodes
    while n < model.elements[0].films[0].heat_start[film + 1]:
        i = first + n - nodes
        T = films.film_temperature[w, n]
        change = T - oil.film_heat_line[w, n, BEFORE]
        flow = supplied(model, w, i, oil)
        carried = wp.max(-flow, real(0.0)) * (T - supply)
        carried -= wp.max(flow, real(0.0)) * (entering(model, w, film, i, inlet) - supply)
        for way in range(4):
            arrives = arriving(model, w, i, n, nodes, way, oil)
            if arrives > real(0.0):
                other = next_to(model, i, way)
                part = kept_part(model, film, first, i, other)
                carried += (real(1.0) - part) * arrives * (films.film_temperature[w, nodes + other] - inlet)
        stored = oil.film_heat_line[w, n, CONTENT] * change * rate + oil.film_heat_line[w, n, GROWTH] * (T - supply)
        g = oil.film_heat_line[w, n, CONDUCTANCE]
        for wall in range(2):
            alpha = oil.film_heat_line[w, n, ALPHA + wall]
            films.film_heat[w, 1, film, TO_A + wall] += g * conducted(model, film, n - nodes, alpha, T, wall)
        generated = oil.film_heat_line[w, n, POWER] - softening(model, w, film, n, static, oil) * change
        films.film_heat[w, 1, film, GENERATED] += generated
        films.film_heat[w, 1, film, CARRIED] += rho_c * carried
        films.film_heat[w, 1, film, STORED] += rho_c * stored
        films.film_heat[w, 1, film, CHANGE] = wp.max(films.film_heat[w, 1, film, CHANGE], wp.abs(change))
        if is_edge(model, i) != 0 and flow < real(0.0):
            films.film_heat[w, 1, film, LEAVING] -= flow
            films.film_heat[w, 1, film, LEAVING_HEAT] -= flow * T
        n += 1
    films.film_heat[w, 1, film, INLET] = inlet


@kernel
def warm_film(run: Run, films: FilmState, oil: FilmScratch):
    """Per (world, film), lanes over nodes, then one: temperatures and viscosities of a film after an accepted step, and
    its balance of heat. A motion in which a film runs away ends."""
    w, film, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or (run.ctl[w].mode != k.DYNAMIC and run.ctl[w].mode != k.STATIC):
        return
    nodes = model.elements[0].films[0].heat_start[film]
    count = model.elements[0].films[0].heat_start[film + 1] - nodes
    if count == 0:
        return
    first = model.elements[0].films[0].function_start[film]
    n = lane
    while n < count:
        gather(model, w, film, first + n, nodes + n, films, oil)
        n += wp.block_dim()
    sync()
    if lane == 0:
        static = int(run.ctl[w].mode == k.STATIC)
        rate = real(0.0)
        if static == 0:
            rate = real(1.0) / run.clk[w].h
        inlet = inlet_of(model, w, film, films, oil)
        columns = model.elements[0].films[0].grid_columns[film]
        sweep = int(0)
        change = real(1.0)
        while sweep < MOST_SWEEPS and change > SETTLED:
            change = real(0.0)
            c = int(0)
            while c < columns:
                solve_column(model, w, film, c, rate, static, inlet, films, oil)
                c += 1
            while c > 0:
                c -= 1
                change = wp.max(change, solve_column(model, w, film, c, rate, static, inlet, films, oil))
            sweep += 1
        book_heat(model, w, film, rate, static, inlet, films, oil)
    sync()
    n = lane
    while n < count:
        T = films.film_temperature[w, nodes + n]
        films.film_thinning[w, nodes + n] = table_at(model, film, T, THINNING)
        if run.ctl[w].mode == k.DYNAMIC and not T <= HOTTEST:
            run.ctl[w].status = run.ctl[w].status | k.TOO_HOT
        n += wp.block_dim()
