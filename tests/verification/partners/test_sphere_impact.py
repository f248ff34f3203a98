"""Case C7: a steel ball strikes a steel half-space."""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms import HertzImpact, contact_modulus
from warpffrf.model import surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import ball
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.output.simulate import simulate

RADIUS, SPEED = 0.01, 0.1  # m, m/s
# half the modulus on a rigid plane is E* of two steels
STEEL = Material(105e9, 0.3, 7800.0, name="steel and steel")
FORCE = DURATION = 0.02  # promised
GAP = 1e-8  # m
QUARTER = (0.0, np.sin(0.25 * np.pi), 0.0, np.cos(0.25 * np.pi))  # turns +x to -z


@pytest.fixture(scope="module")
def steel_ball() -> ReducedBody:
    """Some six nodes in the radius of the patch at the largest force, 193 um."""
    a = 193e-6
    mesh = ball(RADIUS, patch_half_width=1.25 * a, cell=a / 2.5, growth=1.6)
    return reduce(mesh, STEEL, contact={"patch": surfaces.Sphere()}, modes=0, progress=False)


@pytest.mark.slow
@pytest.mark.parametrize("share", [1.0 / 220.0, 1.0 / 55.0])
def test_ball_strikes_a_plane(steel_ball: ReducedBody, share: float) -> None:
    """`share` of the contact time in a step. Force, time, impulse, and no energy gained."""
    exact = HertzImpact(RADIUS, contact_modulus(STEEL), steel_ball.mass, SPEED)
    h = share * exact.duration
    scene = Scene()
    body = scene.add_body(
        steel_ball, name="ball", position=(0.0, 0.0, RADIUS + GAP), rotation=QUARTER, velocity=(0.0, 0.0, -SPEED)
    )
    floor = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0))
    scene.add(Contact(body["patch"], scene.ground.surface(floor, name="floor"), name="pair"))
    result = simulate(scene, np.ceil(1.2 / share) * h, step=h, progress=False)
    assert result.status == "completed", result.message
    F = result.history.contacts["pair"].force[:, 2]
    t = result.time
    # a closed form has v = SPEED at the touch; the force rises and falls as (time)^(3/2): both ends by extrapolation
    on = np.flatnonzero(F > 0.0)
    ends = [
        t[i] + (t[i] - t[j]) * root(F, i) / (root(F, j) - root(F, i))
        for i, j in ((on[0], on[1]), (on[-1], on[-2]))
    ]  # fmt: skip
    duration = ends[1] - ends[0]
    print(f"peak {F.max() / exact.force - 1.0:+.2%}, time {duration / exact.duration - 1.0:+.2%}")
    assert abs(F.max() / exact.force - 1.0) < FORCE
    assert abs(duration / exact.duration - 1.0) < DURATION
    velocity = result.history.bodies["ball"].velocity
    assert velocity[-1, 2] == pytest.approx(SPEED, rel=2e-3)
    ledger = result.energy["numerical"] + result.energy["contact_grid"]
    assert np.max(ledger - np.minimum.accumulate(ledger)) < 0.01 * 0.5 * steel_ball.mass * SPEED**2


def root(F: np.ndarray, i: int) -> float:
    """F^(2/3), linear in time near the ends."""
    return float(np.cbrt(F[i]) ** 2)
