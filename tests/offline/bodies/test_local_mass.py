"""Dynamic local modes of rollers against full finite-element models: nothing but the loads is shared.

Full models are assembled by scikit-fem, dense, with the bore made rigid by a dense constraint. Responses are those of
the elastic part: rigid motion is M-orthogonal to it and the same in both.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.linalg as sla
from offline_bodies import STEEL, reduced
from reference_fe import matrices

import warpffrf.offline.general.unit_loads as unit_loads
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.model.reduced.local_modes import dynamic_modes
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline.contact.node_loads import NORMAL, ContactFacets, TractionField
from warpffrf.offline.products import resolve_shapes

EXACT = 1e-8  # what the product promises of static responses
AGREE = 1e-9  # of the largest entry, between the paths
ORTHONORMAL = 1e-10
SINGLE = 2e-6  # the display transfer is stored in single precision
LOSS = 0.01  # structural loss factor of frequency responses: resonances stay finite


@dataclass
class FullModel:
    """omega (n,), elastic modes V (3 nodes, n) of all nodes, loads B of the nodes (3 nodes, nodes), and their field."""

    omega: np.ndarray
    V: np.ndarray
    B: np.ndarray
    field: TractionField
    M: np.ndarray

    @property
    def trace(self):
        """Hat coefficients of the modes' normal displacement."""
        return self.field.without_gram(self.B.T @ self.V)


def full_model(mesh, interface=("bore",)):
    K, M = matrices(mesh, STEEL)
    points = mesh.points
    held = np.unique(np.concatenate([mesh.facets(name).node_set for name in interface] or [np.zeros(0, int)]))
    free = np.setdiff1d(np.arange(len(points)), held)
    T = np.zeros((3 * len(points), 3 * len(free) + 6 * len(interface)))
    T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    for i, name in enumerate(interface):
        nodes = mesh.facets(name).node_set
        at = 3 * len(free) + 6 * i
        T[(3 * nodes[:, None] + np.arange(3)).ravel(), at : at + 6] = rigid_modes(points[nodes], np.zeros(3))
    omega2, V = sla.eigh(T.T @ K @ T, T.T @ M @ T)
    shape = resolve_shapes(mesh, {"rim": Cylinder()})["rim"]
    facets = ContactFacets.of(points, mesh.facets("rim"), shape)
    field = TractionField("nodes", NORMAL, facets.plan("rim", None), facets)
    B = field.loads(len(points)).toarray()
    return FullModel(np.sqrt(omega2[6:]), T @ V[:, 6:], B, field, M)


@pytest.fixture(scope="module")
def full(small_roller):
    return full_model(small_roller)


def mass_of(s) -> LocalMass:
    """The mass of a surface's local modes, which must be there."""
    assert s.local_mass is not None
    return s.local_mass


def operator(s, lags):
    """A block-circulant operator of a surface as one matrix."""
    return replace(s, lags=lags).compliance(np.arange(s.grid.columns))


def relative(a, b) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("modes", [0, 5, 50])
def test_mass_of_the_residual_responses(small_roller, full, modes, general):
    """N = U^T M U of responses that the full model gives by its modes, less the reduced body's global part."""
    body = reduced(small_roller, modes=modes, general=general, local_dynamics=True)
    s = body.contact_surfaces["rim"]
    on_modes = full.trace  # (nodes, n)
    flexible = on_modes / full.omega**2  # U = V flexible^T without deflation: M-products are sums over V
    omega, shapes = global_modes(body, small_roller, full)
    participation = full.field.without_gram(full.B.T @ shapes)
    coordinates = full.V.T @ full.M @ shapes  # of the global modes in V: the mesh's mass, no sampling
    residual = flexible.T - coordinates @ (participation / omega**2).T
    mass = mass_of(s)
    assert relative(operator(s, mass.lags_mass), residual.T @ residual) < EXACT
    scale = np.sqrt(np.abs(residual.T @ residual).max())
    assert np.abs(mass.overlap @ mass.overlap.T - rank_part(residual, coordinates)).max() < EXACT * scale**2


def rank_part(residual, coordinates):
    W = residual.T @ coordinates
    return W @ W.T


def global_modes(body, mesh, full):
    """Global modes of the full model's own making: vibration modes and the interface's static responses."""
    bore = mesh.facets("bore").node_set
    R = rigid_modes(mesh.points[bore], np.zeros(3))
    motion = np.linalg.lstsq(R, full.V.reshape(-1, 3, full.V.shape[1])[bore].reshape(len(R), -1), rcond=None)[0]
    attached = motion.T / full.omega[:, None] ** 2  # coordinates in V
    count = len(body.frequencies) - attached.shape[1]
    Q = np.concatenate([np.eye(len(full.omega))[:, :count], attached / np.abs(attached).max(axis=0)], axis=1)
    Q = np.linalg.qr(Q)[0]
    omega2, Y = np.linalg.eigh(Q.T @ (full.omega[:, None] ** 2 * Q))
    return np.sqrt(omega2), full.V @ (Q @ Y)


@pytest.mark.parametrize("modes", [0, 5, 60])
def test_both_paths_agree(small_roller, modes):
    bodies = [reduced(small_roller, modes=modes, general=g, local_dynamics=True) for g in (False, True)]
    assert [b.report["path"] for b in bodies] == ["cyclic", "general"]
    a, b = (body.contact_surfaces["rim"] for body in bodies)
    assert relative(operator(a, mass_of(a).lags_mass), mass_of(b).lags_mass[0]) < AGREE
    W, V = mass_of(a).overlap, mass_of(b).overlap
    assert relative(W @ W.T, V @ V.T) < AGREE
    p, q = dynamic_modes(a), dynamic_modes(b)
    assert p.omega == pytest.approx(q.omega, rel=AGREE)
    p, q = dynamic_modes(a, count=20), dynamic_modes(b, count=20)
    assert relative(operator(a, p.residual_lags), q.residual_lags[0]) < AGREE
    assert relative(p.trace @ p.trace.T, q.trace @ q.trace.T) < AGREE


def test_two_planes_a_sector(curved_roller):
    bodies = [reduced(curved_roller, modes=8, general=g, local_dynamics=True) for g in (False, True)]
    a, b = (body.contact_surfaces["rim"] for body in bodies)
    assert relative(operator(a, mass_of(a).lags_mass), mass_of(b).lags_mass[0]) < AGREE
    p, q = dynamic_modes(a, count=12), dynamic_modes(b, count=12)
    assert p.omega == pytest.approx(q.omega, rel=AGREE)
    assert relative(operator(a, p.residual_lags), q.residual_lags[0]) < AGREE


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("modes", [0, 5, 50])
@pytest.mark.parametrize("limits", [{"count": 0}, {"count": 3}, {"max_frequency": 60e3}, {"count": 30}, {}])
def test_static_response_is_exact_at_any_cut(small_roller, full, modes, general, limits):
    body = reduced(small_roller, modes=modes, general=general, local_dynamics=True)
    s = body.contact_surfaces["rim"]
    local = dynamic_modes(s, **limits)
    forces = np.random.default_rng(modes).standard_normal((s.local_modes, 3))
    forces[:, 0] = np.eye(s.local_modes)[4]
    u = s.mode_normal @ (s.mode_normal.T @ forces / (2.0 * np.pi * body.frequencies[:, None]) ** 2)
    u += local.trace @ (local.trace.T @ forces / local.omega[:, None] ** 2)
    u += operator(s, local.residual_lags) @ forces
    exact = full.trace @ (full.trace.T @ forces / full.omega[:, None] ** 2)
    assert np.abs(u - exact).max() < EXACT * np.abs(exact).max()


@pytest.mark.parametrize("general", [False, True])
def test_modes_are_orthonormal(small_roller, general):
    body = reduced(small_roller, modes=5, general=general, local_dynamics=True)
    s = body.contact_surfaces["rim"]
    local = dynamic_modes(s)
    mass = local.shape.T @ operator(s, mass_of(s).lags_mass) @ local.shape
    assert np.abs(mass - np.eye(len(local.omega))).max() < ORTHONORMAL
    assert np.abs(mass_of(s).overlap.T @ local.shape).max() < ORTHONORMAL
    assert local.held == 5  # of six attachment modes the one of torsion is not met by normal loads
    assert local.dropped == 0


def test_modes_of_the_full_model_are_met_from_above(small_roller, full):
    """Global and local frequencies together, with more and more global modes: from above, and nearer each time."""
    above = []
    for modes in (0, 5, 20, 50):
        body = reduced(small_roller, modes=modes, local_dynamics=True)
        local = dynamic_modes(body.contact_surfaces["rim"])
        together = np.sort(np.concatenate([2.0 * np.pi * body.frequencies, local.omega]))
        ratio = together / full.omega[: len(together)]
        assert ratio.min() > 1.0 - AGREE
        above.append(ratio[:40].max())
    assert np.all(np.diff(above) < 0.0)


def response(trace, omega, w, force):
    return (trace / (omega**2 * (1.0 + 1j * LOSS) - w**2)) @ (trace.T @ force)


@pytest.mark.parametrize(("modes", "gain"), [(5, 2.0), (20, 3.0), (50, 5.0)])
def test_surface_under_a_harmonic_pressure(small_roller, full, modes, gain):
    """Up to nine tenths of the first frequency that no global mode has, dynamic local modes are nearer to the full
    model than quasi-static ones at every frequency, by a factor `gain` at half of it."""
    body = reduced(small_roller, modes=modes, local_dynamics=True)
    s = body.contact_surfaces["rim"]
    omega = 2.0 * np.pi * body.frequencies
    local = dynamic_modes(s)
    D, rest = operator(s, s.lags), operator(s, local.residual_lags)
    force = np.eye(s.local_modes)[4]
    first = full.omega[modes] if modes else full.omega[0]
    errors = {}
    for part in (0.3, 0.5, 0.7, 0.9):
        w = part * first
        exact = response(full.trace, full.omega, w, force)
        slow = response(s.mode_normal, omega, w, force)
        static = slow + D @ force / (1.0 + 1j * LOSS)
        dynamic = slow + response(local.trace, local.omega, w, force) + rest @ force / (1.0 + 1j * LOSS)
        errors[part] = [np.linalg.norm(u - exact) / np.linalg.norm(exact) for u in (static, dynamic)]
        assert errors[part][1] < errors[part][0]
    assert errors[0.5][0] > gain * errors[0.5][1]


def test_slow_loads_need_no_local_dynamics(small_roller):
    """The difference between dynamic and quasi-static local modes falls with the square of the frequency."""
    s = reduced(small_roller, modes=5, local_dynamics=True).contact_surfaces["rim"]
    local = dynamic_modes(s)
    force = np.eye(s.local_modes)[4]

    def beyond(w):
        quick = response(local.trace, local.omega, w, force)
        return np.linalg.norm(quick - local.trace @ (local.trace.T @ force / local.omega**2) / (1.0 + 1j * LOSS))

    rate = np.log2(beyond(0.02 * local.omega[0]) / beyond(0.01 * local.omega[0]))
    assert rate == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize("general", [False, True])
def test_kept_modes_are_recovered_by_their_node_forces(small_roller, full, general):
    """Displacement of dynamic modes on the skin, and the bore, which they leave alone."""
    body = reduced(small_roller, modes=5, general=general, local_dynamics=True)
    s = body.contact_surfaces["rim"]
    local = dynamic_modes(s, count=10)
    q = np.random.default_rng(4).standard_normal(len(local.omega))
    found = s.recover(local.equivalent_forces(np.zeros((s.grid.columns, s.grid.rows)), q))
    forces = local.shape @ q
    omega, shapes = global_modes(body, small_roller, full)
    u = full.V @ (full.trace.T @ forces / full.omega**2)
    u -= shapes @ (full.field.without_gram(full.B.T @ shapes).T @ forces / omega**2)
    place = {tuple(np.round(x, 9)): i for i, x in enumerate(small_roller.points)}
    nodes = np.array([place[tuple(np.round(x, 9))] for x in body.surface.points])
    exact = u.reshape(-1, 3)
    assert np.abs(found - exact[nodes]).max() < SINGLE * np.abs(forces).sum() * np.abs(s.lags).max()
    assert np.abs(exact[small_roller.facets("bore").node_set]).max() < EXACT * np.abs(exact).max()


@pytest.mark.parametrize("spacing", [0.04, 0.0175])
def test_other_grids(small_roller, spacing):
    """A grid coarser than the sectors, on both paths (16 of 18 columns' spacing is rounded to what divides a turn)."""
    given = {"modes": 5, "spacing": spacing, "local_dynamics": True}
    a = reduced(small_roller, **given).contact_surfaces["rim"]
    local = dynamic_modes(a, count=6)
    mass = local.shape.T @ operator(a, mass_of(a).lags_mass) @ local.shape
    assert np.abs(mass - np.eye(len(local.omega))).max() < ORTHONORMAL
    b = reduced(small_roller, general=True, **given).contact_surfaces["rim"]
    if a.grid.columns == b.grid.columns:
        assert relative(operator(a, mass_of(a).lags_mass), mass_of(b).lags_mass[0]) < AGREE


@pytest.mark.parametrize("general", [False, True])
def test_surface_on_an_arc(general):
    """Facets on part of the turn: static exactness and trace of the columns that there are."""
    mesh = roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=2, order=1)
    arc = mesh.select("pad", "rim", lambda c: (c[:, 0] > 0.02) & (np.abs(c[:, 2]) < 0.03))
    body = reduced(arc, general=general, contact={"pad": Cylinder()}, modes=5, local_dynamics=True)
    assert body.report["path"] == ("general" if general else "cyclic")
    s = body.contact_surfaces["pad"]
    local = dynamic_modes(s, count=8)
    columns = np.arange(s.grid.columns)
    rest = replace(s, lags=local.residual_lags).compliance(columns)
    D = s.compliance(columns)
    assert relative((local.trace / local.omega**2) @ local.trace.T + rest, D) < ORTHONORMAL
    forces = np.random.default_rng(6).standard_normal((s.grid.columns, s.grid.rows))
    q = local.trace.T @ forces.ravel() / local.omega**2
    at_rest = s.recover(local.equivalent_forces(forces, q))
    assert relative(at_rest, s.recover(forces)) < SINGLE


def test_given_matrices(small_roller, steel):
    """K and M as matrices, without cells: the same inertia."""
    from warpffrf.model import mesh as meshes

    K, M = matrices(small_roller, steel)
    given = meshes.from_matrices(
        M, K, small_roller.points, facets={n: f.blocks for n, f in small_roller.facet_sets.items()}
    )
    a = reduced(given, modes=5, local_dynamics=True).contact_surfaces["rim"]
    b = reduced(small_roller, modes=5, general=True, local_dynamics=True).contact_surfaces["rim"]
    assert relative(mass_of(a).lags_mass, mass_of(b).lags_mass) < AGREE


def test_file_keeps_the_mass(small_roller, tmp_path):
    body = reduced(small_roller, modes=5, local_dynamics=True)
    again = ReducedBody.load(body.save(tmp_path / "body.h5"))
    a, b = (mass_of(x.contact_surfaces["rim"]) for x in (body, again))
    assert np.array_equal(a.lags_mass, b.lags_mass) and np.array_equal(a.overlap, b.overlap)
    assert again.content_hash() == body.content_hash()
    plain = reduced(small_roller, modes=5)
    assert ReducedBody.load(plain.save(tmp_path / "plain.h5")).contact_surfaces["rim"].local_mass is None


def test_it_is_computed_only_when_asked_for(small_roller):
    with_mass, plain = (reduced(small_roller, modes=5, local_dynamics=wanted) for wanted in (True, False))
    a, b = with_mass.contact_surfaces["rim"], plain.contact_surfaces["rim"]
    assert b.local_mass is None
    assert np.array_equal(a.lags, b.lags)
    assert with_mass.provenance["key"] != plain.provenance["key"]


def test_blocks_and_resumed_runs_give_the_same_mass(small_roller, tmp_path, monkeypatch):
    """A run stopped between two blocks goes on with the same bits; the size of blocks changes round-off only."""
    monkeypatch.setenv("WARPFFRF_CACHE", str(tmp_path))
    monkeypatch.setattr(unit_loads, "worker_count", lambda: 1)
    given = {"modes": 5, "general": True, "local_dynamics": True, "tangential": True}
    whole = reduced(small_roller, **given).contact_surfaces["rim"]
    monkeypatch.setattr(unit_loads, "BLOCK", 16)  # the fourth block holds the last normal loads and tangential ones
    small = reduced(small_roller, **given).contact_surfaces["rim"]
    assert relative(mass_of(small).lags_mass, mass_of(whole).lags_mass) < AGREE
    assert relative(mass_of(small).overlap, mass_of(whole).overlap) < AGREE
    compute, done = unit_loads.ResponseSolver._block, []

    def counted(self, surface, start):
        if len(done) == 3:
            raise KeyboardInterrupt
        done.append(start)
        return compute(self, surface, start)

    with monkeypatch.context() as patch:
        patch.setattr(unit_loads.ResponseSolver, "_block", counted)
        with pytest.raises(KeyboardInterrupt, match="call reduce with the same input"):
            reduced(small_roller, **{**given, "cache": True})
    resumed = reduced(small_roller, **{**given, "cache": True}).contact_surfaces["rim"]
    assert np.array_equal(mass_of(resumed).lags_mass, mass_of(small).lags_mass)
    assert np.array_equal(mass_of(resumed).overlap, mass_of(small).overlap)


def test_cells_and_an_averaging_interface(small_roller):
    """Cells as functions, a bore that deforms: the same promises."""
    given = {"modes": 5, "traction": "cells", "interfaces": {"bore": "average"}, "local_dynamics": True}
    body = reduced(small_roller, **given)
    s = body.contact_surfaces["rim"]
    local = dynamic_modes(s, count=9)
    mass = local.shape.T @ mass_of(s).lags_mass[0] @ local.shape
    assert np.abs(mass - np.eye(len(local.omega))).max() < ORTHONORMAL
    assert np.abs(mass_of(s).overlap.T @ local.shape).max() < ORTHONORMAL
    rest = local.residual_lags[0] + (local.trace / local.omega**2) @ local.trace.T
    assert relative(rest, s.lags[0]) < ORTHONORMAL


def test_bad_input(small_roller):
    with pytest.raises(InputError, match="local_dynamics must be True or False, got 'hht'"):
        reduced(small_roller, local_dynamics="hht")
