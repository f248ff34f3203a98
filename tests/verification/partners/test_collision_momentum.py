"""Two free bodies of new shapes collide: a spinning ball strikes a block off its middle, with friction."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.flat_settings import reduce_flat
from warpffrf.model import rotation as rot
from warpffrf.model import surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import ball, block
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
RADIUS, SPEED, SPIN = 0.01, 0.5, 80.0  # m, m/s, rad/s
EXACT = 1e-10  # promised
SECOND_ORDER = 2e-6  # of the angular momentum: a step of 2 us turns and shifts bodies, second order in the step
QUARTER = (0.0, np.sin(0.25 * np.pi), 0.0, np.cos(0.25 * np.pi))  # turns +x to -z


@pytest.fixture(scope="module")
def bodies() -> tuple[ReducedBody, ReducedBody]:
    """Ball and block, coarse: momentum does not depend on the mesh."""
    small = ball(RADIUS, patch_half_width=1.6e-3, cell=0.8e-3, growth=2.0, order=1)
    large = block((0.03, 0.03, 0.015), patch_half_width=4e-3, cell=1e-3, growth=2.0, order=1)
    options = {"modes": 6, "tangential": True, "cache": False, "progress": False}
    return (
        reduce_flat(small, STEEL, contact={"patch": surfaces.Sphere()}, **options),
        reduce_flat(large, STEEL, contact={"patch": surfaces.Plane()}, **options),
    )


def collide(bodies: tuple[ReducedBody, ReducedBody], step: float, duration: float) -> Result:
    scene = Scene()
    place = (1.1e-3, 0.4e-3, RADIUS + 2e-7)
    striker = scene.add_body(
        bodies[0], name="ball", position=place, rotation=QUARTER, velocity=(0.05, 0.0, -SPEED),
        angular_velocity=(0.0, SPIN, 20.0),
    )  # fmt: skip
    struck = scene.add_body(bodies[1], name="block")
    scene.add(Contact(striker["patch"], struck["patch"], friction=0.3, name="pair"))
    result = simulate(scene, duration, step=step, progress=False)
    assert result.status == "completed", result.message
    return result


def momentum(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """P (T, 3) and L about the world's origin (T, 3), of the rigid motion: modes have neither (Tisserand)."""
    scene = result.history.scene
    P, L = 0.0, 0.0
    for body in scene.bodies:  # pyright: ignore[reportAttributeAccessIssue]
        motion = result.history.bodies[body.name]
        A = np.array([rot.matrix(q) for q in motion.rotation])
        arm = A @ body.center_of_mass
        v = motion.velocity + np.cross(motion.angular_velocity, arm)
        J = A @ body.inertia @ A.transpose(0, 2, 1)
        P = P + body.mass * v
        L = L + np.einsum("tij,tj->ti", J, motion.angular_velocity) + body.mass * np.cross(motion.position + arm, v)
    return np.asarray(P), np.asarray(L)


BOOKED = 1e-3  # of the kinetic energy: what patches of cells leave of a bounce, by how they are laid as they grow


def test_momentum_is_kept(bodies: tuple[ReducedBody, ReducedBody]) -> None:
    """Linear momentum to round-off, angular momentum but for the order of the integrator. The ledger books friction of
    grids bound to the material by its forces at the ends of the steps, of first order in the step, on patches by means
    over them."""
    drifts, rises = [], []
    for step in (2e-6, 1e-6):
        result = collide(bodies, step, 1.2e-4)
        c = result.history.contacts["pair"]
        size = np.linalg.norm(c.force, axis=1).max()
        assert size > 100.0
        assert np.linalg.norm(c.force[-1]) == 0.0
        assert np.abs(c.force + c.force_second).max() < EXACT * size
        P, L = momentum(result)
        assert np.abs(P - P[0]).max() < EXACT * bodies[0].mass * SPEED
        drifts.append(np.abs(L - L[0]).max() / np.linalg.norm(L[0]))
        ball_motion = result.history.bodies["ball"]
        assert ball_motion.velocity[-1, 2] > 0.0  # it has bounced
        assert abs(ball_motion.angular_velocity[-1, 1]) < SPIN * (1.0 - 1e-3)  # and friction has slowed its spin
        assert np.all(np.diff(result.energy["friction"]) <= 1e-15)
        ledger = result.energy["numerical"] + result.energy["contact_grid"]
        kinetic = 0.5 * bodies[0].mass * SPEED**2
        rises.append(np.max(ledger - np.minimum.accumulate(ledger)) / kinetic)
    print(f"angular momentum {drifts}, ledger {rises}")
    assert drifts[0] < SECOND_ORDER and drifts[1] < 0.3 * drifts[0]
    assert rises[0] < 0.05 and rises[1] < max(0.6 * rises[0], BOOKED)
