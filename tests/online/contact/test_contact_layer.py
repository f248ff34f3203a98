"""Pressures under nonlinear layers against the minimum of their convex energy, found in plain NumPy.

min s.G s/2 + g.s + int Y(p) dA over s >= 0, with p = sum s_j psi_j and Y' = y, the inverse of the law written down here
once more; by Newton's method projected on s >= 0 with a line search (Bertsekas, SIAM J. Control Optim. 20, 1982), which
finds the one minimum of a convex function from anywhere.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pytest

from scenes.rollers import PAIR, Path, StaticPath, guided_pair, prescribed_pair
from warpffrf.model import joints, laws
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.forces import PointForce
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, Settings, find_equilibrium
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.vibrations.eigenmodes import null_space
from warpffrf.online.vibrations.linearise import linearise
from warpffrf.output.result import Result

sys.path.insert(0, str(FilePath(__file__).parents[1]))
from reference_contact import Pose, Problem, contact_problem, gauss

SETTINGS = Settings(window_strain=0.5, residual_tolerance=1e-10)
AGREE = 5e-9  # as in test_contact_reference
STATIONARY = 1e-13  # of the gap: where the projected Newton iteration ends
SHIFT = 1e-12  # m, of powers (warpffrf.model.laws.curves.curve)

Curve = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def power(k: float, n: float) -> Curve:
    """y, y' and Y of p = k [(d + e)^n - e^n]."""

    def curve(p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        x = p / k + SHIFT**n
        whole = x ** (1.0 / n)
        Y = k * (n / (n + 1.0) * (x ** (1.0 + 1.0 / n) - SHIFT ** (n + 1.0))) - SHIFT * p
        return whole - SHIFT, whole / (n * x * k), Y

    return curve


def exponential(p0: float, length: float) -> Curve:
    """y, y' and Y of p = p0 [exp(d/length) - 1e-6]."""

    def curve(p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        x = p / p0 + 1e-6
        Y = length * p0 * (x * np.log(x) - x - 1e-6 * np.log(1e-6) + 1e-6)
        return length * np.log(x), length / (x * p0), Y

    return curve


def table(depths: Any, pressures: Any) -> Curve:
    """y, y' and Y of straight pieces."""
    d, q = np.array(depths), np.array(pressures)

    def curve(p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        i = np.clip(np.searchsorted(q, p, side="right") - 1, 0, len(q) - 2)
        slope = ((d[1:] - d[:-1]) / (q[1:] - q[:-1]))[i]
        whole = np.concatenate([[0.0], np.cumsum(0.5 * (d[1:] + d[:-1]) * (q[1:] - q[:-1]))])
        y = d[i] + slope * (p - q[i])
        return y, slope, whole[i] + 0.5 * (d[i] + y) * (p - q[i])

    return curve


def cell_points(grid: Any, shape: Any, problem: Problem, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of the nodes of the window at the Gauss points of their cells (points, nodes), and the points' areas."""
    xt, wt = gauss(SETTINGS.theta_points)
    xz, wz = gauss(SETTINGS.z_points)
    rows, n = grid.rows, len(columns)
    values, areas = [], []
    for cell in range(-1, n):
        for k in range(rows - 1):
            dz = grid.z[k + 1] - grid.z[k]
            for t, x in enumerate(xt):
                for s, e in enumerate(xz):
                    z = grid.z[k] + e * dz
                    line = np.zeros(n * rows)
                    for column, a in ((cell, 1.0 - x), (cell + 1, x)):
                        if 0 <= column < n:
                            line[column * rows + k] += a * (1.0 - e)
                            line[column * rows + k + 1] += a * e
                    values.append(line)
                    measure = float(shape.radius_at(z)) * np.sqrt(1.0 + float(shape.slope_at(z)) ** 2)
                    areas.append(wt[t] * grid.pitch * wz[s] * dz * measure)
    return np.array(values), np.array(areas)


def minimum(problem: Problem, N: np.ndarray, dA: np.ndarray, curve: Curve) -> np.ndarray:
    """The pressures (nodes,) of the minimum."""
    counted = problem.area > 0.0
    G, g = problem.G, problem.gap

    def value(s: np.ndarray) -> float:
        return float(0.5 * s @ G @ s + g @ s + dA @ curve(N @ s)[2])

    s = np.where(counted, problem.pressures(), 0.0)
    for _ in range(200):
        y, slope, _ = curve(N @ s)
        gradient = G @ s + g + N.T @ (dA * y)
        bound = (s <= 0.0) & (gradient > 0.0) | ~counted
        if np.abs(np.where(bound, 0.0, gradient) / problem.area.max()).max() < STATIONARY:
            return s
        free = ~bound
        H = G + N.T @ ((dA * slope)[:, None] * N)
        step = np.zeros_like(s)
        scale = 1.0 / np.sqrt(np.diag(H)[free])
        step[free] = -scale * np.linalg.solve(H[np.ix_(free, free)] * np.outer(scale, scale), scale * gradient[free])
        begin, length = value(s), 1.0
        while length > 1e-12:
            trial = np.maximum(s + length * step, 0.0)
            if value(trial) <= begin + 1e-4 * gradient @ (trial - s):
                break
            length *= 0.5
        if length <= 1e-12:  # round-off of the value: the gradient is as small as it can be seen
            return s
        s = trial
    raise RuntimeError("no minimum found")


GAUSSIAN = laws.GreenwoodTripp.from_products(40e-6, 0.1, 0.02, 115e9)
CASES: dict[str, tuple[Any, Curve, str, str, float, float]] = {
    "power 3/2": (laws.NonlinearLayer(1e14, 1.5), power(1e14, 1.5), "plain_body", "plain_body", 0.0, 1500e-6),
    "cube, stiff": (laws.NonlinearLayer(1e23, 3.0), power(1e23, 3.0), "plain_body", "other_body", 0.0, 1000e-6),
    "power 2, crowned": (laws.NonlinearLayer(1e18, 2.0), power(1e18, 2.0), "crowned_body", "plain_body", 0.0, 800e-6),
    "asperities": (
        laws.ExponentialAsperities(1e8, 20e-6), exponential(1e8, 20e-6), "plain_body", "other_body", 0.0, 500e-6,
    ),
    "asperities, tilted": (
        laws.ExponentialAsperities(1e8, 60e-6), exponential(1e8, 60e-6), "other_body", "plain_body", 3e-3, 500e-6,
    ),
    "table": (
        laws.TabulatedLayer((-400e-6, -100e-6, -50e-6, 30e-6), (2e9, 2e8, 4e7, 0.0)),
        table((-30e-6, 50e-6, 100e-6, 400e-6), (0.0, 4e7, 2e8, 2e9)), "plain_body", "other_body", 0.0, 1000e-6,
    ),
    "asperities, Gaussian": (
        GAUSSIAN, table(*GAUSSIAN.curve.table[:, :2].T), "plain_body", "other_body", 0.0, 500e-6,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", list(CASES))
def test_pressures_are_the_minimum_of_the_energy(case: str, request: pytest.FixtureRequest) -> None:
    law, curve, first, second, tilt, approach = CASES[case]
    bodies = [request.getfixturevalue(name) for name in (first, second)]
    scene = prescribed_pair(bodies[0], bodies[1], Path.of([approach], 0.021, -0.013), tilt=tilt)
    scene.contacts[0].law = law
    result = Result(StaticPath(scene, settings=SETTINGS).solve(1))
    assert result.status == "completed", result.message
    found = result.history.contacts[PAIR]
    columns = found.first_column[0] + np.arange(found.pressure.shape[1])
    a, b = scene.contacts[0].a.surface, scene.contacts[0].b.surface
    poses = []
    for name in ("lower", "upper"):
        motion = result.history.bodies[name]
        poses.append(Pose(motion.position[0], rot.matrix(motion.rotation[0]), motion.modal[0]))
    problem = contact_problem(
        a, b, poses[0], poses[1], columns, theta_points=SETTINGS.theta_points, z_points=SETTINGS.z_points
    )
    N, dA = cell_points(a.grid, a.shape, problem, columns)
    exact = minimum(problem, N, dA, curve)
    s = found.pressure[0].ravel()
    worst = np.abs(s - exact).max() / exact.max()
    print(f"{case}: {int((exact > 0.0).sum())} active, pressures agree to {worst:.1e}")
    assert (exact > 0.0).sum() >= 4
    assert worst < AGREE
    p = N @ exact
    y, _, complementary = curve(p)
    stored = 0.5 * exact @ problem.G @ exact + dA @ (p * y - complementary)
    assert result.energy["contact"][0] == pytest.approx(stored, rel=1e-8)


def test_the_first_power_is_the_linear_layer(plain_body: Any, other_body: Any) -> None:
    found = []
    for law in (laws.LinearLayer(2e12), laws.NonlinearLayer(2e12, 1.0), laws.TabulatedLayer((-1e-6, 0.0), (2e6, 0.0))):
        scene = prescribed_pair(plain_body, other_body, Path.of([800e-6], 0.021, -0.013))
        scene.contacts[0].law = law
        found.append(StaticPath(scene, settings=SETTINGS).solve(1))
    for other in found[1:]:
        p, q = (h.contacts[PAIR].pressure[0] for h in (found[0], other))
        assert np.abs(p - q).max() < 1e-9 * p.max()
        assert other.energy["contact"][0] == pytest.approx(found[0].energy["contact"][0], rel=1e-9)


@pytest.mark.parametrize(
    "law", [laws.NonlinearLayer(1e15, 1.5), laws.ExponentialAsperities(1e7, 1e-6)], ids=lambda law: law.kind
)
def test_small_motion_sees_the_tangent_of_the_layer(plain_body: Any, law: Any) -> None:
    """The static compliance of the linearised scene is the difference quotient of two equilibria."""

    def pair(load: float) -> Scene:
        scene = guided_pair(plain_body, plain_body, load=load)
        scene.contacts[0].law = law
        return scene

    load, step = 5e3, 5.0
    low, high = (
        find_equilibrium(pair(load + more)).bodies["carriage"].position[-1, 2] for more in (-step, step)
    )  # fmt: skip
    scene = pair(load)
    engine = Engine(scene)
    assert settle(engine)
    linear = linearise(engine)
    S = 1.0 / np.sqrt(np.diag(linear.M))
    N = S[:, None] * null_space(linear.C * S)
    e = np.zeros(len(linear.M))
    e[6 * scene.body("carriage").index + 2] = 1.0
    static = e @ N @ np.linalg.lstsq(N.T @ linear.K @ N, N.T @ e, rcond=1e-14)[0]
    assert static == pytest.approx((low - high) / (2.0 * step), rel=1e-5)  # the layer hardens: 1e-3 of load squared


def test_laws_side_by_side(plain_body: Any) -> None:
    """Two machines in one scene, one with a layer, one without: each as it is alone."""
    loads = {"layer": laws.NonlinearLayer(1e15, 1.5), "bare": laws.Unilateral()}
    together = Scene(gravity=(0.0, 0.0, 0.0))
    alone = {}
    for place, (name, law) in enumerate(loads.items()):
        for scene in (together, Scene(gravity=(0.0, 0.0, 0.0))):
            x = 0.3 * place if scene is together else 0.0
            lower = scene.add_body(plain_body, name=f"{name} lower", position=(x, 0.0, 0.0))
            upper = scene.add_body(plain_body, name=f"{name} upper", position=(x, 0.0, 0.1))
            scene.add(joints.Fixed(scene.ground, lower["bore"], name=f"{name} base"))
            scene.add(joints.Prismatic(scene.ground, upper["bore"], axis=(0.0, 0.0, 1.0), name=f"{name} guide"))
            scene.add(PointForce(upper["bore"], (0.0, 0.0, -20e3)))
            scene.add(Contact(lower["rim"], upper["rim"], law=law, capacity=80, name=name))
            if scene is not together:
                alone[name] = find_equilibrium(scene).contacts[name]
    found = find_equilibrium(together)
    assert found.status == "completed", found.message
    for name, one in alone.items():
        p, q = found.contacts[name].pressure[0], one.pressure[0]
        assert p[p > 0.0].shape == q[q > 0.0].shape
        assert np.abs(p[p > 0.0] - q[q > 0.0]).max() < 1e-8 * q.max()
