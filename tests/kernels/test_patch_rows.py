"""Rows of G and J of the cells of a patch against the kernels that displace the same cells, which share no sums with
them: a unit pressure on one cell after another, a unit amplitude of one mode after another."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.online import Engine
from warpffrf_kernels.core import control as k

RADIUS, APPROACH, TILT = 0.05, 20e-6, 2e-4
ROUND_OFF = 1e-12  # of the largest entry: sums of some hundred terms
STEEL = wf.Material(210e9, 0.3, 7800.0)


@pytest.fixture(scope="module")
def engine() -> Engine:
    """Two tilted rollers with a layer between them, rows that do not fill their lines, inside an iteration."""
    roller = wf.reduce(
        wf.mesh.roller(RADIUS, 0.015, 0.02, sectors=24, layers=3, axial=2, order=1), STEEL,
        interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, max_frequency=12e3,
        grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(roller, name="lower")
    turn = (np.sin(0.5 * TILT), 0, 0, np.cos(0.5 * TILT))
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * RADIUS - APPROACH), rotation=turn)
    for body in (lower, upper):
        scene.add(wf.joints.Fixed(scene.ground, body["bore"]))
    law = wf.laws.LinearLayer(3e14)
    scene.add(wf.Contact(lower["rim"], upper["rim"], grid="contact_fixed", cells=(8, 11), law=law))
    engine = Engine(scene)
    engine.control(mode=int(k.STATIC), step=0, sub=0, level=0, target=1)
    engine.clock(user_step=1.0)
    engine.replay(1)
    assert engine.word("status")[0] == 0
    engine.control(run=1, moved=1, reassemble=1, refresh=1, recenter=0, iteration=0, failure=0)
    engine.graph.iterate()
    assert engine.word("failure")[0] == 0 and engine.word("active")[0] > 30
    engine.control(run=1, moved=1)
    return engine


def cells(engine: Engine) -> np.ndarray:
    """Those that have a slot."""
    return engine.scratch.slot_node.numpy()[0, : int(engine.word("slots")[0]), 1].copy()


def test_modes_open_cells(engine: Engine) -> None:
    slots = cells(engine)
    J = engine.scratch.J.numpy().reshape(-1, engine.compiled.model.pairs.most_modes)[: len(slots)]
    kept = engine.scratch.q1.numpy().copy()
    found = []
    for mode in range(kept.shape[1]):
        amplitude = np.zeros_like(kept)
        amplitude[0, mode] = 1.0
        engine.scratch.q1.assign(amplitude)
        engine.graph.program.run(("shift",))
        found.append(-engine.scratch.first_field.numpy()[0, 0, slots])
    engine.scratch.q1.assign(kept)
    assert np.allclose(J, np.transpose(found), rtol=0.0, atol=ROUND_OFF * np.abs(J).max())


def test_pressures_open_cells(engine: Engine) -> None:
    slots, scratch = cells(engine), engine.scratch
    G = scratch.G.numpy()[0, : len(slots), : len(slots)]
    J = scratch.J.numpy().reshape(-1, engine.compiled.model.pairs.most_modes)[: len(slots)]
    pressure, active = engine.state.pressure.numpy().copy(), engine.state.active.numpy().copy()
    grid_nodes = active.shape[-1]
    local = []
    for m in slots:
        unit, on = np.zeros_like(pressure), np.zeros_like(active)
        unit[0, 0, m], on[0, 0, m] = 1.0, 1
        engine.state.pressure.assign(unit)
        engine.state.active.assign(on)
        engine.graph.program.run(("displace",))
        local.append(scratch.first_local.numpy()[:grid_nodes][slots])
    engine.state.pressure.assign(pressure)
    engine.state.active.assign(active)
    expected = np.transpose(local) + (J * scratch.receptance.numpy()[0]) @ J.T
    assert np.allclose(G, expected, rtol=0.0, atol=ROUND_OFF * np.abs(G).max())
    assert np.array_equal(G, G.T)
