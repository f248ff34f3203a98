"""The pressure at the ends of a roller: reduced bodies in the step compared with full finite elements of one
quarter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from references.closed_forms import LineContact, contact_modulus
from references.finite_elements.free_end import LINE_LOAD, STEEL_ROLLER, press_pair, press_roller
from studies.contact.roller_end import LENGTHS, PLACES, figures, pressed

A = LineContact(LINE_LOAD, STEEL_ROLLER.outer_radius, contact_modulus(STEEL_ROLLER.material)).half_width
LOAD = LINE_LOAD * STEEL_ROLLER.width
END = 0.05  # promised at the end, where finite elements have converged
INSIDE = 0.01  # half a half-width inside, and of means, at 4 shape functions in a half-width
MIRROR = 2e-4  # (a/R)^2, by which gaps at points and on the line of centres differ
APPROACH = 5e-3
OVERHANG = 0.006  # m, eight half-widths


def test_an_equal_partner_is_a_plane_of_symmetry() -> None:
    """On its equal every roller deforms as on the rigid plane between them, its free end included; hubs come twice as
    near. Both have the same mesh, and a roller half as wide, 13 half-widths, has its middle too."""
    roller = replace(STEEL_ROLLER, width=0.5 * STEEL_ROLLER.width)
    on_plane = pressed(roller, 0.5 * LOAD, A, 2, 0.5)
    on_equal = pressed(roller, 0.5 * LOAD, A, 2, 0.5, 0.0)
    assert on_equal.approach == pytest.approx(2.0 * on_plane.approach, rel=MIRROR)
    assert np.abs(figures(on_equal, A) - figures(on_plane, A)).max() < MIRROR
    assert on_plane.pressure.min() >= 0.0
    assert on_plane.end < on_plane.along(0.5 * A) < on_plane.along(2.0 * A) < on_plane.middle


@pytest.mark.slow
def test_end_pressure_is_that_of_finite_elements() -> None:
    exact, found = press_roller(STEEL_ROLLER, LOAD, A, 6.0, 0.125), pressed(STEEL_ROLLER, LOAD, A, 4, 0.25)
    errors = figures(found, A) / figures(exact, A) - 1.0
    approach = found.approach / exact.approach - 1.0
    print(f"at {PLACES} a and means over {LENGTHS} a: {errors}, approach {approach:+.2%}")
    assert abs(errors[0]) < END
    assert np.abs(errors[1:]).max() < INSIDE
    assert abs(approach) < APPROACH


@pytest.mark.slow
def test_a_longer_partner_raises_the_end_pressure_as_in_finite_elements() -> None:
    """The corner itself is singular: compared are places inside and means."""
    longer = replace(STEEL_ROLLER, width=STEEL_ROLLER.width + 2.0 * OVERHANG)
    exact = press_pair(STEEL_ROLLER, longer, LOAD, A, 3.0, 0.25)
    found = pressed(STEEL_ROLLER, LOAD, A, 4, 0.25, OVERHANG)
    errors = figures(found, A) / figures(exact, A) - 1.0
    approach = found.approach / exact.approach - 1.0
    print(f"at {PLACES} a and means over {LENGTHS} a: {errors}, approach {approach:+.2%}")
    assert np.abs(errors[1:]).max() < END
    assert abs(approach) < APPROACH
    assert exact.end > exact.middle
    assert found.end > found.middle
    assert found.pressure.min() >= 0.0
