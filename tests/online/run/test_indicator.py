"""The indicator of inertia terms: against sizes by hand, against the equations, how it scales, what it says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpffrf.model import joints, signals
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import LEVELS, TERM_NAMES, InertiaTerms, modal_forces, momentum
from warpffrf.model.scene import Scene
from warpffrf.online.compile.inertia_plan import BOUNDS, NOTICEABLE, estimate, fastest_turning, least_level
from warpffrf.online.diagnosis import inertia_indicator
from warpffrf.online.diagnosis.inertia_indicator import (
    FLAG,
    MOST_STEPS,
    TermSize,
    indicator_lines,
    recommended,
    term_sizes,
)
from warpffrf.online.history.history import BodyHistory
from warpffrf.online.run import run
from warpffrf.output.result import Result

ROUND_OFF = 1e-12
TURNED = np.array([0.5, -0.5, 0.5, 0.5])  # body axes in the world: a third of a turn about a diagonal


def terms_of(k: int, **entries: Any) -> InertiaTerms:
    """Zero terms of k modes with some entries set: J1={i: value}, J2={(i, j): value} about z, G={(i, j): value} along
    z."""
    J1, J2, G = np.zeros((k, 3, 3)), np.zeros((k, k, 3, 3)), np.zeros((k, k, 3))
    for i, value in entries.get("J1", {}).items():
        J1[i, 2, 2] = value
    for (i, j), value in entries.get("J2", {}).items():
        J2[i, j, 2, 2] = J2[j, i, 2, 2] = value
    for (i, j), value in entries.get("G", {}).items():
        G[i, j, 2], G[j, i, 2] = value, -value
    return InertiaTerms(J1, J2, G)


def moving(body: ReducedBody, terms: InertiaTerms, w: Any, q: Any, qd: Any, rotation: Any = TURNED, w_rate: Any = None):
    """A scene of one body, and its motion with body-axes angular velocity `w` (T, 3) and modes `q`, `qd`."""
    from warpffrf.model import rotation as rot

    scene = Scene()
    scene.add_body(replace(body, inertia_terms=terms), name="a", inertia="constant")
    w = np.atleast_2d(w).astype(float)
    A, T = rot.matrix(rotation), len(w)
    rate = np.zeros_like(w) if w_rate is None else np.atleast_2d(w_rate)
    motion = BodyHistory(
        position=np.zeros((T, 3)),
        rotation=np.tile(rotation, (T, 1)),
        velocity=np.zeros((T, 3)),
        angular_velocity=w @ A.T,
        modal=np.atleast_2d(q),
        angular_acceleration=rate @ A.T,
        modal_velocity=np.atleast_2d(qd),
    )
    return scene, {"a": motion}


def sizes(*args: Any, level: str = "constant", **options: Any) -> dict[str, TermSize]:
    scene, motions = moving(*args, **options)
    return {s.term: s for s in term_sizes(scene, motions, {"a": level})}


def modes(body: ReducedBody, **values: float) -> np.ndarray:
    q = np.zeros(len(body.frequencies))
    for name, value in values.items():
        q[int(name[1:])] = value
    return q


def test_sizes_by_hand(plain_body: ReducedBody) -> None:
    """One mode each: w^2 J1/(2 omega^2 q), w^2 J2/omega^2, 2 w G omega_0 q/(omega_1 omega_0 q); momentum compared with
    J0 w."""
    omega = 2.0 * np.pi * plain_body.frequencies
    w, q, rate = 300.0, 2e-5, 1.5
    spin, zero = (0.0, 0.0, w), modes(plain_body)
    J0w = plain_body.inertia[2, 2] * w
    J1 = 5.0  # kg m, far more than the roller has: less would not be noticed
    found = sizes(plain_body, terms_of(3, J1={1: J1}), spin, modes(plain_body, q0=q), zero)
    assert found["centrifugal"].on_modes == pytest.approx(0.5 * w**2 * J1 / omega[1] / (omega[0] * q), rel=ROUND_OFF)
    assert found["centrifugal"].on_momentum == 0.0
    found = sizes(plain_body, terms_of(3, J1={0: J1}), spin, modes(plain_body, q0=q), zero)
    assert found["centrifugal"].on_momentum == pytest.approx(q * J1 * w / J0w, rel=1e-6)  # J0's products are not zero
    found = sizes(plain_body, terms_of(3, J2={(0, 0): 0.7}), spin, modes(plain_body, q0=q), zero)
    assert found["deformed inertia"].on_modes == pytest.approx(0.7 * (w / omega[0]) ** 2, rel=ROUND_OFF)
    assert found["deformed inertia"].on_momentum == pytest.approx(q**2 * 0.7 * w / J0w, rel=1e-6)
    coupled = terms_of(3, G={(0, 1): 0.8})
    found = sizes(plain_body, coupled, spin, modes(plain_body, q0=q), modes(plain_body, q0=rate))
    assert found["gyroscopic"].on_modes == pytest.approx(2 * w * 0.8 * rate / omega[1] / (omega[0] * q), rel=ROUND_OFF)
    found = sizes(plain_body, coupled, spin, modes(plain_body, q0=q), modes(plain_body, q1=rate))
    assert found["gyroscopic"].on_momentum == pytest.approx(0.8 * q * rate / J0w, rel=1e-6)
    still = (0.0, 0.0, 0.0)
    found = sizes(plain_body, coupled, still, modes(plain_body, q0=q), zero, w_rate=(0.0, 0.0, 5e4))
    assert found["gyroscopic"].on_modes == pytest.approx(5e4 * 0.8 / (omega[0] * omega[1]), rel=ROUND_OFF)  # Euler


def test_sizes_agree_with_the_equations(plain_body: ReducedBody) -> None:
    """Random motion of several steps: each term as the difference of two levels of `warpffrf.model.reduced.inertia`."""
    rng = np.random.default_rng(5)
    m, T = len(plain_body.frequencies), 7
    k = m - 1
    J1, J2, G = rng.normal(size=(k, 3, 3)), rng.normal(size=(k, k, 3, 3)), rng.normal(size=(k, k, 3))
    J2 = J2 + J2.transpose(1, 0, 2, 3)
    terms = InertiaTerms(J1 + J1.transpose(0, 2, 1), J2 + J2.transpose(0, 1, 3, 2), G - G.transpose(1, 0, 2))
    w, rate = 100.0 * rng.normal(size=(T, 3)), 1e4 * rng.normal(size=(T, 3))
    q, qd = 1e-4 * rng.normal(size=(T, m)), rng.normal(size=(T, m))
    found = sizes(plain_body, terms, w, q, qd, w_rate=rate)
    omega, J0 = 2.0 * np.pi * plain_body.frequencies, plain_body.inertia
    strain = np.linalg.norm(omega * q, axis=1).max()
    turning = np.linalg.norm(w @ J0, axis=1).max()
    turning = max(turning, np.sqrt(0.5 * np.trace(J0)) * np.linalg.norm(qd, axis=1).max())
    differences = {
        "deformed inertia": ("full", "gyroscopic"), "gyroscopic": ("full", "deformed"), "centrifugal": ("deformed", ""),
    }  # fmt: skip
    for name, (more, less) in differences.items():
        f, dL = np.zeros((T, m)), np.zeros((T, 3))
        for t in range(T):
            for level, sign in ((more, 1.0), (less or "constant", -1.0)):
                f[t] += sign * modal_forces(terms, q[t], qd[t], w[t], rate[t], level)
                dL[t] += sign * momentum(terms, J0, q[t], qd[t], w[t], level)
            if not less:  # "deformed" holds J1 and J2: take J2 off
                for level, sign in (("full", -1.0), ("gyroscopic", 1.0)):
                    f[t] += sign * modal_forces(terms, q[t], qd[t], w[t], rate[t], level)
                    dL[t] += sign * momentum(terms, J0, q[t], qd[t], w[t], level)
        assert found[name].on_modes == pytest.approx(np.linalg.norm(f / omega, axis=1).max() / strain, rel=1e-9)
        assert found[name].on_momentum == pytest.approx(np.linalg.norm(dL, axis=1).max() / turning, rel=1e-9)


def test_sizes_grow_with_the_speed_as_they_should(plain_body: ReducedBody) -> None:
    """Twice the speed: four times the load and the softening, twice the Coriolis force; the axes of the world do not
    matter."""
    terms = terms_of(3, J1={0: 0.3}, J2={(0, 0): 0.5, (0, 1): 0.1}, G={(0, 1): 0.8, (0, 2): 0.2})
    q, qd = modes(plain_body, q0=1e-5, q1=2e-5), modes(plain_body, q0=1.0, q2=0.5)
    slow, fast = (sizes(plain_body, terms, (0.0, 0.0, w), q, qd) for w in (400.0, 800.0))
    upright = sizes(plain_body, terms, (0.0, 0.0, 400.0), q, qd, rotation=np.array([0.0, 0.0, 0.0, 1.0]))
    for name, factor in zip(TERM_NAMES, (4.0, 4.0, 2.0), strict=True):
        assert fast[name].on_modes == pytest.approx(factor * slow[name].on_modes, rel=1e-9)
        assert upright[name].on_modes == pytest.approx(slow[name].on_modes, rel=1e-9)
        assert slow[name].on_modes > 0.0


def test_a_load_on_a_still_body(plain_body: ReducedBody) -> None:
    """All of the deformation is left out, unless it is too small to notice; the other terms need a deformation."""
    omega = 2.0 * np.pi * plain_body.frequencies
    zero = modes(plain_body)
    w = 500.0
    limit = NOTICEABLE * np.sqrt(0.5 * np.trace(plain_body.inertia)) * omega[0] ** 2 / (0.5 * w**2)
    for share, size in ((1.01, np.inf), (0.99, 0.0)):
        terms = terms_of(2, J1={0: share * limit}, J2={(0, 0): 0.5}, G={(0, 1): 0.5})
        found = sizes(plain_body, terms, (0.0, 0.0, w), zero, zero)
        assert found["centrifugal"].size == size
        assert found["deformed inertia"].size == found["gyroscopic"].size == 0.0
        lines = indicator_lines(list(found.values()), {"a": "constant"})
        assert ("centrifugal all" in lines[0] and lines[0].endswith("use inertia='deformed'")) == (size > 0.0)
        sized = estimate(terms, plain_body.inertia, omega, w)
        assert (sized["centrifugal"] > BOUNDS["centrifugal"]) == (size > 0.0)  # `auto` draws the line there, too


def test_a_body_at_rest_is_not_judged_by_noise(plain_body: ReducedBody) -> None:
    """Loaded, and as still as round-off lets it be: speeds of 1e-13 to one another are anything."""
    terms = terms_of(2, J2={(0, 0): 0.5}, G={(0, 1): 0.5})
    for turning, rate in ((1e-13, 1e-13), (1e-17, 1e-12), (1e-12, 1e-17)):
        found = sizes(plain_body, terms, (0.0, 0.0, turning), modes(plain_body, q0=1e-6), modes(plain_body, q1=rate))
        assert found["gyroscopic"].size < FLAG
        assert "use inertia" not in indicator_lines(list(found.values()), {"a": "constant"})[0]


def test_stiffening_that_is_missing() -> None:
    """Softening without the stiffening that comes with it would be worse than neither."""
    for level in ("constant", "full"):
        (line,) = indicator_lines(sized(level, 0.3, 0.05, 0.0), {"a": level})
        assert line.endswith("softens: ReductionOptions(stiffening=True) in reduce, stiffening=True in add_body")
        (line,) = indicator_lines(sized(level, 0.3, 0.05, 0.0), {"a": level}, {"a"})
        assert "stiffens" not in line


def sized(level: str, centrifugal: float, deformed: float, gyroscopic: float) -> list[TermSize]:
    values = (centrifugal, deformed, gyroscopic)
    return [TermSize("a", n, v, 0.0, kept) for n, v, kept in zip(TERM_NAMES, values, LEVELS[level], strict=True)]


@pytest.mark.parametrize(
    ("values", "level"),
    [
        ((0.0, 0.0, 0.0), "constant"),
        ((FLAG, FLAG, FLAG), "constant"),
        ((0.02, 0.0, 0.0), "deformed"),
        ((0.0, 0.02, 0.0), "deformed"),
        ((0.0, 0.0, 0.02), "gyroscopic"),
        ((0.02, 0.0, 0.02), "gyroscopic"),
        ((0.0, 0.02, 0.02), "full"),
        ((np.inf, np.inf, np.inf), "full"),
    ],
)
def test_the_least_level_that_will_do(values: tuple[float, float, float], level: str) -> None:
    assert recommended(sized("constant", *values)) == level
    assert least_level([v > FLAG for v in values]) == level


def test_what_the_report_says() -> None:
    assert indicator_lines(sized("constant", 0.312, 0.0031, 1e-4), {"a": "constant"}) == [
        "body 'a': inertia 'constant', neglected of the forces kept: centrifugal 31 %, deformed inertia 0.31 %, "
        "gyroscopic 0.01 %; use inertia='deformed'"
    ]
    assert indicator_lines(sized("full", 0.3, 0.003, 0.0), {"a": "full"}) == [
        "body 'a': inertia 'full', nothing neglected; 'deformed' is sufficient"
    ]
    assert indicator_lines(sized("deformed", 0.3, 0.003, 0.002), {"a": "deformed"}) == [
        "body 'a': inertia 'deformed', neglected of the forces kept: gyroscopic 0.2 %"
    ]
    assert indicator_lines([], {}) == []


def test_bodies_without_terms_and_runs_without_steps(plain_body: ReducedBody) -> None:
    scene, motions = moving(plain_body, terms_of(1), (0.0, 0.0, 1.0), modes(plain_body), modes(plain_body))
    scene_of_none, none = moving(plain_body, terms_of(1), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)))
    assert term_sizes(scene_of_none, none, {"a": "constant"}) == []
    bare = Scene()
    bare.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="b")
    bare.add_body(replace(plain_body, inertia_terms=None), name="a", inertia="constant")
    assert term_sizes(bare, motions, {"a": "constant", "b": "constant"}) == []


def test_a_long_run_is_looked_at_in_places(plain_body: ReducedBody, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is summed does not grow with the run; its end is looked at."""
    looked: list[np.ndarray] = []
    real = inertia_indicator._terms
    spy = lambda terms, q, *rest: (looked.append(q), real(terms, q, *rest))[1]  # noqa: E731
    monkeypatch.setattr(inertia_indicator, "_terms", spy)
    T = 20 * MOST_STEPS
    q = np.zeros((T, len(plain_body.frequencies)))
    q[-1, 0] = 1.0
    scene, motions = moving(plain_body, terms_of(2, J2={(0, 0): 1.0}), np.tile((0.0, 0.0, 1.0), (T, 1)), q, q)
    term_sizes(scene, motions, {"a": "constant"})
    assert len(looked[0]) == MOST_STEPS and looked[0][-1, 0] == 1.0


def test_a_saved_run_is_judged_alike(plain_body: ReducedBody, tmp_path: Path) -> None:
    """From the file as from the run, and the notes of the run hold it."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    scene.add_body(plain_body, name="a", inertia="constant", angular_velocity=(300.0, 900.0, 40.0))
    history = run(scene, 1e-3, step=1e-5, progress=False)
    levels = {"a": "constant"}
    found = term_sizes(scene, history.bodies, levels)
    assert set(indicator_lines(found, levels)) <= set(history.notes)
    Result(history).save(tmp_path / "run.h5")
    loaded = Result.load(tmp_path / "run.h5")
    assert term_sizes(scene, loaded.history.bodies, levels) == found
    assert set(indicator_lines(found, levels)) <= set(loaded.history.notes)


def test_turning_that_the_modes_do_not_hold(plain_body: ReducedBody) -> None:
    """A line where speed squared times what the reduction left out is both noticeable and 1 % of the deformation."""
    known = {"centrifugal": False, "centrifugal_left_out": 4e-11}
    body = replace(plain_body, report={**plain_body.report, "inertia": known})
    J = 0.5 * np.trace(body.inertia)
    for w, share, said in ((600.0, 0.0, True), (400.0, 0.0, False), (600.0, 90.0, True), (600.0, 110.0, False)):
        q = modes(body)
        q[0] = share * w**2 * known["centrifugal_left_out"] * np.sqrt(J)
        scene, motions = moving(body, terms_of(2), (0.0, 0.0, w), q, modes(body))
        lines = inertia_indicator.unheld_lines(scene, motions)
        assert len(lines) == said
        if said:
            assert (
                "'a': rotation at 600 rad/s deforms it by up to 1.4e-05" in lines[0] and "centrifugal=True" in lines[0]
            )
    known["centrifugal"] = True
    scene, motions = moving(body, terms_of(2), (0.0, 0.0, 600.0), modes(body), modes(body))
    assert inertia_indicator.unheld_lines(scene, motions)[0].endswith("reduce it with a larger inertia_modes")
    old = replace(plain_body, report={})  # a file of an earlier version
    scene, motions = moving(old, terms_of(2), (0.0, 0.0, 600.0), modes(body), modes(body))
    assert inertia_indicator.unheld_lines(scene, motions) == []


def test_only_what_turns_counts_as_turning() -> None:
    """A cylindrical joint pushed at 40 m/s turns nothing; its other coordinate does, at the speed of its drive."""
    scene = Scene()
    body = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="a", angular_velocity=(0.0, 3.0, 4.0))
    joint = scene.add(joints.Cylindrical(scene.ground, body.at((0.0, 0.0, 0.0)), axis=(0.0, 0.0, 1.0)))
    scene.add(joints.Drive(joint, signals.Constant(40.0), quantity="velocity", coordinate="translation"))
    assert fastest_turning(scene) == pytest.approx(5.0)
    scene.add(joints.Drive(joint, signals.Ramp(0.0, 70.0, duration=0.1), quantity="velocity", coordinate="rotation"))
    assert fastest_turning(scene) == pytest.approx(70.0)
