"""The law at nodes by true shapes compared with what it should come to: the line of centres, "full", Cattaneo and
Mindlin."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from demos import ball_on_plane
from references.monolithic import results as monolithic
from references.monolithic.line_of_centres.pair import default_layer
from scenes.rigid_cylinder import PAIR, rolled, shifted
from scenes.rollers import PAIR as ROLLERS
from scenes.rollers import Path, prescribed_pair, roller_body
from warpffrf.model import joints, laws, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

ACROSS = (0.0, 1.0, 0.0)
RADIUS = 0.05  # m, of the rollers


@pytest.fixture(scope="module")
def fine_roller() -> ReducedBody:
    return roller_body(150, layers=4, axial=2, grading=1.6, order=1, max_frequency=15e3, cache=False)


def solved(scene: Scene, at_nodes: bool, duration: float, **options: Any) -> Result:
    """The run from equilibrium, at nodes by the monolithic reference or by the engine."""
    if at_nodes:
        result = monolithic.simulate(
            scene, duration, start="equilibrium", progress=False, variant="low_rank", at_nodes=True, **options
        )
    else:
        result = simulate(scene, duration, start="equilibrium", progress=False, **options)
    assert result.status == "completed", result.message
    return result


def rest(scene: Scene, at_nodes: bool, law: Any) -> Any:
    """The pair at rest, its record."""
    contact = scene.contacts[0]
    contact.law = law
    for body in scene.bodies:
        body.level = "constant"
    return solved(scene, at_nodes, 1e-6, step=1e-6).history.contacts[contact.name]


@pytest.mark.slow
@pytest.mark.parametrize("approach", [3e-4, 1.2e-3])
def test_true_shapes_and_line_of_centres(approach: float, fine_roller: ReducedBody) -> None:
    """A layer given as a table goes by the true shapes, the same one as a number along the line of centres. Both gaps
    agree but for the angle between normal and line of centres, up to a/2R: a part (a/2R)^2 of them, a^2 = R d."""
    k = 0.3 * default_layer(fine_roller.contact_surfaces["rim"])
    table = laws.TabulatedLayer((-1e-2, 0.0), (1e-2 * k, 0.0))
    scenes = [prescribed_pair(fine_roller, fine_roller, Path.of([approach, approach], 0.01)) for _ in range(2)]
    shapes, line = (rest(s, True, law) for s, law in zip(scenes, (table, laws.LinearLayer(k)), strict=True))
    off = abs(np.linalg.norm(shapes.force[0]) / np.linalg.norm(line.force[0]) - 1.0)
    print(f"{approach:g} m: off by {off:.1e}, (a/2R)^2 = {0.25 * approach / RADIUS:.1e}")
    assert off < 0.25 * approach / RADIUS
    assert np.abs(shapes.force + shapes.force_second).max() < 1e-12 * np.abs(shapes.force).max()


def test_a_roller_on_the_ground(fine_roller: ReducedBody) -> None:
    """Given approach, some nodes in a half-width: the force of "full" but for what nodes and weak gaps discretise."""
    found = []
    law = laws.LinearLayer(0.3 * default_layer(fine_roller.contact_surfaces["rim"]))
    for at_nodes in (True, False):
        scene = Scene()
        body = scene.add_body(fine_roller, name="roller", position=(0.0, 0.0, RADIUS - 1.2e-3))
        scene.add(joints.Fixed(scene.ground, body["bore"], name="hold"))
        plane = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=ACROSS)
        scene.add(Contact(body["rim"], scene.ground.surface(plane, name="floor"), name=ROLLERS, overlap=1.0))
        found.append(rest(scene, at_nodes, law))
    nodal, full = found
    assert nodal.force[0, 2] == pytest.approx(full.force[0, 2], rel=0.02)
    assert nodal.approach[0] == pytest.approx(full.approach[0], rel=0.02)  # at the nearest node, at the nearest point
    assert np.abs(nodal.torque[0]).max() < 1e-9 * RADIUS * nodal.force[0, 2]
    assert nodal.load_second.shape == full.load_second.shape == (len(nodal.force), 0, 0)
    np.testing.assert_array_equal(nodal.force_second, -nodal.force)


@pytest.fixture(scope="module")
def ball() -> ReducedBody:
    return ball_on_plane.reduced_ball(ball_on_plane.Size(cells=1.5), progress=False)


@pytest.mark.slow
def test_a_ball_on_a_rigid_plane_pushed_aside(ball: ReducedBody, monkeypatch: pytest.MonkeyPatch) -> None:
    """Finite elements, a stiff layer, friction: three nodes in a half-width, so nodes differ from weak gaps by some per
    cent (2 % of the approach, 8 % of the shift), which five nodes bring to 0.6 % and 3 %."""
    monkeypatch.setattr(ball_on_plane, "reduced_ball", lambda *_, **__: ball)
    k = 0.3 * default_layer(ball.contact_surfaces["patch"])
    down, side = [], []
    for at_nodes in (True, False):
        scene = ball_on_plane.build(progress=False)
        contact = scene.contacts[0]
        contact.law = laws.LinearLayer(k)
        integrator: dict[str, Any] = {"integrator": GeneralizedAlpha(0.0)}
        chosen = integrator if at_nodes else {"options": RunOptions(**integrator)}
        result = solved(scene, at_nodes, ball_on_plane.DURATION, step=2e-3, **chosen)
        assert any("does not act in the equilibrium" in note for note in result.history.notes), at_nodes
        record = result.history.contacts[contact.name]
        assert record.force[-1, 2] == pytest.approx(ball_on_plane.LOAD, rel=1e-5)
        assert record.force[-1, 0] == pytest.approx(-ball_on_plane.PUSH, rel=1e-3)
        assert np.all(np.diff(result.history.energy["friction"]) <= 1e-9 * np.ptp(result.history.energy["friction"]))
        assert record.friction is not None and {1, 2} <= set(np.unique(record.friction.state[-1]))
        down.append(-result.joint(ball_on_plane.DOWN).coordinate[-1])
        side.append(result.joint(ball_on_plane.SIDE).coordinate[-1])
    assert down[0] == pytest.approx(down[1], rel=0.02)
    assert side[0] == pytest.approx(side[1], rel=0.09)


@pytest.mark.parametrize(("cells", "loss"), [(16, 0.05), pytest.param(32, 0.01, marks=pytest.mark.slow)])
def test_cattaneo_and_mindlin(cells: int, loss: float) -> None:
    """Case C5 with the law at nodes: stick zone to a spacing, displacement to 0.5 %, loss of a cycle; "full" for
    comparison."""
    nodal, full = (shifted(cells, quadrature) for quadrature in ("at nodes", "full"))
    print(f"stick zone {nodal.stick:+.2f} spacings, displacement {nodal.displacement:+.2%}, loss {nodal.loss:+.2%}")
    assert abs(nodal.stick) < 1.0
    assert abs(nodal.displacement) < 5e-3
    assert abs(nodal.loss) < loss
    assert np.all(np.diff(nodal.result.history.energy["friction"]) <= 0.0)
    c, other = (found.result.history.contacts[PAIR] for found in (nodal, full))
    assert np.abs(other.force[:, 0] - c.force[:, 0]).max() < 0.01 * np.abs(c.force[:, 0]).max()
    assert other.pressure[0].max() == pytest.approx(c.pressure[0].max(), rel=5e-3)
    assert c.friction is not None and other.friction is not None
    assert other.friction.creep_velocity[3, 0] == pytest.approx(c.friction.creep_velocity[3, 0], rel=1e-3)


@pytest.mark.slow
def test_a_stiff_stretch_hardly_matters() -> None:
    """The stick stiffness a hundred times up: forces move by less than a per cent, and as many iterations are taken."""
    found = [shifted(16, "at nodes", stick=stick).result.history for stick in (None, 100.0)]
    soft, stiff = (history.contacts[PAIR].force[:, 0] for history in found)
    assert np.abs(soft - stiff).max() < 0.01 * np.abs(soft).max()
    assert found[1].iterations.mean() < found[0].iterations.mean() + 2.0


@pytest.mark.slow
def test_carter() -> None:
    """Case C6 with the law at nodes, a fast one: after two crossings as far as the cells of "full" at the same step, to
    the first order of both in the cell; the creepage is the one asked for, and nodes that enter are charged with it."""
    (nodal, creep, result), (full, _, _) = (rolled(8, quadrature, crossings=2) for quadrature in ("at nodes", "full"))
    print(f"nodes {nodal:+.2%}, grid {full:+.2%}, creepage {creep:.4f}")
    assert creep == pytest.approx(1.0, rel=1e-3)
    assert abs(nodal - full) < 0.06
    rub = result.history.contacts[PAIR].friction
    assert rub is not None
    assert rub.cells_per_step[-1] == pytest.approx(1.0, rel=1e-3)
    assert rub.rolling_velocity[-1] == pytest.approx(-1.0, rel=1e-3)
    assert rub.power.min() >= 0.0
    touching, sticks, slips = (np.flatnonzero(np.isin(rub.state[-1, :, 0], s)) for s in ((1, 2), (1,), (2,)))
    assert slips[0] == touching[0] and len(sticks) > len(slips)  # it rolls to +x and slips behind
