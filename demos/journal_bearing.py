r"""A shaft in a steel sleeve with an oil film between them: rest, unbalance, and the whirl of a shaft too heavy.

The shaft turns in the bore of a sleeve that is held outside. It moves in the plane across its axis (joint `plane`), a
drive turns it, a force presses it, and nothing but the film carries it. Everything is in the frame of the bore: angles
from the direction of the load, in the sense of rotation.

**Rest.** Under 20 kN, at 56 MPa, the sleeve gives by 2.2 um, and the film is 2.4 um thick at its thinnest.
Eccentricity, attitude, smallest film and peak are those of `references.films.elastic`, a dense reference.
It leaves out the force of the shear on the shaft, which is as small beside that of the pressure as the clearance
beside the radius, 0.1 %.

**Unbalance.** The shaft's centre of mass is beside its axis, so that m u omega^2 turns about a steady load. From rest,
the orbit closes within two turns. The reference takes the same load on a shaft without mass, whose own motion adds
m e'' = 2e-3 of the turning force, and from the same rest. Steps must be short enough for the centre
of mass, which goes around at u = 200 clearances: a step along its velocity ends u (omega h)^2/2 off, the clearance at 6
degrees, and with more of that steps are repeated.

**Whirl.** About a place of rest the film of a rigid bore is -K e - C e', with K and C (2, 2), none of them symmetric:
it pushes a shaft that is off to one side forward around the bore. A shaft of mass m without any other support moves by

    m e'' + C e' + K e = 0,         growing at the threshold by nothing,  e = a exp(i w t),  det(K - m w^2 + i w C) = 0.

With k = m w^2, the imaginary part of it, over w, and the real part are

    Cxx (Kyy - k) + Cyy (Kxx - k) - Kxy Cyx - Kyx Cxy = 0,
    (Kxx - k)(Kyy - k) - Kxy Kyx - w^2 (Cxx Cyy - Cxy Cyx) = 0,

the limit of Routh and Hurwitz: the first gives k, the second w, and the critical mass is m_c = k/w^2. A lighter shaft
comes to rest, a heavier one whirls, at w, close to half of omega, the mean speed of the oil. K and C are of
`references.films.journal`. Runs of a lighter and a heavier shaft begin at rest with a small sideways
velocity; rates of growth are fitted to them and go through zero at the critical mass. They depend on 1/m nearly
linearly. The sleeve of these runs has ten times the modulus of steel, which is rigid here.

K and C hold for all frequencies only where voids have no say in what is full. So the groove is just behind the widest
gap, and the film begins there. Behind a groove opposite the load the gap opens once more: oil goes on, with half of the
speed, in a gap that it does not fill, and the film begins where it comes to fill it. What a motion changes of the flow
at the groove comes there later, and a whirl at half of the speed is on by radians then. Such a shaft whirls from 0.88
of the mass that coefficients at rest tell of (`tests/demos/test_journal_bearing.py`).
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.films.elastic import ElasticJournal, State
from references.films.journal import JournalFilm
from studies.films.elastic_film import at_rest, journal
from warpffrf.output.plots.panels import Panel

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RIGID = wf.Material(youngs_modulus=210e10, poisson_ratio=0.3, density=7850, name="ten times as stiff")
RADIUS, WALL, LENGTH, CLEARANCE = 0.025, 0.0125, 0.025, 25e-6  # m: the bore; of the radius
COLUMNS, ROWS = 64, 9  # hats of the film around and along
SPEED, VISCOSITY = 300.0, 0.01  # rad/s, Pa s
HEAVY = 20e3  # N, at rest
LOAD, MASS, OFF = 5e3, 5.0, 5e-3  # N, kg, m: with unbalance, 2.25 kN
WHIRL_SPEED, WHIRL_VISCOSITY, WHIRL_LOAD = 1500.0, 2.5e-3, 1250.0  # rad/s, Pa s, N: fast, in thin oil, lightly loaded
MASSES = {"light": 0.85, "heavy": 1.15}  # of the critical mass
GROOVE, WHIRL_GROOVE = 0.5 * COLUMNS, 0.6875 * COLUMNS  # columns: opposite the load, 10 degrees behind the widest gap
PUSH = 0.02  # of the clearance, that the sideways velocity makes of a turn of whirl, over 2 pi
FILM = "sleeve-shaft"
REST = 5e-3  # of the reference's figures: of the shear, 1 to 3e-3
ORBIT, REPEATED = 5e-3, 1e-3  # of the clearance; of the orbit
GIVES = 2e-3  # of the clearance
GROWTH, WHIRL, CRITICAL = 1.5e-3, 0.01, 0.02  # of the speed; of the frequency; of the mass: shear adds to K


@dataclass(frozen=True)
class Size:
    """Degrees of a step and turns with unbalance, and of whirl; frames of the recording."""

    degrees: float = 5.0
    turns: int = 3
    whirl_degrees: float = 4.0
    whirl_turns: int = 5
    frames: int = 220


FULL, QUICK = Size(), Size(degrees=6.0, whirl_degrees=6.0, whirl_turns=4, frames=60)


@dataclass(frozen=True)
class Running:
    """How the shaft runs: force [N], speed [rad/s], viscosity [Pa s], the column that the groove holds, mass [kg],
    distance of its centre of mass from the axis [m], velocity at the start across the load [m/s]."""

    load: float
    speed: float = SPEED
    viscosity: float = VISCOSITY
    groove: float = GROOVE
    mass: float = MASS
    off: float = 0.0
    sideways: float = 0.0


def sleeve(material: wf.Material = STEEL, *, progress: bool = True) -> wf.ReducedBody:
    """The sleeve, cells as wide as the hats of the film."""
    mesh = wf.mesh.sleeve(RADIUS, RADIUS + WALL, LENGTH, sectors=COLUMNS, order=1, axial=ROWS - 1)
    return wf.reduce(
        mesh, material, interfaces={"outside": "rigid"}, contact={"bore": wf.surfaces.Bore()}, modes=10, cache=False,
        progress=progress,
    )  # fmt: skip


def machine(reduced: wf.ReducedBody, running: Running) -> wf.Scene:
    """The scene around a sleeve that is reduced already: bodies `sleeve`, `shaft`, joint `plane`, film
    `sleeve-shaft`."""
    scene = wf.Scene()
    outer = scene.add_body(reduced, name="sleeve")
    inertia = 0.5 * running.mass * RADIUS**2
    shaft = scene.add_rigid_body(
        running.mass, (inertia, inertia, inertia), name="shaft", center_of_mass=(running.off, 0, 0),
        position=(0.3 * CLEARANCE, 0, 0), velocity=(0, 0, -running.sideways), angular_velocity=(0, running.speed, 0),
        surfaces={"journal": wf.surfaces.Cylinder(
            radius=RADIUS - CLEARANCE, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)
        )},
    )  # fmt: skip
    axis = shaft.at((0, 0, 0))
    scene.add(wf.joints.Fixed(scene.ground, outer["outside"], axis=(0, 1, 0), name="held"))
    plane = scene.add(wf.joints.Planar(scene.ground, axis, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, wf.signals.Constant(running.speed), quantity="velocity"))
    scene.add(wf.forces.PointForce(axis, (running.load, 0, 0), name="load"))
    groove = wf.films.AxialGroove(2.0 * np.pi * running.groove / COLUMNS, 1e-4, 0.0)  # narrower than a column
    oil = wf.oils.Newtonian(running.viscosity)
    scene.add(wf.Film(outer["bore"], shaft["journal"], oil=oil, feeds=[groove], name=FILM))
    return scene


UNBALANCED = Running(LOAD, off=OFF)


def build(running: Running = UNBALANCED, *, progress: bool = True) -> wf.Scene:
    """The scene of a steel sleeve, with unbalance if nothing else is asked for."""
    return machine(sleeve(progress=progress), running)


def turn(reduced: wf.ReducedBody, running: Running, *, degrees: float, turns: int, progress: bool = True) -> wf.Result:
    """Whole turns from rest under the load."""
    step = np.radians(degrees) / running.speed
    steps = round(360.0 * turns / degrees)
    return wf.simulate(machine(reduced, running), steps * step, step=step, start="equilibrium", progress=progress)


def place(result: wf.Result) -> np.ndarray:
    """Of the shaft (T, 2), over the clearance, from where its axis is in the middle of what holds the sleeve: bent, a
    sleeve has no axis of its own."""
    return result.body("shaft").position[:, [0, 2]] * np.array([1.0, -1.0]) / CLEARANCE


# --- rest


def rest_checks(result: wf.Result, film: ElasticJournal, state: State) -> list[Check]:
    """An equilibrium beside the reference at rest."""
    found, e, exact = result.film(FILM), place(result)[0], state.place / CLEARANCE
    peak = (film.basis.to_hats @ state.pressure).max()
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


# --- unbalance


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
        np.array([(film.basis.to_hats @ s.pressure).max() for s in states]),
    )  # fmt: skip


def unbalance_checks(result: wf.Result, reference: Orbit, steps: int) -> list[Check]:
    """The run beside the last turn, of so many steps, of the reference; and its own last turn beside the one before."""
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


# --- whirl


@dataclass(frozen=True)
class Linear:
    """A rigid film about rest: place (2,) over the clearance, stiffness and damping (2, 2) [N/m, N s/m]."""

    place: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray

    @property
    def critical(self) -> tuple[float, float]:
        """Critical mass [kg] and the frequency of whirl there [rad/s], see the module."""
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


def linear(groove: float = WHIRL_GROOVE) -> Linear:
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
    sideways = PUSH * CLEARANCE * frequency
    return {
        name: Running(WHIRL_LOAD, WHIRL_SPEED, WHIRL_VISCOSITY, groove, share * mass, sideways=sideways)
        for name, share in MASSES.items()
    }


def growth(result: wf.Result, film: Linear) -> complex:
    """The rate of whirl over the speed; what dies out fast is gone after the first turn."""
    later = result.time * WHIRL_SPEED > 2.0 * np.pi
    return fitted(result.time[later], place(result)[later], film.critical[1]) / WHIRL_SPEED


def whirl_checks(results: dict[str, wf.Result], shafts: dict[str, Running], film: Linear) -> list[Check]:
    """Runs of shafts lighter and heavier than the critical mass beside the linear film."""
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
            Check(f"{label}: frequency over speed", rate.imag, exact.imag, "linear film", WHIRL),
        ]
    light, heavy = (1.0 / shafts[name].mass for name in MASSES)
    share = rates["light"].real / (rates["light"].real - rates["heavy"].real)  # of the way to the heavy one: no growth
    between = rates["light"].imag + share * (rates["heavy"].imag - rates["light"].imag)
    return [
        *found,
        Check("whirl: mass without growth", 1.0 / (light + share * (heavy - light)), critical, "Routh and Hurwitz",
              CRITICAL, "kg"),
        Check("whirl: frequency over speed there", between, frequency / WHIRL_SPEED, "Routh and Hurwitz", WHIRL),
    ]  # fmt: skip


# --- what is drawn


@dataclass(frozen=True)
class Round(Panel):
    """A panel in which a circle is round."""

    def draw(self, ax: object) -> None:
        """Draw on matplotlib axes."""
        super().draw(ax)
        axes: Any = ax
        axes.set_aspect("equal")


def panels(
    results: dict[str, wf.Result], rest: tuple[ElasticJournal, State], reference: Orbit, shafts: dict[str, Running],
    film: Linear,
) -> list:  # fmt: skip
    """Pressure at rest, the orbit, its film, and both motions of whirl."""
    steady = results["steady"].film(FILM)
    model, state = rest
    middle, order = ROWS // 2, np.argsort(np.mod(steady.theta + np.pi, 2.0 * np.pi))
    around = np.degrees(np.mod(steady.theta + np.pi, 2.0 * np.pi) - np.pi)[order]
    exact = (model.basis.to_hats @ state.pressure).reshape(COLUMNS, ROWS)
    run = results["unbalance"]
    e, turns = place(run), run.time * SPEED / (2.0 * np.pi)
    circle = np.linspace(0.0, 2.0 * np.pi, 121)
    then = np.arange(len(reference.place)) * turns[1]
    moving, exactly = {}, {}
    for name, shaft in shafts.items():
        result, push = results[name], np.array([0.0, shaft.sideways])
        of_whirl = result.time * WHIRL_SPEED / (2.0 * np.pi)
        off = film.motion(shaft.mass, push, result.time) / CLEARANCE
        moving[f"{shaft.mass:.0f} kg"] = of_whirl, place(result)[:, 0] - place(result)[0, 0]
        exactly[f"linear, {shaft.mass:.0f} kg"] = of_whirl, off[:, 0]
    return [
        Panel("Pressure in the middle at rest, 20 kN", "angle from the load [deg]", "[MPa]",
              {"run": (around, steady.pressure[0, order, middle] / 1e6)},
              {"dense reference": (around, exact[order, middle] / 1e6)}),
        Round("Unbalance: the shaft in the clearance circle", "along the load, over clearance", "across it",
              {"run": (e[:, 0], e[:, 1]), "clearance": (np.cos(circle), np.sin(circle))},
              {"dense reference": (reference.place[:, 0], reference.place[:, 1])}),
        Panel("Unbalance: smallest film", "turns", "[um]", {"run": (turns, run.film(FILM).smallest_gap * 1e6)},
              {"dense reference": (then, reference.thinnest * 1e6)}),
        Panel("Whirl after a push: off rest along the load", "turns", "over clearance", moving, exactly),
    ]  # fmt: skip


def main(out: str | Path = "out/journal_bearing", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write journal_bearing.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went
    well.

    Those are of the unbalance; rest and the motions of whirl are in journal_bearing.steady.h5, .light.h5 and .heavy.h5.
    quick: longer steps, fewer turns. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    steel, rigid = sleeve(progress=progress), sleeve(RIGID, progress=progress)
    log.info("journal bearing: at rest, then %d turns with unbalance", size.turns)
    results = {
        "unbalance": turn(steel, UNBALANCED, degrees=size.degrees, turns=size.turns, progress=progress),
        "steady": wf.equilibrium(machine(steel, Running(HEAVY))),
    }
    film = linear()
    shafts = whirling(film)
    for name, shaft in shafts.items():
        log.info("journal bearing: a push, %.0f kg", shaft.mass)
        degrees, turns = size.whirl_degrees, size.whirl_turns
        results[name] = turn(rigid, shaft, degrees=degrees, turns=turns, progress=progress)
    for name, result in results.items():
        if result.status != "completed":
            log.error("the run '%s' ended early, %s: %s", name, result.status, result.message)
            return 1
    log.info("journal bearing: the reference, a turn and a half with unbalance")
    model = journal(COLUMNS, ROWS)
    rest, reference = at_rest(model, HEAVY).state, orbit(model, size.degrees, 1.5)
    checks = [
        *rest_checks(results["steady"], model, rest),
        *unbalance_checks(results["unbalance"], reference, round(360.0 / size.degrees)),
        *whirl_checks(results, shafts, film),
    ]
    drawn = panels(results, (model, rest), reference, shafts, film)
    return finish(folder / "journal_bearing", results, checks, drawn, frames=size.frames)
