"""Geometric stiffness: exact moments of the prestress, bars under tension and rotating bars against beams."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla
import scipy.sparse as sp
from interface_bodies import box, free_body
from offline_bodies import STEEL, reduced

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import from_matrices
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import PRODUCTS
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.offline.fe import assemble, assign
from warpffrf.offline.inertia.invariants import centrifugal_acceleration, prestress_stiffness

LENGTH, WIDTH, HEIGHT = 0.6, 0.02, 0.014  # m, along z, y, x: bending in the planes of y and x has its own frequencies
# Shear and rotary inertia, (height/length)^2 times 30 for the second mode, and 24 linear cells: 0.6 % is seen.
BEAM = 0.01


class Bar:
    """A free steel bar along z with interfaces on its end faces."""

    def __init__(self) -> None:
        self.mesh = box((1, 1, 24), (HEIGHT, WIDTH, LENGTH))
        self.body = reduce(
            self.mesh,
            STEEL,
            interfaces={"low": "average", "high": "average"},
            modes=8,
            options=ReductionOptions(stiffening=True),
            cache=False,
            progress=False,
        )
        terms = self.body.inertia_terms
        assert terms is not None and terms.stiffening is not None
        self.terms, self.stiffening = terms, terms.stiffening

    def bending(self, direction: int) -> np.ndarray:
        """The two lowest modes that bend along `direction`, found by how much they move."""
        motion = (self.body.surface.modes.astype(float) ** 2).mean(axis=1)
        rest = motion.sum(axis=1) - motion[:, direction]
        return np.flatnonzero(rest < 0.1 * motion[:, direction])[:2]


@pytest.fixture(scope="module")
def bar() -> Bar:
    return Bar()


def beam_geometric(tension, count: int = 60, shapes: int = 2) -> np.ndarray:
    """int T(z) w_i' w_j' dz (shapes, shapes) of the lowest bending modes of a free Euler beam of the bar's length and
    mass per length, int rho A w^2 = 1: Hermite elements, written here; the modes do not depend on E I."""
    h = LENGTH / count
    z, weight = np.polynomial.legendre.leggauss(5)
    s, weight = 0.5 * (1 + z), 0.5 * h * weight
    N = np.stack([1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)])
    D = np.stack([-6 * s + 6 * s**2, h * (1 - 4 * s + 3 * s**2), 6 * s - 6 * s**2, h * (3 * s**2 - 2 * s)]) / h
    C = np.stack([-6 + 12 * s, h * (-4 + 6 * s), 6 - 12 * s, h * (6 * s - 2)]) / h**2
    K, M, G = np.zeros((3, 2 * count + 2, 2 * count + 2))
    line = STEEL.density * WIDTH * HEIGHT
    for e in range(count):
        part = slice(2 * e, 2 * e + 4)
        place = (e + s) * h - 0.5 * LENGTH
        K[part, part] += (C * weight) @ C.T
        M[part, part] += line * (N * weight) @ N.T
        G[part, part] += (D * weight * tension(place)) @ D.T
    _, modes = sla.eigh(K, M)
    modes = modes[:, 2 : 2 + shapes]  # without the two rigid motions
    return modes.T @ G @ modes


def assert_same_up_to_sign(found: np.ndarray, expected: np.ndarray) -> None:
    """Modes have no sign of their own."""
    scale = np.sqrt(np.outer(np.abs(np.diag(expected)), np.abs(np.diag(expected))))
    assert np.all(np.abs(np.abs(found) - np.abs(expected)) < BEAM * scale)
    assert np.all(np.diag(found) * np.diag(expected) > 0.0)


@pytest.mark.parametrize("direction", [0, 1])
def test_tension_at_both_ends(bar, direction) -> None:
    """F at both ends adds int F w'^2, 49.48 F/(m L) for the first mode, to omega^2; pulling stiffens."""
    i = bar.bending(direction)
    loads = {"high": np.array([0, 0, 1.0, 0, 0, 0]), "low": np.array([0, 0, -1.0, 0, 0, 0])}
    K = bar.stiffening.matrix(np.zeros(3), loads)[np.ix_(i, i)]
    expected = beam_geometric(np.ones_like)
    mass = STEEL.density * WIDTH * HEIGHT * LENGTH
    assert expected[0, 0] == pytest.approx(49.48 / (mass * LENGTH), rel=1e-3)
    assert_same_up_to_sign(K, expected)
    F = 1e4  # N, a tenth of the buckling load
    omega = 2.0 * np.pi * bar.body.frequencies[: bar.terms.modes]
    stiffened = np.sqrt(np.linalg.eigvalsh(np.diag(omega**2) + F * bar.stiffening.matrix(np.zeros(3), loads)))
    change = stiffened[i[0]] ** 2 - omega[i[0]] ** 2
    assert change == pytest.approx(F * expected[0, 0], rel=BEAM)


def test_one_end_alone_is_balanced_by_inertia(bar) -> None:
    """A force on one end only accelerates the bar: tension grows linearly to the pulled end, mean half of it."""
    i = bar.bending(0)
    K = bar.stiffening.interfaces["high"][2][np.ix_(i, i)]
    assert_same_up_to_sign(K, beam_geometric(lambda z: 0.5 + z / LENGTH))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("direction", [0, 1])
def test_rotating_bar(bar, axis, direction) -> None:
    """About an axis across the bar, T = rho A w^2 (L^2/4 - z^2)/2 stiffens bending in both planes alike."""
    i = bar.bending(direction)
    line = STEEL.density * WIDTH * HEIGHT
    K = bar.stiffening.centrifugal[axis][np.ix_(i, i)]
    assert_same_up_to_sign(K, beam_geometric(lambda z: 0.5 * line * (0.25 * LENGTH**2 - z**2)))


@pytest.mark.parametrize(("speed", "expected"), [(1.0, 3.68165), (2.0, 4.13732), (5.0, 6.44954), (10.0, 11.20233)])
def test_flap_of_a_rotating_cantilever(bar, speed, expected) -> None:
    """VERIFICATION D7: clamped at one end to a hub of radius zero that turns about x, flap frequencies of a beam.

    Small flap motion: the centre of mass moves by c along x, the frame tilts by a, modes q. With T(s) the tension of
    the clamped bar, sum of what turning and the pull at the root (in body axes) make, the energy is
    int T (a + w')^2/2, and int T w' = - T_root w_root, as the modes have no momentum.
    """
    kept = [i for i in range(bar.terms.modes) if np.ptp(bar.body.surface.modes[i, :, 0]) > 1e-3]
    assert len(kept) >= 6
    root = bar.body.interfaces["low"]
    motion = root.modes[kept][:, [0, 4]].T  # along x, about y
    omega = 2.0 * np.pi * bar.body.frequencies[kept]

    def flap(turning: float) -> float:
        pull = bar.body.mass * turning**2 * 0.5 * LENGTH
        loads = {"low": np.array([0, 0, -pull, 0, 0, 0])}
        n = len(kept)
        M = np.diag([bar.body.mass, bar.body.inertia[1, 1], *np.ones(n)])
        K = np.zeros((n + 2, n + 2))
        K[1, 1] = bar.body.mass * turning**2 * LENGTH**2 / 3.0  # int T
        K[1, 2:] = K[2:, 1] = -pull * motion[0]
        K[2:, 2:] = np.diag(omega**2) + bar.stiffening.matrix(np.array([turning, 0.0, 0.0]), loads)[np.ix_(kept, kept)]
        clamp = np.zeros((2, n + 2))
        clamp[:, 2:] = motion
        clamp[0, :2], clamp[1, 1] = [1.0, -0.5 * LENGTH], 1.0
        free = sla.null_space(clamp / np.abs(clamp).max(axis=1, keepdims=True))
        return float(np.sqrt(sla.eigh(free.T @ K @ free, free.T @ M @ free, eigvals_only=True)[0]))

    unit = flap(0.0) / 3.51602  # sqrt(E I/(rho A L^4)) of this mesh
    assert flap(speed * unit) / unit == pytest.approx(expected, rel=BEAM)


def test_turning_about_the_bar_does_nearly_nothing(bar) -> None:
    i = bar.bending(0)
    across, along = bar.stiffening.centrifugal[0], bar.stiffening.centrifugal[2]
    # stresses go with the square of the distance from the axis
    assert np.abs(along[np.ix_(i, i)]).max() < 4.0 * (WIDTH / LENGTH) ** 2 * across[i[0], i[0]]


@pytest.mark.parametrize("kind", ["rigid", "average"])
def test_mean_stress_of_the_loads(kind) -> None:
    """On rotations as modes K_sigma is the mean stress, tr(S) 1 - S, S_ab = int sigma_ab dV, and S is the first moment
    of the balanced loads: exact on any mesh."""
    mesh = box((2, 2, 3), (0.03, 0.05, 0.08))
    points = mesh.points @ np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0].T
    mesh = type(mesh)(points, mesh.cells, mesh.facet_sets)
    model, system = free_body(mesh, {"low": kind, "high": kind})
    assignment = assign(mesh, STEEL)
    K, M = assemble(mesh.points, mesh.cells, assignment)
    center = points.mean(axis=0)
    T = system.T
    loads = [T.T @ (M @ centrifugal_acceleration(points, center)), *system.wrenches().values()]
    static = T @ model.flexibility(np.concatenate(loads, axis=1))
    R = rigid_modes(points, center)[:, 3:]
    found = prestress_stiffness(points, mesh.cells, assignment, static, R)
    forces = (K @ static).reshape(len(points), 3, -1)
    S = np.einsum("na,nbl->lab", points - center, forces)
    np.testing.assert_allclose(S, S.transpose(0, 2, 1), atol=1e-10 * np.abs(S).max())  # no moment is left
    expected = np.trace(S, axis1=1, axis2=2)[:, None, None] * np.eye(3) - S
    np.testing.assert_allclose(found, expected, atol=1e-10 * np.abs(expected).max())


def test_centrifugal_acceleration() -> None:
    rng = np.random.default_rng(5)
    points, center, w = rng.normal(size=(4, 3)), rng.normal(size=3), rng.normal(size=3)
    products = np.array([w[a] * w[b] for a, b in PRODUCTS])
    expected = -np.cross(w, np.cross(w, points - center)).ravel()
    np.testing.assert_allclose(centrifugal_acceleration(points, center) @ products, expected, atol=1e-14)


def test_periodic_body_goes_the_general_way(small_roller) -> None:
    body = reduced(small_roller, modes=6, stiffening=True)
    assert body.report["path"] == "general" and "stiffening=True" in body.report["path_reason"]
    assert any("stiffening" in note for note in body.report["notes"])
    assert "stiffened by rotation, loads on bore" in body.info()
    terms = body.inertia_terms
    assert terms is not None and terms.stiffening is not None
    # about the roller's axis (y): both modes of a pair alike, and hoop tension stiffens
    K = terms.stiffening.centrifugal[1]
    assert np.abs(K - K.T).max() == 0.0 and np.linalg.eigvalsh(K).min() > 0.0


def test_file_keeps_it(bar, tmp_path) -> None:
    again = ReducedBody.load(bar.body.save(tmp_path / "bar.h5"))
    assert again.content_hash() == bar.body.content_hash()
    assert again.inertia_terms is not None and again.inertia_terms.stiffening is not None
    assert np.array_equal(again.inertia_terms.stiffening.centrifugal, bar.stiffening.centrifugal)
    assert list(again.inertia_terms.stiffening.interfaces) == sorted(bar.stiffening.interfaces)
    for name, K in bar.stiffening.interfaces.items():
        assert np.array_equal(again.inertia_terms.stiffening.interfaces[name], K)


def test_bodies_without_cells_are_refused() -> None:
    mesh = box((1, 1, 2), (0.01, 0.01, 0.03))
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    bare = from_matrices(sp.csr_matrix(M), sp.csr_matrix(K), mesh.points)
    with pytest.raises(InputError, match="stiffening=True needs the stresses in cells.*leave stiffening out"):
        reduce(bare, modes=2, options=ReductionOptions(stiffening=True), cache=False, progress=False)
    with pytest.raises(InputError, match="stiffening must be True or False, or 'membrane', got 'yes'"):
        reduce(mesh, STEEL, modes=2, options=ReductionOptions(stiffening="yes"), cache=False, progress=False)  # pyright: ignore[reportArgumentType]
