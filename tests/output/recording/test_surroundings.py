"""What runs leave to the process around them: threads, memory, Warp's log level, a standard error that is closed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
import warp as wp

import warpffrf as wf
from warpffrf.online.warp_start import TESTED_WARP, untested_warp_note
from warpffrf.output.result import Result

RECORDINGS = 10
RUN = """
import sys
import warpffrf as wf
scene = wf.Scene(gravity=(0, 0, -9.81))
scene.add_rigid_body(1.0, (1, 1, 1), name="block")
result = wf.simulate(scene, 0.01, step=1e-3, progress=True, results=sys.argv[1])
if sys.stdout is not None:
    print(result.status, len(result.time))
"""


def falling() -> wf.Scene:
    scene = wf.Scene(gravity=(0, 0, -9.81))
    scene.add_rigid_body(1.0, (1, 1, 1), name="block")
    return scene


def test_recordings_leave_no_threads(result: Result, tmp_path: Path) -> None:
    """rerun has some that it starts once, with the first recording."""
    from warpffrf.output.recording.recorder import record

    record(result, tmp_path / "first.rrd", max_frames=2)
    threads = psutil.Process().num_threads()
    for n in range(RECORDINGS):
        record(result, tmp_path / f"run_{n}.rrd", max_frames=2)
    assert psutil.Process().num_threads() <= threads


def test_a_recording_that_fails_leaves_no_threads(
    result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from warpffrf.output.recording import recorder

    recorder.record(result, tmp_path / "first.rrd", max_frames=2)
    threads = psutil.Process().num_threads()
    monkeypatch.setattr(recorder.Recorder, "_series", lambda self: 1 / 0)
    for n in range(RECORDINGS):
        with pytest.raises(ZeroDivisionError):
            recorder.record(result, tmp_path / f"run_{n}.rrd", max_frames=2)
    assert psutil.Process().num_threads() <= threads


def test_recordings_of_the_user_stay_open(result: Result, tmp_path: Path) -> None:
    import rerun as rr
    from recordings import columns

    from warpffrf.output.recording.recorder import record

    own = rr.RecordingStream("own")
    own.save(str(tmp_path / "own.rrd"))
    record(result, tmp_path / "run.rrd", max_frames=2)
    own.log("after", rr.Scalars([7.0]))
    own.flush()
    own.disconnect()
    assert rr.get_global_data_recording() is None
    assert columns(tmp_path / "own.rrd", "/after", "Scalars:scalars") == [[7.0]]


@pytest.mark.parametrize("level", [wp.LOG_DEBUG, wp.LOG_INFO, wp.LOG_ERROR])
def test_the_log_level_of_warp_is_the_users(
    level: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture
) -> None:
    monkeypatch.setattr(wp.config, "log_level", level)
    wf.simulate(falling(), 2e-3, step=1e-3, progress=False)
    assert wp.config.log_level == level
    if level == wp.LOG_INFO:  # Warp's own, which says what it loads
        assert capfd.readouterr().out == ""


@pytest.mark.parametrize("closed", [(2,), (0, 1, 2)])
def test_a_process_without_standard_error(closed: tuple[int, ...], tmp_path: Path) -> None:
    """As daemons are: closed before the program starts, so that Python has no sys.stderr."""
    shut = " ".join(f"{n}>&-" if n else "<&-" for n in closed)
    file = tmp_path / "run.h5"
    script = tmp_path / "run.py"
    script.write_text(RUN)
    done = subprocess.run(
        ["sh", "-c", f'exec "$0" "$1" "$2" {shut}', sys.executable, str(script), str(file)], env=dict(os.environ)
    )
    assert done.returncode == 0
    assert len(Result.load(file).time) == 11


def test_standard_error_closed_in_the_run(tmp_path: Path) -> None:
    script = tmp_path / "run.py"
    script.write_text("import os\nos.close(2)\n" + RUN)
    done = subprocess.run([sys.executable, str(script), str(tmp_path / "run.h5")], capture_output=True, text=True)
    assert (done.returncode, done.stdout.split()) == (0, ["completed", "11"])


def test_a_newer_warp_is_noted() -> None:
    constraints = (Path(__file__).resolve().parents[3] / "constraints.txt").read_text()
    assert f"warp-lang=={TESTED_WARP}\n" in constraints
    assert untested_warp_note(TESTED_WARP) == untested_warp_note("1.9.5") == []
    for newer in ("1.19.1", "1.20.0", "2.0.0.dev1"):
        assert TESTED_WARP in untested_warp_note(newer)[0]
