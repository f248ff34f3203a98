"""Verification: oil films."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.optimize import root

import warpffrf as wf
from references.closed_forms.films import (
    adiabatic_rise,
    couette_stress,
    short_bearing_coefficients,
    stability_threshold,
)
from references.films.journal import JournalFilm
from scenes import film_bearing as made
from scenes import warm_pads, warm_sleeve, warm_slider
from studies.films import film_acceptance as study
from studies.films import oil_film
from studies.validate.case import Row, case
from warpffrf.model import films

ROOM = "Oil films"
LUND = (
    "J. W. Lund and K. K. Thomsen, in Topics in Fluid Film Bearing and Rotor Bearing System Design and Optimization, "
    "ASME (1978)"
)
TWO_GROOVES = {  # Sommerfeld number: eccentricity, attitude [deg]; Kxx, Kxy, Kyx, Kyy; Bxx, Bxy, Byy
    0.991: ((0.150, 70.58), (1.56, 7.29, -2.16, 1.52), (14.66, 1.58, 4.49)),
    0.635: ((0.224, 63.54), (1.62, 5.33, -1.57, 1.56), (10.80, 1.70, 3.41)),
    0.235: ((0.460, 49.27), (2.19, 3.57, -0.80, 1.55), (7.36, 1.89, 2.19)),
    0.159: ((0.559, 44.33), (2.73, 3.36, -0.48, 1.48), (6.94, 1.78, 1.74)),
    0.108: ((0.650, 39.72), (3.45, 3.34, -0.23, 1.44), (6.89, 1.72, 1.43)),
}
DIGITS = 0.02  # of the largest of a kind: three digits, and the grid of the table


def _row(found: study.Row, what: str, theirs: float = 1.0) -> Row:
    """As a row of this page: `what` is compared, `theirs` the number of the source, 1 for that of the closed form."""
    named = f"{what} over the closed form's" if theirs == 1.0 else what
    return Row(named, theirs * (1.0 + found.error), theirs, found.target)


@case(ROOM, "A. Sommerfeld, Z. Math. Phys. 50 (1904) 97; W/(μUL(R/c)²)")
def long_bearing() -> Iterator[Row]:
    """F1: the middle row of a wide bearing with a whole film, 128 columns"""
    half, most = study.long_rows()
    yield _row(half, "force, eccentricity 0.5", 9.673597)
    yield _row(most, "force, eccentricity 0.9")


@case(ROOM, "F. W. Ocvirk, NACA TN 2808 (1952); W/(μUL³/c²)")
def short_bearing() -> Iterator[Row]:
    """F2: a short bearing, L/D 0.05, 128 x 9 nodes; the closed form is that of L/D 0"""
    half, most = study.short_rows()
    yield _row(half, "force, eccentricity 0.5", 0.7503811)
    yield _row(most, "force, eccentricity 0.8", 5.731328)


@case(ROOM, "Lord Rayleigh, Phil. Mag. 35 (1918) 1; W h0²/(μUB²L)")
def plane_slider() -> Iterator[Row]:
    """F3: a wide plane slider at the inlet ratio 2.188705 of the largest force, 64 cells"""
    (found,) = study.slider_rows(64, 2.188705)
    yield _row(found, "force", 0.1602431)


@case(ROOM, "H. M. Martin, Engineering 102 (1916) 119; W'h0/(μūR)")
def cylinder_on_plane() -> Iterator[Row]:
    """F4: a rigid cylinder on a plane, cut at 13 sqrt(2 R h0), 192 cells"""
    reynolds, half = study.cylinder_rows()
    yield _row(reynolds, "force, Reynolds' boundary", 4.894968)
    yield _row(half, "force, half of Sommerfeld's", 4.0)


@case(ROOM, "Reynolds' equation: double series of a rectangle; a long plate μLB³V/h³")
def squeezed_plates() -> Iterator[Row]:
    """F5: a square plate that comes down, 32 x 32 cells, and the middle row of a long one, 64 cells"""
    (square,) = study.squeeze_rows()
    yield _row(square, "force of a square plate")
    breadth, height, speed = 0.02, 20e-6, 1e-3
    body = study.wide(breadth, 64)
    scene, _ = study.above(
        body, study.FACE, height=height, velocity=(0, 0, -speed), axis=(0, 0, 1), mass=1e6,
        cavitation="full_sommerfeld", ambient_pressure=1.0,
    )  # fmt: skip
    found = study.completed(study.run(scene, 1e-5, step=1e-5, progress=False))
    force = study.trapezoid(study.along_x(body)[0], study.middle(body, found.films["film"].pressure[-1]))
    gap = found.bodies["runner"].position[-1][2]
    yield Row("force of a long plate over μLB³V/h³", force * gap**3 / (made.VISCOSITY * breadth**3 * speed), 1.0, 2e-3)


@case(ROOM, "Reynolds' equation of a plate under a constant force: 1/h² is linear in time (J. Stefan, 1874)")
def falling_plate() -> Iterator[Row]:
    """A light plate that falls to half the gap, 32 x 32 cells, by the number of steps"""
    for row in study.falling_rows():
        yield _row(row, f"1/h² after {row.case.split(' in ')[1]}")


@case(ROOM, "Quadrature between rupture and filling with mass conserved (JFO), references/closed_forms/cavitation.py")
def ruptured_slider() -> Iterator[Row]:
    """A parabolic slider whose film ruptures and fills again, 128 cells"""
    force, *ends = study.ruptured_rows()
    yield _row(force, "force")
    for row in ends:
        yield Row(f"{row.compared} off by, over the length", row.error, 0.0, row.target, scale=1.0)


@case(ROOM, "Front of the cavity by its differential equation, references/closed_forms/cavitation.py")
def parting_plates() -> Iterator[Row]:
    """Plates that part and meet at 50 Hz: the cavity between them, 200 cells, 400 steps a period"""
    for row, theirs in zip(study.parting_rows(), (0.6614, 1.1782), strict=True):
        yield Row(row.compared.split(",")[0], theirs * (1.0 + row.error), theirs, row.target)


@case(ROOM, "R. Holmes, J. Mech. Eng. Sci. 2 (1960) 337: whirl of the short bearing with a half film")
def whirl_threshold() -> Iterator[Row]:
    """Stability limit of a rigid shaft in a short bearing at half eccentricity: the law of films by itself
    (tests/references/films), L/D 0.02, 256 x 9 nodes"""
    film, place = oil_film.journal(0.02 * 2.0 * oil_film.RADIUS, 256, 9, mode="half_sommerfeld"), oil_film.at(0.5)
    state = film.steady(place)
    K, D = film.coefficients(place, state)
    load = float(np.hypot(*film.force(state)))
    found = stability_threshold(K * oil_film.CLEARANCE / load, D * oil_film.CLEARANCE * oil_film.SPEED / load)
    for name, ours, theirs in zip(
        ("m c ω²/W", "whirl over ω"), found, stability_threshold(*short_bearing_coefficients(0.5)), strict=True
    ):
        yield Row(name, ours, theirs, 0.03)


@case(ROOM, "Energy balance of a slider with constant viscosity and adiabatic walls, by quadrature")
def adiabatic_slider() -> Iterator[Row]:
    """A wide plane slider, inlet over outlet 2, 64 cells: rise of the oil's temperature along it"""
    gaps, breadth, speed = (50e-6, 25e-6), 0.01, 5.0
    scene = warm_slider.slider(
        gaps, speed=speed, breadth=breadth, oil=warm_slider.oil(0.0),
        temperature=films.FilmTemperature(warm_slider.SUPPLY),
    )  # fmt: skip
    film: Any = made.at_rest(scene).films["film"]
    capacity = warm_slider.DENSITY * warm_slider.CAPACITY
    rise = film.temperature[-1][-1, 4] - warm_slider.SUPPLY
    yield Row("rise", rise, adiabatic_rise(warm_slider.VISCOSITY, speed, breadth, *gaps, capacity), 5e-3, "K")
    yield Row("heat carried away over generated", film.heat_carried[-1] / film.heat_generated[-1], 1.0, 1e-6)


@case(ROOM, "S. Nahme, Ing.-Arch. 11 (1940) 191: Couette flow with conduction and exponential viscosity")
def heated_couette() -> Iterator[Row]:
    """Shear stress over that of cold oil between parallel plates, both of one temperature, by the Brinkman number"""
    gap, slope, width, walls = 10e-6, 0.03, 0.02, films.FilmTemperature(40.0, wall_a=40.0, wall_b=40.0)
    for speed in (5.0, 10.0, 20.0):
        power = []
        for n in (1, 2):  # their difference has no ends
            scene = warm_slider.slider(
                (gap, gap), speed=speed, breadth=n * 0.02, length=width, cells=n * 16, oil=warm_slider.oil(slope),
                temperature=walls,
            )  # fmt: skip
            power.append(made.at_rest(scene).films["film"].friction_power[-1])
        brinkman = slope * warm_slider.VISCOSITY * speed**2 / warm_slider.CONDUCTIVITY
        found = (power[1] - power[0]) / (0.02 * width * warm_slider.VISCOSITY * speed**2 / gap)
        yield Row(f"τh/(μ0U), Br = {brinkman:.3g}", found, couette_stress(brinkman), 5e-3)


@case(
    ROOM, "H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids (1959): ring under a flux, with convection outside"
)
def warm_sleeve_at_rest() -> Iterator[Row]:
    """A shaft in a steel sleeve that conducts the heat of its film to its surroundings, 32 x 7 nodes: temperatures and
    expansion of both found together; mean over the bore above the surroundings, under the film's own heat"""
    scene = warm_sleeve.bearing()
    found = wf.study.warm_equilibrium(scene)
    sleeve: Any = warm_sleeve.sleeve()
    heat = float(found.heat["film"][-1, 0])
    bore = sleeve.thermal.temperature(found.states["sleeve"][-1], "bore").mean(axis=0)
    rise = np.average(bore, weights=[0.5, *[1.0] * (len(bore) - 2), 0.5]) - warm_sleeve.AMBIENT
    yield Row("rise of the bore", float(rise), warm_sleeve.bore_rise(heat), 2e-3, "K")
    film = found.result.film("film")
    away = float(film.heat_carried[-1] + film.heat_to_a[-1])
    yield Row("heat carried away and conducted over generated", away / float(film.heat_generated[-1]), 1.0, 1e-6)


@case(ROOM, "M. Fillon, J.-C. Bligoud and J. Frêne, J. Tribol. 114 (1992) 579, measured")
def hottest_pad() -> Iterator[Row]:
    """Q3: four tilting pads of 75°, 10 kN between pivots, VG 32 supplied at 40 °C: face of the hottest pad; pads
    adiabatic, a shaft that takes up no heat, full carry-over of oil from pad to pad, 32 x 9 nodes a pad"""
    for rpm, measured in warm_pads.MEASURED.items():
        yield Row(f"hottest pad, {rpm} rpm", warm_pads.hottest_pad(rpm)[0], measured, 5.0, "°C", 1.0)


def _load_at_one() -> float:
    """Load [N] at the Sommerfeld number 1, mu N L D (R/c)^2/W, of a bearing with L = D."""
    diameter = 2.0 * made.RADIUS
    return made.VISCOSITY * made.SPEED / (2.0 * np.pi) * diameter**2 * (made.RADIUS / made.CLEARANCE) ** 2


@case(ROOM, LUND)
def two_groove_bearing() -> Iterator[Row]:
    """Q1: a bearing of L = D with two axial grooves of 20° at the horizontal split, load between them, Reynolds'
    boundary: where the shaft comes to rest, 72 x 13 nodes"""
    length, grid_nodes = 2.0 * made.RADIUS, (72, 13)
    body = made.bore(grid_nodes, length, made.RIGID)
    feeds = [films.AxialGroove(side * 0.5 * np.pi, np.radians(20.0) * made.RADIUS, 0.0) for side in (1.0, -1.0)]
    unit = (
        made.VISCOSITY * made.SPEED / (2.0 * np.pi) * length * 2.0 * made.RADIUS * (made.RADIUS / made.CLEARANCE) ** 2
    )
    for number, ((eccentricity, attitude), *_) in TWO_GROOVES.items():
        turn = np.radians(attitude)
        start = (eccentricity * np.cos(turn), eccentricity * np.sin(turn))
        scene = made.bearing(body, (unit / number, 0.0), at=start, cavitation="reynolds", feeds=feeds)
        x = made.at_rest(scene).bodies["shaft"].position[-1] / made.CLEARANCE
        yield Row(f"ε, S = {number:g}", np.hypot(x[0], x[2]), eccentricity, 0.015)
        yield Row(f"φ, S = {number:g}", np.degrees(np.arctan2(-x[2], x[0])), attitude, 0.5, "°", 1.0)


@case(ROOM, LUND)
def two_groove_coefficients() -> Iterator[Row]:
    """Q1: stiffness kc/W and damping bcω/W of the same bearing by the law of films by itself (tests/references/films),
    144 x 13 nodes; differences over the largest of a kind"""
    R, columns = made.RADIUS, 144
    feeds = tuple(c for c in range(columns) if abs(abs((c * 360.0 / columns + 180.0) % 360.0 - 180.0) - 90.0) <= 10.0)
    film = JournalFilm(
        R, 2.0 * R, made.CLEARANCE, made.VISCOSITY, made.SPEED, columns, 13, feeds=feeds, mode="reynolds"
    )  # fmt: skip
    unit = _load_at_one()
    for number, ((eccentricity, attitude), stiffness, damping) in TWO_GROOVES.items():
        load, turn = unit / number, np.radians(attitude)

        def lacking(x: np.ndarray, load: float = load) -> np.ndarray:
            return film.force(film.steady(x * made.CLEARANCE)) / load + (1.0, 0.0)

        place = made.CLEARANCE * root(lacking, eccentricity * np.array([np.cos(turn), np.sin(turn)]), tol=1e-9).x
        K, D = film.coefficients(place, film.steady(place))
        K, D = K * made.CLEARANCE / load, D * made.CLEARANCE * made.SPEED / load
        for name, ours, theirs in zip(("Kxx", "Kxy", "Kyx", "Kyy"), K.ravel(), stiffness, strict=True):
            yield Row(f"{name}, S = {number:g}", ours, theirs, DIGITS, "", max(stiffness))
        for name, ours, theirs in zip(("Bxx", "Bxy", "Byy"), (D[0, 0], D[0, 1], D[1, 1]), damping, strict=True):
            yield Row(f"{name}, S = {number:g}", ours, theirs, DIGITS, "", max(damping))
