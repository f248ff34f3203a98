"""The retained tangent of static steps against differences of the residuals: rows and applied forces that turn and
shift with bodies and modes."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

from warpffrf.model import forces, joints
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online import Engine
from warpffrf_kernels.core import control as k

STEP = 1e6  # s: inertia is nothing compared with
DIFFERENCE = 1e-5  # m, rad; modes move the tip by as much
# of the largest entry: what an interface's rotation vector differs from its turn by, half the rotation of 1e-3 rad
AGREE = 2e-3


@functools.cache
def beam() -> ReducedBody:
    mesh = box((0.02, 0.4, 0.01), (2, 12, 2), order=2)
    return reduce(
        mesh, Material(210e9, 0.3, 7850.0), interfaces={"y_min": "rigid", "y_max": "average"}, modes=6,
        options=ReductionOptions(stiffening=True), progress=False,
    )  # fmt: skip


def chain(kind: str) -> Scene:
    """Two beams in a row, rotated out of line, between the ground and loads of every kind; or the ends of the first one
    tied to each other."""
    scene = Scene(gravity=(0, 0, 0))
    first, second = (
        scene.add_body(beam(), name=name, position=(0.0, y, 0.0), stiffening=True, inertia="constant")
        for name, y in (("first", 0.2), ("second", 0.6))
    )
    scene.add(joints.Fixed(scene.ground, first["y_min"], name="root"))
    axis = (1.0, 0.2, -0.1)
    middle: dict[str, Any] = {
        "fixed": lambda: joints.Fixed(first["y_max"], second["y_min"]),
        "revolute": lambda: joints.Revolute(first["y_max"], second["y_min"], axis=axis),
        "universal": lambda: joints.Universal(first["y_max"], second["y_min"], axis=axis, second_axis=(0.0, 0.45, 0.9)),
        "bushing": lambda: forces.Bushing(first["y_max"], second["y_min"], (1e6, 2e6, 3e6, 2e3, 1e3, 3e3)),
        "rod": lambda: joints.Distance(first["y_max"], second["y_max"]),
        "tie": lambda: joints.Universal(
            first["y_min"], first["y_max"], axis=axis, second_axis=(0.0, 0.45, 0.9), point=(0.03, 0.1, 0.02)
        ),
        "tie rod": lambda: joints.Distance(first["y_max"], first["y_min"]),
        "tie bushing": lambda: forces.Bushing(
            first["y_max"], first["y_min"], (1e6, 2e6, 3e6, 2e3, 1e3, 3e3), point=(0.03, 0.1, 0.02)
        ),
    }
    scene.add(middle[kind]())
    scene.add(forces.PointForce(second["y_max"], (3.0, -50.0, -40.0), name="dead"))
    scene.add(forces.PointForce(second["y_max"], (5.0, 20.0, 30.0), frame="body", name="follower"))
    scene.add(forces.PointTorque(second["y_max"], (1.0, -2.0, 0.5), name="couple"))
    scene.add(
        forces.SpringDamper(scene.ground.at((0.1, 0.9, 0.3)), second["y_max"], 2e4, free_length=0.5, name="spring")
    )
    return scene


def evaluated(engine: Engine, q: np.ndarray, dx: np.ndarray, psi: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """Residuals of the rigid coordinates and the modes."""
    work = engine.scratch
    work.dx.assign(dx[None])
    work.psi.assign(psi[None])
    work.dq.assign((dq + q)[None])
    engine.control(mode=int(k.STATIC), run=1, moved=1, refresh=1, iteration=1)
    engine.graph.evaluate()
    return np.concatenate([work.residual.numpy()[0], work.modal_residual.numpy()[0]])


@pytest.mark.parametrize("kind", ["fixed", "revolute", "universal", "bushing", "rod", "tie", "tie rod", "tie bushing"])
def test_the_tangent_is_that_of_the_residuals(kind: str) -> None:
    scene = chain(kind)
    engine = Engine(scene)
    engine.clock(h=STEP)
    engine.coefficients(beta=1.0, acc=1.0 / STEP**2)
    engine.control(mode=int(k.STATIC))
    m, rng = engine.compiled.model, np.random.default_rng(3)
    B, Q, R = m.bodies.count, m.modes.count, m.rows.count
    assert m.dense.count == Q
    reach = np.abs(m.interfaces.modes.numpy()).max()
    q = 1e-3 / reach * rng.normal(size=Q)  # interfaces move by a millimetre and turn by a thousandth
    dx, psi = 1e-3 * rng.normal(size=(B, 3)), 1e-3 * rng.normal(size=(B, 3))
    engine.state.lam.assign(rng.normal(size=(1, R)) * 1e3)
    evaluated(engine, q, dx, psi, np.zeros(Q))
    engine.graph.assemble()
    size = 6 * B + Q
    tangent = engine.scratch.tangent.numpy()[0][:size, :size].copy()
    inverse = engine.scratch.psi_inverse.numpy()[0].copy()
    found = np.zeros((size, size))
    for i in range(size):
        by = DIFFERENCE if i < 6 * B else DIFFERENCE / reach
        ends = []
        for sign in (1.0, -1.0):
            moved, turned, modes = dx.copy(), psi.copy(), np.zeros(Q)
            body, c = divmod(i, 6)
            if i >= 6 * B:
                modes[i - 6 * B] = sign * by
            elif c < 3:
                moved[body, c] += sign * by
            else:
                turned[body] += inverse[body] @ (sign * by * np.eye(3)[c - 3])
            ends.append(evaluated(engine, q, moved, turned, modes))
        found[:, i] = (ends[0] - ends[1]) / (2.0 * by)
    elastic = np.zeros((size, size))
    elastic[6 * B :, 6 * B :] = np.diag(m.modes.stiffness.numpy()[:Q])
    for rows in (slice(0, 6 * B), slice(6 * B, size)):
        for columns in (slice(0, 6 * B), slice(6 * B, size)):
            geometric = (found - elastic)[rows, columns]
            off = (tangent - found)[rows, columns]
            assert np.abs(off).max() < AGREE * np.abs(geometric).max()
