"""Inertia invariants against the kinetic energy of nodal velocities, on both paths, and in the file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from interface_bodies import box, free_body
from offline_bodies import STEEL, reduced

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced import inertia as terms_of
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import InertiaTerms
from warpffrf.offline.bases import basis_options
from warpffrf.offline.bases.build import build_basis
from warpffrf.offline.fe import assemble, assign
from warpffrf.offline.inertia.invariants import covered_modes, inertia_terms, scalar_mass
from warpffrf.offline.products import Limits, mass_properties

SAME = 1e-10  # of the largest entry: both paths' modes carry the round-off of their own factorisations


class Body:
    """A steel block: mass matrix, modes at all nodes, positions about the centre of mass."""

    def __init__(self) -> None:
        mesh = box((2, 3, 4), (0.03, 0.05, 0.08))
        model, system = free_body(mesh, {"low": "rigid", "high": "average"})
        basis = build_basis(basis_options("free_free"), model, system, Limits(7, None))
        _, self.M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
        R = rigid_modes(mesh.points, np.zeros(3))
        self.mass, self.center, self.J0 = mass_properties(R.T @ (self.M @ R), np.zeros(3))
        self.points, self.U = mesh.points, np.asarray(system.T @ basis.Phi)
        self.terms = inertia_terms(self.M, self.U, self.points, self.center)

    def velocities(self, q, qd, w) -> np.ndarray:
        x = self.points - self.center + (self.U @ q).reshape(-1, 3)
        return np.cross(w, x).ravel() + self.U @ qd


@pytest.fixture(scope="module")
def body() -> Body:
    return Body()


def relative(a, b) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


def test_kinetic_energy_of_the_nodes(body) -> None:
    """T, J w + h and the absent linear momentum, from v^T M v of finite elements at large deformation and turning."""
    rng = np.random.default_rng(4)
    for _ in range(3):
        q, qd = 0.02 * rng.normal(size=(2, body.U.shape[1]))
        w = 5.0 * rng.normal(size=3)
        v = body.velocities(q, qd, w)
        T = terms_of.kinetic_energy(body.terms, body.J0, q, qd, w)
        assert pytest.approx(0.5 * v @ (body.M @ v), rel=1e-11) == T
        x = body.points - body.center + (body.U @ q).reshape(-1, 3)
        turns = rigid_modes(x, np.zeros(3))
        momentum = turns[:, 3:].T @ (body.M @ v)
        assert relative(terms_of.momentum(body.terms, body.J0, q, qd, w), momentum) < 1e-11
        assert np.abs(turns[:, :3].T @ (body.M @ v)).max() < 1e-9 * body.mass * np.abs(v).max()


def test_definition_by_moments(body) -> None:
    """The moments with the scalar mass matrix give what rotated modes give; a mass coupling two dofs takes that way."""
    assert scalar_mass(body.M) is not None
    other = sp.lil_matrix(body.M)
    other[0, 1] = other[1, 0] = 1e-14 * body.M[0, 0]
    assert scalar_mass(other) is None
    other[0, 1] = other[1, 0] = 0.0
    other[0, 0] *= 1.0 + 1e-15
    assert scalar_mass(other) is None
    turned = inertia_terms(other, body.U, body.points, body.center)
    for name in ("first", "second", "gyroscopic"):
        assert relative(getattr(body.terms, name), getattr(turned, name)) < 1e-12


def test_mass_matrix_with_directions_of_its_own() -> None:
    """A given M that is not the same in all directions: the forms w.J w and its slopes are still those of v^T M v."""
    rng = np.random.default_rng(8)
    n, k = 9, 4
    A = rng.normal(size=(3 * n, 3 * n))
    M, points, U = A @ A.T + np.eye(3 * n), rng.normal(size=(n, 3)), rng.normal(size=(3 * n, k))
    terms = inertia_terms(sp.csr_matrix(M), U, points, np.zeros(3))
    w, q = rng.normal(size=3), rng.normal(size=k)
    rotated = np.cross(w, points).ravel()
    of_modes = np.stack([np.cross(w, u.reshape(-1, 3)).ravel() for u in U.T], axis=1)
    np.testing.assert_allclose(np.einsum("a,iab,b->i", w, terms.first, w), 2.0 * rotated @ M @ of_modes, rtol=1e-10)
    np.testing.assert_allclose(np.einsum("a,ijab,b->ij", w, terms.second, w), of_modes.T @ M @ of_modes, rtol=1e-9)
    skew = of_modes.T @ M @ U
    np.testing.assert_allclose(terms.gyroscopic @ w, 0.5 * (skew - skew.T), atol=1e-10 * np.abs(skew).max())
    v = rotated + of_modes @ q
    assert w @ terms_of.inertia(terms, inertia_of(M, points), q) @ w == pytest.approx(v @ M @ v, rel=1e-10)


def inertia_of(M, points) -> np.ndarray:
    R = rigid_modes(points, np.zeros(3))[:, 3:]
    return R.T @ M @ R


def invariants(body: ReducedBody) -> list[np.ndarray]:
    """Sums over modes that a rotation within equal frequencies leaves alone, in natural weights 1/omega^2."""
    t = body.inertia_terms
    assert t is not None
    k = t.modes
    s = (body.frequencies[0] / body.frequencies[:k]) ** 2
    first, second, G = t.first.reshape(k, 9), t.second.reshape(k, k, 9), t.gyroscopic
    return [
        np.einsum("i,ia,ib->ab", s, first, first),
        np.einsum("i,iia->a", s, second),
        np.einsum("i,j,ija,ijb->ab", s, s, second, second),
        np.einsum("i,j,ija,ijb->ab", s, s, G, G),
        np.einsum("i,j,ia,ijb,jc->abc", s, s, first, second, first),
        np.einsum("i,j,k,ija,jkb,kic->abc", s, s, s, G, G, G, optimize=True),
        np.einsum("i,j,k,ija,jkb,kic->abc", s, s, s, G, G, second, optimize=True),
        np.einsum("i,j,k,ija,jkb,kic->abc", s, s, s, second, second, second, optimize=True),
    ]


@pytest.mark.parametrize("modes", [6, 40])
def test_paths_agree(small_roller, modes) -> None:
    bodies = [reduced(small_roller, modes=modes, general=general) for general in (False, True)]
    assert [b.report["path"] for b in bodies] == ["cyclic", "general"]
    for a, b in zip(*map(invariants, bodies), strict=True):
        # what vanishes by symmetry is round-off of unit entries in both
        assert np.abs(a - b).max() < SAME * max(np.abs(b).max(), 1e-3)


def test_paths_agree_on_an_odd_number_of_sectors_and_a_tilted_axis(curved_roller) -> None:
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    cyclic = curved_roller.cyclic
    shift = np.array([0.3, -0.2, 0.1])
    moved = Mesh(
        curved_roller.points @ turn.T + shift,
        curved_roller.cells,
        curved_roller.facet_sets,
        cyclic=replace(
            cyclic, axis_point=turn @ cyclic.axis_point + shift, axis_direction=turn @ cyclic.axis_direction
        ),
    )
    bodies = [reduced(moved, modes=12, contact={}, general=general) for general in (False, True)]
    assert [b.report["path"] for b in bodies] == ["cyclic", "general"]
    for a, b in zip(*map(invariants, bodies), strict=True):
        assert np.abs(a - b).max() < SAME * max(np.abs(b).max(), 1e-3)


def test_number_of_modes(small_roller) -> None:
    """The lowest modes, never half of a pair; the terms are those of the whole."""
    whole = reduced(small_roller, modes=40)
    assert whole.report["inertia"]["modes"] == whole.report["inertia"]["of"] == len(whole.frequencies)
    assert "inertia terms   of all global modes" in whole.info()
    for general in (False, True):
        part = reduced(small_roller, modes=40, inertia_modes=11, general=general)
        k = part.report["inertia"]["modes"]
        assert part.inertia_terms is not None and k == part.inertia_terms.modes
        assert k == covered_modes(part.frequencies, 11) and 11 <= k <= 12
        assert f"the first {k} of {len(part.frequencies)} global modes" in part.info()
    first = whole.inertia_terms
    assert first is not None
    short = InertiaTerms(first.first[:k], first.second[:k, :k], first.gyroscopic[:k, :k])
    for a, b in zip(invariants(part), invariants(replace(whole, inertia_terms=short)), strict=True):
        assert np.abs(a - b).max() < SAME * max(np.abs(b).max(), 1e-3)
    assert reduced(small_roller, inertia_modes=0).report["inertia"]["modes"] == 0
    with pytest.raises(InputError, match="ReductionOptions: inertia_modes must be .* at least 0, got -1"):
        reduced(small_roller, inertia_modes=-1)
    with pytest.raises(InputError, match="inertia_modes is a number of modes, got True"):
        reduced(small_roller, inertia_modes=True)


def test_file_keeps_the_terms(small_roller, tmp_path) -> None:
    body = reduced(small_roller, modes=6)
    again = ReducedBody.load(body.save(tmp_path / "roller.h5"))
    assert body.inertia_terms is not None and again.inertia_terms is not None
    for name in ("first", "second", "gyroscopic"):
        assert np.array_equal(getattr(body.inertia_terms, name), getattr(again.inertia_terms, name))
    assert again.inertia_terms.stiffening is None
    other = replace(body, inertia_terms=None)
    assert other.content_hash() != body.content_hash() == again.content_hash()
    assert replace(body, mass=2.0).inertia_terms is body.inertia_terms
