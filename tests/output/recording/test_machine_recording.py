"""Recordings of machines without contact: rigid bodies, arrows, curves; the same from a live scene and from a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recordings import columns

import warpffrf as wf
from warpffrf.model.reduced.inertia import GeometricStiffness, InertiaTerms
from warpffrf.output.geometry.scene_view import Anchor, BodyView
from warpffrf.output.recording.contact_scene import machine_series, plot_kinds
from warpffrf.output.recording.recorder import record

STEPS = 20
SINGLE = 1e-6  # relative: recordings are single precision


@pytest.fixture(scope="module")
def result() -> wf.Result:
    """A bar that swings about one end, with a spring to the ground, a force and a position sensor."""
    scene = wf.Scene(gravity=(0, 0, -9.81))
    bar = scene.add_rigid_body(2.0, (0.01, 0.2, 0.2), name="bar", position=(0.5, 0, 0))
    scene.add(wf.joints.Revolute(scene.ground, bar.at((-0.5, 0, 0)), axis=(0, 1, 0), name="hinge"))
    scene.add(wf.forces.SpringDamper(scene.ground.at((0.5, 0, 1.0)), bar.at((0.5, 0, 0)), 50.0, name="spring"))
    scene.add(wf.forces.PointForce(bar.at((0.2, 0, 0)), (0, 0, -3.0), name="weight"))
    scene.add(wf.sensors.Position(bar.at((0.5, 0, 0)), name="end"))
    return wf.simulate(scene, STEPS * 1e-3, step=1e-3, progress=False)


def test_an_anchor_follows_the_motion_of_its_interface(body: Any) -> None:
    def view(reduced: Any, *, stiffening: bool = False) -> BodyView:
        return BodyView("lower", reduced, 1.0, np.zeros(3), stiffening=stiffening)

    reduced = body
    interface = reduced.interfaces["bore"]
    interface.modes[0] = [1.0, 0.0, 0.0, 0.0, 0.0, 2.0]
    anchor = Anchor("joint", "axle", "lower", "bore", interface.point + [0.0, 0.5, 0.0], True)
    # translation q along x and rotation 2 q about z, which moves the point at y = 0.5 by -2 q 0.5 along x
    assert anchor.displacement(view(reduced), np.array([0.3, 0.0])) == pytest.approx([0.3 - 0.3, 0.0, 0.0])
    # where loads stiffen the body it comes back along x by q K q/2 besides
    K = np.zeros((6, 1, 1))
    K[0] = 4.0
    terms = InertiaTerms(np.zeros((1, 3, 3)), np.zeros((1, 1, 3, 3)), np.zeros((1, 1, 3)),
                         GeometricStiffness(K, {"bore": K}))  # fmt: skip
    bent = view(replace(reduced, inertia_terms=terms), stiffening=True)
    assert anchor.displacement(bent, np.array([0.1, 0.0])) == pytest.approx([-0.5 * 4.0 * 0.1**2, 0.0, 0.0])
    interface.modes[0] = 0.0
    assert not np.any(anchor.displacement(view(None), np.zeros(0)))
    again = Anchor.of(anchor.describe())
    assert again.describe() == anchor.describe()


def test_arrows_stand_where_the_forces_act(result: wf.Result, tmp_path: Path) -> None:
    info = record(result, tmp_path / "run.rrd")
    place = np.array(columns(info.path, "/world/force_arrows/spring/place", "Points3D:positions"))[:, 0]
    assert place == pytest.approx(result.sensor("end").values, rel=SINGLE, abs=SINGLE)
    hinge = np.array(columns(info.path, "/world/joint_arrows/hinge/place", "Points3D:positions"))[:, 0]
    assert hinge == pytest.approx(0.0, abs=1e-9)
    vectors = np.array(columns(info.path, "/world/joint_arrows/hinge/force", "Arrows3D:vectors"))[:, 0]
    force = result.joint("hinge").force
    scale = np.linalg.norm(vectors, axis=1) / np.linalg.norm(force, axis=1)
    assert scale == pytest.approx(scale[0], rel=1e-5)
    assert vectors == pytest.approx(scale[0] * force, rel=1e-5, abs=1e-5 * scale[0] * np.abs(force).max())
    # a body without surfaces: a ball at its centre of mass, and rods to the hinge and to the other forces
    points = np.array(columns(info.path, "/world/bar/solid", "Mesh3D:vertex_positions")[0])
    assert [points[:, 0].min(), points[:, 0].max()] == pytest.approx([-0.5, 0.5], rel=SINGLE)
    assert np.abs(points[:, 1:]).max() < 0.05


def test_a_results_file_gives_the_same_recording(result: wf.Result, tmp_path: Path) -> None:
    loaded = wf.Result.load(result.save(tmp_path / "run.h5"))
    assert [a.describe() for a in loaded.view.anchors] == [a.describe() for a in result.view.anchors]
    assert loaded.view.bodies["bar"].inertia == pytest.approx(np.diag([0.01, 0.2, 0.2]))
    paths = [record(r, tmp_path / f"{n}.rrd").path for n, r in enumerate((result, loaded))]
    for name in ("spring", "weight"):
        vectors = [columns(p, f"/world/force_arrows/{name}/force", "Arrows3D:vectors") for p in paths]
        assert vectors[0] == vectors[1] and len(vectors[0]) == STEPS + 1


def test_curves_are_those_of_the_result(result: wf.Result, tmp_path: Path) -> None:
    info = record(result, tmp_path / "run.rrd")
    got = np.array(columns(info.path, "/plots/joint_force/hinge", "Scalars:scalars")).ravel()
    assert got == pytest.approx(np.linalg.norm(result.joint("hinge").force, axis=1))
    series = {path: values for path, _, values in machine_series(result)}
    assert series["plots", "position", "end", "z"] == pytest.approx(result.sensor("end").values[:, 2])  # from z = 0
    assert series["plots", "energy", "potential"][0] == 0.0
    assert set(plot_kinds(result)) == {"joint_force", "applied_force", "coordinate", "position", "energy"}


def test_rows_with_a_reaction_that_is_not_finite_are_left_out(result: wf.Result, tmp_path: Path) -> None:
    force = result.joint("hinge").force
    kept = force[3].copy()
    force[3] = np.nan
    try:
        info = record(result, tmp_path / "run.rrd")
    finally:
        force[3] = kept
    assert info.skipped_rows == [3]
