"""Rings with interference fits by small-sliding contact: on a shaft, in a bearing, in a housing under a load that
rotates. The axis is y."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from warpffrf.model import forces, joints, laws, signals, surfaces
from warpffrf.model.bearings import RollerGeometry, RollingContact
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, roller, sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding import SmallSliding
from warpffrf.offline import reduce
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, static

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7850.0)
LIGHT = Material(70e9, 0.33, 2700.0)
SEAT, WEIGHTLESS = "seat", (0.0, 0.0, 0.0)

# --- a ring on a hollow shaft

RING = RollerGeometry(elements=6, roller_diameter=0.01, roller_length=0.012, pitch_diameter=0.07, bore=0.05)
SHAFT_BORE, WIDTH = 0.02, 0.012  # m
SECTORS = 24  # cells around


def patches(mesh: Mesh, face: str, count: int) -> Mesh:
    """The mesh with so many equal parts of a round face around the axis as the facet sets `part 0` and so on, the first
    in the middle about +x, the others towards +z."""
    width = 2.0 * np.pi / count
    for k in range(count):
        middle = k * width
        mesh = mesh.select(f"part {k}", face, lambda x, a=middle: np.abs(angle_from(x, a)) < 0.5 * width)
    return mesh


def angle_from(x: Array, a: float) -> Array:
    """Angles [rad] of points (n, 3) about y from the angle `a` from +x towards +z, between -pi and pi."""
    return (np.arctan2(x[:, 2], x[:, 0]) - a + np.pi) % (2.0 * np.pi) - np.pi


@cache
def hollow_shaft(material: Material, sectors: int = SECTORS) -> ReducedBody:
    """Held in the mean of its bore."""
    mesh = roller(0.5 * 0.05, 0.5 * SHAFT_BORE, WIDTH, sectors=sectors, layers=3, axial=1)
    return reduce(
        mesh, material, interfaces={"bore": "average"}, contact={SEAT: surfaces.Matched(first="rim")}, modes=4,
        cache=False, progress=False,
    )  # fmt: skip


@cache
def plain_ring() -> ReducedBody:
    """Held in the mean of its outside."""
    mesh = sleeve(0.025, RING.bottom("inner"), WIDTH, sectors=SECTORS, axial=1, layers=2)
    return reduce(
        mesh, STEEL, interfaces={"outside": "average"}, contact={SEAT: surfaces.Matched(first="bore")}, modes=4,
        cache=False, progress=False,
    )  # fmt: skip


def ring_on_shaft(interference: float, shaft: Material) -> Result:
    """The assembled fit, frictionless; interference [m] of the diameters."""
    scene = Scene(gravity=WEIGHTLESS)
    inner, ring = scene.add_body(hollow_shaft(shaft), name="shaft"), scene.add_body(plain_ring(), name="ring")
    scene.add(joints.Fixed(scene.ground, inner["bore"], name="held"))
    scene.add(joints.Fixed(scene.ground, ring["outside"], name="kept"))
    pressed = SmallSliding(interference=0.5 * interference)
    scene.add(Contact(inner[SEAT], ring[SEAT], sliding=pressed, name=SEAT))
    return done(equilibrium(scene, progress=False))


def done(result: Result) -> Result:
    """A result that is complete."""
    if result.status != "completed":
        raise RuntimeError(result.message)
    return result


def raceway_change(result: Result, radius: float) -> tuple[float, float]:
    """Smallest and largest change [m] of the diameter of the ring's surface of a radius [m]."""
    skin = result.skins()["ring"]
    x, u = skin.points[:, ::2], skin.displacement(-1)[:, ::2]
    there = np.abs(np.linalg.norm(x, axis=1) / radius - 1.0) < 1e-6
    change = 2.0 * np.einsum("ni,ni->n", x[there], u[there]) / radius
    return float(change.min()), float(change.max())


# --- a bearing whose inner ring is pressed on a shaft


@cache
def ring_with_raceway() -> ReducedBody:
    """The raceway in parts that are interfaces, so that pressures of the seat move it, and the reverse."""
    mesh = patches(sleeve(0.025, RING.bottom("inner"), WIDTH, sectors=SECTORS, axial=1, layers=2), "outside", 12)
    return reduce(
        mesh, STEEL, interfaces={f"part {k}": "average" for k in range(12)},
        contact={SEAT: surfaces.Matched(first="bore"), "outside": surfaces.Cylinder()}, modes=4, cache=False,
        progress=False,
    )  # fmt: skip


def bearing_on_shaft(interference: float, clearance: float) -> Result:
    """Interference and diametral clearance before assembly [m]; the outer ring is rigid."""
    scene = Scene(gravity=WEIGHTLESS)
    ring, shaft = (
        scene.add_body(body, name=name)
        for body, name in ((ring_with_raceway(), "ring"), (hollow_shaft(STEEL), "shaft"))
    )
    # half of the clearance is that of the inner raceway, whose mesh has none
    geometry = RollerGeometry(
        elements=RING.elements, roller_diameter=RING.roller_diameter, roller_length=RING.roller_length,
        pitch_diameter=RING.pitch_diameter, clearance=2.0 * clearance,
    )  # fmt: skip
    scene.add_bearing(
        "bearing", geometry, first=(1, 0, 0), inner=ring["outside"], outer=scene.ground, materials=STEEL,
        contact=RollingContact(law=laws.PalmgrenLine(RING.roller_length, 3)),
    )  # fmt: skip
    scene.add(joints.Planar(scene.ground.at((0, 0, 0)), shaft["bore"], axis=(0, 1, 0), name="plane"))
    pressed = SmallSliding(interference=0.5 * interference)
    scene.add(Contact(ring[SEAT], shaft[SEAT], sliding=pressed, friction=0.1, name=SEAT))
    return done(equilibrium(scene, progress=False))


# --- an outer ring in its housing under a load that rotates

PLANE = Material(210e9, 0.0, 7850.0)  # nothing moves along the axis
BORE, OUTSIDE, HOUSING, LONG = 0.080, 0.090, 0.140, 0.008  # m
PARTS, CELLS = 24, 48  # around: parts of the bore that the load passes, cells of the seat
TIGHT, ROUGH = 1e-5, 0.3  # m, of the diameters; coefficient of friction


@cache
def creeping_bodies() -> tuple[ReducedBody, ReducedBody]:
    """The ring, whose bore is loaded in parts, and the housing, held at its outside."""
    mesh = patches(sleeve(0.5 * BORE, 0.5 * OUTSIDE, LONG, sectors=CELLS, axial=1, layers=2), "bore", PARTS)
    ring = reduce(
        mesh, PLANE, interfaces={f"part {k}": "average" for k in range(PARTS)},
        contact={SEAT: surfaces.Matched(first="outside")}, modes=6, cache=False, progress=False,
    )  # fmt: skip
    housing = reduce(
        sleeve(0.5 * OUTSIDE, 0.5 * HOUSING, LONG, sectors=CELLS, axial=1, layers=4), PLANE,
        interfaces={"outside": "average"}, contact={SEAT: surfaces.Matched(first="bore")}, modes=6, cache=False,
        progress=False,
    )  # fmt: skip
    return ring, housing


def rotating_load(load: float, friction: float, revolutions: int) -> Result:
    """Load steps: assembled, loaded, and two per part of the bore while the load [N] rotates from +x towards +z,
    outwards, divided between the two nearest parts."""
    scene = Scene(gravity=WEIGHTLESS)
    ring, housing = (
        scene.add_body(body, name=name) for body, name in zip(creeping_bodies(), ("ring", "housing"), strict=True)
    )
    scene.add(joints.Fixed(scene.ground, housing["outside"], name="held"))
    angle = np.concatenate([[0.0], np.arange(2 * PARTS * revolutions + 1) * np.pi / PARTS])
    width, time = 2.0 * np.pi / PARTS, np.arange(len(angle), dtype=float)
    for k in range(PARTS):
        away = np.abs((angle - k * width + np.pi) % (2.0 * np.pi) - np.pi) / width
        share = load * np.maximum(1.0 - away, 0.0)
        share[0] = 0.0
        outwards = (np.cos(k * width), 0.0, np.sin(k * width))
        scene.add(forces.PointForce(ring[f"part {k}"], (signals.Table(time, share), outwards), name=f"load {k}"))
    pressed = SmallSliding(interference=0.5 * TIGHT)
    scene.add(Contact(ring[SEAT], housing[SEAT], sliding=pressed, friction=friction, name=SEAT))
    return done(static(scene, time[-1], step=1.0, progress=False))


def creep(result: Result) -> Array:
    """Displacement (revolutions,) [m] of the ring along its seat in each, positive along with the load."""
    about_y = 2.0 * result.body("ring").rotation[1 :: 2 * PARTS, 1]  # rad
    return -0.5 * OUTSIDE * np.diff(about_y)


@dataclass(frozen=True)
class Limits:
    """Loads [N]: `slip` at which the first cell slips, `shakedown` beyond which slip goes on for ever."""

    slip: float
    shakedown: float


@cache
def limits() -> Limits:
    """From the tractions of a seat that sticks, p_0 + F p and F t of a cell c at the angle phi of the load.

    By Melan's theorem for friction (A. Klarbring, M. Ciavarella, J. R. Barber, Int. J. Solids Struct. 44 (2007) 8355;
    N. Antoni, Q. S. Nguyen, Vietnam J. Mech. 30 (2008) 195) slip ceases if residual tractions r_c without a resultant
    satisfy |F t + r_c| <= mu (p_0 + F p) at all phi; it holds where slip hardly changes the pressure.
    """
    load = 1000.0
    seat = rotating_load(load, 2.0, 1).contact(SEAT)
    assert np.all(seat.state[1:] == 1)  # sticks
    around = np.einsum("ckx,cx->ck", seat.frames[:, 1:], np.cross((0.0, 1.0, 0.0), seat.frames[:, 0]))
    t = np.einsum("tck,ck->tc", seat.traction, around)
    p, t = (seat.pressure - seat.pressure[0]) / load, (t - t[0]) / load
    bound = ROUGH * seat.pressure[0]
    above, below = (np.min(ROUGH * p - sign * t, axis=0) for sign in (1.0, -1.0))  # r_c < bound + F above, and so on
    shakedown = float(np.min(-2.0 * bound / (above + below)))
    upper, lower = bound + shakedown * above, -bound - shakedown * below
    assert seat.area @ lower <= 0.0 <= seat.area @ upper  # some have no resultant
    return Limits(float(np.min(-bound / np.minimum(above, below))), shakedown)
