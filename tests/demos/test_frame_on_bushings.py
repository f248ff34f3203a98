"""The frame on its bushings: statics, closed-form frequencies by symmetry, momentum; its references against others."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from demos import frame_on_bushings as demo
from demos import frame_reference as reference

SMALL = demo.Cells(along=2, across=3, up=1, frames=5)


@pytest.fixture(scope="module")
def scene() -> wf.Scene:
    return demo.build(SMALL, progress=False)


def test_the_mesh_is_the_cage(scene: wf.Scene) -> None:
    (Lx, Ly, Lz), b = demo.SIZE, demo.BAR
    bars = 4 * Lx + 6 * (Ly - 2 * b) + 6 * (Lz - 2 * b)
    assert scene.body("frame").mass == pytest.approx(bars * b**2 * demo.ALUMINIUM.density, rel=1e-12)


def test_the_figures_of_the_demo(scene: wf.Scene) -> None:
    still = wf.equilibrium(scene)
    result = wf.simulate(
        scene, 0.08, step=demo.STEP, start="equilibrium", integrator=wf.GeneralizedAlpha(demo.RHO_INF), progress=False
    )
    assert still.status == result.status == "completed"
    found = demo.checks(SMALL, scene, result, still)
    assert all(check.passed for check in found), [(c.name, c.error) for c in found]


def test_rigid_frequencies_of_a_symmetric_body() -> None:
    """Springs at the corners of a rectangle in the plane of the centre of mass: all six decouple."""
    m, J, (a, b) = 50.0, np.diag([4.0, 9.0, 12.0]), (0.7, 0.4)
    k = (1.5e5, 1.0e5, 2.0e5, 60.0, 50.0, 40.0)
    arms = np.array([[x, y, 0.0] for x in (-a, a) for y in (-b, b)])
    values = [
        4 * k[0] / m, 4 * k[1] / m, 4 * k[2] / m,
        4 * (k[2] * b**2 + k[3]) / 4.0, 4 * (k[2] * a**2 + k[4]) / 9.0, 4 * (k[0] * b**2 + k[1] * a**2 + k[5]) / 12.0,
    ]  # fmt: skip
    found, modes = reference.rigid_modes(m, J, arms, k)
    assert found == pytest.approx(np.sort(np.sqrt(values)) / (2.0 * np.pi), rel=1e-12)
    assert np.count_nonzero(np.abs(modes) > 1e-9) == 6


def test_the_fit_finds_a_frequency_far_below_a_line_of_the_spectrum() -> None:
    t = np.arange(0.0, 0.6, 5e-4)
    for f in (11.23456, 30.7):
        assert reference.fitted_frequency(t, 3e-6 * np.cos(2 * np.pi * f * t + 0.7)) == pytest.approx(f, rel=1e-10)


def test_a_load_of_the_panel_reaches_the_mounts_in_the_full_model(scene: wf.Scene) -> None:
    """Without gravity and with stiff springs, the full model's mean panel displacement is linear in the load."""
    mesh, body = demo.frame_mesh(SMALL), scene.body("frame")
    mounts = {name: body[name].point for name in demo.MOUNTS}
    answers = [
        reference.static_displacement(mesh, demo.ALUMINIUM, mounts, demo.MOUNT_STIFFNESS, np.zeros(3), ("panel", load))
        for load in ((0.0, 0.0, -1.0), (0.0, 0.0, -2.0))
    ]
    assert answers[1] == pytest.approx(2.0 * answers[0], rel=1e-9, abs=1e-18)
    sink = [reference.facet_mean(mesh, name, answers[0])[2] for name in demo.MOUNTS]
    assert -demo.MOUNT_STIFFNESS[2] * np.sum(sink) == pytest.approx(1.0, rel=1e-9)
