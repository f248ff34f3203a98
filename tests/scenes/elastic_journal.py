"""A shaft in an elastic bore by the reference `references.films.elastic`: at rest and under the load of an engine."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from references.films.elastic import ElasticJournal, Settled, State, held_compliance
from references.films.engine_load import crank_load
from warpffrf.model import oils, surfaces
from warpffrf.model.laws import ExponentialAsperities
from warpffrf.model.material import Material
from warpffrf.model.mesh import sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.offline import reduce

STEEL = Material(210e9, 0.3, 7850.0)
RADIUS, WALL, LENGTH, CLEARANCE = 0.025, 0.0125, 0.025, 25e-6  # m
VISCOSITY, SPEED = 0.01, 300.0  # Pa s, rad/s
ASPERITIES = ExponentialAsperities(2e9, 0.2e-6, 2.8e-6)
HEAVY = 60e3  # N

Array = np.ndarray


@cache
def bore(columns: int, rows: int) -> ReducedBody:
    """A sleeve that is held outside."""
    mesh = sleeve(RADIUS, RADIUS + WALL, LENGTH, sectors=columns, order=1, axial=rows - 1)
    return reduce(
        mesh, STEEL, interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()}, modes=10, cache=False,
        progress=False,
    )  # fmt: skip


def journal(
    columns: int, rows: int, speed: float = SPEED, powers: tuple[int, ...] | None = None, *, rough: bool = False
) -> ElasticJournal:
    """A shaft in it, fed on the far side of the load."""
    body = bore(columns, rows)
    grid = body.contact_surfaces["bore"].grid
    theta = grid.theta_start + grid.pitch * np.arange(columns)
    held = np.arange(columns) == int(np.argmin(np.cos(theta)))
    return ElasticJournal(
        RADIUS, CLEARANCE, oils.Newtonian(VISCOSITY), speed, theta, grid.z, held_compliance(body, "bore", "outside"),
        held, ASPERITIES.curve if rough else None, powers,
    )  # fmt: skip


def at_rest(film: ElasticJournal, load: float) -> Settled:
    """From a third of the clearance and a full film without pressure."""
    return film.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([load, 0.0]))


@dataclass(frozen=True)
class Film:
    """Eccentricity over the clearance, smallest film at nodes [m], largest pressure there [Pa]."""

    eccentricity: float
    thinnest: float
    largest: float

    @classmethod
    def of(cls, film: ElasticJournal, state: State) -> Film:
        """Of a state."""
        return cls(
            float(np.hypot(*state.place)) / CLEARANCE, float(film.gap_at_nodes(state).min()),
            float((film.basis.to_nodes @ state.pressure).max()),
        )  # fmt: skip


@dataclass(frozen=True)
class Orbit:
    """Over two turns: smallest film [m], largest pressure [Pa], mean and largest number of iterations per step, and how
    many steps failed."""

    thinnest: float
    largest: float
    mean: float
    most: int
    failed: int


def orbit(degrees: float, turns: float = 2.0, powers: tuple[int, ...] | None = (0, 2)) -> Orbit:
    """Under the load of an engine, in steps of so many degrees, by BDF2 from rest at the firing dead centre."""
    film = journal(64, 9, powers=powers)
    begin, step = 2.0 * np.pi, np.radians(degrees)
    state = film.settle(np.array([0.3 * CLEARANCE, 0.0]), crank_load(begin)).state
    earlier, found, counts, failed = None, [Film.of(film, state)], [], 0
    for k in range(1, round(360.0 * turns / degrees) + 1):
        new, count = film.stepped(state, crank_load(begin + k * step), step / SPEED, earlier=earlier)
        counts.append(count)
        if new is None:
            failed += 1
            continue
        earlier, state = (state, step / SPEED), new
        found.append(Film.of(film, state))
    return Orbit(
        min(f.thinnest for f in found), max(f.largest for f in found), float(np.mean(counts)), max(counts), failed
    )
