"""Contact surfaces of every kind, offline: planes, spheres, cones, grooves and inside forms.

Areas and resultants are closed forms; static responses are those of the full model, assembled by scikit-fem's vector
basis and solved as a dense saddle point, with nothing shared but the loads of the grid's functions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import pytest
from offline_bodies import STEEL
from reference_fe import free_response, matrices

from scenes.flat_settings import reduce_flat
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh, ball, block, box, ring, roller, sleeve
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import ContactSurface, Tangential
from warpffrf.model.surfaces import (
    Bore,
    Cone,
    ConicalBore,
    CrownedCylinder,
    Cup,
    Cylinder,
    Groove,
    Plane,
    ProfiledCylinder,
    Ring,
    Sphere,
)
from warpffrf.offline import ContactGrid, reduce
from warpffrf.offline.contact.node_loads import NORMAL, TANGENTIAL, ContactFacets, TractionField
from warpffrf.offline.general.unit_loads import GeneralSurface
from warpffrf.offline.products import choose_path, resolve_shapes

EXACT = 1e-8  # what the product promises
SINGLE = 2e-6  # modes on the display surface are stored in single precision
QUADRATURE = 1e-8  # Gauss points on a cell: turning normal and curved meridian
HOLLOW = 1e-6  # the same on four cells across a groove that is a quarter of a circle
AGREE = 1e-9  # cyclic and general path
ROWS, COLUMNS = 4, 16


def squeezed(mesh: Mesh, radius) -> Mesh:
    """The body with its distances from the axis y multiplied by `radius`(y): another meridian, the same cells."""
    factor = radius(mesh.points[:, 1])[:, None]
    return replace(mesh, points=mesh.points * np.concatenate([factor, np.ones_like(factor), factor], axis=1))


def tapered(y):
    return 1.0 + 10.0 * y  # 0.02 at y = 0 becomes 0.02 + 0.2 y


def sphere_zone(y):
    return np.sqrt(0.02**2 - y**2) / 0.02


def hollow(y):
    return (0.025 - np.sqrt(0.005**2 - y**2)) / 0.02


def parabola(y):
    return 1.0 - 50.0 * y**2


def tube() -> Mesh:
    return sleeve(0.02, 0.03, 0.006, sectors=COLUMNS, axial=ROWS - 1, layers=1, grading=1.0, order=1)


def shaft() -> Mesh:
    return roller(0.02, 0.012, 0.006, sectors=COLUMNS, axial=ROWS - 1, layers=1, grading=1.0, order=1)


def zone(radius, slope) -> float:
    """2 pi int R sqrt(1 + R'^2) dz over the width by a fine Gauss rule, and nothing of the code's."""
    x, w = np.polynomial.legendre.leggauss(40)
    z = 0.003 * x
    return float(2.0 * np.pi * 0.003 * np.sum(w * radius(z) * np.sqrt(1.0 + slope(z) ** 2)))


@dataclass(frozen=True)
class Case:
    """A body with the contact set `name` of `shape`; `area` [m2] and `resultant` [m2], int n dA, by hand."""

    make: Any
    name: str
    shape: Any
    area: float
    resultant: tuple[float, float, float]
    outward: bool = True

    @cached_property
    def mesh(self) -> Mesh:
        return self.make()

    @cached_property
    def resolved(self) -> Any:
        return resolve_shapes(self.mesh, {self.name: self.shape})[self.name]


def small_block() -> Mesh:
    return block((0.006, 0.008, 0.005), patch_half_width=(1e-3, 1.5e-3), cell=5e-4, growth=1.9, order=1)


def small_ball() -> Mesh:
    return ball(0.004, patch_half_width=(1e-3, 8e-4), cell=5e-4, growth=1.9, order=1)


def cap() -> tuple[float, float, float]:
    """int n dA over |theta| <= T, |sin(phi)| <= s of a sphere: R^2 2 sin T (phi + sin(phi) cos(phi)) along x."""
    R, T, s = 0.004, 0.25, 0.2
    return R**2 * 2.0 * np.sin(T) * (np.arcsin(s) + s * np.sqrt(1.0 - s**2)), 0.0, 0.0


def torus_zone(R0: float, Rc: float, e: float, sign: float) -> float:
    """2 pi int R ds over |z| < e, R = R0 - sign (Rc - Rc cos(phi)), ds = Rc dphi."""
    phi = np.arcsin(e / Rc)
    return 2.0 * np.pi * Rc * 2.0 * (R0 * phi - sign * Rc * (phi - np.sin(phi)))


TABLE = np.linspace(-0.003, 0.003, 5)  # a parabola is one with its cubic pieces
CONE_AREA = 2.0 * np.pi * 0.02 * 0.006 * np.sqrt(1.0 + 0.2**2)
CONE_FORCE = np.pi * ((0.02 + 0.2 * 0.003) ** 2 - (0.02 - 0.2 * 0.003) ** 2)
EDGE = float(np.sqrt(0.001 * (2.0 * 0.005 - 0.001)))
GROOVED: dict[str, Any] = {
    "groove_radius": 0.005,
    "groove_depth": 0.001,
    "sectors": COLUMNS,
    "axial": 4,
    "layers": 1,
    "order": 1,
}
CASES = {
    "plane": Case(small_block, "patch", Plane(), 6e-6, (0.0, 0.0, 6e-6)),
    "ball": Case(small_ball, "patch", Sphere(), 0.004 * 0.5 * 1.6e-3, cap()),
    "bore": Case(tube, "bore", Bore(), 2.0 * np.pi * 0.02 * 0.006, (0.0, 0.0, 0.0)),
    "ring": Case(
        lambda: ring(0.02, 0.03, 0.01, **GROOVED),
        "groove",
        Ring(),
        torus_zone(0.021, 0.005, EDGE, 1.0),
        (0.0, 0.0, 0.0),
    ),
    "cone": Case(lambda: squeezed(shaft(), tapered), "rim", Cone(), CONE_AREA, (0.0, -CONE_FORCE, 0.0)),
    "conical bore": Case(lambda: squeezed(tube(), tapered), "bore", ConicalBore(), CONE_AREA, (0.0, CONE_FORCE, 0.0)),
    "band": Case(lambda: squeezed(shaft(), sphere_zone), "rim", Sphere(), 2.0 * np.pi * 0.02 * 0.006, (0.0, 0.0, 0.0)),
    "cup": Case(lambda: squeezed(tube(), sphere_zone), "bore", Cup(), 2.0 * np.pi * 0.02 * 0.006, (0.0, 0.0, 0.0)),
    "groove": Case(
        lambda: squeezed(shaft(), hollow), "rim", Groove(), torus_zone(0.02, 0.005, 0.003, -1.0), (0.0, 0.0, 0.0)
    ),
    "table": Case(
        lambda: squeezed(shaft(), parabola),
        "rim",
        ProfiledCylinder(
            radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 1, 0), table=(TABLE, TABLE**2, 2.0 * TABLE)
        ),
        zone(lambda z: 0.02 - z**2, lambda z: -2.0 * z),
        (0.0, 0.0, 0.0),
    ),
}


@pytest.fixture(scope="module", params=CASES)
def case(request):
    return CASES[request.param]


def fields(case: Case, kinds=("nodes", "cells"), spacing=None) -> list[TractionField]:
    """Normal and tangential field on the set's whole grid."""
    facets = ContactFacets.of(case.mesh.points, case.mesh.facets(case.name), case.resolved)
    plan = facets.plan(case.name, spacing)
    return [TractionField(k, d, plan, facets) for k, d in zip(kinds, (NORMAL, TANGENTIAL), strict=True)]


@pytest.mark.parametrize("spacing", [None, 1.3], ids=["nodal", "coarse"])
def test_areas_add_up(case, spacing):
    """Areas of the functions, and the Gram matrix under a constant, are the area of the true surface."""
    if spacing is not None:
        spacing *= ContactFacets.of(case.mesh.points, case.mesh.facets(case.name), case.resolved).chart.edge
    rule = HOLLOW if case.resolved.kind in ("ring", "groove") else QUADRATURE
    for field in fields(case, spacing=spacing):
        assert field.plan.nodal == (spacing is None)
        assert field.areas().sum() == pytest.approx(case.area, rel=rule)
        assert field.gram_theta().sum() * field.gram_z().sum() == pytest.approx(case.area, rel=rule)


def test_constant_pressure_has_its_resultant(case):
    """Force along the normal as by hand; on surfaces that turn no torque about the axis, on all none about the centre
    of symmetry, and a tangential traction around has the torque R times area to the side of the material."""
    normal, tangential = fields(case)
    n, x = len(case.mesh.points), case.mesh.points
    force = (normal.loads(n) @ np.ones(normal.count)).reshape(-1, 3)
    assert np.allclose(force.sum(axis=0), case.resultant, rtol=0.0, atol=1e-6 * case.area)
    size = float(np.max(np.ptp(x, axis=0)))
    moment = np.cross(x, force).sum(axis=0)
    assert np.abs(moment).max() < 1e-6 * size * case.area
    around = np.concatenate([np.ones(tangential.count // 2), np.zeros(tangential.count // 2)])
    sheared = (tangential.loads(n) @ around).reshape(-1, 3)
    if case.name in ("rim", "bore", "groove"):
        torque = float(np.cross(x, sheared).sum(axis=0) @ case.resolved.e_a)
        assert np.abs(sheared.sum(axis=0)).max() < 1e-9 * case.area
        assert np.sign(torque) == case.resolved.side
        R = float(np.max(np.hypot(x[:, 0], x[:, 2])[case.mesh.facets(case.name).node_set]))
        assert 0.9 * R * case.area < abs(torque) < R * case.area * (1.0 + 1e-9)
    else:
        assert sheared.sum(axis=0) @ case.resolved.around(np.array(0.0)) > 0.98 * case.area


def test_directions_are_right_handed_and_look_out(case):
    """e_theta x t_z = n at all nodes, and n is the outward normal of the facets up to their size."""
    facets = case.mesh.facets(case.name)
    theta, z, _ = case.resolved.chart(case.mesh.points[facets.node_set])
    n = case.resolved.normal(theta, z)
    assert np.allclose(np.cross(case.resolved.around(theta), case.resolved.along(theta, z)), n, atol=1e-12)
    assert np.all(np.einsum("ij,ij->i", n, facets.node_normals(case.mesh.points)) > 0.9)


@pytest.fixture(scope="module")
def full():
    """{case name: (K, M)} of scikit-fem, dense, kept over the tests of this module."""
    return {}


@pytest.mark.parametrize("name", ["plane", "ball", "bore", "cone", "ring", "cup"])
@pytest.mark.parametrize("modes", [0, 12])
def test_static_response_is_exact(full, name, modes):
    """Normal and tangential displacement under normal and tangential forces equal the full model's."""
    case = CASES[name]
    mesh = case.mesh
    if name not in full:
        K, M = matrices(mesh, STEEL)
        loads = [f.loads(len(mesh.points)).toarray() for f in fields(case)]
        R = rigid_modes(mesh.points, np.zeros(3))
        full[name] = loads, free_response(K, M, R, np.concatenate(loads, axis=1))
    loads, u = full[name]
    body = reduced(case, modes=modes, periodic=False)
    s = body.contact_surfaces[case.name]
    t = tangential_of(s)
    columns = np.arange(s.grid.columns)
    omega = 2.0 * np.pi * body.frequencies
    shapes = [s.mode_normal / omega, t.mode_tangent.reshape(2 * t.grid.columns * t.grid.rows, -1) / omega]
    D = [[s.compliance(columns), t.coupling(columns, columns)], [None, t.compliance(columns)]]
    ends = np.cumsum([0, *(B.shape[1] for B in loads)])
    f = fields(case)
    first = 0 if s.grid.periodic else 1
    kept = [np.arange(g.count).reshape(-1, g.columns, g.rows)[:, first : first + s.grid.columns].ravel() for g in f]
    grid_nodes, cells = (np.kron(g.gram_theta(), g.gram_z(s.shape)) for g in (s.grid, t.grid))
    gram = grid_nodes, np.kron(np.eye(2), cells)
    for a, b in ((0, 0), (0, 1), (1, 1)):
        C = (loads[a].T @ u[:, ends[b] : ends[b + 1]])[np.ix_(kept[a], kept[b])]
        expected = np.linalg.solve(gram[b], np.linalg.solve(gram[a], C).T).T
        found = D[a][b] + shapes[a] @ shapes[b].T
        assert np.abs(found - expected).max() < EXACT * np.abs(expected).max()


@pytest.mark.parametrize("name", ["plane", "ball", "bore"])
def test_weak_displacements_are_exact_up_to_the_edge(name):
    """M a = int psi_i u dA of every mode, for every node and cell that is kept."""
    case = CASES[name]
    body = reduced(case, modes=8, periodic=False)
    s, x = body.contact_surfaces[case.name], case.mesh.points
    u = np.zeros((len(x), 3, len(body.frequencies)))
    place = {tuple(np.round(p, 9)): i for i, p in enumerate(x)}
    u[[place[tuple(np.round(p, 9))] for p in body.surface.points]] = body.surface.modes.transpose(1, 2, 0)
    first = 0 if s.grid.periodic else 1
    t = tangential_of(s)
    for f, grid, found in zip(fields(case), (s.grid, t.grid), (s.mode_normal[None], t.mode_tangent), strict=True):
        weak = f.loads(len(x)).T @ u.reshape(3 * len(x), -1)
        weak = weak.reshape(len(found), f.columns, f.rows, -1)[:, first : first + grid.columns]
        a = found.reshape(weak.shape)
        assert weak == pytest.approx(
            np.einsum("ij,kl,djlm->dikm", grid.gram_theta(), grid.gram_z(s.shape), a),
            rel=0.0,
            abs=SINGLE * np.ptp(weak),
        )


@pytest.mark.parametrize("name", ["plane", "bore"])
def test_inertia_of_the_local_modes_is_exact(name):
    """N = U^T M U of the full model's responses U to unit forces of the nodes that are kept."""
    case = CASES[name]
    x = case.mesh.points
    K, M = matrices(case.mesh, STEEL)
    f = fields(case)[0]
    s = reduced(case, modes=0, periodic=False, tangential=False, local_dynamics=True).contact_surfaces[case.name]
    first = 0 if s.grid.periodic else 1
    numbers = np.arange(f.count).reshape(f.columns, f.rows)[first : first + s.grid.columns].ravel()
    gram = np.kron(s.grid.gram_theta(), s.gram_z)
    u = free_response(K, M, rigid_modes(x, np.zeros(3)), f.loads(len(x)).toarray()[:, numbers] @ np.linalg.inv(gram))
    expected = u.T @ M @ u
    assert s.local_mass is not None
    assert np.abs(s.local_mass.lags_mass[0] - expected).max() < EXACT * np.abs(expected).max()


@pytest.mark.parametrize("patch", [1e-3, 5e-4])
def test_a_constant_displacement_keeps_its_integral(patch):
    """Of u = n on a plane the kept nodes have int psi_i u dA = pitch times the row's share of the width, edge or not;
    also where one column is all that there is."""
    mesh = block((0.006, 0.008, 0.005), patch_half_width=(patch, 1.5e-3), cell=5e-4, growth=1.9, order=1)
    shape = resolve_shapes(mesh, {"patch": Plane()})["patch"]
    surface = GeneralSurface(mesh, "patch", shape, None)
    assert surface.columns == round(2.0 * patch / 5e-4) - 1
    u = np.tile(shape.normal(0.0, 0.0), len(mesh.points))
    kept, plan = surface.kept[0], surface.plan
    a = kept.without_gram((surface.loads().T @ u)[:, None]).reshape(surface.columns, -1)
    M = plan.pitch / 6.0 * (4.0 * np.eye(len(a)) + np.eye(len(a), k=1) + np.eye(len(a), k=-1))
    width = 0.5 * np.diff(plan.z, prepend=plan.z[0], append=plan.z[-1])
    share = width[:-1] + width[1:]
    assert M @ a @ kept.field.gram_z() == pytest.approx(plan.pitch * np.tile(share, (len(a), 1)), rel=1e-10)
    if len(a) == 1:
        assert a == pytest.approx(1.5, rel=1e-10)  # the multiple of the node that is nearest to 1 on its support


def tangential_of(surface: ContactSurface) -> Tangential:
    assert surface.tangential is not None
    return surface.tangential


def reduced(case: Case, **settings) -> ReducedBody:
    given = {"interfaces": {}, "contact": {case.name: case.shape}, "tangential": True, "cache": False}
    return reduce_flat(case.mesh, STEEL, progress=False, **{**given, **settings})


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bore", "ring", "conical bore", "cup", "groove"])
def test_periodic_path_equals_general_path(name):
    case = CASES[name]
    a, b = (reduced(case, modes=6, **how) for how in ({}, {"periodic": False}))
    assert (a.report["path"], b.report["path"]) == ("cyclic", "general")
    p, q = a.contact_surfaces[case.name], b.contact_surfaces[case.name]
    assert np.allclose(p.grid.theta, q.grid.theta) and np.allclose(p.grid.z, q.grid.z)
    columns = np.arange(p.grid.columns)
    s, t = tangential_of(p), tangential_of(q)
    pairs = [
        (p.compliance(columns), q.compliance(columns)),
        (s.compliance(columns), t.compliance(columns)),
        (s.coupling(columns, columns), t.coupling(columns, columns)),
        (p.mode_normal @ p.mode_normal.T, q.mode_normal @ q.mode_normal.T),
    ]
    for found, expected in pairs:
        assert np.abs(found - expected).max() < AGREE * np.abs(expected).max()


def test_open_shape_is_found(case):
    """Without a shape the right kind is found, on the right side; a flat parabola passes for a crown."""
    table = case.resolved.kind == ProfiledCylinder.kind
    found = resolve_shapes(case.mesh, {case.name: None})[case.name]
    assert found.kind == ("crowned_cylinder" if table else case.resolved.kind) and found.side == case.resolved.side
    x = case.mesh.points[case.mesh.facets(case.name).node_set]
    assert np.abs(found.chart(x)[2]).max() < (2e-7 if table else 1e-12)


def test_no_shape_fits_waves():
    mesh = block((0.006, 0.008, 0.005), patch_half_width=1e-3, cell=5e-4, order=1)
    x = mesh.points.copy()
    x[:, 2] += 1e-4 * np.cos(3000.0 * x[:, 0]) * np.cos(2000.0 * x[:, 1])
    with pytest.raises(InputError, match="do not fit any of the shapes plane, cylinder"):
        resolve_shapes(replace(mesh, points=x), {"patch": None})


@pytest.mark.parametrize(
    ("name", "shape"),
    [("bore", Cylinder()), ("cup", Sphere()), ("conical bore", Cone()), ("ring", CrownedCylinder())]
    + [("cone", ConicalBore()), ("band", Cup()), ("ball", Cup()), ("plane", Plane(outward=(0, 0, -1)))],
)
def test_wrong_side_is_refused(name, shape):
    case = CASES[name]
    with pytest.raises(InputError, match=f"contact {case.name!r}.*side|contact {case.name!r}.*look"):
        resolve_shapes(case.mesh, {case.name: shape})


def test_file_keeps_the_shape(case, tmp_path):
    """The chart of the loaded body is that of the saved one."""
    body = reduced(case, modes=0, tangential=False)
    body.save(tmp_path / "body.h5")
    first, again = (b.contact_surfaces[case.name] for b in (body, ReducedBody.load(tmp_path / "body.h5")))
    assert again.shape.kind == first.shape.kind and again.shape.side == first.shape.side
    theta, z = np.meshgrid(first.grid.theta, first.grid.z)
    assert np.array_equal(again.shape.point(theta, z), first.shape.point(theta, z))
    assert np.array_equal(again.shape.normal(theta, z), first.shape.normal(theta, z))
    assert again.grid.periodic == first.grid.periodic == (case.name != "patch")


@pytest.mark.parametrize("name", ["plane", "ball", "bore"])
def test_stress_at_the_surface_is_the_traction(name):
    """sigma n at the nodes of the contact surface: minus the pressure along n, the shear along its direction."""
    case = CASES[name]
    body = reduced(case, modes=0, stress={"here": case.name}, tangential="nodes")
    s, field = body.contact_surfaces[case.name], body.stress["here"]
    rng = np.random.default_rng(3)
    grid = s.grid
    gram = np.kron(grid.gram_theta(), s.gram_z)
    normal, sheared = rng.uniform(1e6, 2e6, (1, grid.columns * grid.rows)), rng.uniform(1e6, 2e6, (2, len(gram)))
    forces = (normal @ gram).reshape(grid.columns, grid.rows)
    shear = (sheared @ gram).reshape(2, grid.columns, grid.rows)
    q = np.zeros(len(body.frequencies))
    sigma = field.evaluate(q, {case.name: forces}, {case.name: shear})
    theta, z, _ = s.shape.chart(field.points)
    tensor = sigma[..., [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    n = s.shape.normal(theta, z)
    traction = np.einsum("pij,pj->pi", tensor, n)
    # the whole grid of an arc has one more column at both ends, where there is no traction
    first = 0 if grid.periodic else 1
    along = [s.shape.around(theta), s.shape.along(theta, z)]
    pressure = normal.reshape(1, grid.columns, grid.rows), [n]
    tractions = [pressure, (sheared.reshape(2, grid.columns, grid.rows), along)]
    j = np.rint((theta - grid.theta_start) / grid.pitch).astype(int) + first
    k = np.argmin(np.abs(z[:, None] - grid.z), axis=1)
    expected = np.zeros_like(traction)
    for values, directions in tractions:
        p = np.pad(values, ((0, 0), (first, first), (0, 0)))
        for d, direction in enumerate(directions):
            expected += p[d, j % p.shape[1], k][:, None] * direction
    assert np.abs(traction - expected).max() < 1e-6 * np.abs(expected).max()


def test_expected_half_width_on_a_plane_and_a_ball():
    """The rule for ellipses serves a plane and a sphere, the one for lines a bore; the grid keeps what it promises."""
    for name, half_width in (("plane", 1.5e-3), ("ball", 1.5e-3), ("bore", 0.03)):
        case = CASES[name]
        body = reduced(case, modes=0, tangential=False, expected_half_width=half_width, force_error=0.3)
        facts = body.report["contact"][case.name]["expected"]
        assert facts["spacing"] <= half_width and facts["promised_error"] <= 0.3


def test_grid_finer_than_the_mesh_is_refused_on_a_plane():
    case = CASES["plane"]
    with pytest.raises(InputError, match="finer than the surface mesh"):
        reduced(case, modes=0, tangential=False, spacing=3e-4)


def test_two_patches_of_a_plane_are_refused():
    mesh = small_block().select("halves", "top", lambda c: np.abs(c[:, 0]) > 1e-3)
    with pytest.raises(InputError, match="more than one arc"):
        reduce(mesh, STEEL, contact={"halves": Plane()}, cache=False, progress=False)


def test_plane_of_a_periodic_body_takes_the_general_path():
    """A square bar, which looks the same after quarter turns."""
    mesh = box((0.01, 0.01, 0.02), (4, 4, 2), order=1)
    body = reduce(mesh, STEEL, contact={"z_max": None}, cache=False, progress=False)
    assert body.report["path"] == "general" and body.contact_surfaces["z_max"].shape.kind == "plane"
    choice = choose_path(tube(), [], {"ends": Plane(origin=(0, 0, 0), outward=(0, 1, 0))})
    assert choice.patterns is None and "is a plane" in choice.reason


def test_round_face_is_refused_as_no_rectangle():
    mesh = shaft().select("face", "ends", lambda c: c[:, 1] > 0.0)
    with pytest.raises(InputError, match="fill a rectangle"):
        reduce(mesh, STEEL, contact={"face": None}, grid=ContactGrid(spacing=0.02), cache=False, progress=False)


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("middle", [0.0, 2.0, -3.1, 3.1])
def test_arcs_are_counted_about_theta_zero(general, middle):
    """Wherever an arc lies, the middle of its grid is within half a turn of theta = 0, and its columns are on it."""
    mesh = tube()

    def near(c):
        theta = np.arctan2(-c[:, 2], c[:, 0])
        return np.abs((theta - middle + np.pi) % (2.0 * np.pi) - np.pi) < 1.0

    mesh = mesh.select("arc", "bore", near)
    how: dict[str, Any] = {"periodic": False} if general else {}
    body = reduce_flat(mesh, STEEL, contact={"arc": Bore()}, cache=False, progress=False, **how)
    grid = body.contact_surfaces["arc"].grid
    center = 0.5 * (grid.theta[0] + grid.theta[-1])
    assert not grid.periodic and -np.pi - 1e-9 <= center <= np.pi + 1e-9
    off = (center - middle + np.pi) % (2.0 * np.pi) - np.pi
    assert abs(off) < grid.pitch
