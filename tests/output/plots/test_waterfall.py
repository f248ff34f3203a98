"""Waterfalls of sines and run-ups in closed form, compared with an independent short-time Fourier transform; and
refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.signal import ShortTimeFFT
from test_spectrum import vibrating

from warpffrf import cli
from warpffrf.model.errors import InputError
from warpffrf.online.history.history import BodyHistory
from warpffrf.output.result import Result
from warpffrf.output.waterfall import Waterfall, over_speed, waterfall

TIME = np.arange(4000) * 1e-3
SPEED = 5.0 + 2.5 * TIME  # rev/s
TURNS = 5.0 * TIME + 1.25 * TIME**2
SPIN = 2.0 * np.pi * SPEED[:, None] * np.array([0.0, -1.0, 0.0])


def run_up() -> Waterfall:
    """8 orders of a shaft with 2 N, and a natural frequency of 200 Hz with 1 N."""
    values = 2.0 * np.sin(2.0 * np.pi * 8.0 * TURNS) + np.sin(2.0 * np.pi * 200.0 * TIME)
    return waterfall(TIME, values, "force", "N", window=0.25)


def test_it_is_the_short_time_fourier_transform() -> None:
    rng = np.random.default_rng(5)
    values = rng.normal(size=600) + 3.0
    found = waterfall(TIME[:600], values, "x", "N", window=0.08)
    n = np.arange(80)
    hann = np.sin(np.pi * n / 80) ** 2
    transform = ShortTimeFFT(hann, 20, 1e3, fft_mode="onesided2X", scale_to="magnitude", phase_shift=None)

    def centred(part: np.ndarray, axis: int = -1) -> np.ndarray:
        return part - np.sum(hann * part, axis=axis, keepdims=True) / hann.sum()

    spectra = np.abs(transform.stft_detrend(values, centred, p0=2, p1=2 + len(found.time)))  # type: ignore[arg-type]
    assert np.array_equal(found.frequency, transform.f)
    assert found.time + 0.5e-3 == pytest.approx(transform.delta_t * np.arange(2, 2 + len(found.time)))
    assert found.amplitude[:, 1:] == pytest.approx(spectra.T[:, 1:], abs=1e-12)


def test_orders_follow_the_speed_and_natural_frequencies_stay() -> None:
    """In 0.25 s the speed changes by 0.6 rev/s, 8 orders by 5 Hz, a bit more than the resolution of 4 Hz."""
    found = over_speed(run_up(), TIME, SPIN, "shaft")
    assert found.resolution == pytest.approx(4.0) and found.speed is not None
    assert found.speed == pytest.approx(5.0 + 2.5 * found.time, rel=1e-6)  # the mean of a speed that rises evenly
    low = found.frequency < 160.0
    order = found.frequency[low][np.argmax(found.amplitude[:, low], axis=1)]
    assert np.all(np.abs(order - 8.0 * found.speed) < found.resolution)
    (k,) = np.flatnonzero(found.frequency == 200.0)
    assert found.amplitude[:, k] == pytest.approx(1.0, abs=0.01) and "rev/s of 'shaft'" in found.report()


def test_it_is_drawn_over_time_and_over_speed() -> None:
    found = run_up()
    ax = Figure().add_subplot()
    found.draw(ax)
    assert "time [s]" in ax.get_ylabel() and not ax.lines and "Hz" in ax.get_xlabel()
    ax = Figure().add_subplot()
    over_speed(found, TIME, SPIN, "shaft").draw(ax, orders=(8,))
    f, s = np.asarray(ax.lines[0].get_xydata()).T
    assert f == pytest.approx(8.0 * s) and "[rev/s]" in ax.get_ylabel()
    assert 200.0 < ax.get_xlim()[1] < 300.0  # what there is, of 500 Hz
    image = np.asarray(ax.collections[0].get_array())
    assert image.shape[0] == len(found.time) and np.all(np.isfinite(image)) and np.ptp(image) > 1.0


def test_what_makes_no_waterfall_is_said() -> None:
    with pytest.raises(InputError, match="40 saved rows make 2 windows of 32 rows"):
        waterfall(TIME[:40], TIME[:40], "x", "N", window=0.032)
    with pytest.raises(InputError, match="a window of 0.01 s has 10 rows"):
        waterfall(TIME, TIME, "x", "N", window=0.01)
    with pytest.raises(InputError, match="body 'shaft' turns at 5 rev/s throughout"):
        over_speed(run_up(), TIME, np.tile([0.0, 10.0 * np.pi, 0.0], (len(TIME), 1)), "shaft")
    there_and_back = SPIN * np.sin(np.pi * TIME / TIME[-1])[:, None]
    assert "rises and falls" in over_speed(run_up(), TIME, there_and_back, "shaft").notes[-1]


def test_a_result_has_waterfalls(result: Result, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    bodies = result.history.bodies
    run = vibrating(result)
    rows = len(run.time)
    zero, turn = np.zeros((rows, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (rows, 1))
    spin = np.outer(50.0 + np.arange(rows), [0.0, 1.0, 0.0])
    run.history.bodies = {
        name: BodyHistory(zero, turn, zero, spin, np.zeros((rows, old.modal.shape[1]))) for name, old in bodies.items()
    }
    assert run.waterfall("sensor_x[tip]").amplitude.max() == pytest.approx(2e-3, rel=0.2)
    ax = run.plot("waterfall", Figure().add_subplot(), channel="sensor_x[tip]", speed="lower")
    assert "'lower'" in ax.get_ylabel()
    with pytest.raises(InputError, match="'waterfall' needs the history to draw, channel="):
        run.plot("waterfall")
    path, picture = run.save(tmp_path / "run.h5"), tmp_path / "waterfall.png"
    given = ["plot", str(path), "waterfall", "--out", str(picture), "--channel", "sensor_x[tip]", "--speed", "lower"]
    assert cli.main(given) == 0 and picture.stat().st_size > 10_000
    assert cli.main(["plot", str(path), "--list"]) == 0 and "waterfall" in capsys.readouterr().out
