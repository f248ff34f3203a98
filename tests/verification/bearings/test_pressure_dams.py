"""Pressure-dam bearings of a rigid rotor, compared with J. C. Nicholas, L. E. Barrett and M. E. Leader, Experimental-
theoretical comparison of instability onset speeds for a three mass rotor supported by step journal bearings, J. Mech.
Design 102 (1980) 344: eccentricity, and the speed at which the rotor begins to whirl."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf

R, LENGTH, WEIGHT, VISCOSITY, SPEED = 12.7e-3, 25.4e-3, 66.278, 0.0524, 8000.0 * np.pi / 30.0  # m, N, Pa s, rad/s
ECCENTRICITY, THRESHOLD = 0.015, 0.1  # of the clearance: two decimals, and the grid; of the threshold


@pytest.mark.parametrize(
    ("clearance", "dam", "eccentricity", "threshold"),
    [
        (45.7e-6, None, 0.03, 2.1),
        (55.9e-6, wf.films.Dam(61.0e-6, np.radians(145.0)), 0.29, 7.5),
        (63.5e-6, wf.films.Dam(88.9e-6, np.radians(145.0)), 0.29, 7.0),
        (61.0e-6, wf.films.Dam(340e-6, np.radians(150.0)), 0.21, 4.6),
    ],
)
def test_eccentricity_and_threshold(
    clearance: float, dam: wf.films.Dam | None, eccentricity: float, threshold: float
) -> None:
    """The dam is in the upper pad. threshold: speed times sqrt(c/g), a function of the Sommerfeld number, as are
    coefficients over W/c: it is sqrt(m_c c omega^2/W) of the critical mass at the given one."""
    scene = wf.Scene()
    round_ = wf.surfaces.Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    shaft = scene.add_rigid_body(
        WEIGHT / 9.81, (0.01,) * 3, name="shaft", surfaces={"journal": round_}, angular_velocity=(0, SPEED, 0),
        position=(0.1 * clearance, 0, -0.1 * clearance),
    )  # fmt: skip
    arc = np.radians(160.0)
    scene.add_journal_bearing(
        "b", shaft["journal"], [wf.films.Pad(0.0, arc), wf.films.Pad(np.pi, arc, dam=dam)], clearance=clearance,
        length=LENGTH, oil=wf.oils.Newtonian(VISCOSITY), cavitation="reynolds", nodes=(72, 17),
    )  # fmt: skip
    plane = scene.add(wf.joints.Planar(scene.ground, shaft, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, SPEED, quantity="velocity"))
    scene.add(wf.forces.PointForce(shaft, (WEIGHT, 0, 0)))
    film = wf.equilibrium(scene, progress=False).film("b")
    mass = film.coefficients().critical_mass
    ours = np.sqrt(mass * clearance * SPEED**2 / WEIGHT)
    eps = np.hypot(*film.eccentricity[-1]) / clearance
    print(f"eccentricity {eps:.3f}, {eccentricity}; threshold {ours:.2f}, {threshold}")
    assert eps == pytest.approx(eccentricity, abs=ECCENTRICITY)
    assert ours == pytest.approx(threshold, rel=THRESHOLD)
