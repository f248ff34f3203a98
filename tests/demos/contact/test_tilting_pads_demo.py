r"""The demo of a shaft on tilting pads: its run-up compared with the rotor by hand, and the checks of the latter.

**By hand.** Both bearings and halves of the shaft move alike. With the displacement u of the journals and the bending b
of the middle against them, the shaft in between moves by u + phi b, phi = 3 s - 4 s^3 with s from 0 at an end to 1/2,
and the disc by u + b. The means of phi and phi^2 are 5/8 and 17/35; so, with the masses m_d of the disc, m_s of the
shaft and 2 m_j of the journals, the stiffness k of the shaft and K + i w C of each bearing, an unbalance m_d e at the
speed w causes

    [ 2 (K + i w C) - w^2 (m_d + m_s + 2 m_j)     -w^2 (m_d + 5/8 m_s)   ] [u]
    [ -w^2 (m_d + 5/8 m_s)                    k - w^2 (m_d + 17/35 m_s)  ] [b]  =  m_d e w^2 [1; 1] (1, i)^T,

in two directions each; K and C are those of synchronous motion, of pads that follow it, at the temperatures of each
speed. During the run-up, w = w_0 + a t, the same masses and stiffnesses are integrated in time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed
from scipy.integrate import solve_ivp

import warpffrf as wf
from demos import tilting_pads as demo
from demos.tilting_pads import BEARINGS, CLEARANCE, DISC, OFF, QUICK, Held, Size, angle, speed_at, whirl

PEAK, APART = 0.02, 0.05  # of the peak: a time step of 12 degrees takes 1 % off it; phases of the beat after it
SPEED = 0.01  # of the critical speed: a revolution of the short run-up is 0.7 % of it
WARM = 0.3  # K, of means over the last revolutions: the speed rises by 0.02 K in a passage of the oil
BALANCE = 1e-6  # of the heat generated
HALF = 0.1  # of the difference, to the square of the acceleration
RITZ = 2e-3  # of the frequency: two shapes of the shaft instead of all


def shaft_numbers() -> tuple[float, float]:
    """Stiffness [N/m] of the shaft in its middle, with shear, and its mass [kg]."""
    E, nu, area = demo.STEEL.youngs_modulus, demo.STEEL.poisson_ratio, np.pi * demo.RADIUS**2
    shear = demo.SPAN / (4.0 * 0.9 * E / (2.0 * (1.0 + nu)) * area)
    return 1.0 / (demo.SPAN**3 / (12.0 * np.pi * E * demo.RADIUS**4) + shear), demo.STEEL.density * area * demo.SPAN


@dataclass(frozen=True)
class Linear(Held):
    """The rotor by hand, with the coefficients at held speeds, see the module."""

    def matrices(self, speed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Mass [kg], damping [N s/m] and stiffness [N/m] (4, 4) of u and b, each along e_0 and e_1."""
        k, m = shaft_numbers()
        coupled = DISC + 0.625 * m
        mass = np.array([[DISC + m + 2.0 * demo.JOURNAL, coupled], [coupled, DISC + 17.0 / 35.0 * m]])
        C, K = np.zeros((4, 4)), np.diag([0.0, 0.0, k, k])
        for matrix, given in ((C, self.damping), (K, self.stiffness)):
            flat = given.reshape(len(self.speeds), 4)
            matrix[:2, :2] += 2.0 * np.array([np.interp(speed, self.speeds, f) for f in flat.T]).reshape(2, 2)
        return np.kron(mass, np.eye(2)), C, K

    def steady(self, speeds: np.ndarray) -> np.ndarray:
        """Forward whirl (n, 2) [m] of the journals and of the disc, complex, in the directions of the unbalance."""
        found = []
        for w in speeds:
            M, C, K = self.matrices(w)
            x = np.linalg.solve(K + 1j * w * C - w**2 * M, DISC * OFF * w**2 * np.array([1.0, -1j, 1.0, -1j]))
            u, b = (0.5 * (x[i] + 1j * x[i + 1]) for i in (0, 2))
            found.append((u, u + b))
        return np.array(found)

    def passing(self, time: np.ndarray, size: Size) -> np.ndarray:
        """Motion (T, 2) [m] of the journals and of the disc during the run-up, e_0 + i e_1."""
        acceleration = float(np.diff(speed_at(np.array([0.0, 1.0]), size))[0])

        def rates(t: float, state: np.ndarray) -> np.ndarray:
            w = float(speed_at(np.array(t), size))
            M, C, K = self.matrices(w)
            thrown = DISC * OFF * (w**2 - 1j * acceleration) * np.exp(1j * angle(t, size))
            force = np.array([thrown.real, thrown.imag] * 2)
            return np.concatenate([state[4:], np.linalg.solve(M, force - C @ state[4:] - K @ state[:4])])

        x = solve_ivp(rates, (0.0, time[-1]), np.zeros(8), "LSODA", time, rtol=1e-6, atol=1e-10).y
        u, b = x[0] + 1j * x[1], x[2] + 1j * x[3]
        return np.stack([u, u + b], axis=1)


def checks(result: wf.Result, film: Linear, size: Size) -> list[Check]:
    speeds, found = whirl(result.time, demo.motion(result), size)
    _, by_hand = whirl(result.time, film.passing(result.time, size), size)
    found, by_hand = np.abs(found), np.abs(by_hand)
    rows = []
    for i, name in enumerate(("journal", "disc")):
        rows += [
            Check(f"{name}: peak", found[:, i].max(), by_hand[:, i].max(), "by hand", PEAK, "um", 1e6),
            Check(f"{name}: apart by", np.abs(found[:, i] - by_hand[:, i]).max(), 0.0, "by hand", APART, "um", 1e6,
                  scale=by_hand[:, i].max()),
        ]  # fmt: skip
    critical, passing = (float(speeds[np.abs(each[:, 1]).argmax()]) for each in (found, by_hand))
    rows.append(Check("critical speed", critical, passing, "by hand", SPEED, "rad/s"))
    last = demo.pad_temperatures(result)[-2 * size.steps :].mean(axis=0)
    for i, (T, held) in enumerate(zip(last, film.hottest[-1], strict=True), start=1):
        rows.append(Check(f"pad {i}: hottest oil", T, held, "equilibrium", WARM, "degC", scale=1.0))
    for name in result.film_names:
        heat = result.film(name)
        rest = heat.heat_generated - heat.heat_carried - heat.heat_to_b - heat.heat_stored
        rows.append(Check(f"{name}: heat", float(np.abs(rest[1:]).max()), 0.0, "balance", BALANCE, "W",
                          scale=float(heat.heat_generated.max())))  # fmt: skip
    return rows


def isotropic(stiffness: float, damping: float) -> Linear:
    """By hand, with a bearing of the same stiffness [N/m] and damping [N s/m] everywhere."""
    low, high = speed_at(np.array([0.0, QUICK.duration]), QUICK)
    K, C = (np.tile(value * np.eye(2), (2, 1, 1)) for value in (stiffness, damping))
    return Linear(np.array([low, high]), K, C, np.zeros((2, 4)))


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    size = demo.QUICK if quick else demo.FULL
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "tilting_pads")
    film = Linear(**vars(demo.held_speeds(demo.flexible_shaft(progress=False), size)))
    found = checks(result, film, size)
    assert len(found) == 17 and not missed(found)
    K = film.stiffness
    assert np.abs(K - K.transpose(0, 2, 1)).max() < 0.01 * K.max()  # tilting pads do not push across
    assert np.abs(demo.motion(result)[:, 0]).max() < CLEARANCE
    softer = replace(film, stiffness=0.8 * film.stiffness)
    failed = {check.name for check in checks(result, softer, size) if not check.passed}
    assert {"disc: peak", "journal: peak"} <= failed


def test_a_stiff_bearing_has_the_critical_speed_of_rigid_ones() -> None:
    film = isotropic(1e12, 1e5)
    w = demo.rigid_bearings() * np.array([0.5, 1.0 - 1e-4, 1.0 + 1e-4])
    x = film.steady(w)[:, 1]
    k, m = shaft_numbers()
    effective = DISC / (DISC + 17.0 / 35.0 * m)
    np.testing.assert_allclose(abs(x[0]), effective * OFF * 0.25 / (1.0 - 0.25), rtol=1e-3)
    assert x[1].real * x[2].real < 0.0 and abs(x[1]) > 1e3 * abs(x[0])
    assert k == pytest.approx(48.0 * 210e9 * np.pi / 4.0 * demo.RADIUS**4 / demo.SPAN**3, rel=0.03)  # shear


def test_shaft_and_disc_swing_in_the_package_as_by_hand() -> None:
    """Free of bearings: the two shapes by hand are one rigid motion and the first bending, which is compared."""
    scene = wf.Scene()
    bent = scene.add_body(demo.flexible_shaft(progress=False), name="shaft")
    disc = scene.add_rigid_body(DISC, (0.15, 0.25, 0.15), name="disc")
    scene.add(wf.joints.Fixed(bent["seat"], disc, name="hub"))
    for name, end, at in zip(BEARINGS, ("end_low", "end_high"), (-0.5, 0.5), strict=True):
        inertia = (0.5 * demo.JOURNAL * demo.RADIUS**2,) * 3
        journal = scene.add_rigid_body(demo.JOURNAL, inertia, name=name, position=(0, at * demo.SPAN, 0))
        scene.add(wf.joints.Fixed(bent[end], journal, name=f"{name} seat"))
        scene.add(wf.forces.BearingSpring(
            scene.ground.at((0, at * demo.SPAN, 0)), journal, axis=(0, 1, 0), radial=5e7, name=f"{name} spring"
        ))  # fmt: skip
    f = wf.eigenmodes(scene, 8, progress=False).frequencies
    M, _, K = isotropic(5e7, 0.0).matrices(500.0)
    by_hand = np.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)).real.min()) / (2.0 * np.pi)
    assert np.abs(f / by_hand - 1.0).min() < RITZ


def test_a_run_up_half_as_fast_is_off_held_speeds_by_half() -> None:
    film, off = isotropic(1e7, 1.5e4), []  # well damped
    for duration in (1.0, 2.0):
        size = Size(duration=duration)
        time = np.linspace(0.0, duration, round(4000 * duration))
        speeds, found = whirl(time, film.passing(time, size), size)
        later = speeds > film.speeds[0] + 0.2 * np.ptp(film.speeds)
        steady = film.steady(speeds)[later]
        off.append(np.abs(found[later] - steady).max() / np.abs(steady).max())
    assert off[0] < 0.1 and off[1] == pytest.approx(0.5 * off[0], rel=HALF)


def test_whirl_finds_amplitudes_beside_sag_and_backward_whirl() -> None:
    time = np.linspace(0.0, QUICK.duration, 1276)
    turned = angle(time, QUICK)
    amplitudes = np.array([2e-6 + 1e-6j, 3e-6])
    places = 1e-5 + amplitudes * np.exp(1j * turned)[:, None] + 5e-7 * np.exp(-1j * turned)[:, None]
    speeds, found = whirl(time, places, QUICK)
    np.testing.assert_allclose(found, np.broadcast_to(amplitudes, found.shape), atol=2e-8)
    assert np.all(np.diff(speeds) > 0.0)
