"""A plane slider at rest over a surface that slides: its film with a temperature."""

from __future__ import annotations

from typing import Any

import warpffrf as wf

VISCOSITY, CAPACITY, CONDUCTIVITY, DENSITY, SUPPLY = 0.05, 2000.0, 0.13, 880.0, 40.0  # at SUPPLY, degrees Celsius


def oil(slope: float, viscosity: float = VISCOSITY) -> wf.oils.Oil:
    """Viscosity that falls by exp(-slope) per kelvin, from that at the supply's temperature."""
    law = wf.oils.ExponentialLaw(slope)
    return wf.oils.Newtonian(
        viscosity, thermal=wf.oils.Thermal(law, SUPPLY, CAPACITY, CONDUCTIVITY, DENSITY, expansion=0.0)
    )


def slider(
    gaps: tuple[float, float], *, speed: float = 5.0, breadth: float = 0.01, length: float = 0.2, cells: int = 64,
    **film: Any,
) -> wf.Scene:  # fmt: skip
    """Of `breadth` along the sliding and `length` across [m], with `gaps` [m] at its beginning and its end, so long
    that its middle row, 4, is one-dimensional."""
    face = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, -1))
    body = wf.rigid_film_body(
        1.0, (1e-3,) * 3, contact={"face": face}, extent=((0.0, breadth), (-0.5 * length, 0.5 * length)),
        nodes=(cells + 1, 9),
    )  # fmt: skip
    scene = wf.Scene()
    inlet, outlet = gaps
    held = scene.add_body(
        body, name="slider", position=(0, 0, inlet), rotation={"axis": (0, 1, 0), "angle": (inlet - outlet) / breadth}
    )
    scene.add(wf.joints.Fixed(scene.ground.at((0, 0, inlet)), held["center"]))
    top = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    runner = scene.add_rigid_body(1.0, (0.1,) * 3, name="runner", velocity=(speed, 0, 0), surfaces={"top": top})
    scene.add(wf.joints.Prismatic(scene.ground, runner, axis=(1, 0, 0), name="guide"))
    scene.add(wf.joints.Drive(scene.joint("guide"), speed, quantity="velocity"))
    given: dict[str, Any] = {"cavitation": "full_sommerfeld", "ambient_pressure": 1e5, "name": "film"} | film
    scene.add(wf.Film(held["face"], runner["top"], **given))
    return scene
