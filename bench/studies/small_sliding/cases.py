"""Small-sliding contacts of the engine against closed forms, at rest: leaves, a bar, a bolt, a press fit, a press.

Part of `studies.small_sliding.acceptance`; `references.closed_forms.joints` derives the closed forms. Poisson's
ratio is zero, so that bodies of brick cells are beams, bars and plane stress; what they still are besides (shear of a
beam, shear at the end of a slip zone) is within the figures. Pressures are uniform where the closed form has them so,
by a force on an averaging interface, which is the same over all of its face, or by interference between rigid faces.
"""

from __future__ import annotations

import time
from dataclasses import replace
from functools import cache

import numpy as np

from references.closed_forms.joints import BarOnBase, BoltedJoint, PressFit, TwoLeaves
from studies.small_sliding.rows import Row, cycle, loads, static
from warpffrf.model import forces, joints, sensors, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import box, grid, roller, sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding import SmallSliding
from warpffrf.model.small_sliding.sliding import cells_of
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7800.0)
WEIGHTLESS = (0.0, 0.0, 0.0)

Array = np.ndarray


# --- two leaves

LEAVES = TwoLeaves(length=0.2, width=0.02, thickness=0.004, youngs_modulus=210e9, friction=0.3, pressure=1e5)


@cache
def leaf(counts: tuple[int, int], joint: str, back: str) -> ReducedBody:
    """A leaf in so many cells along and across, with a joint interface at the face `joint`, pressed at `back`."""
    return reduce(
        box((LEAVES.length, LEAVES.width, LEAVES.thickness), (*counts, 1), order=2),
        STEEL,
        interfaces=dict.fromkeys(("x_min", "x_max", back), "average"),
        contact={"face": Matched(first=joint)},
        modes=10,
        cache=False,
        progress=False,
    )


def two_leaves(counts: tuple[int, int], force: signals.Table) -> Scene:
    """The leaves clamped at x = -L/2, half of `force` [N] at the tip of each."""
    scene = Scene(gravity=WEIGHTLESS)
    half, press = 0.5 * LEAVES.thickness, LEAVES.pressure * LEAVES.length * LEAVES.width
    faces = {"lower": ("z_max", "z_min", -half, press), "upper": ("z_min", "z_max", half, -press)}
    share = signals.Table(force.times, 0.5 * np.asarray(force.values))
    bodies = []
    for name, (joint, back, z, normal) in faces.items():
        body = scene.add_body(leaf(counts, joint, back), name=name, position=(0.0, 0.0, z))
        scene.add(joints.Fixed(scene.ground, body["x_min"]))
        scene.add(forces.PointForce(body[back], (0.0, 0.0, normal)))
        scene.add(forces.PointForce(body["x_max"], (0.0, 0.0, share)))
        bodies.append(body)
    scene.add(Contact(bodies[0]["face"], bodies[1]["face"], sliding="small", friction=LEAVES.friction, name="joint"))
    scene.add(sensors.Position(bodies[1]["x_max"], name="tip"))
    return scene


def leaf_rows(counts: tuple[int, int] = (40, 1), steps: int = 20, times: float = 2.0) -> list[Row]:
    """A cycle between `times` the force of slip either way."""
    peak = times * LEAVES.slip_force
    path = cycle(steps)
    found = static(two_leaves(counts, loads(path, peak)), len(path) - 1)
    tip = found.sensor("tip").values[:, 2]
    tip = tip - tip[0]
    loss = found.contact("joint").loss
    stuck, slow = steps // int(2 * times), 3 * steps // 4
    slope, slips = tip[stuck] / (peak * path[stuck]), (tip[steps] - tip[slow]) / (peak * (1.0 - path[slow]))
    kink = (peak - tip[steps] / slips) * slips / (slips - slope)
    case, cells = "two leaves", f"{counts[0]} x {counts[1]}"
    at = [peak * path[stuck], peak]
    return [
        Row(case, cells, f"deflection, stuck, {at[0]:.3g} N", "m", float(LEAVES.loading(at[0])), tip[stuck], 5e-3),
        Row(case, cells, f"deflection, slipping, {at[1]:.3g} N", "m", float(LEAVES.loading(at[1])), tip[steps], 5e-3),
        Row(case, cells, "start of slip, where both lines meet", "N", LEAVES.slip_force, kink, 5e-3),
        Row(case, cells, "loss per cycle", "J", LEAVES.cycle_loss(peak), loss[-1] - loss[steps], 5e-3),
    ]


def many_steps_rows(counts: tuple[int, int] = (39, 3), steps: int = 100) -> list[Row]:
    """The wall time of five times `steps` load steps of a joint of 117 cells, the program compiled."""
    path = cycle(steps)
    peak = 2.0 * LEAVES.slip_force
    scene = two_leaves(counts, loads(path, peak))
    static(scene, 1)
    walls, busy = [], []
    for _ in range(3):
        begin, worked = time.perf_counter(), time.process_time()
        found = static(scene, len(path) - 1)
        walls.append(time.perf_counter() - begin)
        busy.append(time.process_time() - worked)
    loss = found.contact("joint").loss
    case, cells = f"two leaves, {len(path) - 1} load steps", f"{counts[0]} x {counts[1]}"
    return [
        Row(case, cells, "time of the processor", "s", 0.0, min(busy), 3.0, relative=False),
        Row(case, cells, "wall time", "s", 0.0, min(walls), 3.0, relative=False),
        Row(case, cells, "loss per cycle", "J", LEAVES.cycle_loss(peak), loss[-1] - loss[steps], 5e-3),
    ]


# --- a bar between rigid faces

HIGH, WIDE, LONG = 0.004, 0.02, 0.27  # m, of the bar
SQUEEZED = 1e-7  # m, by which either rigid face stands inside the bar
BAR_FRICTION = 0.05
PRESSED = STEEL.youngs_modulus * 2.0 * SQUEEZED / HIGH  # Pa
BAR = BarOnBase(
    stiffness=STEEL.youngs_modulus * HIGH * WIDE, length=LONG, resistance=2.0 * BAR_FRICTION * PRESSED * WIDE
)
SHALLOW, DEEP = 6.0 * HIGH, 60.0 * HIGH  # slip zones: a decade of forces


def graded(first: float, growth: float, largest: float) -> Array:
    """Places along the bar, cells that grow from the end that is pulled, at 0, inwards."""
    sizes = [first]
    while sum(sizes) < LONG:
        sizes.append(min(growth * sizes[-1], largest))
    places = np.concatenate([[0.0], np.cumsum(sizes)]) * LONG / sum(sizes)
    return -places[::-1]


@cache
def bar(first: float, growth: float, largest: float) -> ReducedBody:
    """The bar with joint interfaces at both faces."""
    y = 0.5 * WIDE * np.array([-1.0, 1.0])
    z = HIGH * np.array([-0.5, 0.0, 0.5])
    return reduce(
        grid(graded(first * HIGH, growth, largest * HIGH), y, z, order=2), STEEL, interfaces={"x_max": "average"},
        contact={"low": Matched(first="z_min"), "high": Matched(first="z_max")}, modes=10, cache=False, progress=False,
    )  # fmt: skip


def pulled(body: ReducedBody, force: signals.Table) -> Scene:
    """The bar between two rigid faces of the ground, pulled at its end."""
    scene = Scene(gravity=WEIGHTLESS)
    held = scene.add_body(body, name="bar", damping=0.0)
    for name, side in (("low", -1.0), ("high", 1.0)):
        face = surfaces.Plane(origin=(0, 0, 0.5 * side * HIGH), outward=(0, 0, -side), direction=(1, 0, 0))
        base = scene.ground.surface(face, name=name)
        scene.add(
            Contact(held[name], base, sliding=SmallSliding(interference=SQUEEZED), friction=BAR_FRICTION, name=name)
        )
    scene.add(forces.PointForce(held["x_max"], (force, 0.0, 0.0)))
    scene.add(sensors.Position(held["x_max"], name="end"))
    return scene


def micro_slip_rows(first: float = 0.25, growth: float = 1.07, largest: float = 1.5, points: int = 6) -> list[Row]:
    """Cycles of forces over a decade, and the exponent of loss against force."""
    body = bar(first, growth, largest)
    path = cycle(2)
    rows, lost = [], []
    depths = np.geomspace(SHALLOW, DEEP, points)
    case = "bar between rigid faces"
    for depth in depths:
        peak = BAR.resistance * depth
        found = static(pulled(body, loads(path, peak)), len(path) - 1)
        end = found.sensor("end").values[:, 0]
        loss = found.contact("low").loss + found.contact("high").loss
        lost.append(loss[-1] - loss[2])
        zone = found.contact("low").slip_zone(2.0, float(len(path) - 1))
        cells = f"{zone.cells} in the slip zone"
        named = f"{peak:.4g} N"
        if depth in depths[[0, -1]]:
            rows.append(
                Row(case, cells, f"displacement, {named}", "m", float(BAR.loading(peak)), end[2] - end[0], 0.02)
            )
        rows.append(Row(case, cells, f"loss per cycle, {named}", "J", BAR.cycle_loss(peak), lost[-1], 0.02))
    exponent = float(np.polyfit(np.log(depths), np.log(lost), 1)[0])
    cells = f"{body.matched['low'].cells} on a face"
    return [*rows, Row(case, cells, "exponent of loss over force", "", 3.0, exponent, 0.03, relative=False)]


# --- a bolted joint

BLOCK = (0.02, 0.02, 0.01)  # m, of one of the two clamped blocks
CLAMPED = STEEL.youngs_modulus * BLOCK[0] * BLOCK[1] / (2.0 * BLOCK[2])  # N/m
BOLT, TIGHTENED = 0.25 * CLAMPED, 1e4  # N/m, N: of the bolt before the blocks give way


@cache
def block(counts: tuple[int, int, int], joint: str, head: str) -> ReducedBody:
    """A block with a joint interface at the face `joint`, held over all of `head`."""
    return reduce(
        box(BLOCK, counts, order=1),
        STEEL,
        interfaces={head: "average"},
        contact={"face": Matched(first=joint)},
        modes=6,
        cache=False,
        progress=False,
    )


def bolted(counts: tuple[int, int, int], force: signals.Table) -> Scene:
    """Two blocks that a spring draws together; `force` [N] parts them at their outer faces."""
    scene = Scene(gravity=WEIGHTLESS)
    half = 0.5 * BLOCK[2]
    low = scene.add_body(block(counts, "z_max", "z_min"), name="low", position=(0.0, 0.0, -half))
    high = scene.add_body(block(counts, "z_min", "z_max"), name="high", position=(0.0, 0.0, half))
    scene.add(joints.Fixed(scene.ground, low["z_min"]))
    bolt = scene.add(joints.Prismatic(low["z_min"], high["z_max"], axis=(0, 0, 1), point=(0.0, 0.0, 0.0), name="bolt"))
    scene.add(forces.JointSpringDamper(bolt, BOLT, preload=TIGHTENED, name="shank"))
    scene.add(Contact(high["face"], low["face"], sliding="small", friction=0.2, name="joint"))
    scene.add(forces.PointForce(high["z_max"], (0.0, 0.0, force)))
    scene.add(sensors.Position(high["z_max"], name="head"))
    return scene


def bolt_rows(counts: tuple[int, int, int] = (3, 3, 2), steps: int = 8) -> list[Row]:
    """Parted by up to half as much again as opens the joint."""
    preload = TIGHTENED * CLAMPED / (BOLT + CLAMPED)
    exact = BoltedJoint(bolt=BOLT, clamped=CLAMPED, preload=preload)
    path = np.linspace(0.0, 1.5, 3 * steps + 1)
    found = static(bolted(counts, loads(path, exact.opening_force)), len(path) - 1)
    clamp = found.contact("joint").normal_force
    head = found.sensor("head").values[:, 2]
    tension = TIGHTENED + BOLT * (head - 2.0 * 0.5 * BLOCK[2])
    half, last = exact.opening_force * path[steps], exact.opening_force * path[-1]
    fall = (clamp[0] - clamp[steps]) / half
    case, cells = "bolted joint", f"{counts[0]} x {counts[1]}"
    return [
        Row(case, cells, "preload, the spring and the blocks in line", "N", preload, clamp[0], 1e-3),
        Row(case, cells, f"clamp force, {half:.4g} N", "N", float(exact.clamp_force(half)), clamp[steps], 1e-3),
        Row(case, cells, f"bolt force, {half:.4g} N", "N", float(exact.bolt_force(half)), tension[steps], 1e-3),
        Row(case, cells, "force that opens it", "N", exact.opening_force, clamp[0] / fall, 1e-3),
        Row(case, cells, f"clamp force, {last:.4g} N", "N", 0.0, clamp[-1], 1e-9, relative=False),
        Row(case, cells, f"bolt force, {last:.4g} N", "N", float(exact.bolt_force(last)), tension[-1], 1e-3),
    ]


# --- a press fit

FIT = PressFit(radius=0.02, outer_radius=0.04, interference=1e-5, width=0.02, friction=0.15, shaft=STEEL)
TURNED = 1e-4  # rad, of the shaft's ends: about twice what slips


@cache
def shaft(sectors: int) -> ReducedBody:
    """A solid shaft rotated by its ends, which are round all over."""
    mesh = roller(FIT.radius, 0.0, FIT.width, sectors=sectors, layers=2, axial=1, order=2)
    return reduce(
        mesh,
        FIT.shaft,
        interfaces={"ends": "average"},
        contact={"seat": Matched(first="rim")},
        modes=8,
        cache=False,
        progress=False,
    )


@cache
def hub(sectors: int) -> ReducedBody:
    """A hub held in the mean of its outside."""
    mesh = sleeve(FIT.radius, FIT.outer_radius, FIT.width, sectors=sectors, axial=1, layers=3, order=2)
    return reduce(
        mesh,
        FIT.shaft,
        interfaces={"outside": "average"},
        contact={"seat": Matched(first="bore")},
        modes=8,
        cache=False,
        progress=False,
    )


def pressed_on(sectors: int, angle: signals.Table) -> Scene:
    """The shaft in the hub, its ends rotated by `angle` [rad] about y."""
    scene = Scene(gravity=WEIGHTLESS)
    inner, outer = scene.add_body(shaft(sectors), name="shaft"), scene.add_body(hub(sectors), name="hub")
    held = scene.add(joints.Fixed(scene.ground, outer["outside"], name="held"))
    turns = scene.add(joints.Revolute(scene.ground, inner["ends"], axis=(0, 1, 0), name="turns"))
    scene.add(joints.Drive(turns, angle, quantity="position"))
    scene.add(
        Contact(
            inner["seat"],
            outer["seat"],
            sliding=SmallSliding(interference=FIT.interference),
            friction=FIT.friction,
            name="seat",
        )
    )
    scene.add(sensors.JointReaction(held, name="torque"))
    return scene


def press_fit_rows(sectors: int = 32, steps: int = 8) -> list[Row]:
    """Pressure at rest, and the torque at which the shaft slips."""
    path = np.linspace(0.0, 1.0, steps + 1)
    found = static(pressed_on(sectors, loads(path, TURNED)), steps)
    lap = found.contact("seat")
    pressure = float(lap.pressure[0] @ lap.area / lap.area.sum())
    torque = abs(found.sensor("torque").values[:, 4])
    case, cells = "press fit", f"{lap.cells} on the seat"
    return [
        Row(case, cells, "pressure, mean", "Pa", FIT.pressure, pressure, 0.01),
        Row(case, cells, "pressure, largest", "Pa", FIT.pressure, float(lap.pressure[0].max()), 0.01),
        Row(case, cells, "torque that slips", "N m", FIT.slip_torque, torque[-1], 0.01),
    ]


# --- two blocks pressed together, without friction

LOAD = 1e4  # N


@cache
def half_block(counts: tuple[int, int, int], by: str, held: str, joint: str) -> ReducedBody:
    """A block of steel, held rigidly at one end, with a joint interface by nodes or facets at the other."""
    return reduce(
        box(BLOCK, counts, order=1), replace(STEEL, poisson_ratio=0.3), interfaces={held: "rigid"},
        contact={"face": Matched(first=joint, by=by)}, modes=6, cache=False, progress=False,
    )  # fmt: skip


def press_rows(counts: tuple[int, int, int] = (4, 4, 3)) -> list[Row]:
    """Between equal ends no shear crosses the middle: a joint interface without friction changes nothing."""
    size = (BLOCK[0], BLOCK[1], 2.0 * BLOCK[2])
    whole = reduce(
        box(size, (counts[0], counts[1], 2 * counts[2]), order=1), replace(STEEL, poisson_ratio=0.3),
        interfaces={"z_min": "rigid", "z_max": "rigid"}, modes=6, cache=False, progress=False,
    )  # fmt: skip
    scene = Scene(gravity=WEIGHTLESS)
    body = scene.add_body(whole, name="whole")
    scene.add(joints.Fixed(scene.ground, body["z_min"]))
    push = loads([LOAD, LOAD], -1.0)
    scene.add(forces.PointForce(body["z_max"], (0.0, 0.0, push)))
    scene.add(sensors.Position(body["z_max"], name="top"))
    exact = float(static(scene, 1).sensor("top").values[-1, 2]) - BLOCK[2]
    rows = []
    for by, target in (("nodes", 1e-6), ("facets", 5e-3)):
        scene = Scene(gravity=WEIGHTLESS)
        half = 0.5 * BLOCK[2]
        low = scene.add_body(half_block(counts, by, "z_min", "z_max"), name="low", position=(0.0, 0.0, -half))
        high = scene.add_body(half_block(counts, by, "z_max", "z_min"), name="high", position=(0.0, 0.0, half))
        scene.add(joints.Fixed(scene.ground, low["z_min"]))
        scene.add(joints.Prismatic(scene.ground, high["z_max"], axis=(0, 0, 1)))
        lap = scene.add(Contact(high["face"], low["face"], sliding="small", name="joint"))
        scene.add(forces.PointForce(high["z_max"], (0.0, 0.0, push)))
        scene.add(sensors.Position(high["z_max"], name="top"))
        found = static(scene, 1)
        top = float(found.sensor("top").values[-1, 2]) - BLOCK[2]
        cells = f"{len(cells_of(lap).cell)}, by {by}"
        rows.append(
            Row("press of two blocks, no friction", cells, "shortening, of one block's", "m", exact, top, target)
        )
    return rows
