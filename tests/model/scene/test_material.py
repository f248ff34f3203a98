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
    ("E", "nu", "rho", "message"),
    [
        (0.0, 0.3, 1.0, "youngs_modulus must be greater than zero, got 0"),
        (-1.0, 0.3, 1.0, "youngs_modulus must be greater than zero, got -1"),
        (float("nan"), 0.3, 1.0, "youngs_modulus must be finite"),
        (1.0, 0.5, 1.0, "poisson_ratio must lie between -1 and 0.5 .excluded., got 0.5; for rubber use 0.49 to 0.499$"),
        (1.0, 0.7, 1.0, "poisson_ratio must lie between -1 and 0.5 .excluded., got 0.7$"),
        (1.0, -1.0, 1.0, "poisson_ratio must lie between -1 and 0.5 .excluded., got -1"),
        (1.0, 0.3, 0.0, "density must be greater than zero, got 0"),
        (1.0, 0.3, -5.0, "density must be greater than zero, got -5"),
        ("steel", 0.3, 1.0, "youngs_modulus must be a number, got 'steel'"),
    ],
)
def test_bad_numbers_are_refused_by_name(E, nu, rho, message) -> None:
    with pytest.raises(InputError, match=f"material 'stuff': {message}"):
        Material(E, nu, rho, name="stuff")


def test_formulation_follows_poissons_ratio_unless_it_is_given() -> None:
    assert [Material(5e6, nu, 1100.0).mixed for nu in (0.3, 0.45, 0.46, 0.49999)] == [False, False, True, True]
    assert Material(5e6, 0.3, 1100.0, formulation="mixed").mixed
    assert not Material(5e6, 0.49, 1100.0, formulation="displacement").mixed
    with pytest.raises(
        InputError, match="material 'stuff': formulation 'hybrid' does not exist; known: 'displacement', 'mixed'"
    ):
        Material(5e6, 0.49, 1100.0, name="stuff", formulation="hybrid")
