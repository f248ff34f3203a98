"""Two runs beside each other: differences in closed form, other times, quaternions of either sign, what is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from synthetic_run import PEAK, make_history

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.online.history.history import SensorHistory
from warpffrf.output.result import Result

ROUND_OFF = 1e-12
PAIR = "lower-upper"


def run_on(body: ReducedBody, time: np.ndarray | None = None, factor: float = 1.0, **options: str) -> Result:
    """The synthetic run with a sensor `factor` times sin t on times of its own and options of its own."""
    history = make_history(body)
    history.options = options
    if time is not None:
        kept = replace(history, time=time, contacts={}, bodies={}, joints={}, energy={})
        kept.step_size = np.diff(time, prepend=time[0])
        kept.iterations = kept.factorisations = np.ones(len(time), dtype=int)
        history = kept
    t = history.time
    values = factor * np.stack([np.sin(t), 0.0 * t, np.cos(t)], axis=1)
    history.sensors = {"tip": SensorHistory("position", "m", "world", ("x", "y", "z"), values)}
    return Result(history)


def test_a_run_is_itself(body: ReducedBody) -> None:
    same = wf.compare(run_on(body), run_on(body))
    assert not same.settings and all(d.relative == 0.0 and d.largest == 0.0 for d in same.differences)
    assert "no settings differ" in same.report()


def test_differences_in_closed_form(body: ReducedBody) -> None:
    a, b = run_on(body, step="0.001"), run_on(body, factor=1.03, step="0.002")
    force = b.history.contacts[PAIR].force
    force[:, 2] *= 1.5
    b.history.contacts[PAIR].pressure *= 2.0
    for motion in b.history.bodies.values():
        motion.rotation = motion.rotation * np.where(np.arange(len(b.time)) % 2, -1.0, 1.0)[:, None]  # q and -q
    found = wf.compare(a, b)
    by_label = {d.label: d for d in found.differences}
    assert by_label["sensor[tip]"].relative == pytest.approx(0.03, rel=1e-10)  # 0.03 with 14 digits behind it
    pressed = by_label[f"contact_force[{PAIR}]"]
    assert pressed.relative == pytest.approx(0.5, rel=ROUND_OFF)
    assert pressed.at == a.time[-1] and pressed.size == pytest.approx(np.abs(a.contact(PAIR).force).max())
    assert pressed.largest == pytest.approx(0.5 * pressed.size, rel=ROUND_OFF)
    assert by_label[f"contact_peak_pressure[{PAIR}]"].relative == pytest.approx(1.0, rel=ROUND_OFF)
    assert by_label["body_rotation[upper]"].largest < ROUND_OFF
    assert found.settings == {"step": ("0.001", "0.002")}
    relative = [d.relative for d in found.differences]
    assert relative == sorted(relative, reverse=True)
    assert not [label for label in by_label if "column" in label or label in ("iterations", "step_size")]
    assert PEAK > 0.0 and "... and" in found.report(3) and len(found.report(None)) > len(found.report(3))


def test_interpolation_is_of_second_order_and_said(body: ReducedBody) -> None:
    """sin and cos between rows h apart: an error of at most h^2/8 in each point of a unit circle."""
    a = run_on(body, np.linspace(0.0, 2.0, 64))
    errors = []
    for rows in (41, 81):
        found = wf.compare(a, run_on(body, np.linspace(0.0, 2.0, rows)))
        (tip,) = [d for d in found.differences if d.label == "sensor[tip]"]
        assert tip.largest <= (2.0 / (rows - 1)) ** 2 / 8.0
        assert any("interpolated linearly" in note for note in found.notes)
        errors.append(tip.relative)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)  # times of A fall on other places between rows


def test_only_common_times_count(body: ReducedBody) -> None:
    a, b = run_on(body, np.linspace(0.0, 2.0, 21)), run_on(body, np.linspace(0.0, 1.0, 11))
    found = wf.compare(a, b)
    assert found.differences[0].largest < ROUND_OFF
    assert any(note.startswith("11 of the 21 rows of A") for note in found.notes)
    assert not any("interpolated" in note for note in found.notes)
    with pytest.raises(InputError, match="no time in common"):
        wf.compare(a, run_on(body, np.linspace(3.0, 4.0, 5)))


def test_round_off_and_what_one_lacks_are_told(body: ReducedBody) -> None:
    a, b = run_on(body), run_on(body)
    b.history.contacts[PAIR].torque[:] = 1e-20  # beside nothing of its quantity: A is zero
    del b.history.energy["potential"]
    b.history.energy["kinetic"][3] = np.nan
    found = wf.compare(a, b)
    (torque,) = [d for d in found.differences if d.label == f"contact_torque[{PAIR}]"]
    assert torque.relative == np.inf and "A is 0" in found.report()
    assert any("only in A, the first energy[potential]" in note for note in found.notes)
    assert any("only one run has a value, the first energy[kinetic]" in note for note in found.notes)
    assert any("zero, or round-off, in both" in note for note in found.notes)


def test_files_are_compared_and_drawn(body: ReducedBody, tmp_path: Path) -> None:
    paths = [run_on(body, factor=f).save(tmp_path / f"{name}.h5") for name, f in (("one", 1.0), ("two", 2.0))]
    found = wf.compare(*paths)
    assert found.names == ("one.h5", "two.h5")
    (tmp_path / "other").mkdir()
    twin = run_on(body).save(tmp_path / "other" / "one.h5")
    assert wf.compare(paths[0], twin).names == (str(paths[0]), str(twin))
    assert wf.compare(twin, twin).names == (f"{twin} (A)", f"{twin} (B)")
    figure = found.figure()
    for axes in figure.axes:
        first, second = axes.get_lines()
        assert np.isfinite(first.get_ydata()).all() and len(second.get_xdata()) == len(found.b.time)
        assert "[" in axes.get_ylabel()
    # the component that differs most of (sin, 0, cos) near t = 0
    assert figure.axes[0].get_title("right").startswith("sensor_z[tip]: relative L2 1.00e+00")
    assert len(found.figure(["sensor[tip]"]).axes) == 1
    assert found.save_figure(tmp_path / "both.png").stat().st_size > 10_000
    with pytest.raises(InputError, match="did you mean 'sensor"):
        found.figure(["sensor[tib]"])
