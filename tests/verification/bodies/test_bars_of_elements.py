"""Two bars of finite elements collide end to end: St Venant's impact through reduced bodies and plane contact surfaces.

The face of a bar is one element wide, so that its contact grid has a single column of nodes, whose neighbours at both
edges are left out: what the faces' motion weighs there decides about the force at once.
"""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms import BarImpact
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Plane
from warpffrf.offline import reduce
from warpffrf.output.simulate import simulate

STEEL = Material(210e9, 0.0, 7800.0)  # without lateral contraction: a rod
LENGTH, SIDE, SPEED = 1.0, 0.02, 0.1  # m, m, m/s
EXACT = BarImpact(STEEL, LENGTH, SIDE**2, SPEED)
WAVES = 20  # longitudinal modes
GAP, STEP = 1e-7, 1e-6  # m, s
PLATEAU = (0.1, 0.9)  # of the contact time
FORCE = 0.01  # of the mean over the plateau
TIME = IMPULSE = 0.02  # less than half a period of the highest mode, 2.5 % of the contact time


def test_st_venant_of_elements() -> None:
    mesh = box((LENGTH, SIDE, SIDE), (100, 1, 1), order=2)
    limit = (WAVES + 0.5) * EXACT.wave_speed / (2.0 * LENGTH)
    faces = {"x_max": Plane(), "x_min": Plane()}
    bar = reduce(mesh, STEEL, contact=faces, max_frequency=limit, cache=False, progress=False)
    assert bar.contact_surfaces["x_max"].grid.columns == 1
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    first = scene.add_body(bar, name="first", velocity=(SPEED, 0.0, 0.0))
    second = scene.add_body(bar, name="second", position=(LENGTH + GAP, 0.0, 0.0))
    scene.add(Contact(first["x_max"], second["x_min"], name="pair"))
    duration = round(1.3 * EXACT.duration / STEP) * STEP
    run = simulate(scene, duration, step=STEP, progress=False)
    force, t = -run.history.contacts["pair"].force[:, 0], run.time
    closed = np.flatnonzero(force > 0.0)
    start, end = t[closed[0]], t[closed[-1]]
    exact = EXACT.stress * SIDE**2
    assert (end - start) / EXACT.duration == pytest.approx(1.0, abs=TIME)
    assert np.sum(np.diff(t) * force[1:]) == pytest.approx(exact * EXACT.duration, rel=IMPULSE)
    among = (t > start + PLATEAU[0] * EXACT.duration) & (t < start + PLATEAU[1] * EXACT.duration)
    assert force[among].mean() == pytest.approx(exact, rel=FORCE)
