"""Frames that a `Simulation` sends while it is stepped are those of the recording of its result."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rerun as rr
from recordings import columns

import warpffrf as wf
from demos import slider_crank

EVERY, STEPS, FACTOR = 5, 40, 10.0
SINGLE = 1e-6  # of poses and pictures, which are in single precision
OUTPUTS = ["pin", "joint_coordinate[axle]"]


def begun() -> wf.Simulation:
    scene = slider_crank.build(slider_crank.QUICK, progress=False)
    scene.add(wf.sensors.Position(scene.body("piston"), name="pin"))
    return wf.Simulation(scene, step=slider_crank.STEP, outputs=OUTPUTS)


def test_frames_are_those_of_the_recording(tmp_path: Path) -> None:
    """Poses, surfaces of flexible bodies and times of every fifth row, and the declared outputs there; half of the
    steps one by one, half by `run`; none after the end of the stream."""
    sim, stream = begun(), rr.RecordingStream("warpffrf")
    memory = stream.memory_recording()
    sim.stream_to(stream, every=EVERY, deformation_factor=FACTOR)
    for _ in range(STEPS // 2):
        sim.step()
    sim.run(STEPS // 2 * slider_crank.STEP)
    result = sim.result()
    sim.stream_to(None)
    sim.run(10 * slider_crank.STEP)
    stream.flush()
    live = tmp_path / "live.rrd"
    live.write_bytes(memory.drain_as_bytes())
    stream.disconnect()
    made = wf.record(result, tmp_path / "run.rrd", every=EVERY, deformation_factor=FACTOR).path

    def both(entity: str, component: str) -> tuple[list[Any], list[Any]]:
        found, wanted = (columns(file, entity, component) for file in (live, made))
        assert len(found) == len(wanted)
        return found, wanted

    for component in ("Transform3D:translation", "Transform3D:quaternion"):
        for body in ("crank", "rod", "piston"):
            found, wanted = both(f"/world/{body}", component)
            assert len(found) == STEPS // EVERY + 1
            assert found == wanted
    found, wanted = both("/world/rod/surface", "Mesh3D:vertex_positions")
    assert len(found) == STEPS // EVERY + 1 and found == wanted
    both("/world/rod/surface", "Mesh3D:triangle_indices")
    both("/world/crank/solid", "Mesh3D:vertex_positions")
    rows = slice(None, None, EVERY)
    pin = columns(live, r"/plots/outputs/pin", "Scalars:scalars")
    assert np.array(pin) == pytest.approx(result.sensor("pin").values[rows], rel=SINGLE)
    angle = columns(live, r"/plots/outputs/joint_coordinate\[axle\]", "Scalars:scalars")
    assert np.ravel(angle) == pytest.approx(result.joint("axle").coordinate[rows], abs=1e-12)


def test_the_range_of_colours_follows() -> None:
    """It is chosen anew, twice as wide as needed, when a displacement exceeds it, with a new legend."""
    sim, stream = begun(), rr.RecordingStream("warpffrf")
    _ = stream.memory_recording()
    sim.stream_to(stream, every=EVERY)
    assert sim._live is not None
    live, ranges = sim._live[0], []
    for _ in range(STEPS):
        sim.step()
        ranges.append(live._range)
        rod = live.recorder.bodies["rod"].displacement
        assert np.linalg.norm(rod, axis=-1).max() <= live._range
    stream.disconnect()
    grown = np.array(ranges)
    assert np.all(np.diff(grown) >= 0.0) and grown[-1] > 2.0 * grown[EVERY] > 0.0


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"stream": "run.rrd"}, "must be a rerun.RecordingStream"),
        ({"every": 0}, "stream_to: every"),
        ({"deformation_factor": 0.0}, "stream_to: deformation_factor"),
    ],
)
def test_wrong_calls(wrong: dict[str, Any], said: str) -> None:
    stream = rr.RecordingStream("warpffrf")
    arguments: dict[str, Any] = {"stream": stream, **wrong}
    with pytest.raises(wf.InputError, match=said):
        begun().stream_to(**arguments)
    stream.disconnect()
