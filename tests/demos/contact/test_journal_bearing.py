"""The journal bearing, whole; its threshold against eigenvalues, its fit against motions that are known."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import journal_bearing as demo
from demos.journal_bearing import (
    CLEARANCE,
    COLUMNS,
    FILM,
    HEAVY,
    LENGTH,
    LOAD,
    MASS,
    MASSES,
    OFF,
    RADIUS,
    ROWS,
    SPEED,
    WHIRL_GROOVE,
    WHIRL_LOAD,
    WHIRL_SPEED,
    WHIRL_VISCOSITY,
    Running,
    place,
)
from references.films.elastic import ElasticJournal, State
from references.films.journal import JournalFilm
from scenes.elastic_journal import at_rest, journal

REST = 5e-3  # of the reference's figures: of the shear, 1 to 3e-3
ORBIT, REPEATED = 5e-3, 1e-3  # of the clearance; of the orbit
GIVES = 2e-3  # of the clearance
GROWTH, FREQUENCY, NO_GROWTH = 1.5e-3, 0.01, 0.02  # of the speed; of the frequency; of the mass: shear adds to K


def rest_checks(result: wf.Result, film: ElasticJournal, state: State) -> list[Check]:
    """An equilibrium compared with the reference at rest."""
    found, e, exact = result.film(FILM), place(result)[0], state.place / CLEARANCE
    peak = (film.basis.to_nodes @ state.pressure).max()
    source = "dense reference"
    return [
        Check("at rest: force of the film", float(found.force[0, 0]), HEAVY, "statics", 1e-6, "N"),
        Check("at rest: eccentricity over clearance", float(np.hypot(*e)), float(np.hypot(*exact)), source, REST),
        Check("at rest: attitude", _angle(e), _angle(exact), source, REST, "deg", float(np.degrees(1.0))),
        Check("at rest: smallest film", float(found.smallest_gap[0]), float(film.gap(state).min()), source, REST, "um",
              1e6),
        Check("at rest: peak pressure", float(found.largest_pressure[0]), float(peak), source, REST, "MPa", 1e-6),
    ]  # fmt: skip


def _angle(e: np.ndarray) -> float:
    """rad from the load."""
    return float(np.arctan2(e[1], e[0]))


@dataclass(frozen=True)
class Orbit:
    """place (T, 2) over the clearance, smallest film (T,) [m], peak pressure (T,) [Pa]."""

    place: np.ndarray
    thinnest: np.ndarray
    peak: np.ndarray


def orbit(film: ElasticJournal, degrees: float, turns: float) -> Orbit:
    """The reference under the load that turns, from rest without it. Raises RuntimeError where it fails."""
    steady, step = np.array([LOAD, 0.0]), np.radians(degrees)
    earlier, state = None, at_rest(film, LOAD).state
    states = [state]
    for k in range(1, round(360.0 * turns / degrees) + 1):
        thrown = MASS * OFF * SPEED**2 * np.array([np.cos(k * step), np.sin(k * step)])
        new, _ = film.stepped(state, steady + thrown, step / SPEED, earlier=earlier)
        if new is None:
            raise RuntimeError(f"the reference of the demo did not converge at {k * degrees:g} degrees")
        earlier, state = (state, step / SPEED), new
        states.append(state)
    return Orbit(
        np.array([s.place for s in states]) / CLEARANCE, np.array([film.gap(s).min() for s in states]),
        np.array([(film.basis.to_nodes @ s.pressure).max() for s in states]),
    )  # fmt: skip


def unbalance_checks(result: wf.Result, reference: Orbit, steps: int) -> list[Check]:
    """The run compared with the last turn, of so many steps, of the reference; and its own last turn compared with the
    one before."""
    found, e = result.film(FILM), place(result)
    end = len(reference.place)
    same, last = slice(end - steps, end), slice(-steps, None)
    apart = float(np.hypot(*(e[same] - reference.place[same]).T).max())
    across = float(np.ptp(e[last], axis=0).max())
    change = float(np.abs(e[last] - e[-2 * steps : -steps]).max())
    source = "dense reference"
    return [
        Check("unbalance: places differ by, over clearance", apart, 0.0, source, ORBIT, scale=1.0),
        Check("unbalance: smallest film of a turn", float(found.smallest_gap[same].min()),
              float(reference.thinnest[same].min()), source, 2.0 * REST, "um", 1e6),
        Check("unbalance: peak pressure of a turn", float(found.largest_pressure[same].max()),
              float(reference.peak[same].max()), source, 2.0 * REST, "MPa", 1e-6),
        Check("unbalance: third turn off the second", change, 0.0, "synchronous, over the orbit", REPEATED,
              scale=across),
    ]  # fmt: skip


@dataclass(frozen=True)
class Linear:
    """A rigid film about rest: place (2,) over the clearance, stiffness and damping (2, 2) [N/m, N s/m]."""

    place: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray

    @property
    def critical(self) -> tuple[float, float]:
        """Critical mass [kg] and the frequency of whirl there [rad/s], see the demo."""
        K, C = self.stiffness, self.damping
        k = (K[0, 0] * C[1, 1] + K[1, 1] * C[0, 0] - K[0, 1] * C[1, 0] - K[1, 0] * C[0, 1]) / np.trace(C)
        square = ((K[0, 0] - k) * (K[1, 1] - k) - K[0, 1] * K[1, 0]) / np.linalg.det(C)
        return float(k / square), float(np.sqrt(square))

    def _modes(self, mass: float) -> tuple[np.ndarray, np.ndarray]:
        """Rates (4,) [1/s] and shapes (4, 4) of places and velocities, as columns."""
        by_state = np.block([[np.zeros((2, 2)), np.eye(2)], [-self.stiffness / mass, -self.damping / mass]])
        rates, shapes = np.linalg.eig(by_state)
        return rates.astype(complex), shapes.astype(complex)

    def whirl(self, mass: float) -> complex:
        """The rate [1/s] of the motion that dies out most slowly, or grows."""
        rates, _ = self._modes(mass)
        return max((complex(rate) for rate in rates if np.imag(rate) > 0.0), key=lambda rate: rate.real)

    def motion(self, mass: float, velocity: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Off rest (T, 2) [m], from rest with a `velocity` (2,) [m/s]."""
        rates, shapes = self._modes(mass)
        shares = np.linalg.solve(shapes, np.concatenate([np.zeros(2), velocity]).astype(complex))
        return np.real(np.exp(t[:, None] * rates) * shares @ shapes[:2].T)


def linear_film(groove: float = WHIRL_GROOVE) -> Linear:
    """Of the film of the whirling shaft, fed in a column, where it carries the load. Raises RuntimeError where that is
    not found."""
    film = JournalFilm(RADIUS, LENGTH, CLEARANCE, WHIRL_VISCOSITY, WHIRL_SPEED, COLUMNS, ROWS, feeds=(int(groove),))
    e, load = np.array([0.3, 0.3]) * CLEARANCE, np.array([WHIRL_LOAD, 0.0])
    for _ in range(40):
        film.state = film.steady(e)
        K, C = film.coefficients(e, film.state)
        rest = film.force(film.state) + load
        if np.abs(rest).max() < 1e-9 * WHIRL_LOAD:
            return Linear(e / CLEARANCE, K, C)
        move = np.linalg.solve(K, rest)
        e = e + move * min(1.0, 0.1 * CLEARANCE / float(np.hypot(*move)))
    raise RuntimeError("the reference of the demo did not find where the film carries the load")


def fitted(t: np.ndarray, e: np.ndarray, frequency: float) -> complex:
    """The rate [1/s] of one oscillation near `frequency` [rad/s] about any place, in motions e (T, 2) at even times.

    Samples n steps apart, a quarter of a period, of such motions obey e_(k+2n) = a e_(k+n) + b e_k + c, and the rate
    follows from the roots of z^2 - a z - b; a, b, c by least squares."""
    h = float(t[1] - t[0])
    n = max(1, round(0.5 * np.pi / (frequency * h)))
    rows = []
    for i, motion in enumerate(e.T):
        places = np.zeros((len(motion) - 2 * n, e.shape[1]))
        places[:, i] = 1.0
        rows.append(np.column_stack([motion[n:-n], motion[: -2 * n], places]))
    found = np.linalg.lstsq(np.vstack(rows), np.concatenate([motion[2 * n :] for motion in e.T]), rcond=None)[0]
    root = max(np.roots([1.0, -found[0], -found[1]]).astype(complex), key=lambda z: z.imag)
    return complex(np.log(root) / (n * h))


def whirling(film: Linear, groove: float = WHIRL_GROOVE) -> dict[str, Running]:
    """Shafts of `MASSES`, with a sideways velocity."""
    mass, frequency = film.critical
    sideways = demo.PUSH * CLEARANCE * frequency
    return {
        name: Running(WHIRL_LOAD, WHIRL_SPEED, WHIRL_VISCOSITY, groove, share * mass, sideways=sideways)
        for name, share in MASSES.items()
    }


def growth(result: wf.Result, film: Linear) -> complex:
    """The rate of whirl over the speed; what dies out fast is gone after the first turn."""
    later = result.time * WHIRL_SPEED > 2.0 * np.pi
    return fitted(result.time[later], place(result)[later], film.critical[1]) / WHIRL_SPEED


def whirl_checks(results: dict[str, wf.Result], shafts: dict[str, Running], film: Linear) -> list[Check]:
    """Runs of shafts lighter and heavier than the critical mass compared with the linear film."""
    critical, frequency = film.critical
    first = results["light"].film(FILM)
    e = place(results["light"])[0]
    straight = CLEARANCE * (1.0 - np.stack([np.cos(first.theta), np.sin(first.theta)], axis=1) @ e)
    gives = float(np.abs(first.gap[0] - straight[:, None]).max())
    found = [
        Check("whirl: eccentricity over clearance", float(np.hypot(*e)), float(np.hypot(*film.place)), "rigid film",
              REST),
        Check("whirl: attitude", _angle(e), _angle(film.place), "rigid film", REST, "deg", float(np.degrees(1.0))),
        Check("whirl: the sleeve gives by, over clearance", gives / CLEARANCE, 0.0, "rigid", GIVES, scale=1.0),
    ]  # fmt: skip
    rates = {}
    for name, shaft in shafts.items():
        exact = film.whirl(shaft.mass) / WHIRL_SPEED
        rates[name] = rate = growth(results[name], film)
        label = f"whirl, {shaft.mass:.0f} kg"
        found += [
            Check(f"{label}: growth over speed", rate.real, exact.real, "linear film", GROWTH, scale=1.0),
            Check(f"{label}: frequency over speed", rate.imag, exact.imag, "linear film", FREQUENCY),
        ]
    light, heavy = (1.0 / shafts[name].mass for name in MASSES)
    share = rates["light"].real / (rates["light"].real - rates["heavy"].real)  # of the way to the heavy one: no growth
    between = rates["light"].imag + share * (rates["heavy"].imag - rates["light"].imag)
    return [
        *found,
        Check("whirl: mass without growth", 1.0 / (light + share * (heavy - light)), critical, "Routh and Hurwitz",
              NO_GROWTH, "kg"),
        Check("whirl: frequency over speed there", between, frequency / WHIRL_SPEED, "Routh and Hurwitz", FREQUENCY),
    ]  # fmt: skip


OPPOSITE = 0.5 * demo.COLUMNS  # the column of a groove opposite the load


@pytest.fixture(scope="module")
def linear() -> Linear:
    return linear_film()


@both_sizes
def test_the_whole_demo(tmp_path: Path, linear: Linear, quick: bool) -> None:
    size = demo.QUICK if quick else demo.FULL
    unbalance, steady, light, heavy = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "journal_bearing", "steady", "light", "heavy")
    model = journal(COLUMNS, ROWS)
    shafts = {name: demo.whirling(share) for name, share in MASSES.items()}
    found = [
        *rest_checks(steady, model, at_rest(model, HEAVY).state),
        *unbalance_checks(unbalance, orbit(model, size.degrees, 1.5), round(360.0 / size.degrees)),
        *whirl_checks({"light": light, "heavy": heavy}, shafts, linear),
    ]
    assert len(found) == 18 and not missed(found)
    dies, grows = (check.computed for check in found if "growth over speed" in check.name)
    assert dies < 0.0 < grows
    assert (demo.CRITICAL, demo.WHIRL) == pytest.approx(linear.critical, rel=1e-6)


def test_a_shaft_of_the_critical_mass_neither_grows_nor_dies_out(linear: Linear) -> None:
    mass, frequency = linear.critical
    rate = linear.whirl(mass)
    assert abs(rate.real) < 1e-9 * frequency
    assert rate.imag == pytest.approx(frequency, rel=1e-9)
    assert linear.whirl(0.99 * mass).real < 0.0 < linear.whirl(1.01 * mass).real
    assert linear.stiffness[0, 1] * linear.stiffness[1, 0] < 0.0  # pushes across, round the bore


def test_the_linear_motion_obeys_its_equation(linear: Linear) -> None:
    mass, h = linear.critical[0], 1e-7
    t = 1e-3 + h * np.arange(-1, 2)
    e = linear.motion(mass, np.array([0.1, 0.2]), t)
    rate, second = (e[2] - e[0]) / (2.0 * h), (e[2] - 2.0 * e[1] + e[0]) / h**2
    forces = np.array([mass * second, linear.damping @ rate, linear.stiffness @ e[1]])
    assert np.abs(forces.sum(axis=0)).max() < 1e-4 * np.abs(forces).max()
    begin = linear.motion(mass, np.array([0.1, 0.2]), np.array([0.0, h]))
    assert begin[1] / h == pytest.approx([0.1, 0.2], rel=1e-3)


def test_the_fit_finds_rate_and_frequency() -> None:
    t, rate = np.linspace(0.0, 0.02, 301), complex(-11.0, 760.0)
    e = np.real(np.outer(np.exp(rate * t), [1.0, 0.4 - 0.7j])) + np.array([0.3, -0.2])
    assert fitted(t, e, 700.0) == pytest.approx(rate, rel=1e-9)


@pytest.mark.slow
def test_a_film_that_damps_by_a_fifth_more_is_distinguished_from_it(linear: Linear) -> None:
    body, shafts = demo.sleeve(demo.RIGID, progress=False), whirling(linear)
    results = {name: demo.turn(body, shaft, degrees=6.0, turns=3, progress=False) for name, shaft in shafts.items()}
    assert not missed(whirl_checks(results, shafts, linear))
    other = replace(linear, damping=1.2 * linear.damping)
    failed = [check.name for check in whirl_checks(results, shafts, other) if not check.passed]
    assert "whirl: mass without growth" in failed
    assert sum("growth over speed" in name for name in failed) == 2


@pytest.mark.slow
def test_voids_between_groove_and_film_let_a_lighter_shaft_whirl() -> None:
    """Of coefficients at rest it would still come to rest; with voids that move in time it grows by 0.0087."""
    film = linear_film(OPPOSITE)
    shaft = replace(whirling(film, OPPOSITE)["light"], mass=0.95 * film.critical[0])
    result = demo.turn(demo.sleeve(demo.RIGID, progress=False), shaft, degrees=6.0, turns=3, progress=False)
    assert result.status == "completed", result.message
    assert film.whirl(shaft.mass).real < -3e-3 * demo.WHIRL_SPEED
    assert growth(result, film).real == pytest.approx(8.7e-3, abs=1.5e-3)
