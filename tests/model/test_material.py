"""Materials: elastic relations and the border."""

import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material


def test_elastic_constants_agree() -> None:
    steel = Material(210e9, 0.3, 7850, name="steel")
    lam, mu = steel.lame
    # E = mu (3 lam + 2 mu)/(lam + mu), nu = lam/(2 (lam + mu))
    assert mu * (3 * lam + 2 * mu) / (lam + mu) == pytest.approx(210e9, rel=1e-14)
    assert lam / (2 * (lam + mu)) == pytest.approx(0.3, rel=1e-14)
    # plane strain: e_y = 0, so s_x = (lam + 2 mu - lam^2/(lam + 2 mu)) e_x with free s_z
    assert steel.plane_strain_modulus == pytest.approx(lam + 2 * mu - lam**2 / (lam + 2 * mu), rel=1e-14)


@pytest.mark.parametrize(
    ("E", "nu", "rho", "named"),
    [
        (0.0, 0.3, 1.0, "youngs_modulus"),
        (-1.0, 0.3, 1.0, "youngs_modulus"),
        (float("nan"), 0.3, 1.0, "youngs_modulus"),
        (1.0, 0.5, 1.0, "poisson_ratio"),
        (1.0, 0.7, 1.0, "poisson_ratio"),
        (1.0, -1.0, 1.0, "poisson_ratio"),
        (1.0, 0.3, 0.0, "density"),
        (1.0, 0.3, -5.0, "density"),
        ("steel", 0.3, 1.0, "youngs_modulus"),
    ],
)
def test_bad_numbers_are_refused_by_name(E, nu, rho, named) -> None:
    with pytest.raises(InputError, match=f"'stuff'.*{named}"):
        Material(E, nu, rho, name="stuff")
