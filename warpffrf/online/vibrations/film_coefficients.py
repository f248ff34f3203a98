r"""Stiffness and damping of an oil film about a state, and the mass above which a rotor on it whirls.

With its unknowns x, pressures where it is full and cavity fractions elsewhere, a film is linear for small motions
(`film_modes`). Displacements c of the inner body against the outer one along the film's directions e_0, e_1,
`c exp(lambda t)`, change x by -X(lambda) c and require the force T(lambda) c on the inner body,

    X(lambda) = (J_0 + lambda J_1)^-1 (B_0 + lambda B_1),      T(lambda) = -F_c + F_x X(lambda),

F the force of the film, shear included, of which the kernels evaluate the differences along c and along the columns of
X. J_1 contains the rate at which cavities fill, which oil that is conserved requires: pressures and cavities follow
the motion with a delay, and so

    K = Re T(i w),      C = Im T(i w)/w,      slow motions:  K = T(0),  C = T'(0)

depend on the frequency w of the motion, where the film has cavities. Local deformations of the walls are included,
global modes keep their values. Neglected is what the velocity of the motion itself adds to the shear.

**Whirl.** A mass m that the film alone carries moves with constant amplitude at w where m w^2 is an eigenvalue of
T(i w), and hence real. The eigenvalue with the smaller imaginary part crosses the real axis at the whirl; of several
crossings that of the smallest mass is the threshold. They are sought up to 1.2 times the rotational speed. For K and C
that do not depend on w this is the criterion of Routh and Hurwitz.

**Grid error.** As in `diagnosis.film_grid`, at the gap of the state the forces of the film with nodes of the grid, on
twice the rows and on twice the columns are compared, here their central differences for small displacements and
velocities of the walls; 4/3 of the change is the error. With the change dT of T in all motions, of a pad also its
tilts b, along with those a of the shaft, the stiffness of pads that follow, T_aa - T_ab T_bb^-1 T_ba, changes by

    [1, -T_ab T_bb^-1] dT [1; -T_bb^-1 T_ba],

summed with its sign over the pads, whose grids err to the same side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import GROUND_INDEX
from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.scene import Scene
from warpffrf.online.checkpoint import is_dynamic, off_end_of, restore, turned_of
from warpffrf.online.diagnosis.film_grid import OF_CHANGE, film_figures
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.vibrations.film_modes import FilmResponse
from warpffrf.online.vibrations.film_system import GAP_STEP, FilmState, FilmSystem, film_systems, smallest_gap
from warpffrf.online.vibrations.linearise import Probe
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf_kernels.films.sampling import FORCE

Array = np.ndarray
FASTEST, PLACES = 1.2, 12  # of the speed: whirl is at about half of it; rates between zero and there
SAME = 1e-7  # of the speed
UNKNOWN = np.full((2, 2), np.nan), np.full((2, 2), np.nan)
SLOWEST = 1e-3  # of the speed: a slow motion, where pads that follow it have no other derivative
LEAST = 1.0  # Pa, of a film without pressure
WRENCH = [0, 1, 2, 6, 7, 8]  # of `film_figures`
TURNS = 1e-9  # of the speed of the other body: the first one rests


@dataclass(frozen=True)
class FilmCoefficients:
    """Small motions of the inner body of a film against the outer one, along e_0 and e_1 of the film: the force that
    causes a displacement e at the frequency of the motion is `stiffness` e + `damping` e'.

    stiffness (2, 2) N/m, damping (2, 2) N s/m; stiffness_error, damping_error (2, 2): what finer grids of the film,
    of a bearing of all its films, change, estimated, NaN in motion and with quadrature "reduced". critical_mass [kg]:
    above it a rigid mass that the film alone carries whirls, inf if none does; whirl_frequency [Hz] of that motion,
    whirl_ratio of it to the rotational speed; NaN without whirl.
    """

    stiffness: Array
    damping: Array
    stiffness_error: Array
    damping_error: Array
    critical_mass: float
    whirl_frequency: float
    whirl_ratio: float


class _Motions:
    """Small motions of a film, the `index`-th of the scene, at the state of `probe`: of the inner body along e_0 and
    e_1, and of the first body by the `tilts` (n, 6), translations and rotations of its user frame, world, against a
    stiffness [N m/rad]."""

    def __init__(self, probe: Probe, index: int, tilts: Array, stiffness: float, system: FilmSystem) -> None:
        self.probe, self.engine, self.index = probe, probe.engine, index
        film = self.engine.scene.films[index]
        at_rest = np.zeros(probe.count)
        probe.place(at_rest, at_rest, at_rest)
        a = film.a.body
        A = rot.matrix(probe.base["p"][0, a.index])
        self.frame = A @ film.a.surface.shape.frame[:2].T  # (3, 2) e_0, e_1, world
        self.own = slice(6 * a.index, 6 * a.index + 6)
        self.ways = np.zeros((probe.count, 2 + len(tilts)))
        self.ways[self.own][:3, :2] = -self.frame  # the inner body moves as the outer one does backwards
        for k, tilt in enumerate(tilts, start=2):
            self.ways[self.own][:, k] = *(tilt[:3] + np.cross(tilt[3:], A @ a.center_of_mass)), *(A.T @ tilt[3:])
        M = np.diag([a.mass] * 3 + [0.0] * 3)
        M[3:, 3:] = a.inertia
        by_tilt = self.ways[self.own] * (np.arange(2 + len(tilts)) >= 2)
        self.M, self.held = by_tilt.T @ M @ by_tilt, np.diag([0.0, 0.0, *(stiffness,) * len(tilts)])
        self.gap = smallest_gap(self.engine)
        self.response = FilmResponse(system, self.ways, np.zeros_like(self.ways))
        self.of = FilmState(self.engine, index)
        self.largest = float(np.abs(probe.base["film_pressure"]).max())
        self.by_place = self._forces(self.ways, np.zeros((len(self.of.full), self.ways.shape[1])), GAP_STEP * self.gap)

    def at(self, rate: float) -> Array:
        """T(i rate) (ways, ways) [N/m], with the inertia of the first body in its tilts."""
        X = self.response.unknowns(1j * rate)[0]
        T = -self.by_place + self._by_film(np.real(X)) + 1j * self._by_film(np.imag(X))
        return T - rate**2 * self.M + self.held

    def slow(self) -> tuple[Array, Array]:
        """T(0) [N/m] and T'(0) [N s/m]."""
        X, X_rate = self.response.unknowns(0.0)
        return -self.by_place + self._by_film(X), self._by_film(X_rate)

    def on_finer_grids(self) -> Array | None:
        """What finer grids change of K [N/m] and C [N s/m] (2, ways, ways); None where no finer film was found."""
        film, move = self.engine.scene.films[self.index], GAP_STEP * self.gap
        if film.quadrature != "full":
            return None
        self.engine.put_back(self.probe.base)
        at_rest = np.zeros(self.probe.count)
        self.probe.place(at_rest, at_rest, at_rest)
        turn = rot.matrix(self.probe.base["p"][0, film.a.body.index])
        ways = np.concatenate([turn.T @ self.ways[self.own][:3], self.ways[self.own][3:]])  # (6, ways) of A's axes
        forces = [
            [
                [film_figures(self.engine, self.index, film, by, (sign * move * way, order)) for sign in (1.0, -1.0)]
                for order in (0, 1) for way in ways.T
            ]
            for by in ((1, 1), (1, 2), (2, 1))
        ]  # fmt: skip
        if any(found is None for grid in forces for pair in grid for found in pair):
            return None
        own, rows, columns = np.array(forces, dtype=float)[..., WRENCH] @ ways  # (orders and ways, signs, ways)
        change = OF_CHANGE * (rows + columns - 2.0 * own)
        slopes = -(change[:, 0] - change[:, 1]) / (2.0 * move)
        return slopes.reshape(2, ways.shape[1], ways.shape[1]).transpose(0, 2, 1)

    def _by_film(self, x: Array) -> Array:
        """F_x x (ways, columns)."""
        found = np.zeros((self.ways.shape[1], x.shape[1]))
        for k, column in enumerate(x.T):
            full = float(np.abs(column[self.of.full]).max(initial=0.0)) / max(self.largest, LEAST)
            void = float(np.abs(column[~self.of.full]).max(initial=0.0)) / self.gap
            if max(full, void) > 0.0:
                step = GAP_STEP / max(full, void)
                found[:, k : k + 1] = self._forces(np.zeros((len(self.ways), 1)), column[:, None], step)
        return found

    def _forces(self, ways: Array, x: Array, step: float) -> Array:
        """Derivatives (ways, columns) of the force of the film on the first body, along its ways, with respect to
        displacements `ways` of all bodies and changes `x` of the film's unknowns, by central differences."""
        at_rest, base = np.zeros(len(ways)), self.probe.base
        kept = {name: base[name] for name in ("film_pressure", "film_void", "film_asperity")}
        functions, nodes = (self.of.spans[name] for name in ("function", "node"))
        oil, rough = len(self.of.free), self.of.rough
        found = []
        for way, change in zip(ways.T, x.T, strict=True):
            ends = []
            for sign in (step, -step):
                pressure, void, asperity = (values.copy() for values in kept.values())
                pressure[0, 1, functions][self.of.free] += sign * np.where(self.of.is_void, 0.0, change[:oil])
                void[0, 1, functions][self.of.free] += sign * np.where(self.of.is_void, change[:oil], 0.0)
                asperity[0, 1, nodes][:rough] += sign * change[oil:]
                base.update(film_pressure=pressure, film_void=void, film_asperity=asperity)
                self.probe.place(sign * way, at_rest, at_rest)
                ends.append(self.engine.scratch.film_sums.numpy()[0, self.index, int(FORCE) : int(FORCE) + 6].copy())
            found.append(self.ways[self.own].T @ (ends[0] - ends[1]) / (2.0 * step))
        base.update(kept)
        return np.stack(found, axis=1)


class _Bearing:
    """Films of one journal, by pads that follow its motion, and whose directions e_0, e_1 are those of the first."""

    def __init__(
        self, scene: Scene, names: list[str], pivots: list[Array], stiffness: float, history: History, label: str
    ) -> None:
        films = [scene.film(name) for name in names]
        for film in films:
            if film.clearance() is None:
                raise InputError(f"{label}: they are those of a shaft in a bore, and {film.a.label} has no clearance")
        self.speed = _speed(films[0].b.body, history)
        for film in films:
            if not len(pivots) and _speed(film.a.body, history) > TURNS * self.speed:
                raise InputError(
                    f"{label}: the body of {film.a.label} rotates, and the grid of the film with it; name the surface "
                    "that does not rotate first, Film(bore, journal, ...)"
                )
        state = history.checkpoint
        engine = Engine(scene, turned=turned_of(state, scene), off_end=off_end_of(state))
        restore(engine, state, 1.0, label)
        probe = Probe(engine)
        at_rest = np.zeros(probe.count)
        probe.settle_windows()
        probe.place(at_rest, at_rest, at_rest, first=True)
        systems = film_systems(engine, probe.count)
        free = pivots or [np.zeros((0, 6))] * len(films)
        indices = [scene.films.index(film) for film in films]
        self.parts = [_Motions(probe, i, tilts, stiffness, systems[i]) for i, tilts in zip(indices, free, strict=True)]

    def at(self, rate: float) -> Array:
        """T(i rate) (2, 2) of all films, whose first bodies tilt as films and inertia have it."""
        return sum((_reduced(part.at(rate)) for part in self.parts), np.zeros((2, 2), complex))

    def matrices(self, rate: float) -> tuple[Array, Array]:
        """K [N/m] and C [N s/m] (2, 2)."""
        if rate == 0.0 and all(part.ways.shape[1] == 2 for part in self.parts):
            K, C = zip(*(part.slow() for part in self.parts), strict=True)
            return sum(K), sum(C)  # pyright: ignore[reportReturnType]
        rate = self.in_motion(rate)
        T = self.at(rate)
        return np.real(T), np.imag(T) / rate

    def in_motion(self, rate: float) -> float:
        """[rad/s], of a slow motion in place of none."""
        return rate or SLOWEST * max(self.speed, 1.0)


def _reduced(T: Array) -> Array:
    """(2, 2) with the other motions free of force."""
    own, to, fro, free = T[:2, :2], T[:2, 2:], T[2:, :2], T[2:, 2:]
    return own - to @ np.linalg.solve(free, fro)


@WARP_LOCK
def film_coefficients(scene: Scene, name: str, history: History, frequency: float) -> FilmCoefficients:
    """Those of the film called `name` at the last state of `history`, for motions of `frequency` [Hz]. Raises
    `InputError` for a film without clearance, a first body that rotates, and a state that cannot be linearised."""
    alone = _Bearing(scene, [name], [], 0.0, history, f"film {name!r}: coefficients")
    return _coefficients(alone, history, frequency)


@WARP_LOCK
def bearing_coefficients(scene: Scene, name: str, history: History, frequency: float | None) -> FilmCoefficients:
    """Those of the journal bearing called `name`, whose pads follow the motion; frequency None: that of the shaft's
    rotation. Raises `InputError` for an unknown name, and as `film_coefficients`."""
    known = {bearing.name: bearing for bearing in scene.journal_bearings}
    if name not in known:
        raise unknown_name("journal bearing", name, known)
    bearing, tilts = known[name], []
    for joint in bearing.pivots:
        arm, axis = joint.b.world_point() - joint.b.body.position, bearing.place.axis  # pads turn by little
        tilts.append(np.concatenate([-np.cross(axis, arm), axis])[None])
    names, label = [film.name for film in bearing.films], f"bearing {name!r}: coefficients"
    found = _Bearing(scene, names, tilts, bearing.tilt_stiffness, history, label)
    return _coefficients(found, history, found.speed / (2.0 * np.pi) if frequency is None else frequency)


def _coefficients(bearing: _Bearing, history: History, frequency: float) -> FilmCoefficients:
    K, C = bearing.matrices(2.0 * np.pi * frequency)
    mass, whirl = _threshold(bearing)
    errors = UNKNOWN
    if not is_dynamic(history.checkpoint):
        errors = _grid_errors(bearing, 2.0 * np.pi * frequency)
    ratio = whirl / bearing.speed if bearing.speed > 0.0 else np.nan
    return FilmCoefficients(K, C, *errors, mass, whirl / (2.0 * np.pi), ratio)


def _speed(body: Any, history: History) -> float:
    """Angular speed [rad/s]; at an equilibrium, where walls slide with their initial velocities, that of the start."""
    if body.index == GROUND_INDEX:
        return 0.0
    moves = is_dynamic(history.checkpoint)
    return float(np.linalg.norm(history.bodies[body.name].angular_velocity[-1] if moves else body.angular_velocity))


def _threshold(bearing: _Bearing) -> tuple[float, float]:
    """Critical mass [kg] and rate of whirl [rad/s]; inf and NaN if no mass whirls."""
    speed = bearing.speed

    def least_damped(rate: float) -> complex:
        """Eigenvalue [N/m] of T."""
        values = np.linalg.eigvals(bearing.at(rate))
        return values[np.argmin(values.imag)]

    rates = np.linspace(0.0, FASTEST * speed, PLACES + 1)[1:] if speed > 0.0 else np.zeros(0)
    damping = [least_damped(rate).imag for rate in rates]
    found = [(np.inf, np.nan)]
    for i in np.flatnonzero(np.diff(np.sign(damping))):
        root: Any = brentq(lambda w: least_damped(float(w)).imag, rates[i], rates[i + 1], xtol=SAME * speed)
        rate = float(root)
        mass = least_damped(rate).real / rate**2
        if mass > 0.0:
            found.append((float(mass), rate))
    return min(found)


def _grid_errors(bearing: _Bearing, rate: float) -> tuple[Array, Array]:
    """Errors (2, 2) of stiffness and damping at `rate` [rad/s]; NaN where no finer film was found."""
    rate, found = bearing.in_motion(rate), np.zeros((2, 2), complex)
    for part in bearing.parts:
        change = part.on_finer_grids()
        if change is None:
            return UNKNOWN
        T = part.at(rate)
        to, fro, free = T[:2, 2:], T[2:, :2], T[2:, 2:]
        left = np.hstack([np.eye(2), -np.linalg.solve(free.T, to.T).T])
        right = np.vstack([np.eye(2), -np.linalg.solve(free, fro)])
        found += left @ (change[0] + 1j * rate * change[1]) @ right
    return np.abs(np.real(found)), np.abs(np.imag(found)) / rate
