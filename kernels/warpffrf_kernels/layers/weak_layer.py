r"""A layer with a nonlinear or damped law (`layer_laws`), in the weak form and in the local solution.

Weak form. On the surfaces p >= 0, g + y(p) >= 0, p (g + y(p)) = 0, with y = P^-1 the depth of the layer under p. Tested
with the shape functions psi_i of the first surface, and with p = sum_j s_j psi_j,

    0 <= s_i,      r_i = g_i + (G s)_i + int psi_i y(p) dA >= 0,      s_i r_i = 0,

g_i the weak gap. The integral is evaluated at the points of the pair's quadrature, the Gauss points of the grid's cells
or the reduced set chosen for all of them, or at the centres of contact-fixed cells, each the corner of its own cell and
of no other; their weights are positive. It is the gradient
of int W*(p) dA, W* the complementary energy of the layer, so its tangent

    E_ij = int psi_i psi_j y'(p) dA,      y' = 1/P',

is symmetric, positive definite (for few points semidefinite: with fewer points than nodes some combinations of nodes
have no compliance of their own, but have that of the bodies), and couples a node to its eight neighbours. With a depth
proportional to p this is M_psi/k, the constant of `LinearLayer`.

Tangent. At each point the curve is replaced by its tangent at a depth d_q, y(p) = a + b p with b = 1/P'(d_q) and
a = d_q - b P(d_q). The active set solution uses G + E instead of G and gaps that contain int psi (a + b p); it remains
the same linear complementarity problem, also for nodes outside the set.

Choice of the tangent. y is concave and steep at p = 0: a Newton iteration in the pressures converges slowly from below,
one in the depths slowly from above (for a logarithm by one decay length per step), and each is exact where the other
fails. After a solution a point has the pressure p and the depth y_t = a + b p, off the curve; the bodies respond to a
change of pressure by about -S, so the solution is near the intersection of the curve and the line

    d + S (P(d) - p) = y_t,

which lies between the depths y(p) and y_t and is approached from the nearer of them, from either side without
overshooting. S is the sum of the line of G (with the retained coordinates condensed) over the active nodes: the
response to a uniform change, which dominates. Any S > 0 has the same fixed point; near it, d_q = y(p) is Newton's
method. A step begins with the tangents at the present pressures; without pressure these have almost no stiffness, so
the first iterate of a step that closes the contact finds the penetration of the bodies without the layer.

Rates. A damped layer requires the depth of every point at the last accepted state: `layer_energy`.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import (
    ContactFields,
    ContactGeometry,
    ContactSolve,
    LayerScratch,
    PatchScratch,
)
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import CONSTANT, PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact, RetainedSystem
from warpffrf_kernels.core.state import ContactState, LayerState
from warpffrf_kernels.layers.layer_laws import CHI, layer_depth, layer_pressure, least_depth
from warpffrf_kernels.linear.retained_solve import held_motions, solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import COUNT, LEFT_START, START
from warpffrf_kernels.normal.pressure_products import ACTIVE, VECTORS, add_cells

wp.set_module_options(MODULE_OPTIONS)

NEAR = wp.constant(wp.float64(0.1))  # of the pressure: from there Newton's method in the pressures converges
NO_TIME = wp.constant(wp.float64(1.0e-15))  # s: no step is shorter, except a linearisation about a state (1e-20 s)
SIDE_STEPS = wp.constant(2)  # steps towards the intersection, which is only an initial guess


@wp.func
def cell_exists(model: Model, surface: int, column: int) -> bool:
    """Whether there is a cell between the grid columns `column` and the next, counted over full revolutions. On an arc
    the outermost columns have one on their outer side as well, where their shape functions end."""
    return model.surfaces.periodic[surface] != 0 or (column >= -1 and column < model.surfaces.columns[surface])


@wp.func
def rate_of(model: Model, run: Run, w: int, pair: int) -> real:
    """chi/h [1/m] of a pair's law in a time step, otherwise 0."""
    if run.ctl[w].mode != k.DYNAMIC or run.clk[w].h < NO_TIME:
        return real(0.0)
    return model.elements[0].layers.number[pair, CHI] / run.clk[w].h


@wp.func
def node_value(model: Model, node: int, point: int) -> real:
    """Value of corner `node` = 2 c + r of a cell at its point with index `point` in the tables."""
    x = model.elements[0].layers.x[point]
    z = model.elements[0].layers.zeta[point]
    if node < 2:
        x = real(1.0) - x
    if node % 2 == 0:
        z = real(1.0) - z
    return x * z


@wp.func
def point_area(model: Model, w: int, pair: int, point: int, m: int, area: wp.array3d(dtype=real)) -> real:
    """Area [m2] of the point with index `point` in the tables: that of the tables or, for a patch, whose cells grow
    with it, that of cell m, at whose centre the point is."""
    if model.pairs.family[pair] == PATCH:
        return area[w, pair, m]
    return model.elements[0].layers.area[point]


@wp.func
def corner_of(model: Model, cell: int, row: int, rows: int, node: int) -> int:
    """Window index of corner `node` = 2 c + r of the cell (cell, row), cell between the columns cell - 1 and cell of
    the window; -1 beyond the window."""
    column = cell - 1 + node / 2
    if column < 0 or column >= model.window.columns:
        return -1
    return column * rows + row + node % 2


@kernel
def linearise_layer(
    run: Run, geometry: ContactGeometry, contact: ContactState, layer: LayerState, layers: LayerScratch
):
    """Per (world, pair), lanes over points: the tangent of the law at the points of the window, from the pressures of
    the last solution; if the windows were moved, at the present pressures and all columns it may grow to.

    depth: d_q, flexibility: b, beginning: a of the module docstring; past, past_drag: depth and drag at the last
    accepted state.
    """
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.elements[0].layers.kind[pair] == CONSTANT:
        return
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    start = model.elements[0].layers.point_start[pair]
    per_column = model.elements[0].layers.point_count[pair]
    rate = rate_of(model, run, w, pair)
    fresh = run.ctl[w].iteration == 0 or run.ctl[w].recenter != 0
    moved = geometry.center[w, pair, 0] - layer.layer_column[w, pair]
    if model.pairs.family[pair] == PATCH:  # contact-fixed cells, with their history
        moved = int(0)
    turn = model.surfaces.turn[A]
    if turn > 0:
        moved = moved - turn * int(wp.floor(real(moved) / real(turn) + real(0.5)))
    last = (model.window.columns + 1) * per_column
    q = (geometry.window[w, pair, 0] + model.window.half) * per_column + lane
    end = (geometry.window[w, pair, 1] + model.window.half + 2) * per_column
    if fresh:
        q = lane
        end = last
        m = lane
        while m < model.window.grid_nodes:
            layers.layer_support[w, pair, m] = real(0.0)
            m += wp.block_dim()
        sync()
    least = least_depth(model, pair, real(0.0), real(0.0))  # for a point at rest
    at_least = layer_pressure(model, pair, least, real(0.0), real(0.0))
    while q < end:
        cell = q / per_column
        point = start + q - cell * per_column
        row = model.elements[0].layers.row[point]
        p = real(0.0)
        held = real(0.0)
        share = real(0.0)
        for node in range(4):
            m = corner_of(model, cell, row, rows, node)
            if m >= 0:
                value = node_value(model, node, point)
                if contact.active[w, pair, m] != 0:
                    p += value * wp.max(contact.pressure[w, pair, m], real(0.0))
                if layers.layer_support[w, pair, m] > real(0.0):
                    held += value * layers.layer_support[w, pair, m]
                    share += value
        if fresh:
            old = real(0.0)
            drag = real(0.0)
            source = q + moved * per_column
            if rate > real(0.0) and source >= 0 and source < last:
                old = layer.layer_depth[w, pair, source]
                drag = layer.layer_drag[w, pair, source]
            layers.layer_past[w, pair, q] = old
            layers.layer_past_drag[w, pair, q] = drag
            layers.layer_at[w, pair, q] = least
            layers.layer_flexibility[w, pair, q] = real(1.0) / at_least[1]
            layers.layer_beginning[w, pair, q] = least - at_least[0] / at_least[1]
            if p > real(0.0) or old > real(0.0):
                layers.layer_at[w, pair, q] = layer_depth(model, pair, p, old, rate)
        elif p > real(0.0) or share > real(0.0):
            if share > real(0.0):
                held = held / share
            on_tangent = layers.layer_beginning[w, pair, q] + layers.layer_flexibility[w, pair, q] * p
            layers.layer_at[w, pair, q] = next_depth(
                model, pair, p, layers.layer_at[w, pair, q], on_tangent, held, layers.layer_past[w, pair, q], rate
            )
        if p > real(0.0) or layers.layer_past[w, pair, q] > real(0.0) or layers.layer_at[w, pair, q] != least:
            at = layer_pressure(model, pair, layers.layer_at[w, pair, q], layers.layer_past[w, pair, q], rate)
            layers.layer_flexibility[w, pair, q] = real(1.0) / at[1]
            layers.layer_beginning[w, pair, q] = layers.layer_at[w, pair, q] - at[0] / at[1]
        q += wp.block_dim()


@wp.func
def next_depth(
    model: Model, pair: int, p: real, tangent_at: real, on_tangent: real, held: real, past: real, rate: real
) -> real:
    """Depth of the next tangent, after a solution with the pressure p and the depth `on_tangent` on the tangent at the
    depth `tangent_at`; `held`: S."""
    low = layer_depth(model, pair, p, past, rate)
    at = layer_pressure(model, pair, tangent_at, past, rate)
    if held <= real(0.0) or wp.abs(p - at[0]) <= NEAR * at[0]:
        return low
    asked = wp.max(on_tangent, least_depth(model, pair, past, rate))
    top = layer_pressure(model, pair, asked, past, rate)
    x = low
    beyond = low - asked  # distance of x from the line
    if wp.abs(held * (top[0] - p)) <= wp.abs(beyond):
        x = asked
        beyond = held * (top[0] - p)
    pressed = layer_pressure(model, pair, x, past, rate)[0]
    i = int(0)
    while i < SIDE_STEPS:
        here = layer_pressure(model, pair, x, past, rate)
        if beyond > real(0.0):  # downwards, in the depths
            x -= (x + held * (here[0] - p) - asked) / (real(1.0) + held * here[1])
        else:  # upwards, in the pressures
            pressed += (asked - x - held * (pressed - p)) / (real(1.0) / here[1] + held)
            x = layer_depth(model, pair, pressed, past, rate)
        i += 1
    return wp.clamp(x, wp.min(low, asked), wp.max(low, asked))


@kernel
def weigh_layer(run: Run, geometry: ContactGeometry, layers: LayerScratch):
    """Per (world, pair), lanes over nodes of the window: int psi_i a dA, and the line of E, neighbour (column + c - 1,
    row + r - 1) at 3 c + r."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.elements[0].layers.kind[pair] == CONSTANT:
        return
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    start = model.elements[0].layers.point_start[pair]
    per_column = model.elements[0].layers.point_count[pair]
    row_at = model.elements[0].layers.row_start[pair]
    m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        column = m / rows
        own_row = m - column * rows
        for n in range(9):
            layers.layer_tangent[w, pair, m, n] = real(0.0)
        total = real(0.0)
        for corner in range(4):  # corner of the cell that the node is
            cell = column + 1 - corner / 2
            row = own_row - corner % 2
            absolute = geometry.center[w, pair, 0] + cell - 1 - model.window.half
            if row >= 0 and row < rows - 1 and cell_exists(model, A, absolute):
                point = start + model.elements[0].layers.row_at[row_at + row]
                end = start + model.elements[0].layers.row_at[row_at + row + 1]
                q = cell * per_column + point - start
                while point < end:
                    weight = node_value(model, corner, point) * point_area(model, w, pair, point, m, geometry.area)
                    total += weight * layers.layer_beginning[w, pair, q]
                    weight = weight * layers.layer_flexibility[w, pair, q]
                    for node in range(4):
                        n = 3 * (1 + node / 2 - corner / 2) + 1 + node % 2 - corner % 2
                        value = weight * node_value(model, node, point)
                        layers.layer_tangent[w, pair, m, n] = layers.layer_tangent[w, pair, m, n] + value
                    point += 1
                    q += 1
        layers.layer_offset[w, pair, m] = total
        m += wp.block_dim()


@wp.func
def linear_yield(
    model: Model, w: int, pair: int, m: int, rows: int, contact: ContactState, layers: LayerScratch
) -> real:
    """int psi_m (a + b p) dA for the present pressures of the active nodes."""
    value = layers.layer_offset[w, pair, m]
    column = m / rows
    row = m - column * rows
    for c in range(3):
        for r in range(3):
            other = (column + c - 1) * rows + row + r - 1
            inside = column + c >= 1 and column + c <= model.window.columns and row + r >= 1 and row + r <= rows
            if inside:
                if contact.active[w, pair, other] != 0:
                    value += layers.layer_tangent[w, pair, m, 3 * c + r] * contact.pressure[w, pair, other]
    return value


@kernel
def add_yield(run: Run, geometry: ContactGeometry, contact: ContactState, layers: LayerScratch, fields: ContactFields):
    """Per (world, pair), lanes over nodes of the window: adds the layer's weak depth to the opening by local modes."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or model.elements[0].layers.kind[pair] == CONSTANT:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    base = (w * model.pairs.count + pair) * model.window.grid_nodes
    m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        value = linear_yield(model, w, pair, m, rows, contact, layers)
        fields.first_local[base + m] = fields.first_local[base + m] + value
        m += wp.block_dim()


@wp.func
def set_support(
    model: Model, w: int, pair: int, m: int, slot: int, held: real, geometry: ContactGeometry, normal: ContactSolve,
    layers: LayerScratch,
):  # fmt: skip
    """S of node m with the slot `slot`; `held`: its opening by the bodies' local compliance."""
    total = held
    c = int(0)
    while c < model.pairs.coupled_count[pair]:
        column = w * model.retained.count + model.pairs.coupled[pair, c]
        total += normal.L[w, slot, c] * layers.layer_moved[column]
        c += 1
    layers.layer_support[w, pair, m] = real(0.0)
    if geometry.area[w, pair, m] > real(0.0):
        layers.layer_support[w, pair, m] = wp.max(total / geometry.area[w, pair, m], real(0.0))


@kernel
def find_support(
    run: Run, contact: ContactState, geometry: ContactGeometry, normal: ContactSolve, patch: PatchScratch,
    impulses: ImpulsiveContact, system: RetainedSystem, layers: LayerScratch, patterns: wp.array(dtype=Pattern),
):  # fmt: skip
    """Per world, after an evaluation: S of the module docstring, the opening of each active node of a pair due to a
    uniform pressure on all of them, (G + L A^-1 L^T) 1 over its area; G 1 of pairs without a matrix by a product."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    slots = run.ctl[w].slots
    ones = w * VECTORS * model.capacity.slots
    opened = ones + model.capacity.slots
    held = held_motions(run.ctl, w, system.hold_count)
    if model.pairs.matrix_free != 0:
        i = lane
        while i < normal.block[w, 0, LEFT_START]:
            normal.krylov[ones + i] = real(1.0)
            normal.krylov[opened + i] = real(0.0)
            i += wp.block_dim()
        sync()
        add_cells(
            model, w, lane, ACTIVE, 1, 0, normal, patch, geometry, impulses, normal.krylov, ones, normal.krylov, opened
        )
    renew = int(1)
    pair = int(0)
    while pair < model.pairs.count:
        if model.elements[0].layers.kind[pair] != CONSTANT:
            count = model.pairs.coupled_count[pair]
            i = lane
            while i < model.retained.count:
                layers.layer_rhs[w * model.retained.count + i] = real(0.0)
                i += wp.block_dim()
            sync()
            i = int(0)
            while lane == 0 and i < slots:
                if normal.slot_node[w, i, 0] == pair and contact.active[w, pair, normal.slot_node[w, i, 1]] != 0:
                    c = int(0)
                    while c < count:
                        column = w * model.retained.count + model.pairs.coupled[pair, c]
                        layers.layer_rhs[column] = layers.layer_rhs[column] + normal.L[w, i, c]
                        c += 1
                i += 1
            sync()
            solve(
                model, patterns[0], w, lane, renew, system.tangent, layers.layer_rhs, system.hold, held, system.scaling,
                system.pivots, system.sparse_factor, system.sparse_vector, system.sparse_lines, system.fallback,
                system.elimination, system.inverse_transposed, layers.layer_moved,
            )  # fmt: skip
            renew = int(0)
            sync()
            i = lane
            while i < slots:
                if normal.slot_node[w, i, 0] == pair:
                    m = normal.slot_node[w, i, 1]
                    total = real(0.0)
                    j = int(0)
                    while j < slots and model.pairs.matrix[pair] != 0:
                        if (
                            normal.slot_node[w, j, 0] == pair
                            and contact.active[w, pair, normal.slot_node[w, j, 1]] != 0
                        ):
                            total += normal.G[w, i, j]
                        j += 1
                    set_support(model, w, pair, m, i, total, geometry, normal, layers)
                i += wp.block_dim()
            start = normal.block[w, pair, START]
            i = start + lane
            while i < start + normal.block[w, pair, COUNT] and model.pairs.matrix[pair] == 0:
                slot = normal.order[w, i]
                # the product contains the yield
                total = normal.krylov[opened + i] - normal.slot_yield[w, i]
                set_support(model, w, pair, normal.slot_node[w, slot, 1], slot, total, geometry, normal, layers)
                i += wp.block_dim()
            sync()
        pair += 1


@kernel
def add_flexibility(run: Run, normal: ContactSolve, layers: LayerScratch):
    """Per world, lanes over slots: G + E, if any pair has a matrix."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or model.pairs.dense == 0:
        return
    slots = run.ctl[w].slots
    i = lane
    while i < slots:
        pair = normal.slot_node[w, i, 0]
        m = normal.slot_node[w, i, 1]
        j = int(0)
        while j < slots:
            if normal.slot_node[w, j, 0] == pair or model.pairs.beside != 0:
                normal.soft[w, i, j] = normal.G[w, i, j]
            j += 1
        if model.elements[0].layers.kind[pair] != CONSTANT:
            rows = model.surfaces.rows[model.pairs.first[pair]]
            column = m / rows
            row = m - column * rows
            for c in range(3):
                for r in range(3):
                    inside = column + c >= 1 and column + c <= model.window.columns and row + r >= 1
                    if inside and row + r <= rows:
                        j = normal.slot_of[w, pair, (column + c - 1) * rows + row + r - 1]
                        if j >= 0:
                            normal.soft[w, i, j] = normal.soft[w, i, j] + layers.layer_tangent[w, pair, m, 3 * c + r]
        i += wp.block_dim()
