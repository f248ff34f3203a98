"""How pressures answer to tractions: the condensed operator against NumPy, and what it does to the iteration.

The arrays are those of an engine inside a step: two rollers that roll on each other, the upper one in a light carriage
that the load alone presses down, or one roller on a plane, to which its tractions open gaps.
"""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.online import Engine, Settings
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf_kernels.core import control as k

ROUND_OFF = 1e-9  # of the largest entry: a solve with the pressures' matrix, of condition 1e4 and more
SKEW = 1e-3  # of the largest entry: H of bodies that turn is not quite symmetric, the matrix of the tractions is
STEP, OMEGA, LOAD = 5e-4, 10.0, 300e3  # s, rad/s, N


@pytest.fixture(scope="module")
def body() -> wf.ReducedBody:
    mesh = wf.mesh.roller(0.05, 0.015, 0.01, sectors=240, layers=5, axial=2, grading=1.6, order=1)
    return wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=0, grid=wf.ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def rolling(body: wf.ReducedBody, creepage: float = 2e-3) -> wf.Scene:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    speed, at = -OMEGA * (1.0 - creepage), (0.0, 0.0, 0.1)
    lower = scene.add_body(body, name="lower", angular_velocity=(0.0, OMEGA, 0.0))
    upper = scene.add_body(body, name="upper", position=at, angular_velocity=(0.0, speed, 0.0))
    carriage = scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="carriage", position=at)
    center = carriage.at((0.0, 0.0, 0.0))
    first = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="first"))
    second = scene.add(wf.joints.Revolute(center, upper["bore"], axis=(0, 1, 0), name="second"))
    scene.add(wf.joints.Prismatic(scene.ground, center, axis=(0, 0, 1), name="guide"))
    scene.add(wf.forces.PointForce(center, (0.0, 0.0, -LOAD)))
    scene.add(wf.joints.Drive(first, OMEGA, quantity="velocity"))
    scene.add(wf.joints.Drive(second, speed, quantity="velocity"))
    scene.add(wf.Contact(lower["rim"], upper["rim"], friction=0.3, name="pair"))
    return scene


def on_a_plane(body: wf.ReducedBody) -> wf.Scene:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    plane = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="plane")
    wheel = scene.add_body(
        body, name="wheel", position=(0, 0, 0.05), velocity=(0.05 * OMEGA, 0.002, 0.0), angular_velocity=(0, OMEGA, 0)
    )
    scene.add(wf.forces.PointForce(wheel["bore"], (0.0, 0.0, -LOAD)))
    scene.add(wf.Contact(wheel["rim"], plane, friction=0.3, name="pair"))
    return scene


@pytest.fixture(scope="module", params=[rolling, on_a_plane])
def stopped(request: pytest.FixtureRequest, body: wf.ReducedBody) -> Engine:
    """After two steps, with iterations on a third that make everything anew, the last where it has converged."""
    engine = Engine(request.param(body), settings=Settings())
    assert settle(engine)
    engine.initial_rates()
    start_consistently(engine)
    engine.control(every=1)
    engine.enter(k.DYNAMIC, STEP, target=2)
    engine.replay(8)
    assert engine.word("status")[0] == 0 and engine.word("step")[0] == 2
    for _ in range(8):
        engine.control(run=1, moved=1, reassemble=1, refresh=1, recenter=0, iteration=0, failure=0)
        engine.graph.iterate()
    assert engine.word("changes")[0] == 0 and cells_of(engine) > 5
    return engine


def cells_of(engine: Engine) -> int:
    """Cells in play of the first pair."""
    return int(engine.scratch.cell_block.numpy()[0, 0, 1])


def operators(engine: Engine) -> tuple[np.ndarray, ...]:
    """G and L_n of the active slots, in the order of the last solve; L and G of the lines of cells; the retained matrix
    with the pressures, inverted; L over the retained columns."""
    m, x, state = engine.compiled.model, engine.scratch, engine.state
    lines, N, width = 2 * cells_of(engine), m.retained.count, int(m.pairs.coupled_count.numpy()[0])
    place = np.zeros((width, N))
    place[np.arange(width), m.pairs.coupled.numpy()[0, :width]] = 1.0
    n = int(x.answer_state.numpy()[0, 0])
    order = x.order.numpy()[0, :n]
    grid_nodes = x.slot_node.numpy()[0, order, 1]
    np.testing.assert_array_equal(np.sort(grid_nodes), np.flatnonzero(state.active.numpy()[0, 0]))
    np.testing.assert_array_equal(grid_nodes, x.answer_node.numpy()[0, :n])
    L_n, L = x.L.numpy()[0, order, :width] @ place, x.cell_L.numpy()[0, 0, :lines, :width] @ place
    H = np.linalg.inv(x.bordered.numpy()[0])
    pushed = m.pairs.coupled.numpy()[0, :width]  # the columns that tractions push: no others of the receptance are made
    found = x.friction_receptance.numpy().reshape(N, N).T[:, pushed]
    np.testing.assert_allclose(found, H[:, pushed], rtol=0.0, atol=ROUND_OFF * np.abs(H).max())
    return x.soft.numpy()[0][np.ix_(order, order)], L_n, L, x.cell_G.numpy()[0, 0, :lines, :lines], H, grid_nodes


def coupling(engine: Engine) -> np.ndarray:
    """N^T (active slots, lines of the cells) without the retained coordinates: how the gaps open with each traction by
    the local modes, evaluated, and by the global ones."""
    x, state, width = engine.scratch, engine.state, engine.compiled.model.pairs.most_modes
    n, cells = int(x.answer_state.numpy()[0, 0]), cells_of(engine)
    order = x.order.numpy()[0, :n]
    grid_nodes = x.slot_node.numpy()[0, order, 1]
    rows = len(engine.scene.contacts[0].a.surface.grid.z)
    kept, bound, number = state.traction.numpy().copy(), x.bound.numpy()[0, 0].copy(), x.cell_slot.numpy()[0, 0, :cells]
    found = []
    for m in number:
        for d in range(2):
            gaps = []
            for size in (0.5, -0.5):  # within the bounds, which an evaluation cuts them to
                trial = np.zeros_like(kept)
                trial[0, 0, (m // rows) * 2 * rows + d * rows + m % rows] = size * bound[m]
                state.traction.assign(trial)
                engine.control(run=1, moved=1)
                engine.graph.evaluate()
                gaps.append(x.opened.numpy()[0, 0, grid_nodes])
            found.append((gaps[0] - gaps[1]) / max(bound[m], np.finfo(float).tiny))
    state.traction.assign(kept)
    engine.control(run=1, moved=1)
    engine.graph.evaluate()
    J_n, J = x.J.numpy().reshape(-1, width)[order], x.cell_J.numpy().reshape(-1, width)[: 2 * cells]
    return np.array(found).T + (J_n * x.receptance.numpy()[0, :width]) @ J.T


def test_the_answer_of_the_pressures_is_condensed(stopped: Engine, request: pytest.FixtureRequest) -> None:
    G, L_n, L, K, H, grid_nodes = operators(stopped)
    n, lines = len(grid_nodes), len(L)
    assert n > 3
    near = coupling(stopped)
    loaded = np.repeat(
        stopped.scratch.bound.numpy()[0, 0, stopped.scratch.cell_slot.numpy()[0, 0, : lines // 2]] > 0.0, 2
    )
    U = np.triu(stopped.scratch.factor.numpy()[0, :n, :n])
    Y = stopped.scratch.cell_Y.numpy()[0, :n, :lines]
    # N^T against differences of evaluations: of like rollers next to nothing compared with what moves the bodies
    free = np.linalg.inv(
        np.linalg.inv(H) - L_n.T @ np.linalg.solve(G, L_n)
    )  # the retained receptance without pressures
    scale = np.abs(L_n @ free @ L.T).max()
    assert np.abs((U.T @ Y - near)[:, loaded]).max() < ROUND_OFF * scale
    # the whole Schur complement from the operators
    width = stopped.compiled.model.pairs.coupled_count.numpy()[0]
    bordered = stopped.scratch.cell_bordered.numpy()[0, 0, :lines, :width]
    columns = stopped.compiled.model.pairs.coupled.numpy()[0, :width]
    held = stopped.scratch.cell_D.numpy()[0, 0, :lines, :lines] + bordered @ H[np.ix_(columns, columns)] @ bordered.T
    whole = K + L @ free @ L.T
    N_t = U.T @ Y + L_n @ free @ L.T
    expected = whole - N_t.T @ np.linalg.solve(G + L_n @ free @ L_n.T, N_t)
    assert np.abs(held - expected).max() < SKEW * np.abs(whole).max()
    K = 0.5 * (whole + whole.T)
    # an energy still; and what each iteration would leave of an error in the tractions without the answer: across the
    # line of centres of like rollers tractions open no gap
    values = np.linalg.eigvalsh(held)
    assert values[0] > 0.0
    left = np.abs(np.linalg.eigvals(np.linalg.solve(K, K - held))).max()
    low, high = (0.1, 1.0) if request.node.callspec.params["stopped"] is on_a_plane else (0.0, 1e-3)
    assert low <= left < high


def test_a_light_carriage_does_not_slow_the_iteration_down(body: wf.ReducedBody) -> None:
    """Tractions along the surface of a wide patch pressed on the carriage: a third of the error was left by each
    iteration, and steps were halved. They act across the line of centres, and the pressures answer to what is left."""
    result = wf.simulate(rolling(body), 12 * STEP, step=STEP, start="equilibrium", progress=False)
    history = result.history
    assert history.status == "completed" and history.counters["rejected_steps"] == 0
    assert history.counters["max_iterations"] <= 6
    pressure = history.contacts["pair"].pressure
    assert pressure.min() >= 0.0
