"""Campbell diagrams beside closed forms: a rigid rotor on springs with its gyroscopic moment, in world axes, and a body
that wobbles about its axis, in axes that turn with it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import warpffrf as wf
from warpffrf.model import forces, joints
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import box
from warpffrf.output.campbell import Campbell, Crossing, whirl_of
from warpffrf.output.result import Result
from warpffrf.verification.scenes.rollers import STEEL

M, J_T, J_P = 10.0, 0.08, 0.12  # kg, kg m2
BEARINGS = ((-0.2, 2e6), (0.25, 2.5e6))  # m, N/m
SPEEDS = np.array([0.0, 500.0, 1000.0])  # rad/s
FAR = 1e3  # m: springs so long keep their direction to 1e-7
TURN = 2.0 * np.pi


def rotor(speed: float) -> wf.Scene:
    """A rigid rotor about z, on springs that are alike along x and y."""
    scene = wf.Scene()
    body = scene.add_rigid_body(M, (J_T, J_T, J_P), name="rotor", angular_velocity=(0, 0, speed))
    for z, k in BEARINGS:
        for along in np.eye(3)[:2]:
            for sign in (1.0, -1.0):
                end = scene.ground.at(sign * FAR * along + np.array([0.0, 0.0, z]))
                scene.add(forces.SpringDamper(end, body.at((0.0, 0.0, z)), 0.5 * k))
    return scene


def signed_frequencies(speed: float) -> np.ndarray:
    """Rising frequencies [rad/s], forward ones positive, of the complex deflection u + z phi of the axis, u, phi ~
    exp(i w t): M u'' + k0 u + k1 phi = 0, J_t phi'' - i J_p W phi' + k1 u + k2 phi = 0."""
    k0, k1, k2 = (sum(k * z**n for z, k in BEARINGS) for n in range(3))
    mass = np.diag([M, J_T])
    A = np.block(
        [[np.zeros((2, 2)), np.eye(2)],
         [np.linalg.solve(mass, [[k0, k1], [k1, k2]]), np.diag([0.0, J_P * speed / J_T])]]
    )  # fmt: skip
    return np.sort(np.linalg.eigvals(A).real)


@pytest.fixture(scope="module")
def diagram() -> Campbell:
    return wf.campbell(rotor, SPEEDS, count=4)


def test_frequencies_and_senses_are_those_of_the_rotor(diagram: Campbell) -> None:
    assert not diagram.co_rotating and not diagram.notes
    for s, speed in enumerate(SPEEDS):
        there = np.isfinite(diagram.frequencies[s])
        found, whirl = diagram.frequencies[s, there], diagram.whirl[s, there]
        exact = signed_frequencies(speed) / TURN
        if speed == 0.0:
            assert np.sort(found) == pytest.approx(np.sort(np.abs(exact)), rel=1e-6) and np.all(whirl == 0.0)
        else:
            assert np.sort(found * np.sign(whirl)) == pytest.approx(exact, rel=1e-6)
            assert np.abs(whirl) == pytest.approx(1.0, abs=1e-6)  # circles, as the springs are alike


def test_curves_go_on_from_speed_to_speed(diagram: Campbell) -> None:
    """Four curves, each with one sense: two rise and two fall."""
    assert diagram.frequencies.shape == (3, 4) and np.all(diagram.numbers >= 0)
    assert np.array_equal(np.sign(diagram.whirl[1]), np.sign(diagram.whirl[2]))
    rises = np.diff(diagram.frequencies, axis=0)
    assert np.all(np.sign(rises) == np.sign(diagram.whirl[1]))


def test_critical_speeds_lie_on_the_order(diagram: Campbell) -> None:
    """The first backward mode meets order 1 where w = -W solves the rotor's equations, to what a straight line between
    500 and 1000 rad/s leaves."""
    first = diagram.critical_speeds()[0]
    assert isinstance(first, Crossing) and first.whirl < 0.0
    assert first.frequency == pytest.approx(first.speed / TURN)
    trial = np.linspace(500.0, 1000.0, 2001)
    backward = np.array([signed_frequencies(w)[1] for w in trial])
    exact = trial[np.argmin(np.abs(backward + trial))]
    assert first.speed == pytest.approx(exact, rel=0.01)
    assert f"at {first.speed:.5g} rad/s" in diagram.report()


def test_it_is_drawn_and_made_a_table(diagram: Campbell) -> None:
    pandas = pytest.importorskip("pandas")
    ax = diagram.plot(Figure().add_subplot(), orders=(1,))
    assert "[turns/s]" in ax.get_xlabel() and "[Hz]" in ax.get_ylabel()
    legend = ax.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["forward", "backward", "neither"]
    drawn = [np.asarray(line.get_xydata()) for line in ax.get_lines()]
    assert all(np.all(np.isfinite(points)) for points in drawn if len(points))
    frame = diagram.to_dataframe()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == 12 and frame.attrs["units"]["frequency"] == "Hz"
    row = frame[(frame["speed"] == 500.0) & (frame["curve"] == 2)]
    assert row["frequency"].item() == diagram.frequencies[1, 2]


def wobbling(speed: float) -> Result:
    """A body of three different moments on a ball joint, which has turned about its third axis for a while."""
    scene = wf.Scene()
    top = scene.add_rigid_body(3.0, (1.0, 2.0, 2.7), name="top", angular_velocity=(0, 0, speed))
    scene.add(joints.Spherical(scene.ground, top.at((0.0, 0.0, 0.0))))
    return wf.simulate(scene, 1e-3, step=2.5e-4, progress=False)


def test_results_are_taken_at_their_end_and_axes_that_turn_are_said() -> None:
    """Euler: lambda^2 = -W^2 (J_3 - J_1)(J_3 - J_2)/(J_1 J_2) in axes that turn, a straight line through the origin."""
    speeds = np.array([20.0, 40.0])
    found = wf.campbell(wobbling, speeds, count=3)
    exact = speeds / TURN * np.sqrt(1.7 * 0.7 / 2.0)
    nearest = np.nanmin(np.abs(found.frequencies - exact[:, None]), axis=1)
    assert found.co_rotating and np.all(nearest < 1e-4 * exact)
    assert "axes that turn" in found.report() and "axes that turn" in found.plot().get_title()


def test_a_flexible_shaft_bends_at_its_frequency_less_and_plus_the_speed() -> None:
    """Square, on two points: what goes round at f in the world does at f - W and f + W in axes that turn with it, along
    with the spin and against it, but for the inertia of its sections, (pi r/L)^2 = 1.3e-3 of W."""
    mesh = box((0.02, 0.02, 0.5), (1, 1, 10), center=(0.0, 0.0, 0.25), order=1)
    body = wf.reduce(
        mesh, STEEL, interfaces={"z_min": "rigid", "z_max": "rigid"}, modes=6, inertia_modes=18, cache=False,
        progress=False,
    )  # fmt: skip

    def shaft(speed: float) -> wf.Scene:
        scene = wf.Scene()
        found = scene.add_body(body, name="shaft", damping=0.0, angular_velocity=(0, 0, speed), inertia="full")
        scene.add(joints.Spherical(scene.ground, found["z_min"]))
        scene.add(joints.PointOnLine(scene.ground.at((0, 0, 0.5)), found["z_max"], axis=(0, 0, 1)))
        return scene

    speeds = np.array([0.0, 200.0])
    found = wf.campbell(shaft, speeds, count=2)
    assert found.co_rotating and found.frequencies.shape == (2, 2)
    order = np.argsort(-found.whirl[1])
    shift = TURN * (found.frequencies[1] - found.frequencies[0])[order]
    assert shift == pytest.approx([-200.0, 200.0], rel=3e-3)
    assert found.whirl[1, order] == pytest.approx([1.0, -1.0], abs=0.01)  # sections also lean, along the axis


@pytest.mark.parametrize(("turned", "exact"), [(-1j, 1.0), (1j, -1.0), (1.0, 0.0), (-0.5j, 0.8)])
def test_the_whirl_of_a_flexible_body_is_that_of_its_skin(turned: complex, exact: float) -> None:
    """Spin about x; points go by (0, 1, turned) and its multiples: 2 Im/(1 + |turned|^2) of an ellipse."""
    points = np.array([1.0, -2.0, 0.5])[:, None] * np.array([0.0, 1.0, turned])
    body = SimpleNamespace(name="shaft", index=0, mass=3.0, reduced=True)
    found = SimpleNamespace(
        state={"omega": np.array([[[0.0, 0.0, 9.0]]])}, linear=SimpleNamespace(turning=["shaft"]),
        rotation={"shaft": np.array([0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)])},  # z of the body along x
    )  # fmt: skip
    scene = SimpleNamespace(bodies=[body], body=lambda name: body)
    modes: Any = SimpleNamespace(found=found, scene=scene, displacement=lambda i, name: points)
    assert whirl_of(modes, 0) == pytest.approx(exact)


def test_what_is_no_diagram_is_said() -> None:
    for speeds in ([], [2.0, 1.0], [-1.0, 1.0]):
        with pytest.raises(InputError, match="speeds must rise"):
            wf.campbell(rotor, speeds)
    with pytest.raises(InputError, match="build must be a function"):
        wf.campbell(rotor(1.0), [1.0])  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match=r"build\(1\) must make a Scene or a Result"):
        wf.campbell(lambda speed: speed, [1.0])  # pyright: ignore[reportArgumentType]
    assert "instead of 3 rad/s" in wf.campbell(lambda speed: rotor(2.0 * speed), [3.0], count=4).notes[0]
