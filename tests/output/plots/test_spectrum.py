"""Spectra and orders of sines in closed form, at even and uneven times and changing speeds; and refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpffrf import cli
from warpffrf.model.errors import InputError
from warpffrf.online.history.history import SensorHistory
from warpffrf.output.result import Result
from warpffrf.output.spectrum import frequency_spectrum, order_spectrum

ROUND_OFF = 1e-12
HANN_SCALLOP = 8.0 / (3.0 * np.pi)  # of a sine half-way between two places


def test_a_sine_has_its_amplitude_at_its_frequency() -> None:
    time = np.arange(1000) * 1e-3
    values = 7.0 + 3.0 * np.sin(2.0 * np.pi * 50.0 * time + 0.4) + 0.5 * np.cos(2.0 * np.pi * 120.0 * time)
    found = frequency_spectrum(time, values, "x", "N")
    assert found.resolution == pytest.approx(1.0, rel=1e-9) and not found.notes
    assert found.peaks(2) == [pytest.approx((50.0, 3.0)), pytest.approx((120.0, 0.5))]
    assert found.amplitude[49] == pytest.approx(1.5) and found.amplitude[200] < ROUND_OFF * 3.0
    half = frequency_spectrum(time, np.sin(2.0 * np.pi * 50.5 * time), "x", "N")
    assert half.amplitude[50] == pytest.approx(HANN_SCALLOP, rel=1e-3)  # the mirror image is 100 places away
    for frequency in (50.3, 50.5, 50.8):  # peaks are interpolated
        found = frequency_spectrum(time, np.sin(2.0 * np.pi * frequency * time), "x", "N")
        assert found.peaks(1)[0] == (pytest.approx(frequency, abs=1e-4), pytest.approx(1.0, rel=1e-3))
    highest = frequency_spectrum(time, np.where(np.arange(1000) % 2, -2.0, 2.0), "x", "N")
    assert highest.amplitude[-1] == pytest.approx(2.0)


def test_an_envelope_has_the_modulation_of_its_band_alone() -> None:
    """A carrier whose amplitude 2 + cos varies, next to a tone outside the band, which is larger."""
    time = np.arange(2000) * 5e-4
    size = 2.0 + np.cos(2.0 * np.pi * 15.0 * time)
    values = size * np.sin(2.0 * np.pi * 300.0 * time) + 50.0 * np.cos(2.0 * np.pi * 40.0 * time)
    found = frequency_spectrum(time, values, "x", "N", (200.0, 400.0))
    assert found.peaks(1) == [pytest.approx((15.0, 1.0))] and found.largest == pytest.approx(3.0)
    assert found.amplitude[20:].max() < ROUND_OFF * 50.0 and found.label == "x, envelope of 200 to 400 Hz"
    for band in ((200.0, 1200.0), (-1.0, 400.0), (300.0, 307.0), (400.0, 200.0)):
        with pytest.raises(InputError, match=r"x: envelope must be a band .* 0 and 1000 Hz.* 8 Hz wide"):
            frequency_spectrum(time, values, "x", "N", band)


def test_uneven_rows_are_said() -> None:
    time = np.sort(np.concatenate([np.linspace(0.0, 1.0, 2001), np.linspace(0.3, 0.4, 100)[1:-1] + 1e-6]))
    found = frequency_spectrum(time, np.sin(2.0 * np.pi * 20.0 * time), "x", "N")
    assert found.peaks(1)[0] == pytest.approx((20.0, 1.0), rel=1e-3)  # (pi f h)^2/2 of linear interpolation
    assert "uneven" in found.notes[0]


def test_orders_stand_still_while_the_speed_changes() -> None:
    """A run-up: 12 orders of a shaft are one line by orders, and smeared over its band of frequencies."""
    time = np.linspace(0.0, 2.0, 8001)
    rate = 2.0 * np.pi * (10.0 + 5.0 * time)  # rad/s, 30 turns
    turns = 10.0 * time + 2.5 * time**2
    spin = -rate[:, None] * np.array([0.0, 0.6, 0.8])
    values = 4.0 * np.sin(2.0 * np.pi * 12.0 * turns)
    found = order_spectrum(time, values, spin, "x", "N", "shaft")
    rows = 1.0 / (12.0 * 20.0 * time[1])  # a period where it turns fastest
    (place, size), *_ = found.peaks(1)
    assert place == pytest.approx(12.0, rel=1e-9) and 1.0 - (2.0 * np.pi / rows) ** 2 / 12.0 < size / 4.0 < 1.0
    assert found.resolution == pytest.approx(1.0 / 30.0, rel=1e-9)
    assert frequency_spectrum(time, values, "x", "N").amplitude.max() < 1.0
    about = order_spectrum(time, values, spin, "x", "N", "shaft", axis=(0.0, 1.0, 0.0))  # 0.6 of the rate
    assert about.peaks(1)[0][0] == pytest.approx(20.0, rel=1e-2)


def test_what_makes_no_spectrum_is_said() -> None:
    time = np.linspace(0.0, 1.0, 101)
    still, back = np.zeros((101, 3)), np.zeros((101, 3))
    back[:, 2] = 100.0
    back[40:50, 2] = -1.0
    with pytest.raises(InputError, match="7 saved rows"):
        frequency_spectrum(time[:7], time[:7], "x", "N")
    with pytest.raises(InputError, match="no value"):
        frequency_spectrum(time, np.where(time > 0.5, np.nan, time), "x", "N")
    with pytest.raises(InputError, match="turns 0 times"):
        order_spectrum(time, time, still, "x", "N", "shaft")
    with pytest.raises(InputError, match="reverses"):
        order_spectrum(time, time, back, "x", "N", "shaft")
    with pytest.raises(InputError, match="resolve no order"):
        order_spectrum(time, time, still + (0.0, 0.0, 2e3), "x", "N", "shaft")
    assert "no peak" in frequency_spectrum(time, 0.0 * time + 1.0, "x", "N").report()


def vibrating(result: Result) -> Result:
    """The synthetic run on 200 rows, 5 periods of a sensor in them."""
    history = result.history
    history.time = np.arange(200) * 1e-3
    history.step_size = history.iterations = history.factorisations = np.ones(200)
    history.bodies, history.joints, history.contacts, history.energy = {}, {}, {}, {}
    wave = 2e-3 * np.sin(2.0 * np.pi * 25.0 * history.time)
    history.sensors = {"tip": SensorHistory("position", "m", "world", ("x",), wave[:, None])}
    return Result(history)


def test_a_result_has_spectra_of_its_histories(result: Result, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    run = vibrating(result)
    found = run.spectrum("sensor_x[tip]")
    assert found.units == "m" and found.peaks(1)[0] == pytest.approx((25.0, 2e-3))
    assert np.array_equal(run.spectrum(run.sensor("tip").values[:, 0]).amplitude, found.amplitude)
    with pytest.raises(InputError, match=r"no history 'sensor_x\[tap\]'; similar names: 'sensor_x\[tip\]'"):
        run.spectrum("sensor_x[tap]")
    path, picture = run.save(tmp_path / "run.h5"), tmp_path / "spectrum.png"
    assert cli.main(["spectrum", str(path), "sensor_x[tip]", "--out", str(picture)]) == 0
    said = capsys.readouterr().out
    assert "25" in said.splitlines()[1].split() and "0.002" in said and picture.stat().st_size > 10_000
    assert cli.main(["spectrum", str(path), "sensor_x[tip]", "--orders-of", "shaft"]) == 1
    assert "no body called 'shaft'" in capsys.readouterr().err
