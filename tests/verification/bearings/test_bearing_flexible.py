"""Bearings with flexible rolling elements: solid rollers between rigid rings, two patches on the rim of each."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.online.compile.patches.plan import relative_curvatures
from warpffrf.output.contact.hertz import hertz_point
from warpffrf.scene_file.forms import flat

STEEL = wf.Material(206e9, 0.3, 7850.0)
D, LENGTH, PITCH, LOAD = 0.01, 9.6e-3, 0.034, 1500.0
AXIS, FIRST = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])  # other than the axis y of the mesh
HERTZ = 0.02  # of the peak pressure: ends, which carry less; a core of eight cells around
BALANCE = 1e-6
LOCAL = 0.05  # of the play of a pocket: deformation by the impact


@pytest.fixture(scope="module")
def roller() -> wf.ReducedBody:
    return wf.reduce(
        wf.mesh.roller(0.5 * D, 0.0, LENGTH, sectors=16, layers=2, axial=2), STEEL, interfaces={"ends": "average"},
        contact={"rim": wf.surfaces.Cylinder()}, modes=0, grid=wf.ContactGrid(contact_fixed=True), cache=False,
        progress=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def rest(roller: wf.ReducedBody) -> wf.Result:
    scene = wf.Scene()
    bearing = scene.add_bearing(
        "r", wf.bearings.RollerGeometry(elements=3, roller_diameter=D, roller_length=LENGTH, pitch_diameter=PITCH),
        outer=scene.ground, axis=AXIS, first=FIRST, materials=wf.bearings.Materials(STEEL, element_body=roller),
    )  # fmt: skip
    inner = bearing.inner.at((0, 0, 0))
    scene.add(wf.joints.Prismatic(scene.ground.at((0, 0, 0)), inner, axis=FIRST, name="guide"))
    scene.add(wf.forces.PointForce(inner, LOAD * FIRST, name="load"))
    return wf.equilibrium(scene, progress=False)


@pytest.mark.slow
def test_rollers_stand_with_their_axes_along_the_bearing(rest: wf.Result) -> None:
    for angle, element in zip(rest.scene.bearing("r").geometry.angles, rest.scene.bearing("r").elements, strict=True):
        shape = element["rim"].surface.shape
        np.testing.assert_allclose(element.to_world(shape.e_a) - element.position, AXIS, atol=1e-12)
        out = np.cos(angle) * FIRST + np.sin(angle) * np.cross(AXIS, FIRST)
        np.testing.assert_allclose(element.position, 0.5 * PITCH * out, atol=1e-12)


def hertz_line(line: float, R: float) -> tuple[float, float]:
    """Half-width [m] and peak pressure [Pa] against a rigid partner; line [N/m]."""
    E = STEEL.youngs_modulus / (1.0 - STEEL.poisson_ratio**2)
    a = np.sqrt(4.0 * line * R / (np.pi * E))
    return a, 2.0 * line / (np.pi * a)


def test_a_solid_roller_between_rigid_rings(rest: wf.Result) -> None:
    """The centre of a solid cylinder that is loaded at both ends of a diameter approaches a rigid partner by
    P'(1 - nu^2)/(pi E) (2 ln(4R/a) - 1) in plane strain (Johnson, Contact Mechanics, 5.57) and by the same without
    (1 - nu^2) in plane stress; a roller as long as it is thick is in between. Peak pressures are Hertz's."""
    assert rest.status == "completed", rest.message
    found = rest.bearing("r")
    np.testing.assert_allclose(found.inner_load[0], (LOAD, 0.0, 0.0), rtol=BALANCE, atol=1e-9)
    np.testing.assert_allclose(found.outer_load[0], found.inner_load[0], rtol=BALANCE, atol=1e-9)
    assert abs(found.outer_angle[0, 0]) < BALANCE
    line, bounds = LOAD / LENGTH, np.zeros(2)
    for side, R in (("inner", 1.0 / (2.0 / D + 2.0 / (PITCH - D))), ("outer", 1.0 / (2.0 / D - 2.0 / (PITCH + D)))):
        a, peak = hertz_line(line, R)
        assert rest.history.contacts[f"r {side} 1"].pressure[0].max() == pytest.approx(peak, rel=HERTZ)
        softness = line / (np.pi * STEEL.youngs_modulus) * (2.0 * np.log(2.0 * D / a) - 1.0)
        bounds += softness * np.array([1.0 - STEEL.poisson_ratio**2, 1.0])
    assert bounds[0] < found.displacement[0, 0] < bounds[1]
    assert any("'r roller 2', 'r roller 3' are free" in note for note in rest.history.notes)


def test_pockets_take_flexible_rollers_along(roller: wf.ReducedBody) -> None:
    """A driven cage takes the play, then its rollers, which nothing else touches: they stay in their pockets."""
    scene, play, rate, step = wf.Scene(gravity=(0, 0, 0)), 2e-5, 4e3, 2e-5
    bearing = scene.add_bearing(
        "r",
        wf.bearings.RollerGeometry(
            elements=3, roller_diameter=D, roller_length=LENGTH, pitch_diameter=PITCH, clearance=4e-4,
        ),
        outer=scene.ground, cage=wf.bearings.PocketCage(play),
        materials=wf.bearings.Materials(STEEL, element_body=roller),
    )  # fmt: skip
    speed = wf.signals.Ramp(0.0, rate * 80 * step, duration=80 * step)
    scene.add(wf.joints.Drive(bearing.joints["cage_axle"], speed, quantity="velocity"))
    result = wf.simulate(scene, 80 * step, step=step, progress=False)
    assert result.status == "completed", result.message
    way = 0.5 * PITCH * 0.5 * rate * result.time**2  # of a pocket
    assert way[-1] > 3.0 * play
    for element in bearing.elements:
        place = result.body(element.name).position
        along = np.unwrap(np.arctan2(place[:, 0], place[:, 2]))
        assert np.abs(0.5 * PITCH * (along - along[0]) - way).max() < (0.5 + LOCAL) * play


def test_what_is_no_element_is_refused(roller: wf.ReducedBody) -> None:
    def bearing(**changed: object) -> None:
        arguments = {"elements": 3, "roller_diameter": D, "roller_length": LENGTH, "pitch_diameter": PITCH}
        add = flat(wf.Scene.add_bearing, geometry=wf.bearings.RollerGeometry, materials=wf.bearings.Materials)
        add(wf.Scene(), "r", **{"element_body": roller} | arguments | changed)

    bearing()
    for changed, message in (
        ({"roller_diameter": 0.011}, "a cylinder of diameter 0.01 m, and the elements have 0.011 m"),
        ({"element_body": 3}, "must be a reduced body"),
        ({"diameter_deviations": (1e-6, 0.0, 0.0)}, "diameter_deviations are of rigid elements"),
        ({"flanges": wf.bearings.Flanges(1e-4)}, "ribs stop rigid rollers"),
    ):
        with pytest.raises(wf.InputError, match=message):
            bearing(**changed)
    with pytest.raises(wf.InputError, match="a cylinder of diameter 0.01 m, .* are one of sphere"):
        wf.Scene().add_bearing(
            "b", wf.bearings.BallGeometry(elements=3, ball_diameter=D, pitch_diameter=PITCH),
            materials=wf.bearings.Materials(element_body=roller),
        )  # fmt: skip


@pytest.mark.slow
def test_stiffness_of_a_bearing_with_flexible_rollers(roller: wf.ReducedBody) -> None:
    """Three rollers under preload: alike in both radial directions and about both axes across, as what repeats after a
    third of a turn is, none along the axis, and the one that a small load finds."""

    def pressed(load: float) -> wf.Result:
        scene = wf.Scene()
        bearing = scene.add_bearing(
            "r",
            wf.bearings.RollerGeometry(
                elements=3, roller_diameter=D, roller_length=LENGTH, pitch_diameter=PITCH, clearance=-12e-6,
            ),
            outer=scene.ground, materials=wf.bearings.Materials(STEEL, element_body=roller),
        )  # fmt: skip
        inner = bearing.inner.at((0, 0, 0))
        scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), inner, axis=(0, 1, 0), name="plane"))
        scene.add(wf.forces.PointForce(inner, (load, 0, 0), name="load"))
        return wf.equilibrium(scene, progress=False)

    rest, load = pressed(0.0), 20.0
    found = rest.bearing_stiffness("r")
    K, moved = found.matrix, pressed(load).bearing("r").displacement[0, 0] - rest.bearing("r").displacement[0, 0]
    assert K[0, 0] == pytest.approx(load / moved, rel=1e-3)
    assert K[1, 1] == pytest.approx(K[0, 0], rel=1e-4) and K[4, 4] == pytest.approx(K[3, 3], rel=1e-3)
    assert K[3, 3] > 0.0
    assert abs(K[2, 2]) < 1e-6 * K[0, 0] and abs(K[5, 5]) < 1e-6 * K[3, 3]
    assert found.asymmetry < 1e-3


BALL, BALL_PITCH, GROOVE = 12.7e-3, 64.9985e-3, 6.6e-3  # m
LIGHT, HEAVY = 1500.0, 15000.0  # N: half-axes of 0.22 and 0.46 of the ball's radius
PARABOLA = 0.015  # of Hertz's peak pressures, whose surfaces are parabolas


@pytest.fixture(scope="module")
def ball() -> wf.ReducedBody:
    mesh = wf.mesh.roller(
        0.5 * BALL, 0.0, 0.9 * BALL, crown_radius=0.5 * BALL, sectors=16, layers=3, axial=2, tread=6e-3
    )
    return wf.reduce(
        mesh, STEEL, interfaces={"ends": "average"}, contact={"tread": wf.surfaces.Sphere(axis_direction=(0, 1, 0))},
        modes=0, grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip


def under(ball: wf.ReducedBody, load: float) -> wf.Result:
    scene = wf.Scene()
    bearing = scene.add_bearing(
        "b",
        wf.bearings.BallGeometry(elements=3, ball_diameter=BALL, pitch_diameter=BALL_PITCH, osculation=GROOVE / BALL),
        outer=scene.ground, first=(0, 0, -1), materials=wf.bearings.Materials(STEEL, element_body=ball),
    )  # fmt: skip
    inner = bearing.inner.at((0, 0, 0))
    scene.add(wf.joints.Prismatic(scene.ground.at((0, 0, 0)), inner, axis=(0, 0, 1), name="guide"))
    scene.add(wf.forces.PointForce(inner, (0, 0, -load), name="load"))
    return wf.equilibrium(scene, progress=False)


@pytest.mark.slow
def test_a_ball_in_rigid_grooves(ball: wf.ReducedBody) -> None:
    """Hertz's point contact at both sides, with the modulus of the ball alone; patches reach far up the groove. Its
    half-spaces move each other's origin apart by u = (1 + nu)(3 - 2 nu) F/(4 pi E R) each (Boussinesq, at the distance
    2 R), of which the ball's free surface gives a part back. Patches that cells cannot follow are named."""
    rest = under(ball, LIGHT)
    assert rest.status == "completed", rest.message
    found, modulus, approach = rest.bearing("b"), STEEL.youngs_modulus / (1.0 - STEEL.poisson_ratio**2), 0.0
    for side in ("inner", "outer"):
        curvatures = found.geometry.curvatures(side, 0.0)  # pyright: ignore[reportAttributeAccessIssue]
        hertz = hertz_point(LIGHT, np.diag([float(k) for k in curvatures]), modulus)
        approach += hertz.approach
        assert rest.history.contacts[f"b {side} 1"].pressure[0].max() == pytest.approx(
            hertz.peak_pressure, rel=PARABOLA
        )
    nu, R = STEEL.poisson_ratio, 0.5 * BALL
    apart = 2.0 * (1.0 + nu) * (3.0 - 2.0 * nu) * LIGHT / (4.0 * np.pi * STEEL.youngs_modulus * R)
    assert approach - apart < found.displacement[0, 0] < approach
    assert not any("than its cells may be" in note for note in rest.history.notes)
    heavy = under(ball, HEAVY)
    assert [note[:21] for note in heavy.history.notes if "than its cells may be" in note] == ["contact 'b outer 1': "]


@pytest.mark.slow
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_cells_under_a_ball_have_the_curvatures_at_the_contact_angle(ball: wf.ReducedBody, angle: float) -> None:
    """Off the middle of a groove the ball's axis leans against that of the ring: those of ISO/TS 16281's raceways."""
    scene = wf.Scene()
    bearing = scene.add_bearing(
        "b",
        wf.bearings.BallGeometry(
            elements=3, ball_diameter=BALL, pitch_diameter=BALL_PITCH, osculation=GROOVE / BALL, contact_angle=angle,
        ),
        outer=scene.ground, materials=wf.bearings.Materials(STEEL, element_body=ball),
    )  # fmt: skip
    for contact in scene.contacts:
        side = "inner" if "inner" in contact.name else "outer"
        in_the_groove, around = bearing.geometry.curvatures(side, angle)  # pyright: ignore[reportAttributeAccessIssue]
        np.testing.assert_allclose(relative_curvatures(contact), (around, in_the_groove), rtol=1e-9)
