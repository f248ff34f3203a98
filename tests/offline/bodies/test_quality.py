"""The quality report: closed forms of a bar, independent finite-element matrices, a half-plane, and invariants."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
import scipy.linalg as sla
import scipy.sparse as sp
from offline_bodies import STEEL, reduced
from reference_fe import matrices

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import FacetSet, rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.data import DisplaySurface, Interface
from warpffrf.model.reduced.file import _flatten
from warpffrf.model.reduced.summary import quality_lines
from warpffrf.offline import reduce
from warpffrf.offline.elastic import ElasticModel, orthonormal_rigid
from warpffrf.offline.products import Limits
from warpffrf.offline.quality import (
    captured,
    covered_frequencies,
    grid_error,
    load_residual,
    memory,
    rigid_mass,
    sampled_residual,
)

LENGTH = 0.3
SOFT = Material(70e9, 0.0, 2700.0)  # no lateral contraction: a bar's closed forms hold for a block


def block(counts: tuple[int, int, int], size: tuple[float, float, float]) -> Mesh:
    """hex8 block from the origin, facet set `end` at x = 0."""
    a, b, c = (np.arange(n + 1) for n in counts)
    points = np.stack(np.meshgrid(a, b, c, indexing="ij"), axis=-1).reshape(-1, 3) / counts * size
    ny, nz = counts[1] + 1, counts[2] + 1
    i, j, k = (v.ravel() for v in np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"))

    def node(di: int, dj: int, dk: int) -> np.ndarray:
        return ((i + di) * ny + j + dj) * nz + k + dk

    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack([node(*corner) for corner in corners], axis=1)
    end = cells[i == 0][:, [0, 4, 7, 3]]
    return Mesh(points, {"hex8": cells}, {"end": FacetSet({"quad4": end})})


def held_block(mesh: Mesh, material: Material = SOFT, **settings) -> ReducedBody:
    return reduce(mesh, material, interfaces={"end": "rigid"}, cache=False, progress=False, **settings)


def bare_body(modes: np.ndarray, frequencies: np.ndarray, *, mass: float = 2.0) -> ReducedBody:
    """A slender bar along x with an interface at x = 0 whose motion in each mode is given (m, 6)."""
    inertia = np.diag([1e-4 * mass, mass * LENGTH**2 / 12.0, mass * LENGTH**2 / 12.0])
    return ReducedBody(
        mass,
        np.array([0.5 * LENGTH, 0.0, 0.0]),
        inertia,
        frequencies,
        {"end": Interface("rigid", np.zeros(3), modes)},
        {},
        DisplaySurface(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), np.zeros((len(modes), 0, 3))),
    )


@pytest.mark.parametrize("count", [0, 1, 4])
def test_captured_mass_of_free_bar_modes(count: int) -> None:
    # u_n = sqrt(2/m) cos(n pi x/L): Phi_I Phi_I^T = 2 count/m, so 1/(1 + 2 count) of the mass is missing along x
    mass = 2.0
    modes = np.zeros((count, 6))
    modes[:, 0] = np.sqrt(2.0 / mass)
    share = captured(bare_body(modes, np.arange(1.0, count + 1.0), mass=mass), "end")
    assert share["mass"] == pytest.approx([1.0 - 1.0 / (1.0 + 2.0 * count), 0.0, 0.0], abs=1e-12)
    assert share["inertia"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_captured_mass_of_attachment_modes_of_a_bar() -> None:
    # The attachment modes hold the static shapes under inertia loads. Along x that is x (2 L - x): 5/6 of the mass; the
    # mesh of n cells loses the consistent mass at the held end, 1/(3 n) to first order
    error = []
    for n in (10, 20):
        body = held_block(block((n, 1, 1), (LENGTH, 0.02, 0.02)))
        error.append(5.0 / 6.0 - captured(body, "end")["mass"][0])
    assert abs(error[1]) < 2e-3
    assert error[0] / error[1] == pytest.approx(4.0, rel=0.2)  # second order


def test_complete_basis_misses_the_interface_only() -> None:
    mesh = block((2, 1, 1), (0.2, 0.1, 0.05))
    body = held_block(mesh, STEEL, modes=24)  # 8 free nodes and the interface, without the rigid motions
    share = captured(body, "end")
    _, M = matrices(mesh, STEEL)
    held = mesh.facets("end").node_set
    interface = (3 * held[:, None] + np.arange(3)).ravel()
    inside = np.setdiff1d(np.arange(len(M)), interface)
    point = body.interfaces["end"].point
    R = rigid_modes(mesh.points[held], point)
    Mb = R.T @ M[np.ix_(interface, interface)] @ R
    Mi = M[np.ix_(inside, interface)] @ R
    felt = Mb - Mi.T @ np.linalg.solve(M[np.ix_(inside, inside)], Mi)
    whole = rigid_modes(mesh.points, point)
    expected = 1.0 - np.diag(felt) / np.diag(whole.T @ M @ whole)
    assert [*share["mass"], *share["inertia"]] == pytest.approx(expected, abs=1e-9)


def test_captured_grows_with_the_basis() -> None:
    mesh = block((6, 2, 1), (0.2, 0.1, 0.05))
    shares = [captured(held_block(mesh, STEEL, modes=n), "end") for n in (0, 5, 20)]
    values = np.array([[*s["mass"], *s["inertia"]] for s in shares])
    assert np.all(np.diff(values, axis=0) > -1e-12)
    assert np.all((values > 0.0) & (values < 1.0))


def test_rigid_mass_matches_the_matrices() -> None:
    mesh = block((2, 1, 1), (0.2, 0.1, 0.05))
    body = held_block(mesh, STEEL)
    _, M = matrices(mesh, STEEL)
    point = np.array([0.3, -0.1, 0.2])
    R = rigid_modes(mesh.points, point)
    J = R.T @ M @ R
    assert rigid_mass(body, point) == pytest.approx(J, abs=1e-12 * np.abs(J).max())


@pytest.mark.parametrize("settings", [{"max_frequency": 20e3}, {"modes": 5}, {"max_frequency": 20e3, "modes": 3}])
def test_covered_range_holds_every_mode_of_the_mesh(settings) -> None:
    mesh = block((6, 2, 1), (0.2, 0.1, 0.05))
    body = held_block(mesh, STEEL, **settings)
    K, M = matrices(mesh, STEEL)
    held = mesh.facets("end").node_set  # slaved to six coordinates
    free = np.setdiff1d(np.arange(len(mesh.points)), held)
    T = np.zeros((len(K), 3 * len(free) + 6))
    T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    T[(3 * held[:, None] + np.arange(3)).ravel(), -6:] = rigid_modes(mesh.points[held], body.interfaces["end"].point)
    omega2 = sla.eigvalsh(T.T @ K @ T, T.T @ M @ T)[6:]
    exact = np.sqrt(omega2) / (2.0 * np.pi)
    found = body.report["quality"]["frequencies"]
    number = found["vibration_modes"]
    assert number == np.sum(exact <= found["covered"] * (1.0 + 1e-6)) > 0
    assert body.frequencies[:number] == pytest.approx(exact[:number], rel=1e-8)
    assert found["last_vibration"] == pytest.approx(exact[number - 1])
    if "modes" in settings:
        assert number == settings["modes"]
        assert any(f"modes={number}" in text for text in body.report["quality"]["truncated"])
    else:
        assert found["covered"] == pytest.approx(settings["max_frequency"])


def test_no_range_is_claimed_where_none_is_known() -> None:
    body = bare_body(np.zeros((2, 6)), np.array([10.0, 20.0]))
    nothing = covered_frequencies(body, Limits(None, None))
    assert (nothing["vibration_modes"], nothing["covered"]) == (0, 0.0)
    body.report["basis"] = {"kind": "krylov"}
    assert covered_frequencies(body, Limits(None, None))["covered"] is None


# --- the contact grid, on a half-plane: p -> -ln|x - y|, with the displacement measured from a distance of 20 ---

CELLS, REACH, DEPTH = 3000, 3.0, 20.0


@pytest.fixture(scope="module")
def half_plane() -> tuple[np.ndarray, np.ndarray]:
    """Places (n,) of fine cells and their influence (n, n): double integrals of -ln|x - y| over pairs of cells."""
    d = 2.0 * REACH / CELLS
    x = -REACH + d * (np.arange(CELLS) + 0.5)
    k = d * np.arange(CELLS)

    def twice(s: np.ndarray) -> np.ndarray:
        return 0.5 * s**2 * np.log(np.where(s == 0.0, 1.0, np.abs(s))) - 0.75 * s**2

    return x, sla.toeplitz(-(twice(k + d) - 2.0 * twice(k) + twice(k - d)) + np.log(DEPTH) * d * d)


def grid_nodes(x: np.ndarray, spacing: float, count: int) -> np.ndarray:
    """(n, 2 count + 1) values of nodes about zero."""
    return np.maximum(0.0, 1.0 - np.abs(x[:, None] / spacing - np.arange(-count, count + 1)))


def cells(x: np.ndarray, spacing: float, count: int) -> np.ndarray:
    """(n, 2 count) values of cells on both sides of zero."""
    return (np.floor(x / spacing)[:, None] == np.arange(-count, count)).astype(float)


@pytest.mark.parametrize(
    ("kind", "half", "count"), [("nodes", 4, 11), ("nodes", 2, 3), ("cells", 4, 10), ("cells", 2, 4)]
)
def test_grid_error_estimates_the_true_one(half_plane, kind: str, half: int, count: int) -> None:
    x, A = half_plane
    F = {"nodes": grid_nodes, "cells": cells}[kind](x, 1.0 / half, count)
    C = F.T @ A @ F
    found = grid_error(C, 1, kind=kind, half_width=half)
    assert found is not None and found[1] == half
    p = np.sqrt(np.maximum(0.0, 1.0 - x**2))
    b = F.T @ (A @ p)
    true = 1.0 - b @ np.linalg.solve(C, b) / (p @ A @ p)
    assert 0.9 < found[0] / true < 1.5


def test_grid_error_does_not_depend_on_rows_that_carry_the_same(half_plane) -> None:
    x, A = half_plane
    F = grid_nodes(x, 0.25, 11)
    C = F.T @ A @ F
    one, three = grid_error(C, 1), grid_error(np.kron(C, np.eye(3)), 3)
    assert one is not None and three is not None
    assert three == pytest.approx(one)
    assert grid_error(C[:5, :5], 1) is None


def test_grid_error_falls_with_the_third_power_of_the_spacing(half_plane) -> None:
    x, A = half_plane
    errors = []
    for half in (2, 4, 8):
        F = grid_nodes(x, 1.0 / half, 2 * half)
        found = grid_error(F.T @ A @ F, 1, half_width=half)
        assert found is not None
        errors.append(found[0])
    assert [np.log2(a / b) for a, b in pairwise(errors)] == pytest.approx([3.0, 3.0], abs=0.35)


# --- static completeness, memory, and the report as a whole ---


def test_load_residual_sees_what_is_missing() -> None:
    n = 12  # a chain of masses, free at both ends
    K = np.diag(np.r_[1.0, np.full(n - 2, 2.0), 1.0]) - np.eye(n, k=1) - np.eye(n, k=-1)
    M = np.diag(np.linspace(1.0, 2.0, n))
    model = ElasticModel(K, M, orthonormal_rigid(M, np.ones((n, 1))), lambda F: np.linalg.pinv(K) @ F)
    omega2, V = sla.eigh(K, M)
    omega, Phi = np.sqrt(omega2[1:4]), V[:, 1:4]
    loads = np.eye(n)[:, :5]
    exact = model.flexibility(loads)
    by_global = Phi @ ((Phi.T @ loads) / omega[:, None] ** 2)
    local = exact - by_global
    assert load_residual(model, loads, by_global + local) < 1e-12
    missing = load_residual(model, loads, by_global)
    assert 0.1 < missing <= 1.5
    assert load_residual(model, loads, by_global + 0.99 * local) == pytest.approx(0.01 * missing, rel=1e-6)
    assert sampled_residual(model, sp.csc_matrix(loads)) < 1e-12
    halved = sampled_residual(model, loads, lambda F: 0.5 * model.flexibility(F), count=2)
    assert halved == pytest.approx(0.5)
    assert sampled_residual(model, loads[:, :0]) == 0.0


def test_report_of_a_roller_is_plain_data_and_survives_the_file(small_roller, tmp_path) -> None:
    body = reduced(small_roller, max_frequency=20e3)
    q = body.report["quality"]
    assert json.loads(json.dumps(q)) == q
    assert body.load(body.save(tmp_path / "body.h5")).report["quality"] == q
    assert 0.0 < q["static"]["local_share"]["rim"] < 1.0
    assert 0.0 < q["contact_grid"]["rim"]["error"] < 0.1
    arrays, _ = _flatten(body)
    found = memory(body)
    assert {path: found.get(path) for path in arrays} == {path: a.nbytes for path, a in arrays.items()}
    sizes = list(q["memory"].values())
    assert sizes == sorted(sizes, reverse=True)
    text = "\n".join(quality_lines(body.report))
    for word in ("frequencies", "captured", "local share", "contact grid", "conditioning", "memory", "left out"):
        assert word in text


def test_more_global_modes_leave_less_to_the_local_ones(small_roller) -> None:
    share = [reduced(small_roller, modes=n).report["quality"]["static"]["local_share"]["rim"] for n in (0, 40)]
    assert 0.0 < share[1] < share[0] <= 1.0
