"""What every force element owes, over the registry: exact gradients, action equal to reaction, momentum, a closed
ledger of energy, and a description that distinguishes elements."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from warpffrf.model import forces, joints
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, run
from warpffrf.online.engine import Engine
from warpffrf.online.step.launches import blocks
from warpffrf_kernels.constraints import rows
from warpffrf_kernels.linear import geometric_stiffness

STEP = 1e-5  # of the central differences: truncation 1e-10, round-off 1e-11
RNG = np.random.default_rng(3)


def spd(size: float, rank: int = 6) -> np.ndarray:
    """A full positive (semi)definite 6 x 6 matrix of the given rank, translations weighed by `size`."""
    scale = np.array([size] * 3 + [0.1 * size] * 3) ** 0.5
    A = np.random.default_rng(11).normal(size=(6, rank))
    return scale[:, None] * (A @ A.T) * scale


def two_bodies(**motion: Any) -> tuple[Scene, Any, Any]:
    """Two free bodies with arms, rotated and moving, no ground and no gravity."""
    scene = Scene()
    a = scene.add_rigid_body(
        2.0, (0.1, 0.15, 0.2), name="a", center_of_mass=(0.05, 0.0, -0.02), rotation=quaternion(0.4)
    )
    b = scene.add_rigid_body(1.0, (0.05, 0.08, 0.06), name="b", position=(0.3, 0.1, 0.2), rotation=quaternion(-0.7))
    for body, seed in ((a, 1), (b, 2)):
        rng = np.random.default_rng(seed)
        body.velocity, body.angular_velocity = rng.normal(size=3), 2.0 * rng.normal(size=3)
    return scene, a, b


def quaternion(angle: float) -> np.ndarray:
    axis = np.array([1.0, 2.0, 3.0]) / 14.0**0.5
    return np.array([*(np.sin(0.5 * angle) * axis), np.cos(0.5 * angle)])


PLACE = (0.2, 0.05, 0.1)  # where both bodies of the scene meet


def ports(a: Any, b: Any) -> tuple[Any, Any]:
    return a.at(a.to_user(PLACE)), b.at(b.to_user(PLACE))


def revolute(scene: Scene, a: Any, b: Any) -> Any:
    return scene.add(joints.Revolute(*ports(a, b), axis=(0.0, 1.0, 1.0), name="hinge"))


def cylindrical(scene: Scene, a: Any, b: Any) -> Any:
    return scene.add(joints.Cylindrical(*ports(a, b), axis=(0.0, 1.0, 1.0), name="slide"))


AXES = rot.rotation_vector_matrix(np.array([0.3, -0.5, 0.2]))
SPRINGS = {
    "spring_damper": lambda s, a, b: forces.SpringDamper(a.at((0, 0.1, 0)), b.at((0.1, 0, 0)), 300.0, 2.0),
    "joint_spring_damper": lambda s, a, b: forces.JointSpringDamper(
        cylindrical(s, a, b), 200.0, 3.0, coordinate="translation", reference=0.01, preload=-2.0
    ),
    "torsional_spring_damper": lambda s, a, b: forces.TorsionalSpringDamper(
        revolute(s, a, b), 20.0, 0.3, reference=0.2
    ),
    "bushing": lambda s, a, b: forces.Bushing(*ports(a, b), spd(400.0), spd(4.0), axes=AXES, preload=np.arange(6.0)),
    "bushing of rank 3": lambda s, a, b: forces.Bushing(*ports(a, b), spd(400.0, 3), spd(4.0, 3), axes=AXES),
    "bearing_spring": lambda s, a, b: forces.BearingSpring(
        *ports(a, b), axis=(0, 1, 0), radial=500.0, axial=200.0, tilt=30.0, radial_tilt=50.0, radial_damping=2.0,
        axial_damping=1.0, tilt_damping=0.2, spin_damping=0.1, cross=40.0,
    ),
}  # fmt: skip

MOUNT = forces.ForceTable([(-0.2, -90.0), (-0.05, -15.0), (0.0, 0.0), (0.1, 25.0), (0.2, 80.0)], smooth=True)
CURVED = {
    "spring with characteristics": lambda s, a, b: forces.SpringDamper(
        a.at((0, 0.1, 0)), b.at((0.1, 0, 0)), forces.ForcePolynomial([300.0, 400.0, 9e3]), forces.PowerLaw(2.0, 1.5)
    ),
    "angle with characteristics": lambda s, a, b: forces.TorsionalSpringDamper(
        revolute(s, a, b), forces.PowerLaw(20.0, 1.5), forces.ForcePolynomial([0.3, 0.0, 0.02]), reference=0.2
    ),
    "bushing with characteristics": lambda s, a, b: forces.Bushing(
        *ports(a, b), [MOUNT, 300.0, forces.ForcePolynomial([300.0, 0.0, 3e4]), forces.PowerLaw(40.0, 1.2), 20.0, 20.0],
        [1.0, forces.PowerLaw(2.0, 2.0), 1.0, 0.2, 0.2, forces.PowerLaw(0.2, 1.5)], axes=AXES, preload=np.arange(6.0),
    ),
}  # fmt: skip
ALL = SPRINGS | CURVED


def test_every_spring_of_the_registry_is_here() -> None:
    springs = {kind for kind, element in forces.FORCES.items() if hasattr(element, "law")}
    assert springs == {name for name in SPRINGS if name in forces.FORCES}
    terms = ("law", "slip", "tension", "load")
    for element in forces.FORCES.values():
        have = {term for term in terms if hasattr(element, term)}
        assert len(have) == 1 or have == {"law", "tension"}  # a preload in time acts in addition to the law


def spring_scene(name: str) -> tuple[Scene, Any]:
    scene, a, b = two_bodies()
    return scene, scene.add(ALL[name](scene, a, b))


class Rows:
    """Values and gradients of a scene's spring rows at any pose, as the kernel evaluates them."""

    def __init__(self, scene: Scene) -> None:
        self.engine = Engine(scene)
        self.engine.control(run=1, moved=1)

    def __call__(self, r: np.ndarray, A: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Values (rows,), gradients (rows, 6 bodies) and wrenches (rows, 6)."""
        e = self.engine
        x, program = e.scratch, e.graph.program
        x.r1.assign(r[None])
        x.axes.assign(A[None])
        blocks(rows.evaluate_rows).go(program.arrays, program.sizes, program.device)
        return tuple(y.numpy()[0].copy() for y in (x.coordinate, x.C, x.row_wrench))


def moved_apart(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Poses of the centres of mass well away from the initial ones: 0.2 m and 0.6 rad."""
    rng = np.random.default_rng(5)
    r = [b.to_world(b.center_of_mass) + 0.1 * rng.normal(size=3) for b in scene.bodies]
    A = [rot.matrix(b.rotation) @ rot.rotation_vector_matrix(0.4 * rng.normal(size=3)) for b in scene.bodies]
    return np.array(r), np.array(A)


def moved(r: np.ndarray, A: np.ndarray, body: int, c: int, by: float) -> tuple[np.ndarray, np.ndarray]:
    """The poses with one body moved along (c < 3) or rotated about its own axis c - 3."""
    r, A, step = r.copy(), A.copy(), by * np.eye(3)[c % 3]
    if c < 3:
        r[body] += step
    else:
        A[body] = A[body] @ rot.rotation_vector_matrix(step)
    return r, A


@pytest.mark.parametrize("name", ALL)
def test_gradient_agrees_with_differences_and_action_with_reaction(name: str) -> None:
    scene, item = spring_scene(name)
    evaluate = Rows(scene)
    own = evaluate.engine.compiled.forces.rows[item.name]
    r, A = moved_apart(scene)
    _, C, wrench = evaluate(r, A)
    for body in range(2):
        for c in range(6):
            sides = []
            for sign in (1.0, -1.0):
                sides.append(evaluate(*moved(r, A, body, c, sign * STEP))[0])
            slope = (sides[0] - sides[1]) / (2.0 * STEP)
            assert C[own, 6 * body + c] == pytest.approx(slope[own], abs=1e-8 * max(1.0, np.abs(C[own]).max()))
    for row in own:
        f = C[row].reshape(2, 6)
        assert f[:, :3].sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-13 * np.abs(f).max())
        moment = sum(A[i] @ f[i, 3:] + np.cross(r[i], f[i, :3]) for i in range(2))
        assert moment == pytest.approx(np.zeros(3), abs=1e-13 * np.abs(f).max())
        assert f[1, :3] == pytest.approx(wrench[row, :3], abs=1e-14)


@pytest.mark.parametrize("name", ALL)
def test_geometric_stiffness_agrees_with_differences(name: str) -> None:
    """Rigid blocks of the retained matrix against differences of C^T lambda at fixed lambda, rows of joints included. A
    bushing's is of first order in its rotation, here 1e-3 rad."""
    scene, _ = spring_scene(name)
    evaluate = Rows(scene)
    x, s, m = evaluate.engine.scratch, evaluate.engine.state, evaluate.engine.compiled
    rng = np.random.default_rng(0)
    lam = rng.normal(size=(1, m.model.rows.count))
    s.lam.assign(lam)
    evaluate.engine.control(refresh=1)
    r = np.array([b.to_world(b.center_of_mass) for b in scene.bodies]) + 0.02 * rng.normal(size=(2, 3))
    turns = [rot.rotation_vector_matrix(1e-3 * rng.normal(size=3)) for _ in scene.bodies]
    A = np.array([rot.matrix(b.rotation) @ turn for b, turn in zip(scene.bodies, turns, strict=True)])
    expected = np.zeros((12, 12))
    for body in range(2):
        for c in range(6):
            sides = []
            for sign in (1.0, -1.0):
                r1, A1 = moved(r, A, body, c, sign * STEP)
                sides.append(lam[0] @ evaluate(r1, A1)[1])
            expected[:, 6 * body + c] = (sides[0] - sides[1]) / (2.0 * STEP)
    evaluate(r, A)
    x.tangent.zero_()
    program = evaluate.engine.graph.program
    blocks(geometric_stiffness.stiffen).go(program.arrays, program.sizes, program.device)
    found = x.tangent.numpy()[0][:12, :12]
    tolerance = 1e-3 if "bushing" in name else 1e-8
    assert np.abs(found - expected).max() < tolerance * np.abs(expected).max()


def balance_error(name: str, step: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Ledger residual over the energy at hand, and the linear and angular momentum over the run."""
    scene, item = spring_scene(name)
    history = run(scene, 0.4, step=step, integrator=GeneralizedAlpha(0.9), project_start=True, progress=False)
    assert history.status == "completed", history.message
    e = history.energy
    stored = e["kinetic"] + e["potential"]
    moved = np.abs(e["force_work"]).max() + e["damping"].max()
    P, L = np.zeros((len(history.time), 3)), np.zeros((len(history.time), 3))
    for body in scene.bodies:
        h = history.bodies[body.name]
        A = np.array([rot.matrix(q) for q in h.rotation])
        arm = A @ body.center_of_mass
        v = h.velocity + np.cross(h.angular_velocity, arm)
        spin = np.einsum("tij,jk,tlk,tl->ti", A, body.inertia, A, h.angular_velocity)
        P += body.mass * v
        L += body.mass * np.cross(h.position + arm, v) + spin
    assert np.all(np.diff(e["damping"]) >= -1e-15)
    return float(np.abs(e["numerical"]).max() / (np.abs(stored).max() + moved)), P, L


@pytest.mark.parametrize("name", ALL)
def test_ledger_closes_at_second_order_and_momentum_stays(name: str) -> None:
    (coarse, _, _), (fine, P, L) = (balance_error(name, h) for h in (4e-3, 2e-3))
    assert fine < 5e-3 and fine < coarse / 3.0, (coarse, fine)
    assert np.abs(P - P[0]).max() < 1e-9 * np.abs(P).max()  # sums of opposite forces: round-off and Newton tolerance
    assert np.abs(L - L[0]).max() < 5e-3 * np.abs(L).max()  # second order in the step


def test_elements_with_other_numbers_hash_differently() -> None:
    hashes = set()
    for factor in (1.0, 2.0):
        for name in SPRINGS:
            scene, item = spring_scene(name)
            for attribute in ("stiffness", "radial"):
                if hasattr(item, attribute):
                    setattr(item, attribute, factor * getattr(item, attribute))
            hashes.add(scene.content_hash())
    assert len(hashes) == 2 * len(SPRINGS)
