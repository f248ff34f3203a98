"""Contact grids: loads of a constant pressure, spacing, arcs, refusal of grids finer than the mesh."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from offline_bodies import reduced

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.reduced.contact_grid import meridian_gram
from warpffrf.model.surfaces import CrownedCylinder, Cylinder
from warpffrf.offline.contact.contact_grid import facet_chart, nodal_plan, spaced_plan, thinned_rows
from warpffrf.offline.contact.node_loads import (
    BEND,
    ContactFacets,
    TractionField,
    cut_points,
    node_loads,
    surface_vectors,
)


def loads_of(mesh, shape, spacing=None):
    facets = mesh.facets("rim")
    shape = shape.fitted(mesh.points[facets.node_set])
    kind, nodes = facets.single
    chart = facet_chart(mesh.points, kind, nodes, shape)
    plan = nodal_plan(chart, "rim") if spacing is None else spaced_plan(chart, shape, "rim", spacing)
    assert plan is not None
    return shape, plan, node_loads(kind, nodes, chart, shape, plan)


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
    assert outward == pytest.approx(area, rel=0.05)  # normals turn over the 30 degrees of a node


def test_nodal_loads_on_linear_mesh_are_the_gram_matrix(small_roller):
    """N_a = psi_a: the load's size on node a by hat i is M_ai, up to the turn of the normal over a facet."""
    shape, plan, loads = loads_of(small_roller, Cylinder())
    theta, z, _ = shape.chart(small_roller.points)
    grid_node_of = np.rint((theta - plan.theta_start) / plan.pitch).astype(int) % plan.columns * len(plan.z)
    grid_node_of += np.argmin(np.abs(plan.z[:, None] - z), axis=0)
    grid_nodes = plan.columns * len(plan.z)
    b = np.zeros((grid_nodes, grid_nodes))
    grid_node = loads.column % plan.columns * len(plan.z) + loads.row
    np.add.at(b, (grid_node, grid_node_of[loads.node]), loads.area)
    circulant = np.eye(plan.columns) * 2.0 / 3.0
    circulant += (np.roll(np.eye(plan.columns), 1, axis=0) + np.roll(np.eye(plan.columns), -1, axis=0)) / 6.0
    M = np.kron(plan.pitch * circulant, meridian_gram("nodes", shape, plan.z))
    assert np.abs(b - M).max() < 1e-14 * M.max() * 10.0


def test_axial_gram_sums_to_the_area():
    shape = CrownedCylinder(
        radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 1, 0), crown_radius=0.5, fit_tolerance=1e-6
    )
    z = np.linspace(-0.01, 0.01, 5)
    phi = np.arcsin(0.01 / 0.5)
    half = (0.05 - 0.5) * phi + 0.5 * np.sin(phi)
    assert meridian_gram("nodes", shape, z).sum() == pytest.approx(0.5 * 2.0 * half, rel=1e-13)


@pytest.mark.parametrize(
    ("width", "Z"),
    [
        (0.02, np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]])),  # rows 10 mm apart: the middle one is dropped
        (0.12, np.eye(3)),  # rows 60 mm apart, further than the spacing: all are kept
    ],
)
def test_coarse_grid_is_the_sum_of_fine_nodes(width, Z):
    """Every third column: D_c = M_c^-1 W^T M D M W M_c^-1, with W the fine coefficients of the coarse nodes."""
    mesh = roller(0.05, 0.015, width, sectors=18, layers=2, axial=2, order=1)
    fine = reduced(mesh, modes=4).contact_surfaces["rim"]
    coarse = reduced(mesh, modes=4, spacing=0.0525).contact_surfaces["rim"]
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
    assert reduced(small_roller, modes=0, spacing=1.0).contact_surfaces["rim"].grid.columns == 6
    three = roller(0.05, 0.015, 0.02, sectors=3, layers=1, axial=1, order=2)
    assert reduced(three, modes=0, spacing=1.0).contact_surfaces["rim"].grid.columns == 3


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
    # what the global modes do to its nodes, which the Gram matrix of each makes of it
    weak = whole.grid.along_theta(whole.mode_normal.reshape(whole.grid.columns, rows, -1))[among]
    assert np.allclose(arc.grid.along_theta(arc.mode_normal.reshape(len(among), rows, -1)), weak, rtol=1e-10)
    forces = np.random.default_rng(0).standard_normal((arc.grid.columns, rows))
    spread = np.zeros((whole.grid.columns, rows))
    spread[among] = forces
    assert np.allclose(arc.recover(forces), whole.recover(spread), rtol=1e-6, atol=0.0)


@pytest.mark.parametrize("general", [False, True])
def test_arc_nodes_lie_inside_the_facets(small_roller, general):
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
    with pytest.raises(InputError, match="contact grid finer than the surface mesh.*use spacing >= 0.017"):
        reduced(small_roller, general=general, spacing=spacing)


def test_holes_and_separate_arcs_are_refused(small_roller):
    corner = small_roller.select("part", "rim", lambda c: (c[:, 1] < 0.0) | (c[:, 0] > 0.0))
    with pytest.raises(InputError, match="uncovered"):
        reduced(corner, contact={"part": Cylinder()})
    apart = small_roller.select("part", "rim", lambda c: np.abs(c[:, 0]) > 0.03)
    with pytest.raises(InputError, match="more than one arc"):
        reduced(apart, contact={"part": Cylinder()})


def band(kind: str, turn: float = 2.0 * np.pi, shape=None, seed: int = 0):
    """Points and facets of an irregular mesh of a band of a crowned surface, nodes on the true surface."""
    if shape is None:
        shape = CrownedCylinder(
            radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 1, 0), crown_radius=0.3, fit_tolerance=1e-6
        )
    columns, rows = 20, 4
    step = 2 if kind in ("quad8", "quad9", "tri6") else 1
    theta = np.linspace(0.0, turn, step * columns + 1)
    z = np.linspace(-0.01, 0.01, step * rows + 1)
    where = np.stack(np.meshgrid(theta, z, indexing="ij"), axis=-1)
    shift = np.random.default_rng(seed).uniform(-0.1, 0.1, where.shape) * [theta[step], z[step] - z[0]]
    shift[:, [0, -1], 1] = 0.0  # nodes on the edges of the band stay there
    closed = np.isclose(turn, 2.0 * np.pi)
    shift[-1] = shift[0] = 0.0
    where = where + shift
    if step == 2:  # nodes in the middle of edges, in the chart: facets are straight there
        where[1::2] = 0.5 * (where[:-1:2] + where[2::2])
        where[:, 1::2] = 0.5 * (where[:, :-1:2] + where[:, 2::2])
    number = np.arange(where[..., 0].size).reshape(where.shape[:2])
    if closed:
        number[-1] = number[0]

    def corner(i, j):
        return number[i : len(theta) - step + i : step, j : len(z) - step + j : step].ravel()

    # outward: e_theta x t_z is the outward normal
    a, b, c, d = corner(0, 0), corner(step, 0), corner(step, step), corner(0, step)
    facets = {
        "quad4": lambda: {"quad4": [a, b, c, d]},
        "tri3": lambda: {"tri3": [np.r_[a, a], np.r_[b, c], np.r_[c, d]]},
        "quad8": lambda: {"quad8": [a, b, c, d, corner(1, 0), corner(2, 1), corner(1, 2), corner(0, 1)]},
        "quad9": lambda: {"quad9": [a, b, c, d, corner(1, 0), corner(2, 1), corner(1, 2), corner(0, 1), corner(1, 1)]},
        "tri6": lambda: {
            "tri6": [
                *(np.r_[a, a], np.r_[b, c], np.r_[c, d]),
                *(
                    np.r_[corner(1, 0), corner(1, 1)],
                    np.r_[corner(2, 1), corner(1, 2)],
                    np.r_[corner(1, 1), corner(0, 1)],
                ),
            ]
        },
        "mixed": lambda: {
            "quad4": [v[::2] for v in (a, b, c, d)],
            "tri3": [np.r_[a[1::2], a[1::2]], np.r_[b[1::2], c[1::2]], np.r_[c[1::2], d[1::2]]],
        },
    }[kind]()
    points = shape.point(where[..., 0].ravel(), where[..., 1].ravel())
    return points, {k: np.stack(nodes, axis=1) for k, nodes in facets.items()}, shape


LINEAR = ["quad4", "tri3", "mixed"]
KINDS = [*LINEAR, "quad8", "quad9", "tri6"]


@pytest.mark.parametrize("basis", ["nodes", "cells"])
@pytest.mark.parametrize("kind", KINDS)
def test_functions_of_any_grid_on_any_facets(kind, basis):
    """Non-negative, a partition of unity, areas those of the Gram matrix, and total loads of constant tractions."""
    points, blocks, shape = band(kind)
    facets = ContactFacets.of(points, blocks, shape)
    phi = np.arcsin(0.01 / 0.3)
    area = 4.0 * np.pi * 0.3 * ((0.05 - 0.3) * phi + 0.3 * np.sin(phi))
    turn = np.linspace(-phi, phi, 201)  # torque int R dA and axial part int cos dA of unit tractions, Simpson's rule
    weight = np.r_[1.0, np.tile([4.0, 2.0], 99), 4.0, 1.0] * (turn[1] - turn[0]) / 3.0
    radius = 0.05 - 0.3 + 0.3 * np.cos(turn)
    torque, axial = (2.0 * np.pi * 0.3 * np.sum(weight * radius * f) for f in (radius, np.cos(turn)))
    for spacing in (0.0059, 0.0123) if kind in LINEAR else (0.0123,):
        plan = facets.plan("rim", spacing)
        total = {}
        for direction in ("normal", "theta", "meridian"):
            field = TractionField(basis, (direction,), plan, facets)
            B = field.loads(len(points))
            total[direction] = np.asarray(B.sum(axis=1)).reshape(-1, 3)
            assert np.abs(total[direction].sum(axis=0)[[0, 2]]).max() < 1e-9 * area
        assert np.all(field.areas() > 0.0)
        # exact where facets are straight triangles in the chart, on distorted ones lines are cut to a small bend
        expected = np.outer(field.gram_theta().sum(1), field.gram_z().sum(1))
        assert np.allclose(field.areas(), expected, rtol=1e-8 if kind == "tri3" else 8.0 * BEND)
        assert field.areas().sum() == pytest.approx(area, rel=1e-9)
        # the arms are those of the nodes: over the 18 degrees of a straight facet 1 - alpha^2/12 of the radius
        moment = np.cross(points, total["theta"])[:, 1].sum()
        assert moment == pytest.approx(torque, rel=0.015 if kind in LINEAR else 1e-3)
        assert total["meridian"].sum(axis=0)[1] == pytest.approx(axial, rel=1e-8)
        other = TractionField("cells" if basis == "nodes" else "nodes", ("meridian",), plan, facets)
        assert np.allclose(other.loads(len(points)).sum(axis=1), B.sum(axis=1), atol=1e-7 * area / len(points))


@pytest.mark.parametrize("kind", KINDS)
def test_projection_of_smooth_displacements(kind):
    """M^-1 B^T u of a displacement along n, e_theta or t_z whose size is constant gives that size everywhere."""
    points, blocks, shape = band(kind)
    facets = ContactFacets.of(points, blocks, shape)
    plan = facets.plan("rim", 0.009)
    theta, z, _ = shape.chart(points)
    for basis in ("nodes", "cells"):
        for direction in ("normal", "theta", "meridian"):
            field = TractionField(basis, (direction,), plan, facets)
            u = surface_vectors(shape, theta, z, direction)
            found = field.without_gram(field.loads(len(points)).T @ u.reshape(-1, 1))
            assert np.abs(found - 1.0).max() < (0.06 if kind in LINEAR else 0.008)


def test_arcs_have_half_functions_at_their_edges():
    points, blocks, shape = band("tri3", turn=2.0)
    facets = ContactFacets.of(points, blocks, shape)
    plan = facets.plan("pad", 0.009)
    assert not plan.periodic
    for basis in ("nodes", "cells"):
        field = TractionField(basis, ("normal",), plan, facets)
        assert np.allclose(field.areas(), np.outer(field.gram_theta().sum(1), field.gram_z().sum(1)), rtol=1e-7)
        assert field.covered(1e-6).all()


def test_a_checkerboard_of_cells_between_nodes_loads_nothing(small_roller):
    """Why cells stand around the nodes: between them, +-1 in turn has no load on a linear mesh at all."""
    shape, plan, _ = loads_of(small_roller, Cylinder())
    kind, nodes = small_roller.facets("rim").single
    chart = facet_chart(small_roller.points, kind, nodes, shape)
    found = {}
    for name, lines in (("between", plan), ("around", plan.lines("cells"))):
        loads = node_loads(kind, nodes, chart, shape, lines, basis="cells")
        sign = (-1.0) ** (loads.column + loads.row)
        found[name] = np.bincount(loads.node, weights=sign * loads.area)
    assert np.abs(found["between"]).max() < 1e-12 * np.abs(found["around"]).max()


@pytest.mark.parametrize("kind", ["quad4", "quad8", "tri3", "tri6"])
@given(seed=st.integers(0, 1000), columns=st.integers(3, 40), rows=st.integers(2, 9))
@settings(max_examples=6, deadline=None)
def test_cut_facets_integrate_polynomials_exactly(kind, seed, columns, rows):
    """Area and first moments over all pieces are those of the rectangle in the chart, wherever the lines run."""
    cylinder = Cylinder(radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 1, 0), fit_tolerance=1e-6)
    points, blocks, shape = band(kind, shape=cylinder, seed=seed)
    ((_, nodes),) = blocks.items()
    chart = facet_chart(points, kind, nodes, shape)
    x = chart.theta * columns / (2.0 * np.pi)
    lines = (int(np.floor(x.min())), int(np.ceil(x.max())))
    facet, place, weight, column, row = cut_points(kind, x, chart.z, lines, np.linspace(-0.01, 0.01, rows))
    N, slopes = facet_kind(kind).shape(place)
    at = [np.einsum("pk,pk->p", N, v[facet]) for v in (x, chart.z)]
    dx, dz = (np.einsum("pk,pkd->pd", v[facet], slopes) for v in (x, chart.z))
    area = weight * np.abs(dx[:, 0] * dz[:, 1] - dx[:, 1] * dz[:, 0])
    assert area.sum() == pytest.approx(0.02 * columns, rel=1e-12)
    cell = column % columns * (rows - 1) + row
    exact = 1e-9 if kind == "tri3" else 8.0 * BEND
    assert np.bincount(cell, weights=area) == pytest.approx(0.02 / (rows - 1), rel=exact)
    assert np.sum(area * at[1]) == pytest.approx(0.0, abs=1e-14 * columns)
    assert np.sum(area * at[1] ** 2) == pytest.approx(columns * 0.02**3 / 12.0, rel=1e-10)
