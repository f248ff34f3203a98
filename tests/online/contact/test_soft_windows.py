"""Windows of pairs with a soft cover, whose patches are wider than any of metals."""

from __future__ import annotations

import pytest

import warpffrf as wf


@pytest.fixture(scope="module")
def cover() -> wf.ReducedBody:
    rubber = wf.Material(youngs_modulus=4e6, poisson_ratio=0.49, density=1200)
    mesh = wf.mesh.roller(0.05, 0.04, 0.1, sectors=180, layers=3, axial=3, order=2)
    return wf.reduce(
        mesh, rubber, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0, cache=False,
        progress=False,
    )  # fmt: skip


def nip(cover: wf.ReducedBody, force: float, **options) -> wf.Scene:
    """A rigid cylinder above the cover, pressed on it by `force` [N]."""
    scene = wf.Scene(gravity=(0, 0, 0))
    roll = scene.add_body(cover, name="roll")
    face = wf.surfaces.Cylinder(radius=0.06, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    plate = scene.add_rigid_body(20, (0.1, 0.1, 0.1), name="plate", position=(0, 0, 0.1101), surfaces={"face": face})
    pair = scene.add(wf.Contact(roll["rim"], plate["face"], name="nip", grid="body_fixed", **options))
    scene.close_gap(pair)
    scene.add(wf.joints.Fixed(scene.ground, roll["bore"]))
    guide = scene.add(wf.joints.Prismatic(scene.ground, plate.at((0, 0, 0)), axis=(0, 0, 1)))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=1.0, damping=1.0, preload=force))
    return scene


def test_a_soft_cover_has_a_window_that_is_wide_enough(cover) -> None:
    """5 N/mm press the nip to 0.21 of the relative radius to either side, as in a window of the whole turn."""
    own, whole = (wf.equilibrium(nip(cover, 500.0, **options)) for options in ({}, {"capacity": 2000}))
    assert own.status == "completed", own.message
    assert own.contact("nip").window < 0.5 * whole.contact("nip").window
    for name in ("half_width", "peak_pressure", "normal_load"):
        assert getattr(own.contact("nip"), name) == pytest.approx(getattr(whole.contact("nip"), name), rel=1e-9)
    assert own.contact("nip").half_width[-1] == pytest.approx(5.25e-3, rel=0.02)  # a nip of 10.5 mm on a finer mesh


def test_a_window_that_is_too_small_is_named(cover) -> None:
    rest = wf.equilibrium(nip(cover, 500.0, capacity=30))
    assert rest.status == "capacity"
    assert "raise capacity" in rest.message and "uphill" not in rest.message
