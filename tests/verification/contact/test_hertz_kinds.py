"""Cases C1 and C3 with the new surfaces: a cylinder and a ball on planes, six and more elements in a half-width."""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms import LineContact, PointContact, contact_modulus
from references.closed_forms.elastic_sphere import approach_correction
from references.half_space.bodies import half_plane, half_space
from scenes.half_space import PAIR, STEEL, PatchMoments, ball, cylinder, pushed
from warpffrf.model import surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import ball as ball_mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import Engine, History
from warpffrf.online.history.record import history_from_rows
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium

FORCE, HALF_WIDTH, PEAK = 0.01, 0.02, 0.01  # promised
QUARTER = (0.0, np.sin(0.25 * np.pi), 0.0, np.cos(0.25 * np.pi))  # turns +x to -z
POINT = PointContact(100.0, 0.01, contact_modulus(STEEL))  # case C3: a = 148.1 um, delta = 2.194 um


def point_errors(found: PatchMoments, approach: float, softer: float = 0.0) -> tuple[float, float, float]:
    """Force at the given approach; half-width and peak for the force found. `softer`: approach of the bodies over
    Hertz's at the same pressure, less 1."""
    exact = PointContact(found.force, POINT.radius, POINT.modulus)
    hertz = 4.0 / 3.0 * POINT.modulus * np.sqrt(POINT.radius) * (approach / (1.0 + softer)) ** 1.5
    half_width = np.sqrt(2.5 * found.second.sum())
    return found.force / hertz - 1.0, half_width / exact.half_width - 1.0, found.peak / exact.peak_pressure - 1.0


def judge(errors: tuple[float, float, float], spacing: float) -> None:
    """`spacing` of the nodes over the half-width: the largest node misses up to (spacing/2)^2/2 of a parabola."""
    force, half_width, peak = errors
    print(f"force {force:+.2%}, half-width {half_width:+.2%}, peak {peak:+.2%}")
    assert abs(force) < FORCE
    assert abs(half_width) < HALF_WIDTH
    assert abs(peak) < PEAK + 0.25 * spacing**2


@pytest.mark.slow
@pytest.mark.parametrize("cells", [6.0, 9.0])
@pytest.mark.parametrize("phase", [(0.0, 0.0), (0.5, 0.0), (0.3, 0.45)])
def test_ball_on_a_half_space(cells: float, phase: tuple[float, float]) -> None:
    """Anywhere on the grid; `phase` in spacings."""
    pitch = POINT.half_width / cells
    count = 2 * int(cells + 4) + 1
    body = half_space(count, count, pitch, STEEL)
    scene, _ = pushed(body, ball(POINT.radius), POINT.load, 0.0, 1, 0.0)
    shift = pitch * np.array([*phase, 0.0])
    for name in ("carriage", "partner"):
        scene.body(name).position = scene.body(name).position + shift
    result = equilibrium(scene)
    assert result.status == "completed", result.message
    found = PatchMoments.of(result, -1)
    assert found.place == pytest.approx(shift[:2], abs=0.02 * pitch)
    approach = POINT.radius - result.history.bodies["partner"].position[-1, 2]
    judge(point_errors(found, approach), 1.0 / cells)


@pytest.mark.parametrize("cells", [6.0, 7.3, 12.0])
def test_cylinder_on_a_half_plane(cells: float) -> None:
    """Case C1's pressures at the local line load, by a rigid cylinder on steel."""
    radius, width = 0.05, 0.01
    line = LineContact(1e5, radius, contact_modulus(STEEL))
    body = half_plane(2 * int(cells + 4) + 1, line.half_width / cells, width, STEEL, 20.0 * line.half_width)
    scene, _ = pushed(body, cylinder(radius), line.load * width, 0.0, 1, 0.0)
    result = equilibrium(scene)
    assert result.status == "completed", result.message
    found = PatchMoments.of(result, -1)
    half_width, peak = 2.0 * np.sqrt(found.second[0]) / line.half_width - 1.0, found.peak / line.peak_pressure - 1.0
    print(f"{cells}: half-width {half_width:+.2%}, peak {peak:+.2%}")
    assert found.force == pytest.approx(line.load * width, rel=1e-5)  # of a static solve
    assert abs(half_width) < HALF_WIDTH
    assert abs(peak) < PEAK


@pytest.fixture(scope="module")
def steel_ball() -> ReducedBody:
    """Three quadratic cells, six nodes, in the radius of the patch of case C3."""
    a = POINT.half_width
    mesh = ball_mesh(POINT.radius, patch_half_width=1.3 * a, cell=a / 3.0, growth=1.6)
    return reduce(mesh, STEEL, contact={"patch": surfaces.Sphere()}, modes=0, progress=False)


def resting(engine: Engine) -> History:
    """The static state of a body that nothing but contact holds, in a row: proximal steps up to 10 ms, in which it
    would fall half a metre if it were not held."""
    engine.rates_to_zero()
    for tau in 10.0 ** np.arange(-7.0, -1.0):
        engine.static_step(float(tau))
        assert not engine.word("status")[0]
    engine.save_now()
    return history_from_rows(engine.compiled, engine.saved())


@pytest.mark.slow
def test_steel_ball_on_a_rigid_plane(steel_ball: ReducedBody) -> None:
    """Case C3: a ball of finite elements rests on the ground under 100 N of gravity, and yields as a sphere does."""
    scene = Scene(gravity=(0.0, 0.0, -POINT.load / steel_ball.mass))
    # near the solution: nothing but contact holds the ball
    place = (0.0, 0.0, POINT.radius - 0.5 * POINT.approach)
    body = scene.add_body(steel_ball, name="ball", position=place, rotation=QUARTER)
    floor = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0))
    scene.add(
        Contact(
            body["patch"],
            scene.ground.surface(floor, name="floor"),
            name=PAIR,
            overlap=POINT.approach,
            grid="body_fixed",
        )
    )
    result = Result(resting(Engine(scene)))
    found = PatchMoments.of(result, -1)
    assert found.force == pytest.approx(POINT.load, rel=1e-3)
    approach = POINT.radius - result.history.bodies["ball"].position[-1, 2]
    softer = approach_correction(POINT.half_width, POINT.radius, STEEL)
    print(f"a sphere is {-softer:.2%} stiffer than a half-space")
    judge(point_errors(found, approach, softer), 1.0 / 6.0)
