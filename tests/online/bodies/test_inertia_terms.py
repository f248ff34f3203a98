"""Inertia terms of the kernels: against the NumPy equations, their tangent against differences, and free flight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.joints import Fixed
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import (
    GeometricStiffness,
    InertiaTerms,
    body_torque,
    kinetic_energy,
    modal_forces,
    momentum,
)
from warpffrf.model.scene import Scene
from warpffrf.online.engine import Engine
from warpffrf.online.run import run

LEVELS = ("constant", "deformed", "gyroscopic", "full")
ROUND_OFF = 1e-12  # of the largest unbalanced force, from which the terms are taken by difference
RINGING = 1e-7  # of the energy: what the method takes from the modes that the sudden load excites
STIFFENED = 2e-2  # of the largest entry: the turn of the joint's forces with the interface is left out
DIFFERENCE = 1e-6  # of the largest entry: central differences of a step of 1e-6 of the size


def made_up(k: int, modes: int, inertia: np.ndarray, interfaces: tuple[str, ...] = (), seed: int = 3) -> InertiaTerms:
    """Terms of k modes as large as a real body's may be: J1 ~ sqrt(J), J2 and G ~ 1."""
    rng = np.random.default_rng(seed)
    J1 = rng.normal(size=(k, 3, 3))
    J2 = rng.normal(size=(k, k, 3, 3))
    G = rng.normal(size=(k, k, 3))
    J2 = J2 + J2.transpose(1, 0, 2, 3)
    K = rng.normal(size=(6, k, k))
    L = {name: 1e3 * rng.normal(size=(6, k, k)) for name in interfaces}
    stiffening = GeometricStiffness(K + K.transpose(0, 2, 1), {n: x + x.transpose(0, 2, 1) for n, x in L.items()})
    return InertiaTerms(
        np.sqrt(np.trace(inertia)) * 0.5 * (J1 + J1.transpose(0, 2, 1)),
        0.25 * (J2 + J2.transpose(0, 1, 3, 2)),
        0.5 * (G - G.transpose(1, 0, 2)),
        stiffening,
    )


@pytest.fixture(scope="module")
def body(plain_body: ReducedBody) -> ReducedBody:
    """A real body with made-up terms of all its modes but the last two."""
    m = len(plain_body.frequencies)
    return replace(plain_body, inertia_terms=made_up(m - 2, m, plain_body.inertia, tuple(plain_body.interfaces)))


class Evaluated:
    """Residuals and tangent of the kernels at a state that is reached by given increments."""

    def __init__(self, scene: Scene) -> None:
        self.engine = engine = Engine(scene)
        self.m = engine.compiled.model
        rng = np.random.default_rng(7)
        state = engine.state
        for name, size in (("v", 1.0), ("omega", 30.0), ("v_rate", 1.0), ("omega_rate", 900.0), ("v_alg", 1.0),
                           ("omega_alg", 900.0), ("q", 1e-4), ("qd", 0.1), ("qd_rate", 100.0), ("qd_alg", 100.0),
                           ("lam", 50.0)):  # fmt: skip
            array = getattr(state, name)
            array.assign(size * rng.normal(size=array.numpy().shape))
        h, beta, gamma = 1e-3, 0.3, 0.6
        engine.control(run=1, moved=1, refresh=1, mode=0)
        engine.clock(h=h)
        engine.coefficients(
            beta=beta, gamma=gamma, alpha_m=0.0, alpha_f=0.0, acc=1.0 / (beta * h * h), vel=gamma / (beta * h)
        )

    def __call__(self, dx: np.ndarray, psi: np.ndarray, dq: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = self.engine.scratch
        x.dx.assign(dx[None])
        x.psi.assign(psi[None])
        x.dq.assign(dq[None])
        self.engine.graph.evaluate()
        return x.residual.numpy()[0].copy(), x.modal_residual.numpy()[0].copy()

    def retained_matrix(self) -> np.ndarray:
        self.engine.graph.assemble()
        return self.engine.scratch.tangent.numpy()[0].copy()


@pytest.mark.parametrize("level", LEVELS)
def test_kernels_agree_with_the_equations(body: ReducedBody, level: str) -> None:
    """Torque, modal forces and kinetic energy beyond those of the constant inertia."""
    scene = Scene()
    handle = scene.add_body(body, name="a", inertia=level)
    e = Evaluated(scene)
    constant = Scene()
    constant.add_body(body, name="a", inertia="constant")
    c = Evaluated(constant)
    rng = np.random.default_rng(1)
    Q = len(body.frequencies)
    at = rng.normal(size=(1, 3)) * 1e-3, rng.normal(size=(1, 3)) * 0.02, rng.normal(size=Q) * 1e-4
    base = c(*at)
    torque, modal = (found - left for found, left in zip(e(*at), base, strict=True))
    x = e.engine.scratch
    w, wdot, q, qd, qdd = (a.numpy()[0].reshape(-1) for a in (x.omega1, x.omega1_rate, x.q1, x.qd1, x.qd1_rate))
    terms = body.inertia_terms
    assert terms is not None
    J0, zero = handle.inertia, np.zeros(3)
    expected = body_torque(terms, J0, q, qd, qdd, w, wdot, level)
    expected = expected - body_torque(terms, J0, q, qd, qdd, w, wdot, "constant")
    assert np.abs(torque[3:] - expected).max() <= ROUND_OFF * np.abs(base[0]).max()
    assert np.array_equal(torque[:3], zero)
    forces = modal_forces(terms, q, qd, w, wdot, level)
    assert np.abs(modal - forces).max() <= ROUND_OFF * np.abs(base[1]).max()
    if level != "constant":
        extra = kinetic_energy(terms, J0, q, qd, w, level) - kinetic_energy(terms, J0, q, qd, w, "constant")
        assert x.extra_energy.numpy()[0, 0] == pytest.approx(extra, rel=1e-10)


def differences(e: Evaluated, columns: range) -> tuple[np.ndarray, np.ndarray]:
    """The retained matrix of rigid and dense unknowns, and its `columns` by central differences of the residual."""
    rng = np.random.default_rng(2)
    Q = e.m.modes.count
    dx, psi, dq = rng.normal(size=(1, 3)) * 1e-3, rng.normal(size=(1, 3)) * 0.02, rng.normal(size=Q) * 1e-4
    size = 6 + e.m.dense.count
    e(dx, psi, dq)
    matrix = e.retained_matrix()[:size, :size]
    inverse = e.engine.scratch.psi_inverse.numpy()[0, 0].reshape(3, 3)

    def residual(column: int, amount: float) -> np.ndarray:
        x, p, y = dx.copy(), psi.copy(), dq.copy()
        if column < 3:
            x[0, column] += amount
        elif column < 6:
            p[0] += amount * inverse[:, column - 3]
        else:
            y[column - 6] += amount
        r, m = e(x, p, y)
        return np.concatenate([r, m[: e.m.dense.count]])

    found = np.zeros((size, len(columns)))
    for i, column in enumerate(columns):
        step = 1e-6 if column < 6 else 1e-8
        found[:, i] = (residual(column, step) - residual(column, -step)) / (2.0 * step)
    return matrix, found


def test_tangent_agrees_with_differences(body: ReducedBody) -> None:
    """All columns of the rigid and the dense unknowns, full inertia, rotation stiffening."""
    scene = Scene()
    scene.add_body(body, name="a", inertia="full", stiffening=True)
    e = Evaluated(scene)
    matrix, found = differences(e, range(6 + e.m.dense.count))
    assert np.all(np.abs(found - matrix).max(axis=0) < DIFFERENCE * np.abs(matrix).max(axis=0))


def test_forces_at_an_interface_stiffen(body: ReducedBody) -> None:
    """What the stiffening adds to the tangent of the modes under a joint's forces, against differences."""
    matrices = []
    for stiffening in (True, False):
        scene = Scene()
        handle = scene.add_body(body, name="a", inertia="full", stiffening=stiffening)
        scene.add(Fixed(scene.ground, handle["bore"]))
        e = Evaluated(scene)
        matrices.append(differences(e, range(6, 6 + e.m.dense.count)))
    added, found = (matrices[0][i] - matrices[1][i] for i in (0, 1))
    added = added[6:, 6:]
    assert np.abs(added).max() > 1e4  # N/m
    assert np.abs(added - found[6:]).max() < STIFFENED * np.abs(added).max()


def test_levels_need_terms(plain_body: ReducedBody) -> None:
    bare = replace(plain_body, inertia_terms=None)
    for level, stiffening, words in (("full", False, "reduce it again"), ("auto", True, "stiffening=True")):
        scene = Scene()
        scene.add_body(bare, name="a", inertia=level, stiffening=stiffening)
        with pytest.raises(InputError, match=words):
            Engine(scene)
    with pytest.raises(InputError, match="known: 'constant', 'deformed'"):
        Scene().add_body(bare, name="a", inertia="gyroscopc")


@pytest.mark.parametrize("level", LEVELS)
def test_free_flight_keeps_momentum_to_second_order(plain_body: ReducedBody, level: str) -> None:
    """A ring tumbling and ringing: halving the step quarters the drift of angular momentum."""
    drift = []
    for steps in (200, 400):
        scene = Scene(gravity=(0.0, 0.0, 0.0))
        handle = scene.add_body(
            plain_body, name="a", inertia=level, damping=0.0, velocity=(0.3, 0.0, 0.1), angular_velocity=(300, 900, 40)
        )
        history = run(scene, 2e-3, step=2e-3 / steps, progress=False)
        assert history.status == "completed"
        b = history.bodies["a"]
        L, E = [], []
        terms = plain_body.inertia_terms
        assert terms is not None
        for i in range(len(history.time)):
            A = rot.matrix(b.rotation[i])
            w = A.T @ b.angular_velocity[i]
            at = terms, handle.inertia, b.modal[i], b.modal_velocity[i], w, level
            L.append(A @ momentum(*at))
            elastic = 0.5 * np.sum((2.0 * np.pi * plain_body.frequencies * b.modal[i]) ** 2)
            E.append(kinetic_energy(*at) + elastic)
        L, E = np.array(L), np.array(E)
        drift.append((np.abs(L - L[0]).max() / np.abs(L[0]).max(), np.abs(E - E[0]).max() / E[0]))
    assert drift[1][0] < 0.3 * drift[0][0] + 1e-10
    assert drift[1][1] < RINGING
