"""The analytic Jacobian against differences of the residuals: joints, springs, loads, inertia terms, contact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jacobian import analytic, differences, worst_entry
from mass_point_body import mass_point_body

from references.monolithic.core.equations import predicted
from references.monolithic.core.integrator import Formula
from references.monolithic.line_of_centres.pair import LAWS
from references.monolithic.newton import evaluate
from references.monolithic.run import build
from scenes.rollers import guided_pair
from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.integrators import HHT
from warpffrf.model.scene import Scene

AGREE = 2e-6  # central differences: truncation and round-off meet at about 1e-7 of the largest entry of a row
STEP = 1e-2  # s: elastic, gyroscopic and inertia terms are all seen
AXES = rot.rotation_vector_matrix(np.array([0.3, -0.5, 0.2]))
PLACE = (0.1, 0.05, -0.02)


def shaken(scene: Scene, **options: Any) -> tuple[Any, ...]:
    """System and state of a scene with everything in motion, and increments away from those predicted."""
    system, state = build(scene, **options)
    rng = np.random.default_rng(4)
    for name, size in (("v", 0.3), ("w", 2.0), ("v_rate", 1.0), ("w_rate", 5.0), ("v_alg", 1.0), ("w_alg", 5.0)):
        value = getattr(state, name)
        value[:] = size * rng.normal(size=value.shape)
    n = system.layout.modes
    for name, size in (("q", 0.05), ("qd", 0.4), ("qdd", 5.0), ("q_alg", 5.0)):
        getattr(state, name)[:n] = size * rng.normal(size=n)
    state.lam[:] = 20.0 * rng.normal(size=len(state.lam))
    formula = Formula(HHT(-0.1).coefficients, STEP)
    x = predicted(state, formula)
    x.dx += 0.01 * rng.normal(size=x.dx.shape)
    x.psi += 0.2 * rng.normal(size=x.psi.shape)
    return system, state, formula, x


def check(scene: Scene, **options: Any) -> None:
    """Compare the two Jacobians of a scene in motion."""
    system, state, formula, x = shaken(scene, **options)
    sizes = np.full(system.layout.size, 1e-5)
    sizes[system.layout.coordinates :] = 1.0
    e = evaluate(system, state, formula, x, 0.3, [])
    reference, _ = differences(system, state, formula, x, 0.3, [], sizes)
    assert worst_entry(analytic(system, e), reference, sizes, e.residual, AGREE) < AGREE


def flexible_pair(level: str = "full", stiffening: bool = False) -> tuple[Scene, Any, Any]:
    """A flexible and a rigid body."""
    scene = Scene(gravity=(0.3, -0.5, -9.81))
    a = scene.add_body(
        mass_point_body(4, stiffening=stiffening), name="a", inertia=level, stiffening=stiffening, damping=0.03,
        rotation=rot.quaternion(AXES),
    )  # fmt: skip
    b = scene.add_rigid_body(1.5, (0.02, 0.03, 0.04), name="b", center_of_mass=(0.05, -0.02, 0.01), position=PLACE)
    return scene, a, b


@pytest.mark.parametrize("level", ["constant", "deformed", "gyroscopic", "full"])
@pytest.mark.parametrize("stiffening", [False, True])
def test_inertia_terms(level: str, stiffening: bool) -> None:
    scene, a, _ = flexible_pair(level, stiffening)
    scene.add(joints.Spherical(scene.ground, a["left"], name="pin"))
    check(scene)


@pytest.mark.parametrize("kind", list(joints.JOINT_KINDS))
def test_joints_on_a_flexible_interface(kind: str) -> None:
    scene, a, b = flexible_pair("constant")
    across = (0.0, 0.6, 0.8)
    more = {"universal": {"second_axis": across}, "line_in_plane": {"line": across}}.get(kind, {})
    if kind not in ("spherical", "distance"):
        more["axis"] = (1.0, 0.0, 0.0)
    place = a["right"].world_point() + (np.array([0.1, 0.2, 0.1]) if kind == "distance" else 0.0)
    joint = scene.add(joints.JOINT_KINDS[kind](a["right"], b.at(b.to_user(place)), name="j", **more))
    if "rotation" in joint.coordinates:
        turn = signals.Ramp(0.0, 2.0, duration=1.0)
        scene.add(joints.Drive(joint, turn, quantity="velocity", coordinate="rotation"))
    check(scene)


def springs(scene: Scene, a: Any, b: Any) -> dict[str, Any]:
    """One of every spring, between an interface of a and the body b."""
    place = a["right"].world_point()
    port = b.at(b.to_user(place))
    rng = np.random.default_rng(11)
    K, D = (s * (lambda A: A @ A.T)(rng.normal(size=(6, 6))) for s in (300.0, 3.0))
    rubber = forces.ForceTable([(-1.0, -500.0), (0.0, 0.0), (1.0, 900.0)], smooth=True)

    def hinge(kind: str) -> Any:
        return scene.add(joints.JOINT_KINDS[kind](a["right"], port, axis=(0, 1, 0), name="h"))

    return {
        "spring_damper": lambda: forces.SpringDamper(a["left"], b.at((0.1, 0, 0)), 300.0, 2.0),
        "joint_spring_damper": lambda: forces.JointSpringDamper(
            hinge("cylindrical"), 200.0, 3.0, coordinate="translation", reference=0.01, preload=-2.0
        ),
        "torsional_spring_damper": lambda: forces.TorsionalSpringDamper(hinge("revolute"), 20.0, 0.3, reference=0.2),
        "bushing": lambda: forces.Bushing(a["right"], port, K, D, axes=AXES, preload=np.arange(6.0)),
        "bearing": lambda: forces.BearingSpring(
            a["right"], port, axis=(0, 1, 0), radial=500.0, axial=200.0, tilt=30.0, radial_tilt=50.0,
            radial_damping=2.0, axial_damping=1.0, tilt_damping=0.2, spin_damping=0.1, cross=40.0,
        ),
        "characteristics": lambda: forces.SpringDamper(
            a["left"], b.at((0.1, 0, 0)), forces.ForcePolynomial([300.0, 40.0, 9e3]), forces.PowerLaw(2.0, 1.7),
            free_length=0.3,
        ),
        "bushing with characteristics": lambda: forces.Bushing(
            a["right"], port, [rubber] * 3 + [9.0] * 3, [1.0, forces.PowerLaw(3.0, 2.0), 1.0, 0.2,
            forces.ForcePolynomial([0.1, 0.0, 0.2]), 0.2], axes=AXES,
        ),
        "point_force": lambda: forces.PointForce(a["right"], (3.0, -2.0, 5.0)),
        "point_force in the body": lambda: forces.PointForce(a["right"], (3.0, -2.0, 5.0), frame="body"),
        "point_torque": lambda: forces.PointTorque(a["left"], (0.3, -2.0, 0.5)),
    }  # fmt: skip


@pytest.mark.parametrize("name", list(springs(*flexible_pair())))
@pytest.mark.parametrize("stiffening", [False, True])
def test_force_elements(name: str, stiffening: bool) -> None:
    scene, a, b = flexible_pair("constant", stiffening)
    scene.add(springs(scene, a, b)[name]())
    check(scene)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("swapped", [False, True])
def test_contact_of_tilted_and_crowned_rollers(law: str, swapped: bool, roller, other_roller) -> None:
    """Gaps and forces with the turn of the grids, tilted pair, at pressures that are given (nodes) or follow
    (nodes)."""
    pair = (other_roller, roller) if swapped else (roller, other_roller)
    scene = guided_pair(*pair)
    for body in scene.bodies:
        body.level = "constant"
    upper = scene.body("upper")
    upper.rotation = np.array([np.sin(2e-3), 0.0, 0.0, np.cos(2e-3)])
    upper.position = upper.position - np.array([1e-3, 0.0, 2e-4])
    scene.joints.clear()
    scene.forces.clear()
    system, state = build(scene, law=law, layer_stiffness=1e13 if law == "nodes" else None)
    few = 6 * len(scene.bodies) + 30  # columns of the rigid coordinates, the modes and some local coordinates
    formula, rng = Formula(HHT(-0.3).coefficients, 1e-4), np.random.default_rng(3)
    state.q[: system.layout.modes] = 1e-6 * rng.normal(size=system.layout.modes)
    state.q[system.layout.modes :] = 1e-5 * rng.normal(size=system.layout.flexible - system.layout.modes)
    x = predicted(state, formula)
    e = evaluate(system, state, formula, x, 1e-4, [{}])
    closed = np.flatnonzero((e.pairs[0].gap < 0.0) & (e.pairs[0].area > 0.0))
    assert len(closed) >= 4
    carried = [{int(e.pairs[0].number[i]): float(rng.uniform(1e7, 1e9)) for i in closed}]
    e = evaluate(system, state, formula, x, 1e-4, carried)
    sizes = np.full(system.layout.size, 1e-9)
    reference, slopes = differences(system, state, formula, x, 1e-4, carried, sizes, few)
    K = analytic(system, e)[:, :few]
    assert worst_entry(K, reference, sizes[:few], e.residual, AGREE) < AGREE
    gradient, _ = e.pairs[0].rows(closed)
    exact = np.zeros((len(closed), system.layout.size))
    exact[:, system.pairs[0].columns] = gradient
    gaps = e.pairs[0].area[closed] if law == "hats" else np.ones(len(closed))  # per unit area of the test
    off = np.abs(exact[:, :few] - slopes[0][closed]) / gaps[:, None]
    assert off.max() < 1e-6  # differences of 0.1 m by 1e-9 m carry 1e-8 of round-off
