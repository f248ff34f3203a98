"""A rigid rotor with unbalance in an oil film: as one scene, and with its equations outside of the scene of the film.

The bearing lies along y; x is the direction of the load, and the plane of the orbit is x and z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import root

import warpffrf as wf
from warpffrf.model.bodies import Port

RADIUS, CLEARANCE, LENGTH, VISCOSITY = 0.025, 50e-6, 0.025, 0.01  # m, m, m, Pa s
SPEED, MASS, LOAD, UNBALANCE = 300.0, 5.0, 1000.0, 300.0  # rad/s, kg, N, N
BEGIN = (0.3 * CLEARANCE, -0.1 * CLEARANCE)  # m, of the search for the equilibrium
TURN = 2.0 * np.pi / SPEED  # s
FORCES = ("film_force_x[film]", "film_force_z[film]")  # on the bore

Array = np.ndarray


def load(time: float) -> Array:
    """(2,) N on the rotor."""
    return np.array([LOAD + UNBALANCE * np.sin(SPEED * time), UNBALANCE * np.cos(SPEED * time)])


def film_scene(at: tuple[float, float], nodes: tuple[int, int]) -> tuple[wf.Scene, Port]:
    """A bore that is held, and a journal that rotates at `at`; not yet held."""
    bore = wf.surfaces.Bore(radius=RADIUS, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    body = wf.rigid_film_body(
        1.0, (1e-3,) * 3, contact={"bore": bore}, extent=(-0.5 * LENGTH, 0.5 * LENGTH), nodes=nodes,
        points={"outside": (0, 0, 0)},
    )  # fmt: skip
    scene, place, J = wf.Scene(gravity=(0, 0, 0)), (at[0], 0.0, at[1]), 0.5 * MASS * RADIUS**2
    held = scene.add_body(body, name="sleeve")
    scene.add(wf.joints.Fixed(scene.ground, held["outside"], axis=(0, 1, 0), name="held"))
    axle = wf.surfaces.Cylinder(radius=RADIUS - CLEARANCE, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    rotor = scene.add_rigid_body(
        MASS, (J, J, J), name="rotor", position=place, angular_velocity=(0, SPEED, 0), surfaces={"journal": axle}
    )
    groove = wf.films.AxialGroove(np.pi, 1e-4, 0.0)
    oil = wf.oils.Newtonian(VISCOSITY)
    scene.add(wf.Film(held["bore"], rotor["journal"], oil=oil, feeds=[groove], name="film"))
    return scene, rotor.at((0, 0, 0))


def whole(steps: int, turns: int, nodes: tuple[int, int]) -> Array:
    """(steps + 1, 2) m: places of the rotor in a run of one scene with so many steps, from its equilibrium."""
    scene, centre = film_scene(BEGIN, nodes)
    joint = scene.add(wf.joints.Planar(scene.ground.at((BEGIN[0], 0, BEGIN[1])), centre, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(joint, wf.signals.Constant(SPEED), quantity="velocity", name="speed"))
    per, duration = SPEED / (2.0 * np.pi), turns * TURN  # Hz, s
    across = wf.signals.Sine(UNBALANCE, per, phase=0.5 * np.pi, duration=duration)
    along = wf.signals.Sine(UNBALANCE, per, duration=duration, mean=LOAD)
    scene.add(wf.forces.PointForce(centre, (along, 0.0, across), name="load"))
    result = wf.simulate(scene, duration, step=duration / steps, start="equilibrium", progress=False, check=True)
    return result.body("rotor").position[:, [0, 2]]


@dataclass
class Outside:
    """places: (steps + 1, 2) m of the rotor; trials: steps of the film in total."""

    places: Array
    trials: int


def outside(begin: Array, steps: int, turns: int, nodes: tuple[int, int]) -> Outside:
    """The rotor by two-step backward differences and `scipy.optimize.root`, in the film by a `Connector`."""
    scene, centre = film_scene((float(begin[0]), float(begin[1])), nodes)
    at, carrier = (begin[0], 0.0, begin[1]), []
    for number, (axis, name) in enumerate((((1, 0, 0), "x"), ((0, 0, 1), "z"))):
        carrier.append(scene.add_rigid_body(1.0, (1e-3,) * 3, name=f"slide {name}", position=at))
        below = scene.ground.at(at) if number == 0 else carrier[0]
        guide = scene.add(wf.joints.Prismatic(below, carrier[-1], axis=axis, name=f"guide {name}"))
        place = wf.signals.Input(name, unit="m")
        scene.add(wf.joints.Drive(guide, place, quantity="position", name=name))
    joint = scene.add(wf.joints.Revolute(carrier[-1], centre, axis=(0, 1, 0), name="axis"))
    scene.add(wf.joints.Drive(joint, wf.signals.Constant(SPEED), quantity="velocity", name="speed"))
    h = turns * TURN / steps
    film = wf.Connector(wf.Simulation(scene, step=h, start="equilibrium"), inputs=["x", "z"], outputs=FORCES)
    x, v, share, trials = [np.zeros(2)] * 2, [np.zeros(2)] * 2, 4.0 * h * h / (9.0 * MASS), 0
    places = [begin]
    for n in range(steps):
        now = (4.0 * v[-1] - v[-2]) / 3.0
        b, p = (4.0 * x[-1] - x[-2]) / 3.0 + 2.0 * h / 3.0 * now, load((n + 1) * h)
        found = root(lambda c, b=b, p=p: c - (b + share * (p - film(c * CLEARANCE))) / CLEARANCE,
                     (2.0 * x[-1] - x[-2]) / CLEARANCE, tol=1e-7, options={"eps": 1e-6})  # fmt: skip
        assert found.success, found.message
        trials += found.nfev
        force = p - film(found.x * CLEARANCE)
        film.accept()
        x.append(found.x * CLEARANCE)
        v.append(now + 2.0 * h / (3.0 * MASS) * force)
        places.append(begin + x[-1])
    return Outside(np.array(places), trials)
