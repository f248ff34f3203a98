"""A crowned roller tilted on a plane, then rotated: where the patch is, and what holds the tilt."""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms import contact_modulus
from references.closed_forms.elliptic import EllipticContact
from scenes import tilted_roller as tilted
from scenes.tilted_roller import CROWN, GUIDE, LOAD, PAIR, RADIUS, STEEL, STEP, TILT, TILTING, TILTS, TURNING, WAITING

HERTZ = EllipticContact(LOAD, RADIUS, CROWN, contact_modulus(STEEL))
SHIFT = CROWN * float(np.sin(TILT))  # m
BALANCE = 1e-6  # of the load at rest: what the tilted cradle still moves
SHAKES = 2e-3  # of the load while it rotates: cells of the contact grid pass, and the carriage has inertia
PLACE = 0.01  # of the shift: the roller tilts elastically under the torque
TORQUE = 0.01  # of P (Rc - R) sin(phi)
AXES, PEAK = 0.02, 0.02  # of half-axes and peak pressure: four nodes around and six along in a half-axis
ROUND = 0.01  # of the approach, by which the height may vary while the roller rotates: cells of the contact grid pass
SMALL = tilted.Size(sectors=600, layers=7, axial=8)


@pytest.mark.slow
def test_the_patch_goes_along_the_crown_and_the_cradle_holds_the_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    """A crown of 2 m tilted by 0.5 mrad: by 1 mm; the force goes through the centre of the crown's arc."""
    monkeypatch.setattr(tilted, "TURNING", STEP)
    result = tilted.run(tilted.build(SMALL, progress=False), progress=False)
    assert result.status == "completed", result.message
    pair, i = result.contact(PAIR), -2
    assert pair.history.pressure.min() >= 0.0
    assert pair.force[i, 2] == pytest.approx(1000.0, rel=BALANCE)
    assert pair.center_of_pressure[0, 1] == pytest.approx(0.0, abs=1e-9)
    shift = float(pair.center_of_pressure[i, 1])
    assert shift == pytest.approx(2.0 * np.sin(0.5e-3), rel=PLACE)
    torque = float(abs(result.joint(TILTS).torque[i, 0]))
    assert torque == pytest.approx(1000.0 * (2.0 - 0.01) / 2.0 * shift, rel=1e-3)
    a, b = HERTZ.half_axes
    assert pair.half_widths[i] == pytest.approx((a, b), rel=0.05)  # two nodes across, four along in a half-axis


@pytest.mark.slow
@pytest.mark.parametrize("size", [tilted.QUICK, tilted.FULL])
def test_level_tilted_and_rotating(size: tilted.Size) -> None:
    result = tilted.run(tilted.build(size, progress=False), progress=False)
    pair, t = result.contact(PAIR), result.time
    i = int(np.flatnonzero(t <= TILTING + WAITING + 0.5 * STEP)[-1])
    for row, shift, balance in ((0, 0.0, BALANCE), (i, SHIFT, BALANCE), (len(t) - 1, SHIFT, SHAKES)):
        assert pair.force[row, 2] == pytest.approx(LOAD, rel=balance)
        assert pair.center_of_pressure[row, 1] == pytest.approx(shift, abs=PLACE * SHIFT)
        assert pair.half_widths[row] == pytest.approx(HERTZ.half_axes, rel=AXES)
        assert pair.peak_pressure[row] == pytest.approx(HERTZ.peak_pressure, rel=PEAK)
    assert abs(result.joint(TILTS).torque[i, 0]) == pytest.approx(LOAD * (CROWN - RADIUS) * np.sin(TILT), rel=TORQUE)
    assert pair.history.pressure.min() >= 0.0
    rotating = t > TILTING + WAITING + 0.5 * TURNING
    assert np.ptp(result.joint(GUIDE).coordinate[rotating]) < ROUND * HERTZ.approach
