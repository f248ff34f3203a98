"""Contact grids: loads of a constant pressure, spacing, arcs, refusal of grids finer than the mesh."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from offline_bodies import reduced

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.model.reduced_body import axial_gram
from warpffrf.model.surfaces import CrownedCylinder, Cylinder
from warpffrf.offline.contact_grid import facet_chart, nodal_plan, spaced_plan, thinned_rows
from warpffrf.offline.hat_loads import hat_loads


def loads_of(mesh, shape, spacing=None):
    facets = mesh.facets("rim")
    shape = shape.fitted(mesh.points[facets.node_set])
    chart = facet_chart(mesh.points, *facets.single, shape)
    plan = nodal_plan(chart, "rim") if spacing is None else spaced_plan(chart, shape, "rim", spacing)
    assert plan is not None
    return shape, plan, hat_loads(*facets.single, chart, shape, plan)


@pytest.mark.parametrize("spacing", [None, 0.021])
@pytest.mark.parametrize("order", [1, 2])
def test_constant_pressure_is_applied_exactly(order, spacing):
    """Resultant of p = 1 on a crowned rim: zero; radial sum: the true area times the mean normal's radial part."""
    mesh = roller(0.05, 0.015, 0.02, crown_radius=0.5, sectors=12, layers=1, axial=4, order=order)
    shape, _, loads = loads_of(mesh, CrownedCylinder(), spacing)
    # area of the crowned band: 2 pi int R ds, ds = Rc dphi along the arc, R = R0 - Rc + Rc cos(phi)
    phi = np.arcsin(0.01 / 0.5)
    area = 2.0 * np.pi * 0.5 * 2.0 * ((0.05 - 0.5) * phi + 0.5 * np.sin(phi))
    assert loads.area.sum() == pytest.approx(area, rel=1e-12)
    assert np.abs(loads.value.sum(axis=0)).max() < 1e-14 * area * 1e2
    theta, z, _ = shape.chart(mesh.points[loads.node])
    outward = np.einsum("ed,ed->e", loads.value, shape.normal(theta, z)).sum()
    assert outward == pytest.approx(area, rel=0.05)  # normals turn over the 30 degrees of a hat


def test_nodal_loads_on_linear_mesh_are_the_gram_matrix(small_roller):
    """N_a = psi_a: the load's size on node a by hat i is M_ai, up to the turn of the normal over a facet."""
    shape, plan, loads = loads_of(small_roller, Cylinder())
    theta, z, _ = shape.chart(small_roller.points)
    hat_of_node = np.rint((theta - plan.theta_start) / plan.pitch).astype(int) % plan.columns * len(plan.z)
    hat_of_node += np.argmin(np.abs(plan.z[:, None] - z), axis=0)
    hats = plan.columns * len(plan.z)
    b = np.zeros((hats, hats))
    hat = loads.column % plan.columns * len(plan.z) + loads.row
    np.add.at(b, (hat, hat_of_node[loads.node]), loads.area)
    circulant = np.eye(plan.columns) * 2.0 / 3.0
    circulant += (np.roll(np.eye(plan.columns), 1, axis=0) + np.roll(np.eye(plan.columns), -1, axis=0)) / 6.0
    M = np.kron(plan.pitch * circulant, axial_gram(shape, plan.z))
    assert np.abs(b - M).max() < 1e-14 * M.max() * 10.0


def test_axial_gram_sums_to_the_area():
    shape = CrownedCylinder(
        radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 1, 0), crown_radius=0.5, fit_tolerance=1e-6
    )
    z = np.linspace(-0.01, 0.01, 5)
    phi = np.arcsin(0.01 / 0.5)
    half = (0.05 - 0.5) * phi + 0.5 * np.sin(phi)
    assert axial_gram(shape, z).sum() == pytest.approx(0.5 * 2.0 * half, rel=1e-13)


@pytest.mark.parametrize(
    ("width", "Z"),
    [
        (0.02, np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]])),  # rows 10 mm apart: the middle one is dropped
        (0.12, np.eye(3)),  # rows 60 mm apart, further than the spacing: all are kept
    ],
)
def test_coarse_grid_is_the_sum_of_fine_hats(width, Z):
    """Every third column: D_c = M_c^-1 W^T M D M W M_c^-1, with W the fine coefficients of the coarse hats."""
    mesh = roller(0.05, 0.015, width, sectors=18, layers=2, axial=2, order=1)
    fine = reduced(mesh, modes=4).contact_surfaces["rim"]
    coarse = reduced(mesh, modes=4, traction_spacing=0.0525).contact_surfaces["rim"]
    n, m = fine.grid.columns, coarse.grid.columns
    assert n == 3 * m and coarse.grid.rows == Z.shape[1]
    assert np.isin(np.round(coarse.grid.z, 12), np.round(fine.grid.z, 12)).all()
    W = np.zeros((n, m))
    for j in range(m):
        for a in range(-2, 3):
            W[(3 * j + a) % n, j] = 1.0 - abs(a) / 3.0
    W = np.kron(W, Z)
    M = np.kron(fine.grid.gram_theta(), fine.gram_z)
    M_c = np.kron(coarse.grid.gram_theta(), coarse.gram_z)
    D = fine.compliance(np.arange(n))
    expected = np.linalg.solve(M_c, np.linalg.solve(M_c, W.T @ M @ D @ M @ W).T)
    quadrature = 1e-8  # the two use other rules for the normal that turns by 20 degrees over a facet
    assert np.abs(coarse.compliance(np.arange(m)) - expected).max() < quadrature * np.abs(expected).max()
    normal = np.linalg.solve(M_c, W.T @ M @ fine.mode_normal)
    assert (
        np.abs(normal @ normal.T - coarse.mode_normal @ coarse.mode_normal.T).max()
        < quadrature * np.abs(normal).max() ** 2
    )
    forces = np.random.default_rng(0).standard_normal((m, coarse.grid.rows))
    same = (M @ W @ np.linalg.solve(M_c, forces.ravel())).reshape(n, 3)
    u = fine.recover(same)
    assert np.abs(coarse.recover(forces) - u).max() < 2e-6 * np.abs(u).max()  # single precision


@given(gaps=st.lists(st.floats(1e-4, 5e-3), min_size=1, max_size=12), spacing=st.floats(1e-4, 2e-2))
def test_thinned_rows_are_apart_and_none_is_dropped_in_vain(gaps, spacing):
    lines = np.cumsum([0.0, *gaps])
    rows = thinned_rows(np.repeat(lines, 3), spacing)
    assert np.isin(np.round(rows, 12), np.round(lines, 12)).all() and rows[[0, -1]] == pytest.approx(lines[[0, -1]])
    slack = 1e-8 * spacing
    assert len(rows) == 2 or np.diff(rows).min() >= spacing - slack
    for dropped in np.setdiff1d(np.round(lines, 12), np.round(rows, 12)):
        assert np.abs(rows - dropped).min() < spacing + slack


def test_thinned_rows_of_a_uniform_surface():
    z = np.linspace(-0.01, 0.01, 9)
    assert thinned_rows(z, 2.5e-3) == pytest.approx(z)
    assert thinned_rows(z, 5e-3) == pytest.approx(z[::2])
    assert thinned_rows(z, 6e-3) == pytest.approx(
        z[[0, 3, 8]]
    )  # 7.5 mm, then 12.5 mm: 6 and 5 mm would leave too little
    assert thinned_rows(z, 1.0) == pytest.approx(z[[0, -1]])


def test_spacing_longer_than_a_quarter_turn_keeps_four_columns(small_roller):
    assert reduced(small_roller, modes=0, traction_spacing=1.0).contact_surfaces["rim"].grid.columns == 6
    three = roller(0.05, 0.015, 0.02, sectors=3, layers=1, axial=1, order=2)
    assert reduced(three, modes=0, traction_spacing=1.0).contact_surfaces["rim"].grid.columns == 3


@pytest.mark.parametrize("order", [1, 2])
def test_arc_is_a_part_of_the_full_turn(order):
    mesh = roller(0.05, 0.015, 0.02, sectors=16, layers=1, axial=2, order=order)
    # an arc that runs across theta = 0: sectors 14, 15, 0, 1, 2
    mesh = mesh.select("tread", "rim", lambda c: np.abs(np.arctan2(-c[:, 2], c[:, 0]) - np.pi / 16) < 5.4 * np.pi / 16)
    whole = reduced(mesh, modes=4).contact_surfaces["rim"]
    body = reduced(mesh, modes=4, contact={"tread": Cylinder()})
    arc = body.contact_surfaces["tread"]
    assert body.report["path"] == "cyclic" and not arc.grid.periodic
    assert arc.grid.columns == order * 4 and arc.lags.shape == whole.lags.shape
    first = int(np.rint(((arc.grid.theta_start - whole.grid.theta_start) % (2 * np.pi)) / whole.grid.pitch))
    assert first == order * 15
    columns = np.arange(arc.grid.columns)
    among = (first + columns) % whole.grid.columns
    assert np.allclose(arc.compliance(columns), whole.compliance(among), rtol=1e-12, atol=0.0)
    rows = whole.grid.rows
    chosen = (among[:, None] * rows + np.arange(rows)).ravel()
    assert np.allclose(arc.mode_normal, whole.mode_normal[chosen])
    forces = np.random.default_rng(0).standard_normal((arc.grid.columns, rows))
    spread = np.zeros((whole.grid.columns, rows))
    spread[among] = forces
    assert np.allclose(arc.recover(forces), whole.recover(spread), rtol=1e-6, atol=0.0)


@pytest.mark.parametrize("general", [False, True])
def test_arc_hats_lie_inside_the_facets(small_roller, general):
    mesh = small_roller.select("tread", "rim", lambda c: c[:, 0] > 0.02)
    facets = mesh.facets("tread")
    body = reduced(mesh, general=general, contact={"tread": Cylinder()})
    s = body.contact_surfaces["tread"]
    theta, _, _ = s.shape.chart(mesh.points[facets.node_set])
    ends = s.grid.theta[[0, -1]] + np.array([-1.0, 1.0]) * s.grid.pitch
    ends = (ends + np.pi) % (2.0 * np.pi) - np.pi
    assert ends == pytest.approx([theta.min(), theta.max()], abs=1e-9)
    assert not s.grid.periodic


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("spacing", [0.004, 0.0085])
def test_grid_finer_than_the_mesh_is_refused(small_roller, general, spacing):
    with pytest.raises(InputError, match="contact grid finer than the surface mesh.*traction_spacing >= 0.017"):
        reduced(small_roller, general=general, traction_spacing=spacing)


def test_holes_and_separate_arcs_are_refused(small_roller):
    corner = small_roller.select("part", "rim", lambda c: (c[:, 1] < 0.0) | (c[:, 0] > 0.0))
    with pytest.raises(InputError, match="uncovered"):
        reduced(corner, contact={"part": Cylinder()})
    apart = small_roller.select("part", "rim", lambda c: np.abs(c[:, 0]) > 0.03)
    with pytest.raises(InputError, match="more than one arc"):
        reduced(apart, contact={"part": Cylinder()})
