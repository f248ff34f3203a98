"""The engine's solve of cells against a dense reference of its own, on small irregular joints.

Two sheets in one body on grid lines of no order, held at their root, pressed by uneven loads and dragged about by a
force at the tip that turns: cells open and close, stick, slip, and slip in other directions from step to step. The
flexibility of the cells is that of full finite elements. Loads are of some micronewton, so that nothing turns.
"""

from __future__ import annotations

import numpy as np
import pytest

from references.small_sliding.cells import facet_cells
from references.small_sliding.full_model import FullModel, Part
from references.small_sliding.quasi_static import StaticSmallSliding
from references.small_sliding.sheets import ROOT, graded_stack, one_body
from small_sliding_reference import solve_increment, violations
from warpffrf.model import forces, joints, signals
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding.sliding import cells_of
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce
from warpffrf.output.simulate import static

STEEL = Material(210e9, 0.3, 7850.0)
STEPS = 14
SAME = 1e-8  # of the largest force, and of motions: Newton's method ends at 1e-9 of it
LOAD = 1e-5  # N


@pytest.mark.parametrize(("seed", "friction"), [(1, 0.0), (2, 0.15), (3, 0.3), (5, 0.6)])
def test_forces_are_those_of_the_reference(seed: int, friction: float) -> None:
    rng = np.random.default_rng(seed)
    x = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 1.5, 6))]) * 5e-3
    y = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 1.5, 3))]) * 5e-3
    mesh = one_body(graded_stack((x, y, [0.0, 4e-3]), 4e-3, 2))
    middle = 0.4 * x[-1]
    mesh = mesh.select("head", "sheet1_z_max", lambda c: c[:, 0] > middle)
    mesh = mesh.select("foot", "sheet0_z_min", lambda c: c[:, 0] > middle)
    loaded = {"head": -1.0, "foot": 1.0}
    tip = "sheet1_x_max"
    model = FullModel([Part(mesh, STEEL, (ROOT,))])
    names = [("head", 2), ("foot", 2), (tip, 0), (tip, 1), (tip, 2)]
    F = np.stack([model.spread(0, name, np.eye(3)[axis]) for name, axis in names], axis=1)
    body = reduce(
        mesh, STEEL, interfaces={ROOT: "rigid"} | dict.fromkeys([*loaded, tip], "average"), modes=3,
        contact={"lap": Matched("sheet1_z_min", first="sheet0_z_max")}, cache=False, progress=False,
    )  # fmt: skip
    lap = StaticSmallSliding(model, facet_cells(model, (0, "sheet0_z_max"), (0, "sheet1_z_min")), friction)
    turn = np.linspace(0.0, 3.0 * np.pi, STEPS) + rng.uniform(0.0, 1.0)
    press = rng.uniform(0.6, 1.4, STEPS)
    drag = 0.5 * (0.1 + friction) * rng.uniform(0.5, 1.5, STEPS)
    path = LOAD * np.stack([-press, press, drag * np.cos(turn), drag * np.sin(turn), 0.2 * np.sin(2.0 * turn)], axis=1)
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    sheets = scene.add_body(body, name="sheets")
    scene.add(joints.Fixed(scene.ground, sheets[ROOT]))
    scene.add(Contact(sheets["lap"], sliding="small", friction=friction, name="lap"))
    times = np.arange(float(STEPS))
    for i, (name, axis) in enumerate(names):
        scene.add(forces.PointForce(sheets[name], (signals.Table(times, path[:, i]), np.eye(3)[axis])))
    run = static(scene, STEPS - 1.0, step=1.0, progress=False)
    assert run.history.status == "completed", run.history.message
    seen = run.history.small_sliding["lap"]
    area = lap.cells.area
    found = np.concatenate([seen.pressure[:, :, None], -seen.traction], axis=2) * area[None, :, None]
    moved = lap.cells.loads.T @ model.solve(F)
    gap = cells_of(scene.contacts[0]).gap
    states, worst, compared = set(), 0.0, 0
    for i in range(1, STEPS):
        b = (moved @ path[i]).reshape(-1, 3)
        b[:, 0] += gap
        largest = np.abs(found[i]).max()
        states |= set(seen.state[i].tolist())
        if run.history.step_size[i] < 1.0:
            continue  # a load step in parts is several increments
        assert violations(lap.flexibility, b, friction, -seen.slip[i - 1], None, found[i].ravel())["worst"] < SAME
        compared += 1
        exact = solve_increment(lap.flexibility, b, friction, -seen.slip[i - 1])
        worst = max(worst, np.abs(exact.force - found[i].ravel()).max() / largest)
    assert worst < SAME and compared >= STEPS // 2
    if friction > 0.0:
        assert states == {0, 1, 2}
        turned = np.ptp(np.unwrap(np.arctan2(*np.diff(seen.slip, axis=0)[:, -1].T)))
        assert turned > 0.5
