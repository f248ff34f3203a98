"""What `reduce` says of contact input that it cannot use."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scenes.flat_settings import reduce_flat
from warpffrf.model import surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.offline.contact.local_mass import check_compliance, eigenvalue_ratio

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)


def reduced(shape: Any, *, axial: int = 2, **options: Any) -> Any:
    mesh = roller(0.05, 0.03, 0.02, sectors=24, axial=axial, layers=1, order=1)
    return reduce_flat(
        mesh,
        STEEL,
        interfaces={"bore": "rigid"},
        contact={"rim": shape},
        modes=0,
        progress=False,
        cache=False,
        **options,
    )


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("axial", [1, 2, 3])
@pytest.mark.parametrize("shape", [surfaces.Groove(), surfaces.CrownedCylinder()])
def test_a_straight_rim_has_no_arc(shape: Any, axial: int) -> None:
    with pytest.raises(InputError, match=r"contact 'rim': surface .* show no (groove|crown); use Cylinder\(\)"):
        reduced(shape, axial=axial)


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_an_arc_that_is_given_may_be_as_flat_as_it_likes() -> None:
    body = reduced(surfaces.Groove(groove_radius=1e25))
    plain = reduced(surfaces.Cylinder())
    np.testing.assert_allclose(
        body.contact_surfaces["rim"].lags, plain.contact_surfaces["rim"].lags, rtol=1e-9, atol=1e-22
    )


@pytest.mark.parametrize("value", ["yes", 1, np.array([1.0, 2.0])])
def test_tangential_is_named(value: Any) -> None:
    with pytest.raises(
        InputError,
        match="ContactGrid: tangential must be True, False or a kind of functions: .* known: 'nodes', 'cells'",
    ):
        reduced(surfaces.Cylinder(), tangential=value)


def test_a_compliance_without_numbers_is_refused() -> None:
    window = np.eye(3)
    assert eigenvalue_ratio(window) == 1.0
    window[1, 2] = np.nan
    assert np.isnan(eigenvalue_ratio(window))
    with pytest.raises(InputError, match="contact 'rim': .* no area on the facets.*give another shape"):
        check_compliance(window, "rim", 1e-3)
