"""Reduced energies of large deflections: what they must have in common, and what tells them apart, on coarse cells."""

from __future__ import annotations

import numpy as np
import pytest

from studies.bodies import large_deflections as study
from studies.bodies import reduced_energies as reduced


@pytest.fixture(scope="module")
def arch() -> reduced.Structure:
    return study.arch(8)


@pytest.fixture(scope="module")
def plate() -> reduced.Structure:
    return study.plate(3)


def test_galerkin_is_the_energy_of_the_full_model(arch) -> None:
    modes = arch.modes(3)
    energy = reduced.galerkin(arch, modes, "")
    q = 3e-3 * np.random.default_rng(0).standard_normal(3)
    r = q[energy.i] * q[energy.j]
    V = 0.5 * q @ energy.K2 @ q + q @ energy.K3 @ r + r @ energy.K4 @ r
    assert pytest.approx(arch.body.energy(modes @ q), rel=1e-10) == V
    np.testing.assert_allclose(energy.force(q), modes.T @ arch.body.forces(modes @ q), rtol=1e-8)


@pytest.mark.parametrize("make", ["squares", "free_ends", "slaved", "galerkin", "few_cells"])
def test_tangents_are_slopes_of_forces(arch, make) -> None:
    """Of the load's part too, by central differences: 1e-6."""
    modes = arch.modes(3)
    if make == "free_ends":
        energy: reduced.Energy = reduced.free_ends(arch, 3)
    elif make == "galerkin":
        energy = reduced.galerkin(arch, modes, "")
    elif make == "few_cells":
        energy = reduced.FewCells("", arch.body, modes, np.linspace(0.0, 2.0, len(arch.body.nodes)), arch.load, 0)
    else:
        energy = getattr(reduced, make)(arch, modes)
    rng = np.random.default_rng(1)
    q, v = 2e-3 * rng.standard_normal((2, energy.coordinates))
    h = 1e-4
    slope = (energy.force(q + h * v) - energy.force(q - h * v)) / (2.0 * h)
    np.testing.assert_allclose(energy.tangent(q) @ v, slope, atol=1e-6 * np.abs(slope).max())
    assert energy.load(q) @ v == pytest.approx((energy.way(q + h * v) - energy.way(q - h * v)) / (2.0 * h), rel=1e-8)
    np.testing.assert_allclose(energy.bend, energy.bend.T)


def test_squares_are_never_negative_and_slaved_derivatives_are(arch, plate) -> None:
    for structure in (arch, plate):
        definite = reduced.squares(structure, structure.modes(4)).definite
        assert definite is not None and definite > -1e-12
    definite = reduced.slaved(arch, arch.modes(4)).definite
    assert definite is not None and definite < -1e-2


def test_squares_are_the_manifold_without_their_rest(plate) -> None:
    """Stretching alone, no part of it along a mode: what Galerkin's method has beside the motion along itself."""
    modes = plate.modes(4)
    energy = reduced.squares(plate, modes)
    q = np.array([0.01, -0.004, 0.003, 0.002])
    fields = reduced.Fields(plate.body, modes)
    theta = -plate.solve(fields.pushes(turning=False))
    r = q[fields.i] * q[fields.j]
    E2 = fields.Y2 @ r + fields.strain(theta) @ r
    e = 0.5 * (energy.L @ q) @ q
    assert e @ e == pytest.approx(E2 @ E2, rel=2e-2)  # eigenvalues left out
    assert np.abs(fields.Y1.T @ E2).max() < 1e-9 * np.linalg.norm(fields.Y1, axis=0).max() * np.linalg.norm(E2)


def test_ends_that_move_are_what_an_arch_needs(arch) -> None:
    (own,) = [e for e in study.compared_with(arch, [reduced.free_ends(arch, 6)]).entries]
    (held,) = [e for e in study.compared_with(arch, [reduced.squares(arch, arch.modes(6))]).entries]
    assert abs(own.whole) < 0.005 and held.whole < -0.1


def test_few_weights_are_few_positive_and_near() -> None:
    rng = np.random.default_rng(2)
    G = rng.random((12, 40))
    b = G.sum(axis=1)
    w = reduced.few_weights(G, b, 1e-6)
    assert np.all(w >= 0.0) and np.count_nonzero(w) <= 12
    assert np.linalg.norm(G @ w - b) <= 1e-6 * np.linalg.norm(b)


def test_the_page_has_the_figures() -> None:
    coarse = study.beam(5)
    one = study.compared(coarse)
    text = study.page([one, study.compared(study.arch(6))])
    for entry in one.entries:
        assert f"{entry.whole:+.2%}" in text
    assert max(map(len, (line for line in text.splitlines() if not line.startswith("|")))) <= 120
