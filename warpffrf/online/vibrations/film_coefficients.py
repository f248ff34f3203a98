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
velocities of the wall; 4/3 of the change is the error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import GROUND_INDEX
from warpffrf.model.errors import InputError
from warpffrf.model.films import Film
from warpffrf.model.scene import Scene
from warpffrf.online.checkpoint import is_dynamic, off_end_of, restore, turned_of
from warpffrf.online.diagnosis.film_grid import OF_CHANGE, film_figures
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.vibrations.film_modes import FilmResponse
from warpffrf.online.vibrations.film_system import GAP_STEP, FilmState, film_systems, smallest_gap
from warpffrf.online.vibrations.linearise import Probe
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf_kernels.films.sampling import FORCE

Array = np.ndarray
FASTEST, PLACES = 1.2, 12  # of the speed: whirl is at about half of it; rates between zero and there
SAME = 1e-7  # of the speed
UNKNOWN = np.full((2, 2), np.nan), np.full((2, 2), np.nan)
LEAST = 1.0  # Pa, of a film without pressure
TURNS = 1e-9  # of the speed of the other body: the first one rests


@dataclass(frozen=True)
class FilmCoefficients:
    """Small motions of the inner body of a film against the outer one, along e_0 and e_1 of the film: the force that
    causes a displacement e at the frequency of the motion is `stiffness` e + `damping` e'.

    stiffness (2, 2) N/m, damping (2, 2) N s/m; stiffness_error, damping_error (2, 2): what finer grids of the film
    change, estimated, NaN in motion and with quadrature "reduced". critical_mass [kg]: above it a rigid mass that the
    film alone carries whirls, inf if none does; whirl_frequency [Hz] of that motion, whirl_ratio of it to the
    rotational speed; NaN without whirl.
    """

    stiffness: Array
    damping: Array
    stiffness_error: Array
    damping_error: Array
    critical_mass: float
    whirl_frequency: float
    whirl_ratio: float


class _Motions:
    """Small motions of a film, the `index`-th of the scene, at the present state of `engine`."""

    def __init__(self, engine: Engine, index: int) -> None:
        self.engine, self.index, film = engine, index, engine.scene.films[index]
        self.probe = probe = Probe(engine)
        at_rest = np.zeros(probe.count)
        probe.settle_windows()
        probe.place(at_rest, at_rest, at_rest, first=True)
        body = film.a.body.index
        self.frame = rot.matrix(probe.base["p"][0, body]) @ film.a.surface.shape.frame[:2].T  # (3, 2) e_0, e_1, world
        self.ways = np.zeros((probe.count, 2))
        self.ways[6 * body : 6 * body + 3] = -self.frame  # the inner body moves as the outer one does backwards
        self.gap = smallest_gap(engine)
        self.response = FilmResponse(film_systems(engine, probe.count)[index], self.ways, np.zeros_like(self.ways))
        self.of = FilmState(engine, index)
        self.largest = float(np.abs(probe.base["film_pressure"]).max())
        unknowns = len(self.of.full)
        self.by_place = self._forces(self.ways, np.zeros((unknowns, 2)), GAP_STEP * self.gap)

    def at(self, rate: float) -> Array:
        """T(i rate) (2, 2) [N/m]."""
        X = self.response.unknowns(1j * rate)[0]
        return -self.by_place + self._by_film(np.real(X)) + 1j * self._by_film(np.imag(X))

    def slow(self) -> tuple[Array, Array]:
        """T(0) [N/m] and T'(0) [N s/m]."""
        X, X_rate = self.response.unknowns(0.0)
        return -self.by_place + self._by_film(X), self._by_film(X_rate)

    def _by_film(self, x: Array) -> Array:
        """F_x x (2, columns)."""
        size = max(float(np.abs(x[self.of.full]).max(initial=0.0)) / max(self.largest, LEAST),
                   float(np.abs(x[~self.of.full]).max(initial=0.0)) / self.gap)  # fmt: skip
        return self._forces(np.zeros_like(self.ways), x, GAP_STEP / size) if size > 0.0 else np.zeros((2, x.shape[1]))

    def _forces(self, ways: Array, x: Array, step: float) -> Array:
        """Derivatives (2, columns) of the force of the film on the inner body, along e_0 and e_1, with respect to
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
                ends.append(-self.engine.scratch.film_sums.numpy()[0, self.index, int(FORCE) : int(FORCE) + 3])
            found.append(self.frame.T @ (ends[0] - ends[1]) / (2.0 * step))
        base.update(kept)
        return np.stack(found, axis=1)


@WARP_LOCK
def film_coefficients(scene: Scene, name: str, history: History, frequency: float) -> FilmCoefficients:
    """Those of the film called `name` at the last state of `history`, for motions of `frequency` [Hz]. Raises
    `InputError` for a film without clearance, a first body that rotates, and a state that cannot be linearised."""
    film, label = scene.film(name), f"film {name!r}: coefficients"
    if film.clearance() is None:
        raise InputError(f"{label}: they are those of a shaft in a bore, and {film.a.label} has no clearance")
    speed = _speed(film.b.body, history)
    if _speed(film.a.body, history) > TURNS * speed:
        raise InputError(
            f"{label}: the body of {film.a.label} rotates, and the grid of the film with it; name the surface that "
            "does not rotate first, Film(bore, journal, ...)"
        )
    state, index = history.checkpoint, scene.films.index(film)
    engine = Engine(scene, turned=turned_of(state, scene), off_end=off_end_of(state))
    restore(engine, state, 1.0, label)
    motions = _Motions(engine, index)
    K, C = motions.slow()
    if frequency > 0.0:
        rate = 2.0 * np.pi * frequency
        T = motions.at(rate)
        K, C = np.real(T), np.imag(T) / rate
    mass, whirl = _threshold(motions, speed)
    errors = UNKNOWN
    if film.quadrature == "full" and not is_dynamic(state):
        errors = _grid_errors(motions, film)
    ratio = whirl / speed if speed > 0.0 else np.nan
    return FilmCoefficients(K, C, *errors, mass, whirl / (2.0 * np.pi), ratio)


def _speed(body: Any, history: History) -> float:
    """Angular speed [rad/s]; at an equilibrium, where walls slide with their initial velocities, that of the start."""
    if body.index == GROUND_INDEX:
        return 0.0
    moves = is_dynamic(history.checkpoint)
    return float(np.linalg.norm(history.bodies[body.name].angular_velocity[-1] if moves else body.angular_velocity))


def _threshold(motions: _Motions, speed: float) -> tuple[float, float]:
    """Critical mass [kg] and rate of whirl [rad/s]; inf and NaN if no mass whirls."""

    def least_damped(rate: float) -> complex:
        """Eigenvalue [N/m] of T."""
        values = np.linalg.eigvals(motions.at(rate))
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


def _grid_errors(motions: _Motions, film: Film) -> tuple[Array, Array]:
    """Errors (2, 2) of stiffness and damping; NaN where no finer film was found."""
    engine, index, move = motions.engine, motions.index, GAP_STEP * motions.gap
    directions = film.a.surface.shape.frame[:2]
    engine.put_back(motions.probe.base)
    at_rest = np.zeros(motions.probe.count)
    motions.probe.place(at_rest, at_rest, at_rest)
    forces = [
        [
            [film_figures(engine, index, film, by, (sign * move * way, order)) for sign in (1.0, -1.0)]
            for order in (0, 1) for way in directions
        ]
        for by in ((1, 1), (1, 2), (2, 1))
    ]  # fmt: skip
    if any(found is None for grid in forces for pair in grid for found in pair):
        return UNKNOWN
    own, rows, columns = np.array(forces, dtype=float)[..., :3] @ directions.T  # (columns of K and C, signs, 2)
    change = OF_CHANGE * (rows + columns - 2.0 * own)
    found = (change[:, 0] - change[:, 1]).T / (2.0 * move)
    return np.abs(found[:, :2]), np.abs(found[:, 2:])
