"""Surfaces on the device against NumPy: points on the chart, and distances found by minimising over the meridian."""

# Warp kernels confuse it
# pyright: reportInvalidTypeForm=false, reportAssignmentType=false, reportGeneralTypeIssues=false
# pyright: reportOperatorIssue=false
from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
import warp as wp
from scipy.optimize import minimize_scalar

from warpffrf.model.gears import Gear
from warpffrf.model.surfaces import Curve, Extruded
from warpffrf.model.surfaces.height import Height, unit_normal
from warpffrf.online.compile.surfaces import Curves
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.surfaces import smooth, surface

wp.set_module_options(MODULE_OPTIONS)


@dataclass
class Numbers:
    """What a surface is on the device."""

    radius: float = 1.0
    side: float = 1.0
    tangent: float = 0.0
    crown: float = 0.0
    planar: int = 0
    breaks: np.ndarray = field(default_factory=lambda: np.zeros(0))
    coefficients: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    curve: Curve | None = None
    height: Height | None = None

    def at(self, z: Any) -> np.ndarray:
        """R(z) as it is written, not as it is computed."""
        z = np.asarray(z, float)
        R = self.radius + self.tangent * z
        if self.crown:
            R = R - (self.crown - np.sign(self.crown) * np.sqrt(self.crown**2 - z**2))
        for i, c in enumerate(self.coefficients):
            low = -np.inf if i == 0 else self.breaks[i]
            high = np.inf if i == len(self.coefficients) - 1 else self.breaks[i + 1]
            t = z - self.breaks[i]
            R = R - np.where((z >= low) & (z < high), c @ np.stack([t**p for p in range(4)]), 0.0)
        return R


# a drop that begins at 6 mm on either side: 50 (|z| - 6 mm)^3, and 1e-4 of a wave over the middle, slopes continuous
BREAKS = np.array([-0.01, -0.006, 0.006, 0.01])
WAVE = np.array([0.0, 0.0, 2e-2 * 0.012, -2e-2])
ENDS = np.array([[50.0 * 0.004**3, -150.0 * 0.004**2, 150.0 * 0.004, -50.0], [0.0, 0.0, 0.0, 50.0]])
TABLE = np.array([ENDS[0], WAVE, ENDS[1]])
TABLE[1, 1] = 0.0
TABLE[2, :2] = [WAVE @ [1.0, 0.012, 0.012**2, 0.012**3], WAVE @ [0.0, 1.0, 2 * 0.012, 3 * 0.012**2]]

SURFACES = {
    "cylinder": Numbers(0.05),
    "bore": Numbers(0.05, side=-1.0),
    "crowned": Numbers(0.05, crown=0.6),
    "flat crown": Numbers(0.05, crown=1e6),
    "sphere": Numbers(0.012, crown=0.012),
    "cup": Numbers(0.012, crown=0.012, side=-1.0),
    "groove around a shaft": Numbers(0.03, crown=-0.0065),
    "groove in a ring": Numbers(0.04, crown=0.0065, side=-1.0),
    "cone": Numbers(0.03, tangent=0.4),
    "conical bore": Numbers(0.03, tangent=-0.7, side=-1.0),
    "crowned cone": Numbers(0.03, tangent=0.2, crown=0.9),
    "table": Numbers(0.02, breaks=BREAKS, coefficients=TABLE),
    "table in a ring": Numbers(0.02, side=-1.0, breaks=BREAKS, coefficients=TABLE),
    "plane": Numbers(planar=1),
}


def model_of(s: Numbers) -> Model:
    """The caller keeps it: its arrays live as long as it does."""
    m = Model()
    for name, value in (("radius", s.radius), ("side", s.side), ("tangent", s.tangent), ("crown", s.crown)):
        setattr(m.surfaces, name, wp.array([value], dtype=wp.float64, device="cpu"))
    for name, value in (("planar", s.planar), ("table_start", 0), ("table_count", len(s.coefficients))):
        setattr(m.surfaces, name, wp.array([value], dtype=wp.int32, device="cpu"))
    m.surfaces.table_break = wp.array([*s.breaks, 0.0], dtype=wp.float64, device="cpu")
    rows = np.concatenate([s.coefficients, np.zeros((1, 4))])
    m.surfaces.table_coefficient = wp.array(rows, dtype=wp.float64, device="cpu")
    curves = Curves()
    for name, value in curves.add(s.curve, s.height).items():
        of = wp.float64 if isinstance(value, float | np.ndarray) else wp.int32
        setattr(m.surfaces, name, wp.array([value], dtype=of, device="cpu"))
    if curves.pieces:
        m.surfaces.curve_knot = wp.array(curves.knots[0], dtype=wp.float64, device="cpu")
        m.surfaces.curve_piece = wp.array(curves.pieces[0], dtype=wp.float64, device="cpu")
    if s.curve is not None:
        m.surfaces.curve_seed = wp.array(curves.seeds[0], dtype=wp.int32, device="cpu")
    return m


@wp.kernel
def place(models: wp.array(dtype=Model), at: wp.array2d(dtype=real), out: wp.array2d(dtype=vec3)):
    i = wp.tid()
    model = models[0]
    out[i, 0] = surface.local_point(model, 0, at[i, 0], at[i, 1])
    out[i, 1] = surface.local_normal(model, 0, at[i, 0], at[i, 1])
    out[i, 2] = surface.around_of(out[i, 1])
    out[i, 3] = vec3(smooth.radius_of(model, 0, at[i, 1]), smooth.slope_of(model, 0, at[i, 1]), real(0.0))


@wp.kernel
def measure(models: wp.array(dtype=Model), x: wp.array(dtype=vec3), out: wp.array2d(dtype=vec3)):
    i = wp.tid()
    model = models[0]
    foot = surface.foot_of(model, 0, x[i])
    out[i, 0] = vec3(foot.theta, foot.z, foot.distance)
    out[i, 1] = foot.normal
    out[i, 2] = vec3(foot.distance, real(0.0), real(0.0))
    if model.surfaces.planar[0] < surface.EXTRUDED:
        out[i, 2] = vec3(smooth.smooth_distance(model, 0, x[i]), real(0.0), real(0.0))


def run(kernel: Any, s: Numbers, given: wp.array, count: int, width: int) -> np.ndarray:
    out, model = wp.zeros((count, width), dtype=vec3, device="cpu"), model_of(s)
    models = wp.array([model], dtype=Model, device="cpu")
    wp.launch(kernel, dim=count, inputs=[models, given], outputs=[out], device="cpu")
    return out.numpy()


def chart_points(s: Numbers, count: int = 40) -> np.ndarray:
    """theta, z on the part of the surface that bodies have."""
    rng = np.random.default_rng(5)
    theta = rng.uniform(-np.pi, np.pi, count) * (0.01 if s.planar else 1.0)
    reach = 0.009 if not s.crown else min(0.009, 0.8 * abs(s.crown))
    return np.stack([theta, rng.uniform(-reach, reach, count)], axis=1)


def shown(s: Numbers, at: np.ndarray) -> np.ndarray:
    return run(place, s, wp.array(at, dtype=wp.float64, device="cpu"), len(at), 4)


def charted(s: Numbers, x: np.ndarray) -> np.ndarray:
    return run(measure, s, wp.array(x, dtype=vec3, device="cpu"), len(x), 3)


@pytest.mark.parametrize("name", list(SURFACES))
def test_points_and_frames(name: str) -> None:
    """Points lie where the formula says, and (e_theta, t_z, n) are the derivatives of the chart, right-handed."""
    s = SURFACES[name]
    at = chart_points(s)
    theta, z = at.T
    points, normals, around, profile = np.moveaxis(shown(s, at), 1, 0)
    if s.planar:
        assert np.array_equal(points, np.stack([0.0 * z, theta, z], axis=1))
        assert np.array_equal(profile[:, :2], np.tile([1.0, 0.0], (len(z), 1)))
    else:
        R = s.at(z)
        expected = np.stack([R * np.cos(theta), R * np.sin(theta), z], axis=1)
        # the formula as written loses |crown| * 1e-16 to cancellation, which the kernel does not
        assert np.abs(points - expected).max() < 1e-15 + 3e-16 * abs(s.crown)
        assert np.abs(profile[:, 0] - R).max() < 1e-15 + 3e-16 * abs(s.crown)
    step = 1e-6
    by_theta = (shown(s, at + [step, 0.0])[:, 0] - shown(s, at - [step, 0.0])[:, 0]) / (2.0 * step)
    by_z = (shown(s, at + [0.0, step])[:, 0] - shown(s, at - [0.0, step])[:, 0]) / (2.0 * step)
    assert np.abs(by_theta - s.side * profile[:, :1] * around).max() < 1e-9
    t_z = by_z / np.linalg.norm(by_z, axis=1, keepdims=True)
    assert np.abs(np.cross(around, t_z) - normals).max() < 1e-7  # differences over 1 um: curvature of 1/12 mm
    away = points + 1e-4 * normals  # away from the material: outwards, or towards the axis
    if not s.planar:
        sign = np.sign(np.hypot(away[:, 0], away[:, 1]) - s.at(away[:, 2]))
        assert np.all(sign == s.side)


@pytest.mark.parametrize("name", list(SURFACES))
@pytest.mark.parametrize("gap", [0.0, 2e-6, -3e-5, 4e-4])
def test_chart_and_distance(name: str, gap: float) -> None:
    """A point at a distance along the normal has that distance, its foot, and the normal as gradient."""
    s = SURFACES[name]
    at = chart_points(s)
    points, normals = np.moveaxis(shown(s, at), 1, 0)[:2]
    chart, gradient, distance = np.moveaxis(charted(s, points + gap * normals), 1, 0)
    # coordinates of 0.05 m are right to 7e-18, and so are their differences
    assert np.abs(chart[:, 2] - gap).max() < 1e-16
    assert np.array_equal(chart[:, 2], distance[:, 0])
    assert np.abs(chart[:, 1] - at[:, 1]).max() < 1e-12
    turn = (chart[:, 0] - at[:, 0] + np.pi) % (2.0 * np.pi) - np.pi
    assert np.abs(turn).max() < 1e-13
    assert np.abs(gradient - normals).max() < 1e-11


@pytest.mark.parametrize("name", [n for n, s in SURFACES.items() if not s.planar])
def test_distance_is_the_least_of_all(name: str) -> None:
    """Far points too: the distance is the smallest over the meridian, and its gradient that of differences."""
    s = SURFACES[name]
    rng = np.random.default_rng(11)
    reach = 0.02 if not s.crown else min(0.02, abs(s.crown))
    rho = s.radius + s.side * rng.uniform(0.0, 0.004, 12)
    zeta = rng.uniform(-0.5, 0.5, 12) * reach
    theta = rng.uniform(-3.0, 3.0, 12)
    x = np.stack([rho * np.cos(theta), rho * np.sin(theta), zeta], axis=1)
    chart, gradient, _ = np.moveaxis(charted(s, x), 1, 0)
    grid = np.linspace(-reach, reach, 4001)
    for i in range(len(x)):
        if (rho[i] - s.at(zeta[i])) * s.side < 0.0:
            continue

        def off(z: float, i: int = i) -> float:
            return float(np.hypot(rho[i] - s.at(z), zeta[i] - z))

        near = grid[np.argmin(np.hypot(rho[i] - s.at(grid), zeta[i] - grid))]
        spacing = grid[1] - grid[0]
        best: Any = minimize_scalar(
            off, bounds=(near - spacing, near + spacing), method="bounded", options={"xatol": 1e-13}
        )
        assert chart[i, 2] == pytest.approx(best.fun, abs=1e-10 * abs(s.crown) + 1e-12)
    step = 1e-7
    for axis in range(3):
        move = step * np.eye(3)[axis]
        slope = (charted(s, x + move)[:, 0, 2] - charted(s, x - move)[:, 0, 2]) / (2.0 * step)
        assert np.abs(slope - gradient[:, axis]).max() < 1e-7


def test_beyond_the_centre_of_a_groove() -> None:
    """The arc ends 135 degrees from its bottom, and is not the other half of the circle: up to there the distance is
    that from the circle, beyond that from its end."""
    s, end = SURFACES["groove in a ring"], 0.0065 * np.sqrt(0.5)
    x = np.array([[0.04 - 0.0065 - 0.003, 0.0, 0.002], [0.04 - 0.0065 - 0.003, 0.0, -0.002]])
    chart, gradient, _ = np.moveaxis(charted(s, x), 1, 0)
    assert chart[:, 1] == pytest.approx([end, -end])
    assert chart[:, 2] == pytest.approx([np.hypot(end - 0.003, end - 0.002)] * 2)
    assert np.linalg.norm(gradient, axis=1) == pytest.approx([1.0, 1.0])
    far = charted(s, np.array([[0.04 - 0.0065 - 0.01, 0.0, 0.011]]))[0, 0, 2]  # in the bore, not in the ring
    assert far == pytest.approx(np.hypot(0.01 - end, 0.011 - end))
    angle = np.radians([60.0, 90.0, 110.0, -134.0])
    off = 0.006 * np.stack([np.cos(angle), 0.0 * angle, np.sin(angle)], axis=1)
    chart, gradient, _ = np.moveaxis(charted(s, off + [0.04 - 0.0065, 0.0, 0.0]), 1, 0)
    assert chart[:, 2] == pytest.approx([0.0005] * 4, rel=1e-12)
    np.testing.assert_allclose(gradient, -off / 0.006, atol=1e-14)


def test_a_flat_crown_is_a_cylinder() -> None:
    """No digit is lost when the crown's radius is 2e7 times the body's."""
    x = np.array([[0.05 + 1e-6, 0.0, 0.0], [0.05 + 1e-6, 0.0, 0.009]])
    flat = charted(SURFACES["flat crown"], x)[:, 0, 2]
    assert flat - 1e-6 == pytest.approx([0.0, 0.009**2 / 2e6], abs=1e-17)


TURN = 2.0 * np.pi * np.arange(180) / 180
LOBE = (0.04 + 0.01 * np.cos(TURN) + 0.002 * np.cos(3.0 * TURN))[:, None] * np.stack(
    [np.cos(TURN), np.sin(TURN)], axis=1
)
CURVES = {
    "closed": Curve.through(LOBE, closed=True),
    "open": Curve.arcs((0.0, 0.0), 0.3, [(0.02, 0.03), (0.01, np.inf), (0.015, -0.02), (0.01, 0.05)]),
}
DEPTH = 1.5e-3  # m
THIN = replace(CURVES["open"], depth=DEPTH)
NEWTON = 1e-12  # m: both end their Newton iterations at round-off


@pytest.mark.parametrize("name", list(CURVES))
def test_the_foot_on_an_extruded_curve_is_that_of_the_host(name: str) -> None:
    """At 2,000 points near the curve and far from it: chart, distance, and its gradient, the normal at the foot."""
    curve = CURVES[name]
    s, rng = Numbers(planar=2, curve=curve), np.random.default_rng(3)
    u = rng.uniform(curve.knots[0], curve.knots[-1], 2000)
    off = rng.uniform(-1.0, 1.0, 2000) * np.where(np.arange(2000) % 2, 4e-3, 1e-6)
    x = np.concatenate([curve.at(u) + off[:, None] * curve.normal(u), rng.uniform(-0.01, 0.01, (2000, 1))], axis=1)
    found = charted(s, x)
    foot, distance = curve.foot(x[:, :2])
    assert np.allclose(found[:, 2, 0], distance, rtol=0.0, atol=NEWTON)
    assert np.allclose(curve.at(found[:, 0, 0]), curve.at(foot), rtol=0.0, atol=1e3 * NEWTON)  # its square is the error
    assert np.array_equal(found[:, 0, 1], x[:, 2]) and np.array_equal(found[:, 0, 2], found[:, 2, 0])
    assert np.allclose(found[:, 1, :2], curve.normal(foot), rtol=0.0, atol=1e-7)


def test_ends_and_depth_of_a_curve_are_those_of_the_host() -> None:
    """Beyond the ends the distance is that of the end, and the normal points away from it; below the depth, which is
    known to a cell of the lattice, all is free space."""
    rng, (start, end) = np.random.default_rng(4), THIN.knots[[0, -1]]
    u = rng.uniform(start - 2e-3, end + 2e-3, 2000)
    x = THIN.at(u) + rng.uniform(-4e-3, 4e-3, 2000)[:, None] * THIN.normal(u)
    foot, distance = THIN.foot(x)
    known = np.abs(distance + DEPTH) > THIN.seeds[1]
    found = charted(Numbers(planar=2, curve=THIN), np.column_stack([x, np.zeros(2000)]))
    assert np.allclose(found[known, 2, 0], THIN.gap(x)[known], rtol=0.0, atol=NEWTON)
    past = ((foot < start) | (foot > end)) & known & (distance > -DEPTH)
    away = x - THIN.at(np.clip(foot, start, end))
    assert past.sum() > 50 and np.sum(distance < -DEPTH) > 200
    assert np.allclose(found[past, 1, :2], (away / np.linalg.norm(away, axis=1)[:, None])[past], rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("name", list(CURVES))
def test_places_of_an_extruded_curve_are_those_of_the_host(name: str) -> None:
    curve = CURVES[name]
    u = np.linspace(curve.knots[0], curve.knots[-1], 300, endpoint=False)
    points, normals, around, profile = np.moveaxis(
        shown(Numbers(planar=2, curve=curve), np.stack([u, 0.0 * u], 1)), 1, 0
    )
    assert np.allclose(points[:, :2], curve.at(u), rtol=0.0, atol=1e-15)
    assert np.allclose(normals[:, :2], curve.normal(u), rtol=0.0, atol=1e-13)
    assert np.allclose(np.cross(around, [0.0, 0.0, 1.0]), normals, rtol=0.0, atol=1e-13)
    assert np.array_equal(profile[:, :2], np.tile([1.0, 0.0], (len(u), 1)))


FLANK = Gear(4.5e-3, 23, helix_angle=np.radians(20.0), tip_rounding=0.2e-3)


@wp.kernel
def bend(models: wp.array(dtype=Model), x: wp.array(dtype=vec3), out: wp.array2d(dtype=vec3)):
    i = wp.tid()
    model = models[0]
    slope = surface.gradient_slope_of(model, 0, x[i])
    out[i, 0] = slope * vec3(real(1.0), real(0.0), real(0.0))
    out[i, 1] = slope * vec3(real(0.0), real(1.0), real(0.0))
    out[i, 2] = slope * vec3(real(0.0), real(0.0), real(1.0))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("side", ["right", "left"])
def test_helical_flanks_are_those_of_the_host(side: str, sign: float) -> None:
    """Points, normals, charts, distances and their gradients; the gradient rotates with the point as the tensor of the
    host's curvatures states, and near the surface as differences of it do."""
    twist, curve = sign * FLANK.twist, FLANK.flank(side, 2)
    host = Extruded(curve=curve, twist=twist, axis_direction=(0, 0, 1), x_direction=(1, 0, 0))
    s, rng = Numbers(planar=2, curve=curve, tangent=twist), np.random.default_rng(8)
    at = np.stack([rng.uniform(curve.knots[0], curve.knots[-1], 300), rng.uniform(-0.01, 0.01, 300)], axis=1)
    points, normals, around, _ = np.moveaxis(shown(s, at), 1, 0)
    assert np.allclose(points, host.point(*at.T), rtol=0.0, atol=1e-15)
    assert np.allclose(normals, host.normal(*at.T), rtol=0.0, atol=1e-13)
    assert np.allclose(around, host.around(*at.T), rtol=0.0, atol=1e-13)
    x = points + rng.uniform(-1.0, 1.0, (300, 1)) * np.where(np.arange(300) % 2, 3e-4, 1e-6)[:, None] * normals
    chart, gradient, distance = np.moveaxis(charted(s, x), 1, 0)
    theta, z, known = host.chart(x)
    inside = (theta > curve.knots[0]) & (theta < curve.knots[-1])
    assert inside.sum() > 250
    assert np.allclose(distance[inside, 0], known[inside], rtol=0.0, atol=NEWTON)
    assert np.allclose(chart[inside], np.stack([theta, z, known], axis=1)[inside], rtol=0.0, atol=1e4 * NEWTON)

    def slopes(x: np.ndarray) -> np.ndarray:
        return run(bend, s, wp.array(x, dtype=vec3, device="cpu"), len(x), 3)

    flat = inside & (np.hypot(*curve.at(at[:, 0]).T) > 0.5 * FLANK.root_form_diameter + 2e-4)
    flat &= np.hypot(*curve.at(at[:, 0]).T) < 0.5 * FLANK.tip_form_diameter - 2e-4
    tensor = host.curvature_tensor(*at.T)
    assert np.allclose(slopes(points)[flat], tensor[flat], rtol=0.0, atol=1e-4 * np.abs(tensor[flat]).max())
    h, steps = 1e-6, np.eye(3)
    found = np.stack([charted(s, x + h * d)[:, 1] - charted(s, x - h * d)[:, 1] for d in steps], axis=2) / (2.0 * h)
    assert np.allclose(found[flat], slopes(x)[flat], rtol=0.0, atol=2e-3 * np.abs(tensor[flat]).max())
    assert np.allclose(np.linalg.norm(gradient, axis=1), 1.0, rtol=0.0, atol=1e-14)


def waves() -> Height:
    """Heights of waves of 40 um and 5 mm over a cap of 30 mm, 20 mm by 14 mm; the smallest radius is 15 mm."""
    half = np.array([0.01, 0.007])
    u, v = (x.ravel() for x in np.meshgrid(*(np.linspace(-a, a, 41) for a in half), indexing="ij"))
    h = np.sqrt(0.03**2 - u**2 - v**2) - 0.03 + 4e-5 * np.cos(u / 8e-4) * np.sin(v / 9e-4)
    return Height.fitted(np.column_stack([h, u, v]), None)


WAVES = waves()


def test_the_foot_on_a_height_is_that_of_the_host() -> None:
    """At 20,000 points on either side, also beyond the border: chart, distance and normal."""
    rng = np.random.default_rng(6)
    u, v = (rng.uniform(-1.2 * a, 1.2 * a, 20000) for a in WAVES.half)
    h, gradient, _ = WAVES.at(u, v)
    off = rng.uniform(-2e-3, 2e-3, len(u))
    x = np.column_stack([h, u, v]) + off[:, None] * unit_normal(gradient)
    found = charted(Numbers(planar=3, height=WAVES), x)
    foot_u, foot_v, distance = WAVES.foot(x, ends=True)
    assert np.abs(found[:, 2, 0] - distance).max() < 1e-14
    assert np.array_equal(found[:, 0, 2], found[:, 2, 0])
    assert np.abs(found[:, 0, :2] - np.column_stack([foot_u, foot_v])).max() < 1e-10
    foot = np.column_stack([WAVES.at(foot_u, foot_v)[0], foot_u, foot_v])
    far = np.abs(distance) > 1e-6
    assert np.abs((x - foot) / distance[:, None] - found[:, 1])[far].max() < 1e-8


def test_the_normal_of_a_height_turns_as_its_differences_do() -> None:
    s, rng = Numbers(planar=3, height=WAVES), np.random.default_rng(7)
    u, v = (rng.uniform(-0.9 * a, 0.9 * a, 200) for a in WAVES.half)
    h, gradient, _ = WAVES.at(u, v)
    x = np.column_stack([h, u, v]) + rng.uniform(-1e-3, 1e-3, (200, 1)) * unit_normal(gradient)
    found, step = run(bend, s, wp.array(x, dtype=vec3, device="cpu"), len(x), 3), 1e-7
    for axis in range(3):
        ahead, behind = (charted(s, x + sign * step * np.eye(3)[axis])[:, 1] for sign in (1.0, -1.0))
        assert np.abs((ahead - behind) / (2.0 * step) - found[:, :, axis]).max() < 1e-3 * np.abs(found).max()
