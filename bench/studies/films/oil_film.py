"""The law of oil films compared with closed forms, quadrature and finite volumes; two minutes.

The law of films on nodes (`references.films`), by itself and between rigid surfaces.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from references.closed_forms.cavitation import PartingPlates, ruptured_slider
from references.closed_forms.films import (
    HALF_CYLINDER,
    REYNOLDS_CYLINDER,
    JournalBearing,
    plane_slider,
    short_bearing_coefficients,
    squeezed_plate,
    stability_threshold,
)
from references.films.finite_volumes import steady_journal
from references.films.journal import JournalFilm
from references.films.pads import pad, plates, square_plate
from warpffrf.study.markdown import table

FOLDER, PAGE = "docs/studies", "oil_film.md"
RADIUS, CLEARANCE, VISCOSITY, SPEED = 0.025, 25e-6, 0.01, 300.0  # m, m, Pa s, rad/s
RATIOS, ECCENTRICITIES = (0.5, 1.0), (0.2, 0.5, 0.8, 0.9)
GRID_NODES = ((64, 9), (128, 17), (180, 31))
VOLUMES = (360, 64)
TURNING = 0.25  # of the shaft's speed, of a load that turns

Array = np.ndarray


def journal(length: float, columns: int, rows: int, **options: object) -> JournalFilm:
    """A film of the page's radius, clearance, oil and speed."""
    return JournalFilm(RADIUS, length, CLEARANCE, VISCOSITY, SPEED, columns, rows, **options)  # type: ignore[arg-type]


def at(eccentricity: float) -> Array:
    """A place on the line theta = 0."""
    return np.array([eccentricity * CLEARANCE, 0.0])


def attitude(force: Array) -> float:
    """Between load and line of centres [deg]."""
    return float(np.degrees(np.arctan2(force[1], -force[0])))


def _off(found: float, exact: float) -> str:
    return f"{100.0 * (found / exact - 1.0):+.2g} %"


def finite_rows() -> list[list[str]]:
    """Nodes against finite volumes: load, attitude, largest pressure."""
    rows = []
    for ratio in RATIOS:
        length = ratio * 2.0 * RADIUS
        for e in ECCENTRICITIES:
            volumes = steady_journal(
                RADIUS, length, CLEARANCE, VISCOSITY, SPEED, e, columns=VOLUMES[0], rows=VOLUMES[1], mode="reynolds"
            )
            row = [f"{ratio:g}", f"{e:g}", f"{volumes.load:.5g}", f"{np.degrees(volumes.attitude):.2f}"]
            for columns, along in GRID_NODES:
                film = journal(length, columns, along, mode="reynolds")
                state = film.steady(at(e))
                force = film.force(state)
                row.append(
                    f"{_off(float(np.hypot(*force)), volumes.load)}, "
                    f"{attitude(force) - np.degrees(volumes.attitude):+.2g}°, "
                    f"{_off(float(state.pressure.max()), volumes.largest)}"
                )
            rows.append(row)
    return rows


def mode_rows() -> list[list[str]]:
    """What each treatment of the cavity makes of one bearing, and sweeps of its set."""
    length = RADIUS
    rows = []
    for e in (0.5, 0.8):
        for mode, feeds in (("jfo", (64,)), ("jfo", (48,)), ("reynolds", ()), ("half_sommerfeld", ())):
            film = journal(length, 128, 17, mode=mode, feeds=feeds)
            state = film.steady(at(e))
            force = film.force(state)
            fed = f", fed at {360 * feeds[0] // 128}°" if feeds else ""
            rows.append([f"{e:g}", mode + fed, f"{np.hypot(*force):.5g}", f"{attitude(force):.2f}", str(state.sweeps)])
    return rows


def closed_rows() -> list[list[str]]:
    """Against closed forms."""
    rows = []
    for e in (0.5, 0.9):
        film = journal(1.0, 128, 2, mode="full_sommerfeld")
        film.held[:] = False
        film.held[:2] = True
        found = float(np.hypot(*film.force(film.steady(at(e)))))
        exact = JournalBearing(RADIUS, 1.0, CLEARANCE, VISCOSITY, SPEED * RADIUS).long(e)
        rows.append([f"long bearing, whole film (Sommerfeld), eccentricity {e:g}", "128 columns", _off(found, exact)])
    for e in (0.5, 0.8):
        length = 0.02 * 2.0 * RADIUS
        film = journal(length, 128, 9, mode="reynolds")
        found = float(np.hypot(*film.force(film.steady(at(e)))))
        exact = JournalBearing(RADIUS, length, CLEARANCE, VISCOSITY, SPEED * RADIUS).short(e)[0]
        rows.append([f"short bearing, L/D 0.02 (Ocvirk), eccentricity {e:g}", "128 x 9", _off(found, exact)])
    slider = pad(lambda x: 2.0 - x, np.linspace(0.0, 1.0, 65), speed=1.0, mode="full_sommerfeld").force
    exact = plane_slider(2.0, 1.0, 1.0, viscosity=1.0, speed=1.0)
    rows.append(["plane slider, gaps 2 to 1", "65 columns", _off(slider, exact)])
    t = np.linspace(-1.0, 1.0, 201)
    x = 13.0 * np.sqrt(2e-3) * np.sign(t) * np.abs(t) ** 2.5
    for mode, closed in (("reynolds", REYNOLDS_CYLINDER), ("half_sommerfeld", HALF_CYLINDER)):
        found = 1e-3 * pad(lambda x: 1e-3 + 0.5 * x**2, x, speed=2.0, mode=mode).force
        rows.append([f"cylinder on a plane, cut at 13 root(2 R h), {mode}", "201 columns", _off(found, closed)])
    for n in (16, 32):
        rows.append(["square plate, squeezed", f"{n} x {n}", _off(square_plate(n), squeezed_plate(1.0, 1.0))])
    return rows


def rupture_rows() -> list[list[str]]:
    """A parabolic slider whose film ruptures and forms again: force, flux and both ends of the cavity in cells."""
    length, narrow, wide, speed, viscosity, outlet = 76.2e-3, 25.4e-6, 50.8e-6, 4.57, 0.04, 0.336e6

    def gap(x: Array) -> Array:
        return narrow + (wide - narrow) * (2.0 * x / length - 1.0) ** 2

    exact = ruptured_slider(gap, length, 0.5 * length, viscosity=viscosity, speed=speed, inlet=0.0, outlet=outlet)  # type: ignore[arg-type]
    rows = []
    for cells in (64, 128, 256):
        x = np.linspace(0.0, length, cells + 1)
        found = pad(gap, x, speed=speed, mode="jfo", viscosity=viscosity, ends=(0.0, outlet))
        void = np.flatnonzero(found.void > 0.0)
        rows.append([
            str(cells), _off(found.force, exact.force), f"{found.inflow[0] / exact.flux - 1.0:+.1e}",
            f"{(x[void[0]] - exact.rupture) / x[1]:+.2f}", f"{(x[void[-1]] - exact.refill) / x[1]:+.2f}",
            str(found.state.sweeps),
        ])  # fmt: skip
    return rows


def parting_rows() -> list[list[str]]:
    """Plates that part and meet: largest cavity over the half-width, and its collapse over the period."""
    given = PartingPlates(5e-3, 25e-6, 10e-6, 0.02, 0.015, 1e5)
    time, half = given.cavity()
    rows = [["front in time (ODE)", "", f"{half.max() / given.half_width:.4f}", f"{time[-1] / given.period:.4f}"]]
    for cells, steps in ((50, 100), (100, 400), (200, 1600)):
        found = plates(given, cells, steps)
        collapse = float(found.time[found.cavity > 0.0][-1]) / given.period
        rows.append([str(cells), str(steps), f"{found.cavity.max() / given.half_width:.4f}", f"{collapse:.4f}"])
    return rows


def standing(load: float, grid_nodes: tuple[int, int]) -> float:
    """Eccentricity [m] under a load [N] that stands, at the speed |omega - 2 w| at which one that turns with
    w = TURNING omega does the same."""
    film = JournalFilm(
        RADIUS, RADIUS, CLEARANCE, VISCOSITY, SPEED * abs(1.0 - 2.0 * TURNING), *grid_nodes, mode="reynolds"
    )  # fmt: skip
    place = 0.6 * at(0.5)
    film.begin(place)
    for _ in range(30):
        place, _ = film.carry(place, np.array([load, 0.0]), 0.01)
    return float(np.hypot(*place))


def turning(load: float, grid_nodes: tuple[int, int], per_turn: int) -> tuple[float, float]:
    """Eccentricity [m] under a load [N] that turns, after four turns of the shaft in so many steps each, and the mean
    number of Newton iterations per step from the second turn on."""
    film = JournalFilm(RADIUS, RADIUS, CLEARANCE, VISCOSITY, SPEED, *grid_nodes, mode="reynolds")
    place, step, counts = np.array([0.5, -0.3]) * CLEARANCE, 2.0 * np.pi / SPEED / per_turn, []
    film.begin(place)
    for k in range(1, 4 * per_turn + 1):
        angle = TURNING * SPEED * k * step
        place, count = film.carry(place, load * np.array([np.cos(angle), np.sin(angle)]), step)
        counts.append(count)
    return float(np.hypot(*place)), float(np.mean(counts[per_turn:]))


def turning_rows(load: float, steps: Sequence[int], grid_nodes: tuple[int, int] = (48, 9)) -> list[list[str]]:
    """Against the load that stands, by steps per revolution."""
    exact, rows = standing(load, grid_nodes), []
    for per_turn in steps:
        found, iterations = turning(load, grid_nodes, per_turn)
        rows.append([str(per_turn), _off(found, exact), f"{iterations:.1f}"])
    return rows


def threshold_rows() -> list[list[str]]:
    """Of a short bearing at half eccentricity, by columns: critical mass m c omega^2/W and whirl over omega."""
    exact = stability_threshold(*short_bearing_coefficients(0.5))
    rows = [["closed form", f"{exact[0]:.4f}", f"{exact[1]:.4f}"]]
    for columns in (64, 128, 256):
        film = journal(0.02 * 2.0 * RADIUS, columns, 9, mode="half_sommerfeld")
        state = film.steady(at(0.5))
        K, D = film.coefficients(at(0.5), state)
        load = float(np.hypot(*film.force(state)))
        mass, whirl = stability_threshold(K * CLEARANCE / load, D * CLEARANCE * SPEED / load)
        rows.append([f"{columns} x 9", f"{mass:.4f}", f"{whirl:.4f}"])
    return rows


def balance_rows() -> list[list[str]]:
    """Torques about both axes, and power, of a fed bearing."""
    rows = []
    for columns, along in GRID_NODES:
        film, place = journal(RADIUS, columns, along, feeds=(columns // 2,)), np.array([0.6, 0.2]) * CLEARANCE
        state = film.steady(place)
        force = film.force(state)
        shaft, bore = film.torques(place, state)
        lever = place[0] * force[1] - place[1] * force[0]
        power = sum(film.losses(place, state))
        rows.append(
            [f"{columns} x {along}", f"{(shaft + bore + lever) / shaft:.1e}", f"{-shaft * SPEED / power - 1.0:.1e}"]
        )
    return rows


def compute() -> dict[str, list[list[str]]]:
    """The figures of the page."""
    return {
        "finite": finite_rows(),
        "mode": mode_rows(),
        "closed": closed_rows(),
        "rupture": rupture_rows(),
        "parting": parting_rows(),
        "turning": turning_rows(3000.0, (30, 60, 120)),
        "threshold": threshold_rows(),
        "balance": balance_rows(),
    }


def page(found: dict[str, list[list[str]]]) -> str:
    """Markdown."""
    grid_nodes = [f"{a} x {b} nodes" for a, b in GRID_NODES]
    return f"""# The law of oil films

Reynolds' equation on bilinear shape functions with the cavity volume per area as the unknown where the film is not full
(`tests/references/films`), by itself and between rigid surfaces. Radius {1e3 * RADIUS:g} mm, clearance
{1e6 * CLEARANCE:g} µm, {VISCOSITY:g} Pa s, {SPEED:g} rad/s unless stated otherwise.

## Finite bearings compared with finite volumes

Rupture by Reynolds' condition. Load [N] and attitude [deg] on {VOLUMES[0]} x {VOLUMES[1]} volumes, implemented
separately; errors of load, attitude and largest pressure of the film on nodes.

{table(["L/D", "eccentricity", "load", "attitude", *grid_nodes], found["finite"])}
## Treatments of the cavity

L/D 0.5, 128 x 17 nodes, the film widest at 180°. Oil that is carried as cavity and film into the feed conserves mass;
Reynolds' condition, which forgets what was lost at the rupture, is closest to it. *Sweeps*: updates of the set of full
nodes.

{table(["eccentricity", "cavitation", "load [N]", "attitude [deg]", "sweeps"], found["mode"])}
## Closed forms

{table(["case", "nodes", "error of the force"], found["closed"])}
## Rupture and filling

A parabolic slider, 76.2 mm long, 25.4 to 50.8 µm, 4.57 m/s, 0.04 Pa s, 0.336 MPa at its end: compared with quadrature.
The ends of the cavity are off by so many cells.

{table(["cells", "force", "flux", "rupture", "refill", "sweeps"], found["rupture"])}
Plates, 10 mm wide, 25 + 10 cos(wt) µm apart at 50 Hz, 1 bar around them: the largest cavity over the half-width, and
when it collapses, in periods. BDF2.

{table(["cells", "steps", "largest cavity", "collapse"], found["parting"])}
## Motion

A load of 3 kN on a bearing of L/D 0.5 that rotates at a quarter of the shaft's speed: eccentricity compared with that
of a stationary load, at half of the speed. BDF2, 48 x 9 nodes.

{table(["steps per revolution", "eccentricity", "Newton iterations per step"], found["turning"])}
Short bearing, L/D 0.02, eccentricity 0.5, half film: where it begins to whirl. The film ends between two columns,
which is of first order.

{table(["nodes", "m c ω²/W", "whirl/ω"], found["threshold"])}
## Balance

A fed bearing at eccentricity 0.63: the torques about the axes of shaft and bore and the moment of the load between
them, over the torque; and the power of the shaft compared with the losses of shear and of flow.

{table(["nodes", "torques", "power"], found["balance"])}"""
