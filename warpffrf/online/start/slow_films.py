"""How long films take to become steady, for equilibria: voids come around with half of the sliding speed.

A proximal step squeezes films over its own time, which may not grow beyond what joints bear; where walls slide slowly a
film needs far longer. So its time is stretched against that of the bodies.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.bodies import Body
from warpffrf.model.films import Film
from warpffrf.model.scene import Scene

TURNS = 30.0  # of the oil in the longest step: each such step leaves a thirtieth of what was not steady


def stretch(scene: Scene, longest: float) -> float:
    """Time of films over that of the bodies; longest [s]: step of these."""
    times = [time for film in scene.films if (time := slide_time(film)) is not None]
    return max([1.0, *(TURNS * time / longest for time in times)])


def slide_time(film: Film) -> float | None:
    """Time [s] that the oil takes through a film with the velocities that the scene begins with; None where nothing
    slides."""
    shape, grid = film.a.surface.shape, film.grid
    theta, z = film.theta[grid.columns // 2], 0.5 * (grid.z[0] + grid.z[-1])
    at = film.a.body.to_world(shape.point(theta, z))
    velocities = []
    for body in (film.a.body, film.b.body):
        still = np.zeros(3)
        moving = isinstance(body, Body)
        velocities.append(body.velocity + np.cross(body.angular_velocity, at - body.position) if moving else still)
    normal = film.a.body.to_world(shape.point(theta, z) + shape.normal(theta, z)) - at
    sliding = velocities[1] - velocities[0]
    speed = 0.5 * float(np.linalg.norm(sliding - (sliding @ normal) * normal))
    radius = 1.0 if shape.profile().planar else float(shape.radius_at(z))
    length = max(radius * grid.pitch * grid.columns, float(grid.z[-1] - grid.z[0]))
    return length / speed if speed > 0.0 else None
