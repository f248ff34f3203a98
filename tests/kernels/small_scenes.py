"""Small scenes that between them launch every kernel, and how each is run; bodies have a few dozen cells around."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from scenes.flat_settings import reduce_flat
from scenes.rollers import STEEL, Path, guided_pair, roller_body, solve_path
from warpffrf.model import films, forces, joints, laws, mesh, oils, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.films import Film
from warpffrf.model.friction import RegularisedCoulomb, Stribeck
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Matched
from warpffrf.offline import ContactGrid, ReductionOptions, reduce
from warpffrf.offline.contact.cubature import choose_sampling
from warpffrf.online import Engine, Settings, run
from warpffrf.online.load_steps import run_static
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.vibrations.eigenmodes import find_modes
from warpffrf_kernels.core import control as k

STEP, STEPS = 2e-5, 5
RESISTANCE = laws.RollingResistanceArm(1e-4, 1.0)
RADIUS, BALL = 0.05, 0.02  # m
ALUMINIUM = Material(70e9, 0.34, 2700.0)
WIDE = Settings(window_strain=0.3)  # patches of many nodes on coarse grids


# --- bodies


@functools.cache
def roller(**options: Any) -> ReducedBody:
    made: dict[str, Any] = {"layers": 2, "axial": 2, "grading": 1.6, "order": 1, "max_frequency": 12e3} | options
    return roller_body(made.pop("sectors", 60), cache=False, **made)


@functools.cache
def rubbing() -> ReducedBody:
    return roller(tangential=True, contact_fixed=False)


@functools.cache
def patched(**options: Any) -> ReducedBody:
    """A roller whose mesh is much coarser than its patches."""
    made = mesh.roller(RADIUS, 0.015, 0.02, sectors=36, layers=2, axial=2, grading=1.6, order=1)
    return reduce_flat(
        made, options.pop("material", STEEL), interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()},
        max_frequency=12e3, contact_fixed=True, cache=False, progress=False, **options,
    )  # fmt: skip


def rubbing_patched(material: Material = STEEL) -> ReducedBody:
    return patched(tangential=True, material=material)


@functools.cache
def dynamic_roller() -> ReducedBody:
    made = mesh.roller(RADIUS, 0.015, 0.02, sectors=48, layers=2, axial=2, grading=1.6, order=1)
    return reduce(
        made, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=4,
        options=ReductionOptions(local_dynamics=True), cache=False, progress=False,
    )  # fmt: skip


@functools.cache
def few_points(sectors: int) -> ReducedBody:
    """A roller whose gaps are taken at chosen points: of 90 sectors they stand on stations of the line of centres, of
    60 elsewhere."""
    body = roller(sectors=sectors)
    rim = body.contact_surfaces["rim"]
    return replace(body, contact_surfaces={"rim": replace(rim, sampling=choose_sampling(rim, 0.01))})


@functools.cache
def beam() -> ReducedBody:
    """A bar whose loads stiffen it, with interfaces of every kind."""
    made = mesh.box((0.02, 0.3, 0.01), (1, 8, 1), order=2)
    made = made.select("middle", "z_max", lambda centers: np.abs(centers[:, 1]) < 0.1)
    return reduce(
        made, STEEL, interfaces={"y_min": "rigid", "y_max": "average", "middle": "free"},
        contact={"x_max": surfaces.Plane()}, modes=6, options=ReductionOptions(stiffening=True), cache=False,
        progress=False,
    )  # fmt: skip


@functools.cache
def plate() -> ReducedBody:
    """A plate between two rigid ends, with membrane energy."""
    made = mesh.box((0.2, 0.2, 0.004), (3, 3, 1), order=2)
    return reduce(
        made, STEEL, interfaces={"x_min": "rigid", "x_max": "rigid"}, modes=6,
        options=ReductionOptions(stiffening="membrane"), cache=False, progress=False,
    )  # fmt: skip


@functools.cache
def ring() -> ReducedBody:
    """Contact on the inside; its grid matches no roller's."""
    made = mesh.roller(0.075, 0.055, 0.024, sectors=42, layers=2, axial=3, grading=1.0)
    return reduce(
        made, STEEL, interfaces={"rim": "rigid"}, contact={"bore": surfaces.Bore()}, modes=4,
        grid=ContactGrid(tangential=True, contact_fixed=False),
        cache=False, progress=False,
    )  # fmt: skip


@functools.cache
def block() -> ReducedBody:
    """Its contact grid ends on all four sides."""
    made = mesh.box((0.02, 0.02, 0.01), (4, 4, 2))
    return reduce(
        made, STEEL, interfaces={"z_min": "rigid"}, contact={"z_max": surfaces.Plane()}, modes=2,
        grid=ContactGrid(tangential=True, contact_fixed=False),
        cache=False, progress=False,
    )  # fmt: skip


# --- scenes


def chain() -> Scene:
    """Links in joints of all kinds, springs of all kinds between them, and loads."""
    scene = Scene(gravity=(0.3, -0.5, -9.81))
    links = [
        scene.add_rigid_body(0.5, (1e-3, 2e-3, 2e-3), name=f"link {i}", position=(0.2 * i + 0.1, 0.0, 0.0))
        for i in range(len(joints.JOINT_KINDS))
    ]
    turned = [scene.ground, *(link.at((0.1, 0.0, 0.0)) for link in links)]
    for i, kind in enumerate(joints.JOINT_KINDS):
        given: dict[str, Any] = {"axis": (0.0, 1.0, 0.0)} if kind not in ("spherical", "distance") else {}
        given |= {"second_axis": (0.0, 0.0, 1.0)} if kind == "universal" else {}
        given |= {"line": (0.0, 0.0, 1.0)} if kind == "line_in_plane" else {}
        near = -0.1 if kind != "distance" else -0.05
        joint = scene.add(joints.JOINT_KINDS[kind](turned[i], links[i].at((near, 0.0, 0.0)), **given, name=kind))
        if kind == "revolute":
            scene.add(forces.TorsionalSpringDamper(joint, 2.0, 0.01))
        elif kind == "cylindrical":
            scene.add(forces.JointSpringDamper(joint, 200.0, 1.0, coordinate="translation"))
        elif kind == "prismatic":
            scene.add(joints.Drive(joint, signals.SmoothStep(0.0, 0.1, duration=0.01), quantity="velocity"))
    scene.add(forces.SpringDamper(links[0].at((0.0, 0.1, 0.0)), links[4].at((0.0, 0.1, 0.0)), 100.0, 1.0))
    stiffness = np.diag([1e3, 2e3, 3e3, 10.0, 20.0, 30.0]) + 1.0
    scene.add(forces.Bushing(links[4].at((0.1, 0.0, 0.0)), links[5].at((-0.1, 0.0, 0.0)), stiffness, 1e-2 * stiffness))
    scene.add(
        forces.BearingSpring(
            scene.ground, links[-1].at((0.1, 0.0, 0.0)), axis=(1, 0, 0), radial=1e3, axial=2e3, tilt=10.0
        )
    )
    load = signals.Table([0.0, 1.0, 10.0], [0.0, 2.0, 1.0])
    scene.add(forces.PointForce(links[2].at((0.0, 0.0, 0.05)), (load, (0.0, 1.0, 0.0)), frame="body"))
    scene.add(forces.PointTorque(links[6].at((0.0, 0.0, 0.0)), (0.01, 0.0, 0.02)))
    return scene


def pendulum() -> Scene:
    """A pin that rubs, of a bar that swings and is held by a spring and a damper that are not in proportion."""
    scene = Scene()
    bar = scene.add_rigid_body(1.0, (1e-2, 1e-2, 1e-2), name="bar", position=(0.1, 0.0, 0.0))
    pin = scene.add(joints.Revolute(scene.ground.at((0, 0, 0)), bar.at((-0.1, 0, 0)), axis=(0, 1, 0), name="pin"))
    scene.add(forces.RevoluteFriction(pin, 0.3, pin_radius=0.01, load_independent=1.0))
    table = forces.ForceTable([[-0.1, -1.0], [0.0, 0.0], [0.1, 2.0]])
    scene.add(forces.SpringDamper(scene.ground.at((0.1, 0, 0.2)), bar.at((0, 0, 0)), table, forces.PowerLaw(2.0, 1.5)))
    return scene


def meeting(first: Any, second: Any, law: Any, height: float, **contact: Any) -> Scene:
    """A rigid body that is thrown on the ground, along it too, in lumped contact with friction."""
    scene = Scene()
    body = scene.add_rigid_body(
        0.1, (1e-5, 1e-5, 1e-5), name="body", position=(0, 0, height), velocity=(0.1, 0, -0.1), surfaces={"skin": first}
    )
    floor = scene.ground.surface(second, name="floor")
    scene.add(LumpedContact(body["skin"], floor, law=law, friction=0.2, name="pair", **contact))
    return scene


def beams() -> Scene:
    """Flexible bars that turn and are loaded at places and over surfaces, at the fullest level of inertia; the ends of
    one are drawn together, and held then."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    spin = np.array([0.0, 0.0, 20.0])
    bars = []
    for i in range(2):
        at = np.array([0.0, 0.15 + 0.3 * i, 0.0])
        bars.append(
            scene.add_body(
                beam(), name=f"bar {i}", position=at, velocity=np.cross(spin, at), angular_velocity=spin,
                inertia="full", stiffening=True,
            )
        )  # fmt: skip
    scene.add(joints.Revolute(scene.ground, bars[0]["y_min"], axis=(0, 0, 1)))
    scene.add(joints.Revolute(bars[0]["y_max"], bars[1]["y_min"], axis=(1, 0, 0)))
    scene.add(forces.Bushing(bars[0]["y_max"], bars[1]["y_min"], np.diag([0.0, 0.0, 0.0, 5.0, 5.0, 5.0])))
    scene.add(forces.PointForce(bars[1]["y_max"], (0.0, 0.0, -50.0)))
    scene.add(forces.PointTorque(bars[1]["y_max"], (1.0, 0.0, 0.0), frame="body"))
    tie = scene.add(joints.PointOnLine(bars[1]["y_min"], bars[1]["y_max"], axis=(0, 1, 0)))
    scene.add(forces.Pretension(tie, 20.0, lock_at=1e-4))
    scene.add(forces.SurfaceLoad(bars[0]["x_max"], 1e3))
    scene.add(forces.NodalLoad(bars[1]["middle"], (0.0, 0.0, 0.1)))
    return scene


def plates() -> Scene:
    """A plate that hangs from one of its ends, next to a bar without membrane energy."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    scene.add_body(beam(), name="bar", position=(1.0, 0.0, 0.0))
    held = scene.add_body(plate(), name="plate", stiffening=True)
    scene.add(joints.Fixed(scene.ground, held["x_min"]))
    scene.add(forces.PointForce(held["x_max"], (0.0, 0.0, -50.0)))
    return scene


def rollers(
    first: ReducedBody,
    second: ReducedBody,
    *,
    quadrature: str = "full",
    grid: str = "body_fixed",
    law: Any = None,
    cells: tuple[int, int] | None = None,
    **more: Any,
) -> Scene:
    scene = guided_pair(first, second, **{"load": 60e3, "speed": 60.0, "ramp": 0.02} | more)
    scene.contacts[0].quadrature = quadrature
    scene.contacts[0].grid = grid
    scene.contacts[0].cells = cells
    scene.contacts[0].law = law or scene.contacts[0].law
    return scene


def three_rollers(body: ReducedBody, **contact: Any) -> Scene:
    """The middle one serves two pairs."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    placed = [
        scene.add_body(body, name=f"roller {i}", position=(0.0, 0.0, i * (2.0 * RADIUS - 4e-5))) for i in range(3)
    ]
    for i, roller in enumerate(placed):
        axle = scene.add(joints.Revolute(scene.ground, roller["bore"], axis=(0, 1, 0)))
        turn = signals.SmoothStep(0.0, 30.0 * (-1.0) ** i * (1.0 + 0.02 * i), duration=1e-3)
        scene.add(joints.Drive(axle, turn, quantity="velocity"))
    scene.add(Contact(placed[1]["rim"], placed[0]["rim"], **contact))
    scene.add(Contact(placed[1]["rim"], placed[2]["rim"], **contact))
    return scene


def ball_on(
    body: ReducedBody,
    interface: str = "bore",
    face: str = "rim",
    *,
    at: tuple[float, float, float] = (0.0, 0.001, RADIUS),
    speed: float = 0.5,
    **contact: Any,
) -> Scene:
    """A rigid ball that falls on the place `at` of a body while it slides and spins: gaps at points."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    held = scene.add_body(body, name="held")
    scene.add(joints.Fixed(scene.ground, held[interface]))
    ball = scene.add_rigid_body(
        0.3, (5e-5,) * 3, name="ball", position=np.array(at) + (0.0, 0.0, BALL + 2e-6), velocity=(0.1, 0.05, -speed),
        angular_velocity=(1.0, 2.0, 3.0),
    )  # fmt: skip
    shape = surfaces.Sphere(radius=BALL, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    scene.add(Contact(held[face], ball.surface(shape, name="face"), **contact))
    return scene


def roller_in_ring(**contact: Any) -> Scene:
    """A roller that rolls on the inside of a ring, both flexible: gaps at points."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    retained = scene.add_body(ring(), name="ring")
    scene.add(joints.Fixed(scene.ground, retained["rim"]))
    inner = scene.add_body(
        rubbing(), name="roller", position=(0.0, 0.003, -0.005 - 1e-5), angular_velocity=(0.0, 10.0, 0.0)
    )
    scene.add(Contact(inner["rim"], retained["bore"], **contact))
    return scene


@functools.cache
def sleeve(modes: int = 4) -> ReducedBody:
    """A bore that is held outside."""
    made = mesh.sleeve(0.025, 0.035, 0.02, sectors=16, order=1, axial=4)
    return reduce(
        made, STEEL, interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()}, modes=modes, cache=False,
        progress=False,
    )  # fmt: skip


@functools.cache
def hollow_shaft() -> ReducedBody:
    """A shaft that is shorter than its bore, with columns of another pitch."""
    made = mesh.roller(0.025 - 25e-6, 0.015, 0.016, sectors=12, layers=2, order=1, axial=3)
    return reduce(
        made, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=4, cache=False,
        progress=False,
    )  # fmt: skip


def journal(*, load: float = 2e3, feed: float = 1e5, speed: float = 300.0, yields: bool = False, **given: Any) -> Scene:
    """A shaft that is rotated in a film of oil, with voids, in a bore that yields; it may yield too."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    bore = scene.add_body(sleeve(), name="bore")
    scene.add(joints.Fixed(scene.ground, bore["outside"], axis=(0, 1, 0)))
    turning: dict[str, Any] = {"name": "shaft", "angular_velocity": (0.0, speed, 0.0)}
    if yields:
        shaft = scene.add_body(hollow_shaft(), **turning)
        middle = shaft["bore"]
    else:
        shape = surfaces.Cylinder(radius=0.025 - 25e-6, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
        shaft = scene.add_rigid_body(0.5, (2e-4,) * 3, surfaces={"rim": shape}, **turning)
        middle = shaft.at((0, 0, 0))
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), middle, axis=(0, 1, 0)))
    scene.add(joints.Drive(plane, signals.Constant(speed), quantity="velocity"))
    scene.add(forces.PointForce(middle, (signals.Table((0.0, 1e-3, 1.0), (load, 2 * load, 0.0)), 0, 0)))
    feeds = [films.AxialGroove(np.pi, 1e-4, feed)]
    scene.add(Film(bore["bore"], shaft["rim"], **{"oil": oils.Newtonian(0.01), "feeds": feeds} | given))
    return scene


@functools.cache
def half(face: str) -> ReducedBody:
    """A block whose `face` lies on another one."""
    other = "z_min" if face == "z_max" else "z_max"
    return reduce(
        mesh.box((0.06, 0.02, 0.02), (3, 2, 2), order=1),
        STEEL,
        interfaces={other: "rigid"},
        contact={"face": Matched(first=face)},
        modes=6,
        cache=False,
        progress=False,
    )


@functools.cache
def folded() -> ReducedBody:
    """A clamped fork of two leaves, whose inner faces lie on each other."""
    filled = np.ones((3, 1, 3), dtype=bool)
    filled[1:, :, 1] = False
    leaves = mesh.grid((0.0, 0.01, 0.03, 0.05), (0.0, 0.01), (0.0, 4e-3, 4.01e-3, 8e-3), filled=filled, order=1)
    for name, z in (("low", 4e-3), ("high", 4.01e-3)):
        leaves = leaves.select_plane(name, point=(0.02, 0, z), normal=(0, 0, 1))
    leaves = leaves.select("tip", "z_max", lambda x: x[:, 0] > 0.03)
    return reduce(
        leaves,
        STEEL,
        interfaces={"x_min": "rigid", "tip": "average"},
        contact={"lap": Matched("high", first="low")},
        modes=6,
        cache=False,
        progress=False,
    )


def lapped(friction: float = 0.3, push: float = 700.0) -> Scene:
    """Two blocks pressed together, one of them pulled along until some cells slip."""
    scene = Scene(gravity=(0, 0, 0))
    base = scene.add_body(half("z_max"), name="base", position=(0, 0, 0.01))
    top = scene.add_body(half("z_min"), name="top", position=(0, 0, 0.03))
    scene.add(joints.Fixed(scene.ground, base["z_min"]))
    if not friction:
        scene.add(joints.Prismatic(scene.ground, top["z_max"], axis=(0, 0, 1)))
    scene.add(Contact(top["face"], base["face"], sliding="small", friction=friction))
    along = signals.Ramp(0.0, push, duration=1e-4)
    scene.add(forces.PointForce(top["z_max"], (along if friction else 0.0, 0.0, -2000.0)))
    return scene


def fork(friction: float) -> Scene:
    """The leaves of a fork pressed together at their ends, in a state of one body."""
    scene = Scene(gravity=(0, 0, 0))
    body = scene.add_body(folded(), name="fork")
    scene.add(joints.Fixed(scene.ground, body["x_min"]))
    scene.add(Contact(body["lap"], sliding="small", friction=friction))
    scene.add(forces.PointForce(body["tip"], (0.0, 0.0, signals.Ramp(-300.0, -600.0, duration=1e-4))))
    return scene


# --- how they are run


@dataclass(frozen=True)
class Case:
    """A scene, how many steps of which size [s] it takes, and how that ends."""

    build: Callable[[], Scene]
    step: float = STEP
    options: dict[str, Any] = field(default_factory=dict)
    how: Callable[[Case], str] = lambda case: case.go()
    ends: str = "completed"

    def go(self) -> str:
        """The status of a run."""
        return run(self.build(), STEPS * self.step, step=self.step, progress=False, **self.options).status


def two_worlds(case: Case) -> str:
    """The same in two copies."""
    engine = Engine(case.build(), worlds=2, settings=WIDE)
    assert settle(engine)
    engine.initial_rates()
    start_consistently(engine)
    engine.control(every=1)
    engine.enter(k.DYNAMIC, case.step, target=STEPS)
    engine.replay(4 * STEPS)
    return "completed" if np.all(engine.word("step") == STEPS) else "not_converged"


def load_steps(case: Case) -> str:
    """Equilibria one after the other."""
    return run_static(case.build(), STEPS * case.step, step=case.step, progress=False).status


def modes(case: Case) -> str:
    """Vibrations about the equilibrium."""
    find_modes(case.build(), 4)
    return "completed"


def all_round(case: Case) -> str:
    """Static states of two tilted rollers that are rotated until every column has met others, on both grids."""
    turned = np.linspace(0.0, 2.0 * np.pi, 13)
    path = Path.of(np.full(13, 4e-4), turned, -1.7 * turned)
    return solve_path(roller(), roller(sectors=42, outer_radius=0.035), path, tilt=2e-3, settings=WIDE).status


def suddenly(load: float) -> signals.Table:
    """A load that is far too large from the first step on."""
    return signals.Table((0.0, 1e-5, 1.0), (60e3, load, load))


REST: dict[str, Any] = {"start": "equilibrium", "settings": WIDE}
HOPELESS: dict[str, Any] = {"start": "equilibrium", "settings": replace(WIDE, max_level=2)}
DAMPED = laws.HuntCrossley(1e15, 1.5, damping=50.0)
ASPERITIES = laws.ExponentialAsperities(2e8, 5e-6)
PROJECTED = GeneralizedAlpha(project_velocities=True)
FLOOR = surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
WHEEL = surfaces.Cylinder(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
BEAD = surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 0, 1))
CASES: dict[str, Case] = {
    "chain": Case(chain, 1e-3),
    "chain, projected": Case(chain, 1e-3, {"integrator": PROJECTED, "step_error": 1e-6}),
    "pendulum": Case(pendulum, 1e-3),
    "bead": Case(lambda: meeting(BEAD, FLOOR, laws.HertzPoint(STEEL, STEEL), 0.01), 1e-5),
    "wheel": Case(lambda: meeting(WHEEL, FLOOR, laws.PalmgrenLine(0.01, 5), 0.01, rolling_resistance=RESISTANCE), 1e-5),
    "beams": Case(beams, 1e-4),
    "plates": Case(plates, 1e-4),
    "rollers": Case(lambda: rollers(roller(), roller(sectors=42, outer_radius=0.035)), options=REST),
    "rollers, sudden": Case(lambda: rollers(roller(), roller(), ramp=5e-4), 1e-4, REST),
    "rollers, wide": Case(lambda: rollers(roller(), roller(), load=600e3), options=REST | {"step_error": 1e-9}),
    "rollers, asperities": Case(lambda: rollers(roller(), roller(), law=ASPERITIES), options=REST),
    "rollers, damped layer": Case(lambda: rollers(roller(), roller(), law=DAMPED), options=REST),
    "rollers, projected": Case(lambda: rollers(roller(), roller()), options=REST | {"integrator": PROJECTED}),
    "rollers, vibrations": Case(lambda: rollers(roller(), roller()), how=modes),
    "rollers, all round": Case(Scene, how=all_round),
    "rollers, two worlds": Case(lambda: rollers(rubbing(), rubbing(), friction=0.3), how=two_worlds),
    "crowned rollers": Case(lambda: rollers(roller(crown_radius=0.6, axial=5), roller()), options=REST),
    "few points": Case(lambda: rollers(few_points(90), roller(), quadrature="reduced"), options=REST),
    "few points elsewhere": Case(lambda: rollers(few_points(60), roller(), quadrature="reduced"), options=REST),
    "few points, asperities": Case(
        lambda: rollers(few_points(90), roller(), quadrature="reduced", law=ASPERITIES), options=REST
    ),
    "friction": Case(lambda: rollers(rubbing(), rubbing(), friction=0.3, load=300e3), options=REST),
    "friction, regularised": Case(
        lambda: rollers(rubbing(), rubbing(), friction=RegularisedCoulomb(0.3, 1e-2)), options=REST
    ),
    "friction, falling with the speed": Case(
        lambda: rollers(rubbing(), rubbing(), friction=Stribeck(0.4, 0.2, 1e-2)), options=REST
    ),
    "friction, damped layer": Case(lambda: rollers(rubbing(), rubbing(), friction=0.3, law=DAMPED), options=REST),
    "rollers, patch": Case(lambda: rollers(patched(), patched(), grid="contact_fixed"), options=REST),
    "rollers, patch with a layer": Case(
        lambda: rollers(patched(), patched(), grid="contact_fixed", law=laws.LinearLayer(1e14)), options=REST
    ),
    "ball, patch": Case(lambda: ball_on(patched(), grid="contact_fixed"), 2e-6),
    "rollers, patch with a damped layer": Case(
        lambda: rollers(patched(), patched(), grid="contact_fixed", law=DAMPED), options=REST
    ),
    "three rollers, patches": Case(lambda: three_rollers(patched(), grid="contact_fixed"), options=REST),
    "rollers, patch with friction": Case(
        lambda: rollers(rubbing_patched(), rubbing_patched(), grid="contact_fixed", friction=0.3), options=REST
    ),
    "rollers, patch of many cells with friction": Case(
        lambda: rollers(
            rubbing_patched(), rubbing_patched(ALUMINIUM), grid="contact_fixed", cells=(21, 20), friction=0.3
        ),
        options=REST,
    ),
    "unlike rollers, patch with friction": Case(
        lambda: rollers(rubbing_patched(), rubbing_patched(ALUMINIUM), grid="contact_fixed", friction=0.3), options=REST
    ),
    "rollers, patch with falling friction": Case(
        lambda: rollers(
            rubbing_patched(), rubbing_patched(), grid="contact_fixed", friction=Stribeck(0.4, 0.2, 1e-2)
        ),
        options=REST,
    ),
    "ball, patch with friction": Case(lambda: ball_on(rubbing_patched(), grid="contact_fixed", friction=0.2), 2e-6),
    "three rollers, patches with friction": Case(
        lambda: three_rollers(rubbing_patched(), grid="contact_fixed", friction=0.2), options=REST
    ),
    "three rollers": Case(lambda: three_rollers(roller()), options=REST),
    "three rollers, friction": Case(lambda: three_rollers(rubbing(), friction=0.2), options=REST),
    "ball": Case(lambda: ball_on(roller()), 2e-6),
    "ball, damped": Case(lambda: ball_on(roller(), law=DAMPED), 2e-6),
    "ball, friction": Case(lambda: ball_on(rubbing(), friction=0.2), 2e-6),
    "ball, impulsive": Case(lambda: ball_on(dynamic_roller()), 2e-6, {"local_modes": "hht"}),
    "ball, impulsive and exact": Case(lambda: ball_on(dynamic_roller()), 2e-6, {"local_modes": "exponential"}),
    "ball at the edge of a roller": Case(lambda: ball_on(rubbing(), at=(0.0, 0.0101, RADIUS), friction=0.2), 2e-6),
    "ball at the corner of a block": Case(
        lambda: ball_on(block(), "z_min", "z_max", at=(0.0098, 0.0098, 0.005), friction=0.2), 2e-6
    ),
    "roller in a ring": Case(roller_in_ring),
    "roller in a ring, friction": Case(lambda: roller_in_ring(friction=0.2, law=DAMPED), 5e-6),
    "journal": Case(journal, 1e-4, {"start": "equilibrium"}),
    "journal, piezoviscous": Case(
        lambda: journal(
            oil=oils.Roelands(0.01, coefficient=2e-8, density=oils.DowsonHigginson()),
            form_a=films.LobedForm(2e-6, 2), form_b=films.LobedForm(2e-6, 3),
        ),
        1e-4, {"start": "equilibrium"},
    ),
    "journal, rough": Case(
        lambda: journal(
            load=20e3,
            mixed=films.MixedLubrication(
                laws.ExponentialAsperities(2e9, 1e-6), boundary_friction=0.1, roughness_a=films.Roughness(1e-6, 3.0),
                roughness_b=films.Roughness(5e-7, 1 / 6),
            ),
        ),
        1e-4, {"start": "equilibrium"},
    ),
    "journal, both yield": Case(
        lambda: journal(
            yields=True, load=20e3, mixed=films.MixedLubrication(laws.ExponentialAsperities(2e9, 1e-6), 0.1)
        ),
        1e-4,
        {"start": "equilibrium"},
    ),
    "journal, warm": Case(
        lambda: journal(
            oil=oils.iso_vg(10, temperature=40.0, heat_capacity=2000.0),
            temperature=films.FilmTemperature(40.0, wall_a=45.0, carry_over=0.7),
        ),
        1e-4, {"start": "equilibrium"},
    ),
    "journal, profiles, both yield": Case(
        lambda: journal(yields=True, quadrature="reduced"), 1e-4, {"start": "equilibrium"}
    ),
    "journal, profiles": Case(lambda: journal(quadrature="reduced"), 1e-4, {"start": "equilibrium"}),
    "journal, other rules": Case(lambda: journal(cavitation="half_sommerfeld", load=50.0), 1e-4,
    {"start": "equilibrium"}),
    # runs that fail, each in another way
    "small sliding": Case(lapped, options=REST),
    "small sliding without friction": Case(lambda: lapped(0.0), options=REST),
    "small sliding in a body": Case(lambda: fork(0.2), options=REST),
    "small sliding, load steps": Case(lambda: lapped(push=400.0), how=load_steps),
    "small sliding, two worlds": Case(lapped, how=two_worlds),
    "too deep": Case(
        lambda: rollers(rubbing(), rubbing(), friction=0.3, load=suddenly(1e12)), options=HOPELESS, ends="capacity"
    ),
    "too deep elsewhere": Case(
        lambda: rollers(few_points(60), roller(), quadrature="reduced", load=suddenly(1e12)), options=HOPELESS,
        ends="capacity",
    ),
    "not finite": Case(
        lambda: rollers(rubbing(), rubbing(), friction=0.3, law=DAMPED, load=suddenly(1e200)), options=HOPELESS,
        ends="capacity",
    ),
    "too fast": Case(
        lambda: rollers(roller(), roller(), speed=1e8, ramp=1e-4), options=HOPELESS, ends="not_converged"
    ),
}  # fmt: skip
