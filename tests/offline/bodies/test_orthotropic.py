"""Orthotropic materials: closed forms of a bar in rotated axes, patch tests, an isotropic material given by nine
constants, a bending beam, refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.offline.fe import assign, fe_matrices

Array = np.ndarray
ROUND_OFF = 1e-9  # relative; of linear systems of a few hundred unknowns
E, NU, G, RHO = (135e9, 10e9, 8e9), (0.3, 0.25, 0.45), (5e9, 4e9, 3.4e9), 1600.0  # a ply of carbon fibres
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
SAME = wf.Material.orthotropic(
    3 * (210e9,), 3 * (0.3,), 3 * (210e9 / 2.6,), 7850, axes=((1.0, 2.0, 0.5), (0.0, 1.0, -1.0))
)  # steel, in any axes
TURN = Rotation.from_rotvec([0.4, -0.7, 0.9]).as_matrix()  # columns: body axes of the material axes
PLY = wf.Material.orthotropic(E, NU, G, RHO, axes=(TURN[:, 0], TURN[:, 1]), name="ply")


def strain_of_stress(sigma: Array) -> Array:
    """Strain (3, 3) in body axes of a stress (3, 3), by the engineering constants."""
    s = TURN.T @ sigma @ TURN
    e = np.zeros((3, 3))
    e[0, 0] = s[0, 0] / E[0] - NU[0] * s[1, 1] / E[0] - NU[1] * s[2, 2] / E[0]
    e[1, 1] = -NU[0] * s[0, 0] / E[0] + s[1, 1] / E[1] - NU[2] * s[2, 2] / E[1]
    e[2, 2] = -NU[1] * s[0, 0] / E[0] - NU[2] * s[1, 1] / E[1] + s[2, 2] / E[2]
    for (i, j), modulus in zip(((0, 1), (0, 2), (1, 2)), G, strict=True):
        e[i, j] = e[j, i] = s[i, j] / (2.0 * modulus)
    return TURN @ e @ TURN.T


def skewed(order: int) -> Any:
    """A bar whose inner nodes are moved."""
    mesh = wf.mesh.box((0.2, 0.02, 0.03), (4, 2, 2), order=order)
    inner = np.setdiff1d(np.arange(len(mesh.points)), mesh.outer_facets().node_set)
    points = mesh.points.copy()
    if order == 1:
        points[inner] += np.random.default_rng(2).uniform(-1.5e-3, 1.5e-3, (len(inner), 3))
    return wf.mesh.Mesh(points, dict(mesh.cells), facet_sets=mesh.facet_sets, name="bar")


@pytest.mark.parametrize("order", [1, 2])
def test_uniaxial_bar_in_rotated_axes(order: int) -> None:
    """Tension along x: all nodes follow the closed form, and with them every nodal force inside vanishes."""
    mesh = skewed(order)
    K, _ = fe_matrices(mesh, assign(mesh, PLY))
    sigma = np.zeros((3, 3))
    sigma[0, 0] = 1e8
    e = strain_of_stress(sigma)
    ply = TURN[0, :]  # direction cosines of x with the material axes; Lekhnitskii's E along any direction
    m2 = ply**2
    along = m2[0] ** 2 / E[0] + m2[1] ** 2 / E[1] + m2[2] ** 2 / E[2]
    along += m2[0] * m2[1] * (1 / G[0] - 2 * NU[0] / E[0]) + m2[0] * m2[2] * (1 / G[1] - 2 * NU[1] / E[0])
    along += m2[1] * m2[2] * (1 / G[2] - 2 * NU[2] / E[1])
    assert e[0, 0] == pytest.approx(1e8 * along, rel=1e-12)
    u = mesh.points @ e.T
    f = (K @ u.ravel()).reshape(-1, 3)
    ends = np.abs(np.abs(mesh.points[:, 0]) - 0.1) < 1e-9
    largest = np.abs(f[ends, 0]).max()
    assert np.abs(f[~ends]).max() < ROUND_OFF * largest and np.abs(f[:, 1:]).max() < ROUND_OFF * largest
    right = mesh.points[:, 0] > 0.1 - 1e-9
    assert f[right, 0].sum() == pytest.approx(1e8 * 0.02 * 0.03, rel=1e-10)
    assert u.ravel() @ K @ u.ravel() == pytest.approx(1e8 * e[0, 0] * 0.2 * 0.02 * 0.03, rel=1e-10)


def same_numbers(a: Any, b: Any, what: str) -> None:
    size = max(np.abs(a).max(initial=0.0), 1e-300)
    assert np.abs(a - b).max(initial=0.0) < 2e-6 * size, what  # single precision of skins and stresses


def test_isotropic_by_nine_constants() -> None:
    """Every product of a reduced body is that of the isotropic material: matrices, modes, stress, stiffening."""
    mesh = wf.mesh.box((0.2, 0.15, 0.002), (5, 4, 1), order=2)
    K, M = fe_matrices(mesh, assign(mesh, STEEL))
    K_same, M_same = fe_matrices(mesh, assign(mesh, SAME))
    assert abs(K - K_same).max() < 1e-13 * abs(K).max() and abs(M - M_same).max() == 0.0
    points = {"inside": [[0.03, 0.01, 0.0004]], "skin": "skin"}
    bodies = [
        wf.reduce(
            mesh, material, interfaces={"x_min": "rigid", "x_max": "average"}, modes=5, stress=points, cache=False,
            progress=False, options=wf.ReductionOptions(stiffening="membrane"),
        )
        for material in (STEEL, SAME)
    ]  # fmt: skip
    a, b = bodies
    assert np.allclose(a.frequencies, b.frequencies, rtol=1e-8)
    modes = [body.interfaces["x_max"].modes for body in bodies]
    assert np.allclose(np.abs(modes[0]), np.abs(modes[1]), rtol=1e-6, atol=1e-6 * np.abs(modes[0]).max())
    sign = np.sign(np.sum(modes[0] * modes[1], axis=1))
    for name, field in a.stress.items():
        same_numbers(field.modes, sign[:, None, None] * b.stress[name].modes, name)
    terms: Any = [body.inertia_terms for body in bodies]
    first, second = (one.stiffening for one in terms)
    both = np.outer(sign, sign)[: first.modes, : first.modes]
    same_numbers(first.centrifugal, both * second.centrifugal, "centrifugal")
    same_numbers(first.interfaces["x_max"], both * second.interfaces["x_max"], "interfaces")
    energy = [np.einsum("rij,rkl->ijkl", s.membrane, s.membrane) for s in (first, second)]  # of any basis of forms
    assert np.abs(np.abs(energy[0]) - np.abs(energy[1])).max() < 1e-4 * np.abs(energy[0]).max()


def test_stress_of_the_bar() -> None:
    """A body of one patch of strain: recovered stress from the displacement of a uniform state."""
    from warpffrf.offline.stress.operator import Slots, nodal_stress

    mesh = skewed(1)
    sigma = np.array([[5.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, -1.0]]) * 1e7
    u = mesh.points @ strain_of_stress(sigma).T
    slots = Slots(np.arange(len(mesh.points)), np.zeros(len(mesh.points), dtype=np.int64))
    found = (nodal_stress(mesh.points, mesh.cells, assign(mesh, PLY), slots) @ u.ravel()).reshape(-1, 6)
    wanted = sigma[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    assert np.abs(found - wanted).max() < ROUND_OFF * np.abs(wanted).max()


@pytest.mark.parametrize("across", [0, 1])
def test_first_frequency_of_a_beam(across: int) -> None:
    """A free slender beam with its fibres along and across it: Timoshenko's first bending frequency."""
    length, height = 0.4, 0.01
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) if not across else ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    ply = wf.Material.orthotropic(E, NU, G, RHO, axes=axes)
    mesh = wf.mesh.box((length, 0.014, height), (40, 1, 1), order=2)
    body = wf.reduce(mesh, ply, modes=2, cache=False, progress=False)
    modulus, shear = E[across], G[1] if not across else G[2]
    beta, I_by_A = 4.730040744862704 / length, height**2 / 12.0
    f = beta**2 * np.sqrt(modulus * I_by_A / RHO) / (2.0 * np.pi)
    # to first order in both: rotary inertia by int phi_x^2 = 49.48/L^2, shear by int phi_xxx^2 = 12.30 beta^4/L^2
    f /= np.sqrt(1.0 + I_by_A / length**2 * (49.48 + 12.30 * modulus / (5.0 / 6.0 * shear)))
    assert body.frequencies[0] == pytest.approx(f, rel=3e-3)


def test_body_goes_through_its_file(tmp_path: Path) -> None:
    mesh = wf.mesh.box((0.2, 0.02, 0.01), (6, 1, 1), order=2)
    body = wf.reduce(mesh, PLY, modes=3, cache=False, progress=False)
    assert wf.ReducedBody.load(body.save(tmp_path / "bar.h5")).content_hash() == body.content_hash()
    other = wf.Material.orthotropic(E, NU, (5e9, 4e9, 3.5e9), RHO, axes=(TURN[:, 0], TURN[:, 1]))
    assert wf.reduce(mesh, other, modes=3, cache=False, progress=False).frequencies[0] != body.frequencies[0]


def test_two_materials_and_the_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells of both kinds; the key of the cache depends on constants and axes, not on the name."""
    from warpffrf.offline.settings import _numbers

    box = wf.mesh.box((0.2, 0.02, 0.01), (6, 1, 1), order=1)
    sets = {"left": np.arange(3), "right": np.arange(3, 6)}
    mesh = wf.mesh.Mesh(box.points, dict(box.cells), facet_sets=box.facet_sets, cell_sets=sets)
    mixed = wf.reduce(mesh, {"left": STEEL, "right": SAME}, modes=3, cache=False, progress=False)
    whole = wf.reduce(mesh, STEEL, modes=3, cache=False, progress=False)
    assert np.allclose(mixed.frequencies, whole.frequencies, rtol=1e-8)
    assert mesh.report({"left": STEEL, "right": PLY}).mass == pytest.approx(0.5 * 4e-5 * (7850 + RHO))
    again = wf.Material.orthotropic(E, NU, G, RHO, axes=(TURN[:, 0], TURN[:, 1]), name="other name")
    turned = wf.Material.orthotropic(E, NU, G, RHO, name="ply")
    assert _numbers(again) == _numbers(PLY) != _numbers(turned)


def test_periodic_bodies_take_the_general_path() -> None:
    roller = wf.mesh.roller(0.05, 0.015, 0.02, sectors=16, layers=2, axial=2, order=1)
    body = wf.reduce(roller, PLY, modes=2, cache=False, progress=False)
    assert body.report["path"].startswith("general") and "orthotropic" in str(body.report)


def test_contact_surfaces_are_refused_by_name() -> None:
    mesh = wf.mesh.box((0.2, 0.02, 0.01), (6, 1, 1), order=1)
    with pytest.raises(InputError, match="contact 'z_max': 6 cells below it are of the orthotropic material 'ply'"):
        wf.reduce(mesh, PLY, contact={"z_max": wf.surfaces.Plane()}, modes=2, cache=False, progress=False)
    with pytest.raises(InputError, match="material must be a Material"):
        wf.mesh.Shell([[0, 1, 2, 3]], 0.01, PLY)  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"youngs_moduli": (1e9, 1e9)}, "youngs_moduli must have shape"),
        ({"youngs_moduli": (1e9, -1e9, 1e9)}, "youngs_moduli must be greater than zero"),
        ({"shear_moduli": (1e9, 0.0, 1e9)}, "shear_moduli must be greater than zero"),
        ({"density": 0.0}, "density"),
        ({"poisson_ratios": (4.0, 0.25, 0.45)}, r"\|nu_12\| < 3.674, "),
        ({"poisson_ratios": (0.3, 0.25, 1.2)}, "energy of some strain"),
        ({"youngs_moduli": (1e9, 1e9, 1e9), "poisson_ratios": (0.5, 0.5, 0.5)}, "energy of some strain"),
        ({"axes": ((1, 0, 0), (2, 0, 0))}, "are parallel"),
        ({"axes": ((1, 0, 0), (0, 0, 0))}, r"axes\[1\]"),
        ({"axes": ((1, 0, 0),)}, "axes are two directions"),
        ({"youngs_moduli": (float("nan"), 1e9, 1e9)}, "youngs_moduli"),
    ],
)
def test_wrong_constants(changed: dict[str, Any], said: str) -> None:
    given = {"youngs_moduli": E, "poisson_ratios": NU, "shear_moduli": G, "density": RHO, "name": "ply"}
    with pytest.raises(InputError, match=said):
        wf.Material.orthotropic(**{**given, **changed})
