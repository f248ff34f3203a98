"""A slider with a pocket at whose beginning the film breaks (M. T. Fowell, Imperial College, 2007), on a rigid body
with as many nodes as the film requires, compared with Reynolds' equation in one dimension, integrated by pieces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import warpffrf as wf
from warpffrf.model.errors import InputError

BREADTH, INLET, OUTLET, DEPTH = 0.01, 1.05e-6, 1.0e-6, 1e-6  # m
POCKET = (0.002, 0.005)  # m along the sliding
VISCOSITY, SPEED, AMBIENT = 0.01, 1.0, 1e5  # Pa s, m/s, Pa
LENGTH, CELLS = 0.2, 200  # m across the sliding, so long that its middle is one-dimensional; cells along the sliding
WITHIN = 5e-3


def gap(x: float) -> float:
    return INLET + (OUTLET - INLET) * x / BREADTH + (DEPTH if POCKET[0] < x < POCKET[1] else 0.0)


def rise(begin: float, end: float, flux: float) -> float:
    """Of the pressure [Pa] of a full film, between edges of the pocket; flux: that of the oil, over U/2 [m]."""
    inside = (begin + 1e-12, end - 1e-12)
    return quad(lambda x: 6.0 * VISCOSITY * SPEED * (gap(x) - flux) / gap(x) ** 3, *inside, epsrel=1e-9)[0]


def closed_form() -> tuple[float, Any]:
    """Position [m] at which the film forms again, and the pressure [Pa] over x [m]: the flux is that for which the
    pressure falls to zero up to the pocket, and the film that begins in it reaches the ambient pressure at the end."""
    first, last = POCKET
    flux: Any = brentq(lambda flux: AMBIENT + rise(0.0, first, flux), 0.9 * OUTLET, 1.1 * INLET, xtol=1e-16)
    behind = rise(last, BREADTH, flux) - AMBIENT
    again: Any = brentq(lambda x: rise(x, last, flux) + behind, first, last - 1e-9, xtol=1e-12)

    def pressure(x: float) -> float:
        if x <= first:
            return AMBIENT + rise(0.0, x, flux) if x else AMBIENT
        return rise(again, min(x, last), flux) * (x > again) + (rise(last, x, flux) if x > last else 0.0)

    return again, pressure


def test_the_film_breaks_at_the_pocket_and_forms_again_in_it() -> None:
    face = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, -1))
    slider = wf.rigid_film_body(
        1.0, (1e-3,) * 3, contact={"face": face}, extent=((0.0, BREADTH), (-0.5 * LENGTH, 0.5 * LENGTH)),
        nodes=(CELLS + 1, 9),
    )  # fmt: skip
    scene = wf.Scene()
    held = scene.add_body(
        slider, name="slider", position=(0, 0, INLET),
        rotation={"axis": (0, 1, 0), "angle": (INLET - OUTLET) / BREADTH},
    )  # fmt: skip
    scene.add(wf.joints.Fixed(scene.ground.at((0, 0, INLET)), held["center"]))
    top = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    runner = scene.add_rigid_body(1.0, (0.1,) * 3, name="runner", velocity=(SPEED, 0, 0), surfaces={"top": top})
    scene.add(wf.joints.Prismatic(scene.ground, runner, axis=(1, 0, 0), name="guide"))
    scene.add(wf.joints.Drive(scene.joint("guide"), SPEED, quantity="velocity"))
    film = wf.Film(
        held["face"], runner["top"], oil=wf.oils.Newtonian(VISCOSITY), ambient_pressure=AMBIENT, name="film",
        form_a=wf.films.PocketForm(DEPTH, POCKET),
    )  # fmt: skip
    scene.add(film)
    found = wf.equilibrium(scene, progress=False).film("film")
    middle, x = found.pressure[-1][:, 4], found.theta
    again, pressure = closed_form()
    expected = np.array([pressure(at) for at in x])
    load, theirs = np.trapezoid(middle, x), np.trapezoid(expected, x)
    empty = x[(found.void[-1][:, 4] > 0.0)]
    print(
        f"load {load:.1f}, {theirs:.1f} N/m; peak {middle.max():.5g}, {expected.max():.5g} Pa; empty {empty[[0, -1]]}"
    )
    assert load == pytest.approx(theirs, rel=WITHIN)
    assert middle.max() == pytest.approx(expected.max(), rel=WITHIN)
    assert abs(empty[-1] - again) < 1.5 * BREADTH / CELLS and abs(empty[0] - POCKET[0]) < 1.5 * BREADTH / CELLS


def test_rigid_bodies_for_films_are_for_films() -> None:
    bore = wf.surfaces.Bore(radius=0.025, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    given: dict[str, Any] = {"contact": {"bore": bore}, "extent": (-0.01, 0.01)}
    with pytest.raises(InputError, match="which is no surface of contact"):
        wf.rigid_film_body(1.0, (1, 1, 1), contact={"bore": bore}, extent={"rim": (0, 1)})
    with pytest.raises(InputError, match="ascending"):
        wf.rigid_film_body(1.0, (1, 1, 1), contact={"bore": bore}, extent=(0.01, -0.01))
    scene = wf.Scene()
    body = scene.add_body(wf.rigid_film_body(1.0, (1, 1, 1), **given), name="sleeve")
    pin = wf.surfaces.Cylinder(radius=0.0249, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    shaft = scene.add_rigid_body(1.0, (1, 1, 1), name="shaft", surfaces={"rim": pin})
    with pytest.raises(InputError, match="carries oil films only"):
        wf.Contact(body["bore"], shaft["rim"])
