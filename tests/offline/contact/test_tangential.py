"""Tangential tractions and cells: operators of the cyclic path against the whole mesh, solved by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from traction_reference import cyclic_product, mixed_roller, plan_of, relative, sector_of, the_surface, whole_operators

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.model.surfaces import CrownedCylinder
from warpffrf.offline.contact.node_loads import TANGENTIAL, ContactFacets
from warpffrf.offline.cyclic.sector import phase
from warpffrf.offline.cyclic.surface import CyclicField, FacetPattern, facet_pattern

EXACT = 1e-10  # what the issue asks for
SINGLE = 2e-6  # transfers are stored in single precision
KINDS = [("nodes", "cells"), ("nodes", "nodes"), ("cells", "cells")]


BODIES = {
    "linear": (lambda: roller(0.05, 0.02, 0.02, sectors=12, layers=1, axial=2, order=1), None, None),
    "odd": (lambda: roller(0.05, 0.02, 0.02, sectors=9, layers=1, axial=1, order=1), None, None),
    "quadratic": (lambda: roller(0.05, 0.02, 0.02, sectors=5, layers=1, axial=1, order=2), None, None),
    "crowned": (
        lambda: roller(0.05, 0.02, 0.02, crown_radius=0.08, sectors=8, layers=1, axial=2, order=1),
        CrownedCylinder(),
        None,
    ),
    "coarser": (lambda: roller(0.05, 0.02, 0.02, sectors=12, layers=1, axial=2, order=1), None, 0.055),
    "mixed": (mixed_roller, None, None),
}


@pytest.fixture(scope="module", params=BODIES)
def body(request):
    make, shape, spacing = BODIES[request.param]
    return make(), shape, spacing


@pytest.mark.parametrize("kinds", KINDS, ids=lambda kinds: "-".join(kinds))
def test_operators_equal_brute_force(body, kinds):
    mesh, given, spacing = body
    product, shape = cyclic_product(mesh, shape=given, spacing=spacing, traction=kinds[0], tangential=kinds[1], modes=0)
    s, D = the_surface(product)
    plan, surface = plan_of(mesh, shape, spacing=spacing)
    whole = whole_operators(mesh, shape, plan, kinds)
    columns = np.arange(s.grid.columns)
    assert D.grid.kind == kinds[1] and len(s.lags) == len(D.lags_tt) == len(D.lags_nt)
    quadrature = EXACT if surface.stride == 1 else 1e-8  # coarse functions: other rules for the turning normal
    assert relative(normal_compliance(s), whole.D[0][0]) < quadrature
    assert relative(D.compliance(columns), whole.D[1][1]) < quadrature
    assert relative(D.coupling(columns, columns), whole.D[0][1]) < quadrature
    forces = np.random.default_rng(0).standard_normal((2, D.grid.columns, D.grid.rows))
    u = (whole.responses[1] @ forces.ravel()).reshape(-1, 3)
    here = [int(np.argmin(np.linalg.norm(mesh.points - p, axis=1))) for p in product.skin_points]
    assert relative(D.recover(forces), u[here]) < SINGLE


def normal_compliance(s) -> np.ndarray:
    c, rows = s.grid.columns_per_sector, s.grid.rows
    sector = np.arange(s.grid.columns // c)
    lags = s.lags[(sector[:, None] - sector) % len(sector)]
    return lags.transpose(0, 2, 1, 3).reshape(len(sector) * c * rows, -1)


def test_modes_are_projected(body):
    """mode_tangent is the L2 projection of the modes' displacement on the surface, mode_normal too."""
    mesh, given, spacing = body
    product, shape = cyclic_product(
        mesh, shape=given, spacing=spacing, interfaces=["bore"], modes=6, tangential="cells"
    )
    s, D = the_surface(product)
    plan, _ = plan_of(mesh, shape, spacing=spacing)
    whole = whole_operators(mesh, shape, plan, ("nodes", "cells"))
    here = [int(np.argmin(np.linalg.norm(mesh.points - p, axis=1))) for p in product.skin_points]
    u = np.zeros((len(mesh.points), 3, len(product.omega)))
    u[here] = product.skin_modes.transpose(1, 2, 0)
    u = u.reshape(-1, len(product.omega))
    for field, B, found in zip(whole.fields, whole.loads, (s.mode_normal, D.mode_tangent), strict=True):
        assert relative(found.reshape(-1, len(product.omega)), field.without_gram(B.T @ u)) < SINGLE


def test_interfaces_and_modes_are_taken_out_of_the_tangential_part():
    """With modes and interface, the whole response to tangential forces is as exact as without modes."""
    mesh = roller(0.05, 0.02, 0.02, sectors=9, layers=2, axial=1, order=1)
    few, _ = cyclic_product(mesh, interfaces=["bore"], modes=0, tangential="cells")
    many, _ = cyclic_product(mesh, interfaces=["bore"], modes=40, tangential="cells")
    whole = []
    for p in (few, many):
        s, D = the_surface(p)
        columns = np.arange(s.grid.columns)
        n, t = s.mode_normal / p.omega, D.mode_tangent.reshape(-1, len(p.omega)) / p.omega
        coupling = D.coupling(columns, columns) + n @ t.T
        whole.append((D.compliance(columns) + t @ t.T, coupling))
    assert relative(whole[0][0], whole[1][0]) < EXACT and relative(whole[0][1], whole[1][1]) < EXACT


def test_arc_is_a_part_of_the_full_turn():
    mesh = roller(0.05, 0.02, 0.02, sectors=16, layers=1, axial=1, order=2)
    mesh = mesh.select("tread", "rim", lambda c: np.abs(np.arctan2(-c[:, 2], c[:, 0]) - np.pi / 16) < 5.4 * np.pi / 16)
    _, b = the_surface(cyclic_product(mesh, modes=4, tangential="cells")[0])
    arc, a = the_surface(cyclic_product(mesh, name="tread", modes=4, tangential="cells")[0])
    assert a.grid.columns == arc.grid.columns and not a.grid.periodic
    assert a.grid.theta_start == pytest.approx(arc.grid.theta_start)
    first = int(np.rint(((a.grid.theta_start - b.grid.theta_start) % (2.0 * np.pi)) / b.grid.pitch))
    columns, normal = np.arange(a.grid.columns), np.arange(arc.grid.columns)
    among, beside = (first + columns) % b.grid.columns, (first + normal) % b.grid.columns
    assert np.allclose(a.compliance(columns), b.compliance(among), rtol=1e-9, atol=1e-24)
    assert relative(a.coupling(normal, columns), b.coupling(beside, among)) < 1e-12
    forces = np.random.default_rng(0).standard_normal((2, len(columns), a.grid.rows))
    spread = np.zeros((2, b.grid.columns, b.grid.rows))
    spread[:, among] = forces
    assert relative(a.recover(forces), b.recover(spread)) < SINGLE


def test_loads_of_a_harmonic_are_those_of_its_wave():
    """B_k s equals the load on sector 0 of the whole grid's coefficients s e^{i k o phi}, in the sector's axes."""
    mesh = roller(0.05, 0.02, 0.02, crown_radius=0.1, sectors=7, layers=1, axial=2, order=1)
    shape = CrownedCylinder().fitted(mesh.points[mesh.facets("rim").node_set])
    plan, surface = plan_of(mesh, shape)
    whole = whole_operators(mesh, shape, plan, ("nodes", "cells"))
    sector = sector_of(mesh)
    axes, nn, N = sector.axes, sector.nodes, sector.count
    pattern = facet_pattern(mesh, "rim")
    assert isinstance(pattern, FacetPattern)
    facets = ContactFacets.of(mesh.points, pattern.nodes, shape)
    tangential = CyclicField(surface, facets, sector, "cells", TANGENTIAL)
    rng = np.random.default_rng(0)
    for field, B in zip((surface.normal, tangential), whole.loads, strict=True):
        for k in range(N // 2 + 1):
            s = rng.standard_normal(field.count)
            wave = np.array([phase(k * o, N) for o in range(N)])
            parts = s.reshape(len(field.directions), 1, field.c * field.rows) * wave[None, :, None]
            load = (B @ parts.ravel())[: 3 * nn].reshape(nn, 3) @ axes
            assert relative(np.asarray(field.load(k) @ s), load.ravel()) < 1e-12


def test_mixed_facets_are_reduced_in_both_kinds():
    mesh = mixed_roller()
    assert set(mesh.facets("rim").blocks) == {"quad4", "tri3"}
    mesh.check()
    product, _ = cyclic_product(mesh, interfaces=["bore"], modes=2)
    assert product.facts["harmonics"] == "complex"  # the diagonals of the triangles all lean one way


def test_unknown_kind_is_refused():
    mesh = roller(0.05, 0.02, 0.02, sectors=6, layers=1, axial=1, order=1)
    with pytest.raises(InputError, match="'nodes', 'cells'"):
        cyclic_product(mesh, tangential="waves")
