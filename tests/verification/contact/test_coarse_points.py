"""Hertz's contacts of solid bodies on coarse meshes: the fastest cases of `coarse_points`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from references.closed_forms import contact_modulus
from studies.contact import coarse_points as cp

APPROACH = 0.01  # against closed forms: the mesh's own error and the spacing of the far field's splines
HALF_WIDTH = 0.016  # strips at the rim count whole: ten in the patch make a line 1.5 % wide
PEAK = 0.01  # eight cells in the patch: 0.3 % of a point, nothing of a line
IMPACT = 0.02  # half-spaces against a whole ball: 0.7 %
TETRAHEDRA, TET4 = 0.002, 0.004  # of the force, of elements nine half-contacts wide; measured 3e-4 and 1e-3
RIPPLE = 5e-4  # of the force on tet10, over half an element, with what the block's own compliance changes by
MISES, DEPTH = 0.01, 0.02
PLANE_STRAIN = replace(cp.STEEL, poisson_ratio=0.0)


@pytest.mark.parametrize(("elements", "order"), [(2, 1), (2, 2), (3, 1), pytest.param(4, 2, marks=pytest.mark.slow)])
def test_solid_roller_between_planes(elements: int, order: int) -> None:
    """C1 and C2 in plane strain, a contact of 0.003 radii."""
    errors = cp.roller_errors(cp.roller(PLANE_STRAIN, elements, order), PLANE_STRAIN)
    assert abs(errors.approach) < APPROACH
    assert abs(errors.half_width) < HALF_WIDTH
    assert abs(errors.peak) < PEAK


@pytest.mark.slow
def test_long_solid_roller() -> None:
    """C1 and C2 at mid-width with nu = 0.3: four linear elements on the radius, and the half-space fading over four."""
    errors = cp.roller_errors(cp.roller(cp.STEEL, 4, 1), cp.STEEL)
    assert abs(errors.approach) < APPROACH
    assert abs(errors.half_width) < HALF_WIDTH
    assert abs(errors.peak) < PEAK


@pytest.mark.parametrize("kind", ["hex27", "tet10", "tet4"])
def test_solid_ball_on_a_plane(kind: str) -> None:
    """C3 with five elements on the radius."""
    errors = cp.ball_errors(cp.ball(cp.STEEL, replace(cp.PLAIN, kind=kind)), cp.LOAD, cp.STEEL)
    assert abs(errors.approach) < APPROACH
    assert abs(errors.half_width) < HALF_WIDTH
    assert abs(errors.peak) < PEAK


def test_ball_strikes_a_half_space() -> None:
    """C7: force, time and approach, and the speed that it leaves with."""
    both = replace(cp.STEEL, youngs_modulus=0.5 * cp.STEEL.youngs_modulus)
    result, exact = cp.struck([cp.ball(both, cp.PLAIN)], contact_modulus(cp.STEEL, cp.STEEL), cp.SPEED)
    assert np.max(np.abs(cp.impact_errors(result, exact))) < IMPACT


@pytest.mark.slow
def test_steel_on_rubber() -> None:
    """Two balls in flight, a modulus 40,000 times the other and nu = 0.49."""
    errors, _ = cp.unlike_balls(cp.STEEL, cp.RUBBER, 0.5 * cp.SPEED)
    assert abs(errors.approach) < APPROACH
    assert abs(errors.half_width) < HALF_WIDTH
    assert abs(errors.peak) < PEAK


@pytest.mark.slow
def test_tetrahedra_of_4_mm_under_a_ball() -> None:
    """Against quadratic ones of half their size, and over half an element."""
    places = [(0.0, 0.0), (1e-3, 0.0), (2e-3, 1e-3)]
    bodies = [cp.block(cp.STEEL, kind, size) for kind, size in (("tet10", 2e-3), ("tet10", 4e-3), ("tet4", 4e-3))]
    reference, coarse, linear = (np.array([cp.ball_on_block(body, place) for place in places]) for body in bodies)
    assert coarse == pytest.approx(reference, rel=TETRAHEDRA)
    assert linear == pytest.approx(reference, rel=TET4)
    assert np.ptp(coarse / reference) < RIPPLE


def test_stress_below_a_point() -> None:
    """The largest von Mises stress and its depth, 0.07 mm below elements of 2 mm."""
    for error, bound in zip(cp.ball_mises(cp.STEEL, cp.PLAIN), (MISES, DEPTH), strict=True):
        assert abs(float(error.rstrip("%"))) < 100.0 * bound


def test_a_patch_at_the_edge_of_its_surface_is_reported() -> None:
    """The surface ends half a spacing inside its facets, and takes half of the patch away."""
    body = cp.ball(cp.STEEL, cp.PLAIN)
    result = cp.weighed(body, cp.LOAD, cp.STEEL, lean=0.5 / cp.PLAIN.elements)
    assert any("the patch reaches the end of ball['patch'] across" in note for note in result.history.notes)


def test_too_few_functions_are_refused() -> None:
    with pytest.raises(cp.InputError, match="1 x 3 functions, from one of which nothing varies"):
        cp.ball(cp.STEEL, cp.BallMesh(3.34, 2, "hex8"))
