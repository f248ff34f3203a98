"""Writes docs/studies/elastic_film.md: `python -m studies.films.elastic_film [FOLDER]`. About four minutes.

A shaft in an elastic bore by the reference of `verification.films.elastic`: what iterations, bases and steps do.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from references.films.elastic import ElasticJournal, Settled, State, held_compliance
from references.films.engine_load import crank_load
from warpffrf.model import oils, surfaces
from warpffrf.model.laws import ExponentialAsperities
from warpffrf.model.material import Material
from warpffrf.model.mesh import sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.offline import reduce
from warpffrf.study.markdown import table

FOLDER, PAGE = "docs/studies", "elastic_film.md"
MADE = "Made by `python -m studies.films.elastic_film`; do not edit.\n"
STEEL = Material(210e9, 0.3, 7850.0)
RADIUS, WALL, LENGTH, CLEARANCE = 0.025, 0.0125, 0.025, 25e-6  # m
VISCOSITY, SPEED = 0.01, 300.0  # Pa s, rad/s
ASPERITIES = ExponentialAsperities(2e9, 0.2e-6, 2.8e-6)
LOADS, SPEEDS = (2e3, 10e3, 20e3, 40e3), (300.0, 30.0, 3.0, 0.3)
HEAVY = 60e3  # N
POWERS = (None, (0, 2), (0, 2, 4))
DEGREES = (4.0, 2.0, 1.0, 0.5, 0.25)

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
    """Eccentricity over the clearance, smallest film at hats [m], largest pressure there [Pa]."""

    eccentricity: float
    thinnest: float
    largest: float

    @classmethod
    def of(cls, film: ElasticJournal, state: State) -> Film:
        """Of a state."""
        return cls(
            float(np.hypot(*state.place)) / CLEARANCE, float(film.gap_at_hats(state).min()),
            float((film.basis.to_hats @ state.pressure).max()),
        )  # fmt: skip


def basis_rows() -> list[list[str]]:
    """Hats and strips, by the grid and the load."""
    rows = []
    for columns, along in ((64, 9), (64, 17)):
        for powers in POWERS:
            for load in LOADS:
                film = journal(columns, along, powers=powers)
                settled = at_rest(film, load)
                f = Film.of(film, settled.state)
                rows.append([
                    f"{columns} x {along}", "hats" if powers is None else f"strips {powers}",
                    str(film.basis.unknowns), f"{1e-3 * load:g}", f"{f.eccentricity:.4f}", f"{1e6 * f.thinnest:.3f}",
                    f"{1e-6 * f.largest:.2f}", f"{settled.iterations} in {settled.steps}",
                ])  # fmt: skip
    return rows


def mixed_rows() -> list[list[str]]:
    """With asperities, by the speed."""
    rows = []
    for powers in POWERS[:2]:
        for speed in SPEEDS:
            film = journal(64, 9, speed, powers, rough=True)
            settled = at_rest(film, HEAVY)
            f, share = Film.of(film, settled.state), np.hypot(*film.force(settled.state)[1]) / HEAVY
            rows.append([
                "hats" if powers is None else f"strips {powers}", f"{speed:g}", f"{f.eccentricity:.4f}",
                f"{1e6 * f.thinnest:.3f}", f"{1e-6 * f.largest:.1f}", f"{1e-6 * settled.state.asperity.max():.0f}",
                f"{share:.3f}", f"{settled.iterations} in {settled.steps}",
            ])  # fmt: skip
    return rows


@dataclass(frozen=True)
class Orbit:
    """Over two turns: smallest film [m], largest pressure [Pa], mean and largest number of iterations a step, and how
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


def orbit_rows() -> list[list[str]]:
    """By the step, beside the shortest."""
    found = {degrees: orbit(degrees) for degrees in DEGREES}
    exact = found[min(DEGREES)]
    return [
        [
            f"{degrees:g}", f"{1e6 * o.thinnest:.4f}", f"{100.0 * (o.thinnest / exact.thinnest - 1.0):+.2g} %",
            f"{1e-6 * o.largest:.2f}", f"{o.mean:.1f}", str(o.most), str(o.failed),
        ]
        for degrees, o in found.items()
    ]  # fmt: skip


def page() -> str:
    """Markdown."""
    return f"""# A shaft in an elastic bore

{MADE}
The reference of oil films between elastic surfaces (`tests/references/films/elastic.py`), dense, by Newton's
method with one change of the set of full hats an iteration. A steel sleeve, {1e3 * WALL:g} mm thick, held outside,
linear cells as wide as the hats; radius and length {1e3 * RADIUS:g} mm, clearance {1e6 * CLEARANCE:g} µm,
{VISCOSITY:g} Pa s, {SPEED:g} rad/s; mass-conserving, fed on the far side of the load.

## Hats and strips

*Strips*: hats around times (1 - ζ²) (ζ^m - c_m) along, with one void a column, the multiplier of its mean pressure; one
point around and 2 n along in a strip between columns. Rest under a load, from a full film without pressure.

{table(["hats", "pressure", "unknowns", "load [kN]", "eccentricity", "smallest film [µm]", "largest pressure [MPa]",
        "iterations in steps"], basis_rows())}
## Asperities

An exponential law, 2 GPa at touch and 0.2 µm of decay, beside the film; {1e-3 * HEAVY:g} kN, 64 x 9.

{table(["pressure", "speed [rad/s]", "eccentricity", "smallest film [µm]", "largest pressure [MPa]", "asperities [MPa]",
        "their share", "iterations in steps"], mixed_rows())}
## Two turns of an engine

A smooth load, {1e-3 * float(np.hypot(*crank_load(2.0 * np.pi + 0.2))):.2g} kN as it fires, 64 x 9 hats, strips (0, 2),
BDF2; the smallest film beside that of the shortest step.

{table(["step [deg]", "smallest film [µm]", "error", "largest pressure [MPa]", "iterations a step", "at most",
        "failed"], orbit_rows())}"""  # fmt: skip


def main() -> None:
    """Write the page."""
    path = Path(sys.argv[1] if len(sys.argv) > 1 else FOLDER) / PAGE
    path.write_text(page(), encoding="utf-8")
    print(path)


if __name__ == "__main__":
    main()
