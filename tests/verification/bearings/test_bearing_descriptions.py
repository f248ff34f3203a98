"""Ball bearings that are preloaded, and whose raceways and balls are not round, against the equations of bearings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, root

from references.closed_forms.ball_bearing import BallBearing
from warpffrf.model import films, forces
from warpffrf.model import rotation as rot
from warpffrf.model.bearings import BallGeometry, Bearing, Flanges, PreloadForce, PreloadOffset, RollerGeometry
from warpffrf.model.joints import Fixed
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.online import History, find_equilibrium

MM, UM = 1e-3, 1e-6
STEEL = Material(210e9, 0.3, 7850.0)
SIZE = {"elements": 7, "ball_diameter": 11.5 * MM, "pitch_diameter": 43.5 * MM, "osculation": (0.52, 0.53)}
ANGLE = np.radians(25.0)
ROUND_OFF = 1e-9  # of the preload: what an equilibrium leaves
# of the largest load: squares of deflections over radii, and of slopes of the form
REFERENCE = 1e-3
# of the force: Hertz's stiffness is that of the contact angle 0 there, of the initial one here, cos(25 deg) in the
# curvature around the axis, which counts by a small power
SAME_LAW = 1e-2


def loads(history: History, bearing: Bearing, side: str) -> np.ndarray:
    """(elements,) N."""
    return np.array([history.lumped_contacts[c.name].normal_force[-1] for c in bearing.contacts_of(side)])


def by_the_book() -> BallBearing:
    D = SIZE["ball_diameter"]
    return BallBearing(7, D, SIZE["pitch_diameter"], 0.52 * D, 0.53 * D, 0.0, 210e9)


def axial_force(pressed: float) -> float:
    """F [N] of rings that are pressed by a way [m] along the axis, as `model.bearings.parts` has it."""
    book = by_the_book()
    X, Y = book.reach * np.cos(ANGLE), book.reach * np.sin(ANGLE) + pressed
    Q, alpha = book.balls(np.array(X), np.array(Y))
    return float(7 * Q * np.sin(alpha))


@pytest.mark.parametrize("angle", [ANGLE, -ANGLE])
def test_a_force_presses_the_rings(angle: float) -> None:
    """Both rings are free: the loads of all balls add up to it on either, and the ring moves as the equations say."""
    scene = Scene()
    bearing = scene.add_bearing(
        "b", BallGeometry(**SIZE, contact_angle=angle), axial_preload=PreloadForce(500.0), outer=scene.ground,
        axis=(0.0, 0.6, 0.8),
    )  # fmt: skip
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    axis = bearing.place.axis
    for side, sign in (("inner", 1.0), ("outer", -1.0)):
        total = sum(history.lumped_contacts[c.name].force[-1] for c in bearing.contacts_of(side))
        assert sign * total @ axis == pytest.approx(500.0 * np.sign(angle), rel=ROUND_OFF)
    np.testing.assert_allclose(loads(history, bearing, "inner"), loads(history, bearing, "inner")[0], rtol=1e-6)
    pressed = float(np.sign(angle) * history.bodies["b inner ring"].position[-1] @ axis)
    assert axial_force(pressed) == pytest.approx(500.0, rel=SAME_LAW)


def test_raceways_that_stand_off_press_when_held() -> None:
    scene = Scene()
    bearing = scene.add_bearing(
        "b", BallGeometry(**SIZE, contact_angle=ANGLE), axial_preload=PreloadOffset(20 * UM), outer=scene.ground
    )
    scene.add(Fixed(scene.ground, bearing.inner.at((0, 0, 0)), name="hold"))
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    held = history.joints["hold"].force[-1]
    total = sum(history.lumped_contacts[c.name].force[-1] for c in bearing.contacts_of("outer"))
    assert abs(held @ bearing.place.axis) == pytest.approx(abs(total @ bearing.place.axis), rel=ROUND_OFF)
    assert abs(held @ bearing.place.axis) == pytest.approx(axial_force(20 * UM), rel=SAME_LAW)


OVAL = films.LobedForm(12 * UM, 2, 0.5)
WAVY = OVAL + films.LobedForm(2 * UM, 5, 0.2)
THICKER = np.array([0.0, 4.0, 0.0, 0.0, -3.0, 0.0, 1.0]) * UM


def reference(form: Any, turned: float, radial: float) -> np.ndarray:
    """Loads (7,) [N]: Q = c_P delta^1.5 with delta_j = n_j - t_j^2/d_pw - w(phi_j - rotated) + D_j - D, n_j and t_j the
    motion of the inner ring along and across the radius of a ball."""
    book = by_the_book()
    phi = book.angles
    given = THICKER - form(phi - turned, 0.0)

    def taken(at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Loads, and how delta grows with x and y."""
        along = at[0] * np.cos(phi) + at[1] * np.sin(phi)
        across = at[1] * np.cos(phi) - at[0] * np.sin(phi)
        Q = book.stiffness * np.maximum(along - across**2 / book.pitch + given, 0.0) ** 1.5
        turn = 2.0 * across / book.pitch
        return Q, np.cos(phi) + turn * np.sin(phi), np.sin(phi) - turn * np.cos(phi)

    def lacking(at: np.ndarray) -> list[float]:
        Q, by_x, by_y = taken(at)
        return [float(np.sum(Q * by_x)) - radial, float(np.sum(Q * by_y))]

    found = root(lacking, [15 * UM, 0.0], tol=1e-13)
    assert found.success
    return taken(found.x)[0]


@pytest.mark.parametrize(("form", "turned"), [(OVAL, 0.0), (WAVY, 0.7)])
def test_loads_follow_the_form_of_the_raceway(form: Any, turned: float) -> None:
    """An outer ring that is oval and wavy, as built and rotated in its seat, and balls of different sizes."""
    scene = Scene()
    ring = scene.add_rigid_body(1.0, (1e-3,) * 3, name="ring", rotation={"axis": (0, 0, 1), "angle": 0.3})
    bearing = scene.add_bearing(
        "b", BallGeometry(**SIZE, outer_form=form, diameter_deviations=THICKER), first=(0, 0, 1), outer=ring,
        axis=(0, 1, 0),
    )  # fmt: skip
    if turned:
        turn = rot.rotation_vector_matrix(turned * bearing.place.axis)
        ring.rotation = rot.quaternion(turn @ rot.matrix(ring.rotation))
    scene.add(Fixed(scene.ground, ring.at((0, 0, 0)), name="seat"))
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, 0.0, 1e3), name="load"))
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    Q = reference(form, turned, 1e3)
    round_ones = reference(films.LobedForm(0.0, 2), 0.0, 1e3)
    off = np.abs(loads(history, bearing, "outer") - Q).max() / Q.max()
    print(f"loads {loads(history, bearing, 'outer').round(1)}, off {off:.2g}, round {round_ones.round(1)}")
    assert np.abs(Q - round_ones).max() > 0.2 * Q.max()
    assert off < REFERENCE


TILT = 2e-3  # of first order in the lever that a tilted roller has at its skin
LENGTH, END = 10 * MM, 0.1  # m
ROLLERS = {"elements": 8, "roller_diameter": 8 * MM, "roller_length": LENGTH, "pitch_diameter": 40 * MM}


def test_flanges_carry_thrust() -> None:
    """An NJ bearing: the inner ring's rib presses each roller against the outer ring's, an eighth of the thrust each,
    after the play and 2 (Q/K)^(2/3) of Hertz's sphere on a plane."""
    scene = Scene()
    play = 40 * UM
    bearing = scene.add_bearing(
        "r", RollerGeometry(**ROLLERS, clearance=-4 * UM), outer=scene.ground,
        flanges=Flanges(play, inner="back", end_radius=END), materials=STEEL,
    )  # fmt: skip
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, 800.0, 0.0), name="thrust"))
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    for name in ("inner_back", "outer_front"):
        Q = [history.lumped_contacts[f"r flange {name.replace('_', ' ')} {i}"].normal_force[-1] for i in range(1, 9)]
        np.testing.assert_allclose(Q, 100.0, rtol=1e-6)
    stiffness = 4.0 / 3.0 * 0.5 * STEEL.plane_strain_modulus * np.sqrt(END)
    moved = history.bodies["r inner ring"].position[-1, 1]
    assert moved == pytest.approx(play + 2.0 * (100.0 / stiffness) ** (2.0 / 3.0), rel=1e-6)


def test_thrust_tilts_rollers() -> None:
    """Ribs met at a height over the raceways: forces through the middles of the spherical ends make a couple, which the
    laminae of IsoLamina carry; against a roller between two planes in NumPy."""
    scene, height, thrust, tight = Scene(), 1 * MM, 800.0, 8 * UM
    bearing = scene.add_bearing(
        "r", RollerGeometry(**ROLLERS, clearance=-tight), outer=scene.ground,
        flanges=Flanges(40 * UM, inner="back", end_radius=END, height=height), materials=STEEL,
    )  # fmt: skip
    for side, sign in (("outer", 1.0), ("inner", -1.0)):  # where ends meet ribs
        rib = bearing.contacts[f"flange_{side}_{'front' if side == 'outer' else 'back'}_1"].nearest()  # pyright: ignore[reportAttributeAccessIssue]
        out = bearing.place.outward(0.0)
        lever = 0.5 * ROLLERS["roller_diameter"] - height
        assert rib.place @ out - 0.5 * ROLLERS["pitch_diameter"] == pytest.approx(sign * lever, rel=1e-3)
        assert rib.gap == pytest.approx(20 * UM * np.sqrt(1.0 - (lever / END) ** 2), rel=1e-6)
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, thrust, 0.0), name="thrust"))
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    lean = np.arcsin(lever / END)
    n, length, diameter = 30, LENGTH / MM, ROLLERS["roller_diameter"] / MM
    x = length * ((np.arange(n) + 0.5) / n - 0.5)  # mm
    drop = 0.00035 * diameter * np.log(1.0 / (1.0 - (2.0 * x / length) ** 2))
    stiffness = 35948.0 * length ** (8.0 / 9.0) / n * 2.0 ** (10.0 / 9.0)

    couple = 2.0 * (END - 0.5 * LENGTH) * thrust / 8.0 / np.cos(lean)  # of forces along the axis of the roller, rotated

    def excess(tilt: float) -> float:
        pressed = [np.maximum(0.25 * tight / MM + sign * tilt * x - drop, 0.0) ** (10.0 / 9.0) for sign in (1.0, -1.0)]
        return float(stiffness * np.sum((pressed[0] - pressed[1]) * x) * MM - couple * np.sin(lean - tilt))

    tilt: Any = brentq(excess, 0.0, 0.01)
    found = [2.0 * np.linalg.norm(history.bodies[e.name].rotation[-1, [0, 2]]) for e in bearing.elements]
    print(f"tilt {np.mean(found) * 1e3:.5g} mrad, roller between planes {tilt * 1e3:.5g} mrad")
    np.testing.assert_allclose(found, tilt, rtol=TILT)
    Q = [history.lumped_contacts[f"r flange outer front {i}"].normal_force[-1] for i in range(1, 9)]
    np.testing.assert_allclose(Q, 100.0 / np.cos(lean), rtol=1e-5)


def test_flanges_stop_the_skew() -> None:
    """At psi_max of the play, where the roller's ends just touch both ribs."""
    scene = Scene()
    play = 30 * UM
    bearing = scene.add_bearing("r", RollerGeometry(**ROLLERS), flanges=Flanges(play, end_radius=END), cage=None)
    skew = np.sqrt(play / (END - 0.5 * LENGTH))
    roller = bearing.elements[2]
    roller.rotation = rot.quaternion(
        rot.rotation_vector_matrix(skew * bearing.place.outward(bearing.geometry.angles[2]))
    )
    for end in ("front", "back"):
        at = bearing.contacts[f"flange_outer_{end}_3"].nearest()  # pyright: ignore[reportAttributeAccessIssue]
        assert abs(at.gap) < skew**2 * play  # the next order of the cosine
        off = at.place - roller.position
        across = off - (off @ bearing.place.axis) * bearing.place.axis
        assert np.linalg.norm(across) == pytest.approx((END - 0.5 * LENGTH) * skew, rel=1e-3)
