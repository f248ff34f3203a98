"""Every basis of the registry against a dense full model, and what each one promises of its own."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla
from interface_bodies import box, free_body, two_bearing_roller
from offline_bodies import STEEL
from reference_fe import free_response, matrices

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline import bases
from warpffrf.offline.bases import BASES
from warpffrf.offline.bases.build import build_basis
from warpffrf.offline.bases.modes import BasisProblem, attachment_modes
from warpffrf.offline.bases.responses import hankel_values, modal_receptance, position_gramian, projected_receptance
from warpffrf.offline.bases.vibrations import SMALL_SYSTEM, hold_interfaces, shifted_solver
from warpffrf.offline.interfaces import AverageInterface, InterfaceSystem
from warpffrf.offline.products import Limits

EXACT = 1e-8  # what the product promises
AT_REST = 1e-10  # motion of the interfaces under residual loads, of that of the body
ROUND_OFF = 1e-12  # of receptances over their largest
NONE = Limits(None, None)
TOP = 2.0 * np.pi * 60e3  # rad/s, about 15 modes of the roller below
RNG = np.random.default_rng(5)


def snapshots(columns: int, kept: int, nodes: int = 180) -> np.ndarray:
    """(nodes, 3, columns) displacements in a space of `kept` directions, deterministic."""
    rng = np.random.default_rng(kept)
    return (rng.standard_normal((3 * nodes, kept)) @ rng.standard_normal((kept, columns))).reshape(nodes, 3, columns)


CASES = {
    "free_free": (bases.FreeFree(), Limits(20, None)),
    "craig_bampton": (bases.CraigBampton(), Limits(None, TOP)),
    "craig_chang": (bases.CraigChang(), Limits(12, TOP)),
    "krylov": (bases.Krylov(expansion_points=(1e4, 3e4)), NONE),
    "krylov about zero": (bases.Krylov(moments=3), NONE),
    "balanced": (bases.Balanced(pool_modes=80), Limits(10, None)),
    "pod": (bases.POD(), Limits(None, TOP)),
    "pod of snapshots": (bases.POD(snapshots=snapshots(30, 12)), NONE),
    # two faces of the roller that look at each other through its wall
    "joint": (bases.TrialVectorDerivatives(first="rim", second="bore", normal=6, tangential=5), Limits(4, None)),
}


@pytest.fixture(scope="module")
def body():
    """A roller, one interface rigid and one averaging, and loads on its rim like those of stress modes."""
    mesh = two_bearing_roller()
    model, system = free_body(mesh, {"left": "rigid", "right": "average"})
    rim = mesh.facets("rim").node_set
    normal = np.zeros((len(mesh.points), 3, len(rim)))
    outward = mesh.points[rim] * [1.0, 0.0, 1.0]
    normal[rim, :, np.arange(len(rim))] = outward / np.linalg.norm(outward, axis=1)[:, None]
    return mesh, model, system, system.T.T @ normal.reshape(-1, len(rim))


@pytest.fixture(scope="module")
def full(body):
    """Dense independent model: matrices by scikit-fem, constraint written out; static responses to all loads."""
    mesh, _, system, pressure = body
    K, M = matrices(mesh, STEEL)
    left = system.interfaces[0]
    free = np.setdiff1d(np.arange(len(mesh.points)), left.nodes)
    T = np.zeros((3 * len(mesh.points), 3 * len(free) + 6))
    T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    T[(3 * left.nodes[:, None] + np.arange(3)).ravel(), 3 * len(free) :] = rigid_modes(
        mesh.points[left.nodes], left.point
    )
    R = np.zeros((T.shape[1], 6))
    R[: 3 * len(free)] = rigid_modes(mesh.points[free], left.point)
    R[3 * len(free) :] = np.eye(6)
    K, M = T.T @ K @ T, T.T @ M @ T
    right = system.interfaces[1]
    assert isinstance(right, AverageInterface)
    F = np.zeros((T.shape[1], 12))
    F[3 * len(free) :, :6] = np.eye(6)
    F[:, 6:] = T[(3 * right.nodes[:, None] + np.arange(3)).ravel()].T @ right.S.T
    loads = np.concatenate([F, pressure], axis=1)
    omega2 = sla.eigh(K, M, eigvals_only=True)
    return K, M, loads, free_response(K, M, R, loads), np.sqrt(omega2[6:])


def built(body, case: str):
    options, limits = CASES[case]
    return build_basis(options, body[1], body[2], limits, mesh=body[0])


def test_registries_agree():
    assert {options.kind for options, _ in CASES.values()} == set(BASES)
    assert all(cls.kind == kind for kind, cls in BASES.items())


# --- what every basis promises ---


@pytest.mark.parametrize("case", CASES)
def test_static_response_is_exact(body, full, case):
    """Global modes and residual local modes together, to interface loads and to pressure; alone, to interface loads."""
    _, model, system, pressure = body
    basis = built(body, case)
    _, _, loads, exact, _ = full
    F = np.concatenate([system.loads, pressure], axis=1)
    assert np.allclose(F, loads, atol=1e-14)
    scale = np.abs(exact).max(axis=0)
    q = (basis.Phi.T @ F) / (basis.omega**2)[:, None]
    participation = basis.Phi.T @ pressure
    local = model.flexibility(pressure) - basis.Phi @ (participation / (basis.omega**2)[:, None])  # residual responses
    assert np.all(np.abs(basis.Phi @ q[:, :12] - exact[:, :12]).max(axis=0) < EXACT * scale[:12])
    assert np.all(np.abs(basis.Phi @ q[:, 12:] + local - exact[:, 12:]).max(axis=0) < EXACT * scale[12:])
    moved = np.abs(system.loads.T @ local)
    moved[[3, 4, 5, 9, 10, 11]] *= 0.015  # rotations, times the radius of the bore
    assert moved.max() < AT_REST * np.abs(exact[:, 12:]).max()


@pytest.mark.parametrize("case", CASES)
def test_modes_are_orthonormal_and_free_of_rigid_motion(body, case):
    _, model, _, _ = body
    basis = built(body, case)
    Phi, omega = basis.Phi, basis.omega
    m = len(omega)
    assert np.all(np.diff(omega) >= 0.0) and omega[0] > 0.0
    assert np.abs(Phi.T @ (model.M @ Phi) - np.eye(m)).max() < 1e-11
    assert np.abs((Phi / omega).T @ (model.K @ (Phi / omega)) - np.eye(m)).max() < 1e-11
    assert np.abs(model.R.T @ (model.M @ Phi)).max() < 1e-12
    assert basis.facts["basis"]["static_completion"]["attachment_modes"] == 12
    # responses near two frequencies may say the same of the stiffest load
    assert basis.facts["dependent_directions_dropped"] <= (2 if case == "krylov" else 0)


@pytest.mark.parametrize(
    "sequence",
    [
        [(bases.FreeFree(), Limits(n, None)) for n in (0, 6, 14, 40)],
        [(bases.CraigBampton(), Limits(n, None)) for n in (0, 6, 14, 40)],
        [(bases.CraigChang(), Limits(n, None)) for n in (0, 6, 14, 40)],
        [(bases.Krylov(expansion_points=(0.0, 2e4), moments=n), NONE) for n in (1, 2, 3, 4)],
        [(bases.Balanced(pool_modes=150), Limits(n, None)) for n in (0, 10, 25, 60)],
        [(bases.POD(), Limits(n, TOP)) for n in (0, 10, 20, 30)],
    ],
    ids=lambda s: s[0][0].kind,
)
def test_frequencies_fall_towards_those_of_the_full_model(body, full, sequence):
    """Rayleigh-Ritz on growing spaces: none below, none rises, and the first ones come close."""
    exact = full[4]
    before = None
    for options, limits in sequence:
        omega = build_basis(options, body[1], body[2], limits).omega
        assert np.all(omega >= exact[: len(omega)] * (1.0 - 1e-9))
        if before is not None:
            assert len(omega) > len(before)
            assert np.all(omega[: len(before)] <= before * (1.0 + 1e-9))
        before = omega
    assert before is not None
    excited = before[0]  # modes that no interface load excites are not in every basis: judge the lowest that is
    assert np.abs(exact / excited - 1.0).min() < 1e-4


# --- modal bases ---


@pytest.mark.parametrize("options", [bases.FreeFree(), bases.CraigBampton(), bases.CraigChang()], ids=lambda o: o.kind)
def test_all_modes_kept_is_the_full_model(options):
    mesh = box((2, 2, 3), (0.02, 0.03, 0.1))
    model, system = free_body(mesh, {"low": "rigid", "high": "rigid"})
    elastic = model.size - 6
    most = elastic if options.kind != "craig_bampton" else model.size - 12
    basis = build_basis(options, model, system, Limits(most, None))
    exact = np.sqrt(sla.eigh(model.K.toarray(), model.M.toarray(), eigvals_only=True)[6:])
    assert len(basis.omega) == elastic
    assert np.abs(basis.omega / exact - 1.0).max() < 1e-8
    with pytest.raises(InputError, match=f"{options.kind}.*{most + 1}.*more than the model has \\({most}\\)"):
        build_basis(options, model, system, Limits(most + 1, None))


def test_craig_chang_spans_the_space_of_free_free(body):
    """Same modes, same space: residual flexibility differs from the attachment modes by vibration modes."""
    _, model, system, _ = body
    one = build_basis(bases.FreeFree(), model, system, Limits(12, None))
    other = build_basis(bases.CraigChang(), model, system, Limits(12, None))
    assert np.abs(one.omega / other.omega - 1.0).max() < 1e-10
    cosines = np.linalg.svd(one.Phi.T @ (model.M @ other.Phi), compute_uv=False)
    assert np.abs(cosines - 1.0).max() < 1e-10
    assert other.facts["basis"]["static_completion"]["missing_before"] < 1e-8
    assert one.facts["basis"]["static_completion"]["missing_before"] > 0.1


def test_fixed_interface_modes_and_constraint_modes(body):
    """Against dense algebra in the null space of the interface coordinates."""
    _, model, system, _ = body
    F = system.loads
    problem = BasisProblem(model, system, NONE, attachment_modes(model, F))
    held, C, rank = hold_interfaces(problem)
    K, M = model.K.toarray(), model.M.toarray()
    Z = sla.null_space(F.T / np.linalg.norm(F, axis=0)[:, None])
    assert rank == 12 and Z.shape[1] == model.size - 12
    # constraint modes: one coordinate moves by one, the rest is at equilibrium
    assert np.allclose(F.T @ C, np.eye(12), atol=1e-9)
    assert np.abs(Z.T @ (K @ C)).max() < 1e-9 * np.abs(K @ C).max()
    # held response to any load
    f = np.random.default_rng(6).standard_normal((model.size, 3))
    exact = Z @ np.linalg.solve(Z.T @ K @ Z, Z.T @ f)
    assert np.abs(held.solve(f) - exact).max() < 1e-9 * np.abs(exact).max()
    exact = np.sqrt(sla.eigh(Z.T @ K @ Z, Z.T @ M @ Z, eigvals_only=True))[:9] / (2.0 * np.pi)
    basis = build_basis(bases.CraigBampton(), model, system, Limits(8, None))
    low, high = basis.facts["basis"]["fixed_interface_frequencies"]
    kept = basis.facts["basis"]["fixed_interface_modes"]
    assert low == pytest.approx(exact[0], rel=1e-9) and high == pytest.approx(exact[kept - 1], rel=1e-9)


def test_free_interfaces_that_share_nodes():
    """Their common loads depend on each other: dropped once, and everything stays exact."""
    model, system = free_body(two_bearing_roller(), {"left": "free", "bore": "free"})
    shared = 3 * 24
    basis = build_basis(bases.CraigBampton(), model, system, Limits(4, None))
    facts = basis.facts["basis"]
    assert facts["constraint_modes"] == system.loads.shape[1] - shared
    assert basis.facts["dependent_directions_dropped"] == shared
    A = model.flexibility(system.loads)
    static = basis.Phi @ ((basis.Phi.T @ system.loads) / (basis.omega**2)[:, None])
    assert np.abs(static - A).max() < EXACT * np.abs(A).max()


# --- moment matching ---


@pytest.fixture(scope="module")
def block():
    """A small block: model, interfaces, elastic eigenvalues, and its unit-energy interface loads on dense modes."""
    model, system = free_body(box((2, 2, 4), (0.02, 0.03, 0.1)), {"low": "rigid", "high": "average"})
    F = system.loads / np.sqrt(np.einsum("na,na->a", system.loads, model.flexibility(system.loads)))
    lam, V = sla.eigh(model.K.toarray(), model.M.toarray())
    return model, system, F, lam[6:], V[:, 6:].T @ F


def moment(lam, b, at: float, j: int) -> np.ndarray:
    """Derivative j over j! of b^T (diag(lam) - at)^-1 b with respect to `at`."""
    return b.T @ (b / ((lam - at) ** (j + 1))[:, None])


@pytest.mark.parametrize("hertz", [0.0, 6e3, 2e4])
@pytest.mark.parametrize("moments", [1, 2, 3])
def test_krylov_matches_moments(block, hertz, moments):
    """k blocks match 2 k moments, as K and M are symmetric and inputs are outputs, and not one more."""
    model, system, F, lam, b = block
    basis = build_basis(bases.Krylov(expansion_points=(hertz,), moments=moments), model, system, NONE)
    at = (2.0 * np.pi * hertz) ** 2
    errors = []
    for j in range(2 * moments + 1):
        exact = moment(lam, b, at, j)
        reduced = moment(basis.omega**2, basis.Phi.T @ F, at, j)
        errors.append(np.abs(reduced - exact).max() / np.abs(exact).max())
    assert max(errors[:-1]) < 1e-8
    if moments == 1 and hertz == 0.0:  # elsewhere the attachment modes, those of zero, make the space larger
        assert errors[-1] > 1e-5


@pytest.mark.parametrize("moments", [1, 2])
def test_krylov_error_has_the_order_of_its_moments(block, moments):
    """Error of the receptance near an expansion point at zero: order 2 k in the square of the frequency."""
    model, system, F, lam, b = block
    basis = build_basis(bases.Krylov(expansion_points=(0.0,), moments=moments), model, system, NONE)
    errors = []
    for part in (0.2, 0.1):
        at = part * (2.0 * np.pi * 1e4) ** 2
        errors.append(np.abs(moment(basis.omega**2, basis.Phi.T @ F, at, 0) - moment(lam, b, at, 0)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2 * moments, abs=0.2)


def test_krylov_on_a_natural_frequency_is_refused(body, full):
    omega = full[4]
    point = float(omega[0] / (2.0 * np.pi))
    with pytest.raises(InputError, match="expansion point .* Hz is a natural frequency.*move it"):
        build_basis(bases.Krylov(expansion_points=(point,)), body[1], body[2], NONE)


def test_shifted_solver_of_a_larger_body():
    """Above the size from which nested dissection orders the dofs; real and complex, rigid interfaces unplaced."""
    model, system = free_body(box((7, 7, 11), (0.02, 0.03, 0.1)), {"low": "rigid", "high": "average"})
    assert model.size > SMALL_SYSTEM
    f = np.random.default_rng(8).standard_normal((model.size, 2))
    shift = (2.0 * np.pi * 1.6e4) ** 2
    for K in (model.K, model.K * complex(1.0, 0.02)):
        u = shifted_solver(K, model.M, shift, system.coordinates, "test")(f)
        assert np.abs(K @ u - shift * (model.M @ u) - f).max() < 1e-9 * np.abs(f).max()


def test_krylov_default_points_follow_max_frequency(body):
    facts = build_basis(bases.Krylov(moments=1), body[1], body[2], Limits(None, TOP)).facts["basis"]
    assert facts["expansion_points"] == pytest.approx([0.0, 30e3, 60e3])


# --- balanced truncation ---


@pytest.fixture(scope="module")
def modal_system():
    """Frequencies, ratio and inputs of 15 modes, with a close pair, and its state-space matrices in (q, q')."""
    rng = np.random.default_rng(7)
    omega = np.sort(np.concatenate([rng.uniform(1.0, 30.0, 14), [12.0, 12.001]]))
    zeta = 0.03
    b = rng.standard_normal((16, 3)) / omega[:, None]
    A = np.block([[np.zeros((16, 16)), np.eye(16)], [-np.diag(omega**2), -np.diag(2 * zeta * omega)]])
    B = np.concatenate([np.zeros((16, 3)), b])
    C = np.concatenate([b, np.zeros((16, 3))]).T
    return omega, zeta, b, A, B, C


def test_closed_form_gramians_solve_the_lyapunov_equations(modal_system):
    omega, zeta, b, A, B, C = modal_system
    P = sla.solve_continuous_lyapunov(A, -B @ B.T)
    Q = sla.solve_continuous_lyapunov(A.T, -C.T @ C)
    assert np.allclose(position_gramian(omega, zeta, b), P[:16, :16], rtol=1e-9, atol=1e-12 * np.abs(P).max())
    assert np.allclose(Q[16:, 16:], P[:16, :16], atol=1e-9 * np.abs(P).max())  # why one projection serves both sides
    exact = np.sort(np.sqrt(np.abs(np.linalg.eigvals(P @ Q))))[::-1]
    assert np.allclose(hankel_values(omega, zeta, b), exact, atol=1e-9 * exact[0])


def test_first_order_truncation_keeps_below_the_bound(modal_system):
    """Classical balanced truncation, written out: the Hankel values here are those of its bound."""
    omega, zeta, b, A, B, C = modal_system
    P = sla.solve_continuous_lyapunov(A, -B @ B.T)
    Q = sla.solve_continuous_lyapunov(A.T, -C.T @ C)
    Lp, Lq = np.linalg.cholesky(P), np.linalg.cholesky(Q)
    U, s, Vt = np.linalg.svd(Lq.T @ Lp)
    hankel = hankel_values(omega, zeta, b)
    at = np.linspace(0.0, 40.0, 400)
    full = modal_receptance(at, omega, zeta, b)
    for states in (6, 12, 20):
        T = Lp @ (Vt.T[:, :states] / np.sqrt(s[:states]))
        W = Lq @ (U[:, :states] / np.sqrt(s[:states]))
        a, bb, cc = W.T @ A @ T, W.T @ B, C @ T
        reduced = np.array([cc @ np.linalg.solve(1j * w * np.eye(states) - a, bb) for w in at])
        assert np.linalg.norm(full - reduced, ord=2, axis=(1, 2)).max() <= 2.0 * hankel[states:].sum() * (1 + 1e-9)


@pytest.mark.parametrize("count", [10, 25, 40, 60])
def test_balanced_truncation_keeps_below_twice_the_sum_of_discarded_hankel_values(body, count):
    """The error as reported, and again from the reduced body itself against the pool of all its modes."""
    _, model, system, _ = body
    facts = build_basis(bases.Balanced(pool_modes=80, damping=0.02), model, system, Limits(count, None)).facts["basis"]
    assert 0.0 < facts["measured_error"] <= facts["first_order_bound"] + ROUND_OFF
    hankel = np.array(facts["hankel_values"])
    assert np.all(np.diff(hankel) <= 0.0) and hankel[0] < 1.0


def test_balanced_error_is_that_of_the_reduced_body(body):
    """Pool of all modes, whose static responses the pool then spans: the reported error is that of Phi itself."""
    model, system = free_body(box((2, 2, 3), (0.02, 0.03, 0.1)), {"low": "rigid", "high": "average"})
    zeta, elastic = 0.02, model.size - 6
    basis = build_basis(bases.Balanced(pool_modes=elastic, damping=zeta), model, system, Limits(25, None))
    omega2, V = sla.eigh(model.K.toarray(), model.M.toarray())
    omega, V = np.sqrt(omega2[6:]), V[:, 6:]
    F = system.loads / np.sqrt(np.einsum("na,na->a", system.loads, model.flexibility(system.loads)))
    D = basis.Phi.T @ (model.M @ V) * (2.0 * zeta * omega) @ (V.T @ (model.M @ basis.Phi))
    at = np.sort(np.concatenate([[0.0], omega, 0.5 * (omega[1:] + omega[:-1])]))
    full = modal_receptance(at, omega, zeta, V.T @ F)
    reduced = projected_receptance(at, D, np.diag(basis.omega**2), basis.Phi.T @ F)
    error = np.linalg.norm(full - reduced, ord=2, axis=(1, 2)).max() / np.linalg.norm(full, ord=2, axis=(1, 2)).max()
    assert basis.facts["basis"]["measured_error"] == pytest.approx(error, rel=1e-5)


def test_balanced_by_tolerance(body):
    loose, tight = (
        build_basis(bases.Balanced(tolerance=t), body[1], body[2], Limits(None, TOP)).facts["basis"]
        for t in (0.5, 1e-3)
    )
    assert loose["balanced_directions"] < tight["balanced_directions"]
    assert tight["first_order_bound"] <= 1e-3 and tight["measured_error"] <= 1e-3


# --- snapshots ---


def test_pod_reproduces_its_snapshots(body):
    """Snapshots of 12 directions and a rigid motion: 12 vectors are found and they give the snapshots back."""
    mesh, model, system, _ = body
    free = InterfaceSystem(mesh.points, [])
    rigid = rigid_modes(mesh.points, np.zeros(3)) @ np.ones((6, 30))
    X = snapshots(30, 12) + 3.0 * rigid.reshape(-1, 3, 30)
    for shape in ((180, 3, 30), (540, 30)):
        plain, _ = free_body(mesh, {})
        basis = build_basis(bases.POD(snapshots=X.reshape(shape)), plain, free, NONE)
        assert basis.facts["basis"]["pod_vectors"] == 12 and len(basis.omega) == 12
        elastic = plain.without_rigid(X.reshape(540, 30))
        again = basis.Phi @ (basis.Phi.T @ (plain.M @ elastic))
        assert np.abs(again - elastic).max() < 1e-9 * np.abs(elastic).max()
    # fewer vectors leave what the report says
    short = build_basis(bases.POD(snapshots=X), plain, free, Limits(7, None))
    rest = elastic - short.Phi @ (short.Phi.T @ (plain.M @ elastic))
    norm = [np.sqrt(np.einsum("nt,nt->", u, plain.M @ u)) for u in (rest, elastic)]
    assert short.facts["basis"]["snapshots_left_out"] == pytest.approx(norm[0] / norm[1], rel=1e-6)


def test_pod_of_default_snapshots_follows_the_receptance(body, full):
    """Between the frequencies of the snapshots too, with the damping they were taken at."""
    _, model, system, _ = body
    K, M, loads, _, _ = full
    F = loads[:, :12] / np.sqrt(np.einsum("na,na->a", system.loads, model.flexibility(system.loads)))
    basis = build_basis(bases.POD(damping=0.02), model, system, Limits(None, TOP))
    b = basis.Phi.T @ F
    R = np.asarray(model.R)
    P = F - M @ (R @ (R.T @ F))
    for hertz in (1.7e4, 3.3e4, 5.9e4):
        w2 = (2.0 * np.pi * hertz) ** 2
        exact = P.T @ np.linalg.solve(K * (1.0 + 0.04j) - w2 * M, P)
        reduced = b.T @ (b / (basis.omega**2 * (1.0 + 0.04j) - w2)[:, None])
        assert np.abs(reduced - exact).max() < 1e-3 * np.abs(exact).max()


# --- options and bad input ---


def test_options_describe_themselves():
    a, b = (bases.POD(snapshots=snapshots(4, k)).describe() for k in (2, 3))
    assert a["kind"] == "pod" and a["snapshots"]["shape"] == [540, 4] and a != b
    assert bases.Krylov(expansion_points=(0, 2e3)).describe()["expansion_points"] == [0.0, 2e3]
    assert bases.basis_options("krylov") == bases.Krylov()
    assert bases.basis_options(bases.FreeFree()) == bases.FreeFree()


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: bases.basis_options("guyan"), "basis 'guyan' does not exist; known: 'free_free', 'craig_bampton'"),
        (lambda: bases.basis_options(3), "basis 3 does not exist"),
        (lambda: bases.FreeFree(dependent_tolerance=0.0), "'free_free': dependent_tolerance must be greater"),
        (lambda: bases.Krylov(moments=0), "'krylov': moments must be a whole number of at least 1"),
        (lambda: bases.Krylov(expansion_points=()), "must be distinct, and at least one"),
        (lambda: bases.Krylov(expansion_points=(1.0, 1.0)), "must be distinct"),
        (lambda: bases.Krylov(expansion_points=(-1.0,)), "expansion point"),
        (lambda: bases.Balanced(damping=1.5), "'balanced': damping must be below 1"),
        (lambda: bases.Balanced(pool_modes=0), "pool_modes"),
        (lambda: bases.POD(snapshots=np.zeros((4, 5))), r"shape \(nodes, 3, t\).*\(4, 5\)"),
        (lambda: bases.POD(snapshots=np.full((6, 2), np.nan)), "NaN"),
        (lambda: bases.POD(snapshots=np.ones((6, 2)), frequencies=(1.0,)), "frequencies are not used"),
        (lambda: bases.POD(frequencies=()), "frequencies are empty"),
        (lambda: bases.Krylov().check_limits(None, 5), "'krylov' does not use modes; .*moments"),
        (lambda: bases.Krylov(expansion_points=(0,)).check_limits(1e3, None), "max_frequency only sets default"),
        (lambda: bases.Balanced(pool_modes=9).check_limits(1e3, None), "both set the pool"),
        (lambda: bases.POD().check_limits(None, 3), "give bases.POD"),
        (lambda: bases.POD(frequencies=(1.0,)).check_limits(1e3, None), "leave it out"),
        (lambda: bases.basis_options("trial_vector_derivatives"), "first must name a facet set; give bases.Trial"),
        (lambda: bases.TrialVectorDerivatives(first="a", second="a"), "first and second are both 'a'"),
        (lambda: bases.TrialVectorDerivatives(first="a", second="b", normal=-1), "normal must be a whole number"),
    ],
)
def test_bad_options_name_the_thing(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize("kind", ["craig_bampton", "krylov", "balanced", "pod"])
def test_bases_of_interface_loads_need_interfaces(kind):
    mesh = box((2, 1, 2), (0.02, 0.03, 0.1))
    model, system = free_body(mesh, {})
    with pytest.raises(InputError, match=f"basis '{kind}' is built from loads on interfaces.*'free_free'"):
        build_basis(bases.basis_options(kind), model, system, Limits(None, TOP))


@pytest.mark.parametrize(
    "options, limits, message",
    [
        (bases.FreeFree(), Limits(1000, None), "1000 vibration modes are more"),
        (bases.Krylov(moments=40), NONE, "480 Krylov vectors are more"),
        (bases.Balanced(), Limits(500, None), "500 balanced directions"),
        (bases.Balanced(pool_modes=600), NONE, "600 vibration modes in the pool"),
        (bases.POD(frequencies=(1e3,)), Limits(500, None), "500 POD vectors"),
        (bases.POD(snapshots=snapshots(4, 2, 90)), NONE, "of 90 nodes, the mesh has 180"),
    ],
)
def test_bases_larger_than_the_model_are_refused(body, options, limits, message):
    with pytest.raises(InputError, match=message):
        build_basis(options, body[1], body[2], limits)


def test_snapshots_of_rigid_motion_alone_are_refused(body):
    rigid = rigid_modes(body[0].points, np.zeros(3))
    with pytest.raises(InputError, match="rigid motion only"):
        build_basis(bases.POD(snapshots=rigid), body[1], body[2], NONE)
