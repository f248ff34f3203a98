"""The smallest runs that have something to draw: rollers that begin to turn with friction, an oiled shaft, a
small-sliding contact that is pushed to and fro, a ball bearing under a load, gears that rotate by a pitch."""

from __future__ import annotations

import numpy as np
import small_sliding_runs

import warpffrf as wf
from scenes.gears import RELIEVED
from scenes.gears import rolling as rolling_gears
from scenes.rollers import STEEL, guided_pair, roller_body
from warpffrf.model import films, forces, joints, oils, surfaces
from warpffrf.model.mesh import sleeve
from warpffrf.output.result import Result

STEPS, STEP, SPEED = 24, 1e-4, 200.0  # -, s, rad/s reached at the end
RADIUS, CLEARANCE = 0.025, 25e-6  # m, of the bore, and of the shaft in it


def rolling() -> Result:
    """Two rollers on cells that travel, finer than the mesh, pressed and rotated from rest against each other."""
    body = roller_body(
        48, layers=2, axial=2, grading=2.0, order=1, modes=2, max_frequency=None, tangential=True, contact_fixed=True,
        cache=False,
    )  # fmt: skip
    scene = guided_pair(body, body, load=2e4, speed=SPEED, ramp=STEPS * STEP, friction=0.2)
    return wf.simulate(scene, STEPS * STEP, step=STEP, start="equilibrium", progress=False)


def oiled() -> Result:
    """A rigid shaft that turns in a steel sleeve under a load, from near the middle on."""
    mesh = sleeve(RADIUS, 1.5 * RADIUS, RADIUS, sectors=24, order=1, axial=4)
    body = wf.reduce(
        mesh, STEEL, interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()}, modes=2, cache=False,
        progress=False,
    )  # fmt: skip
    scene = wf.Scene()
    held = scene.add_body(body, name="sleeve")
    scene.add(joints.Fixed(scene.ground, held["outside"]))
    journal = surfaces.Cylinder(radius=RADIUS - CLEARANCE, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    shaft = scene.add_rigid_body(
        1.0, (3e-4,) * 3, name="shaft", position=(0.3 * CLEARANCE, 0.0, 0.0), angular_velocity=(0.0, 300.0, 0.0),
        surfaces={"rim": journal},
    )  # fmt: skip
    middle = shaft.at((0, 0, 0))
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), middle, axis=(0, 1, 0)))
    scene.add(joints.Drive(plane, 300.0, quantity="velocity"))
    scene.add(forces.PointForce(middle, (0.0, 0.0, -2e3)))
    groove = films.AxialGroove(np.pi, 1e-4, 0.0)
    oil = oils.Newtonian(0.01, thermal=oils.Thermal(oils.ExponentialLaw(0.03), 40.0, 2000.0))
    warm = films.FilmTemperature(40.0, wall_a=45.0)
    scene.add(wf.Film(held["bore"], shaft["rim"], oil=oil, feeds=[groove], temperature=warm, name="film"))
    return wf.simulate(scene, 2e-3, step=2e-4, progress=False)


def rubbing_contact() -> Result:
    """The small-sliding contact of `small_sliding_runs` through half a cycle of its push."""
    step = small_sliding_runs.PERIOD / 10.0
    return wf.static(small_sliding_runs.scene(), 0.5 * small_sliding_runs.PERIOD, step=step, progress=False)


def loaded_bearing() -> Result:
    """A ball bearing whose inner ring is pressed outwards, at rest."""
    scene = wf.Scene()
    bearing = scene.add_bearing(
        "bearing", wf.bearings.BallGeometry(elements=7, ball_diameter=11.5e-3, pitch_diameter=43.5e-3), first=(0, 0, 1),
        outer=scene.ground,
    )  # fmt: skip
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, 0.0, 1e3)))
    return wf.equilibrium(scene, progress=False)


def gears() -> Result:
    """Two gears with tip relief that rotate by slightly more than a pitch."""
    scene = rolling_gears(RELIEVED, 1e-3, 100.0, 150.0)
    return wf.simulate(scene, 2.8e-3, step=2e-5, start="equilibrium", progress=False)
