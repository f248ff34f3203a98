"""Sums over modes, and interfaces: the kernels against NumPy."""

# Warp kernels confuse it
# pyright: reportInvalidTypeForm=false, reportAssignmentType=false, reportGeneralTypeIssues=false
from __future__ import annotations

import numpy as np
import pytest
import warp as wp

from studies.speed import against_exudyn as study
from warpffrf.model import joints
from warpffrf.model.scene import Scene
from warpffrf.online import Engine
from warpffrf.online.step.launches import blocks
from warpffrf_kernels.bodies import interfaces
from warpffrf_kernels.core.scalars import dot, weighted

ROUND_OFF = 1e-14  # of the sum of absolute values: machine precision times the terms of a partial sum


@wp.kernel
def both_sums(
    n: int,
    x: wp.array(dtype=wp.float64),
    p: wp.array(dtype=wp.float64),
    y: wp.array(dtype=wp.float64),
    out: wp.array(dtype=wp.float64),
):
    out[0] = dot(n, x, 1, y, 2)
    out[1] = weighted(n, x, 1, p, 3, y, 2)


@pytest.mark.parametrize("n", [0, 1, 2, 15, 16, 17, 31, 32, 50, 1000])
def test_sums_take_every_entry_once(n: int) -> None:
    """Numbers of entries around the block of sixteen, from odd beginnings."""
    random = np.random.default_rng(n)
    x, p, y = random.normal(size=(3, n + 4))
    out = wp.zeros(2, dtype=wp.float64, device="cpu")
    arrays = [wp.array(a, dtype=wp.float64, device="cpu") for a in (x, p, y)]
    wp.launch(both_sums, dim=1, inputs=[n, *arrays], outputs=[out], device="cpu")
    x, p, y = x[1 : 1 + n], p[3 : 3 + n], y[2 : 2 + n]
    for found, terms in zip(out.numpy(), (x * y, x * p * y), strict=True):
        assert found == pytest.approx(terms.sum(), abs=ROUND_OFF * max(np.abs(terms).sum(), 1.0))


@pytest.fixture(scope="module")
def engine() -> Engine:
    """Two bars of different numbers of modes, hinged to each other and to the ground."""
    mesh = study.bar(cells=4)
    scene = Scene()
    one, two = (
        scene.add_body(study.reduced_bar(mesh, modes), name=name, inertia="constant", position=(x, 0.0, 0.0))
        for name, modes, x in (("one", 9, 0.0), ("two", 14, 1.0))
    )
    scene.add(joints.Spherical(scene.ground, one["root"]))
    scene.add(joints.Spherical(scene.ground, two["root"]))
    return Engine(scene)


def test_interfaces_move_as_their_modes_say(engine: Engine) -> None:
    """Phi q; and the mean of Phi q and slope q where loads stiffen the body."""
    x, m, program = engine.scratch, engine.compiled, engine.graph.program
    random = np.random.default_rng(0)
    q = random.normal(size=m.model.modes.count)
    slope = random.normal(size=m.interface_modes.shape)
    x.q1.assign(q[None])
    engine.control(run=1, moved=1)
    parts = [q[m.modal_start[b] : m.modal_start[b + 1]] for b in m.model.interfaces.body.numpy()]
    straight = [m.interface_modes[i, :, : len(p)] @ p for i, p in enumerate(parts)]
    bent = [slope[i, :, : len(p)] @ p for i, p in enumerate(parts)]
    start = m.model.interfaces.stiffening_start.numpy()
    for stiffened, now, expected in (
        (False, m.interface_modes, straight),
        (True, slope, [0.5 * (a + b) for a, b in zip(straight, bent, strict=True)]),
    ):
        x.slope.assign(now.ravel())
        m.model.interfaces.stiffening_start.assign(np.zeros_like(start) if stiffened else start)
        blocks(interfaces.move_interfaces).go(program.arrays, program.sizes, program.device)
        found = x.interface_motion.numpy()[0]
        assert found == pytest.approx(np.array(expected), abs=1e-12 * np.abs(expected).max())
    m.model.interfaces.stiffening_start.assign(start)


@wp.kernel
def load(
    n: int,
    force: wp.vec3d,
    torque: wp.vec3d,
    width: int,
    slope: wp.array(dtype=wp.float64),
    y: wp.array(dtype=wp.float64),
):
    interfaces.add_load(n, wp.float64(-2.0), force, torque, width, slope, 3, y, 1)


@pytest.mark.parametrize("keep", [(1.0, 1.0), (0.0, 1.0), (1.0, 0.0)])
def test_a_load_on_an_interface_is_that_of_its_modes(keep: tuple[float, float]) -> None:
    """y += sign slope^T (f, t), first entries of each line only, components that are zero too."""
    random = np.random.default_rng(2)
    n, width = 11, 13
    slope, y = random.normal(size=3 + 6 * width), random.normal(size=n + 3)
    wrench = random.normal(size=6) * np.repeat(keep, 3)
    moved = wp.array(y, dtype=wp.float64, device="cpu")
    lines = wp.array(slope, dtype=wp.float64, device="cpu")
    wp.launch(load, dim=1, inputs=[n, wrench[:3], wrench[3:], width, lines], outputs=[moved], device="cpu")
    expected = y.copy()
    expected[1 : 1 + n] -= 2.0 * wrench @ slope[3:].reshape(6, width)[:, :n]
    assert moved.numpy() == pytest.approx(expected, abs=1e-13)
