"""Inertia terms against point masses, the Lagrangian by finite differences, and conservation in free motion."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from warpffrf.model.errors import InputError
from warpffrf.model.reduced import inertia as terms_of
from warpffrf.model.reduced.inertia import LEVELS, PRODUCTS, GeometricStiffness, InertiaTerms

MODES = 5
J_STEP = 1e-5  # of central differences: third derivatives of a polynomial of degree 4 leave 1e-10


class PointMasses:
    """Random point masses with modes that fulfil Tisserand's conditions; sums over points are the only formulas."""

    def __init__(self, seed: int = 3, count: int = 12) -> None:
        rng = np.random.default_rng(seed)
        self.m = rng.uniform(0.5, 2.0, count)
        X = rng.normal(size=(count, 3))
        self.X = X - self.m @ X / self.m.sum()
        R = np.zeros((3 * count, 6))
        for a in range(3):
            e = np.eye(3)[a]
            R[:, a] = np.tile(e, count)
            R[:, 3 + a] = np.cross(e, self.X).ravel()
        M = np.repeat(self.m, 3)
        basis = np.concatenate([R, rng.normal(size=(3 * count, MODES))], axis=1) * np.sqrt(M)[:, None]
        Q = np.linalg.qr(basis)[0][:, 6:] / np.sqrt(M)[:, None]
        self.phi = Q.T.reshape(MODES, count, 3)
        self.stiffness = rng.uniform(30.0, 90.0, MODES)

    def inertia(self, q: np.ndarray) -> np.ndarray:
        x = self.X + np.tensordot(q, self.phi, 1)
        return np.sum([m * ((p @ p) * np.eye(3) - np.outer(p, p)) for m, p in zip(self.m, x, strict=True)], axis=0)

    def velocities(self, q, qd, w) -> np.ndarray:
        return np.cross(w, self.X + np.tensordot(q, self.phi, 1)) + np.tensordot(qd, self.phi, 1)

    @property
    def terms(self) -> InertiaTerms:
        one = np.eye(3)
        first = np.zeros((MODES, 3, 3))
        second, gyroscopic = np.zeros((MODES, MODES, 3, 3)), np.zeros((MODES, MODES, 3))
        for i, a in enumerate(self.phi):
            for m, X, p in zip(self.m, self.X, a, strict=True):
                first[i] += m * (2.0 * (X @ p) * one - np.outer(X, p) - np.outer(p, X))
            for j, b in enumerate(self.phi):
                for m, p, r in zip(self.m, a, b, strict=True):
                    second[i, j] += m * ((p @ r) * one - 0.5 * (np.outer(p, r) + np.outer(r, p)))
                    gyroscopic[i, j] += m * np.cross(p, r)
        return InertiaTerms(first, second, gyroscopic)


@pytest.fixture(scope="module")
def cloud() -> PointMasses:
    return PointMasses()


@pytest.fixture(scope="module")
def state():
    rng = np.random.default_rng(11)
    q, qd, qdd = 0.3 * rng.normal(size=(3, MODES))
    w, wdot = rng.normal(size=(2, 3))
    return q, qd, qdd, w, wdot


def test_sums_over_points(cloud, state) -> None:
    q, qd, _, w, _ = state
    terms, J0 = cloud.terms, cloud.inertia(np.zeros(MODES))
    v = cloud.velocities(q, qd, w)
    x = cloud.X + np.tensordot(q, cloud.phi, 1)
    np.testing.assert_allclose(terms_of.inertia(terms, J0, q), cloud.inertia(q), atol=1e-12)
    np.testing.assert_allclose(terms_of.momentum(terms, J0, q, qd, w), cloud.m @ np.cross(x, v), atol=1e-12)
    assert terms_of.kinetic_energy(terms, J0, q, qd, w) == pytest.approx(0.5 * cloud.m @ (v * v).sum(axis=1), rel=1e-13)
    np.testing.assert_allclose(cloud.m @ v, 0.0, atol=1e-12)  # deforming and turning carry no linear momentum


@pytest.mark.parametrize("level", LEVELS)
def test_forces_are_those_of_the_lagrangian(cloud, state, level) -> None:
    """d/dt dT/dqdot - dT/dq and d/dt L + w x L by central differences of the kinetic energy along a motion."""
    q, qd, qdd, w, wdot = state
    terms, J0 = cloud.terms, cloud.inertia(np.zeros(MODES))

    def energy(q, qd, w) -> float:
        return terms_of.kinetic_energy(terms, J0, q, qd, w, level)

    def slope(f, x):
        steps = J_STEP * np.eye(len(x))
        return np.array([(f(x + s) - f(x - s)) / (2.0 * J_STEP) for s in steps])

    def along(t):
        return q + t * qd + 0.5 * t**2 * qdd, qd + t * qdd, w + t * wdot

    def rate(f):
        return (f(J_STEP) - f(-J_STEP)) / (2.0 * J_STEP)

    def modal_momentum(t):
        a, b, c = along(t)
        return slope(lambda x: energy(a, x, c), b)

    def angular_momentum(t):
        a, b, c = along(t)
        return slope(lambda x: energy(a, b, x), c)

    modal = rate(modal_momentum) - slope(lambda x: energy(x, qd, w), q)
    torque = rate(angular_momentum) + np.cross(w, angular_momentum(0.0))
    # differences of differences: round-off 1e-16/J_STEP^2 = 1e-6
    np.testing.assert_allclose(qdd + terms_of.modal_forces(terms, q, qd, w, wdot, level), modal, atol=2e-5)
    np.testing.assert_allclose(terms_of.body_torque(terms, J0, q, qd, qdd, w, wdot, level), torque, atol=2e-5)
    np.testing.assert_allclose(terms_of.momentum(terms, J0, q, qd, w, level), angular_momentum(0.0), atol=1e-8)


@pytest.mark.parametrize("level", LEVELS)
def test_free_motion_conserves_energy_and_angular_momentum(cloud, state, level) -> None:
    """Nothing acts but the springs of the modes: T + V and the momentum in space stay, at every level."""
    q, qd, _, w, _ = state
    terms, J0 = cloud.terms, cloud.inertia(np.zeros(MODES))

    def rates(t, y):
        q, qd, w, A = y[:MODES], y[MODES : 2 * MODES], y[2 * MODES : 2 * MODES + 3], y[-9:].reshape(3, 3)

        def left(a):  # linear in the accelerations a = (qdd, wdot)
            qdd, wdot = a[:MODES], a[MODES:]
            modal = qdd + terms_of.modal_forces(terms, q, qd, w, wdot, level) + cloud.stiffness * q
            return np.concatenate([modal, terms_of.body_torque(terms, J0, q, qd, qdd, w, wdot, level)])

        constant = left(np.zeros(MODES + 3))
        matrix = np.stack([left(e) - constant for e in np.eye(MODES + 3)], axis=1)
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)  # a mass matrix
        a = np.linalg.solve(matrix, -constant)
        W = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        return np.concatenate([qd, a, (A @ W).ravel()])

    start = np.concatenate([q, qd, w, np.eye(3).ravel()])
    run = solve_ivp(rates, (0.0, 1.0), start, method="DOP853", rtol=1e-11, atol=1e-12)

    def constants(y):
        q, qd, w, A = y[:MODES], y[MODES : 2 * MODES], y[2 * MODES : 2 * MODES + 3], y[-9:].reshape(3, 3)
        E = terms_of.kinetic_energy(terms, J0, q, qd, w, level) + 0.5 * cloud.stiffness @ q**2
        return np.array([E, *(A @ terms_of.momentum(terms, J0, q, qd, w, level))])

    np.testing.assert_allclose(constants(run.y[:, -1]), constants(start), rtol=1e-8, atol=1e-8)
    assert np.abs(run.y[:MODES, -1] - q).max() > 0.01  # it did move


def test_only_the_first_modes_carry_terms(cloud, state) -> None:
    q, qd, qdd, w, wdot = state
    terms, J0 = cloud.terms, cloud.inertia(np.zeros(MODES))
    k = 2
    part = InertiaTerms(terms.first[:k], terms.second[:k, :k], terms.gyroscopic[:k, :k])
    short = np.where(np.arange(MODES) < k, 1.0, 0.0)
    np.testing.assert_allclose(terms_of.inertia(part, J0, q), cloud.inertia(q * short), atol=1e-12)
    forces = terms_of.modal_forces(part, q, qd, w, wdot)
    np.testing.assert_array_equal(forces[k:], 0.0)
    whole = terms_of.modal_forces(terms, q * short, qd * short, w, wdot)
    np.testing.assert_allclose(forces[:k], whole[:k], atol=1e-13)
    torque = terms_of.body_torque(part, J0, q, qd, qdd, w, wdot)
    np.testing.assert_allclose(
        torque, terms_of.body_torque(terms, J0, q * short, qd * short, qdd * short, w, wdot), atol=1e-12
    )


def test_geometric_stiffness_sums_products_and_loads() -> None:
    rng = np.random.default_rng(1)
    base = rng.normal(size=(3, 3, 2, 2))
    both = base + base.transpose(1, 0, 2, 3)  # K_ab = K_ba
    centrifugal = np.stack([both[a, b] * (1.0 if a == b else 2.0) for a, b in PRODUCTS])
    loads = rng.normal(size=(6, 2, 2))
    stiffness = GeometricStiffness(centrifugal, {"bore": loads})
    w, F = rng.normal(size=3), rng.normal(size=6)
    expected = np.einsum("a,b,abij->ij", w, w, both) + np.tensordot(F, loads, 1)
    np.testing.assert_allclose(stiffness.matrix(w, {"bore": F}), expected, atol=1e-13)
    with pytest.raises(InputError, match="interface 'rim' does not exist; known: 'bore'"):
        stiffness.matrix(w, {"rim": F})


def test_shapes_and_levels_are_checked(cloud) -> None:
    terms = cloud.terms
    with pytest.raises(InputError, match="inertia level 'all' does not exist; known: 'constant'"):
        terms.kept("all")
    with pytest.raises(InputError, match="inertia terms: second must have shape"):
        InertiaTerms(terms.first[:2], terms.second, terms.gyroscopic)
    with pytest.raises(InputError, match="give both of k"):
        InertiaTerms(terms.first, terms.second, terms.gyroscopic, GeometricStiffness(np.zeros((6, 2, 2))))
