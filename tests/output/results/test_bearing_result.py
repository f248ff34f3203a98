"""Bearings in results: tables, patches, lives, stiffness, plots, files; published numbers where there are."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
import pytest

from references.closed_forms.elliptic import EllipticContact
from scenes.published_bearings import E206, E210, MM, p7, p8
from warpffrf.model import forces, laws
from warpffrf.model.bearings import BallGeometry, PocketCage, RollerGeometry, RollingContact
from warpffrf.model.errors import InputError
from warpffrf.model.joints import Fixed
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, simulate

matplotlib.use("Agg")
LIFE = 5e-3  # P7: promised
PRESSURE = 1e-2  # P8: promised


def at_rest(scene: Scene) -> Result:
    return equilibrium(scene, progress=False)


@pytest.fixture(scope="module")
def radial() -> Result:
    return at_rest(p7(0.0, 1e3, 0.0)[0])


@pytest.fixture(scope="module")
def skew() -> Result:
    return at_rest(p7(10e-6, 1e3, 1e3)[0])


@pytest.fixture(scope="module")
def ball_209() -> Result:
    return at_rest(p8(shoulders=(1.5 * MM, 0.25 * MM))[0])


def test_published_reference_lives(radial: Result) -> None:
    """P7, 23.4 kN of dynamic capacity."""
    found = radial.bearing("bearing").reference_life(23400.0)
    assert found.revolutions == pytest.approx(13163.0, rel=LIFE)
    assert at_rest(p7(10e-6, 1e3, 0.0)[0]).bearing("bearing").reference_life(23400.0).revolutions == pytest.approx(
        10795.8, rel=LIFE
    )
    axial = at_rest(p7(0.0, 0.0, 1e3)[0]).bearing("bearing")
    assert axial.reference_life(23400.0).revolutions == pytest.approx(2222.7, rel=1e-4)
    F_a = abs(axial.force[-1, 2])  # X = 0.56, and Y = 1.54 at F_a/(Z D^2) = 1.08 MPa, between 1.55 and 1.45
    assert axial.basic_life(23400.0).load == pytest.approx(1.54 * F_a, rel=5e-3)
    assert axial.reference_life(23400.0).inner_load == pytest.approx(axial.inner_load[-1].mean(), rel=1e-6)


def test_a_run_without_saved_steps_has_no_table(radial: Result) -> None:
    bearing = radial.bearing("bearing")
    bearing.time = np.zeros(0)
    with pytest.raises(InputError, match="bearing 'bearing': no step was saved \\(completed"):
        bearing.report()


def test_basic_life(radial: Result) -> None:
    life = radial.bearing("bearing").basic_life(23400.0)
    assert life.revolutions == pytest.approx(23.4**3, rel=1e-6) and life.load == pytest.approx(1e3)
    own, rated = radial.bearing("bearing"), radial.bearing("bearing").geometry.dynamic_rating
    assert own.basic_life().capacity == own.reference_life().capacity == rated
    assert own.basic_life().revolutions == pytest.approx((rated / 1e3) ** 3, rel=1e-6)
    with pytest.raises(InputError, match="give X and Y of the catalogue"):
        radial.bearing("bearing").basic_life(23400.0, X=0.0)
    with pytest.raises(InputError, match="turning must be"):
        radial.bearing("bearing").reference_life(23400.0, turning="both")


def test_published_patches(ball_209: Result) -> None:
    """P8: half-axes and peak pressures of the ball under the load."""
    found = ball_209.bearing("209")
    for patches, a, b, peak in (
        (found.inner_patches, 2.568, 0.274, 3072e6),
        (found.outer_patches, 2.490, 0.338, 2567e6),
    ):
        assert patches.half_axis_across[-1, 0] == pytest.approx(a * MM, rel=2e-3)
        assert patches.half_axis_around[-1, 0] == pytest.approx(b * MM, rel=2e-3)
        assert patches.peak_pressure[-1, 0] == pytest.approx(peak, rel=PRESSURE)
        assert np.all(patches.peak_pressure[-1, 3:7] == 0.0)


def test_what_a_shoulder_cuts_off(ball_209: Result) -> None:
    """Of the semi-ellipsoid of Hertz's pressure beyond the end of the groove, by quadrature."""
    share = ball_209.bearing("209").cut_off
    a = ball_209.bearing("209").outer_patches.half_axis_across[-1, 0]
    room = 6.6 * MM * np.arccos(1.0 - 0.25 / 6.6)
    x = np.linspace(room, a, 20001)
    beyond = np.trapezoid(0.75 / a * np.maximum(1.0 - (x / a) ** 2, 0.0), x)
    assert 0.01 < beyond and share["outer"][-1, 0] == pytest.approx(beyond, rel=1e-6)
    assert share["inner"][-1, 0] == 0.0 and share["outer"][-1, 4] == 0.0


def test_columns_of_the_table(skew: Result) -> None:
    """Loads and angles balance the force on the ring; the frame counts from the first ball, along z here."""
    found = skew.bearing("bearing")
    np.testing.assert_allclose(found.force[-1], (-1e3, 0.0, -1e3), atol=1e-5)
    Q, alpha, phi = found.inner_load[-1], found.inner_angle[-1], found.angle[-1]
    assert np.sum(Q * np.sin(alpha)) == pytest.approx(1e3, rel=1e-6)
    assert np.sum(Q * np.cos(alpha) * np.cos(phi)) == pytest.approx(1e3, rel=1e-3)  # and what leans on the pockets
    np.testing.assert_allclose(found.outer_angle[-1], alpha, atol=1e-3)
    position = skew.body("bearing inner ring").position[-1]
    np.testing.assert_allclose(found.displacement[-1], (position[2], position[0], position[1]), atol=1e-15)
    assert abs(found.tilt[-1, 1]) == pytest.approx(2.715e-3, rel=1e-3)
    assert found.cage_force[-1, 1] == pytest.approx(-found.cage_force[-1, 6], rel=1e-6)
    assert set(found.table()) >= {"angle [deg]", "inner load [N]", "outer peak [MPa]", "cage force [N]"}
    assert "7 of 7 balls loaded" in found.report() and "tilted by" in found.report()


def test_a_roller_of_laminae() -> None:
    """P10 with a clearance; peak pressures of lines by Hertz, and what a table has not is left out."""
    scene = Scene()
    bearing = scene.add_bearing(
        "N",
        RollerGeometry(
            elements=14, roller_diameter=10 * MM, roller_length=9.6 * MM, pitch_diameter=64 * MM, clearance=40.6e-6,
        ),
        first=(0, 0, 1), outer=scene.ground, contact=RollingContact(law=laws.PalmgrenLine(9.6 * MM, 3)), materials=E206,
    )  # fmt: skip
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, 0.0, 4450.0), name="load"))
    found = equilibrium(scene, progress=False).bearing("N")
    R = 1.0 / (1.0 / (5 * MM) + 1.0 / bearing.geometry.bottom("inner"))
    line = found.inner_load[-1, 0] / (9.6 * MM)
    peak = np.sqrt(line * 0.5 * E206.plane_strain_modulus / (np.pi * R))
    assert found.inner_patches.peak_pressure[-1, 0] == pytest.approx(peak, rel=1e-6)
    assert "inner a [mm]" not in found.report() and "3 of 14 rollers loaded" in found.report()
    with pytest.raises(InputError, match="30 laminae at least"):
        found.reference_life(50e3)


def test_stiffness_is_the_slope_of_equilibria(skew: Result) -> None:
    """Symmetric, and a newton more moves the ring by what it says."""
    found = skew.bearing_stiffness("bearing")
    assert found.asymmetry < 1e-6
    scene = skew.scene
    assert found.left_out == ()
    more = forces.PointForce(scene.bearing("bearing").inner.at((0, 0, 0)), (0.0, 0.0, 1.0), name="more")  # pyright: ignore[reportAttributeAccessIssue]
    scene.forces.append(more)
    moved = equilibrium(scene, progress=False).bearing("bearing")
    scene.forces.remove(more)
    before = skew.bearing("bearing")
    change = np.concatenate([moved.displacement[-1] - before.displacement[-1], moved.tilt[-1] - before.tilt[-1]])
    change[5] = 0.0  # nothing holds it
    force = found.matrix @ change
    np.testing.assert_allclose(force[:3], (1.0, 0.0, 0.0), atol=1e-3)  # a thousandth of the load: squares of it
    np.testing.assert_allclose(force[3:5], 0.0, atol=1e-3 * 0.022)


def test_one_patch_is_that_of_another_derivation(radial: Result) -> None:
    """Carlson's integrals instead of Legendre's."""
    found = radial.bearing("bearing")
    across, along = found.geometry.curvatures("outer", 0.0)  # pyright: ignore[reportAttributeAccessIssue]
    modulus = 0.5 * E210.plane_strain_modulus
    exact = EllipticContact(found.outer_load[-1, 0], 1.0 / float(across), 1.0 / float(along), modulus)
    assert found.outer_patches.half_axis_across[-1, 0] == pytest.approx(exact.half_axes[0], rel=1e-9)
    assert found.outer_patches.peak_pressure[-1, 0] == pytest.approx(exact.peak_pressure, rel=1e-9)


def test_files_keep_bearings(ball_209: Result, tmp_path: Path) -> None:
    again = Result.load(ball_209.save(tmp_path / "run.h5"))
    assert again.bearing_names == ["209"]
    assert again.bearing("209").report() == ball_209.bearing("209").report()
    with pytest.raises(InputError, match="'209'"):
        again.bearing("210")


def test_plots(ball_209: Result) -> None:
    ax = ball_209.plot("load_zone", bearing="209")
    assert ax.name == "polar" and len(ax.lines) == 2
    assert len(ball_209.plot("element_loads").lines) == 9
    with pytest.raises(InputError, match="polar axes"):
        ball_209.plot("load_zone", ax=ball_209.plot("element_loads"))


def test_a_cage_with_pockets_comes_to_rest() -> None:
    """Balls next to the load are squeezed out until their pockets hold them, alike on either side."""
    scene = Scene()
    bearing = scene.add_bearing(
        "b", BallGeometry(elements=7, ball_diameter=11.5 * MM, pitch_diameter=43.5 * MM, clearance=10e-6),
        first=(0, 0, 1), outer=scene.ground, cage=PocketCage(0.1 * MM),
    )  # fmt: skip
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, 0.0, 1e3), name="load"))
    result = equilibrium(scene, progress=False)
    assert result.status == "completed", result.message
    force = result.bearing("b").cage_force[-1]
    assert force[1] == pytest.approx(-force[6], rel=1e-4) and 0.05 < abs(force[1]) < 1.0
    assert np.abs(result.bearing("b").outer_load[-1] - evenly_spaced()).max() < 5.0  # the two lean on the loaded one


def evenly_spaced() -> np.ndarray:
    """Loads of the same bearing with balls at equal angles."""
    scene = Scene()
    bearing = scene.add_bearing(
        "b", BallGeometry(elements=7, ball_diameter=11.5 * MM, pitch_diameter=43.5 * MM, clearance=10e-6),
        first=(0, 0, 1), outer=scene.ground,
    )  # fmt: skip
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, 0.0, 1e3), name="load"))
    return equilibrium(scene, progress=False).bearing("b").outer_load[-1]


@pytest.mark.parametrize(
    ("thrust", "said"),
    [(-500.0, "7 balls press on the flanks against the sense of the contact angle, 25 deg"), (500.0, "")],
)
def test_thrust_against_the_contact_angle_is_named(thrust: float, said: str) -> None:
    scene = Scene()
    bearing = scene.add_bearing(
        "b",
        BallGeometry(elements=7, ball_diameter=11.5 * MM, pitch_diameter=43.5 * MM, contact_angle=np.radians(25.0)),
        outer=scene.ground,
    )  # fmt: skip
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, thrust, 0.0), name="thrust"))
    report = equilibrium(scene, progress=False).bearing("b").report()
    assert said in report and ("flanks" in report) == bool(said)


def test_a_bearing_without_load_says_so() -> None:
    scene = Scene()
    scene.add_bearing(
        "b", BallGeometry(elements=3, ball_diameter=10 * MM, pitch_diameter=40 * MM, clearance=20e-6),
        outer=scene.ground,
    )  # fmt: skip
    assert "no element is loaded: the inner ring is free" in equilibrium(scene, progress=False).bearing("b").report()


def test_a_bearing_without_load_has_no_stiffness() -> None:
    scene = Scene()
    bearing = scene.add_bearing(
        "b", BallGeometry(elements=8, ball_diameter=0.01, pitch_diameter=0.05), outer=scene.ground
    )
    scene.add(Fixed(scene.ground, bearing.inner.at((0, 0, 0)), axis=(0, 0, 1)))  # pyright: ignore[reportAttributeAccessIssue]
    found = simulate(scene, 1e-5, step=1e-5, progress=False).bearing_stiffness("b")
    assert np.all(np.isnan(found.matrix)) and "no element is loaded" in found.reason
