r"""The friction drive compared with its loop of rigid rollers, and with Kalker's and Coulomb's rolling.

The loop, written out here, has the same samples: torques are linear over each step, so that speeds are exact. While the
surfaces roll on each other there is one inertia, J w2' = i T - M. Friction then carries Q R2 = M + J2 w2'; beyond its
limit both rollers are on their own,

    J1 w1' = T - mu N R1,        J2 w2' = mu N R2 - M,

until their surfaces have the same speed, with the momentum i J1 w1 + J2 w2.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import friction_drive as demo
from demos.friction_drive import (
    FRICTION,
    HALF_WIDTH,
    INERTIA,
    INERTIAS,
    KI,
    KP,
    LIMIT,
    LOAD,
    LOADED,
    LOST,
    MOST_TORQUE,
    OVERLOAD,
    OVERLOADED,
    PRESS,
    QUICKNESS,
    RADII,
    RATIO,
    SPEED,
    SPIN_UP,
    STEEL,
)  # fmt: skip
from references.closed_forms.rolling_tables import KALKER, KALKER_POISSON

SAMPLED = 0.02  # of the dip: the torque answers the speed a step late, w h = 0.012
CREPT = 0.01  # of the speed: friction builds up and falls in a crossing of the patch, a tenth of 1/w; creepage
RATE = 5e-3  # of the deceleration in gross slip: the last of the sticking cells; tractions on an arc, (a/R)^2
CREEPAGE = 0.03  # their curve is approximate; seven cells across the patch
SETTLED = 1e-4  # of the values that the controller settles at, 12/w after the step: exp(-12) (1 + 12)


@dataclass(frozen=True)
class Loop:
    """Speed of the large roller (T,) [rad/s], and when the brake was let go [s]."""

    speed: np.ndarray
    let_go: float


def loop(step: float, end: float) -> Loop:
    """The loop of rigid rollers in steps of `step` [s]."""
    t = step * np.arange(round(end / step) + 1)
    x = np.clip(t / SPIN_UP, 0.0, 1.0)
    reference = SPEED * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    small = large = integral = motor = brake = slipping = 0.0
    let_go, speeds = np.inf, [0.0]
    for n in range(len(t) - 1):
        error = reference[n] - large
        wanted = KP * error + KI * integral
        command = min(max(wanted, -MOST_TORQUE), MOST_TORQUE)
        if (wanted - command) * error <= 0.0:
            integral += step * error
        if let_go == np.inf and t[n] >= OVERLOADED and large < LOST * SPEED:
            let_go = float(t[n])
        load = 0.0 if t[n] < LOADED or t[n] >= let_go else LOAD if t[n] < OVERLOADED else OVERLOAD
        T, M = 0.5 * (motor + command), 0.5 * (brake + load)
        motor, brake = command, load
        if not slipping:
            carried = load + INERTIAS[1] * (RATIO * command - load) / INERTIA
            slipping = float(np.sign(carried)) if abs(carried) > LIMIT else 0.0
        if slipping:
            large += step * (slipping * LIMIT - M) / INERTIAS[1]
            small += step * (T - slipping * LIMIT / RATIO) / INERTIAS[0]
            if slipping * (small - RATIO * large) <= 0.0:
                large, slipping = (INERTIAS[1] * large + RATIO * INERTIAS[0] * small) / INERTIA, 0.0
        else:
            large += step * (RATIO * T - M) / INERTIA
        if not slipping:
            small = RATIO * large
        speeds.append(large)
    return Loop(np.array(speeds), let_go)


def creepage(share: float) -> float:
    """Of a circular patch at Q/(mu N) = share: P. J. Vermeulen, K. L. Johnson, J. Appl. Mech. 31 (1964), 338, with the
    slope of Kalker's C11."""
    C11 = float(np.polynomial.Polynomial.fit(KALKER_POISSON, KALKER[1.0][0], 2)(STEEL.poisson_ratio))
    shear = 0.5 * STEEL.youngs_modulus / (1.0 + STEEL.poisson_ratio)
    return 3.0 * FRICTION * PRESS / (shear * HALF_WIDTH**2 * C11) * (1.0 - np.cbrt(1.0 - share))


def checks(result: wf.Result, size: demo.Size) -> list[Check]:
    """The figures of a run."""
    t, large = result.time, result.body("large").angular_velocity[:, 1]
    let_go, rigid = demo.let_go(result), loop(size.step, float(t[-1]))
    of_loop = rigid.speed[np.rint(t / size.step).astype(int)]
    loaded, at = (t > LOADED) & (t < OVERLOADED), int(np.flatnonzero(t < OVERLOADED)[-1])
    pair = result.contact(demo.PAIR)
    share = float(np.abs(pair.friction.tangential_force[at, 0]) / (FRICTION * pair.normal_load[at]))
    return [
        Check("load step: slower by", SPEED - float(large[loaded].min()), float(demo.dip(LOADED + 1.0 / QUICKNESS)),
              "one inertia, critically damped", SAMPLED, "rad/s"),
        Check("speed, largest difference", float(np.abs(large - of_loop).max()), 0.0, "loop of rigid rollers", CREPT,
              "rad/s", scale=SPEED),
        Check("speed under the load", float(large[at]), SPEED, "reference", SETTLED, "rad/s"),
        Check("torque of the motor", -float(result.force("motor").torque[at, 1]), LOAD / RATIO, "statics", SETTLED,
              "N m"),
        Check("friction used", share, LOAD / LIMIT, "statics", SETTLED),
        Check("creepage", float(np.abs(pair.friction.creepage[at, 0])), creepage(share), "Vermeulen and Johnson",
              CREEPAGE),
        Check("overload: falls with", demo.falling(result), (OVERLOAD - LIMIT) / INERTIAS[1], "Coulomb", RATE,
              "rad/s2"),
        Check("let go at", let_go, rigid.let_go, "loop of rigid rollers", 8.0 * size.step, "s", scale=1.0),
    ]  # fmt: skip


def test_the_loop_has_its_closed_form() -> None:
    """Sampled four times as often, the loop of rigid rollers is four times as near to one inertia with critical
    damping."""
    errors = []
    for step in (2e-4, 5e-5):
        found = loop(step, 0.5)
        t = step * np.arange(len(found.speed))
        before = found.speed[np.searchsorted(t, LOADED)] - SPEED  # what is left of the spin-up, a few thousandths
        loaded = t >= LOADED
        late = t[loaded] - LOADED
        rest = before * np.exp(-QUICKNESS * late)
        errors.append(float(np.abs(found.speed[loaded] - SPEED + demo.dip(t[loaded]) - rest).max()))
    assert errors[0] < SAMPLED * demo.dip(LOADED + 1.0 / QUICKNESS)
    assert errors[1] < 0.5 * errors[0]


def test_the_radius_of_the_patch_is_hertzs() -> None:
    from references.closed_forms import PointContact, contact_modulus

    hertz = PointContact(PRESS, 1.0 / sum(1.0 / r for r in RADII), contact_modulus(STEEL, STEEL))
    assert pytest.approx(hertz.half_width, rel=1e-12) == HALF_WIDTH


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "friction_drive")
    assert not missed(checks(result, demo.QUICK if quick else demo.FULL))
