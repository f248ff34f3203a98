"""A shaft in an elastic bore, on hats by Newton's method: beside the rigid one, Barus' transform and dry contact."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import oils, surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.laws import ExponentialAsperities
from warpffrf.model.material import Material
from warpffrf.model.mesh import sleeve
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.offline import reduce
from warpffrf.verification.films.elastic import ElasticJournal, Settled, held_compliance
from warpffrf.verification.films.journal import JournalFilm

RADIUS, LENGTH, CLEARANCE, VISCOSITY, SPEED = 0.025, 0.025, 25e-6, 0.01, 300.0  # m, m, m, Pa s, rad/s
COLUMNS, ROWS, FEED = 64, 9, 32
ROUGH = ExponentialAsperities(2e9, 0.2e-6, 2.8e-6).curve
BALANCED = 1e-6  # of a load that is balanced to 1e-8 in steps that still squeeze by 1e-6 of the clearance
# load and largest pressure of hats of p beside hats of its transform, of second order: 0.7 and 1.4 % measured
BARUS, BARUS_PEAK = 0.01, 0.02
MOST = 60  # iterations from rest, promised
DRY = 0.01  # of what asperities carry at next to no speed: the film carries the rest


@pytest.fixture(scope="module")
def bore() -> ReducedBody:
    mesh = sleeve(RADIUS, 1.5 * RADIUS, LENGTH, sectors=COLUMNS, order=1, axial=ROWS - 1)
    return reduce(
        mesh, Material(210e9, 0.3, 7850.0), interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()},
        modes=10, cache=False, progress=False,
    )  # fmt: skip


def journal(bore: ReducedBody | None, speed: float = SPEED, oil: oils.Oil | None = None, **options) -> ElasticJournal:
    theta, z = 2.0 * np.pi / COLUMNS * np.arange(COLUMNS), np.linspace(-0.5 * LENGTH, 0.5 * LENGTH, ROWS)
    C = np.zeros((COLUMNS * ROWS, COLUMNS * ROWS))
    if bore is not None:
        grid = bore.contact_surfaces["bore"].grid
        assert (grid.columns, len(grid.z)) == (COLUMNS, ROWS)
        theta, C = grid.theta_start + theta, held_compliance(bore, "bore", "outside")
    held = np.zeros((COLUMNS, ROWS), dtype=bool)
    held[FEED] = True
    return ElasticJournal(
        RADIUS, CLEARANCE, oil or oils.Newtonian(VISCOSITY), speed, theta, z, C, held, **options
    )  # fmt: skip


def rest(film: ElasticJournal, load: float) -> Settled:
    return film.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([load, 0.0]))


def rigid_film(place: np.ndarray) -> tuple[JournalFilm, np.ndarray]:
    """The film of the rigid bearing at a place, and its pressures."""
    film = JournalFilm(RADIUS, LENGTH, CLEARANCE, VISCOSITY, SPEED, COLUMNS, ROWS, feeds=(FEED,))
    return film, film.steady(place).pressure


def test_the_compliance_of_a_bore_that_is_held(bore: ReducedBody) -> None:
    C = held_compliance(bore, "bore", "outside")
    assert np.allclose(C, C.T, rtol=0.0, atol=1e-12 * np.abs(C).max())
    assert np.linalg.eigvalsh(C)[0] > 0.0


def test_a_rigid_bore() -> None:
    load = 5000.0
    found = rest(journal(None), load)
    film, pressure = rigid_film(found.place)
    assert found.pressure == pytest.approx(pressure, rel=BALANCED, abs=BALANCED * pressure.max())
    assert film.on_shaft.T @ pressure == pytest.approx([-load, 0.0], abs=BALANCED * load)


def test_barus_is_another_pressure_of_a_newtonian_film() -> None:
    """With mu = mu_0 exp(alpha p) and a given gap q = (1 - exp(-alpha p))/alpha obeys the equation with mu_0, and is
    positive where p is."""
    load, alpha = 15000.0, 2e-8
    found = rest(journal(None, oil=oils.Barus(VISCOSITY, coefficient=alpha)), load)
    film, q = rigid_film(found.place)
    p = -np.log1p(-alpha * q) / alpha
    assert p.max() > 1.3 * q.max()  # it thickens much
    assert film.on_shaft.T @ p == pytest.approx([-load, 0.0], abs=BARUS * load)
    assert found.pressure.max() == pytest.approx(p.max(), rel=BARUS_PEAK)


@pytest.mark.parametrize("load", [2e3, 20e3, 60e3])
def test_rest_is_found_from_a_full_film(bore: ReducedBody, load: float) -> None:
    """Also where the shaft is further out than the clearance, in the dent that it makes."""
    film = journal(bore)
    found = rest(film, load)
    assert found.iterations <= MOST
    assert film.force(found.pressure) == pytest.approx([-load, 0.0], abs=BALANCED * load)
    assert found.gap.min() > 0.0
    assert (np.hypot(*found.place) > CLEARANCE) == (load == 60e3)
    assert np.all(found.pressure[found.void > 0.0] == 0.0) and np.all(found.void >= 0.0)


def dry(film: ElasticJournal, begin: Settled, load: float) -> np.ndarray:
    """Asperity pressures without a film, by Newton's method on the gaps at the hats and the place; the asperities of
    `begin` touch, but do not carry the load."""
    e, n = begin.place.copy(), film.grid.count
    h = CLEARANCE - film.normal_at_hats @ e + film.G @ begin.asperity
    for _ in range(200):
        a, steep = ROUGH.pressure(-h), -ROUGH.slope(-h)
        rest_h = h - (CLEARANCE - film.normal_at_hats @ e + film.G @ a)
        rest_e = film.force(a) + np.array([load, 0.0])
        J = np.zeros((n + 2, n + 2))
        J[:n, :n] = np.eye(n) - film.G * steep[None, :]
        J[:n, n:], J[n:, :n] = film.normal_at_hats, film.on_shaft.T * steep[None, :]
        change = np.linalg.solve(J, -np.concatenate([rest_h, rest_e]))
        part = min(1.0, 0.2e-6 / np.abs(change[:n]).max())  # of the decay of the exponential
        h, e = h + part * change[:n], e + part * change[n:]
        if part == 1.0 and np.abs(change[:n]).max() < 1e-14:
            return ROUGH.pressure(-h)
    raise AssertionError("dry contact was not found")


def test_asperities_take_over_as_the_shaft_slows_down(bore: ReducedBody) -> None:
    load, shares, middle = 60e3, [], None
    for speed in (300.0, 30.0, 3.0, 0.03):
        film = journal(bore, speed, asperities=ROUGH)
        found = rest(film, load)
        assert found.iterations <= MOST and found.gap.min() > 0.0
        assert found.asperity == pytest.approx(
            ROUGH.pressure(-(CLEARANCE - film.normal_at_hats @ found.place
                             + film.G @ (found.pressure + found.asperity))),
            abs=BALANCED * found.asperity.max(),
        )  # fmt: skip
        shares.append(float(np.hypot(*film.force(found.asperity))) / load)
        middle = found if speed == 3.0 else middle
    assert shares == sorted(shares) and shares[0] < 0.05 and shares[-1] > 1.0 - DRY
    assert middle is not None
    alone = dry(film, middle, load)
    assert np.linalg.norm(found.asperity - alone) < DRY * np.linalg.norm(alone)


def test_what_cannot_rest_is_named() -> None:
    """A shaft that does not turn sinks for ever."""
    with pytest.raises(InputError, match="squeezed out"):
        rest(journal(None, 0.0), 100.0)
