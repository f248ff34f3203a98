"""Verification: pressure of dry contact without friction, at rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from demos import pin_in_bore
from references.closed_forms import LineContact, PointContact, conformal_by_half_angle, contact_modulus
from references.closed_forms.elastic_sphere import approach_correction
from references.half_space.bodies import half_plane, half_space
from references.wheel_rail import BENCHMARK, BENCHMARK_ENDS, Wheelset
from scenes import rollers, wheel_on_rail
from scenes.half_space import STEEL, PatchMoments, ball, cylinder, pushed
from studies.contact import coarse_points as points
from studies.contact.hertz import hertz_phases
from studies.contact.ripple import approach_for, element_size, ripples, window_for, worst
from studies.validate.case import Row, case
from warpffrf.model import joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import grid
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces.railway import head_of_arcs
from warpffrf.offline import ContactGrid, reduce
from warpffrf.output.simulate import equilibrium

ROOM = "Contact without friction"
HERTZ = "H. Hertz, J. reine angew. Math. 92 (1882) 156; K. L. Johnson, Contact Mechanics (1985)"
MM, MPA, UM = 1e3, 1e-6, 1e6  # of a metre, of a pascal


@case(ROOM, f"{HERTZ}, section 4.2")
def hertz_line() -> Iterator[Row]:
    """C1: 100 N/mm between two steel cylinders of R 50 mm, as a rigid cylinder of twice the relative radius on an exact
    elastic half-plane of steel; 12 nodes in the half-width"""
    line = LineContact(1e5, 0.05, contact_modulus(STEEL))
    width = 0.01
    body = half_plane(33, line.half_width / 12.0, width, STEEL, 20.0 * line.half_width)
    scene, _ = pushed(body, cylinder(0.05), line.load * width, 0.0, 1, 0.0)
    found = PatchMoments.of(equilibrium(scene), -1)
    yield Row("half-width, by the second moment", MM * 2.0 * np.sqrt(found.second[0]), 0.166093, 0.02, "mm")
    yield Row("peak pressure", MPA * found.peak, 383.291, 0.01, "MPa")


@case(ROOM, f"{HERTZ}, section 4.2")
def hertz_point() -> Iterator[Row]:
    """C3: a rigid ball of R 10 mm under 100 N on an exact elastic half-space of steel, 9 nodes in the radius of the
    patch"""
    exact = PointContact(100.0, 0.01, contact_modulus(STEEL))
    body = half_space(27, 27, exact.half_width / 9.0, STEEL)
    scene, _ = pushed(body, ball(exact.radius), exact.load, 0.0, 1, 0.0)
    result = equilibrium(scene)
    found = PatchMoments.of(result, -1)
    approach = exact.radius - float(result.history.bodies["partner"].position[-1, 2])
    yield Row("radius of the patch, by second moments", UM * np.sqrt(2.5 * found.second.sum()), 148.125, 0.02, "µm")
    yield Row("peak pressure", MPA * found.peak, 2176.13, 0.0131, "MPa")
    yield Row("approach", UM * approach, 2.19410, 0.01, "µm")


@case(ROOM, f"{HERTZ}, section 4.2; approach: eq. 5.57")
def solid_roller() -> Iterator[Row]:
    """C1, C2: a solid steel roller of R 50 mm in plane strain (Poisson's ratio 0, the same E/(1 - nu²)) between two
    rigid planes, two quadratic elements on the radius, contact-fixed cells"""
    plane = Material(STEEL.plane_strain_modulus, 0.0, STEEL.density)
    exact = LineContact(1e5, points.ROLLER_RADIUS, contact_modulus(plane))
    approach = points.roller_approach(exact.load, exact.half_width, plane)
    pair = points.pressed_rollers([points.roller(plane, 2, 2)], 2.0 * approach).contact("pair 0")
    yield Row("line load at an approach of 1.81895 µm", 1e-3 * pair.line_load[-1], 100.0, 0.01, "N/mm")
    yield Row("half-width, by the second moment", MM * pair.half_width[-1], 0.166093, 0.016, "mm")
    yield Row("peak pressure", MPA * pair.mid_peak_pressure[-1], 383.291, 0.01, "MPa")


@case(ROOM, f"{HERTZ}, section 4.2: 0.3003 p0 at a depth of 0.786 a")
def shear_below_line() -> Iterator[Row]:
    """C1: largest shear stress below the line contact of a solid steel roller of R 50 mm, four elements on the
    radius"""
    exact = LineContact(points.LINE_LOAD, points.ROLLER_RADIUS, contact_modulus(STEEL))
    depths = points.DEPTHS * exact.half_width
    squeeze = 2.0 * points.roller_approach(points.LINE_LOAD, exact.half_width, STEEL)
    result = points.pressed_rollers([points.roller(STEEL, 4, 1, depths)], squeeze)
    line = replace(exact, load=float(result.contact("pair 0").line_load[-1]))
    value, depth = points.largest(depths, result.stress("roller 0", "below").max_shear[-1])
    yield Row("largest shear stress over p0", value / line.peak_pressure, 0.3003, 0.01)
    yield Row("its depth over a", depth / line.half_width, 0.786, 0.03)


@case(ROOM, f"{HERTZ}, section 4.2; a sphere instead of a half-space: references/closed_forms/elastic_sphere.py")
def solid_ball() -> Iterator[Row]:
    """C3: a ball of finite elements, R 10 mm, five on the radius, under its weight of 100 N on a rigid plane"""
    pair = points.weighed(points.ball(points.STEEL, points.PLAIN), 100.0, points.STEEL).contact("pair")
    softer = 1.0 + approach_correction(148.125e-6, 0.01, points.STEEL)
    yield Row("radius of the patch, the larger", UM * np.max(pair.half_widths[-1]), 148.125, 0.016, "µm")
    yield Row("peak pressure", MPA * pair.peak_pressure[-1], 2176.13, 0.01, "MPa")
    yield Row("approach", UM * pair.history.approach[-1], 2.19410 * softer, 0.01, "µm")


@case(ROOM, "K. L. Johnson, Contact Mechanics (1985), eqs. 3.45")
def stress_below_point() -> Iterator[Row]:
    """C3: largest von Mises stress below a steel ball under 100 N, 0.07 mm below elements of 2 mm"""
    exact = PointContact(points.LOAD, points.BALL_RADIUS, contact_modulus(points.STEEL))
    depths = points.DEPTHS * exact.half_width
    result = points.weighed(points.ball(points.STEEL, points.PLAIN, depths), points.LOAD, points.STEEL)
    found = points.largest(depths, result.stress("ball", "below").von_mises[-1])
    theirs = points.largest(depths, exact.von_mises(depths, 0.3))
    yield Row("largest von Mises stress", MPA * found[0], MPA * theirs[0], 0.01, "MPa")
    yield Row("its depth", UM * found[1], UM * theirs[1], 0.02, "µm")


@case(ROOM, f"{HERTZ}, section 4.2, unlike bodies")
def unlike_rollers() -> Iterator[Row]:
    """A steel roller on one of aluminium, R 50 mm both, four elements on the radius"""
    errors, _ = points.unlike_rollers(points.STEEL, points.ALUMINIUM, 2e-4)
    yield Row("approach over the closed form's", 1.0 + errors.approach, 1.0, 0.01)
    yield Row("half-width over Hertz's at the load", 1.0 + errors.half_width, 1.0, 0.016)
    yield Row("peak pressure over Hertz's", 1.0 + errors.peak, 1.0, 0.01)


@case(ROOM, "A. W. A. Konter, Advanced Finite Element Contact Benchmarks, NAFEMS (2006), benchmark 1, closed form")
def nafems_cylinder() -> Iterator[Row]:
    """P6: a cylinder (R 50 mm, 210 GPa) on a block (70 GPa) under 35 kN/mm, both in plane strain (Poisson's ratio 0,
    the same E/(1 - nu²)); values at the load found, which is within 2 %, scaled to this one by the root"""
    cylinder_of, block_of = (Material(E / 0.91, 0.0, 7850.0) for E in (210e9, 70e9))
    x = np.linspace(-0.1, 0.1, 25)
    mesh = grid(x, np.linspace(-0.01, 0.01, 3), np.linspace(-0.1, 0.0, 13), order=2)
    base = reduce(
        mesh, block_of, interfaces={"z_min": "rigid"}, contact={"z_max": surfaces.Plane(direction=(0, 1, 0))}, modes=0,
        grid=ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip
    radius = points.ROLLER_RADIUS
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(base, name="block")
    scene.add(joints.Fixed(scene.ground, held["z_min"]))
    squeeze = 1.705e-3
    roller = scene.add_body(
        points.roller(cylinder_of, 8, 1), name="roller", position=(0.0, 0.0, radius - 0.6 * squeeze)
    )  # fmt: skip
    points.guided(scene, roller)
    scene.add(Contact(roller["rim"], held["z_max"], grid="contact_fixed", name="pair"))
    roof = points.plane(scene, 2.0 * radius - squeeze, -1.0)
    scene.add(Contact(roller["rim"], roof, grid="contact_fixed", name="roof"))
    pair = points.rested(scene).contact("pair")
    root = np.sqrt(3.5e7 / pair.line_load[-1])
    yield Row("line load found", 1e-6 * pair.line_load[-1], 35.0, 0.02, "kN/mm")
    yield Row("peak pressure", MPA * root * pair.mid_peak_pressure[-1], 3585.4, 0.03, "MPa")
    yield Row("half-width, by the second moment", MM * root * pair.half_width[-1], 6.215, 0.03, "mm")


@cache
def _fine_roller() -> ReducedBody:
    return rollers.roller_body(720, layers=8, axial=2, grading=1.5, order=2, modes=0, cache=False)


@case(ROOM, f"{HERTZ}, section 4.2")
def rollers_mid_plane() -> Iterator[Row]:
    """Two hollow steel rollers on body-fixed grids, four elements in the half-width: eight places of the patch, rolling
    and sliding, the worst"""
    found = [errors.worst() for errors in hertz_phases(_fine_roller(), 4.0).values()]
    yield Row("half-width over Hertz's, worst error", max(width for width, _ in found), 0.0, 0.02, scale=1.0)
    yield Row("peak pressure over Hertz's, worst error", max(peak for _, peak in found), 0.0, 0.01, scale=1.0)


@case(ROOM, "Invariants of rotation: constant force, action and reaction, no torque without friction")
def turning_at_constant_approach() -> Iterator[Row]:
    """C9: two hollow steel rollers rotated at constant approach, two and four elements in the half-width"""
    body = _fine_roller()
    for elements, tolerance in ((2.0, 1e-2), (4.0, 1.5e-3)):
        ripple = worst(ripples(body, elements, phases=2)).value
        yield Row(
            f"change of the force, {elements:g} elements, peak to peak over mean", ripple, 0.0, tolerance, scale=1.0
        )
    turn = element_size(body) / 0.05 * np.linspace(0.0, 1.0, 5)
    path = rollers.Path.of(np.full(5, approach_for(body, 2.0)[0]), turn, 0.3 * turn)
    result = rollers.solve_path(body, body, path, settings=window_for(body, 2.0))
    contact: Any = result.contact(rollers.PAIR)
    size = float(contact.force_magnitude.max())
    torque = np.abs(result.joint("axle").torque[:, 1]).max()
    yield Row("torque of the driven axle over the radius", torque / 0.05, 0.0, 1e-6, "N", size)
    yield Row("force and reaction, sum", np.abs(contact.force + contact.force_second).max(), 0.0, 1e-10, "N", size)


@case(
    ROOM, "A. Persson, On the stress distribution of cylindrical elastic bodies in contact, thesis, Gothenburg (1964)"
)
def pin_in_a_bore() -> Iterator[Row]:
    """Conforming contact: the demo pin_in_bore, pin and sleeve alike, a clearance of 0.1 % of the radius"""
    result = pin_in_bore.run(pin_in_bore.build(progress=False), progress=False)
    pair = result.contact(pin_in_bore.PAIR)
    share = np.gradient(pair.z) * np.where(np.isin(np.arange(len(pair.z)), (0, len(pair.z) - 1)), 0.5, 1.0)
    for angle, end in zip(pin_in_bore.ANGLES, pin_in_bore.waits(), strict=True):
        i = int(np.argmin(np.abs(result.time - end)))
        clearance = pin_in_bore.CLEARANCE * pin_in_bore.RADIUS
        exact = conformal_by_half_angle(
            np.radians(angle), pin_in_bore.RADIUS, clearance, pin_in_bore.MATERIAL, pin_in_bore.MATERIAL
        )
        peak = float((pair.mean_pressure[i] @ share / share.sum()).max())
        yield Row(f"peak pressure, half-angle {angle:g}°", MPA * peak, MPA * exact.peak_pressure, 0.02, "MPa")


@case(
    ROOM,
    "Manchester Contact Benchmark, case A-2.2 (P. Shackleton and S. Iwnicki, Vehicle System Dynamics 46 (2008) 129), "
    "by CONTACT (E. A. H. Vollebregt, open program, examples mbench_a22), cells of 0.2 mm",
)
def wheel_on_rail_benchmark() -> Iterator[Row]:
    """A wheel S1002 of R 460 mm on a rail UIC 60 at 1:40, displaced, rolled and yawed; an elastic wheel of half the
    modulus on a rigid rail, facets of 6 to 12 mm, cells of the patch, on given rows where it touches in two places"""
    curve = head_of_arcs(BENCHMARK_ENDS)
    wheelset = Wheelset(wheel_on_rail.profile(), curve)
    for kind, cases in BENCHMARK.items():
        for one in cases:
            part = kind if kind != "two places" else "flange" if one.y > 1.0 else "tread"
            cells = (wheel_on_rail.STRIPS, wheel_on_rail.ROWS[part]) if kind == "two places" else None
            found = wheel_on_rail.pressed(part, wheelset, curve, one.pose, one.load, cells=cells)
            at = f"{kind}, wheelset at {one.side * one.y:g} mm"
            yield Row(f"peak pressure, {at}", MPA * float(found.peak_pressure[-1]), one.peak, 0.03, "MPa")
            if kind != "two places":
                yield Row(
                    f"centre on the profile, {at}", MM * float(found.center_of_pressure[-1, 1]), one.s, 0.2, "mm", 1.0
                )
