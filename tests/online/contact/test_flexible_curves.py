"""Flexible bodies with extruded faces: a circle is a cylinder, arcs carry Hertz's pressure, teeth transmit torques."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes import curved_blocks as blocks
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.surfaces import Curve, Cylinder, Extruded, Plane
from warpffrf.offline import ContactGrid, reduce

RADIUS, LOAD, SPEED = 0.05, 20e3, 5.0  # m, N, rad/s
CIRCLE = Curve.arcs((RADIUS, 0.0), 0.5 * np.pi, [(2.0 * np.pi * RADIUS, RADIUS)], closed=True)
OPEN = Curve.arcs((0.0, RADIUS), np.pi, [(np.pi * RADIUS, RADIUS)])  # the half with x < 0
AXIS: dict[str, Any] = {"axis_point": (0.0, 0.0, 0.0), "axis_direction": (0.0, 1.0, 0.0)}
# Cubic pieces of 0.02 rad are off a circle by 4e-10 R, 2e-11 m of an approach of 1e-5 m, and bent by 3e-5 more or
# less where they join; pressures follow the root of the curvature, and the patch covers half a piece.
AS_ROUND = 1e-5


@cache
def round_body(kind: str, part: str) -> wf.ReducedBody:
    """A hollow roller whose rim, or half of it, is a cylinder, or a curve."""
    mesh = roller(RADIUS, 0.015, 0.02, sectors=24, layers=3, axial=2, order=2)
    mesh = mesh.select("face", "rim", lambda p: p[:, 0] < (1e-9 if part == "half" else np.inf))
    curve = Extruded(curve=CIRCLE if part == "whole" else OPEN, **AXIS)
    return reduce(
        mesh, blocks.STEEL, interfaces={"bore": "rigid"}, modes=4,
        contact={"face": Cylinder(radius=RADIUS, **AXIS) if kind == "cylinder" else curve},
        grid=ContactGrid(contact_fixed=True, tangential=True),
        options=wf.ReductionOptions(periodic=False), progress=False,
    )  # fmt: skip


def rolled(kind: str, part: str, other: str, friction: float) -> wf.Result:
    """A roller pressed on a plane, or on another one, and rolled: closed curves over their ends."""
    seam = -0.02 if other == "plane" else 0.02  # rad, in front of the patch
    body, turned = round_body(kind, part), 0.5 * np.pi + seam if part == "whole" else -0.5 * np.pi
    scene, top = wf.Scene(gravity=(0, 0, 0)), (0.0, 0.0, RADIUS + (0.0 if other == "plane" else RADIUS))
    upper = scene.add_body(body, name="upper", position=top, rotation={"axis": (0, 1, 0), "angle": turned})
    carriage = scene.add_rigid_body(1.0, (1e-3,) * 3, name="carriage", position=top)
    scene.add(wf.joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=(0, 0, 1)))
    axle = scene.add(wf.joints.Revolute(carriage.at((0, 0, 0)), upper["bore"], axis=(0, 1, 0)))
    if other == "plane":
        face = scene.ground.surface(Plane(origin=(0, 0, 0), outward=(0, 0, 1), direction=(0, 1, 0)), name="face")
    else:
        lower = scene.add_body(body, name="lower", rotation={"axis": (0, 1, 0), "angle": -turned})
        axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0)))
        face = lower["face"]
    scene.add(wf.joints.Drive(axle, wf.signals.SmoothStep(0.0, SPEED, duration=5e-3), quantity="velocity"))
    scene.add(wf.forces.PointForce(carriage.at((0, 0, 0)), (0.0, 0.0, -LOAD)))
    scene.add(wf.Contact(upper["face"], face, friction=friction, grid="contact_fixed", name="pair"))
    result = wf.simulate(scene, 0.012, step=2e-4, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    return result


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize(("part", "other"), [("whole", "plane"), ("whole", "roller"), ("half", "roller")])
def test_a_circle_is_a_cylinder(part: str, other: str, friction: float) -> None:
    """Forces, positions, rotations and pressures in equilibrium, and rolling, are those of a cylinder."""
    found, known = rolled("curve", part, other, friction), rolled("cylinder", part, other, friction)
    pair, same = found.contact("pair"), known.contact("pair")
    assert np.abs(pair.force - same.force).max() < AS_ROUND * LOAD
    assert np.abs(pair.peak_pressure / same.peak_pressure - 1.0).max() < AS_ROUND
    assert np.abs(found.body("upper").position - known.body("upper").position).max() < 1e-3 * AS_ROUND * RADIUS
    assert np.abs(found.body("upper").angular_velocity - known.body("upper").angular_velocity).max() < AS_ROUND * SPEED
    if friction:
        assert np.abs(same.force[:, 0]).max() > (0.1 if other == "plane" else 1e-4) * LOAD
        assert np.abs(pair.friction.tangential_force - same.friction.tangential_force).max() < AS_ROUND * LOAD
    if part == "whole" and friction:  # the patch passes the end of the closed curve
        columns = pair.history.cells.column
        assert columns.min() < -0.1 and columns.max() > 0.05


@cache
def block(radius: float) -> wf.ReducedBody:
    return blocks.block(blocks.arc(radius))


@pytest.mark.parametrize("radii", [(15e-3, 20e-3), (15e-3, -40e-3), (-40e-3, 15e-3)])
def test_arcs_on_arcs(radii: tuple[float, float]) -> None:
    """Convex on convex, on hollow, and as first surface: Hertz's line contact at mid-width."""
    scene = blocks.pressed(block(radii[0]), block(radii[1]), 3e3, grid="contact_fixed")
    pair = wf.simulate(scene, 1e-4, step=1e-4, start="equilibrium", progress=False).contact("pair")
    relative = sum(1.0 / radius for radius in radii)
    line, modulus = float(pair.line_load[0]), 0.5 * 210e9 / (1.0 - 0.3**2)
    half_width = np.sqrt(4.0 * line / (np.pi * modulus * relative))
    assert pair.half_width[0] == pytest.approx(half_width, rel=2e-3)
    assert pair.mid_peak_pressure[0] == pytest.approx(2.0 * line / (np.pi * half_width), rel=2e-3)
    assert pair.force[0] == pytest.approx([0.0, -3e3, 0.0], abs=3e-3)


@cache
def tooth(number: int, tangential: bool) -> wf.ReducedBody:
    return blocks.tooth(number, tangential=tangential)


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_teeth(friction: float) -> None:
    """Involutes roll and slide on each other: the force lies on the line of action, torques are in the ratio of the
    base circles, friction has its lever, and energies balance."""
    torque, speed = 60.0, 5.0
    one, two = (tooth(i, friction > 0.0) for i in (0, 1))
    scene = blocks.teeth(one, two, torque, speed, friction=friction, grid="contact_fixed")
    result = wf.simulate(scene, 4e-3, step=4e-5, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    pair, b = result.contact("pair"), blocks.BASES
    action = np.array([-np.sin(blocks.ANGLE), np.cos(blocks.ANGLE), 0.0])
    assert np.abs(result.energy_residual).max() < 1e-6 * result.energy_scale
    angle = one.contact_surfaces["face"].shape
    held, force = result.joint("axle_first"), np.linalg.norm(pair.force, axis=1)
    assert held.force[:, :2] == pytest.approx(-pair.force[:, :2], abs=1e-4 * force.max())  # action is reaction
    # moments of the force in the centre of pressure about both axles
    moments = []
    for i in range(len(result.time)):
        motion, (theta, z) = result.body("first"), pair.patch_center[i] + (pair.moments.center[i, 0], 0.0)
        place = motion.position[i] + rot.matrix(motion.rotation[i]) @ np.ravel(angle.point(theta, z))
        arms = (place, place - [sum(b) / np.cos(blocks.ANGLE), 0.0, 0.0])
        moments.append([np.cross(arm, pair.force[i])[2] for arm in arms])
    about = np.array(moments)
    assert about[:, 0] == pytest.approx(-held.torque[:, 2], rel=1e-4)
    assert about[:, 1] == pytest.approx(-torque, rel=2e-3)  # and the inertia of the hub
    if friction:
        across = np.abs(pair.force @ [np.cos(blocks.ANGLE), np.sin(blocks.ANGLE), 0.0])[-20:]
        assert across == pytest.approx(friction * (pair.force @ action)[-20:], rel=1e-3)
        assert np.all(pair.friction.power[-20:] > 0.0)
    else:
        assert force == pytest.approx(torque / b[1], rel=2e-4)
        assert pair.force @ action == pytest.approx(force, rel=1e-8)  # cosine of the tilt of the teeth, 3e-5 rad
        assert -held.torque[:, 2] == pytest.approx(force * b[0], rel=1e-4)
    omega = result.body("hub_second").angular_velocity[:, 2]
    assert omega == pytest.approx(speed * b[0] / b[1], rel=2e-3)


def test_two_flanks_of_two_bodies() -> None:
    """Two contacts between the same two bodies, on different surfaces of each, share the load equally."""
    body = blocks.twin(15e-3)
    scene = blocks.pressed(body, body, 6e3, faces=(("left", "right"), ("right", "left")), grid="contact_fixed")
    result = wf.simulate(scene, 1e-4, step=1e-4, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    alone = wf.simulate(
        blocks.pressed(block(15e-3), block(15e-3), 3e3, grid="contact_fixed"),
        1e-4, step=1e-4, start="equilibrium", progress=False,
    )  # fmt: skip
    for name in ("pair", "pair_2"):
        pair = result.contact(name)
        assert pair.force[0] == pytest.approx([0.0, -3e3, 0.0], abs=0.3)
        hertz = pair.hertz(0)
        assert pair.mid_peak_pressure[0] == pytest.approx(hertz.peak_pressure, rel=5e-3)
        assert pair.mid_peak_pressure[0] == pytest.approx(alone.contact("pair").mid_peak_pressure[0], rel=2e-2)


def test_a_curve_ends_with_its_grid() -> None:
    """A block next to another, below the tangent in which its curve ends, does not touch it."""
    body, scene = block(15e-3), wf.Scene(gravity=(0, 0, 0))
    turned = {"axis": (0, 0, 1), "angle": np.pi}
    one = scene.add_body(body, name="one", position=(14e-3, -4e-3, 0.0), rotation=turned)
    other = scene.add_body(body, name="other")
    for held in (one, other):
        scene.add(wf.joints.Fixed(scene.ground, held["back"]))
    scene.add(wf.Contact(one["face"], other["face"], grid="contact_fixed", name="pair"))
    result = wf.simulate(scene, 1e-5, step=1e-5, progress=False)
    pair = result.contact("pair")
    end = 14e-3 - 0.5 * blocks.LENGTH - 0.5 * blocks.LENGTH  # from end to end along x
    assert np.all(pair.force == 0.0)
    assert np.all(pair.approach < -0.8 * end)


def test_what_is_refused() -> None:
    mesh, curve = blocks.mesh_below(blocks.arc(15e-3), counts=(6, 2, 2)), blocks.arc(15e-3)
    cases = {
        "largest distance of a node": blocks.arc(15.1e-3),
        "beyond the ends of the curve": blocks.arc(15e-3, 9e-3),
        "to the left of the curve": Curve(knots=curve.knots, points=curve.points[::-1], tangents=-curve.tangents[::-1]),
    }
    for message, wrong in cases.items():
        with pytest.raises(InputError, match=message):
            reduce(mesh, blocks.STEEL, contact={"face": blocks.extruded(wrong)}, progress=False)
    with pytest.raises(InputError, match="curve must be given"):
        reduce(mesh, blocks.STEEL, contact={"face": Extruded(axis_direction=(0, 0, 1))}, progress=False)
    kinks = Mesh(mesh.points, mesh.cells, {"face": mesh.outer_facets()})  # at the edges of the block
    with pytest.raises(InputError, match="largest distance of a node"):
        reduce(kinks, blocks.STEEL, contact={"face": blocks.extruded(curve)}, progress=False)
    scene, body = wf.Scene(), block(15e-3)
    lower, upper = (scene.add_body(body, name=name) for name in ("lower", "upper"))
    with pytest.raises(InputError, match="is of kind extruded; films are between planes"):
        scene.add(wf.Film(lower["face"], upper["face"], oil=wf.oils.Newtonian(viscosity=0.02)))
