"""The finite element roller on a rigid plane: load, plane strain in the middle, convergence at the end."""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms import LineContact, contact_modulus
from references.finite_elements.free_end import LINE_LOAD, STEEL_ROLLER, EndPressure, press_pair, press_roller
from warpffrf.model.errors import InputError

LINE = LineContact(LINE_LOAD, STEEL_ROLLER.outer_radius, contact_modulus(STEEL_ROLLER.material))
END_CHANGE = 0.02  # between the levels
MIDDLE = 0.03  # of Hertz at 6 cells in the half-width, where the largest hat still feels the edge of the set


def pressed(cells: float, end: float) -> EndPressure:
    return press_roller(STEEL_ROLLER, LINE_LOAD * STEEL_ROLLER.width, LINE.half_width, cells, end)


@pytest.mark.slow
def test_end_pressure_converges_and_the_middle_is_hertz() -> None:
    coarse, fine = pressed(4.0, 0.25), pressed(6.0, 0.25)
    for f in (coarse, fine):
        p = f.pressure
        assert p.min() >= 0.0 and not p[-1].any()
        mean = 0.25 * (p[1:, 1:] + p[1:, :-1] + p[:-1, 1:] + p[:-1, :-1])
        carried = 4.0 * f.radius * np.diff(f.angles) @ mean @ np.diff(f.z)
        assert carried == pytest.approx(LINE_LOAD * STEEL_ROLLER.width, rel=1e-3)  # the nodes' arcs are not quite arcs
        assert np.all(np.diff(p[0]) < 1e-3 * f.middle)  # falls towards the end
    hertz = LineContact(fine.middle_line_load, fine.radius, LINE.modulus)
    print(
        f"middle {fine.middle / hertz.peak_pressure:.4f} of Hertz",
        f"end {coarse.end / coarse.middle:.4f}, {fine.end / fine.middle:.4f} of the middle",
    )
    assert fine.middle == pytest.approx(hertz.peak_pressure, rel=MIDDLE)
    assert fine.end / fine.middle == pytest.approx(coarse.end / coarse.middle, rel=END_CHANGE)
    assert fine.end < fine.middle and fine.end_line_load < 1.0


def test_mean_line_load_is_that_of_a_linear_one() -> None:
    """Line load q0 (1 - z/2) up to z = 1, a mean of 5/8 q0 over the last half; the nodes' arc is a triangle."""
    z = np.array([0.0, 0.4, 1.0])
    p = np.outer([1.0, 0.0], 1.0 - 0.5 * z)
    f = EndPressure(2.0, np.array([0.0, 0.1]), z, p, 0.0, 0)
    assert f.middle_line_load == pytest.approx(0.2)
    assert f.mean_line_load(0.5) == pytest.approx(0.2 * 0.625)


def test_a_partner_that_is_not_longer_is_refused() -> None:
    with pytest.raises(InputError, match="wider"):
        press_pair(STEEL_ROLLER, STEEL_ROLLER, 1e4, LINE.half_width, 4.0, 0.25)
