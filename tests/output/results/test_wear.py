"""Wear by Archard's law: depths in closed form, volumes, and worn surfaces in the next run."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from patch_rubbing_run import patch_contact
from rubbing_run import make_rubbing_history
from synthetic_run import roller

import warpffrf as wf
from references.closed_forms.elliptic import EllipticContact
from warpffrf.model.surfaces import Extruded
from warpffrf.model.surfaces.worn import worn
from warpffrf.output.result import Result

K, PRESSURE, SLIP, TIME = 2e-14, 1e9, 0.1, np.array([0.0, 1e-3, 4e-3])  # m2/N, Pa, m/s, s
HALF, LENGTH, RADIUS = 0.5e-3, 1.4e-3, 0.02  # m, of `patch_contact`
SUM = 1e-12  # relative: round-off
AXIS: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
CYLINDER = wf.surfaces.Cylinder(radius=RADIUS, **AXIS)
LINE = wf.surfaces.Curve(knots=(-0.05, 0.05), points=((-0.05, 0.0), (0.05, 0.0)), tangents=((1.0, 0.0),) * 2)
FLAT = Extruded(curve=LINE)

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
CROWN, WIDTH, LOAD, SPEED, CREEPAGE, FRICTION = 0.1, 0.01, 200.0, 1.0, 0.5, 0.2  # m, m, N, m/s, -, -
STEPS = 40  # of a revolution: all cells slide, whatever the step


def uniform(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    one = np.ones(np.broadcast_shapes(x.shape, y.shape))
    direction = np.stack([0.6 * one, -0.8 * one])
    return PRESSURE * one, -0.3 * PRESSURE * direction, SLIP * direction


def test_constant_pressure_and_slip_wear_a_roller_and_a_curve_evenly() -> None:
    """All around the roller, 2 W of 2 pi R is under load; the curve does not move away from the patch."""
    depth = K * PRESSURE * SLIP * TIME[-1]
    for shape, expected in ((CYLINDER, depth * HALF / (np.pi * RADIUS)), (FLAT, depth)):
        contact = patch_contact(shape, uniform, widths=(HALF,) * 3)
        contact.time = TIME
        form = contact.wear(K, repetitions=5.0)[0]
        assert form is not None
        values = form.values.ravel()
        assert values[2:-2] == pytest.approx(5.0 * expected, rel=SUM)
        assert values[[1, -2]] == pytest.approx(2.5 * expected, rel=SUM)  # ends of the track, half a cell each side
        assert values[[0, -1]] == pytest.approx(0.0, abs=5.0 * SUM * expected)


@pytest.mark.parametrize("shape", [CYLINDER, FLAT])
def test_no_volume_is_lost_in_the_profile(shape: Any) -> None:
    rng = np.random.default_rng(3)

    def fields(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        p, traction, slip = uniform(x, y)
        return p * rng.random(p.shape), traction, slip * rng.random(p.shape)

    contact = patch_contact(shape, fields, widths=(HALF, 0.8 * HALF, 0.7 * HALF))
    contact.time = TIME
    both = contact.wear((K, 3.0 * K))
    expected = K * contact.friction.wear_rate @ np.diff(TIME, prepend=0.0)
    for form, factor in zip(both, (1.0, 3.0), strict=True):
        assert form is not None
        along, across = (form.z, 2.0 * np.pi * RADIUS) if shape is CYLINDER else (form.theta, LENGTH)
        assert across * np.trapezoid(form.values.ravel(), along) == pytest.approx(factor * expected, rel=SUM)
    assert contact.wear((0.0, K))[0] is None


def test_nodes_of_a_contact_grid_wear_evenly_up_to_the_ends() -> None:
    """Carter's rolling is the same in every section; the nodes at the ends have half a cell."""
    result = Result(make_rubbing_history(roller()))
    contact: Any = result.contact("lower-upper")
    volume = K * contact.friction.wear_rate @ np.diff(result.time, prepend=result.time[0])
    for form in contact.wear(K):
        area = 2.0 * np.pi * float(contact.view.first.shape.radius_at(0.0)) * np.ptp(form.z)
        assert form.values[0] == pytest.approx(volume / area, rel=1e-9)


# --- worn surfaces


def test_a_worn_profile_lies_below_the_old_one_by_the_depth() -> None:
    z = np.linspace(-3e-3, 3e-3, 31)
    depth = 2e-6 * np.cos(np.pi * z / 6e-3) ** 2
    form, at = wf.films.MeasuredForm([0.0], z, depth[None]), np.linspace(-2.9e-3, 2.9e-3, 50)
    exact = 2e-6 * np.cos(np.pi * at / 6e-3) ** 2
    crowned = wf.surfaces.CrownedCylinder(radius=RADIUS, crown_radius=CROWN, **AXIS)
    once = worn(crowned, form, (-5e-3, 5e-3), "roller")
    twice = worn(once, form, (-5e-3, 5e-3), "roller")
    for shape, times in ((once, 1), (twice, 2)):
        away = crowned.chart(shape.point(0.3, at))[2]
        assert away == pytest.approx(-times * exact, abs=1e-10)  # the spline, (0.2 mm)^4/384 of the fourth derivative
    assert worn(CYLINDER, wf.films.BarrelForm(1e-6, 4e-3), None, "roller").radius_at(2e-3) == pytest.approx(
        RADIUS - 1e-6, abs=1e-15
    )


def test_a_worn_curve_lies_below_the_old_one_by_the_depth_and_closes() -> None:
    angle = 2.0 * np.pi * np.arange(180) / 180
    oval = np.stack([0.03 * np.cos(angle), 0.02 * np.sin(angle)], axis=1)
    face = Extruded(curve=wf.surfaces.Curve.through(oval, closed=True))
    u = np.linspace(0.0, face.curve.length, 121)
    depth = 3e-6 * (1.0 - np.cos(2.0 * np.pi * u / face.curve.length))
    depth[-1] = depth[0]
    found = worn(face, wf.films.MeasuredForm(u, [0.0], depth[:, None], periodic=False), None, "cam").curve
    at = np.linspace(0.0, found.length, 77)
    foot, distance = face.curve.foot(found.at(at))
    assert found.closed
    assert -distance == pytest.approx(3e-6 * (1.0 - np.cos(2.0 * np.pi * foot / face.curve.length)), abs=1e-10)
    assert np.linalg.norm(found.at(at, 1), axis=1) == pytest.approx(1.0, abs=1e-5)  # by arc length


def test_forms_and_surfaces_without_a_profile_are_refused() -> None:
    scene = wf.Scene()
    names = {
        "rim": CYLINDER, "bore": wf.surfaces.Bore(radius=RADIUS, **AXIS),
        "table": wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)),
    }  # fmt: skip
    body = scene.add_rigid_body(1.0, (1, 1, 1), name="body", surfaces=names)
    refused: tuple[tuple[str, Any, str], ...] = (
        ("rim", wf.films.LobedForm(1e-6, 3), "changes around the axis"),
        ("bore", wf.films.BarrelForm(1e-6, 0.01), "has no profile"),
        ("table", wf.films.BarrelForm(1e-6, 0.01), "surfaces.Extruded with a straight curve"),
        ("rim", 3.0, "must be one of films"),
    )
    for name, form, message in refused:
        port: Any = body[name]
        with pytest.raises(wf.InputError, match=message):
            port.add_form(form)
    contact = patch_contact(CYLINDER, uniform, widths=(HALF, HALF))
    contact.time = TIME[:2]
    with pytest.raises(wf.InputError, match="negative"):
        contact.wear((1e-14, -1e-14))
    contact.time = TIME[:1]
    with pytest.raises(wf.InputError, match="two saved rows"):
        contact.wear(K)


# --- two rollers, crowned on straight


def rollers(*forms: Any) -> wf.Scene:
    """Half-spaces, the upper roller crowned, guided vertically and loaded, slower by CREEPAGE; `forms` of the wear of
    the upper and the lower one."""
    scene = wf.Scene()
    shapes = wf.surfaces.CrownedCylinder(radius=RADIUS, crown_radius=CROWN, **AXIS), CYLINDER
    upper, lower = (
        wf.half_space_body(1.0, (1e-3,) * 3, STEEL, contact={"rim": shape}, extent=(-0.5 * WIDTH, 0.5 * WIDTH))
        for shape in shapes
    )
    turning, place = SPEED / RADIUS, (0, 0, 2.0 * RADIUS)
    below = scene.add_body(lower, name="lower", angular_velocity=(0, turning, 0))
    above = scene.add_body(upper, name="upper", position=place, angular_velocity=(0, -turning * (1.0 - CREEPAGE), 0))
    for port, form in zip((above["rim"], below["rim"]), forms, strict=False):
        port.add_form(form)
    arm = scene.add_rigid_body(0.1, (1e-4,) * 3, name="arm", position=place).at((0, 0, 0))
    scene.add(wf.joints.Prismatic(scene.ground, arm, axis=(0, 0, 1)))
    for base, port, speed in (
        (scene.ground, below["center"], turning),
        (arm, above["center"], -turning * (1.0 - CREEPAGE)),
    ):
        axle = scene.add(wf.joints.Revolute(base, port, axis=(0, 1, 0)))
        scene.add(wf.joints.Drive(axle, speed, quantity="velocity"))
    scene.add(wf.forces.PointForce(arm, (0, 0, -LOAD)))
    scene.add(wf.Contact(above["rim"], below["rim"], friction=FRICTION, cells=(13, 25), name="pair"))
    return scene


def revolution(scene: wf.Scene) -> wf.Result:
    """Of the lower roller."""
    step = 2.0 * np.pi * RADIUS / SPEED / STEPS
    options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(0.0))  # long steps: the rollers do not vibrate
    result = wf.simulate(scene, STEPS * step, step=step, start="equilibrium", options=options, progress=False)
    assert result.status == "completed", result.message
    return result


@cache
def new() -> wf.Result:
    return revolution(rollers())


def test_a_revolution_wears_both_rollers_by_hertz_and_archard() -> None:
    """p0 pi/2 a (1 - z^2/b^2) is the line load, and all of it slides by the difference of the ways."""
    result = new()
    contact, way = result.contact("pair"), 2.0 * np.pi * RADIUS * CREEPAGE
    hertz = EllipticContact(float(contact.normal_load.mean()), 0.5 * RADIUS, CROWN, 0.5 * 210e9 / (1.0 - 0.3**2))
    a, b = sorted(hertz.half_axes)
    peak = 1.5 * hertz.load / (np.pi * a * b)
    for form in contact.wear(K):
        line = 0.5 * np.pi * peak * a * np.maximum(1.0 - (form.z / b) ** 2, 0.0)
        expected = K * line * way / (2.0 * np.pi * RADIUS)
        inside = np.abs(form.z) < 0.85 * b  # the rim of the patch is a row of cells
        assert form.values[0][inside] == pytest.approx(expected[inside], rel=0.01)
        assert form.values[0] == pytest.approx(expected, abs=0.04 * expected.max())
    volume = 2.0 * np.pi * RADIUS * np.trapezoid(contact.wear(K)[1].values[0], contact.wear(K)[1].z)
    work = contact.friction.field_power @ np.diff(result.time, prepend=0.0)
    assert volume == pytest.approx(K * work / FRICTION, rel=1e-9)


def test_worn_rollers_press_less() -> None:
    """The wear of both removes a part of the crown where it presses most: the relative curvature along the axis falls
    from 1/Rc by 2 x 2 h/b^2 of the profile h (1 - z^2/b^2), and Hertz's pressure with it."""
    contact = new().contact("pair")
    b = float(contact.half_widths[-1].max())
    most = 0.02 * b**2 / CROWN  # each h: 8 % of the curvature in total
    repetitions = most / contact.wear(K)[0].values.max()
    again = revolution(rollers(*contact.wear(K, repetitions=repetitions))).contact("pair")
    before, after = (
        EllipticContact(LOAD, 0.5 * RADIUS, radius, 0.5 * 210e9 / (1.0 - 0.3**2))
        for radius in (CROWN, 1.0 / (1.0 / CROWN - 4.0 * most / b**2))
    )
    expected = after.peak_pressure / before.peak_pressure
    assert expected < 0.982 and again.peak_pressure[-1] / contact.peak_pressure[-1] == pytest.approx(
        expected, rel=0.003
    )


def test_a_form_on_a_mesh_is_a_crown_of_the_mesh() -> None:
    """A parabola off a straight roller, and a roller meshed with that crown, press alike on a straight one."""
    drop, half = 10e-6, 0.01
    peaks = []
    for crown in (None, 0.5 * half**2 / drop):
        mesh = wf.mesh.roller(0.05, 0.03, 2.0 * half, sectors=60, layers=2, axial=6, order=2, crown_radius=crown)
        shape = wf.surfaces.Cylinder() if crown is None else wf.surfaces.CrownedCylinder()
        body = wf.reduce(
            mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": shape}, modes=0,
            grid=wf.ContactGrid(contact_fixed=True), progress=False,
        )  # fmt: skip
        scene = wf.Scene(gravity=(0, 0, 0))
        table = wf.surfaces.Cylinder(radius=0.1, axis_point=(0, 0, -0.15), axis_direction=(0, 1, 0))
        roller = scene.add_body(body, name="roller")
        if crown is None:
            roller["rim"].add_form(wf.films.BarrelForm(drop, 2.0 * half))
            assert body.contact_surfaces["rim"].shape.kind == "cylinder"  # other scenes keep it
        scene.add(wf.joints.Prismatic(scene.ground, roller["bore"], axis=(0, 0, 1)))
        scene.add(wf.forces.PointForce(roller["bore"], (0, 0, -20e3)))
        scene.add(wf.Contact(roller["rim"], scene.ground.surface(table, name="table"), cells=(11, 25), name="pair"))
        peaks.append(wf.equilibrium(scene, progress=False).contact("pair").mean_pressure[0].max(axis=0))
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-3, abs=0.01 * peaks[1].max())
