"""The tilted roller on a coarser mesh: where the patch goes, and what holds the tilt."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import tilted_roller as demo
from demos.tilted_roller import CROWN, GUIDE, LOAD, PAIR, RADIUS, STEEL, STEP, TILT, TILTING, TILTS, TURNING, WAITING
from references.closed_forms import contact_modulus
from references.closed_forms.elliptic import EllipticContact

HERTZ = EllipticContact(LOAD, RADIUS, CROWN, contact_modulus(STEEL))
SHIFT = CROWN * float(np.sin(TILT))  # m
BALANCE = 1e-6  # of the load at rest: what the tilted cradle still moves
SHAKES = 2e-3  # of the load while it turns: cells of the contact grid pass, and the carriage has inertia
PLACE = 0.01  # of the shift: the roller gives way under the torque
TORQUE = 0.01  # of P (Rc - R) sin(phi)
AXES, PEAK = 0.02, 0.02  # of half-axes and peak pressure: four nodes around and six along in a half-axis
ROUND = 0.01  # of the approach, by which the height may vary while the roller turns: cells of the contact grid pass


def checks(result: wf.Result) -> list[Check]:
    """The figures of a run: level, tilted, turning."""
    pair, t = result.contact(PAIR), result.time
    tilted = int(np.flatnonzero(t <= TILTING + WAITING + 0.5 * STEP)[-1])
    a, b = HERTZ.half_axes
    found = []
    for label, i, shift, balance in (
        ("level", 0, 0.0, BALANCE), ("tilted", tilted, SHIFT, BALANCE), ("turning", len(t) - 1, SHIFT, SHAKES)
    ):  # fmt: skip
        found += [
            Check(f"{label}: force upwards", float(pair.force[i, 2]), LOAD, "statics", balance, "N"),
            Check(f"{label}: patch along the axis", float(pair.center_of_pressure[i, 1]), shift, "Rc sin(phi)", PLACE,
                  "mm", 1e3, scale=SHIFT),
            Check(f"{label}: half-axis across", float(pair.half_widths[i, 0]), a, "Hertz", AXES, "um", 1e6),
            Check(f"{label}: half-axis along", float(pair.half_widths[i, 1]), b, "Hertz", AXES, "mm", 1e3),
            Check(f"{label}: peak pressure", float(pair.peak_pressure[i]), HERTZ.peak_pressure, "Hertz", PEAK, "MPa",
                  1e-6),
        ]  # fmt: skip
    torque = float(np.abs(result.joint(TILTS).torque[tilted, 0]))
    expected = LOAD * (CROWN - RADIUS) * float(np.sin(TILT))
    lowest = float(pair.history.pressure.min())
    turning = t > TILTING + WAITING + 0.5 * TURNING
    way = result.joint(GUIDE).coordinate[turning]
    return [
        *found,
        Check("torque of the cradle", torque, expected, "P (Rc - R) sin(phi)", TORQUE, "N m"),
        Check("lowest pressure", min(lowest, 0.0), 0.0, "unilateral", 0.0, "Pa", scale=HERTZ.peak_pressure),
        Check("height while turning varies by", float(np.ptp(way)), 0.0, "round roller, over the approach",
              ROUND, "nm", 1e9, scale=HERTZ.approach),
    ]  # fmt: skip


SMALL = demo.Size(sectors=600, layers=7, axial=8)


@pytest.mark.slow
def test_the_patch_goes_along_the_crown_and_the_cradle_holds_the_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    """A crown of 2 m tilted by 0.5 mrad: by 1 mm; the force goes through the centre of the crown's arc."""
    monkeypatch.setattr(demo, "TURNING", demo.STEP)
    result = demo.run(demo.build(SMALL, progress=False), progress=False)
    assert result.status == "completed", result.message
    pair, i = result.contact(demo.PAIR), -2
    assert pair.history.pressure.min() >= 0.0
    assert pair.force[i, 2] == pytest.approx(1000.0, rel=BALANCE)
    assert pair.center_of_pressure[0, 1] == pytest.approx(0.0, abs=1e-9)
    shift = float(pair.center_of_pressure[i, 1])
    assert shift == pytest.approx(2.0 * np.sin(0.5e-3), rel=PLACE)
    torque = float(abs(result.joint(demo.TILTS).torque[i, 0]))
    assert torque == pytest.approx(1000.0 * (2.0 - 0.01) / 2.0 * shift, rel=1e-3)
    a, b = HERTZ.half_axes
    assert pair.half_widths[i] == pytest.approx((a, b), rel=0.05)  # two nodes across, four along in a half-axis


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "tilted_roller")
    assert not missed(checks(result))
