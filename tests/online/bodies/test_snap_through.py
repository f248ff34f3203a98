"""Static runs through limit points: both branches compared with full finite elements, jumps named, their works; what
cannot jump fails as before."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import warpffrf as wf
from demos import snapping_arch as arch
from references.large_deflections.equilibrium_path import EquilibriumPath, pushed_arch
from warpffrf.online import snap_through
from warpffrf.online.engine import Engine

NEAR = 5e-3  # of the crown's way: the error of a reduced arch behind the jump
PATH = 0.02  # of the limit load, at 4 kN
LIMIT, LOWER = 2e-3, 5e-3  # of both limit loads
UP_AND_DOWN = 20  # load steps


@pytest.fixture(scope="module")
def exact() -> EquilibriumPath:
    top = (0.0, 0.0, arch.RISE + 0.5 * arch.THICKNESS)
    return pushed_arch(arch.mesh(arch.QUICK), arch.STEEL, top, arch.FARTHEST, arch.QUICK.steps)


def pushed(push: wf.signals.Table) -> wf.Scene:
    scene = arch.clamped(arch.QUICK, progress=False)
    scene.add(wf.forces.PointForce(scene.body("arch")["crown"], (0.0, 0.0, push), name="push"))
    return scene


@pytest.fixture(scope="module")
def cycle() -> wf.Result:
    """Up to a fifth above the limit load and back to zero."""
    push = wf.signals.Table([0.0, 0.5 * UP_AND_DOWN, UP_AND_DOWN], [0.0, -arch.LARGEST, 0.0])
    return wf.static(pushed(push), float(UP_AND_DOWN), step=1.0, progress=False)


def force_of(result: wf.Result) -> np.ndarray:
    t, n = result.time, UP_AND_DOWN
    return arch.LARGEST * np.minimum(t, n - t) / (0.5 * n)


def jumps(result: wf.Result) -> list[tuple[float, float, float, float]]:
    """Begin [s], end [s], distance [mm] and energy [J] of the jumps that the notes name."""
    found = []
    for note in result.history.notes:
        if "has jumped" in note:
            said = re.search(
                r"step to t = (\S+) s.* beyond t = (\S+) s,.* up to (\S+) mm away; that gave off (\S+) J", note
            )
            assert said is not None
            end, begin, distance, energy = map(float, said.groups())
            found.append((begin, end, distance, energy))
    return found


def test_both_branches_are_those_of_the_full_model(cycle, exact) -> None:
    assert cycle.status == "completed", cycle.message
    w, force = arch.crown_way(cycle), force_of(cycle)
    F_1, F_2 = exact.loads
    snapped = np.zeros(len(w), dtype=bool)
    for i in range(1, len(w)):
        snapped[i] = force[i] > F_1 or (snapped[i - 1] and force[i] > F_2)
        w_1, w_2 = exact.limits
        assert (w[i] > w_2) if snapped[i] else (w[i] < w_1)
    assert np.abs(exact(w) - force).max() < PATH * F_1
    assert snapped.sum() == 6


def test_jumps_are_named_with_their_loads_ways_and_works(cycle, exact) -> None:
    """Each gives off what the path leaves on its way, from the limit to where it lands under the load of the step's
    end; the force of the step grows from the limit on, on average by half of that."""
    there, back = jumps(cycle)
    load = arch.LARGEST / (0.5 * UP_AND_DOWN)
    F_1, F_2 = exact.loads
    assert load * there[0] == pytest.approx(F_1, rel=LIMIT)
    assert arch.LARGEST - load * (back[0] - 0.5 * UP_AND_DOWN) == pytest.approx(F_2, rel=LOWER)
    for (_, end, distance, energy), at, behind in ((there, 0, True), (back, 1, False)):
        limit, begins = exact.loads[at], exact.limits[at]
        force = load * min(end, UP_AND_DOWN - end)
        lands = exact.rising(force, behind=behind)
        assert distance == pytest.approx(1e3 * abs(lands - begins), rel=0.02)  # the crown's middle, not its mean
        off = 0.5 * (force + limit) * (lands - begins) - float(exact._spline.integrate(begins, lands))
        assert energy == pytest.approx(off, rel=0.02)
    numerical = cycle.energy["numerical"]
    assert -numerical[-1] == pytest.approx(there[3] + back[3], rel=0.02)  # trapezoidal works between are the rest
    assert not any("leave" in note and "open" in note for note in cycle.history.notes)


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_equilibrium_a_thousandth_before_and_behind_the_limit(exact, share) -> None:
    """Of the reduced arch's own limit load; the tangent before it is a tenth of that at rest."""
    driven = wf.static(arch.driven(arch.QUICK, progress=False), 19.0, step=1.0, progress=False)
    path = EquilibriumPath(arch.crown_way(driven), -driven.joint("rod").force[:, 2])
    force = share * path.loads[0]
    found = wf.equilibrium(pushed(wf.signals.Table([0.0, 1.0], [-force, -force])))
    assert found.status == "completed", found.message
    height = pushed(wf.signals.Table([0.0, 1.0], [0.0, 0.0])).body("arch")["crown"].point[2]
    w = height - found.sensor("crown").values[-1, 2]
    assert w == pytest.approx(exact.rising(force, behind=True) if share > 1.0 else path.limits[0], rel=0.08)
    if share > 1.0:
        assert w == pytest.approx(exact.rising(force, behind=True), rel=NEAR)


def test_a_jump_in_halved_steps_is_that_in_whole_ones(cycle) -> None:
    """What follows a jump does not know how it was made, and a step a tenth as long lands nearer to the limit."""
    push = wf.signals.Table([0.0, 10.0], [0.0, -arch.LARGEST])
    fine = wf.static(pushed(push), 10.0, step=0.1, progress=False)
    assert fine.status == "completed", fine.message
    w = arch.crown_way(fine)
    np.testing.assert_allclose(w[::10], arch.crown_way(cycle)[:11], rtol=1e-6, atol=1e-9)
    (jump,) = jumps(fine)
    assert jump[1] - jump[0] <= 0.1
    (coarse, _) = jumps(cycle)
    assert jump[0] == pytest.approx(coarse[0], abs=2e-3)
    assert jump[3] < coarse[3]


def test_a_jump_on_whose_way_room_was_made_is_the_same(cycle, monkeypatch) -> None:
    """Scratch arrays are others then: the load step begins with what is in those."""
    settled, made = snap_through._settled, []

    def with_more_room(engine: Engine, time: float) -> bool:
        found = settled(engine, time)
        before, capacity = engine.scratch, engine.compiled.model.capacity
        capacity.slot_limit = capacity.slots + 1  # for a node of a contact that is not there
        assert engine.make_room(capacity.slot_limit)
        made.append(engine.scratch is not before)
        return found

    monkeypatch.setattr(snap_through, "_settled", with_more_room)
    push = wf.signals.Table([0.0, 0.5 * UP_AND_DOWN], [0.0, -arch.LARGEST])
    found = wf.static(pushed(push), float(np.ceil(jumps(cycle)[0][1])), step=1.0, progress=False)
    assert found.status == "completed" and made == [True] and jumps(found) == jumps(cycle)[:1]
    np.testing.assert_array_equal(arch.crown_way(found), arch.crown_way(cycle)[: len(found.time)])


def test_turns_between_orientations() -> None:
    rng = np.random.default_rng(0)
    p0, p1 = Rotation.random(8, rng), Rotation.random(8, rng)
    expected = (p0.inv() * p1).as_rotvec()
    np.testing.assert_allclose(snap_through._turns(p0.as_quat(), -p1.as_quat()), expected, atol=1e-12)
    assert np.abs(snap_through._turns(p0.as_quat(), p0.as_quat())).max() < 1e-12


def test_rolling_resistance_hinders_no_jump() -> None:
    """Two springs as a flat roof, whose apex is pushed through and would roll on a floor, if it came there."""
    half, height, stiffness = 0.1, 0.02, 1e6  # m, N/m
    scene = wf.Scene()
    floor = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, -0.2), outward=(0, 0, 1)), name="floor")
    ball = wf.surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    apex = scene.add_rigid_body(1.0, (1e-3,) * 3, name="apex", position=(0, 0, height), surfaces={"ball": ball})
    steel = wf.Material(210e9, 0.3, 7850.0)
    law, resistance = wf.laws.HertzPoint(steel, steel), wf.laws.RollingResistanceArm(1e-4, 1.0)
    scene.add(wf.LumpedContact(apex["ball"], floor, law=law, rolling_resistance=resistance))
    scene.add(wf.joints.Prismatic(scene.ground.at((0, 0, 0)), apex.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    length = float(np.hypot(half, height))
    for side in (-half, half):
        scene.add(wf.forces.SpringDamper(scene.ground.at((side, 0, 0)), apex.at((0, 0, 0)), stiffness))
    limit = 2.0 / np.sqrt(27.0) * stiffness * height**3 / length**2  # of k z (h^2 - z^2)/l^2, for h << l
    push = wf.signals.Table([0.0, 4.0], [0.0, -1.04 * limit])
    scene.add(wf.forces.PointForce(apex.at((0, 0, 0)), (0.0, 0.0, push), name="push"))
    found = wf.static(scene, 4.0, step=1.0, progress=False)
    assert found.status == "completed", found.message
    assert len(jumps(found)) == 1
    assert found.body("apex").position[-1, 2] < -height
