"""The contact snippets against NumPy, written from the equations, on the arrays of an engine inside a step.

sum_hat: the sums over Gauss points of the module docstring of `line_of_centres_points`; couple: G of
`contact_compliance` from the dense compliance of both surfaces, without the tables; the elimination of the active nodes
put back into the whole system."""

from __future__ import annotations

import numpy as np

from warpffrf.online import Engine
from warpffrf.online.step.launches import blocks
from warpffrf_kernels.core import control as k
from warpffrf_kernels.kinematics import line_of_centres_points

ROUND_OFF = 1e-12  # relative to the largest entry: sums of some hundred terms


def slots(engine: Engine) -> tuple[np.ndarray, int]:
    """Hats of the window that have a slot, and their number."""
    count = int(engine.word("slots")[0])
    return engine.scratch.slot_node.numpy()[0, :count, 1].copy(), count


def surfaces(engine: Engine):
    contact = engine.scene.contacts[0]
    return contact.a.surface, contact.b.surface


def by_station(values: np.ndarray, cells: int, rows: int, NT: int, NZ: int) -> np.ndarray:
    """Values of the points of all strips, (cells, circumferential point, station, ...)."""
    places = values[: cells * rows * NZ * NT].reshape(cells, rows * NZ, NT, *values.shape[1:])
    return np.swapaxes(places, 1, 2)


def nodes_of_points(engine: Engine) -> dict[str, np.ndarray]:
    """What `weigh` sums, point by point: every Gauss point adds to four nodes of A, and there to four nodes of B."""
    m, x = engine.compiled.model, engine.scratch
    a, b = surfaces(engine)
    rows, rows_b, NT, NZ = a.grid.rows, b.grid.rows, engine.settings.theta_points, m.quadrature.z_points
    NS = (rows - 1) * NZ
    cells = m.window.columns + 1
    gap = by_station(x.point_gap.numpy()[0, 0], cells, rows - 1, NT, NZ)
    place = by_station(x.point_place.numpy()[0, 0], cells, rows - 1, NT, NZ)
    weight, wrench = x.station.numpy()[0, 0, :, 6], x.station_wrench.numpy()[0, 0]
    x_gauss, w_gauss = np.polynomial.legendre.leggauss(NT)
    xt, wt, xz = 0.5 * (x_gauss + 1.0), 0.5 * w_gauss, m.quadrature.z_abscissa.numpy()
    origin = int(x.center.numpy()[0, 0, 1]) - m.window.second_half
    low, high = x.window.numpy()[0, 0] + m.window.half
    found = {
        "weak_gap": np.zeros((m.window.columns, rows)), "area": np.zeros((m.window.columns, rows)),
        "wrench": np.zeros((m.window.columns, rows, 6)),
        "load": np.zeros((m.window.columns, rows, m.window.second_columns, rows_b)),
    }  # fmt: skip
    for cell in range(low, high + 2):
        for t in range(NT):
            for s in range(NS):
                q = a.grid.pitch * wt[t] * weight[s]
                u, v = place[cell, t, s]
                c_b = int(np.floor(u))
                r_b = min(int(np.floor(v)), rows_b - 2)
                for column, across in ((cell - 1, 1.0 - xt[t]), (cell, xt[t])):
                    if not low <= column <= high:
                        continue
                    zc = s // NZ
                    for row, along in ((zc, 1.0 - xz[s % NZ]), (zc + 1, xz[s % NZ])):
                        w = q * across * along
                        found["area"][column, row] += w
                        found["weak_gap"][column, row] += w * gap[cell, t, s]
                        found["wrench"][column, row] += w * wrench[s]
                        for dc, part in ((0, 1.0 - (u - c_b)), (1, u - c_b)):
                            for dr, share in ((0, 1.0 - (v - r_b)), (1, v - r_b)):
                                found["load"][column, row, c_b + dc - origin, r_b + dr] += w * part * share
    return found


def stencils(engine: Engine) -> np.ndarray:
    """Loads on B's nodes of the second window under unit pressure nodes, (columns, rows, columns of B, rows of B)."""
    m, x = engine.compiled.model, engine.scratch
    a, b = surfaces(engine)
    rows, rows_b, SC, SR = a.grid.rows, b.grid.rows, m.window.stencil_columns, m.window.stencil_rows
    weight, at = x.stencil.numpy()[0, 0], x.stencil_at.numpy()[0, 0]
    load = np.zeros((m.window.grid_nodes, m.window.second_columns, rows_b + SR))
    low, high = x.window.numpy()[0, 0] + m.window.half
    for i in range(low * rows, (high + 1) * rows):
        if x.area.numpy()[0, 0, i] > 0.0:
            load[i, at[i, 0] : at[i, 0] + SC, at[i, 1] : at[i, 1] + SR] += weight[i].reshape(SC, SR)
    assert not load[:, :, rows_b:].any()
    return load[: m.window.columns * rows, :, :rows_b].reshape(m.window.columns, rows, m.window.second_columns, rows_b)


SOLVED = 1e-9  # of the largest term: solves with G, of condition 1e4 and more


def close(found: np.ndarray, expected: np.ndarray, tolerance: float = ROUND_OFF) -> bool:
    return bool(np.abs(found - expected).max() <= tolerance * np.abs(expected).max())


def test_sum_node(engine: Engine) -> None:
    m, x = engine.compiled.model, engine.scratch
    expected = nodes_of_points(engine)
    rows = surfaces(engine)[0].grid.rows
    low, high = x.window.numpy()[0, 0] + m.window.half
    inside = slice(low, high + 1)
    for name, shape in (("weak_gap", ()), ("area", ()), ("wrench", (6,))):
        values = getattr(x, name).numpy()[0, 0][: m.window.columns * rows].reshape(m.window.columns, rows, *shape)
        assert close(values[inside], expected[name][inside]), name
    assert close(stencils(engine)[inside], expected["load"][inside])


def test_stencil_holds_a_row_that_only_inner_points_reach(engine: Engine) -> None:
    """The lowest row of B under a node may lie under any of its points: the load of a node is its area all the same."""
    m, x = engine.compiled.model, engine.scratch
    a = surfaces(engine)[0]
    rows, NT = a.grid.rows, engine.settings.theta_points
    place = x.point_place.numpy().copy()
    changed = place.copy()
    points = by_station(changed[0, 0], m.window.columns + 1, rows - 1, NT, m.quadrature.z_points)
    points[..., 1] = 1.0 + 1e-9
    points[:, NT // 2, :, 1] = 1.0 - 1e-9
    names = ("weak_gap", "area", "wrench", "stencil", "stencil_at")
    kept = {name: getattr(x, name).numpy().copy() for name in names}
    x.point_place.assign(changed)
    engine.control(run=1, moved=1)
    program = engine.graph.program
    blocks(line_of_centres_points.weigh, "pair").go(program.arrays, program.sizes, program.device)
    failure = int(engine.word("failure")[0])
    low, high = x.window.numpy()[0, 0] + m.window.half
    inside = slice(low * rows, (high + 1) * rows)
    load = x.stencil.numpy()[0, 0, inside].sum(axis=1)
    area = x.area.numpy()[0, 0, inside].copy()
    x.point_place.assign(place)
    for name, values in kept.items():
        getattr(x, name).assign(values)
    engine.control(failure=0)
    assert failure & int(k.STENCIL) == 0
    assert close(load, area)


def test_couple(engine: Engine) -> None:
    """G from D of both bodies, hat by hat, and the condensed global modes."""
    m, x = engine.compiled.model, engine.scratch
    a, b = surfaces(engine)
    mode, count = slots(engine)
    load = stencils(engine).reshape(m.window.columns * a.grid.rows, -1)[mode]
    first = (int(x.center.numpy()[0, 0, 0]) - m.window.half + mode // a.grid.rows) % a.grid.columns
    node = first * a.grid.rows + mode % a.grid.rows
    second = np.arange(m.window.second_columns) + int(x.center.numpy()[0, 0, 1]) - m.window.second_half
    node_b = ((second % b.grid.columns)[:, None] * b.grid.rows + np.arange(b.grid.rows)).ravel()
    D_A, D_B = (s.compliance(np.arange(s.grid.columns)) for s in (a, b))
    M_A = np.kron(a.grid.gram_theta(), a.gram_z)[node]
    G = M_A @ D_A @ M_A.T + load @ D_B[np.ix_(node_b, node_b)] @ load.T
    J = np.hstack([-M_A @ a.mode_normal, -load @ b.mode_normal[node_b]])
    receptance = x.receptance.numpy()[0]
    G += J * receptance @ J.T
    found_J = x.J.numpy().reshape(-1, m.pairs.most_modes)[:count, : J.shape[1]]
    assert close(found_J, J)
    assert close(x.G.numpy()[0, :count, :count], G)
    assert np.linalg.eigvalsh(G).min() > 0.0


def test_the_retained_matrix_with_the_pressures(engine: Engine) -> None:
    """A + L^T G^-1 L over the active nodes; and z, ds of the eliminated system solve the whole one."""
    m, x = engine.compiled.model, engine.scratch
    N = m.retained.count
    start, count = x.block.numpy()[0, 0, :2]
    order = x.order.numpy()[0, start : start + count]
    columns = m.pairs.coupled.numpy()[0, : m.pairs.coupled_count.numpy()[0]]
    L = np.zeros((count, N))
    L[:, columns] = x.L.numpy()[0, order, : len(columns)]
    G = x.G.numpy()[0][np.ix_(order, order)]
    p = engine.graph.pattern
    there = np.zeros((N, N), bool)
    there[np.repeat(np.arange(N), np.diff(p.entry_start)), p.entry_column] = True
    A, bordered = (np.where(there, a.numpy()[0], 0.0) for a in (x.tangent, x.bordered))
    added = L.T @ np.linalg.solve(G, L)
    assert count > 3 and not np.any(added[~there])
    assert np.abs(bordered - A - added).max() < SOLVED * np.abs(added).max()
    z, ds = x.z.numpy(), x.solution.numpy()[0, start : start + count]
    right = x.right.numpy()[0, start : start + count]
    assert np.abs(L @ z + G @ ds - right).max() < SOLVED * max(np.abs(right).max(), np.abs(G @ ds).max())
    rest = A @ z - L.T @ ds - x.rhs.numpy()[0]
    assert np.abs(rest).max() < SOLVED * (np.abs(A) @ np.abs(z) + np.abs(L.T) @ np.abs(ds)).max()


def test_first_rigid_columns_of_the_gradient(engine: Engine) -> None:
    """Hats that all move apart: L of a translation of A along the line of centres is minus that of B."""
    m, x = engine.compiled.model, engine.scratch
    _, count = slots(engine)
    L = x.L.numpy()[0, :count]
    assert close(L[:, 6:9], -L[:, 0:3])
    assert m.retained.count == 6 * m.bodies.count + m.dense.count + m.rows.count
