"""How pressures answer to tractions: the condensed operator against NumPy, and what it does to the iteration.

The arrays are those of an engine inside a step: two rollers that roll on each other, the upper one in a light carriage
that the load alone presses down.
"""

from __future__ import annotations

import numpy as np
import pytest
from warpffrf_kernels import control as k

import warpffrf as wf
from warpffrf.online import Engine, Settings
from warpffrf.online.settle import settle

ROUND_OFF = 1e-9  # of the largest entry: a solve with the pressures' matrix, of condition 1e4 and more
SYMMETRIC = 1e-7  # of the same: H of bodies that turn is symmetric to about 1e-9
STEP, OMEGA, LOAD = 5e-4, 10.0, 300e3  # s, rad/s, N


@pytest.fixture(scope="module")
def body() -> wf.ReducedBody:
    mesh = wf.mesh.roller(0.05, 0.015, 0.01, sectors=240, layers=5, axial=2, grading=1.6, order=1)
    return wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=0, tangential=True, cache=False, progress=False,
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


@pytest.fixture(scope="module")
def stopped(body: wf.ReducedBody) -> Engine:
    """After two steps, with one more iteration on the accepted state."""
    engine = Engine(rolling(body), settings=Settings())
    assert settle(engine)
    engine.initial_rates()
    engine.start()
    engine.control(EVERY=1)
    engine.enter(k.DYNAMIC, STEP, target=2)
    engine.replay(8)
    assert engine.word("STATUS")[0] == 0 and engine.word("STEP")[0] == 2
    engine.control(RUN=1, MOVED=1, REASSEMBLE=1, REFRESH=1, RECENTER=0, ITERATION=0, FAILURE=0)
    engine.graph.iterate()
    assert engine.word("CHANGES")[0] == 0 and engine.word("CELLS")[0] > 5
    return engine


def operators(engine: Engine) -> tuple[np.ndarray, ...]:
    """G_c of the active slots, L_n and V_n of these, L and V of the cells' lines, all over the outer columns, and the
    numbers of the active slots."""
    m, x, state = engine.compiled.model, engine.work, engine.state
    slots, lines = int(engine.word("SLOTS")[0]), 2 * int(engine.word("CELLS")[0])
    N, width = m.outer_count, int(m.coupled_count.numpy()[0])
    modes = x.slot_mode.numpy()[0, :slots, 1]
    among = np.flatnonzero(state.active.numpy()[0, 0, modes])
    columns = m.coupled.numpy()[0, :width]

    def spread(L: np.ndarray) -> np.ndarray:
        place = np.zeros((width, N))
        place[np.arange(width), columns] = 1.0
        return L[:, :width] @ place

    V_n = x.V.numpy().reshape(-1, N)[among]
    V = x.cell_V.numpy().reshape(-1, N)[:lines]
    L_n, L = spread(x.L.numpy()[0, among]), spread(x.cell_L.numpy()[0, :lines])
    return x.condensed.numpy()[0][np.ix_(among, among)], L_n, V_n, L, V, among


def test_the_answer_of_the_pressures_is_condensed(stopped: Engine) -> None:
    G_c, L_n, V_n, L, V, among = operators(stopped)
    lines, N = V.shape
    X = np.linalg.solve(G_c, L_n)
    n = int(stopped.work.answer_state.numpy()[0, 0])
    assert n == len(among) > 3
    order = stopped.work.answer_order.numpy()[0, :n]
    np.testing.assert_array_equal(np.sort(order), among)
    held = stopped.work.cell_held.numpy().reshape(-1, N)[:lines]
    expected = V - (V @ X.T) @ V_n
    assert np.abs(held - expected).max() < ROUND_OFF * np.abs(V).max()
    G = stopped.work.cell_G.numpy()[0, :lines, :lines]
    K = stopped.work.cell_K.numpy()[0, :lines, :lines]
    coupling = L @ V_n.T
    schur = G + L @ V.T - coupling @ np.linalg.solve(G_c, coupling.T)
    assert np.abs(K - schur).max() < SYMMETRIC * np.abs(G + L @ V.T).max()
    # an energy still; and what each iteration would leave of an error in the tractions without the answer
    values = np.linalg.eigvalsh(0.5 * (K + K.T))
    assert values[0] > -SYMMETRIC * values[-1]
    left = np.abs(np.linalg.eigvals(np.linalg.solve(G + L @ V.T, G + L @ V.T - K))).max()
    assert 0.1 < left < 1.0


def test_a_light_carriage_does_not_slow_the_iteration_down(body: wf.ReducedBody) -> None:
    """Without the answer of the pressures a third of the error is left by each iteration here, and steps are halved."""
    result = wf.simulate(rolling(body), 12 * STEP, step=STEP, start="equilibrium", progress=False)
    history = result.history
    assert history.status == "completed" and history.counters["rejected_steps"] == 0
    assert history.iterations[1:].max() <= 6
    pressure = history.contacts["pair"].pressure
    assert pressure.min() >= 0.0
