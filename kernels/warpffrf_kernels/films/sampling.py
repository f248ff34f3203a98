r"""Gaps, pressures and flows of a film at its points.

A film is defined on the grid of its first surface A, in A's frame. At a point x of A, fixed in A's material,

    h = d_B(x) + forms - n.u_A + S(x).u,        grad h = n,

d_B the signed distance from the second surface, u_A the displacement of A by its modes and by the pressure, in A's own
normal, S u the opening by a deformable second surface (`sides`, `second`); n includes the slopes of its form and of S
u. With U = (u_B - u_A)/2 half the sliding velocity, r = rho(p)/rho_0, k = h^3/(12 mu), the cavity volume per area D (at
the density rho_0), and a rate of change by BDF2, delta_t f = a_0 f + a_1 f_(n-1) + a_2 f_(n-2),

    delta_t (r h - D) + div(U (r h - D)) - div(r k grad p) = 0,      0 <= p  _|_  D >= 0.

Half of the sliding velocity times h is the flow carried by both walls; its normal part, the change of h, is in delta_t.
Euler's rule (a_0 = 1/h) is used for the first step and in static steps, which have no velocities: their walls slide
with the initial velocities of the scene. A steady state is fixed in space while A spins about its own axis, so in A's
frame U contains that rotation in addition to half of the sliding.

**Forces.** The pressure exerts p n dA on A at x and the opposite on B at the same x, so that it is the derivative of h
with respect to all coordinates times p, and has no moment about the axis of a round B. Then the shear must be that of
B's wall, on A

    tau = mu (u_B - u_A)(1 - D/h)/h + (h/2) grad p,

and the opposite on B, at x again: action equals reaction in force and moment. The total power into the bodies is

    - int mu |u_B - u_A|^2 (1 - D/h)/h dA - int k |grad p|^2 dA - (closing of cavities) + (supply by feeds),

as follows from Reynolds' equation tested with p itself (`flow`). **Asperities** carry load in addition to the film, at
the nodes, with a pressure a = P(-h) that deforms and loads as p does, and friction mu a against the sliding. **Rough
walls** (`roughness`) have phi k in place of k, U h - l v/2 in place of U h with v = u_B - u_A, in the equation, and in
tau Phi mu v/h and (h - l)/2 in place of h/2, each with circumferential and axial factors: the losses are then Phi mu
v^2/h and phi k |grad p|^2, by the same identity. Cavities are convected with U as between smooth walls: they occur
where the film is thick, and l is below 1 % of a gap of ten deviations. Tangential displacements by the shear are
neglected, and so is the contribution of elastic motion to U.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real, sync, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import FilmState, MotionState
from warpffrf_kernels.films.asperities import asperities_at
from warpffrf_kernels.films.oil import oil_at
from warpffrf_kernels.films.roughness import factors_at
from warpffrf_kernels.films.sides import carried_at, opened_by_motion, opened_with_second, posed, sides_of, sliding_at

wp.set_module_options(MODULE_OPTIONS)

# --- cavitation rules, values of `Films.rule`
MASS_CONSERVING = wp.constant(0)  # cavities are convected with the oil
REYNOLDS = wp.constant(1)  # pressure or a slack in its place, which is not convected
HALF = wp.constant(2)  # negative pressures exert no load
NONE = wp.constant(3)  # negative pressures exert tension

# --- values of a point
GAP = wp.constant(0)
FLOW_AROUND = wp.constant(1)  # weight r (phi k p_x - h U_x + l v_x/2), multiplied by the slope of a test function
FLOW_ALONG = wp.constant(2)
FILLING = wp.constant(3)  # weight delta_t (r h)
CONDUCTANCE = wp.constant(4)  # weight r phi k, circumferential
AROUND_BY_PRESSURE = wp.constant(5)  # of both flows and the filling, at given slopes and gap
ALONG_BY_PRESSURE = wp.constant(6)
FILLING_BY_PRESSURE = wp.constant(7)
AROUND_BY_GAP = wp.constant(8)
ALONG_BY_GAP = wp.constant(9)
FILLING_BY_GAP = wp.constant(10)
PRESSURE = wp.constant(11)  # load-carrying pressure times the weight
NORMAL = wp.constant(12)  # n, A's axes
EVENNESS = wp.constant(15)  # axial phi over circumferential phi

# --- sums over the points, forces including shear
FORCE = wp.constant(0)  # on A, its axes; the sum in the world
FORCE_MOMENT = wp.constant(3)  # on A about its centre of mass, its axes
VISCOUS = wp.constant(6)  # power of the pressure flow, W
SHEAR = wp.constant(7)  # of the sliding, W
BY_ASPERITIES = wp.constant(8)  # normal force of asperities, N
STORED = wp.constant(9)  # energy of the local modes of A, J
SECOND_FORCE_MOMENT = wp.constant(10)  # on B about its centre of mass, its axes; of the sum only

# --- values of a node with asperities
PRESSED = wp.constant(0)  # pressure of the law, Pa
STIFFNESS = wp.constant(1)  # its slope, Pa/m
NODE_NORMAL = wp.constant(2)  # n, A's axes

GUARD = wp.constant(wp.float64(0.5))  # of the gaps at the start of a step: lower bound in its prediction


@wp.func
def at_point(model: Model, point: int, field: wp.array2d(dtype=real), w: int, first: int) -> real:
    """A field over nodes at a point; `first`: first node of the film."""
    total = real(0.0)
    for c in range(4):
        total += (
            model.elements[0].films[0].between[point, c]
            * field[w, first + model.elements[0].films[0].grid_node[point, c]]
        )
    return total


@kernel
def open_film(run: Run, films: FilmState, oil: FilmScratch):
    """Per (world, film), lanes over functions: an attempt starts from the accepted film and the coefficients of its
    rates."""
    w, film, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    i = model.elements[0].films[0].function_start[film] + lane
    while i < model.elements[0].films[0].function_start[film + 1]:
        films.film_pressure[w, 1, i] = films.film_pressure[w, 0, i]
        films.film_void[w, 1, i] = films.film_void[w, 0, i]
        films.film_full[w, 1, i] = films.film_full[w, 0, i]
        i += wp.block_dim()
    i = model.elements[0].films[0].node_start[film] + lane
    while i < model.elements[0].films[0].node_start[film + 1]:
        films.film_asperity[w, 1, i] = films.film_asperity[w, 0, i]
        i += wp.block_dim()
    if lane == 0:
        oil.film_changed[w, film] = 1
        if film == 0:
            h = run.clk[w].h
            if run.ctl[w].mode == k.STATIC:
                h *= oil.film_stretch[w]
            oil.film_rates[w, 0] = real(1.0) / h
            oil.film_rates[w, 1] = real(-1.0) / h
            oil.film_rates[w, 2] = real(0.0)
            if run.ctl[w].mode == k.DYNAMIC and films.film_step[w] > real(0.0):
                ratio = h / films.film_step[w]
                oil.film_rates[w, 0] = (real(1.0) + real(2.0) * ratio) / ((real(1.0) + ratio) * h)
                oil.film_rates[w, 1] = -(real(1.0) + ratio) / h
                oil.film_rates[w, 2] = ratio * ratio / ((real(1.0) + ratio) * h)


@kernel
def guard_prediction(run: Run, state: MotionState, films: FilmState, oil: FilmScratch, trial: Trial):
    """Per world, lanes over points, bodies, modes: predicted increments are limited so that the gaps stay above GUARD
    of those at the start of the step, and none opens by more than the largest: the acceleration of a light body may
    throw it out of its film."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].again != 0:
        return
    part = real(1.0)
    film = int(0)
    while film < model.elements[0].films[0].count:
        before = posed(model, w, film, 0, state, trial)
        after = posed(model, w, film, 1, state, trial)
        start = model.elements[0].films[0].point_start[film]
        end = model.elements[0].films[0].point_start[film + 1]
        g = start + lane
        while g < end:
            place = model.elements[0].films[0].point_place[g]
            closing = opened_by_motion(model, film, before, place)[0] - opened_by_motion(model, film, after, place)[0]
            oil.film_least[w, g] = closing
            g += wp.block_dim()
        sync()
        largest = real(0.0)
        opening = real(0.0)
        g = start
        while g < end:
            may = (real(1.0) - GUARD) * films.film_mass[w, 0, g]
            if oil.film_least[w, g] > may:
                part = wp.min(part, may / oil.film_least[w, g])
            largest = wp.max(largest, films.film_mass[w, 0, g])
            opening = wp.max(opening, -oil.film_least[w, g])
            g += 1
        if opening > largest:
            part = wp.min(part, largest / opening)
        film += 1
    sync()
    if part < real(1.0):
        b = lane
        while b < model.bodies.count:
            trial.dx[w, b] = part * trial.dx[w, b]
            trial.psi[w, b] = part * trial.psi[w, b]
            b += wp.block_dim()
        n = lane
        while n < model.modes.count:
            trial.dq[w, n] = part * trial.dq[w, n]
            n += wp.block_dim()


@kernel
def sample_film(run_of_run: Run, trial: Trial, films: FilmState, film_now: FilmScratch):
    """Per (world, film), lanes over unknowns, nodes, functions, points: values of all points. An attempt in which the
    surfaces touch has failed."""
    w, film, lane = wp.tid()
    model = run_of_run.models[w]
    if run_of_run.ctl[w].run == 0 or run_of_run.ctl[w].moved == 0:
        return
    static = int(0)
    if run_of_run.ctl[w].mode == k.STATIC:
        static = int(1)
    sides = sides_of(model, w, film, static, trial)
    rule = model.elements[0].films[0].rule[film]
    unknowns = model.elements[0].films[0].unknowns[film]
    rough = model.elements[0].films[0].rough[film]
    first = model.elements[0].films[0].function_start[film]
    first_unknown = model.elements[0].films[0].unknown_start[film]
    run = w * model.elements[0].films[0].system_start[model.elements[0].films[0].count]
    run += model.elements[0].films[0].system_start[film]
    first_node = model.elements[0].films[0].node_start[film]
    point = model.elements[0].films[0].point_start[film]
    points = model.elements[0].films[0].point_start[film + 1] - point
    # pressures that deform: of asperities, then of the film
    i = lane
    while i < rough:
        film_now.film_acting[run + unknowns + i] = films.film_asperity[w, 1, first_node + i]
        i += wp.block_dim()
    i = lane
    while i < unknowns:
        p = films.film_pressure[w, 1, first + model.elements[0].films[0].function_of[first_unknown + i]]
        if rule == HALF:
            p = wp.max(p, real(0.0))
        film_now.film_acting[run + i] = p
        i += wp.block_dim()
    sync()
    grid_nodes = model.elements[0].films[0].node_start[film + 1] - first_node
    A = model.elements[0].films[0].first[film]
    modes = model.elements[0].films[0].modes[film]
    modal = w * model.modes.count + model.surfaces.modal_start[A]
    # opening by pressures, those of full functions only
    flat = w * model.elements[0].films[0].node_start[model.elements[0].films[0].count] + first_node
    m = lane
    while m < grid_nodes:
        film_now.film_local[flat + m] = model.elements[0].films[0].lift[first_node + m]
        m += wp.block_dim()
    i = int(0)
    while i < unknowns + rough:
        p = film_now.film_acting[run + i]
        if p != real(0.0):
            line = model.elements[0].films[0].compliance_start[film] + i * grid_nodes
            axpy(grid_nodes, p, model.elements[0].films[0].compliance, line, film_now.film_local, flat)
        i += 1
    sync()
    # opening of the first surface at its nodes; pressure law, normal and moments of the asperities there
    m = lane
    while m < grid_nodes:
        u = film_now.film_local[flat + m]
        line = model.elements[0].films[0].shape_start[film] + m * modes
        u -= dot(modes, model.elements[0].films[0].shape, line, trial.q1, modal)
        film_now.film_opened[w, first_node + m] = u
        if rough > 0:
            place = model.elements[0].films[0].node_place[first_node + m]
            seen = opened_with_second(model, w, film, sides, place, points + m, film_now)
            gap = seen[0] + model.elements[0].films[0].node_form[first_node + m] + u
            law = asperities_at(model, film, -gap)
            for c in range(3):
                film_now.film_node_line[w, first_node + m, NODE_NORMAL + c] = seen[1 + c]
            film_now.film_node_line[w, first_node + m, PRESSED] = law[0]
            film_now.film_node_line[w, first_node + m, STIFFNESS] = law[1]
            film_now.film_energy_now[w, first_node + m] = law[2]
        m += wp.block_dim()
    # velocity U at the functions
    i = first + lane
    while i < model.elements[0].films[0].function_start[film + 1]:
        carried = carried_at(sides, model.elements[0].films[0].place[i])
        film_now.film_carried[w, i, 0] = wp.dot(carried, model.elements[0].films[0].around[i])
        film_now.film_carried[w, i, 1] = wp.dot(carried, model.elements[0].films[0].along[i])
        i += wp.block_dim()
    sync()
    a0 = film_now.film_rates[w, 0]
    first_warm = model.elements[0].films[0].heat_start[film]
    warm = model.elements[0].films[0].heat_start[film + 1] - first_warm
    # points: gap
    g = point + lane
    while g < point + points:
        place = model.elements[0].films[0].point_place[g]
        seen = opened_with_second(model, w, film, sides, place, g - point, film_now)
        h = seen[0] + model.elements[0].films[0].form[g] + at_point(model, g, film_now.film_opened, w, first_node)
        if not h > real(0.0):
            run_of_run.ctl[w].failure = run_of_run.ctl[w].failure | k.NOT_CONVERGED
            run_of_run.ctl[w].run = 0
        # film pressure with its slopes, cavity, and asperity pressure
        p = real(0.0)
        p_x = real(0.0)
        p_z = real(0.0)
        void = real(0.0)
        j = int(0)
        while j < model.elements[0].films[0].function.shape[1]:
            f = model.elements[0].films[0].function[g, j]
            if f >= 0:
                value = films.film_pressure[w, 1, first + f]
                p += model.elements[0].films[0].value[g, j] * value
                p_x += model.elements[0].films[0].slope_around[g, j] * value
                p_z += model.elements[0].films[0].slope_along[g, j] * value
                void += model.elements[0].films[0].void_value[g, j] * films.film_void[w, 1, first + f]
            j += 1
        pressed = real(0.0)
        if rough > 0:
            for c in range(4):
                load = films.film_asperity[w, 1, first_node + model.elements[0].films[0].grid_node[g, c]]
                pressed += model.elements[0].films[0].between[g, c] * load
        # sliding and flow factors
        slide = sliding_at(sides, place)
        around = model.elements[0].films[0].point_around[g]
        along = model.elements[0].films[0].point_along[g]
        slide_x = wp.dot(slide, around)
        slide_z = wp.dot(slide, along)
        carried = carried_at(sides, place)
        u_x = wp.dot(carried, around)
        u_z = wp.dot(carried, along)
        thinning = real(0.0)
        if warm > 0:
            thinning = at_point(model, g, films.film_thinning, w, first_warm)
        oil = oil_at(model, film, p, thinning)
        weight = model.elements[0].films[0].weight[g]
        over_h = real(1.0) / h
        conductance = h * h * h / (real(12.0) * oil.viscosity)
        factors = factors_at(model, film, h)
        through_x = factors.flow[0] * conductance
        through_z = factors.flow[1] * conductance
        kept_x = real(0.5) * factors.lag[0] * slide_x
        kept_z = real(0.5) * factors.lag[1] * slide_z
        even = real(1.0)
        if model.elements[0].films[0].factor_count[film] > 0:
            even = factors.flow[1] / factors.flow[0]
        # flows and film content, then their derivatives with respect to pressure and gap
        mass = oil.density * h
        film_now.film_mass_now[w, g] = mass
        film_now.film_line[w, g, GAP] = h
        film_now.film_line[w, g, FLOW_AROUND] = weight * oil.density * (through_x * p_x - h * u_x + kept_x)
        film_now.film_line[w, g, FLOW_ALONG] = weight * oil.density * (through_z * p_z - h * u_z + kept_z)
        past = (
            film_now.film_rates[w, 1] * films.film_mass[w, 0, g] + film_now.film_rates[w, 2] * films.film_mass[w, 1, g]
        )
        film_now.film_line[w, g, FILLING] = weight * (a0 * mass + past)
        film_now.film_line[w, g, CONDUCTANCE] = weight * oil.density * through_x
        film_now.film_line[w, g, EVENNESS] = even
        thinner_x = oil.density * through_x * oil.thickening
        thinner_z = oil.density * through_z * oil.thickening
        flow_x = through_x * p_x - h * u_x + kept_x
        flow_z = through_z * p_z - h * u_z + kept_z
        film_now.film_line[w, g, AROUND_BY_PRESSURE] = weight * (oil.stiffening * flow_x - thinner_x * p_x)
        film_now.film_line[w, g, ALONG_BY_PRESSURE] = weight * (oil.stiffening * flow_z - thinner_z * p_z)
        film_now.film_line[w, g, FILLING_BY_PRESSURE] = weight * a0 * oil.stiffening * h
        wide_x = real(3.0) * through_x * over_h + factors.flow_slope[0] * conductance
        wide_z = real(3.0) * through_z * over_h + factors.flow_slope[1] * conductance
        more_x = real(0.5) * factors.lag_slope[0] * slide_x
        more_z = real(0.5) * factors.lag_slope[1] * slide_z
        film_now.film_line[w, g, AROUND_BY_GAP] = weight * oil.density * (wide_x * p_x - u_x + more_x)
        film_now.film_line[w, g, ALONG_BY_GAP] = weight * oil.density * (wide_z * p_z - u_z + more_z)
        film_now.film_line[w, g, FILLING_BY_GAP] = weight * oil.density * a0
        # normal and its moments, shear, forces on both bodies, dissipated power
        pushing = p
        if rule == HALF:
            pushing = wp.max(p, real(0.0))
        n = vec3(seen[1], seen[2], seen[3])
        film_now.film_line[w, g, PRESSURE] = weight * pushing
        filled = wp.clamp(real(1.0) - void * over_h, real(0.0), real(1.0))
        drag = oil.viscosity * filled * over_h
        half_x = real(0.5) * (h - factors.lag[0])
        half_z = real(0.5) * (h - factors.lag[1])
        drag_x = drag * factors.drag[0]
        drag_z = drag * factors.drag[1]
        square = slide_x * slide_x + slide_z * slide_z
        rub = real(0.0)
        if pressed > real(0.0) and square > real(0.0):
            rub = model.elements[0].films[0].asperity_friction[film] * pressed / wp.sqrt(square)
        tau = ((drag_x + rub) * slide_x + half_x * p_x) * around + ((drag_z + rub) * slide_z + half_z * p_z) * along
        force = weight * ((pushing + pressed) * n + tau)
        moment = wp.cross(place, force)
        for c in range(3):
            film_now.film_line[w, g, NORMAL + c] = n[c]
            film_now.film_pull[w, g, FORCE + c] = force[c]
            film_now.film_pull[w, g, FORCE_MOMENT + c] = moment[c]
        film_now.film_pull[w, g, VISCOUS] = weight * oil.density * through_x * (p_x * p_x + even * p_z * p_z)
        dragged = (drag_x - drag) * slide_x * slide_x + (drag_z - drag) * slide_z * slide_z
        film_now.film_pull[w, g, SHEAR] = weight * ((drag + rub) * square + dragged)
        film_now.film_pull[w, g, BY_ASPERITIES] = weight * pressed
        yielded = real(0.0)
        for c in range(4):
            there = film_now.film_local[flat + model.elements[0].films[0].grid_node[g, c]]
            yielded += model.elements[0].films[0].between[g, c] * there
        film_now.film_pull[w, g, STORED] = real(0.5) * weight * (pushing + pressed) * yielded
        g += wp.block_dim()
