"""Lumped contacts in what is made of a run: files, arrays, report, plots, recordings, and methods that lack them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpffrf.model import laws, surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.integrators import RungeKutta4
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.scene import Scene
from warpffrf.online.stages import Stage
from warpffrf.output.files.fields import LUMPED_FIELDS
from warpffrf.output.options import RunOptions
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate


def roller_on_floor() -> Scene:
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    tread = surfaces.Cylinder(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    roller = scene.add_rigid_body(
        0.1, (1e-5,) * 3, name="roller", position=(0, 0, 0.01), velocity=(0.1, 0, 0), surfaces={"tread": tread}
    )
    law = laws.IsoLamina(0.012, 30)
    scene.add(LumpedContact(roller["tread"], floor, law=law, friction=0.3, name="line"))
    return scene


@pytest.fixture(scope="module")
def result() -> Result:
    return simulate(roller_on_floor(), 4e-3, step=1e-4, progress=False)


def test_history(result: Result) -> None:
    found = result.lumped_contact("line")
    assert result.lumped_contact_names == ["line"]
    assert found.lamina_force.shape == (41, 30)
    np.testing.assert_allclose(found.lamina_force.sum(axis=1), found.normal_force, rtol=1e-12)
    np.testing.assert_allclose(found.force[:, 2], found.normal_force, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.force[:, :2], found.friction_force[:, :2], atol=1e-9)
    touching = found.normal_force > 0.0
    lever = found.place - result.body("roller").position
    np.testing.assert_allclose(found.torque[touching], np.cross(lever, found.force)[touching], atol=1e-12)
    assert found.slip_velocity[touching][0, 0] > 0.09  # it slides before it rolls
    with pytest.raises(InputError, match="'line'"):
        result.lumped_contact("lines")


def test_files_and_arrays(result: Result, tmp_path: Path) -> None:
    again = Result.load(result.save(tmp_path / "run.h5"))
    for field in LUMPED_FIELDS:
        np.testing.assert_array_equal(
            getattr(again.lumped_contact("line"), field.attribute),
            getattr(result.lumped_contact("line"), field.attribute),
        )
    assert again.view.lumped["line"].second.shape.kind == "plane"
    data = result.to_xarray()
    np.testing.assert_array_equal(data["lumped_force"][:, 0], result.lumped_contact("line").force)
    assert data["lumped_lamina_force_line"].shape == (41, 30)


def test_report_plot_and_recording(result: Result, tmp_path: Path) -> None:
    assert "lumped contact 'line': force" in result.report()
    assert len(result.summary().axes) == 2
    for shown in (result, Result.load(result.save(tmp_path / "run.h5"))):
        info = record(shown, tmp_path / "run.rrd", overwrite=True)
        assert info.frames == 41 and info.path.stat().st_size > 10_000


def test_stages_join(result: Result) -> None:
    stages = [Stage("first", 2e-3, 1e-4), Stage("second", 2e-3, 1e-4)]
    joined = simulate(roller_on_floor(), stages, progress=False)
    np.testing.assert_allclose(
        joined.lumped_contact("line").force[-1], result.lumped_contact("line").force[-1], rtol=1e-12
    )


def test_integrators_that_lack_them_say_so() -> None:
    with pytest.raises(InputError, match="lumped_contact 'line': only scenes of free bodies"):
        simulate(roller_on_floor(), 1e-3, step=1e-4, options=RunOptions(integrator=RungeKutta4()), progress=False)


def test_friction_is_noted_where_it_does_not_act() -> None:
    found = simulate(roller_on_floor(), 1e-3, step=1e-4, start="equilibrium", progress=False)
    assert any("friction of 'line' does not act" in note for note in found.history.notes)
