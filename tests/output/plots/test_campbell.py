"""Campbell diagrams compared with closed forms: a rigid rotor on springs with its gyroscopic moment, in world axes; in
axes that turn a body that wobbles about its axis, a disc on a light shaft (forward, backward, critical speed), a shaft
alone, and the waves of a ring. All are seen from both frames."""

from __future__ import annotations

import logging
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import warpffrf as wf
from scenes.rollers import STEEL
from warpffrf.model import forces, joints
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import box
from warpffrf.output.campbell import Campbell, Crossing, whirl_of
from warpffrf.output.result import Result

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
    assert not diagram.notes
    for s, speed in enumerate(SPEEDS):
        there = np.isfinite(diagram.frequencies[s])
        found, whirl = diagram.frequencies[s, there], diagram.whirl[s, there]
        exact = signed_frequencies(speed) / TURN
        if speed == 0.0:
            assert np.sort(found) == pytest.approx(np.sort(np.abs(exact)), rel=1e-6) and np.all(whirl == 0.0)
        else:
            assert np.sort(found * np.sign(whirl)) == pytest.approx(exact, rel=1e-6)
            assert np.abs(whirl) == pytest.approx(1.0, abs=1e-6)  # circles, as the springs are alike
            seen = np.sort(diagram.rotating_frequencies[s, there])
            assert seen == pytest.approx(np.sort(np.abs(exact - speed / TURN)), rel=1e-6)


def test_curves_go_on_from_speed_to_speed(diagram: Campbell) -> None:
    """Four curves, each with one sense: two rise and two fall."""
    assert diagram.frequencies.shape == (3, 4) and np.all(diagram.numbers >= 0)
    assert np.array_equal(np.sign(diagram.whirl[1]), np.sign(diagram.whirl[2]))
    rises = np.diff(diagram.frequencies, axis=0)
    assert np.all(np.sign(rises) == np.sign(diagram.whirl[1]))


def test_critical_speeds_are_those_of_unbalance(diagram: Campbell) -> None:
    """w = W in the rotor's equations: k0 - M W^2, k1; k1, k2 + (J_p - J_t) W^2 is singular, once as J_p > J_t; to what
    a straight line between 500 and 1000 rad/s leaves. The backward curves that cross the line are not excited."""
    k0, k1, k2 = (sum(k * z**n for z, k in BEARINGS) for n in range(3))
    squares = np.roots([M * (J_T - J_P), -(k0 * (J_T - J_P) + k2 * M), k0 * k2 - k1**2])
    exact = np.sqrt(squares[squares > 0.0])
    (only,) = diagram.critical_speeds()
    assert isinstance(only, Crossing) and only.whirl > 0.9
    assert only.frequency == pytest.approx(only.speed / TURN)
    assert only.speed == pytest.approx(exact[0], rel=0.01)
    assert f"(unbalance): curve {only.branch} at {only.speed:.5g} rad/s" in diagram.report()


def test_it_is_drawn_and_made_a_table(diagram: Campbell) -> None:
    pandas = pytest.importorskip("pandas")
    ax = diagram.plot(Figure().add_subplot(), orders=(1,))
    assert "[rev/s]" in ax.get_xlabel() and "[Hz]" in ax.get_ylabel()
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
    """A body of three different moments on a ball joint, which has rotated about its third axis for a while."""
    scene = wf.Scene()
    top = scene.add_rigid_body(3.0, (1.0, 2.0, 2.7), name="top", angular_velocity=(0, 0, speed))
    scene.add(joints.Spherical(scene.ground, top.at((0.0, 0.0, 0.0))))
    return wf.simulate(scene, 1e-3, step=2.5e-4, progress=False)


def test_results_are_taken_at_their_end_and_axes_that_turn_are_said() -> None:
    """Euler: lambda^2 = -W^2 (J_3 - J_1)(J_3 - J_2)/(J_1 J_2) in axes that turn, a straight line through the origin."""
    speeds = np.array([20.0, 40.0])
    found = wf.campbell(wobbling, speeds, count=3)
    exact = speeds / TURN * np.sqrt(1.7 * 0.7 / 2.0)
    nearest = np.nanmin(np.abs(found.rotating_frequencies - exact[:, None]), axis=1)
    assert np.all(nearest < 1e-4 * exact)
    assert "axes that turn" in found.report() and "fixed frame" in found.report()
    assert "fixed frame" in found.plot().get_title() and "axes that turn" in found.plot(frame="rotating").get_title()
    with pytest.raises(InputError, match="frame is 'world'"):
        found.plot(frame="world")


def test_a_flexible_shaft_bends_at_its_frequency_less_and_plus_the_speed() -> None:
    """Square, on two points: what goes round at f in the world does at f - W and f + W in axes that turn with it, along
    with the spin and against it, but for the inertia of its sections, (pi r/L)^2 = 1.3e-3 of W."""
    mesh = box((0.02, 0.02, 0.5), (1, 1, 10), center=(0.0, 0.0, 0.25), order=1)
    body = wf.reduce(
        mesh, STEEL, interfaces={"z_min": "rigid", "z_max": "rigid"}, modes=6,
        options=wf.ReductionOptions(inertia_modes=18), cache=False, progress=False,
    )  # fmt: skip

    def shaft(speed: float) -> wf.Scene:
        scene = wf.Scene()
        found = scene.add_body(body, name="shaft", damping=0.0, angular_velocity=(0, 0, speed), inertia="full")
        scene.add(joints.Spherical(scene.ground, found["z_min"]))
        scene.add(joints.PointOnLine(scene.ground.at((0, 0, 0.5)), found["z_max"], axis=(0, 0, 1)))
        return scene

    speeds = np.array([0.0, 200.0])
    found = wf.campbell(shaft, speeds, count=2)
    assert found.frequencies.shape == (2, 2)
    order = np.argsort(-found.whirl[1])
    shift = TURN * (found.rotating_frequencies[1] - found.rotating_frequencies[0])[order]
    assert shift == pytest.approx([-200.0, 200.0], rel=3e-3)
    assert found.frequencies[1] == pytest.approx(
        found.frequencies[0], rel=3e-3 * 200.0 / (TURN * found.frequencies[0, 0])
    )

    assert found.whirl[1, order] == pytest.approx([1.0, -1.0], abs=0.01)  # sections also lean, along the axis


LIGHT = wf.Material(210e9, 0.0, 1.0)  # no mass that counts, no Poisson effect: a beam's clamp does not hold it
SIDE, LENGTH = 0.01, 0.4  # m
DISC = (2.0, 0.01, 0.02)  # kg, kg m2: across and about the axis
SHEAR = 1e-3  # of frequencies: (SIDE/LENGTH)^2 = 6e-4, and sixteen cells


def overhung_frequencies(speed: float) -> np.ndarray:
    """Rising signed frequencies [rad/s] of a disc at the end of a massless cantilever, Euler and Bernoulli: u and slope
    phi with 12 EI/L^3, -6 EI/L^2, 4 EI/L."""
    EI = LIGHT.youngs_modulus * SIDE**4 / 12.0
    K = EI * np.array([[12.0 / LENGTH**3, -6.0 / LENGTH**2], [-6.0 / LENGTH**2, 4.0 / LENGTH]])
    mass, J_t, J_p = DISC
    zero = np.zeros((2, 2))
    A = np.block([[zero, np.eye(2)], [np.linalg.solve(np.diag([mass, J_t]), K), np.diag([0.0, J_p * speed / J_t])]])
    return np.sort(np.linalg.eigvals(A).real)


def test_a_disc_on_a_light_shaft_in_both_frames() -> None:
    """Forward and backward whirl with the gyroscopic moment; the forward curve passes zero in axes that turn, and is
    one curve; the critical speed is where det(K - W^2 diag(M, J_t - J_p)) = 0."""
    mesh = box((SIDE, SIDE, LENGTH), (1, 1, 16), center=(0.0, 0.0, 0.5 * LENGTH), order=2)
    ends = {"z_min": "rigid", "z_max": "rigid"}
    body = wf.reduce(mesh, LIGHT, interfaces=ends, modes=4, cache=False, progress=False)

    def rotor(speed: float) -> wf.Scene:
        scene = wf.Scene(gravity=(0, 0, 0))
        shaft = scene.add_body(body, name="shaft", damping=0.0, angular_velocity=(0, 0, speed))
        turn = scene.add(joints.Revolute(scene.ground, shaft["z_min"], axis=(0, 0, 1)))
        scene.add(joints.Drive(turn, speed, quantity="velocity"))
        mass, J_t, J_p = DISC
        disc = scene.add_rigid_body(
            mass, (J_t, J_t, J_p), name="disc", position=(0, 0, LENGTH), angular_velocity=(0, 0, speed)
        )
        scene.add(joints.Fixed(shaft["z_max"], disc.at((0, 0, 0))))
        return scene

    speeds = np.array([0.0, 40.0, 60.0, 80.0, 100.0])
    found = wf.campbell(rotor, speeds, count=5)
    assert found.frequencies.shape == (5, 5) and np.all(found.numbers >= 0) and not found.notes
    bends = found.waves[1] == 1
    assert np.sum(bends) == 4 and np.all(found.waves[1:, ~bends] == 0)  # the other one twists
    assert np.array_equal(found.frequencies[1:, ~bends], found.rotating_frequencies[1:, ~bends])
    for s, speed in enumerate(speeds):
        exact = overhung_frequencies(speed) / TURN
        signed = (np.where(found.whirl[s] < 0.0, -1.0, 1.0) * found.frequencies[s])[bends]
        if speed:
            assert np.sort(signed) == pytest.approx(exact, rel=SHEAR)
            turning = np.sort(found.rotating_frequencies[s, bends])
            assert turning == pytest.approx(np.sort(np.abs(exact - speed / TURN)), rel=SHEAR, abs=SHEAR * speed / TURN)
    assert np.all(np.sign(found.whirl[1:]) == np.sign(found.whirl[1]))
    passing = int(np.argmin(found.rotating_frequencies[1]))
    away = overhung_frequencies(60.0)[2] - 60.0, overhung_frequencies(80.0)[2] - 80.0
    assert away[0] > 0.0 > away[1] and found.whirl[:, passing][1:] == pytest.approx(1.0, abs=1e-3)
    (only,) = found.critical_speeds()
    trial = np.linspace(60.0, 80.0, 2001)
    exact = trial[np.argmin([abs(overhung_frequencies(w)[2] - w) for w in trial])]
    assert only.branch == passing and only.speed == pytest.approx(exact, rel=SHEAR)


def test_internal_damping_drives_whirl_above_the_critical_speed(caplog: pytest.LogCaptureFixture) -> None:
    """The disc on its light shaft with beta K that turns with it: M x'' + (beta K - i G W) x' + (K - i beta W K) x = 0
    of complex x; forward whirl grows where it is slower than the speed."""
    beta, speeds = 1e-4, np.array([40.0, 100.0])
    mesh = box((SIDE, SIDE, LENGTH), (1, 1, 16), center=(0.0, 0.0, 0.5 * LENGTH), order=2)
    body = wf.reduce(
        mesh, LIGHT, interfaces={"z_min": "rigid", "z_max": "rigid"}, modes=4, cache=False, progress=False
    )  # fmt: skip
    mass, J_t, J_p = DISC

    def rotor(speed: float) -> wf.Scene:
        scene = wf.Scene(gravity=(0, 0, 0))
        shaft = scene.add_body(
            body, name="shaft", damping=wf.damping.Rayleigh(beta=beta), angular_velocity=(0, 0, speed)
        )
        turn = scene.add(joints.Revolute(scene.ground, shaft["z_min"], axis=(0, 0, 1)))
        scene.add(joints.Drive(turn, speed, quantity="velocity"))
        disc = scene.add_rigid_body(
            mass, (J_t, J_t, J_p), name="disc", position=(0, 0, LENGTH), angular_velocity=(0, 0, speed)
        )
        scene.add(joints.Fixed(shaft["z_max"], disc.at((0, 0, 0))))
        return scene

    with caplog.at_level(logging.WARNING, "warpffrf"):
        found = wf.campbell(rotor, speeds, count=5)
    EI = LIGHT.youngs_modulus * SIDE**4 / 12.0
    K = EI * np.array([[12.0 / LENGTH**3, -6.0 / LENGTH**2], [-6.0 / LENGTH**2, 4.0 / LENGTH]])
    for s, speed in enumerate(speeds):
        D, k = beta * K - 1j * speed * np.diag([0.0, J_p]), (1.0 - 1j * beta * speed) * K
        inverse = np.diag([1.0 / mass, 1.0 / J_t])
        exact = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ k, -inverse @ D]]))
        ratios = np.sort(-exact.real / np.abs(exact))
        assert np.sort(found.damping_ratios[s, found.waves[s] == 1]) == pytest.approx(ratios, rel=5 * SHEAR)
        assert (ratios[0] < 0.0) == (speed == speeds[1])
    assert "negative damping" in found.notes[-1] and "from 100 rad/s on" in found.notes[-1]
    assert "destabilises whirl" in caplog.text


def test_waves_of_a_ring_go_round_in_the_world() -> None:
    """Bryan: in the ring the pattern of n waves lags by 2 W/(n^2 + 1), so that in the world the two are at w_n +- n W
    (n^2 - 1)/(n^2 + 1). They have no unbalance to answer to."""
    mesh = wf.mesh.roller(0.101, 0.099, 0.01, sectors=36, layers=1, axial=1, order=2)
    body = wf.reduce(mesh, STEEL, max_frequency=600.0, cache=False, progress=False)

    def ring(speed: float) -> wf.Scene:
        scene = wf.Scene(gravity=(0, 0, 0))
        scene.add_body(body, name="ring", damping=0.0, inertia="full", angular_velocity=(0, speed, 0))
        return scene

    speed = 10.0
    found = wf.campbell(ring, [speed], count=40)
    own = body.frequencies
    for n in (2, 3):
        two = np.flatnonzero((found.waves[0] == n) & (np.abs(found.whirl[0]) > 0.9))
        at = found.frequencies[0, two]
        signs = np.sign(found.whirl[0, two])
        forward, backward = (float(at[signs == sign].min()) for sign in (1.0, -1.0))  # in the plane, below those aside
        shift = n * speed / TURN * (n * n - 1) / (n * n + 1)
        assert 0.5 * (forward - backward) == pytest.approx(shift, rel=0.01)
        assert np.min(np.abs(own - 0.5 * (forward + backward))) < 0.01 * shift
    assert not found.critical_speeds()


def test_a_state_that_is_not_settled_is_said_aloud(caplog: pytest.LogCaptureFixture) -> None:
    """A bar that turns about its end, stiffened by what stretches it, and has not been stretched yet."""
    mesh = box((0.5, 0.01, 0.01), (6, 1, 1), center=(0.25, 0.0, 0.0), order=1)
    body = wf.reduce(
        mesh, STEEL, interfaces={"x_min": "rigid"}, modes=12, options=wf.ReductionOptions(stiffening=True), cache=False,
        progress=False
    )  # fmt: skip

    def bar(speed: float) -> wf.Scene:
        scene = wf.Scene(gravity=(0, 0, 0))
        arm = scene.add_body(body, name="bar", stiffening=True, angular_velocity=(0, 0, speed))
        scene.add(joints.Revolute(scene.ground, arm["x_min"], axis=(0, 0, 1)))
        return scene

    with caplog.at_level(logging.WARNING, "warpffrf"):
        found = wf.campbell(bar, [400.0], count=3)
    assert "not steady" in caplog.text and found.report().startswith("CAUTION: the state is not steady")
    assert "at 1 of 1 speeds, from 400 rad/s on" in found.notes[0] and "settled" in found.notes[0]
    assert any("caution" in text.get_text() for text in found.plot().texts)


@pytest.mark.parametrize(("turned", "exact"), [(-1j, 1.0), (1j, -1.0), (1.0, 0.0), (-0.5j, 0.8)])
def test_the_whirl_of_a_flexible_body_is_that_of_its_skin(turned: complex, exact: float) -> None:
    """Spin about x; points go by (0, 1, rotated) and its multiples: 2 Im/(1 + |rotated|^2) of an ellipse."""
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
        with pytest.raises(InputError, match="speeds must ascend"):
            wf.campbell(rotor, speeds)
    with pytest.raises(InputError, match="build must be a function"):
        wf.campbell(rotor(1.0), [1.0])  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match=r"build\(1\) must return a Scene or a Result"):
        wf.campbell(lambda speed: speed, [1.0])  # pyright: ignore[reportArgumentType]
    assert "instead of 3 rad/s" in wf.campbell(lambda speed: rotor(2.0 * speed), [3.0], count=4).notes[0]
