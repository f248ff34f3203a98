"""A shaft on four warm tilting pads, the load between two pivots: M. Fillon, J.-C. Bligoud and J. Frene, Experimental
study of tilting-pad journal bearings, comparison with theoretical thermoelastohydrodynamic results, J. Tribol. 114
(1992) 579.

Measured are the temperatures of pads whose oil, ISO VG 32, is supplied at 40 degrees. Here pads are adiabatic and the
shaft has one temperature, that at which it takes up no heat on the whole: it sees all pads in a revolution, and its
ends carry little off.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import warpffrf as wf

RADIUS, CLEARANCE, LENGTH, LOAD = 0.05, 148e-6, 0.07, 10e3  # m, N
SUPPLY = 40.0  # degrees Celsius
MEASURED = {1000: 49.5, 2000: 59.5, 3000: 67.5, 4000: 76.5}  # rpm: the hottest pad, degrees Celsius
NO_HEAT = 0.01  # of the heat generated: what the shaft takes up, at a temperature that is known to 0.2 K
FIRST_GUESSES = (48.0, 60.0)  # degrees Celsius, of the shaft


def bearing(
    rpm: float, temperature: wf.films.FilmTemperature | None, *, sense: int = 1, nodes: tuple[int, int] = (32, 9)
) -> wf.Scene:
    """The shaft begins near the middle."""
    speed = sense * rpm * np.pi / 30.0
    scene = wf.Scene()
    surface = wf.surfaces.Cylinder(radius=RADIUS, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    shaft = scene.add_rigid_body(
        20.0, (0.1,) * 3, name="shaft", surfaces={"journal": surface}, angular_velocity=(0, speed, 0),
        position=(0.1 * CLEARANCE, 0, 0),
    )  # fmt: skip
    thermal = wf.oils.Thermal(wf.oils.ExponentialLaw(0.0341), SUPPLY, 2000.0, density=860.0)
    scene.add_journal_bearing(
        "b", shaft["journal"], wf.films.pads(4, np.radians(75.0), first=0.25 * np.pi, preload=0.47),
        clearance=CLEARANCE, length=LENGTH, oil=wf.oils.Newtonian(0.0277, thermal=thermal), sense=sense, nodes=nodes,
        tilting=wf.films.TiltingPads(0.02), temperature=temperature,
    )  # fmt: skip
    plane = scene.add(wf.joints.Planar(scene.ground, shaft, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, speed, quantity="velocity"))
    scene.add(wf.forces.PointForce(shaft, (LOAD, 0.0, 0.0)))
    return scene


def at_rest(rpm: float, temperature: wf.films.FilmTemperature | None, **given: Any) -> list[Any]:
    """The films of the equilibrium."""
    found = wf.equilibrium(bearing(rpm, temperature, **given), progress=False)
    if found.status != "completed":
        raise RuntimeError(f"{found.status}: {found.message}")
    return [found.film(name) for name in found.film_names]


def hottest_pad(rpm: float) -> tuple[float, float]:
    """Temperature [degrees Celsius] of the hottest face of a pad, by the parabola across the gap, and of the shaft, by
    the secant method."""

    def taken(shaft: float) -> tuple[float, list[Any]]:
        films = at_rest(rpm, wf.films.FilmTemperature(SUPPLY, wall_b=shaft))
        heat = sum(float(film.heat_generated[-1]) for film in films)
        return sum(float(film.heat_to_b[-1]) for film in films) / heat, films

    before, shaft = FIRST_GUESSES
    last, (now, films) = taken(before)[0], taken(shaft)
    for _ in range(6):
        if abs(now) <= NO_HEAT:
            break
        before, last, shaft = shaft, now, shaft - now * (shaft - before) / (now - last)
        now, films = taken(shaft)
    else:
        raise RuntimeError(f"the shaft finds no temperature at {rpm} rpm")
    mean = max(float(film.temperature[-1].max()) for film in films)
    return shaft + 1.5 * (mean - shaft), shaft
