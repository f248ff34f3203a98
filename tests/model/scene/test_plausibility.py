"""Input that is hardly meant is said, and what is usual is not."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.checks.plausibility import angle_doubts, friction_doubts, gravity_doubts, quaternion_doubts
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh.report import material_warnings, refuse_wrong_units


@pytest.mark.parametrize(
    ("gravity", "words"),
    [
        ((0, 0, 0), ()),
        ((0, 0, -9.81), ()),
        ((0, 0, -1.62), ()),
        ((9.81, 0, 0), ()),
        ((0, 0, -9810), ("9810 m/s2",)),
        ((0, 0, -9.81e-3), ("0.00981 m/s2",)),
        ((0, 0, 9.81), ("upwards", "(0, 0, -9.81)")),
        ((0, 3.0, 9.0), ()),  # a tilted scene
    ],
)
def test_gravity(gravity: tuple, words: tuple[str, ...]) -> None:
    said = " ".join(gravity_doubts(gravity))
    assert all(word in said for word in words) and bool(said) == bool(words)


def test_friction_angles_quaternions() -> None:
    assert not friction_doubts(1.2, "x") and "give 0.3" in friction_doubts(30.0, "x")[0]
    assert not angle_doubts([np.pi, -2 * np.pi], "x") and "np.radians(45)" in angle_doubts([0.0, -45.0], "x")[0]
    assert quaternion_doubts(np.array([1.0, 0, 0, 0]), "x") and not quaternion_doubts(np.array([0, 1.0, 0, 0]), "x")


@pytest.mark.parametrize(
    ("E", "rho", "meant"),
    [
        (210.0, 7850.0, "210 GPa is 2.1e+11 Pa"),
        (70e3, 2700.0, "70000 MPa is 7e+10 Pa"),
        (210e9, 7.85, "7.85 g/cm3 is 7850 kg/m3"),
        (210e3, 7.85e-9, "density 7.85e-09 t/mm3 is 7850 kg/m3"),
    ],
)
def test_slips_of_units_are_named(E: float, rho: float, meant: str) -> None:
    assert meant in material_warnings(Material(E, 0.3, rho))[0]


@pytest.mark.parametrize(
    ("E", "rho", "refused"),
    [
        (210e3, 7850.0, "210000 MPa is 2.1e\\+11 Pa"),
        (210.0, 7850.0, "210 GPa is 2.1e\\+11 Pa"),
        (9e4, 1000.0, "would be 9.49 m/s"),  # no slip that is known
        (210e9, 7.85, "7.85 g/cm3 is 7850 kg/m3; of a body without mass the density is below 0.5 kg/m3"),
        (1e6, 1000.0, ""),  # soft rubber, 32 m/s
        (2e5, 1000.0, ""),  # 14 m/s: a warning
        (1.2e12, 3500.0, ""),  # diamond
        (2.1e13, 7850.0, ""),  # nearly rigid
        (210e9, 0.1, ""),  # nearly massless
        (210e3, 7.85e-9, ""),  # consistent: N, mm, t
    ],
)
def test_wrong_units_are_refused(E: float, rho: float, refused: str) -> None:
    material = Material(E, 0.3, rho)
    if not refused:
        refuse_wrong_units(material)
        refuse_wrong_units(None)
        return
    with pytest.raises(InputError, match=f"reduce: material of 'core': the speed of sound.*{refused}"):
        refuse_wrong_units({"core": material})


def test_reduce_refuses_before_it_computes() -> None:
    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=8, layers=1, axial=1, order=1)
    with pytest.raises(InputError, match="210000 MPa is"):
        wf.reduce(mesh, Material(210e3, 0.3, 7850.0), max_frequency=20e3, cache=False, progress=False)


@pytest.mark.parametrize(("E", "rho"), [(210e9, 7850), (5e6, 1100), (3e9, 1200), (1.05e12, 3510), (0.6e6, 1000)])
def test_materials_that_there_are(E: float, rho: float) -> None:
    """Steel, rubber, a polymer, diamond, soft silicone."""
    assert not material_warnings(Material(E, 0.3, rho))
