"""Characteristics on the device: force, slope and potential of the host, at and beyond all kinks."""

# Warp kernels confuse it
# pyright: reportInvalidTypeForm=false, reportIndexIssue=false
from __future__ import annotations

import numpy as np
import pytest
import warp as wp

from warpffrf.model import forces
from warpffrf.model.scene import Scene
from warpffrf.online.compile.scene import CompiledScene, compile_scene, models_of
from warpffrf.online.settings import Settings
from warpffrf_kernels.constraints.characteristics import characteristic
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3

wp.set_module_options(MODULE_OPTIONS)

ROUND_OFF = 1e-13  # of the largest value: the same sums in another order
POINTS = [(-2.0, -5.0), (-0.7, -1.0), (0.3, 0.5), (1.0, 0.4), (3.0, 9.0)]
CURVES = [
    forces.ForcePolynomial([1.0, -0.5, 0.3, 0.2, -0.1, 0.05, 0.02]),
    forces.PowerLaw(2.0, 1.5),
    forces.PowerLaw(2.0, 1.0),
    forces.ForceTable(POINTS),
    forces.ForceTable(POINTS, smooth=True),
    forces.ForceTable([(1.0, 2.0), (2.0, 3.0)]),
]


@wp.kernel
def evaluate(models: wp.array(dtype=Model), n: int, x: wp.array(dtype=real), found: wp.array(dtype=vec3)):
    i = wp.tid()
    found[i] = characteristic(models[0], n, x[i])


@pytest.fixture(scope="module")
def compiled() -> CompiledScene:
    """A body on a spring of each curve, in their order."""
    scene = Scene()
    body = scene.add_rigid_body(1.0, (1, 1, 1), name="body", position=(1.0, 0.0, 0.0))
    for curve in CURVES:
        scene.add(forces.SpringDamper(scene.ground.at((0, 0, 0)), body.at((0, 0, 0)), curve))
    return compile_scene(scene, Settings(), "cpu")


@pytest.mark.parametrize("n", range(len(CURVES)))
def test_device_and_host(compiled: CompiledScene, n: int) -> None:
    curve = CURVES[n]
    breaks = curve.pieces.breaks
    x = np.concatenate([np.linspace(-4.0, 5.0, 201), breaks, np.nextafter(breaks, -9.0), [0.0]])
    found = wp.zeros(len(x), dtype=wp.vec3d)
    wp.launch(evaluate, len(x), [models_of([compiled]), n, wp.array(x, dtype=wp.float64)], [found])
    expected = np.stack([curve.force(x), curve.slope(x), curve.energy(x)], axis=1)
    assert np.all(np.abs(found.numpy() - expected) <= ROUND_OFF * np.abs(expected).max(axis=0))


def test_rows_know_their_characteristics(compiled: CompiledScene) -> None:
    rows = compiled.model.rows
    assert rows.elastic.numpy().tolist() == list(range(len(CURVES)))
    assert np.all(rows.viscous.numpy() == -1) and np.all(rows.stiffness.numpy() == 0.0)
