"""Full finite elements of large deflections against closed forms, and against what their mechanics asks for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh
from scipy.spatial.transform import Rotation

from references.closed_forms import LEVY_CLAMPED_SQUARE, Elastica, bar_force, pinned_beam_frequency
from references.closed_forms.large_deflections import LEVY_POISSON, LIMIT_STRETCH
from references.large_deflections import statics
from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.motion import released
from references.large_deflections.statics import by_displacement, by_load
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, box, grid
from warpffrf.model.mesh.elements import cell_kind

STEEL = Material(210e9, 0.3, 7850.0)
TETS_OF_HEX = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
BEAM = 2e-3  # B1: what two programs of the same elements may differ by
LEVY = 0.025  # 2 %, his own bound of the error, and 0.5 % of these cells
BENT = 3e-3  # 20 quadratic cells of a beam 60 times as long as deep: shear and stretching are 1e-3 of bending


def small(kind: str) -> Mesh:
    """A few cells of a kind with straight and, but for hex8, slightly bent edges."""
    base = box((0.04, 0.02, 0.01), (2, 1, 1), order=1 if kind in ("hex8", "tet4") else 2)
    if kind.startswith("tet"):
        (cells,) = box((0.04, 0.02, 0.01), (2, 1, 1), order=1).cells.values()
        points = box((0.04, 0.02, 0.01), (2, 1, 1), order=1).points
        tets = np.concatenate([cells[:, list(t)] for t in TETS_OF_HEX])
        if kind == "tet4":
            return Mesh(points, {kind: tets}, {})
        unit = cell_kind("tet10").nodes
        corner = np.stack([1.0 - unit.sum(axis=1), *unit.T], axis=1)  # (10, 4)
        x = np.einsum("ka,eai->eki", corner, points[tets]).reshape(-1, 3)
        points, number = np.unique(x.round(9), axis=0, return_inverse=True)
        return Mesh(points, {kind: number.reshape(-1, 10)}, {})
    wave = 5e-4 * np.sin(90.0 * base.points[:, ::-1])
    return Mesh(base.points + wave, base.cells, {})


@pytest.mark.parametrize("kind", ["hex8", "hex27", "tet4", "tet10"])
def test_forces_and_tangent_are_derivatives(kind) -> None:
    """Of the energy by central differences: 1e-6 is their error at this step; the tangent symmetric to round-off."""
    body = StVenantKirchhoffBody(small(kind), STEEL)
    rng = np.random.default_rng(1)
    u = 2e-3 * rng.standard_normal(body.size)
    v = 1e-3 * rng.standard_normal(body.size)
    h = 1e-4
    f, K = body.forces(u), body.tangent(u)
    assert f @ v == pytest.approx((body.energy(u + h * v) - body.energy(u - h * v)) / (2 * h), rel=1e-6)
    slope = (body.forces(u + h * v) - body.forces(u - h * v)) / (2 * h)
    np.testing.assert_allclose(K @ v, slope, atol=1e-6 * np.abs(slope).max())
    assert abs(K - K.T).max() < 1e-14 * abs(K).max()
    rest = body.tangent(np.zeros(body.size))
    assert abs(rest - body.K).max() < 1e-13 * abs(body.K).max()


def test_rigid_rotation_gives_no_stress() -> None:
    body = StVenantKirchhoffBody(small("hex27"), STEEL)
    turn = Rotation.from_rotvec([0.7, -1.9, 2.2]).as_matrix()
    u = (body.mesh.points @ (turn - np.eye(3)).T + [0.1, 0.2, -0.3]).ravel()
    assert np.abs(body.stress(u)).max() < 1e-12 * STEEL.youngs_modulus
    # and a state that is rotated has the rotated forces
    v = u + 1e-3 * np.random.default_rng(2).standard_normal(body.size)
    back = (v.reshape(-1, 3) @ turn + body.mesh.points @ (turn - np.eye(3))).ravel()
    forces = body.forces(back).reshape(-1, 3) @ turn.T
    np.testing.assert_allclose(body.forces(v), forces.ravel(), atol=1e-11 * np.abs(forces).max())
    assert body.energy(back) == pytest.approx(body.energy(v), rel=1e-11)


def test_newton_doubles_the_digits() -> None:
    """Of a stocky body, strained by a tenth: each residual is the last one squared, to a factor, down to round-off."""
    body = StVenantKirchhoffBody(box((0.1, 0.05, 0.05), (3, 1, 1)), STEEL)
    force = 0.05 * STEEL.youngs_modulus * 0.05**2
    (state,) = by_load(body, body.held("x_min"), body.spread("x_max", (force, 0.0, 0.2 * force)), [1.0])
    r = np.array(state.residuals)
    last = r[r > 1e-14][-3:]
    assert np.log(last[2] / last[1]) / np.log(last[1] / last[0]) > 1.7


def test_bar_through_its_limit_point() -> None:
    """Stretched and pressed to 0.4 of its length, past the least force at 1/sqrt 3: the closed form to round-off."""
    length, side = 0.1, 0.02
    body = StVenantKirchhoffBody(box((length, side, side), (2, 1, 1)), STEEL)
    x = body.mesh.points
    held = [3 * np.flatnonzero(np.isclose(x[:, c], x[:, c].min())) + c for c in range(3)]
    load = body.spread("x_max", (1.0, 0.0, 0.0))
    tip = 3 * body.nearest_node(x.max(axis=0))
    for strains in (np.linspace(0.1, 0.5, 3), np.linspace(-0.1, -0.6, 6)):
        states = by_displacement(body, np.concatenate(held), load, tip, strains * length)
        expected = STEEL.youngs_modulus * side**2 * bar_force(strains)
        np.testing.assert_allclose([s.factor for s in states], expected, rtol=1e-7)
    least = STEEL.youngs_modulus * side**2 * bar_force(LIMIT_STRETCH - 1.0)
    assert min(s.factor for s in states) > least


@pytest.mark.slow
def test_clamped_beam() -> None:
    """Table B1: full St. Venant-Kirchhoff solutions of the same mesh by another program."""
    body = StVenantKirchhoffBody(box((1.0, 0.03, 0.01), (30, 1, 1)), STEEL)
    middle = 3 * body.nearest_node((0.0, 0.0, 0.0)) + 2
    states = by_load(body, body.held("x_min", "x_max"), body.body_force((0, 0, 1.0)), [300, 1200, 6000, 24000])
    np.testing.assert_allclose([s.u[middle] / 0.01 for s in states], [0.32146, 0.88278, 1.90621, 3.23825], rtol=BEAM)


def test_elastica() -> None:
    length, side = 1.0, 1.0 / 60.0
    material = Material(210e9, 0.0, 7850.0)
    body = StVenantKirchhoffBody(box((length, side, side), (20, 1, 1)), material)
    stiffness = material.youngs_modulus * side**4 / 12.0 / length**2
    tip = body.nearest_node((0.5 * length, 0.0, 0.0))
    factors = [0.5, 1.0, 2.0, 4.0]
    states = by_load(body, body.held("x_min"), body.spread("x_max", (0, 0, stiffness)), factors)
    for factor, state in zip(factors, states, strict=True):
        exact = Elastica(factor)
        assert state.u[3 * tip + 2] / length == pytest.approx(exact.deflection, rel=BENT)
        assert -state.u[3 * tip] / length == pytest.approx(exact.shortening, rel=2 * BENT)


@pytest.mark.slow
def test_clamped_plate() -> None:
    """Levy's centre deflections up to twice the thickness; a quarter, cells finer at the edges, which may move along
    themselves as his."""
    side, t = 0.4, 4e-3
    material = Material(210e9, LEVY_POISSON, 7850.0)
    lines = 0.5 * side * (1.0 - (1.0 - np.linspace(0.0, 1.0, 9)) ** 1.5)
    body = StVenantKirchhoffBody(grid(lines, lines, [-0.5 * t, 0.5 * t]), material)
    x = body.mesh.points
    edge, middle = np.isclose(x[:, :2], 0.5 * side), np.isclose(x[:, :2], 0.0)
    across = [3 * np.flatnonzero(edge[:, c] | middle[:, c]) + c for c in (0, 1)]
    held = np.concatenate([*across, 3 * np.flatnonzero(edge.any(axis=1)) + 2])
    centre = 3 * body.nearest_node((0.0, 0.0, 0.0)) + 2
    unit = material.youngs_modulus * t**3 / (side**4 * material.density)  # m/s^2 of q a^4/(E t^4) = 1
    chosen = [17.79, 134.9, 402.0]
    states = by_load(body, held, body.body_force((0, 0, unit)), chosen)
    found = [s.u[centre] / t for s in states]
    np.testing.assert_allclose(found, [LEVY_CLAMPED_SQUARE[q] for q in chosen], rtol=LEVY)


def test_closed_forms() -> None:
    """Tables B2 and B3; the linear limit P L^3/(3 E I), and the force of the bar, whose slope is the derivative."""
    for load, w, u in (
        (0.5, 0.162144, 0.015919),
        (1, 0.301721, 0.056433),
        (2, 0.493457, 0.160642),
        (4, 0.669964, 0.328941),
    ):
        assert (Elastica(load).deflection, Elastica(load).shortening) == pytest.approx((w, u), abs=1e-6)
    assert Elastica(1e-3).deflection == pytest.approx(1e-3 / 3.0, rel=1e-6)
    for amplitude, ratio in ((1, 1.08916), (2, 1.31778), (3, 1.62568), (5, 2.35014)):
        assert pinned_beam_frequency(amplitude) == pytest.approx(ratio, abs=1e-5)
    # to the first order f/f0 = 1 + 3 A^2/(32 r^2) of Duffing's oscillator
    assert pinned_beam_frequency(1e-2) == pytest.approx(1.0 + 3e-4 / 32.0, abs=1e-9)
    assert bar_force(LIMIT_STRETCH - 1.0) == pytest.approx(-1.0 / (3.0 * np.sqrt(3.0)))
    with pytest.raises(InputError, match="elastica: load"):
        Elastica(0.0)


def test_bad_input(monkeypatch) -> None:
    body = StVenantKirchhoffBody(small("hex8"), STEEL)
    monkeypatch.setattr(statics, "ITERATIONS", 1)
    with pytest.raises(InputError, match="no equilibrium found at load factor 1.*by displacement"):
        by_load(body, np.arange(12), np.ones(body.size), [1.0])
    with pytest.raises(InputError, match="hold some dofs"):
        by_load(body, np.zeros(0, dtype=int), np.zeros(body.size), [1.0])
    with pytest.raises(InputError, match="dof 0 is held"):
        by_displacement(body, np.arange(3), np.zeros(body.size), 0, [1.0])


@pytest.mark.slow
def test_released_bar_swings_as_its_modes_and_keeps_its_energy() -> None:
    """A cantilever let go from the shape of its first mode, 1e-4 of its length: the period of the mode, longer by
    (omega h)^2/12; twice as many steps are four times as near. Bent by a third of its length it keeps its energy to the
    square of the step."""
    body = StVenantKirchhoffBody(box((0.2, 0.02, 0.01), (4, 1, 1)), STEEL)
    held = body.held("x_min")
    free = body.free(held)
    omega2, shape = eigsh(body.K[free][:, free].tocsc(), 1, body.M[free][:, free].tocsc(), sigma=0.0)
    omega = float(np.sqrt(omega2[0]))
    u = np.zeros(body.size)
    u[free] = shape[:, 0] / np.abs(shape).max() * 2e-5
    seen = int(np.argmax(np.abs(u)))
    wrong = []
    for steps in (20, 40):
        motion = released(body, held, u, 2.0 * np.pi / omega, steps)
        x = motion.u[:, seen] / u[seen]
        wrong.append(np.arccos(min(x[-1], 1.0)))
        late = 2.0 * np.pi * (2.0 * np.pi / steps) ** 2 / 12.0
        assert wrong[-1] == pytest.approx(late, rel=0.1)
    assert np.log2(wrong[0] / wrong[1]) == pytest.approx(2.0, abs=0.1)
    (bent,) = by_load(body, held, body.spread("x_max", (0.0, 0.0, 2e4)), [1.0])
    drift = [np.ptp(m.energy) / m.energy[0] for m in (released(body, held, bent.u, 5e-3, n) for n in (50, 100))]
    assert drift[1] < 0.4 * drift[0] < 0.02
