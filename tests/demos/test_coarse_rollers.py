"""The rollers of 4 mm tetrahedra, pressed: statics, Hertz, and the closed form of the stress below."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from demos import coarse_rollers as demo
from demos import two_rollers as fine
from references.closed_forms import LineContact

# Johnson, section 4.2.1, nu = 0.3: the largest von Mises stress of a line contact, and where; to their digits.
LARGEST, WHERE = 0.558, 0.70


def test_the_curve_finds_the_largest_stress_of_a_line_contact() -> None:
    t = np.linspace(0.1, 2.0, 39)
    value, depth = demo.largest_mises(t, LineContact(0.5 * np.pi, 1.0, 2.0).von_mises(t, 0.3))
    assert value == pytest.approx(LARGEST, abs=1e-3) and depth == pytest.approx(WHERE, abs=1e-2)


def test_the_pressed_pair_carries_the_load_and_is_hertzian() -> None:
    scene = demo.build(progress=False)
    result = wf.equilibrium(scene)
    assert result.status == "completed", result.message
    pair = result.contact(demo.PAIR)
    assert pair.loaded == "cells"
    assert pair.force_magnitude[-1] == pytest.approx(fine.static_force(scene, result, fine.LOAD), rel=demo.BALANCE)
    # in closed form here, at the line load found at mid-width
    E_star, R = 210e9 / (2 * (1 - 0.3**2)), fine.OUTER_RADIUS / 2
    a = np.sqrt(4 * pair.line_load[-1] * R / (np.pi * E_star))
    peak = 2 * pair.line_load[-1] / (np.pi * a)
    assert pair.half_width[-1] == pytest.approx(a, rel=demo.HALF_WIDTH)
    assert pair.mid_peak_pressure[-1] == pytest.approx(peak, rel=demo.PEAK)
    found = demo.largest_mises(demo.DEPTHS, result.stress("lower", "below").von_mises[-1])[0]
    assert found == pytest.approx(LARGEST * peak, rel=demo.MISES)
