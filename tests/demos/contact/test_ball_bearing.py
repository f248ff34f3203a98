"""The ball bearing, whole; its equations against those of a published method, and what its checks tell apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import ball_bearing as demo
from demos.ball_bearing import BALL, CAGE, CLEARANCE, COUNT, GROOVE, HEAVY, LOAD, NAME, PITCH, ROLLING
from references.closed_forms.ball_bearing import BallBearing

PUBLISHED = 1e-2  # of loads, deflection and pressures
LOADS, FOLLOWS, SPEEDS = 5e-3, 5e-3, 1e-2  # of the largest load: pockets push too; of the deflection; of the speeds
CENTRIFUGAL = 0.02  # of a ball's: 1 N compared with 4.5 kN
LEDGER = 1e-2  # of the energy at hand
ALONE = 0.1  # N: what a pocket may push, whose cup presses balls inwards, where centrifugal forces are compared
SETTLING = 1.0 / 3.0  # of the run


def by_the_equations(phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of balls at `phi` (T, Z) [rad] from the load: loads (T, Z) [N], and the shift of the ring along the load (T,)
    [m]. Raises RuntimeError where it fails."""
    stiffness = BallBearing(COUNT, BALL, PITCH, GROOVE, GROOVE, CLEARANCE, 206e9).stiffness
    loads, shifts, shift = [], [], np.array([60e-6, 0.0])
    for angles in phi:
        toward = np.stack([np.cos(angles), np.sin(angles)])
        for _ in range(40):  # Newton's method
            root = np.sqrt(np.maximum(shift @ toward - 0.5 * CLEARANCE, 0.0))
            lacking = toward @ (stiffness * root**3) - np.array([LOAD, 0.0])
            if np.abs(lacking).max() < 1e-9 * LOAD:
                break
            shift = shift - np.linalg.solve(1.5 * stiffness * (toward * root) @ toward.T, lacking)
        else:
            raise RuntimeError("the equations of the ball bearing were not solved")
        loads.append(stiffness * root**3)
        shifts.append(shift[0])
    return np.array(loads), np.array(shifts)


def checks(result: wf.Result) -> list[Check]:
    """At rest compared with what is published, then the last two thirds of the run compared with equations and
    kinematics."""
    found, rest = result.bearing(NAME), "published"
    Q, peaks = found.outer_load[0], (found.inner_patches.peak_pressure[0], found.outer_patches.peak_pressure[0])
    rows = np.flatnonzero(result.time > SETTLING * result.time[-1])
    exact, shift = by_the_equations(found.angle[rows])
    inner, outer = found.inner_load[rows], found.outer_load[rows]
    loaded = exact > HEAVY * exact.max()
    alone = loaded & (np.abs(found.cage_force[rows]) < ALONE)
    thrown = result.scene.body(f"{NAME} ball 1").mass * 0.5 * PITCH * found.orbit_speed[rows] ** 2
    cage = result.body(f"{NAME} cage").angular_velocity[rows, 1]
    against = (found.spin[rows][..., 2] - cage[:, None])[loaded]
    power = np.sum([each.sum(axis=1) for each in found.friction_power.values()], axis=0)
    work = result.energy["friction"][-1]
    equations, kinematics = "equations of ISO/TS 16281", "rolling without slip"
    return [
        Check("at rest: ball under the load", float(Q[0]), 4527.0, rest, PUBLISHED, "N"),
        Check("at rest: the next one", float(Q[1]), 2841.0, rest, PUBLISHED, "N"),
        Check("at rest: deflection", float(found.displacement[0, 0]), 60.5e-6, rest, PUBLISHED, "um", 1e6),
        Check("at rest: peak pressure, inner ring", float(peaks[0][0]), 3072e6, rest, PUBLISHED, "MPa", 1e-6),
        Check("at rest: peak pressure, outer ring", float(peaks[1][0]), 2567e6, rest, PUBLISHED, "MPa", 1e-6),
        Check("turning: loads of all balls off by", float(np.abs(inner - exact).max()), 0.0, equations, LOADS, "N",
              scale=float(exact.max())),
        Check("turning: mean deflection", float(found.displacement[rows, 0].mean()), float(shift.mean()), equations,
              FOLLOWS, "um", 1e6),
        Check("turning: outer load less inner", float((outer - inner)[alone].mean()), float(thrown[alone].mean()),
              "centrifugal force", CENTRIFUGAL, "N"),
        Check("turning: speed of the cage", float(cage.mean()), CAGE, kinematics, SPEEDS, "rad/s"),
        Check("turning: loaded balls against it", float(against.mean()), -ROLLING, kinematics, SPEEDS, "rad/s"),
        Check("friction: power summed", -float(np.trapezoid(power, result.time)), float(work), "energy ledger", 0.1,
              "mJ", 1e3),
        Check("energy lacking", float(np.ptp(result.energy_residual)), 0.0, "energy ledger", LEDGER, scale=1.0),
    ]  # fmt: skip


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "ball_bearing")
    assert not missed(checks(result))


def test_the_equations_are_those_of_the_standard() -> None:
    """A ball under the load, as `BallBearing` has it by root finding in space."""
    book = BallBearing(9, demo.BALL, demo.PITCH, demo.GROOVE, demo.GROOVE, demo.CLEARANCE, 206e9)
    exact, Q = book.solve(demo.LOAD, 0.0, (60e-6, 0.0, 0.0), tilts=False, lever=0.0)
    loads, shift = by_the_equations(book.angles[None])
    assert shift[0] == pytest.approx(exact[0], rel=1e-3)  # there the clearance is a free contact angle
    np.testing.assert_allclose(loads[0], Q, atol=2e-3 * Q.max())
    turned, same = by_the_equations(book.angles[None] + 2.0 * np.pi / 9.0)
    np.testing.assert_allclose(np.roll(turned[0], 1), loads[0], rtol=1e-6)
    assert same[0] == pytest.approx(shift[0], rel=1e-9)
