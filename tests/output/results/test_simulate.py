"""`simulate` and `equilibrium`: what is checked before the run and written after it. The engine is replaced."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError, RunError
from warpffrf.online.history.history import History
from warpffrf.output import simulate as module
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, simulate


class SceneOfHistory:
    """A scene that is empty and has the hash of another one."""

    bodies = joints = contacts = finite_sliding = small_sliding = films = ()

    def __init__(self, digest: str) -> None:
        self.digest = digest

    def content_hash(self) -> str:
        return self.digest


@pytest.fixture
def scene(history: History) -> Any:
    return SceneOfHistory(Result(history).view.content_hash)


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch, history: History) -> list[tuple[Any, ...]]:
    made: list[tuple[Any, ...]] = []

    def run(scene: Any, duration: float, **options: Any) -> History:
        made.append((scene, duration, options))
        return history

    def find_equilibrium(scene: Any, *, device: str, friction: bool, progress: bool) -> History:
        made.append((scene, device, friction))
        return history

    monkeypatch.setattr(module, "run", run)
    monkeypatch.setattr(module, "find_equilibrium", find_equilibrium)
    return made


def test_arguments_reach_the_engine_and_files_are_written(
    calls: list, scene: Any, history: History, tmp_path: Path
) -> None:
    result = simulate(
        scene,
        0.1,
        step=1e-4,
        options=RunOptions(save_every=3),
        results=tmp_path / "r.h5",
        record=tmp_path / "r.rrd",
        progress=False,
    )
    ((given, duration, options),) = calls
    assert given is scene and duration == 0.1
    assert (options["step"], options["save_every"], options["start"], options["progress"]) == (
        1e-4,
        3,
        "initial",
        False,
    )
    assert options["integrator"].rho_inf == 0.8
    assert Result.load(tmp_path / "r.h5").time == pytest.approx(result.time)
    assert (tmp_path / "r.rrd").stat().st_size > 0


def test_files_are_reported_with_their_sizes_and_seconds(
    calls: list, scene: Any, history: History, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    history.notes.append("something was left out")
    with caplog.at_level("INFO", "warpffrf"):
        result = simulate(scene, 0.1, step=1e-4, results=tmp_path / "r.h5", record=tmp_path / "r.rrd", progress=False)
    results, recording = result.written
    assert (results.what, recording.what) == ("results", "recording")
    for file in result.written:
        assert file.size == file.path.stat().st_size and 0.0 < file.seconds < 60.0
        assert str(file) in result.report() and str(file) in caplog.text
    assert "note: something was left out" in caplog.text
    assert f"recording: {len(result.time)} frames, every 1 of {len(result.time)} saved rows" in caplog.text


def test_a_run_that_ended_early_is_written_as_well(calls: list, scene: Any, history: History, tmp_path: Path) -> None:
    history.status, history.message = "interrupted", "stopped by the user; continue with start=result"
    simulate(scene, 0.1, step=1e-4, results=tmp_path / "r.h5", record=tmp_path / "r.rrd")
    loaded = Result.load(tmp_path / "r.h5")
    assert loaded.status == "interrupted" and "continue with start" in loaded.message
    assert (tmp_path / "r.rrd").exists()


def test_with_check_a_run_that_ended_early_raises_with_its_result(
    calls: list, scene: Any, history: History, tmp_path: Path
) -> None:
    assert simulate(scene, 1e-3, step=1e-4, check=True, progress=False).status == "completed"
    history.status, history.message = "not_converged", "reduce step"
    for call in (lambda **o: simulate(scene, 1e-3, step=1e-4, **o), lambda **o: equilibrium(scene, **o)):
        with pytest.raises(RunError, match="^not_converged: reduce step$") as caught:
            call(check=True, results=tmp_path / "run.h5", overwrite=True, progress=False)
        found: Any = caught.value.result
        assert found.time is history.time
        assert Result.load(tmp_path / "run.h5").status == "not_converged"


def test_paths_are_checked_before_the_run(calls: list, scene: Any, tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    for name, file in (("results", "x.h5"), ("record", "x.rrd")):
        with pytest.raises(InputError, match=f"{name}: .* cannot be written"):
            simulate(scene, 0.1, step=1e-4, **{name: blocked / file})  # pyright: ignore[reportArgumentType]
        with pytest.raises(InputError, match=f"{name}: .* cannot be written"):
            equilibrium(scene, **{name: blocked / file})  # pyright: ignore[reportArgumentType]
        for wrong in ("run.csv", "run"):
            with pytest.raises(InputError, match=rf"{name}: .*{wrong}' must end in \.(h5 or \.hdf5|rrd)$"):
                simulate(scene, 0.1, step=1e-4, **{name: tmp_path / wrong})  # pyright: ignore[reportArgumentType]
    assert not calls


def test_steps_are_checked_before_the_run_is_announced(calls: list, scene: Any, caplog: Any) -> None:
    with caplog.at_level("INFO", "warpffrf"):
        with pytest.raises(InputError, match="step must be greater than zero, got -0.0001"):
            simulate(scene, 0.02, step=-1e-4)
        assert not calls and not caplog.text
        simulate(scene, 0.02, step=0.02 / 192)
    assert "0.02 s in steps of 0.000104167 s" in caplog.text


def test_a_result_is_continued_also_from_its_file(calls: list, scene: Any, result: Result, tmp_path: Path) -> None:
    simulate(scene, 0.1, step=1e-4, start=result)
    assert calls[0][2]["start"] is result.history
    loaded = Result.load(result.save(tmp_path / "r.h5"))
    simulate(scene, 0.1, step=1e-4, start=loaded)
    for name, array in result.history.checkpoint.items():
        got = calls[1][2]["start"].checkpoint[name]
        assert got.dtype == array.dtype and np.array_equal(got, array)


def test_another_scenes_result_is_refused(calls: list, result: Result) -> None:
    with pytest.raises(InputError, match="result of another scene"):
        simulate(SceneOfHistory("another"), 0.1, step=1e-4, start=result)  # pyright: ignore[reportArgumentType]
    result.history.checkpoint = {}
    with pytest.raises(InputError, match="no checkpoint"):
        simulate(SceneOfHistory(result.view.content_hash), 0.1, step=1e-4, start=result)  # pyright: ignore[reportArgumentType]
    assert not calls


def test_unknown_words_list_the_known(calls: list, scene: Any) -> None:
    with pytest.raises(InputError, match="start is 'nonsense'; known: '"):
        simulate(scene, 0.1, step=1e-4, start="nonsense")
    with pytest.raises(InputError, match="start is 'equilibriun'; did you mean 'equilibrium'. known: '"):
        simulate(scene, 0.1, step=1e-4, start="equilibriun")
    with pytest.raises(InputError, match="local_modes 'nonsense' does not exist; known: '"):
        RunOptions(local_modes="nonsense")
    assert not calls


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"step_error": -1.0}, "step_error must be greater than zero"),
        ({"energy_tolerance": 0.0}, "energy_tolerance must be greater than zero"),
        ({"energy_tolerance": 1e-5, "integrator": wf.integrators.RungeKutta4()}, "energy_tolerance halves steps"),
        ({"integrator": "hht"}, "integrator must be one of integrators.GeneralizedAlpha"),
        ({"save_every": 0}, "save_every must be a whole number of at least 1"),
        ({"save_every": 2.5}, "save_every must be a whole number"),
        ({"device": 0}, "device must be 'cpu' or 'cuda:0'"),
        ({"project_start": 1}, "project_start must be True or False"),
    ],
)
def test_wrong_options_are_refused_at_construction(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=f"^RunOptions: {said}"):
        RunOptions(**options)


def test_options_are_an_object_and_show_what_was_chosen(calls: list, scene: Any) -> None:
    assert repr(RunOptions(save_every=3, device="cpu")) == "RunOptions(save_every=3, device='cpu')"
    with pytest.raises(InputError, match="^simulate: options must be wf.RunOptions"):
        simulate(scene, 0.1, step=1e-4, options={"save_every": 3})  # pyright: ignore[reportArgumentType]
    assert not calls


@pytest.mark.parametrize(
    ("call", "argument", "said"),
    [
        (simulate, "kind", "a static run is wf.static("),
        (simulate, "local", "it belongs to options=wf.RunOptions(local_modes=...)"),
        (simulate, "save_every", "it belongs to options=wf.RunOptions(save_every=...)"),
        (simulate, "savevery", "it belongs to options=wf.RunOptions(save_every=...)"),
        (simulate, "device", "it belongs to options=wf.RunOptions(device=...)"),
        (simulate, "stages", "it is called 'duration' now"),
        (simulate, "record_every", "write the recording with wf.record(result, path, every=...)"),
        (simulate, "keep_every", "leave it out"),
        (wf.simulate_worlds, "step_error", "it belongs to options=wf.RunOptions(step_error=...)"),
        (wf.study.sweep, "equilibrium", "it is run=wf.equilibrium now"),
        (wf.study.sweep, "client", "it is workers=... now"),
        (wf.study.speed_error, "step", "it is run=functools.partial(wf.simulate, step=...) now"),
    ],
)
def test_arguments_of_before_name_the_new_ones(call: Any, argument: str, said: str) -> None:
    with pytest.raises(TypeError, match=f"there is no argument '{argument}'; {re.escape(said)}"):
        call(None, None, **{argument: None})


def test_equilibrium_is_a_result(calls: list, scene: Any, tmp_path: Path) -> None:
    result = equilibrium(scene, results=tmp_path / "e.h5")
    assert isinstance(result, Result) and calls == [(scene, None, False)]
    assert (tmp_path / "e.h5").exists()
