"""Stress operators: sector against whole mesh, traction on the surface, the reduced body against the full model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from offline_bodies import STEEL, reduced
from reference_fe import free_response, matrices

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.stress_field import GridSpan, StressPoints, from_tensor, rotated, sector_frames, to_tensor
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline.contact.contact_grid import facet_chart, nodal_plan
from warpffrf.offline.contact.node_loads import node_loads, surface_vectors
from warpffrf.offline.cyclic.sector import sector_axes
from warpffrf.offline.fe import assign
from warpffrf.offline.stress.operator import traction_correction, traction_operator
from warpffrf.offline.stress.plan import StressPlan

SAME = 1e-12  # of the largest stress: round-off of sums and rotations
FULL = 1e-6  # what the product promises compared with the full model
SINGLE = 3e-7  # transfers are stored in single precision: round-off of sums of some hundred terms
INSIDE = np.random.default_rng(5).uniform((0.02, 0.0, -0.009), (0.045, 6.28, 0.009), (12, 3))
INSIDE = np.stack([INSIDE[:, 0] * np.cos(INSIDE[:, 1]), INSIDE[:, 2], -INSIDE[:, 0] * np.sin(INSIDE[:, 1])], axis=1)


@pytest.fixture(scope="module")
def linear():
    return roller(0.05, 0.015, 0.02, sectors=18, layers=2, axial=2, order=1)


@pytest.fixture(scope="module")
def curved():
    return roller(0.05, 0.015, 0.02, sectors=9, layers=2, axial=1, order=2)


def rim(mesh, name="rim"):
    return {name: Cylinder().fitted(mesh.points[mesh.facets(name).node_set])}


def on_arc(mesh):
    """The mesh with the facets of a part of its rim, some whole sectors, as the set `arc`."""
    return mesh.select("arc", "rim", lambda x: np.arctan2(-x[:, 2], x[:, 0]) % (2.0 * np.pi) < 10.0 / 9.0 * np.pi)


# --- a sector and the whole ---


@pytest.mark.parametrize("wanted", ["rim", "all", "inside", "one side"])
@pytest.mark.parametrize("surface", ["rim", "arc"])
@pytest.mark.parametrize("order", [1, 2])
def test_sector_operator_equals_the_whole(linear, curved, order, surface, wanted) -> None:
    mesh = on_arc(linear if order == 1 else curved)
    half = np.flatnonzero(mesh.points[next(iter(mesh.cells.values()))].mean(axis=1)[:, 1] > 0.0)
    mesh = replace(mesh, cell_sets={"half": half if len(half) else np.arange(mesh.cell_count)})
    points = {"inside": INSIDE, "one side": StressPoints("skin", "half")}.get(wanted, wanted)
    plan = StressPlan(mesh, assign(mesh, STEEL), "here", points, rim(mesh, surface))
    axes = sector_axes(mesh.cyclic.axis_direction, mesh.points[0])
    sectors = plan.sector_operator(axes)
    N = mesh.cyclic.sectors
    u = np.random.default_rng(1).standard_normal(3 * len(mesh.points))
    expected = (plan.operator() @ u).reshape(-1, 6)
    frames = sector_frames(axes, np.arange(N), N)
    local = np.einsum("snj,sji->sni", u.reshape(N, -1, 3), frames).reshape(N, -1)
    per_sector = np.array([sum(B @ local[(s + o) % N] for o, B in sectors.blocks.items()) for s in range(N)])
    found = rotated(per_sector.reshape(N, -1, 6)[sectors.sector, sectors.place], frames[sectors.sector])
    assert np.abs(found - expected).max() < SAME * np.abs(expected).max()
    if wanted == "rim" and surface == "rim":
        assert sectors.place.max() + 1 == len(plan.points) // N  # copies of a point in other sectors share its place


def test_waves_are_the_whole_body(curved) -> None:
    """A wave of harmonic k, put through the blocks and sampled at the points, is the stress of the whole body."""
    plan = StressPlan(curved, assign(curved, STEEL), "here", INSIDE, rim(curved))
    axes = sector_axes(curved.cyclic.axis_direction, curved.points[0])
    sectors, N, k = plan.sector_operator(axes), 9, 2
    rng = np.random.default_rng(2)
    amplitude = rng.standard_normal((3 * len(curved.points) // N, 2)) * (1.0 + 0.5j)
    amplitude += 1j * rng.standard_normal(amplitude.shape)
    turn = np.exp(2j * np.pi * k * np.arange(N) / N)
    user = np.einsum("sij,njm,s->snim", sector_frames(axes, np.arange(N), N), amplitude.reshape(-1, 3, 2), turn)
    wave = sum(np.exp(2j * np.pi * k * o / N) * block for o, block in sectors.blocks.items()) @ amplitude
    expected = plan.operator() @ user.reshape(-1, 2)
    assert np.abs(sectors.sampled(k, wave) - expected).max() < SAME * np.abs(expected).max()


# --- traction on the surface ---


def test_correction_follows_from_the_strains_in_the_surface() -> None:
    """Against the textbook way: strains in the surface from Hooke's law, normal strain from the traction."""
    rng = np.random.default_rng(3)
    nu, E = 0.3, 210e9
    lam, mu = STEEL.lame
    n = rng.standard_normal(3)
    n /= np.linalg.norm(n)
    h, t = rng.standard_normal(6), rng.standard_normal(3)
    found = h + traction_correction(n[None], np.array([nu]))[0] @ (t - traction_operator(n[None])[0] @ h)
    Q, _ = np.linalg.qr(np.column_stack([n, rng.standard_normal((3, 2))]))
    F = np.column_stack([Q[:, 1], Q[:, 2], n])  # columns: two directions in the surface, the normal
    tensor = F.T @ to_tensor(h) @ F
    e = (1.0 + nu) / E * tensor - nu / E * np.trace(tensor) * np.eye(3)
    local_t = F.T @ t
    e_nn = (local_t[2] - lam * (e[0, 0] + e[1, 1])) / (lam + 2.0 * mu)
    dilation = e[0, 0] + e[1, 1] + e_nn
    s = np.zeros((3, 3))
    s[:2, :2] = 2.0 * mu * e[:2, :2] + lam * dilation * np.eye(2)
    s[2] = s[:, 2] = local_t
    assert found == pytest.approx(from_tensor(F @ s @ F.T), rel=1e-10)


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("set_name", ["rim", "arc"])
def test_traction_on_the_surface_is_the_pressure(curved, general, set_name) -> None:
    """sigma n = -p n at nodes and between them, whatever the mesh makes of it; on an arc too."""
    mesh = on_arc(curved)
    shape = rim(mesh)["rim"]
    angle = np.linspace(0.1, 3.4, 9) if set_name == "arc" else np.linspace(0.1, 6.0, 9)
    between = shape.point(angle, np.linspace(-0.008, 0.007, 9))
    stress = {"nodes": set_name, "between": between}
    body = reduced(mesh, general=general, modes=4, contact={set_name: Cylinder()}, stress=stress)
    s = body.contact_surfaces[set_name]
    pressure = np.random.default_rng(4).uniform(0.5e6, 1e6, (s.grid.columns, s.grid.rows))
    if set_name == "arc" and not general:  # the cyclic path inverts the Gram matrix of a full turn
        pressure[[0, -1]] = 0.0
    forces = -s.grid.gram_theta() @ pressure @ s.gram_z
    for name in stress:
        field = body.stress[name]
        tensor = to_tensor(field.evaluate(np.zeros(len(body.frequencies)), {set_name: forces}))
        theta, z, _ = s.shape.chart(field.points)
        normal = s.shape.normal(theta, z)
        column = (theta - s.grid.theta_start) / s.grid.pitch
        turn = 2.0 * np.pi / s.grid.pitch
        column = column % turn if s.grid.periodic else (column + 1.0) % turn - 1.0
        at = np.array([bilinear(pressure, c, v, s.grid) for c, v in zip(column, z, strict=True)])
        traction = np.einsum("pij,pj->pi", tensor, normal)
        assert np.abs(traction + at[:, None] * normal).max() < SINGLE * pressure.max()


def bilinear(values, column, z, grid) -> float:
    """The nodes' value at a place, by hand."""
    j, k = int(np.floor(column)), int(np.clip(np.searchsorted(grid.z, z) - 1, 0, grid.rows - 2))
    s, t = column - j, (z - grid.z[k]) / (grid.z[k + 1] - grid.z[k])
    total = 0.0
    for dj, w in ((0, 1 - s), (1, s)):
        c = (j + dj) % grid.columns if grid.periodic else j + dj
        if 0 <= c < grid.columns:
            total += w * ((1 - t) * values[c, k] + t * values[c, k + 1])
    return total


@pytest.mark.parametrize("kind", ["nodes", "cells"])
def test_traction_in_every_direction(curved, kind) -> None:
    """The operator on displacements leaves no traction on the surface; nodes and cells bring in theirs, whatever their
    direction."""
    shape = rim(curved)["rim"]
    points = shape.point(np.linspace(0.1, 6.0, 9), np.linspace(-0.008, 0.007, 9))
    plan = StressPlan(curved, assign(curved, STEEL), "here", points, {"rim": shape})
    theta, z, _ = shape.chart(plan.points)
    N = traction_operator(shape.normal(theta, z))
    S = plan.operator()
    left = np.einsum("pic,pcu->piu", N, S.toarray().reshape(len(points), 6, -1))
    assert np.abs(left).max() < SAME * np.abs(S).max()
    columns, lines = 18, np.linspace(-0.01, 0.01, 4)
    grid = SurfaceGrid(shape.e_0, 0.05, 2.0 * np.pi / columns, columns, True, lines, columns, kind)
    value = np.random.default_rng(0).standard_normal((3, columns, grid.rows))
    directions = ("normal", "theta", "meridian")
    own = plan.own("rim", grid, GridSpan(0, columns, True), directions) @ value.ravel()
    traction = np.einsum("pic,pc->pi", N, own.reshape(-1, 6))
    column = (theta - 0.05) / grid.pitch % columns
    expected = np.zeros_like(traction)
    for d, direction in enumerate(directions):
        along = surface_vectors(shape, theta, z, direction)
        if kind == "cells":
            at = value[d, column.astype(int), np.searchsorted(lines, z) - 1]
        else:
            at = np.array([bilinear(value[d], c, v, grid) for c, v in zip(column, z, strict=True)])
        expected += at[:, None] * along
    assert np.abs(traction - expected).max() < SAME * np.abs(value).max()


@pytest.mark.parametrize("kind", ["nodes", "cells"])
@pytest.mark.parametrize("set_name", ["rim", "arc"])
def test_tangential_loads_on_both_paths(linear, kind, set_name) -> None:
    """Sector by sector or all at once: the same stress under the same normal and tangential forces."""
    mesh = on_arc(linear)
    settings = {"contact": {set_name: Cylinder()}, "tangential": kind, "modes": 0}
    found = []
    for general in (False, True):
        body = reduced(mesh, general=general, stress={"here": INSIDE * 0.97, "on": set_name}, **settings)
        s, rng = body.contact_surfaces[set_name], np.random.default_rng(6)
        # tractions within the arc, so that the ends of an arc, where the paths differ, carry none
        first = int(np.argmin(np.abs((s.grid.theta - 1.4 + np.pi) % (2.0 * np.pi) - np.pi)))
        pressure = np.zeros((s.grid.columns, s.grid.rows))
        pressure[first : first + 3] = rng.standard_normal((3, s.grid.rows))
        forces = s.grid.gram_theta() @ pressure @ s.gram_z
        assert s.tangential is not None
        grid = s.tangential.grid
        shear = np.zeros((2, grid.columns, grid.rows))
        shear[:, first : first + 3] = rng.standard_normal((2, 3, grid.rows))
        sheared = grid.gram_theta() @ shear @ grid.gram_z(s.shape)
        q = np.zeros(len(body.frequencies))
        on = body.stress["on"]
        order = np.lexsort(np.round(on.points, 9).T)
        both = [body.stress["here"].evaluate(q, {set_name: forces}, {set_name: sheared})]
        both.append(on.evaluate(q, {set_name: forces}, {set_name: sheared})[order])
        found.append(np.concatenate(both))
    assert np.abs(found[0] - found[1]).max() < FULL * np.abs(found[0]).max()


# --- the reduced body and the full model ---


@pytest.fixture(scope="module")
def full(linear):
    """Displacements (n, 3, nodes) of the full model under the nodes of the rim with unit coefficients, bore rigid."""
    K, M = matrices(linear, STEEL)
    points, bore = linear.points, linear.facets("bore").node_set
    free = np.setdiff1d(np.arange(len(points)), bore)
    T = np.zeros((3 * len(points), 3 * len(free) + 6))
    T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    T[(3 * bore[:, None] + np.arange(3)).ravel(), 3 * len(free) :] = rigid_modes(points[bore], np.zeros(3))
    R = np.concatenate([rigid_modes(points[free], np.zeros(3)), np.eye(6)])
    (kind, nodes), shape = linear.facets("rim").single, rim(linear)["rim"]
    chart = facet_chart(points, kind, nodes, shape)
    plan = nodal_plan(chart, "rim")
    assert plan is not None
    loads = node_loads(kind, nodes, chart, shape, plan)
    rows = len(plan.z)
    B = np.zeros((len(points), 3, plan.columns * rows))
    for d in range(3):
        np.add.at(B[:, d], (loads.node, loads.column % plan.columns * rows + loads.row), loads.value[:, d])
    u = T @ free_response(T.T @ K @ T, T.T @ M @ T, R, T.T @ B.reshape(3 * len(points), -1))
    return u.reshape(len(points), 3, -1)


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("modes", [0, 40])
def test_same_stress_as_the_full_model(linear, full, general, modes) -> None:
    body = reduced(linear, modes=modes, general=general, stress={"all": "all", "inside": INSIDE * 0.97})
    s = body.contact_surfaces["rim"]
    pressure = np.random.default_rng(modes).uniform(0.0, 1e6, (s.grid.columns, s.grid.rows))
    pressure[3:] = 0.0
    forces = -s.grid.gram_theta() @ pressure @ s.gram_z
    q = (s.mode_normal.T @ forces.ravel()) / (2.0 * np.pi * body.frequencies) ** 2
    found = body.stress["all"].evaluate(q, {"rim": forces})
    u = -full @ pressure.ravel()
    every = StressPlan(linear, assign(linear, STEEL), "all", "all")  # no contact surface: without the traction
    expected = (every.operator() @ u.ravel()).reshape(-1, 6)
    place = {tuple(np.round(x, 9)): i for i, x in enumerate(linear.points)}
    order = np.array([place[tuple(np.round(x, 9))] for x in body.stress["all"].points])
    on_rim = np.isin(order, linear.facets("rim").node_set)
    scale = np.abs(expected).max()
    assert np.abs(found - expected[order])[~on_rim].max() < FULL * scale
    # on the rim: the same strains in the surface, the applied traction on it
    theta, z, _ = s.shape.chart(linear.points[order[on_rim]])
    normal = s.shape.normal(theta, z)
    t = np.zeros((len(theta), 3))
    j = np.rint((theta - s.grid.theta_start) / s.grid.pitch).astype(int) % s.grid.columns
    k = np.argmin(np.abs(z[:, None] - s.grid.z), axis=1)
    t -= pressure[j, k][:, None] * normal
    h = expected[order[on_rim]]
    missing = t - np.einsum("pij,pj->pi", to_tensor(h), normal)
    exact = h + np.einsum("pcr,pr->pc", traction_correction(normal, np.full(len(h), 0.3)), missing)
    assert np.abs(found[on_rim] - exact).max() < FULL * scale
    # at points within the cells: the operator on the full displacements, and the traction of the corrected nodes
    plan = StressPlan(linear, assign(linear, STEEL), "inside", INSIDE * 0.97, rim(linear))
    field = body.stress["inside"]
    own = field.normal["rim"].of_traction(forces[None])
    direct = (plan.operator() @ u.ravel()).reshape(-1, 6) + own
    assert np.abs(field.evaluate(q, {"rim": forces}) - direct).max() < FULL * scale


def test_wrong_loads_are_refused(linear) -> None:
    field = reduced(linear, modes=0, stress={"here": "rim"}).stress["here"]
    q = np.zeros(len(field.modes))
    with pytest.raises(InputError, match="normal load on contact surface 'bore' does not exist; known: 'rim'"):
        field.evaluate(q, {"bore": np.zeros((18, 3))})
    with pytest.raises(InputError, match=r"normal forces on 'rim' must be \(18, 3\), got \(3, 18\)"):
        field.evaluate(q, {"rim": np.zeros((3, 18))})
    with pytest.raises(InputError, match="modal coordinates are needed"):
        field.evaluate(np.zeros(len(q) + 1), {})


def test_wrong_requests_are_refused(linear) -> None:
    for wanted in ([INSIDE], {"a/b": "rim"}, {"": "rim"}):
        with pytest.raises(InputError, match="stress must be {name: points} with names without '/'"):
            reduced(linear, modes=0, stress=wanted)
    with pytest.raises(InputError, match="stress 'far': 12 of 12 points lie outside the mesh"):
        reduced(linear, modes=0, stress={"far": INSIDE * 1000.0})


def test_file_holds_the_stress(linear, tmp_path) -> None:
    body = reduced(linear, modes=2, stress={"here": INSIDE})
    again = type(body).load(body.save(tmp_path / "body.h5"))
    forces = np.random.default_rng(0).standard_normal((18, 3))
    q = np.ones(len(body.frequencies))
    first, second = (b.stress["here"].evaluate(q, {"rim": forces}) for b in (body, again))
    assert np.array_equal(first, second)
    assert again.content_hash() == body.content_hash()
