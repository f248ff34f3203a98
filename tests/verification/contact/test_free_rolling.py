r"""Unlike cylinders that roll freely with hardly any friction: the creepage follows from the pressures alone.

Pressures strain the surfaces by -(1 - 2 nu)(1 + nu) p/E along the plane, so that those of two half-planes in plane
strain part by 2 |beta| p/E*. Where friction is too small to change that, it slips one way where p is above
xi E*/(2 |beta|) and the other way where it is below, and no force is left where half of the load is on either side. Of
Hertz's pressure that is at |x| = t a,

    (2/pi)(asin t + t sqrt(1 - t^2)) = 1/2,      xi = 2 |beta| p0 sqrt(1 - t^2)/E*.

Rows along the axis share the creepage: the half is that of the load of all rows, each with Hertz's pressure of its own.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from references.closed_forms import LineContact, contact_modulus, coupling_ratio
from scenes.rolling_pairs import PAIR, STEEL, WIDTH, Drives, R, pair, roll
from studies.rolling.rolling_bodies import ALUMINIUM, unlike

FRICTION = 1e-4  # of which tractions strain the surfaces by 1e-3 of what pressures do
ROWS_TOLERANCE = 0.01  # relative: 0.5 % of finite bodies at a/R = 0.003, 0.3 % of 11 cells in a half-width
MIDDLE = 0.015  # the creepage is lower than at mid-width by more: the line load there is 2.5 % above the mean


def by_rows(contacts: list[LineContact], lengths: np.ndarray) -> float:
    """Creepage [-] of rows of these lengths [m] together."""
    modulus, beta = contact_modulus(STEEL, ALUMINIUM), abs(coupling_ratio(STEEL, ALUMINIUM))
    loads = np.array([c.load for c in contacts]) * lengths
    peaks = np.array([c.peak_pressure for c in contacts])

    def above(p: float) -> float:
        t = np.sqrt(np.maximum(0.0, 1.0 - (p / peaks) ** 2))
        return float(loads @ (2.0 / np.pi * (np.arcsin(t) + t * np.sqrt(1.0 - t * t))) - 0.5 * loads.sum())

    found: Any = brentq(above, 0.0, float(peaks.max()))
    return 2.0 * beta * found / modulus


@pytest.mark.slow
def test_creepage_is_that_of_the_pressures_of_all_rows() -> None:
    approach, strips = 3e-6, 31
    scene = pair(
        *unlike(4e-3, 2, 2.0 * WIDTH), approach, Drives(free=True, creepage=-4.5e-4), cells=(strips, 5),
        friction=FRICTION,
    )  # fmt: skip
    result = roll(scene, 1.65e-4, strips, 1.0, 6.0, friction=FRICTION).result
    contact: Any = result.contact(PAIR)
    creepage = contact.friction.creepage[:, 0]
    found = -float(creepage[len(creepage) // 2 :].mean())
    lengths = contact.cell_areas[-1] / contact.spacing[-1]
    lines = contact.history.pressure[-1].sum(axis=0) * contact.spacing[-1]
    modulus = contact_modulus(STEEL, ALUMINIUM)
    rows = [LineContact(float(line), 0.5 * R, modulus) for line in lines]
    assert found == pytest.approx(by_rows(rows, lengths), rel=ROWS_TOLERANCE)
    middle = by_rows([LineContact(float(contact.line_load[-1]), 0.5 * R, modulus)], np.ones(1))
    assert found < (1.0 - MIDDLE) * middle
