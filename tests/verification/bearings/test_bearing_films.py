"""Film thickness from runs of bearings that turn: entrainment by the kinematics of rolling, films of a published
example; friction torque of pivoting compared with the catalogue's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model import forces, joints, laws, oils
from warpffrf.model.bearings import BallGeometry, PocketCage, RollerGeometry, RollingContact
from warpffrf.model.bearings.lubrication import film_of_lines, film_of_points
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.bearings.bearing_result import BearingResult
from warpffrf.output.simulate import simulate

MM, UM = 1e-3, 1e-6
STEEL = Material(210e9, 0.3, 7850.0)
D, PITCH, ANGLE = 10 * MM, 50 * MM, np.radians(27.5)  # the angle is that under the preload
OIL = oils.Roelands(0.04, coefficient=2e-8)
KINEMATICS = 1e-2  # contact angles differ by centrifugal load and preload
PUBLISHED = 3e-2


def rolling(inner: float, outer: float) -> BearingResult:
    """An angular-contact bearing, pressed, whose rings turn with these speeds [rad/s]."""
    scene = Scene(gravity=(0, 0, 0))
    bearing = scene.add_bearing(
        "b", BallGeometry(elements=8, ball_diameter=D, pitch_diameter=PITCH, contact_angle=np.radians(25.0)),
        materials=STEEL,
    )  # fmt: skip
    for side, speed, y in (("inner", inner, 20 * UM), ("outer", outer, 0.0)):
        ring: Any = getattr(bearing, side)
        ring.position = np.array([0.0, y, 0.0])
        axle = scene.add(joints.Revolute(scene.ground.at((0, y, 0)), ring.at((0, 0, 0)), axis=(0, 1, 0), name=side))
        scene.add(joints.Drive(axle, speed, quantity="velocity", name=f"{side} drive"))
    bearing.roll(inner, outer, angle=ANGLE)
    result = simulate(scene, 2e-5, step=1e-5, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    return result.bearing("b")


@pytest.mark.parametrize(("inner", "outer"), [(300.0, 0.0), (0.0, 300.0), (300.0, -100.0), (200.0, 200.0)])
def test_entrainment_is_that_of_rolling(inner: float, outer: float) -> None:
    """(w_i - w_o) d_pw (1 - gamma^2)/4 on both rings, none of a bearing that turns as a whole."""
    found = rolling(inner, outer)
    films = found.film_thickness(OIL)
    for side in ("inner", "outer"):
        gamma = D * np.cos(getattr(found, f"{side}_angle")[-1]) / PITCH
        u = abs(inner - outer) * PITCH * (1.0 - gamma**2) / 4.0
        np.testing.assert_allclose(films[side].entrainment[-1], u, rtol=KINEMATICS, atol=1e-3)
        assert np.abs(films[side].slip[-1]).max() < KINEMATICS * max(u.max(), 0.1)
        if inner == outer:
            assert films[side].minimum[-1].max() < 1e-3 * UM
            continue
        across, along = found.geometry.curvatures(side, getattr(found, f"{side}_angle")[-1])  # pyright: ignore[reportAttributeAccessIssue]
        by_hand = film_of_points(
            OIL, speed=u, load=getattr(found, f"{side}_load")[-1], radius=1.0 / along,
            ratio=1.0339 * (along / across) ** 0.636, modulus=0.5 * STEEL.plane_strain_modulus,
        )  # fmt: skip
        np.testing.assert_allclose(films[side].minimum[-1], by_hand.minimum, rtol=KINEMATICS)
        np.testing.assert_allclose(films[side].central[-1], by_hand.central, rtol=KINEMATICS)


def test_film_of_a_209_bearing_under_load() -> None:
    """B. J. Hamrock, NASA RP-1255 (1991): 0.557 um on the inner ring under the most loaded ball; with loads of the run,
    where that ball has 4.5 kN and not 5 F_r/Z."""
    speed, steel = 400.0, Material(200e9, 0.3, 7850.0)
    scene = Scene(gravity=(0, 0, 0))
    bearing = scene.add_bearing(
        "209",
        BallGeometry(
            elements=9, ball_diameter=12.7 * MM, pitch_diameter=0.5 * (52.291 + 77.706) * MM, osculation=0.52,
            clearance=15 * UM,
        ),
        first=(0, 0, 1), outer=scene.ground, materials=steel,
    )  # fmt: skip
    inner: Any = bearing.inner
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), inner, axis=(0, 1, 0), name="plane"))
    scene.add(joints.Drive(plane, speed, name="drive"))
    scene.add(forces.PointForce(inner, (0, 0, 8900.0), name="load"))
    bearing.roll(speed, angle=0.0)
    result = simulate(scene, 1e-6, step=1e-6, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    found, oil = result.bearing("209"), oils.Barus(0.04, coefficient=2.3e-8)
    film = found.film_thickness(oil, roughness=(0.0625 * UM, 0.175 * UM))["inner"]
    least, Lambda = film.minimum[0, 0], film.parameter[0, 0]
    print(f"film {least * 1e6:.4f} um under {found.inner_load[0, 0]:.0f} N, Lambda {Lambda:.3f}")
    assert least == pytest.approx(0.557 * UM, rel=PUBLISHED)
    assert Lambda == pytest.approx(least / (0.1858 * UM), rel=1e-3)
    assert np.isnan(film.minimum[0, 4]) and np.isnan(film.parameter[0, 4])  # without a load
    warm = found.film_thickness(oil, thinning=0.04)["inner"].minimum[0, 0]
    starved = found.film_thickness(oil, inlet=1.1 * found.outer_patches.half_axis_around[0, 0])["inner"].minimum[0, 0]
    assert 0.7 < warm / least < 0.95 and 0.5 < starved / least < 0.95
    shear = found.shear_below()["inner"]  # Johnson, table 4.1: 0.300 to 0.322 p0 and 0.785 to 0.745 b for b/a 0 to 0.2
    assert shear.stress[0, 0] / found.inner_patches.peak_pressure[0, 0] == pytest.approx(0.312, abs=6e-3)
    assert shear.depth[0, 0] / found.inner_patches.half_axis_around[0, 0] == pytest.approx(0.765, abs=0.015)
    life = found.modified_life(32.5e3, 20.4e3, kappa=Lambda**1.3, contamination=0.5, row=0)
    assert life.load == pytest.approx(32.5e3 * life.basic.revolutions ** (-1.0 / 3.0)) and life.fatigue_limit > 0.0
    assert found.static_safety(20.4e3, 0) == pytest.approx(20.4 / 8.9, rel=1e-3)
    with pytest.raises(InputError, match="oils.Barus"):
        found.film_thickness(oils.iso_vg(68, temperature=60.0))


def test_film_of_rollers() -> None:
    """Rollers rolling under a radial load: Dowson's formula at the load and entrainment of each."""
    speed, length = 300.0, 9.6 * MM
    scene = Scene(gravity=(0, 0, 0))
    bearing = scene.add_bearing(
        "n", RollerGeometry(elements=14, roller_diameter=10 * MM, roller_length=length, pitch_diameter=64 * MM),
        first=(0, 0, 1), outer=scene.ground, contact=RollingContact(law=laws.PalmgrenLine(length, 3)), materials=STEEL,
    )  # fmt: skip
    inner: Any = bearing.inner
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), inner, axis=(0, 1, 0), name="plane"))
    scene.add(joints.Drive(plane, speed, name="drive"))
    scene.add(forces.PointForce(inner, (0, 0, 4450.0), name="load"))
    bearing.roll(speed)
    found = simulate(scene, 1e-6, step=1e-6, start="equilibrium", progress=False).bearing("n")
    film = found.film_thickness(OIL, roughness=0.2 * UM)["outer"]
    u = speed * 64 * MM * (1.0 - (10.0 / 64.0) ** 2) / 4.0
    by_hand = film_of_lines(
        OIL, speed=u, line_load=found.outer_load[0, 0] / length, radius=1.0 / (1.0 / (5 * MM) - 1.0 / (37 * MM)),
        modulus=0.5 * STEEL.plane_strain_modulus,
    )  # fmt: skip
    assert film.minimum[0, 0] == pytest.approx(by_hand.minimum, rel=1e-3)
    assert film.parameter[0, 0] == pytest.approx(by_hand.minimum / (0.2 * UM), rel=1e-3)
    shear = found.shear_below()["outer"]
    assert shear.stress[0, 0] == pytest.approx(0.3003 * found.outer_patches.peak_pressure[0, 0], rel=1e-3)
    with pytest.raises(InputError, match="inlet is for balls"):
        found.film_thickness(OIL, inlet=1e-3)
    with pytest.raises(InputError, match="roughness .m. is zero"):
        found.film_thickness(OIL, roughness=0.0)


def test_torque_of_pivoting_is_that_of_the_catalogue() -> None:
    """The torque that grows with the load in an angular-contact bearing under thrust results from pivoting: within a
    factor of 1.5 of M_1 of the catalogue, f_1 = 0.001 (P_0/C_0)^0.33 with half the thrust as P_0 and C_0 12 kN."""
    speed = 300.0
    scene = Scene(gravity=(0, 0, 0))
    bearing = scene.add_bearing(
        "b", BallGeometry(elements=8, ball_diameter=D, pitch_diameter=PITCH, contact_angle=np.radians(25.0)),
        outer=scene.ground, cage=PocketCage(0.1 * MM), materials=STEEL,
        contact=RollingContact(
            friction=laws.RegularisedCoulomb(0.06, 0.02), spin=True, law=laws.HertzPoint(STEEL, STEEL, damping=1.0)
        ),
    )  # fmt: skip
    inner: Any = bearing.inner
    at = np.array([0.0, 20 * UM, 0.0])
    inner.position = at
    axle = scene.add(joints.Revolute(scene.ground.at(at), inner.at((0, 0, 0)), axis=(0, 1, 0), name="axle"))
    scene.add(joints.Drive(axle, speed, quantity="velocity", name="drive"))
    bearing.roll(speed, angle=ANGLE)
    result = simulate(scene, 4e-4, step=1e-5, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    found = result.bearing("b")
    thrust = abs(found.force[-1, 2])
    _, M_1 = wf.bearings.catalogue_torque(
        PITCH, speed, viscosity=45e-6, load=thrust, f0=2.0, f1=0.001 * (0.5 * thrust / 12e3) ** 0.33
    )
    print(f"torque {-found.friction_torque[-1] * 1e3:.2f} N mm, catalogue {M_1 * 1e3:.2f} N mm under {thrust:.0f} N")
    assert 1.0 / 1.5 < -found.friction_torque[-1] / M_1 < 1.5
