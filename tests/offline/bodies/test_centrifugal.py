"""Attachment modes of turning: against a full FE solution, on both paths, and against the closed form of a disc."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from interface_bodies import box, free_body
from offline_bodies import STEEL, reduced
from reference_fe import free_response, matrices

from scenes.flat_settings import reduce_flat
from scenes.rotating_disc import INNER, OUTER, THICKNESS, closed_form
from scenes.rotating_disc import STEEL as DISC_STEEL
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import PRODUCTS, modal_forces
from warpffrf.offline import ReductionOptions, bases, reduce
from warpffrf.offline.bases.build import build_basis
from warpffrf.offline.bases.modes import attachment_modes
from warpffrf.offline.cyclic.harmonics import Harmonics
from warpffrf.offline.cyclic.inertia import turning_waves
from warpffrf.offline.cyclic.path import axes_of
from warpffrf.offline.cyclic.sector import assemble_sector
from warpffrf.offline.fe import assemble, assign
from warpffrf.offline.inertia.invariants import (
    BEYOND,
    TurningResponse,
    centrifugal_acceleration,
    covering_turning,
    left_out,
)
from warpffrf.offline.products import Limits

EXACT = 1e-8  # what the product promises
SINGLE = 2e-7  # the display modes are stored in single precision
AGREE = 1e-9  # both paths
SECTORS = (3, 4, 5, 9)  # harmonics 1 and 2 coincide, 2 is N/2, odd, many
SPINS = np.random.default_rng(3).standard_normal((4, 3)) * 100.0  # rad/s


def free_of_contact(mesh: Mesh, **settings) -> ReducedBody:
    return reduced(mesh, **{"contact": {}, "modes": 4, **settings})


def steady(body: ReducedBody, w: np.ndarray) -> np.ndarray:
    """Modal coordinates (m,) [m] in steady turning, by the equations of motion of the modes without J2."""
    terms = body.inertia_terms
    assert terms is not None
    rest = np.zeros(len(body.frequencies))
    return -modal_forces(terms, rest, rest, w, np.zeros(3)) / (2.0 * np.pi * body.frequencies) ** 2


def deformed(body: ReducedBody, w: np.ndarray) -> np.ndarray:
    """Display points' displacement (n, 3) [m] in steady turning."""
    return np.tensordot(steady(body, w), body.surface.modes.astype(float), 1)


def full_response(mesh: Mesh, w: np.ndarray, bore: bool) -> np.ndarray:
    """Displacement (n, 3) of all nodes by the dense model of scikit-fem, the bore rigid or not there."""
    K, M = matrices(mesh, STEEL)
    held = mesh.facets("bore").node_set if bore else np.zeros(0, int)
    free = np.setdiff1d(np.arange(len(mesh.points)), held)
    T = np.zeros((3 * len(mesh.points), 3 * len(free) + 6 * bore))
    T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    R = rigid_modes(mesh.points[free], np.zeros(3))
    if bore:
        T[(3 * held[:, None] + np.arange(3)).ravel(), 3 * len(free) :] = rigid_modes(mesh.points[held], np.zeros(3))
        R = np.concatenate([R, np.eye(6)])
    load = M @ (-np.cross(w, np.cross(w, mesh.points))).ravel()  # the centre of mass is the origin
    return (T @ free_response(T.T @ K @ T, T.T @ M @ T, R, (T.T @ load)[:, None])).reshape(-1, 3)


def on_skin(body: ReducedBody, mesh: Mesh) -> np.ndarray:
    place = {tuple(np.round(x, 9) + 0.0): i for i, x in enumerate(mesh.points)}
    return np.array([place[tuple(np.round(x, 9) + 0.0)] for x in body.surface.points])


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("bore", [True, False])
def test_static_response_to_turning_is_exact(small_roller, general, bore):
    interfaces = {"bore": "rigid"} if bore else {}
    settings = {"interfaces": interfaces, "general": general}
    body, plain = (free_of_contact(small_roller, centrifugal=c, **settings) for c in (True, False))
    nodes = on_skin(body, small_roller)
    held = small_roller.facets("bore").node_set
    for w in (*SPINS, *(100.0 * np.eye(3))):
        whole = full_response(small_roller, w, bore)
        exact = whole[nodes]
        if bore:  # in double precision; rotations times the radius
            rigid = rigid_modes(small_roller.points[held], np.zeros(3))
            motion = np.linalg.lstsq(rigid, whole[held].ravel(), rcond=None)[0]
            miss = steady(body, w) @ body.interfaces["bore"].modes - motion
            assert np.abs(miss * [1.0, 1.0, 1.0, 0.015, 0.015, 0.015]).max() < EXACT * np.abs(whole).max()
        assert np.abs(deformed(body, w) - exact).max() < SINGLE * np.abs(exact).max()
        assert np.abs(deformed(plain, w) - exact).max() > 0.1 * np.abs(exact).max()  # what it is without


CASES = {
    "free_free": (bases.FreeFree(), Limits(5, None)),
    "craig_bampton": (bases.CraigBampton(), Limits(5, None)),
    "craig_chang": (bases.CraigChang(), Limits(5, None)),
    "krylov": (bases.Krylov(moments=1), Limits(None, None)),
    "balanced": (bases.Balanced(pool_modes=20), Limits(5, None)),
    "pod": (bases.POD(frequencies=(0.0, 1e3)), Limits(5, None)),
}


@pytest.mark.parametrize("case", CASES)
def test_every_basis_takes_the_loads_of_turning(case):
    """In double precision: response of the modes alone against the dense saddle point, and what else they promise."""
    mesh = box((2, 2, 4), (0.03, 0.05, 0.08))
    model, system = free_body(mesh, {"low": "rigid", "high": "average"})
    _, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    F = np.asarray(system.T.T @ (M @ centrifugal_acceleration(mesh.points, mesh.points.mean(axis=0))))
    options, limits = CASES[case]
    plain, basis = (build_basis(options, model, system, limits, turning) for turning in (None, F))
    omega, Phi = basis.omega, basis.Phi
    both = np.concatenate([system.loads, F], axis=1)
    exact = free_response(model.K.toarray(), model.M.toarray(), system.rigid(np.zeros(3)), both)
    found = Phi @ ((Phi.T @ both) / (omega**2)[:, None])
    assert np.all(np.abs(found - exact).max(axis=0) < EXACT * np.abs(exact).max(axis=0))
    assert np.abs(Phi.T @ (model.M @ Phi) - np.eye(len(omega))).max() < 1e-11
    assert np.abs((Phi / omega).T @ (model.K @ (Phi / omega)) - np.eye(len(omega))).max() < 1e-11
    assert len(omega) == len(plain.omega) + 6
    assert np.all(omega[: len(plain.omega)] <= plain.omega * (1.0 + EXACT))  # a larger space: from above


def test_frequencies_stay_above_those_of_the_full_model(small_roller):
    exact = reduced(small_roller, contact={}, modes=60, interfaces={}).frequencies
    body = free_of_contact(small_roller, interfaces={}, centrifugal=True)
    assert np.all(body.frequencies[:4] == pytest.approx(exact[:4], rel=1e-9))
    assert np.all(body.frequencies[:60] >= exact[: len(body.frequencies)] * (1.0 - 1e-9))


@pytest.mark.parametrize("sectors", SECTORS)
@pytest.mark.parametrize("swirl", [0.0, 8.0], ids=["mirrored", "not mirrored"])
def test_both_paths_agree(sectors, swirl):
    """Frequencies, inertia terms through what does not depend on the choice within pairs, and the figure left out."""
    mesh = roller(0.05, 0.015, 0.02, sectors=sectors, layers=1, axial=2, order=2)
    x = mesh.points
    angle = swirl * (np.hypot(x[:, 0], x[:, 2]) - 0.05)  # rad, turns the inner nodes: no plane is one of symmetry
    c, s = np.cos(angle), np.sin(angle)
    turned = np.stack([c * x[:, 0] + s * x[:, 2], x[:, 1], c * x[:, 2] - s * x[:, 0]], axis=1)
    mesh = Mesh(turned, mesh.cells, mesh.facet_sets, mesh.cyclic)
    for centrifugal in (True, False):
        cyclic, general = (free_of_contact(mesh, centrifugal=centrifugal, general=g) for g in (False, True))
        assert (cyclic.report["path"], general.report["path"]) == ("cyclic", "general")
        assert cyclic.report["harmonics"] == ("complex" if swirl else "real")
        assert cyclic.frequencies == pytest.approx(general.frequencies, rel=AGREE)
        a, b = cyclic.inertia_terms, general.inertia_terms
        assert a is not None and b is not None
        p, q = (
            np.einsum("iab,i,icd->abcd", t.first, g.frequencies**-4.0, t.first) for t, g in ((a, cyclic), (b, general))
        )
        assert np.abs(p - q).max() < AGREE * np.abs(q).max()
        assert cyclic.report["inertia"]["centrifugal"] is centrifugal
        missing = [g.report["inertia"]["centrifugal_left_out"] for g in (cyclic, general)]
        if centrifugal:
            scale = free_of_contact(mesh, inertia_modes=0).report["inertia"]["centrifugal_left_out"]
            assert max(missing) < 1e-7 * scale  # the root of the round-off of a Gram matrix
        else:
            assert missing[0] == pytest.approx(missing[1], rel=1e-7)


@pytest.mark.parametrize("sectors", SECTORS)
def test_waves_make_the_loads_of_the_whole_body(sectors):
    """On every sector the real part of waves times phases is M times the acceleration of each product."""
    mesh = roller(0.05, 0.015, 0.02, sectors=sectors, layers=1, axial=1, order=2)
    sector = assemble_sector(mesh, assign(mesh, STEEL), axes_of(mesh))
    harmonics = Harmonics(sector, [])
    _, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    found = np.zeros((sectors, 3 * sector.nodes, 6))
    for k in range(sectors // 2 + 1):
        waves = turning_waves(harmonics, k, 0.0)
        assert waves.loads.shape[1] == len(waves.weights)
        assert np.isrealobj(waves.loads)  # these sectors are their own mirror images
        u = harmonics.waves.basis(k) @ (waves.loads @ waves.weights)
        found += np.real(np.exp(2j * np.pi * k * np.arange(sectors) / sectors)[:, None, None] * u)
    own = np.einsum("ni,ia->na", mesh.points - sector.origin, sector.axes)  # in the axes of sector 0
    exact = np.asarray(sp.csr_matrix(M) @ centrifugal_acceleration(own, np.zeros(3))).reshape(sectors, -1, 3, 6)
    a = 2.0 * np.pi * np.arange(sectors) / sectors
    turn = np.array([[np.cos(a), np.sin(a), 0 * a], [-np.sin(a), np.cos(a), 0 * a], [0 * a, 0 * a, 1 + 0 * a]])
    exact = np.einsum("ijs,snjp->snip", turn, exact).reshape(found.shape)
    assert np.abs(found - exact).max() < 1e-11 * np.abs(exact).max()


# --- a disc in plane stress ---


def disc(**settings) -> ReducedBody:
    mesh = roller(OUTER, INNER, THICKNESS, sectors=24, layers=6, axial=1, grading=1.0, order=2)
    given = {"interfaces": {}, "contact": {}, "modes": 10, "cache": False, "progress": False}
    return reduce_flat(mesh, DISC_STEEL, **{**given, **settings})


def radial(body: ReducedBody, r: float, speed: float) -> float:
    """Mean radial displacement [m] at the radius r of a disc that turns about y."""
    x = body.surface.points
    u = deformed(body, np.array([0.0, speed, 0.0]))
    at = np.isclose(np.hypot(x[:, 0], x[:, 2]), r)
    return float(np.mean((u[at, 0] * x[at, 0] + u[at, 2] * x[at, 2]) / r))


# order (thickness/radius)^2 = 4e-4 of plane stress, and 6 quadratic layers; the bore is the worst
PLANE = 2e-3


@pytest.mark.parametrize("path", [{}, {"periodic": False}], ids=["cyclic", "general"])
def test_a_disc_grows_as_in_plane_stress(path):
    speed = 1000.0
    grown, plain = disc(centrifugal=True, **path), disc(**path)
    exact = closed_form(np.array([INNER, OUTER]), speed)[0]
    assert [radial(grown, r, speed) for r in (INNER, OUTER)] == pytest.approx(list(exact), rel=PLANE)
    assert abs(radial(plain, OUTER, speed)) < 1e-6 * exact[1]  # no vibration mode breathes
    # all is left out, and known to be: a bound of the displacement over the radius of gyration
    J0 = plain.inertia
    r = np.linspace(INNER, OUTER, 2001)
    u = closed_form(r, speed)[0]
    rms = np.sqrt(np.trapezoid(u**2 * r, r) / np.trapezoid(r, r) * plain.mass / (0.5 * np.trace(J0)))
    bound = speed**2 * plain.report["inertia"]["centrifugal_left_out"]
    assert rms * (1.0 - PLANE) < bound < 2.0 * rms
    assert grown.report["inertia"]["centrifugal_left_out"] < 1e-6 * plain.report["inertia"]["centrifugal_left_out"]


# --- which modes get inertia terms ---


def test_inertia_terms_reach_the_modes_that_hold_the_response(small_roller):
    """Beyond the usual number where it is left out; a number that cuts them off is kept, and reported."""
    whole = free_of_contact(small_roller, modes=100, centrifugal=True)
    assert 60 < whole.report["inertia"]["modes"] <= len(whole.frequencies)
    assert any("so that they contain the response to rotation" in note for note in whole.report["notes"])
    cut = free_of_contact(small_roller, modes=100, centrifugal=True, inertia_modes=6)
    usual = free_of_contact(small_roller, modes=100)
    assert cut.report["inertia"]["modes"] < 10 and usual.report["inertia"]["modes"] < 70
    none = free_of_contact(small_roller, modes=100, inertia_modes=0).report["inertia"]["centrifugal_left_out"]
    w = np.array([0.0, 1.0, 0.0])
    exact = full_response(small_roller, w, True)[on_skin(whole, small_roller)]
    assert np.abs(deformed(whole, w) - exact).max() < 2.0 * BEYOND * np.abs(exact).max()
    assert (
        whole.report["inertia"]["centrifugal_left_out"]
        <= BEYOND * none
        < usual.report["inertia"]["centrifugal_left_out"]
    )
    assert cut.report["inertia"]["centrifugal_left_out"] > 0.5 * none


def test_what_is_left_out_is_the_response_less_that_of_the_modes():
    """S by its definition, and its bound over random directions of turning."""
    mesh = box((2, 2, 3), (0.03, 0.05, 0.08))
    model, system = free_body(mesh, {})
    _, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    center = mesh.points.mean(axis=0)
    F = np.asarray(M @ centrifugal_acceleration(mesh.points, center))
    basis = build_basis(bases.FreeFree(), model, system, Limits(9, None))
    omega, Phi = basis.omega, basis.Phi
    u = attachment_modes(model, F)
    response = TurningResponse.of(model.M, F, u, omega, Phi)
    inertia = np.diag([1e-3, 2e-3, 2.5e-3])
    for kept in (0, 4, 9):
        lacking = u - Phi[:, :kept] @ ((Phi[:, :kept].T @ F) / (omega[:kept] ** 2)[:, None])
        S = response.beyond(omega[kept - 1] if kept else 0.0)
        assert np.abs(S - lacking.T @ (model.M @ lacking)).max() < 1e-10 * np.abs(S).max()
        bound = left_out(S, inertia) ** 2 * 0.5 * np.trace(inertia)
        w = np.random.default_rng(1).standard_normal((400, 3))
        w /= np.linalg.norm(w, axis=1)[:, None]
        products = np.stack([w[:, a] * w[:, b] for a, b in PRODUCTS], axis=1)
        sizes = np.einsum("tp,pq,tq->t", products, S, products)
        assert 0.5 * bound < sizes.max() <= bound * (1.0 + 1e-9)


def test_modes_counted_for_turning():
    """By hand: responses of 1, 1, 0.02 and 0.005 in modes that share no mass, two of them a pair."""
    omega = np.array([1.0, 2.0, 3.0, 3.0, 4.0])
    parts = np.array([1.0, 1.0, 0.0, 0.02, 0.005])

    def lacking(limit: float) -> float:
        return float(np.linalg.norm(parts[omega > limit]))

    assert [covering_turning(omega, least, lacking) for least in (0, 2, 4, 5)] == [4, 4, 4, 5]
    assert covering_turning(omega[:2], 0, lambda limit: 1.0) == 2


def test_option_is_checked_and_known(small_roller):
    with pytest.raises(InputError, match="centrifugal must be True or False"):
        reduce(small_roller, STEEL, options=ReductionOptions(centrifugal=1))  # type: ignore[arg-type]
    body = free_of_contact(small_roller, centrifugal=True)
    assert body.provenance["settings"]["options"]["centrifugal"] is True
    assert body.provenance["key"] != free_of_contact(small_roller).provenance["key"]
