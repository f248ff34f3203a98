"""Case C8: two bars collide, by treatment of the local modes; the retained modes ring where nothing damps them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import zeta

from studies.contact.colliding_bars import EXACT, LENGTH, SPEED, STEEL, bar, collide, measured

TIME = IMPULSE = MEAN = 0.02  # promised
RMS = {20: 0.05, 50: 0.01}  # promised
GAINED = 0.01
MOMENTUM = 1e-10


def test_the_exact_impact() -> None:
    """The values of the case."""
    assert EXACT.duration == pytest.approx(385.45e-6, rel=1e-5)
    assert EXACT.stress == pytest.approx(0.5 * 7800.0 * EXACT.wave_speed * SPEED)


def test_a_bar_is_as_soft_as_a_rod() -> None:
    """Pushed at an end in free flight: modes and rest give L/(3 E A), for any number of modes."""
    for modes in (1, 20):
        body = bar(modes)
        face = body.contact_surfaces["right"]
        M = np.kron(face.grid.gram_theta(), face.gram_z)
        pressure = np.ones(2)
        load = M @ pressure  # hat forces
        moved = face.mode_normal.T @ load / (2.0 * np.pi * body.frequencies) ** 2
        area = face.grid.pitch * (face.grid.z[1] - face.grid.z[0])
        force = area  # of the unit pressure nodes
        weak = M @ (face.mode_normal @ moved + face.lags[0] @ load)
        rod = LENGTH / (3.0 * STEEL.youngs_modulus * 0.02**2)
        assert weak.sum() / force == pytest.approx(rod * force, rel=2e-3)  # FACE_COMPLIANCE
    assert 2.0 / np.pi**2 * float(zeta(2.0, 1.0)) == pytest.approx(1.0 / 3.0)


@pytest.mark.parametrize("local", ["quasi_static", "hht", "exponential"])
@pytest.mark.parametrize("phase", [0.0, 0.37, 0.71])
@pytest.mark.parametrize("modes", [20, 50])
def test_st_venant(modes: int, phase: float, local: str) -> None:
    """The default damping of the highest global modes. (Dynamic local modes whose contact force kept its memory gained
    more than twice the energy.)"""
    found = measured(collide(modes, phase=phase, local=local))
    print(found)
    assert found.status == "completed"
    assert abs(found.duration) < TIME
    assert abs(found.impulse) < IMPULSE
    assert abs(found.mean) < MEAN
    assert found.rms < RMS[modes]
    assert found.momentum < MOMENTUM
    assert found.gained < GAINED


@pytest.mark.parametrize("local", ["quasi_static", "hht"])
def test_nothing_damped_rings(local: str) -> None:
    """Negative control: the same bars without modal damping keep their time and impulse, but not their plateau."""
    found = measured(collide(20, damping=0.0, local=local))
    assert abs(found.duration) < TIME
    assert abs(found.impulse) < IMPULSE
    assert found.rms > 2.0 * RMS[20]
    assert found.gained < GAINED
