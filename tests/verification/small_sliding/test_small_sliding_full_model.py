"""The full finite elements of stacked sheets: matrices, cells, the leaves of Goodman and Klumpp, and motion."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from references.closed_forms import TwoLeaves
from references.finite_elements.meshes import matrices
from references.small_sliding.cells import Cells, facet_cells, gathered, node_cells, together
from references.small_sliding.dynamics import Scheme, peaks, released
from references.small_sliding.full_model import FullModel, Part
from references.small_sliding.quasi_static import StaticSmallSliding
from references.small_sliding.sheets import ROOT, graded_stack, one_body, stack
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, box
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.fe import assemble, assign

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
SLENDER = Material(210e9, 0.0, 7850.0, name="without Poisson's ratio")
ROUND_OFF = 1e-12
SIZE = (0.1, 0.01, 0.004)  # m


def two(order: int = 2, counts: tuple[int, int, int] = (8, 1, 1), material: Material = STEEL) -> FullModel:
    return FullModel([Part(sheet, material, ("x_min",)) for sheet in stack(SIZE, counts, 2, order=order)])


def between(model: FullModel, kind=facet_cells) -> Cells:
    return kind(model, (0, "z_max"), (1, "z_min"))


@pytest.mark.parametrize("order", [1, 2])
def test_matrices_are_those_of_the_package(order: int) -> None:
    """Curved and skewed hexahedra too; scikit-fem and the package number and integrate apart."""
    mesh = box((0.1, 0.03, 0.02), (3, 2, 2), order=order)
    x = mesh.points
    bent = x + 0.1 * np.stack([x[:, 1] * x[:, 2], x[:, 0] ** 2, x[:, 0] * x[:, 1]], axis=1)
    for points in (x, bent):
        moved = Mesh(points, mesh.cells, mesh.facet_sets)
        ours = matrices(moved, STEEL)
        theirs = assemble(points, moved.cells, assign(moved, STEEL))
        # bent cells have rational gradients and masses of a higher degree: one rule or another
        for found, wanted, near in zip(ours, theirs, (1e-13 if points is x else 1e-3, 1e-7), strict=True):
            assert abs(found - wanted).max() < near * abs(wanted).max()
        R = rigid_modes(points, points.mean(axis=0))
        assert np.abs(ours[0] @ R).max() < ROUND_OFF * abs(ours[0]).max()
        assert R[:, 0] @ (ours[1] @ R[:, 0]) == pytest.approx(STEEL.density * moved.volume(), rel=1e-9)


def tetrahedra(order: int) -> Mesh:
    """A box of hexahedra cut along their diagonals."""
    block = box((0.1, 0.03, 0.02), (3, 2, 2), order=1)
    cuts = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
    cells = np.concatenate([block.cells["hex8"][:, list(cut)] for cut in cuts])
    if order == 1:
        return Mesh(block.points, {"tet4": cells})
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    x, columns, number = list(block.points), [cells], {}
    for place in cell_kind("tet10").nodes[4:]:
        a, b = next((a, b) for a, b in combinations(range(4), 2) if np.allclose(corner[a] + corner[b], 2.0 * place))
        middle = []
        for i, j in np.sort(cells[:, [a, b]], axis=1).tolist():
            if (i, j) not in number:
                number[i, j] = len(x)
                x.append(0.5 * (block.points[i] + block.points[j]))
            middle.append(number[i, j])
        columns.append(np.array(middle)[:, None])
    return Mesh(np.array(x), {"tet10": np.concatenate(columns, axis=1)})


@pytest.mark.parametrize("order", [1, 2])
def test_matrices_of_tetrahedra_are_those_of_the_package(order: int) -> None:
    mesh = tetrahedra(order)
    theirs = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    for found, wanted in zip(matrices(mesh, STEEL), theirs, strict=True):
        assert abs(found - wanted).max() < 1e-12 * abs(wanted).max()


@pytest.mark.slow
def test_a_body_that_nothing_holds_is_named() -> None:
    lower, upper = stack(SIZE, (4, 1, 1), 2)
    loose = FullModel([Part(lower, STEEL, ("x_min",)), Part(upper, STEEL)])
    with pytest.raises(InputError, match=r"nothing holds body 1 \(sheet 1\).*add springs"):
        loose.solve(np.zeros((loose.size, 1)))
    a = [loose.spread(1, name, d) for name in ("x_min", "x_max", "y_min") for d in np.eye(3)]
    assert loose.with_springs(*((v, 1e6) for v in a)).solve(np.zeros((loose.size, 1))).max() == 0.0


def test_cells_see_relative_motion_and_balance() -> None:
    model = two()
    for cells in (between(model), between(model, node_cells)):
        # a held pair of nodes is no cell, its share of the area is missing
        assert cells.area.sum() <= 0.001 * (1.0 + ROUND_OFF)
        assert np.allclose(cells.frames[:, 0], [0.0, 0.0, 1.0]) and np.allclose(np.linalg.det(cells.frames), 1.0)
        upper = np.zeros((len(model.points), 3))
        upper[model.offsets[1] :] = [3.0, -2.0, 5.0]
        seen = (cells.loads.T @ upper.ravel()).reshape(-1, 3)
        assert np.allclose(seen, np.einsum("cij,j->ci", cells.frames, [3.0, -2.0, 5.0]), atol=ROUND_OFF)
        whole = rigid_modes(model.points, np.zeros(3))
        assert np.abs(cells.loads.T @ whole).max() < ROUND_OFF  # forces and moments balance
    facets = between(model)
    assert facets.count == 8 and facets.area.sum() == pytest.approx(0.001)
    halves = gathered(facets, np.arange(8) // 2)
    assert halves.count == 4 and np.allclose(halves.area, 0.00025)
    mean = 0.5 * (facets.loads.toarray()[:, :3] + facets.loads.toarray()[:, 3:6])
    assert np.allclose(halves.loads.toarray()[:, :3], mean, atol=1e-15)
    assert together([facets, halves]).count == 12
    apart = FullModel(
        [Part(m, STEEL, ("x_min",)) for m in (stack(SIZE, (8, 1, 1), 2)[0], stack(SIZE, (7, 1, 1), 2)[1])]
    )
    with pytest.raises(InputError, match="facet at .* has no partner.*meshes that match"):
        between(apart)


@pytest.mark.slow
def test_mean_of_a_spread_load_and_springs() -> None:
    model = two()
    a = model.spread(1, "x_max", (0.0, 0.0, 1.0))
    assert a.reshape(-1, 3).sum(axis=0) == pytest.approx([0.0, 0.0, 1.0])
    tilted = (model.points[:, 2] * 2.0 + 1.0)[:, None] * [0.0, 0.0, 1.0]
    assert a @ tilted.ravel() == pytest.approx(2.0 * 0.006 + 1.0)  # at the middle of the end face
    k = 3e5
    compliance = a @ model.solve(a[:, None])[:, 0]
    sprung = model.with_springs((a, k))
    # a spring in parallel: 1/(1/c + k)
    assert a @ sprung.solve(a[:, None])[:, 0] == pytest.approx(1.0 / (1.0 / compliance + k), rel=1e-8)
    assert model.body_force((0.0, 0.0, -9.81)).sum() == pytest.approx(-9.81 * 2 * 7850.0 * 4e-6)


@cache
def leaves() -> tuple[TwoLeaves, StaticSmallSliding, np.ndarray]:
    """L/h = 100, as slender as the closed form is; loads: pressure on both sides, force at both tips."""
    L, b, h = 0.2, 0.01, 2e-3
    form = TwoLeaves(L, b, h, SLENDER.youngs_modulus, 0.3, 1e6)
    model = FullModel([Part(s, SLENDER, ("x_min",)) for s in stack((L, b, h), (40, 1, 1), 2)])
    pressed = model.spread(1, "z_max", (0.0, 0.0, -1.0)) + model.spread(0, "z_min", (0.0, 0.0, 1.0))
    tip = 0.5 * (model.spread(0, "x_max", (0.0, 0.0, 1.0)) + model.spread(1, "x_max", (0.0, 0.0, 1.0)))
    lap = StaticSmallSliding(model, between(model), form.friction)
    return form, lap, np.stack([pressed, tip], axis=1)


@pytest.mark.slow
def test_two_leaves_have_the_closed_loop() -> None:
    """Case A1: stuck and slipping stiffness, loop; 0.5 %."""
    form, lap, loads = leaves()
    peak = 2.0 * form.slip_force
    P = peak * np.concatenate(
        [[0.0], np.linspace(0.25, 1.0, 4), np.linspace(1.0, -1.0, 9)[1:], np.linspace(-1.0, 1.0, 9)[1:]]
    )
    path = np.stack([np.full(len(P), form.pressure * form.length * form.width), P], axis=1)
    found = lap.follow(loads, path, loads[:, 1:])
    tip = found.observed[:, 0]
    near = 0.005 * abs(tip).max()
    assert np.abs(tip[1:5] - form.loading(P[1:5])).max() < near
    assert np.abs(tip[4:13] - form.unloading(P[4:13], peak)).max() < near
    assert np.abs(tip[12:] - form.reloading(P[12:], peak)).max() < near
    assert found.loss(4, 20) == pytest.approx(form.cycle_loss(peak), rel=0.005)
    assert tip[1] / P[1] == pytest.approx(form.length**3 / (24.0 * 210e9 * 0.01 * 8e-9 / 12.0), rel=0.005)
    # forces: the pressure goes through the joint, but for what the clamp holds, with friction at its bound
    assert found.pressure.min() > 0.0
    assert found.force[-1, :, 0].sum() == pytest.approx(path[0, 0], rel=0.005)
    assert np.abs(found.traction[4, :, 0]) == pytest.approx(0.3 * found.pressure[4], rel=1e-9)
    # the work put in during a cycle is lost: trapezoids of eight straight pieces cut the two corners
    assert np.trapezoid(P[4:], tip[4:]) == pytest.approx(form.cycle_loss(peak), rel=0.05)


def test_energy_of_a_path_that_sticks() -> None:
    form, lap, loads = leaves()
    P = 0.5 * form.slip_force
    path = np.array([[form.pressure * form.length * form.width, a * P] for a in (0.0, 1.0)])
    found = lap.follow(loads, path, loads)
    assert found.dissipated == pytest.approx([0.0, 0.0], abs=1e-12)
    work = 0.5 * (path[0] + path[1]) @ (found.observed[1] - found.observed[0])
    assert found.energy[1] - found.energy[0] == pytest.approx(work, rel=1e-7)


@pytest.mark.slow
def test_one_body_with_a_common_root_is_the_sheets() -> None:
    sheets = stack(SIZE, (8, 1, 1), 2)
    body = one_body(sheets)
    body.check()
    assert body.volume() == pytest.approx(8e-6) and len(body.facets(ROOT)) == 2
    found = []
    for model, lower, upper, at in (
        (two(), (0, "z_max"), (1, "z_min"), (1, "x_max")),
        (FullModel([Part(body, STEEL, (ROOT,))]), (0, "sheet0_z_max"), (0, "sheet1_z_min"), (0, "sheet1_x_max")),
    ):
        tip = model.spread(*at, (0.0, 0.0, -1.0))[:, None]
        lap = StaticSmallSliding(model, facet_cells(model, lower, upper), 0.2)
        found.append(lap.follow(tip, np.array([[50.0], [20.0], [80.0]]), tip))
    assert found[0].observed == pytest.approx(found[1].observed, rel=1e-9)
    assert np.abs(found[0].force - found[1].force).max() < 1e-8 * np.abs(found[0].force).max()
    assert set(found[0].state.ravel()) >= {0, 2}


@pytest.mark.slow
def test_nodes_and_facets_and_layers_give_like_results() -> None:
    """Three sheets pressed and bent: cells of facets and of nodes; a layer in series lets them slip less."""
    lines = (np.linspace(0.0, SIZE[0], 9), [-0.005, 0.005], [0.0, 0.004])
    model = FullModel([Part(s, STEEL, ("x_min",)) for s in graded_stack(lines, 0.004, 3)])
    pressed = model.spread(2, "z_max", (0.0, 0.0, -1.0)) + model.spread(0, "z_min", (0.0, 0.0, 1.0))
    tip = model.spread(2, "x_max", (0.0, 0.0, -1.0))
    path = np.array([[2e3, 0.0], [2e3, 25.0], [2e3, -25.0], [2e3, 25.0]])
    shown = {}
    for name, kind, layer in (("facets", facet_cells, 0.0), ("nodes", node_cells, 0.0), ("soft", facet_cells, 3e-11)):
        cells = together([kind(model, (k, "z_max"), (k + 1, "z_min")) for k in range(2)])
        lap = StaticSmallSliding(model, cells, 0.1, tangential_compliance=layer)
        shown[name] = lap.follow(np.stack([pressed, tip], axis=1), path, tip[:, None])
    amplitude = {name: np.ptp(r.observed[1:]) for name, r in shown.items()}
    assert amplitude["nodes"] == pytest.approx(amplitude["facets"], rel=0.03)
    assert shown["nodes"].loss(1, 3) == pytest.approx(shown["facets"].loss(1, 3), rel=0.1)
    assert amplitude["soft"] > 1.02 * amplitude["facets"]
    assert shown["soft"].loss(1, 3) < shown["facets"].loss(1, 3)


def test_free_vibration_of_sheets_that_stick() -> None:
    """Friction without end and pressure that never ends: the frequency is that of sheets tied in their cells."""
    model = two(counts=(6, 1, 1))
    cells = between(model)
    pressed = model.spread(1, "z_max", (0.0, 0.0, -1.0)) + model.spread(0, "z_min", (0.0, 0.0, 1.0))
    tip = model.spread(1, "x_max", (0.0, 0.0, 1.0))
    loads = np.stack([pressed, tip], axis=1)
    stiff = 1e17  # N/m: tied by springs far stiffer than the sheets
    K = sp.csr_matrix(model.K + stiff * cells.loads @ cells.loads.T)[model.free][:, model.free]
    M = sp.csc_matrix(model.M[model.free][:, model.free])
    omega = np.sqrt(eigsh(sp.csc_matrix(K), k=1, M=M, sigma=0.0, return_eigenvectors=False)[0])
    period = float(2.0 * np.pi / omega)
    lap = StaticSmallSliding(model, cells, 5.0)
    before = np.array([[1e4, 0.0], [1e4, 5.0]])
    motion = released(
        lap,
        loads,
        before,
        np.array([1e4, 0.0]),
        steps=200,
        step=period / 50.0,
        scheme=Scheme.damped(0.9),
        observed=loads,
    )
    assert motion.dissipated[-1] < 1e-9 * motion.strain[0]
    at = peaks(motion.observed[:, 1] - motion.observed[:, 1].mean())
    late = at[at > 20]
    found = (late[-1] - late[0]) / 50.0 / round((late[-1] - late[0]) / 50.0)
    assert found == pytest.approx(1.0, abs=0.02)  # peaks are known to half a step


@pytest.mark.slow
def test_motion_keeps_its_ledger() -> None:
    """Kinetic and strain energy, less the work of the loads, and what friction and damping took: the trapezoidal rule
    loses nothing else while all cells stay shut."""
    model = two(counts=(6, 1, 1))
    pressed = model.spread(1, "z_max", (0.0, 0.0, -1.0)) + model.spread(0, "z_min", (0.0, 0.0, 1.0))
    tip = model.spread(1, "x_max", (0.0, 0.0, 1.0))
    loads = np.stack([pressed, tip], axis=1)
    lap = StaticSmallSliding(model, between(model), 0.2)
    before = np.array([[2e3, 0.0], [2e3, 40.0]])
    after = np.array([2e3, 0.0])
    rest = {}
    for steps in (200, 400):
        motion = released(
            lap,
            loads,
            before,
            after,
            steps=steps,
            step=2e-3 / steps,
            scheme=Scheme.trapezoidal(),
            damping=(300.0, 1e-6),
            observed=loads,
        )
        assert np.all(motion.state[1:] > 0)
        ledger = motion.kinetic + motion.strain - motion.observed @ after + motion.dissipated + motion.damped
        lost = motion.dissipated[-1] + motion.damped[-1]
        assert motion.dissipated[-1] > 0.2 * lost and motion.damped[-1] > 0.05 * lost
        rest[steps] = np.abs(ledger - ledger[0]).max() / lost
    assert rest[400] < 0.05 and rest[400] < 0.75 * rest[200]  # friction is taken at the end of a step: first order
