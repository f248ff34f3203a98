"""Form deviations of rigid surfaces: what is kept of them, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from warpffrf.model import films, laws, surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene

UM = 1e-6
STEEL = Material(210e9, 0.3, 7850.0)
AXIS: dict[str, Any] = {"axis_point": (0.0, 0.0, 0.0), "axis_direction": (0.0, 0.0, 1.0)}
RING = surfaces.Ring(radius=0.03, groove_radius=0.0053, **AXIS)
BALL = surfaces.Sphere(radius=0.005, axis_point=(0.0, 0.0, 0.0))


def test_values_and_curvatures_are_those_of_the_waves() -> None:
    """The spline errs by (5/384) (order step)^4 of the value and (order step)^2/12 of the curvature."""
    scene = Scene()
    form = scene.ground.surface(RING, name="r", form=films.LobedForm(5 * UM, 9, 0.3)).surface.form
    theta = np.linspace(-1.0, 7.0, 200)
    w, slope, bend = form.turned(0.2).at(theta)
    x = 9.0 * (theta - 0.5)
    step = 9.0 * 2.0 * np.pi / 16384
    np.testing.assert_allclose(w, 5 * UM * np.cos(x), atol=step**4 * 5 * UM)
    np.testing.assert_allclose(slope, -45 * UM * np.sin(x), atol=step**3 * 45 * UM)
    np.testing.assert_allclose(bend, -405 * UM * np.cos(x), atol=step**2 * 405 * UM)


def test_a_measured_form_is_smooth_and_closes() -> None:
    places = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)
    measured = films.MeasuredForm(places, [0.0], np.cos(2.0 * places)[:, None] * UM)
    form = Scene().ground.surface(RING, name="r", form=measured).surface.form
    theta = np.linspace(0.0, 7.0, 100)
    np.testing.assert_allclose(form.at(theta)[0], np.cos(2.0 * theta) * UM, atol=1e-4 * UM)


def test_the_gap_has_the_form() -> None:
    scene = Scene()
    ring = scene.ground.surface(RING, name="r", form=films.LobedForm(5 * UM, 2))
    ball = scene.add_rigid_body(0.01, (1e-6,) * 3, name="ball", position=(0.0, 0.025, 0.0), surfaces={"skin": BALL})
    contact = LumpedContact(ball["skin"], ring, law=laws.HertzPoint(STEEL))
    assert contact.gap() == pytest.approx(-5 * UM, rel=1e-9)


def waves(form: Any, shape: Any = RING) -> Any:
    scene = Scene()
    ring = scene.ground.surface(shape, name="r", form=form)
    ball = scene.add_rigid_body(0.01, (1e-6,) * 3, name="ball", position=(0.025, 0.0, 0.0), surfaces={"skin": BALL})
    return LumpedContact(ball["skin"], ring, law=laws.HertzPoint(STEEL)).approach()


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: waves(3), "form must be one of films.LobedForm"),
        (lambda: waves(films.BarrelForm(1e-6, 0.01)), "changes along the axis"),
        (lambda: waves(films.WornForm(1e-6, 0.0, 1e-4)), "too short or edges too sharp"),
        (lambda: waves(films.LobedForm(1e-6, 2), BALL), "has no axis of revolution for a form"),
        (lambda: waves(films.LobedForm(20 * UM, 120)), "have hollows of 320.1 1/m, which .* bridges"),
    ],
)
def test_what_no_lumped_contact_can_see_is_refused(make: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()


def test_a_roller_is_round() -> None:
    scene = Scene()
    body = scene.add_rigid_body(0.01, (1e-6,) * 3, name="roller", position=(0.0, 0.0, 0.035))
    roller = body.surface(surfaces.Cylinder(radius=0.005, **AXIS), name="skin", form=films.LobedForm(1e-6, 3))
    shaft = scene.ground.surface(surfaces.Cylinder(radius=0.03, **AXIS), name="shaft")
    with pytest.raises(InputError, match="cut into round laminae"):
        LumpedContact(roller, shaft, law=laws.PalmgrenLine(0.01))
