"""A gear pair in a recording: whole gears, the frame of the view of their flanks, and pressure there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recordings import columns

import warpffrf as wf
from scenes.gears import FZG, RELIEVED, angle_at, on_shafts, rolling
from warpffrf.output.geometry.places import Pose
from warpffrf.output.recording import recorder as recorder_module
from warpffrf.output.recording.gear_scene import GearScene

SINGLE = 1e-6  # relative: recordings are single precision


def test_gears_in_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scenes: list[GearScene] = []
    monkeypatch.setattr(recorder_module, "GearScene", lambda *a: scenes.append(GearScene(*a)) or scenes[-1])
    result = wf.equilibrium(on_shafts(FZG, angle_at(FZG, 0.0), 100.0), progress=False)
    info = wf.record(result, tmp_path / "run.rrd")
    assert not any("magnified" in note for note in info.notes)  # nothing is deformed
    for name, gear in (("pinion", FZG.gear_1), ("wheel", FZG.gear_2)):
        points = np.array(columns(info.path, f"/world/{name}/surface", "Mesh3D:vertex_positions")[-1])
        assert np.hypot(points[:, 0], points[:, 2]).max() == pytest.approx(0.5 * gear.tip_diameter, rel=SINGLE)
    (frame,) = columns(info.path, "/world/gears/mesh/eye", "Transform3D:translation")
    assert np.ravel(frame) == pytest.approx([0.5 * FZG.working_diameters[0], 0.0, 0.0], abs=1e-8)
    # the patch of the pair that carries: at the pitch point, its relief within what the view shows
    gear = result.gear("mesh")
    (i,) = np.flatnonzero(gear.load[0])
    entity = f"/world/contacts/{gear.contacts[i].replace(' ', chr(92) + ' ')}"
    (origin,) = columns(info.path, entity, "Transform3D:translation")
    assert np.ravel(origin) == pytest.approx(np.ravel(frame), abs=20e-6)
    contact = result.contact(gear.contacts[i])
    assert Pose.of(contact.bodies, "pinion", 0).to_user(np.reshape(origin, (1, 3)))[0, 1] == pytest.approx(0.0)
    (scene,) = scenes
    view = scene.view()
    assert view.name == "Flanks of 'pinion'" and not any("wheel" in entity for entity in view.contents)
    assert sum("relief" in entity for entity in view.contents) == len(gear.contacts)


def test_teeth_that_never_touch(tmp_path: Path) -> None:
    """Their series of friction have no value: no column without rows is written, at which the viewer panics."""
    from rerun.chunk import RrdReader

    scene = rolling(RELIEVED, 0.0, 100.0, 150.0)
    result = wf.simulate(scene, 2e-5, step=1e-5, start="equilibrium", progress=False)
    apart = [name for name in result.contact_names if not np.any(result.contact(name).touching)]
    assert apart and np.all(np.isnan(result.contact(apart[0]).friction.traction_coefficient))
    info = wf.record(result, tmp_path / "run.rrd")
    chunks = [chunk.to_record_batch() for chunk in RrdReader(str(info.path)).stream().filter(content="/plots/**")]
    assert chunks and min(chunk.num_rows for chunk in chunks) > 0
