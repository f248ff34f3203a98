"""Lumped contacts: the tangent in the retained matrix against differences of the residuals, action and reaction, and
the places of the kernels against those of a search on the host."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from lumped_scenes import MEETINGS, STEEL, pair

from warpffrf.model import laws
from warpffrf.online import Engine
from warpffrf_kernels.core import control as k

STEP, BETA, GAMMA = 1e-4, 0.3, 0.6  # of the step in time whose tangent it is
APPROACH = 4e-6  # m
DIFFERENCE = 2e-10  # m, and over a lever of 10 mm rad: a fraction 5e-5 of the approach
ARM = 0.01  # m: what makes moments forces
# of the largest entry: the square of that fraction, and round-off of the force, 1e-17 m of approach over the difference
AGREE = 1e-5
# mu, how fast, and the slip velocity of the regularised law [m/s]
REGIMES = {
    "stick": (0.4, 0.02, 0.0), "slip": (0.2, 10.0, 0.0), "creep": (0.3, 0.1, 0.5), "rub": (0.3, 3.0, 0.01),
    "none": (0.0, 1.0, 0.0), "traction": (0.3, 3.0, 0.01),
}  # fmt: skip
# lever [m] and rolling speed [rad/s], slip velocity [m/s] of friction that resists pivoting: below and at the bounds
MOMENTS = {"turns slowly": (1e-3, 1e3, 1.0), "turns fast": (1e-3, 0.1, 1e-5)}
ALL_REGIMES = ("ball on groove", "crossed cylinders", "roller by laminae in bore")
MANY = {**REGIMES, **MOMENTS}
CASES = [(name, r) for name in MEETINGS for r in (MANY if name in ALL_REGIMES else ("slip",))]


def engine_of(name: str, regime: str) -> tuple[Engine, np.ndarray, np.ndarray]:
    """In a step that ends with some slip; and the increments of that step."""
    options: dict[str, Any] = {}
    if regime in MOMENTS:
        lever, rolling_speed, creep = MOMENTS[regime]
        mu, fast = 0.3, 3.0
        options = {"rolling_resistance": laws.RollingResistanceArm(lever, rolling_speed), "spin": "laminae" not in name}
    else:
        mu, fast, creep = REGIMES[regime]
    friction = laws.RegularisedCoulomb(mu, creep) if creep else mu
    if regime == "traction":
        friction = laws.TractionCurve(mu, creep, 0.1, 0.2)
    law = laws.PalmgrenLine(0.01, 3, damping=0.3) if "laminae" in name else laws.HertzPoint(STEEL, damping=0.3)
    scene = pair(name, APPROACH, mass=1e-9, friction=friction, law=law, **options)
    engine = Engine(scene)
    rng = np.random.default_rng(5)
    slow = 1e-7 * fast if regime in ("stick", "slip") else 1e-6
    dx, psi = slow * rng.normal(size=(2, 3)), slow / ARM * rng.normal(size=(2, 3))
    engine.state.v.assign(0.05 * fast * rng.normal(size=(1, 2, 3)))
    engine.state.omega.assign(0.05 * fast / ARM * rng.normal(size=(1, 2, 3)))
    engine.clock(h=STEP)
    engine.coefficients(beta=BETA, gamma=GAMMA, acc=1.0 / (BETA * STEP**2), vel=GAMMA / (BETA * STEP))
    evaluated(engine, dx, psi)
    if regime in ("stick", "slip"):  # a force from the step before, at another place with another normal
        found = {n: getattr(engine.state, f"lumped_{n}").numpy().copy() for n in ("force", "at", "normal", "shear")}
        friction = engine.state.lumped_friction.numpy().copy()
        for array in found.values():
            array[:, 0] = array[:, 1]
        shape = found["at"][:, 0].shape
        found["at"][:, 0] += 1e-6 * rng.normal(size=shape)
        found["normal"][:, 0] += 1e-3 * rng.normal(size=shape)
        found["normal"][:, 0] /= np.linalg.norm(found["normal"][:, 0], axis=-1, keepdims=True)
        found["shear"][:, 0] *= 1.1
        across = np.cross(found["normal"][:, 0], rng.normal(size=shape))
        friction[:, 0] = 0.1 * found["force"][:, 1, :, None] * across
        for key, value in {**found, "friction": friction}.items():
            getattr(engine.state, f"lumped_{key}").assign(value)
    return engine, dx, psi


def evaluated(engine: Engine, dx: np.ndarray, psi: np.ndarray, iteration: int = 1) -> np.ndarray:
    """Residuals of the rigid coordinates."""
    engine.scratch.dx.assign(dx[None])
    engine.scratch.psi.assign(psi[None])
    engine.control(mode=int(k.DYNAMIC), run=1, moved=1, refresh=1, iteration=iteration)
    engine.graph.evaluate()
    return engine.scratch.residual.numpy()[0].copy()


@pytest.mark.parametrize(("name", "regime"), CASES)
def test_the_tangent_is_that_of_the_residuals(name: str, regime: str) -> None:
    engine, dx, psi = engine_of(name, regime)
    evaluated(engine, dx, psi)
    if regime in MOMENTS:
        moments = engine.scratch.lumped_moment.numpy()[0]
        assert set(moments["rolls_on"]) == {int(regime == "turns fast")}
        assert "laminae" in name or set(moments["pivots_on"]) == {int(regime == "turns fast")}
    else:
        regimes = engine.scratch.lumped_load.numpy()["regime"]
        number = {"none": 0, "traction": list(REGIMES).index("rub") + 1}.get(regime, list(REGIMES).index(regime) + 1)
        assert set(regimes.ravel()) == {number}
    engine.graph.assemble()
    tangent = engine.scratch.tangent.numpy()[0].copy()
    inverse = engine.scratch.psi_inverse.numpy()[0].copy()
    found = np.zeros((12, 12))
    for i in range(12):
        body, c = divmod(i, 6)
        by = DIFFERENCE if c < 3 else DIFFERENCE / ARM
        ends = []
        for sign in (1.0, -1.0):
            moved, turned = dx.copy(), psi.copy()
            if c < 3:
                moved[body, c] += sign * by
            else:
                turned[body] += inverse[body] @ (sign * by * np.eye(3)[c - 3])
            ends.append(evaluated(engine, moved, turned))
        found[:, i] = (ends[0] - ends[1]) / (2.0 * by)
    lever = np.tile(np.repeat([1.0, ARM], 3), 2)
    off = (tangent - found) / np.outer(lever, lever)
    assert np.abs(off).max() < AGREE * np.abs(found / np.outer(lever, lever)).max()


@pytest.mark.parametrize(("name", "regime"), [*((name, "slip") for name in MEETINGS), (ALL_REGIMES[0], "turns fast")])
def test_action_equals_reaction(name: str, regime: str) -> None:
    """In force, and in moment about any point."""
    engine, dx, psi = engine_of(name, regime)
    residual = -evaluated(engine, dx, psi)
    at = engine.scratch.r1.numpy()[0]
    axes = engine.scratch.axes.numpy()[0]
    wrench = residual + inertia_forces(engine)
    force = wrench.reshape(2, 6)[:, :3]
    moment = np.einsum("bij,bj->bi", axes, wrench.reshape(2, 6)[:, 3:]) + np.cross(at, force)
    size = np.abs(force).max()
    assert size > 1.0
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * size
    assert np.abs(moment.sum(axis=0)).max() < 1e-12 * size * ARM


@pytest.mark.parametrize("name", ALL_REGIMES)
def test_slip_that_has_reversed_ignores_the_bound_once(name: str) -> None:
    """Otherwise Newton's method alternates between +-mu F."""
    engine, dx, psi = engine_of(name, "slip")

    def beyond(way: float) -> float:
        """Of the bound, friction that exceeds it, after the increments `way` times those of the case."""
        evaluated(engine, way * dx, way * psi, iteration=2)
        friction = np.linalg.norm(engine.state.lumped_friction.numpy()[0, 1], axis=-1)
        force = REGIMES["slip"][0] * engine.state.lumped_force.numpy()[0, 1]
        return float((friction[force > 0.0] / force[force > 0.0]).max() - 1.0)

    assert abs(beyond(1.0)) < 1e-12
    assert beyond(-1.0) > 1.0  # that of the spring
    assert abs(beyond(-1.0)) < 1e-12


def inertia_forces(engine: Engine) -> np.ndarray:
    """What the accelerations of the trial state take (12,)."""
    m, x = engine.compiled.model, engine.scratch
    rate, turn, spin = (getattr(x, name).numpy()[0] for name in ("v1_rate", "omega1_rate", "omega1"))
    J = m.bodies.inertia.numpy()[:2]
    torque = np.einsum("bij,bj->bi", J, turn) + np.cross(spin, np.einsum("bij,bj->bi", J, spin))
    return np.hstack([m.bodies.mass.numpy()[:2, None] * rate, torque]).ravel()


@pytest.mark.parametrize("name", [name for name in MEETINGS if "laminae" not in name and "wavy" not in name])
def test_places_are_those_of_a_search(name: str) -> None:
    scene = pair(name, APPROACH)
    contact = scene.lumped_contacts[0]
    engine = Engine(scene)
    still = np.zeros((2, 3))
    engine.clock(h=STEP)
    engine.coefficients(beta=BETA, gamma=GAMMA, acc=1.0, vel=1.0)
    evaluated(engine, still, still)
    touch = engine.scratch.lumped_load.numpy()["touch"][0, 0]
    wanted = contact.nearest()
    assert abs(touch["gap"] - wanted.gap) < 1e-15
    # the search finds the least gap, its place to the root of it
    assert np.abs(touch["n"] - wanted.normal).max() < 1e-5
    assert np.abs(touch["x"] - wanted.place).max() < 2e-7
