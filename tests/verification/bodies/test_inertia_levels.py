"""Inertia levels against closed forms, in time: a rotating bar (D1), a disc (D2), a spinning ring (D3), free flight."""

from __future__ import annotations

import numpy as np
import pytest

from demos.two_rollers import Size
from demos.two_rollers import build as two_rollers
from scenes import rotating_bar, rotating_disc, spinning_ring
from studies.bodies import free_flight
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import LEVELS, TERM_NAMES
from warpffrf.model.scene import Scene
from warpffrf.online import History, Settings, run
from warpffrf.online.compile.inertia_plan import InertiaPlan
from warpffrf.online.diagnosis.inertia_indicator import FLAG, TermSize, recommended, term_sizes

MESH_ORDER = 2.0  # of the linear cells of the bar
EXTRAPOLATED = 1e-9  # relative: two meshes or steps extrapolated, what is left is of the next order
PROMISED = 1e-6  # relative, of the limit of the reduced model
LAST = 30  # saved steps over which what is left of the spin-up is averaged
INDICATED = 0.05  # relative: the indicator is of first order in what it estimates


def used(scene: Scene) -> dict[str, str]:
    """Inertia level of each body as the compiler chooses it."""
    return {b.name: plan.level for b, plan in zip(scene.bodies, InertiaPlan.of(scene).bodies, strict=True)}


def indicated(history: History, body: str) -> dict[str, TermSize]:
    scene: Scene = history.scene  # pyright: ignore[reportAssignmentType]
    return {s.term: s for s in term_sizes(scene, history.bodies, used(scene)) if s.body == body}


@pytest.fixture(scope="module")
def bars() -> list[ReducedBody]:
    return [rotating_bar.bar(cells) for cells in (15, 30, 60)]


@pytest.fixture(scope="module")
def bar(bars: list[ReducedBody]) -> ReducedBody:
    return bars[1]


@pytest.mark.parametrize("level", LEVELS)
def test_bar_model_tends_to_the_closed_form(bars: list[ReducedBody], level: str) -> None:
    """The stationary state of the reduced model, as cells get smaller: order 2, and the limit to 1e-9."""
    e = np.array([rotating_bar.elongation(b, rotating_bar.stationary(b, level).q) for b in bars])
    exact = rotating_bar.closed_form(level)
    assert np.log2((e[:-1] - exact) / (e[1:] - exact)) == pytest.approx(MESH_ORDER, abs=0.01)
    assert (4.0 * e[2] - e[1]) / 3.0 == pytest.approx(exact, rel=EXTRAPOLATED)
    assert e[1] == pytest.approx(exact, rel=5e-6)


def test_closed_forms_of_the_bar_tell_the_levels_apart() -> None:
    """J2 makes 0.34 %, J1 a quarter; the outward motion of the centre of mass is in all of them, which makes the rest
    of the 1.6 % between the "linear" value and the exact one."""
    constant, gyroscopic, exact, linear = map(rotating_bar.closed_form, ("constant", "gyroscopic", "full", "linear"))
    assert exact == pytest.approx(1.305866e-2, rel=1e-6) and linear == pytest.approx(1.285714e-2, rel=1e-6)
    assert exact / gyroscopic - 1.0 == pytest.approx(3.42e-3, rel=1e-2)
    assert gyroscopic / constant - 1.0 > 0.3 and linear < gyroscopic < exact


def test_bar_modes_from_vibration_tend_to_the_same_limit(bar: ReducedBody) -> None:
    """Free-free modes instead of polynomials: from below, the closer the more of them."""
    limit = rotating_bar.elongation(bar, rotating_bar.stationary(bar, "full").q)
    missing = []
    for frequency in (3e3, 12e3, 40e3):
        body = rotating_bar.bar(terms=None, max_frequency=frequency)
        missing.append(1.0 - rotating_bar.elongation(body, rotating_bar.stationary(body, "full").q) / limit)
    assert 0.0 < missing[2] < missing[1] < missing[0] < 0.1
    assert missing[2] < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("level", ["constant", "gyroscopic", "deformed", "full"])
def test_bar_in_time_settles_to_second_order(bar: ReducedBody, level: str) -> None:
    """Spun up from rest and settled: compared with the stationary state of the same model, which no code of the run
    made."""
    exact = rotating_bar.elongation(bar, rotating_bar.stationary(bar, level).q)
    error = rotating_bar.settled_sequence(bar, level, (4e-5, 2e-5, 1e-5)) / exact - 1.0
    assert np.log2(error[:-1] / error[1:]) == pytest.approx(2.0, abs=0.1)
    assert abs((4.0 * error[2] - error[1]) / 3.0) < PROMISED


@pytest.mark.slow
@pytest.mark.parametrize("level", ["deformed", "full"])
def test_bar_in_time_settles_to_a_millionth(bar: ReducedBody, level: str) -> None:
    exact = rotating_bar.elongation(bar, rotating_bar.stationary(bar, level).q)
    error = rotating_bar.settled_sequence(bar, level, (1e-5, 5e-6, 2.5e-6)) / exact - 1.0
    assert np.log2(error[:-1] / error[1:]) == pytest.approx(2.0, abs=0.1)
    assert abs(error[-1]) < PROMISED


def test_indicator_on_the_bar(bar: ReducedBody) -> None:
    """At "constant" the centrifugal load is missing by about a third; without J2 the indicator says what J2 makes; in a
    steady turn there is nothing gyroscopic."""
    history = rotating_bar.spun_up(bar, "constant", 1e-4)
    found = indicated(history, "bar")
    share = rotating_bar.closed_form("gyroscopic") / rotating_bar.closed_form("constant") - 1.0
    assert found["centrifugal"].size == pytest.approx(share, rel=0.1)  # of the root of energy there, of the tip here
    assert recommended(list(found.values())) == "deformed"
    assert any(note.endswith("use inertia='deformed'") for note in history.notes)
    found = indicated(rotating_bar.spun_up(bar, "gyroscopic", 1e-4), "bar")
    share = rotating_bar.closed_form("deformed") / rotating_bar.closed_form("gyroscopic") - 1.0
    assert found["deformed inertia"].size == pytest.approx(share, rel=INDICATED)
    assert found["gyroscopic"].size < 0.1 * FLAG


@pytest.mark.slow
def test_slender_bar_buckles_without_geometric_stiffening() -> None:
    """The centrifugal forces on the bent bar outgrow its bending stiffness; the tension that would hold it is of second
    order in the displacement. With it the bar settles where the model says, and swings a little about that."""
    slender = rotating_bar.bar(side=rotating_bar.SLENDER, stiffening=True)
    motion = [np.asarray(slender.interfaces[name].modes)[:, 1] for name in ("tip", "root")]
    sideways = {}
    for stiffening in (False, True):
        history = rotating_bar.spun_up(slender, "full", 1e-4, stiffening=stiffening)
        sideways[stiffening] = history.bodies["bar"].modal @ (motion[0] - motion[1])
        if stiffening:
            assert history.status == "completed"
            expected = rotating_bar.stationary(slender, "full", stiffening=True).q
            settled = rotating_bar.elongation(slender, history.bodies["bar"].modal[-LAST:]).mean()
            assert settled == pytest.approx(rotating_bar.elongation(slender, expected), rel=0.02)
        else:
            assert history.status == "not_converged"
    assert abs(sideways[False][-1]) > 0.05 and abs(sideways[True][-1]) < 1e-3  # m, of 1 m


@pytest.mark.slow
def test_disc_displacement_and_stress() -> None:
    """D2 in plane stress: the rim to 1e-4 of the mesh, stresses by order 2 of their finite elements."""
    spins = [rotating_disc.spin(rotating_disc.disc(*mesh), "gyroscopic") for mesh in ((12, 4), (24, 8))]
    assert abs(spins[1].rim) < 2e-4 and abs(spins[1].bore) < 1e-3
    assert abs(spins[0].bore / spins[1].bore) > 4.0
    for spin in spins:
        inside = rotating_disc.PLACES > 0.03  # the row of cells at the bore is coarse compared with its radius
        assert np.abs(spin.radial_stress[inside]).max() < 0.02 and np.abs(spin.hoop_stress[inside]).max() < 0.02
    worst = [max(np.abs(s.radial_stress).max(), np.abs(s.hoop_stress).max()) for s in spins]
    assert worst[1] < 0.6 * worst[0] and worst[1] < 0.025


def test_disc_needs_the_centrifugal_load() -> None:
    """Without it nothing deforms the disc; what the deformed shape adds is w^2 over the lowest frequency squared."""
    body = rotating_disc.disc(12, 4)
    still = rotating_disc.spin(body, "constant")
    assert abs(still.grown) < 1e-15
    found = indicated(still.result.history, "disc")
    assert np.isinf(found["centrifugal"].size) and recommended(list(found.values())) == "deformed"
    linear, whole = (rotating_disc.spin(body, level) for level in ("gyroscopic", "deformed"))
    expected = (rotating_disc.SPEED / (2.0 * np.pi * body.frequencies[0])) ** 2
    assert whole.grown / linear.grown - 1.0 == pytest.approx(expected, rel=0.05)
    assert indicated(linear.result.history, "disc")["deformed inertia"].size == pytest.approx(expected, rel=0.05)


@pytest.fixture(scope="module")
def ring() -> ReducedBody:
    return spinning_ring.ring()


def test_ring_frequencies(ring: ReducedBody) -> None:
    """Thin-ring values within 0.5 %, and nearer on a finer mesh; each wave number has its pair."""
    finer = spinning_ring.ring(192)
    for n, thin in ((2, 127.935), (3, 361.854), (4, 693.823)):
        assert spinning_ring.thin_ring(n) == pytest.approx(thin, rel=1e-5)
        pairs = [b.frequencies[spinning_ring.pair(b, n)] for b in (ring, finer)]
        assert pairs[0][0] == pytest.approx(pairs[0][1], rel=1e-8)
        assert pairs[0][0] == pytest.approx(thin, rel=5e-3)
        assert abs(pairs[1][0] - thin) < 0.25 * abs(pairs[0][0] - thin)


@pytest.mark.slow
@pytest.mark.parametrize("level", ["gyroscopic", "full"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_pattern_lags_behind_the_ring(ring: ReducedBody, n: int, level: str) -> None:
    """In time: within 0.5 % of theory; compared with the eigenvalues of the same model of order 2, and to 1e-6."""
    exact = spinning_ring.exact_lag(ring, n, level)
    assert exact == pytest.approx(spinning_ring.thin_lag(n), rel=1e-3)
    rates = [spinning_ring.measured_lag(ring, n, spinning_ring.spinning(ring, n, level, h)) for h in (2e-5, 1e-5, 5e-6)]
    assert rates[-1] == pytest.approx(spinning_ring.thin_lag(n), rel=5e-3)
    error = np.array(rates) / exact - 1.0
    assert np.log2(error[:-1] / error[1:]) == pytest.approx(2.0, abs=0.1)
    assert abs((4.0 * error[2] - error[1]) / 3.0) < PROMISED


@pytest.mark.slow
def test_pattern_lags_to_a_millionth(ring: ReducedBody) -> None:
    exact = spinning_ring.exact_lag(ring, 2, "full")
    rate = spinning_ring.measured_lag(ring, 2, spinning_ring.spinning(ring, 2, "full", 2e-6))
    assert rate == pytest.approx(exact, rel=PROMISED)


@pytest.mark.parametrize("level", ["constant", "deformed"])
def test_pattern_stays_without_gyroscopic_terms(ring: ReducedBody, level: str) -> None:
    history = spinning_ring.spinning(ring, 2, level, 2e-5)
    assert abs(spinning_ring.measured_lag(ring, 2, history)) < 1e-6 * abs(spinning_ring.thin_lag(2))
    found = indicated(history, "ring")
    gamma = 2.0 * 2 / (2**2 + 1)
    expected = 2.0 * spinning_ring.SPIN * gamma / (2.0 * np.pi * ring.frequencies[0])
    assert found["gyroscopic"].size == pytest.approx(expected, rel=INDICATED)  # 10 %
    assert recommended(list(found.values())) == "gyroscopic"


@pytest.fixture(scope="module")
def soft_ring() -> ReducedBody:
    return free_flight.ring()


@pytest.mark.parametrize("level", LEVELS)
def test_angular_momentum_of_a_heavily_bent_ring(soft_ring: ReducedBody, level: str) -> None:
    """A tumbling ring with its first pair bent by 5 mm (its wall: 8 mm): momentum in space, of each level's own
    inertia, to second order."""
    scene = free_flight.ring_scene(soft_ring, level)
    q = np.zeros(len(soft_ring.frequencies))
    q[:2] = 5e-3 / np.linalg.norm(soft_ring.surface.modes[0], axis=1).max() * np.array([0.8, 0.6])
    start = spinning_ring.bent_start(scene, "ring", q)
    drift = []
    for step in (1e-4, 5e-5):
        history = run(scene, free_flight.RING_TIME, step=step, start=start, progress=False)
        assert history.status == "completed"
        assert np.abs(history.bodies["ring"].modal[1:, :2]).max() > 0.5 * np.linalg.norm(q)
        drift.append(free_flight.deviations(history, "ring")[2])
    assert drift[1] < 1e-5
    assert np.log2(drift[0] / drift[1]) == pytest.approx(2.0, abs=0.1)


def bar_at(speed: float) -> tuple[Scene, float, float]:
    return rotating_bar.bar_scene(rotating_bar.bar(), "auto", speed=speed), rotating_bar.SPIN_UP, 1e-4


def disc_at(speed: float) -> tuple[Scene, float, float]:
    scene = Scene()
    scene.add_body(rotating_disc.disc(12, 4), name="disc", damping=1.0, angular_velocity=(0.0, speed, 0.0))
    return scene, rotating_disc.DURATION, rotating_disc.STEP


def soft_ring_at(speed: float) -> tuple[Scene, float, float]:
    scene = Scene()
    scene.add_body(free_flight.ring(), name="ring", damping=0.02, angular_velocity=(0.3 * speed, 0.9 * speed, 0.0))
    return scene, 0.05, 2e-4


def rollers_at(speed: float) -> tuple[Scene, float, float]:
    """The demo on a coarse mesh, as fast as it is."""
    return two_rollers(Size(180, 4, 3), progress=False), 0.04, 4e-4


@pytest.mark.parametrize(
    ("build", "speed", "wanted"),
    [
        (bar_at, 1.0, "constant"),
        (bar_at, 100.0, "deformed"),
        (bar_at, 1000.0, "deformed"),
        (disc_at, 100.0, "constant"),
        (disc_at, 1000.0, "deformed"),
        (soft_ring_at, 0.01, "constant"),
        (soft_ring_at, 1.0, "constant"),
        (soft_ring_at, 10.0, "gyroscopic"),
        (soft_ring_at, 40.0, "full"),
        (rollers_at, 100.0, "constant"),
    ],
)
def test_auto_keeps_what_the_indicator_then_wants(build, speed: float, wanted: str) -> None:
    """`auto` may keep more than the indicator asks for after the run, not less; and the indicator asks for what the
    scene is known to need."""
    scene, duration, step = build(speed)
    start = "equilibrium" if scene.contacts else "initial"
    goes_on = Settings(gain_limit=0.0)  # the rollers bounce on their coarse mesh
    history = run(scene, duration, step=step, start=start, progress=False, settings=goes_on)
    assert history.status == "completed"
    levels = used(scene)
    for body in levels:
        own = [s for s in term_sizes(scene, history.bodies, levels) if s.body == body]
        if not own:
            continue
        assert all(s.kept for s in own if s.size > FLAG)
        assert recommended(own) == wanted
        assert [s.term for s in own] == list(TERM_NAMES)


@pytest.mark.parametrize(("spin", "flagged"), [(2.0, False), (20.0, True)])
def test_gyroscopic_terms_of_the_ring_are_flagged_from_a_known_speed_on(
    ring: ReducedBody, spin: float, flagged: bool
) -> None:
    """2 Omega gamma/omega = 1 % at 5 rad/s for two waves."""
    found = indicated(spinning_ring.spinning(ring, 2, "constant", 2e-5, spin=spin), "ring")
    assert (found["gyroscopic"].size > FLAG) == flagged
    assert (recommended(list(found.values())) == "gyroscopic") == flagged
