"""The half-space under the functions of a contact grid, and what is left of a body without it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from offline_bodies import STEEL, reduced

import warpffrf as wf
from patch_reference import Patch, line_edges, spline_matrix
from references.finite_elements.free_end import STEEL_ROLLER, press_roller
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.far_field import NOTHING, WHOLE, cutoff
from warpffrf.offline.near_field.half_space import PointLoads, half_space_at, mean_between, normal_load
from warpffrf.offline.near_field.window import FlatChart

NU = 0.3
# The far fields of a roller from two meshes on the same nodes, over the largest entry of the whole compliance. Linear
# cells of 4 mm leave 0.6 % of it at the load itself; quadratic ones 0.1 %.
SAME_FIELD = {1: 8e-3, 2: 2e-3}
CROWNED = 2e-3  # of the compliance: far fields of a rim with a crown of 2 m and of a straight one
BOTH_PATHS = 2e-3  # windows of one sector or of some: other cut faces
RIPPLE = 2e-4  # of the force, over an element: 5e-5 measured with hex8
# Fine finite elements of the roller pressed on a plane: 0.1 % themselves, 0.15 % from cells of 4 mm, and of the peak
# 0.5 %, of which 0.3 % lie with the nodes of the reference.
FORCE, PEAK = 5e-3, 8e-3


def roller(**counts):
    return wf.mesh.roller(0.05, 0.015, 0.02, **{"sectors": 80, "layers": 7, "axial": 5, "order": 1, **counts})


def far_of(body):
    """The far field of the rim."""
    found = body.contact_surfaces["rim"].far
    assert found is not None
    return found


@pytest.fixture(scope="module")
def hex8():
    return reduced(roller(), max_frequency=20e3, contact_fixed=True)


def means(body, lags):
    """Mean displacement per unit force among nodes, of coefficients per node force, in the layout of `lags`."""
    s = body.contact_surfaces["rim"]
    g = s.grid
    area = s.gram_z.sum(axis=1) * g.pitch
    total, rows = g.columns, g.rows

    def weak(blocks):
        v = g.along_theta(blocks.reshape(total, rows, -1))
        return np.einsum("kl,jlm->jkm", s.gram_z, v).reshape(blocks.shape)

    half = np.roll(weak(lags)[::-1], 1, axis=0).transpose(0, 2, 1)
    a = np.tile(area, g.columns_per_sector)
    return weak(half) / a[:, None] / a


def test_point_load_is_boussinesq() -> None:
    """On the surface u_y = (1 - nu^2)/(pi E r), on the axis below the load (1 + nu)(3 - 2 nu)/(2 pi E y), and Navier's
    equation by differences."""
    r = np.array([0.3, 1.0, 7.0])
    zero = np.zeros(3)
    _, _, u = normal_load(r, zero, zero, NU)
    assert np.allclose(u, (1.0 - NU**2) / (np.pi * r), rtol=1e-14)
    _, _, u = normal_load(zero, zero, r, NU)
    assert np.allclose(u, (1.0 + NU) * (3.0 - 2.0 * NU) / (2.0 * np.pi * r), rtol=1e-14)

    x, step = np.array([0.7, -0.4, 0.5]), 1e-3
    offsets = [(i, j) for i in range(3) for j in range(3)]

    def at(p):
        return np.stack(normal_load(p[0], p[1], p[2], NU))

    hessian = np.zeros((3, 3, 3))  # of each component
    for i, j in offsets:
        e, d = step * np.eye(3)[i], step * np.eye(3)[j]
        hessian[:, i, j] = (at(x + e + d) - at(x + e - d) - at(x - e + d) + at(x - e - d)) / (4.0 * step**2)
    # mu small-sliding contact u + (lambda + mu) grad div u = 0, lambda + mu = mu/(1 - 2 nu)
    residual = np.einsum("cii->c", hessian) + np.einsum("iij->j", hessian) / (1.0 - 2.0 * NU)
    assert np.max(np.abs(residual)) < 1e-4 * np.max(np.abs(hessian))  # second differences


def test_mean_of_two_distant_squares() -> None:
    """Against Gauss points on both; the expansion by second moments errs with the fourth power of their distance."""
    x, w = np.polynomial.legendre.leggauss(8)
    s, t = (v.ravel() for v in np.meshgrid(0.5 * x, 0.5 * x))
    weight = np.outer(0.5 * w, 0.5 * w).ravel()
    errors = []
    for d in (3.0, 6.0):
        r = np.hypot(d + s[:, None] - s, 0.5 * d + t[:, None] - t)
        exact = (1.0 - NU**2) / np.pi * weight @ (1.0 / r) @ weight
        found = mean_between(np.array(d), np.array(0.5 * d), (np.array(1.0 / 6.0), np.array(1.0 / 6.0)), NU)
        errors.append(abs(float(found) / exact - 1.0))
    assert errors[0] < 1e-3
    assert errors[0] / errors[1] > 12.0  # 16


def test_distributed_load_is_love() -> None:
    """Outward displacement below a square under a uniform load, and its sign: outward loads pull outwards."""
    x, w = np.polynomial.legendre.leggauss(8)
    s, t = (v.ravel()[None] for v in np.meshgrid(0.5 * x, 0.5 * x))
    loads = PointLoads(s, t, np.outer(0.5 * w, 0.5 * w).reshape(1, -1))
    u = half_space_at(np.array([[3.0, 0.0, 0.0]]), loads, NU)[:, 0, 0]
    a, b = np.arcsinh(0.5 / 2.5), np.arcsinh(0.5 / 3.5)
    love = 2.0 * (3.5 * b - 2.5 * a + 0.5 * (np.arcsinh(3.5 / 0.5) - np.arcsinh(2.5 / 0.5)))  # of 1/r over the square
    assert u[2] == pytest.approx((1.0 - NU**2) / np.pi * love, rel=1e-6)
    assert u[0] > 0.0  # the surface is drawn away from a pull
    assert abs(u[1]) < 1e-12


@pytest.mark.parametrize(
    "shape",
    [
        wf.surfaces.Cylinder(radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)),
        wf.surfaces.Bore(radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)),
        wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)),
    ],
)
def test_charts_keep_lengths_and_handedness(shape) -> None:
    """Unrolled surfaces keep arcs, and (s, t, -y) is right-handed: cells keep their orientation."""
    theta, z = 0.3, 0.01
    chart = FlatChart(shape, theta, z)
    s, t = chart.on_surface(theta + np.array([-0.01, 0.02]), np.array([z - 0.003, z]))
    R = 1.0 if shape.profile().planar else 0.05
    assert np.allclose(np.abs(s), R * np.array([0.01, 0.02]), rtol=1e-12)
    assert np.allclose(t, [-0.003, 0.0], atol=1e-15)
    around, along = shape.around(theta), shape.along(theta, z)
    step = 1e-6
    origin = chart.origin - 1e-4 * shape.normal(theta, z)
    moved = np.stack([origin, origin + step * around, origin + step * along, origin - step * shape.normal(theta, z)])
    s, t, y = chart.flat(moved)
    Jacobian = np.stack([np.diff(v[[0, i]]) for i in (1, 2, 3) for v in (s, t, y)]).reshape(3, 3) / step
    assert np.allclose(Jacobian, np.eye(3), atol=5e-3)  # 1e-4/R below the surface
    assert y[0] == pytest.approx(1e-4, rel=1e-9)


def test_cutoff() -> None:
    phi = np.array([0.0, WHOLE, 0.5 * (WHOLE + NOTHING), NOTHING, 3.0])
    assert np.allclose(cutoff(np.cos(phi)), [1.0, 1.0, 0.5, 0.0, 0.0], atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2])
def test_far_field_is_the_meshs_no_more(hex8, order) -> None:
    """On the same nodes the whole compliance of 4 mm cells and of finer ones differs by a sixth at a load, the
    difference from the half-space by less than a hundredth."""
    fine = reduced(
        roller(sectors=160, layers=11, axial=10, order=2), max_frequency=20e3, contact_fixed=True, spacing=4e-3
    )
    coarse = hex8
    if order == 2:
        coarse = reduced(roller(order=2), max_frequency=20e3, contact_fixed=True, spacing=4e-3)
    a, b = (body.contact_surfaces["rim"] for body in (coarse, fine))
    assert (a.grid.columns, a.grid.rows) == (b.grid.columns, b.grid.rows)
    whole = means(fine, b.lags)
    size = np.max(np.abs(whole))
    if order == 1:
        assert np.max(np.abs(means(coarse, a.lags) - whole)) > 0.1 * size
    u_a, u_b = (_along_middle(body, s) for body, s in ((coarse, a), (fine, b)))
    assert np.max(np.abs(u_a - u_b)) < SAME_FIELD[order] * size


def _along_middle(body, surface) -> np.ndarray:
    """Displacement, with modes, along the middle of the rim by a unit force there, at nodes and between."""
    theta = surface.grid.theta[0] + surface.grid.pitch * np.linspace(0.0, 6.0, 25)
    z = np.zeros(len(theta))
    P = (surface.splines.around(theta)[:, :, None] * surface.splines.along(z)[:, None, :]).reshape(len(theta), -1)
    S = spline_matrix(surface, far_of(body).lags, np.arange(P.shape[1]))
    modes = P @ surface.splines.of_nodes(surface.mode_normal)
    omega = 2.0 * np.pi * body.frequencies
    return P @ S @ P[0] + (modes / omega**2) @ modes[0]


@pytest.mark.slow
def test_paths_agree(hex8) -> None:
    """The windows of one sector, and those of clusters of the general path."""
    general = reduced(roller(), general=True, max_frequency=20e3, contact_fixed=True)
    a, b = (body.contact_surfaces["rim"] for body in (hex8, general))
    numbers = np.arange(a.grid.columns * a.grid.rows)
    whole = np.max(np.abs(a.compliance(np.arange(a.grid.columns))))
    difference = spline_matrix(a, far_of(hex8).lags, numbers) - spline_matrix(b, far_of(general).lags, numbers)
    assert np.max(np.abs(difference)) < BOTH_PATHS * whole


def test_ripple_of_a_rolling_patch(hex8) -> None:
    """The force at a constant approach hardly knows where the elements are: half-width 0.43 mm, elements of 4 mm."""
    forces = []
    s = hex8.contact_surfaces["rim"]
    edges = line_edges(0.02, 0.5e-3, 1.5e-3)
    for phase in (0.0, 0.25, 0.5):
        patch = Patch(hex8, "rim", "bore", s.grid.theta[5] + phase * s.grid.pitch, 12, 0.09e-3, edges)
        forces.append(patch.press(0.05 - np.sqrt(0.05**2 - patch.x**2), 10.46e-6).sum())
    assert np.ptp(forces) < RIPPLE * np.mean(forces)


@pytest.mark.parametrize("cells", [12, 20, 40])
def test_pressures_are_unique(hex8, cells) -> None:
    """The compliance of square windows of equal cells is definite: its eigenvalue ratio is that of the half-space, or
    better."""
    edges = np.linspace(-0.5e-3, 0.5e-3, cells + 1)
    patch = Patch(hex8, "rim", "bore", 0.01, cells, 1e-3 / cells, edges)
    for G in (patch.near, patch.near + patch.far + patch.modes):
        values = np.linalg.eigvalsh(G)
        assert values[0] > 3e-3 * values[-1]


@pytest.mark.slow
@pytest.mark.parametrize("load", [2900.0, 13400.0])
def test_roller_compared_with_fine_elements(hex8, load) -> None:
    """Force, peak and the pressure near the free ends of a roller on a plane: elements of 4 mm, half-widths of 0.2 and
    0.43 mm, compared with finite elements of 0.035 and 0.07 mm."""
    half_width = {2900.0: 0.2e-3, 13400.0: 0.43e-3}[load]
    reference = press_roller(STEEL_ROLLER, load, half_width, 6.0, 0.125)
    s = hex8.contact_surfaces["rim"]
    patch = Patch(hex8, "rim", "bore", s.grid.theta[3], 20, 2.4 * half_width / 20, line_edges(0.02, 0.06e-3, 0.9e-3))
    f = patch.press(0.05 - np.sqrt(0.05**2 - patch.x**2), reference.approach)
    assert f.sum() == pytest.approx(load, rel=FORCE)
    p = (f / patch.areas).reshape(20, -1)[9:11].mean(axis=0)
    rows = patch.z[: p.size]
    assert np.interp(0.0, rows, p) == pytest.approx(reference.middle, rel=PEAK)
    for inside, error in ((0.2e-3, 0.015), (0.06e-3, 0.05)):
        assert np.interp(0.01 - inside, rows, p) == pytest.approx(reference.along(inside), rel=error)


def test_saved_and_loaded(hex8, tmp_path) -> None:
    path = hex8.save(tmp_path / "roller.h5")
    far = far_of(wf.ReducedBody.load(path))
    mine = far_of(hex8)
    assert np.array_equal(far.lags, mine.lags)
    assert far.facts() == mine.facts()
    assert [end.z for end in far.ends] == pytest.approx([-0.01, 0.01])


def test_ends_of_a_crowned_rim(hex8) -> None:
    """A crown that drops by 25 um leaves the edges square and the far field that of the straight rim, but for how the
    loads are spread: 1e-3 of the compliance. At a slope of 0.07 the edge is none, and a note says so."""
    crowned = reduced(
        roller(crown_radius=2.0), contact={"rim": wf.surfaces.CrownedCylinder(crown_radius=2.0)}, max_frequency=20e3,
        contact_fixed=True,
    )  # fmt: skip
    assert [end.z for end in far_of(crowned).ends] == pytest.approx([-0.01, 0.01])
    a, b = (_along_middle(body, body.contact_surfaces["rim"]) for body in (hex8, crowned))
    s = hex8.contact_surfaces["rim"]
    whole = np.max(np.abs(means(hex8, s.lags)))
    assert np.max(np.abs(a - b)) < CROWNED * whole
    steep = reduced(
        roller(sectors=40, layers=3, axial=3, crown_radius=0.14),
        contact={"rim": wf.surfaces.CrownedCylinder(crown_radius=0.14)}, contact_fixed=True,
    )  # fmt: skip
    assert far_of(steep).ends == ()
    assert any("is no right angle" in note for note in steep.report["notes"])


def test_what_cannot_have_a_patch_is_refused() -> None:
    mesh = roller(sectors=24, layers=3, axial=2)
    with pytest.raises(InputError, match="'rim': no contact-fixed grid: its tractions are constant on cells; use"):
        reduced(mesh, contact_fixed=True, traction="cells")
    with pytest.raises(InputError, match="contact_fixed must be True, False or None"):
        reduced(mesh, contact_fixed="yes")


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cells", [1, 2])
def test_few_cells_on_the_radius(cells, order) -> None:
    """Windows of a solid roller leave out what does not bear being laid flat: the axis, and the far side."""
    mesh = wf.mesh.roller(0.05, 0, 0.05, sectors=8 * cells, layers=1, axial=2, order=order)
    body = wf.reduce(
        mesh, STEEL, interfaces={"end_low": "average"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip
    far = far_of(body)
    assert np.all(np.isfinite(far.lags)) and far.asymmetry < 0.05


def test_a_plane_has_a_far_field() -> None:
    """Clusters of functions on a surface that is curved in no direction are as wide as their number allows."""
    mesh = wf.mesh.box((0.02, 0.02, 0.01), (4, 4, 2), order=1)
    body = wf.reduce(
        mesh, STEEL, interfaces={"z_min": "rigid"}, contact={"z_max": wf.surfaces.Plane()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip
    far = body.contact_surfaces["z_max"].far
    assert far is not None and np.all(np.isfinite(far.lags))


def test_facets_that_cannot_be_laid_flat_are_refused() -> None:
    mesh = roller(sectors=4, layers=1, axial=2)
    with pytest.raises(
        InputError, match="no contact-fixed grid: its facets .* too large compared with the radius.*three or more"
    ):
        reduced(mesh, contact_fixed=True)


def test_coatings_are_refused() -> None:
    """A layer of another material under the rim: named, with the depth that must be of one material."""
    mesh = roller(sectors=24, layers=4, axial=2)
    radius = np.linalg.norm(mesh.points[:, [0, 2]], axis=1)
    (kind,) = mesh.cells
    outer = radius[mesh.cells[kind]].mean(axis=1) > 0.045
    sets = {"coat": np.flatnonzero(outer), "core": np.flatnonzero(~outer)}
    coated = replace(mesh, cell_sets=sets)
    soft = wf.Material(3e9, 0.4, 1200.0)
    with pytest.raises(InputError, match="cells of another material lie within 3 facet edges.*one material there"):
        wf.reduce(
            coated,
            {"coat": soft, "core": STEEL},
            interfaces={"bore": "rigid"},
            contact={"rim": wf.surfaces.Cylinder()},
            grid=wf.ContactGrid(contact_fixed=True),
            cache=False,
            progress=False,
        )


@pytest.mark.parametrize(
    ("order", "thickness", "said"), [(1, 4e-3, "by about 1[0-4]%"), (2, 4e-3, "by about [23]%"), (1, 16e-3, None)]
)
def test_walls_as_thin_as_their_cells(order, thickness, said) -> None:
    """One layer of 4 mm cells around a rigid core: named, with what the force errs by (10.5 and 2.2 % measured)."""
    mesh = wf.mesh.roller(
        0.05, 0.05 - thickness, 0.02, sectors=80, layers=round(thickness / 4e-3), axial=5, order=order
    )
    body = reduced(mesh, modes=0, contact_fixed=True)
    found = [line for line in body.report["warnings"] if "the wall behind it" in line]
    assert bool(found) == (said is not None)
    assert said is None or re.search(said, found[0])


def test_fine_meshes_need_none() -> None:
    """None decides by the mesh: nodes 2.6 mm apart are coarse, but not for an expected half-width of 2 cm."""
    mesh = roller(sectors=120)
    assert reduced(mesh, contact_fixed=None).contact_surfaces["rim"].far is not None
    soft = reduced(mesh, contact_fixed=None, expected_half_width=0.02, force_error=0.1)
    assert soft.contact_surfaces["rim"].far is None


OF_THE_MESH = 0.03  # 2.0 % of this coarse mesh on either arc; lags without a counterpart made it a third


@pytest.mark.parametrize("half", [6.5, 7.0])
def test_an_arc_of_an_even_number_of_columns_is_as_symmetric_as_one_of_an_odd_number(half: float) -> None:
    """Next to the middle of an even number there is one more column on one side, which has no counterpart."""
    mesh = roller(sectors=120, layers=4, axial=2)
    pitch = 2.0 * np.pi / 120
    mesh = mesh.select("tread", "rim", lambda x: np.abs(np.arctan2(-x[:, 2], x[:, 0]) - 0.25 * pitch) < half * pitch)
    body = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"tread": wf.surfaces.Cylinder()}, modes=0,
            grid=wf.ContactGrid(contact_fixed=True),
        cache=False, progress=False,
    )  # fmt: skip
    surface = body.contact_surfaces["tread"]
    assert surface.grid.columns > 8 and not surface.grid.periodic
    assert surface.far is not None and surface.far.asymmetry < OF_THE_MESH
