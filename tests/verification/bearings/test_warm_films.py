"""Films with a temperature: closed forms, the balance of heat, mixing between pads, continuation, refusals."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references.closed_forms.films import adiabatic_rise, couette_stress
from scenes import film_bearing, warm_pads
from scenes.warm_slider import CAPACITY, CONDUCTIVITY, DENSITY, SUPPLY, VISCOSITY, oil, slider
from warpffrf.model.errors import InputError
from warpffrf.output.contact.result import FilmResult

CLOSED_FORM = 5e-3
BALANCE = 1e-6  # of the heat: tolerance of the oil balance, and of the changes of temperature at rest
ROUND_OFF = 1e-9
HEATED = wf.films.FilmTemperature(SUPPLY)
MEASURED_WITHIN = 5.0  # K
BORE = (48, 7)


def at_rest(scene: wf.Scene) -> FilmResult:
    found = wf.equilibrium(scene, progress=False)
    assert found.status == "completed", found.message
    return found.film("film")


def unbalanced(film: Any) -> float:
    """Largest of all rows but the first, which has no step, over the heat generated."""
    left = film.heat_generated - film.heat_carried - film.heat_to_a - film.heat_to_b - film.heat_stored
    return float(np.abs(left[1:] / film.heat_generated[1:]).max(initial=0.0))


def journal(**film: Any) -> wf.Scene:
    """A shaft in a rigid sleeve, that begins off its equilibrium."""
    given: dict[str, Any] = {"oil": oil(0.03, film_bearing.VISCOSITY), "feeds": [film_bearing.GROOVE]} | film
    body = film_bearing.bore(BORE, stiffer=film_bearing.RIGID)
    return film_bearing.bearing(body, (2e3, 0.0), **given)


def test_oil_heats_up_along_an_adiabatic_slider_as_in_closed_form() -> None:
    gaps, breadth, speed = (50e-6, 25e-6), 0.01, 5.0
    film = at_rest(slider(gaps, speed=speed, breadth=breadth, oil=oil(0.0), temperature=HEATED))
    found = film.temperature[-1][-1, 4] - SUPPLY
    expected = adiabatic_rise(VISCOSITY, speed, breadth, *gaps, DENSITY * CAPACITY)
    print(f"rise {found:.5f} K, closed form {expected:.5f} K")
    assert found == pytest.approx(expected, rel=CLOSED_FORM)
    assert np.all(np.diff(film.temperature[-1][:, 4]) > 0.0)
    assert abs(film.heat_generated[-1] - film.heat_carried[-1]) < BALANCE * film.heat_generated[-1]


@pytest.mark.parametrize("walls", [{"wall_a": SUPPLY, "wall_b": SUPPLY}, {"wall_a": SUPPLY}, {"wall_b": SUPPLY}])
def test_couette_flow_with_conduction_is_that_of_nahme(walls: dict[str, Any]) -> None:
    """Two lengths of plates, whose difference has no ends; from cold walls to viscosities that halve."""
    gap, slope, width, cells = 10e-6, 0.03, 0.02, 16
    temperature = wf.films.FilmTemperature(SUPPLY, **walls)
    for speed in (5.0, 10.0, 20.0):
        power = [
            at_rest(
                slider(
                    (gap, gap), speed=speed, breadth=n * 0.02, length=width, cells=n * cells, oil=oil(slope),
                    temperature=temperature,
                )
            ).friction_power[-1]
            for n in (1, 2)
        ]  # fmt: skip
        found = (power[1] - power[0]) / (0.02 * width * VISCOSITY * speed**2 / gap)
        brinkman = slope * VISCOSITY * speed**2 / CONDUCTIVITY * (4.0 if len(walls) == 1 else 1.0)
        print(f"Br {brinkman:6.2f}: {found:.5f}, closed form {couette_stress(brinkman):.5f}")
        assert found == pytest.approx(couette_stress(brinkman), rel=CLOSED_FORM)


@pytest.mark.parametrize(
    "made",
    [
        lambda viscosity: wf.oils.Newtonian(viscosity),
        lambda viscosity: wf.oils.Barus(viscosity, coefficient=2e-8),
        lambda viscosity: wf.oils.Roelands(viscosity, coefficient=2e-8),
    ],
)
def test_the_viscosity_of_the_film_is_that_of_the_oil_at_its_temperature(made: Any) -> None:
    """The first step of a motion has the temperature of the supply, an entry of the table of viscosities."""
    warm = replace(made(0.05), thermal=wf.oils.Thermal(wf.oils.VogelLaw(900.0, 95.0), 40.0, CAPACITY))
    found = [
        wf.simulate(
            slider((4e-6, 2e-6), cells=16, oil=mine, temperature=temperature), 1e-4, step=1e-4, progress=False
        ).film("film")
        for mine, temperature in ((warm, wf.films.FilmTemperature(80.0)), (warm.at(80.0), None))
    ]  # fmt: skip
    assert found[1].largest_pressure[-1] > 2e7
    np.testing.assert_allclose(found[0].pressure[1], found[1].pressure[1], rtol=ROUND_OFF, atol=1.0)
    assert found[0].friction_power[1] == pytest.approx(found[1].friction_power[1], rel=ROUND_OFF)


def test_heat_is_balanced_in_every_step_of_a_motion_and_at_rest() -> None:
    """With cavities, a groove that replaces some of the oil, and two walls; the heat is what the ledger has lost."""
    temperature = wf.films.FilmTemperature(SUPPLY, wall_a=45.0, wall_b=50.0, carry_over=0.6)
    scene = journal(temperature=temperature)
    found = wf.simulate(scene, 40 * 1e-4, step=1e-4, progress=False)
    assert found.status == "completed", found.message
    moving, still = found.film("film"), at_rest(journal(temperature=temperature))
    assert moving.void.max() > 0.0 and abs(moving.heat_stored[-1]) > 1e-3 * moving.heat_generated[-1]
    for film in (moving, still):
        assert unbalanced(film) < BALANCE
        lost = film.friction_power + film.pressure_loss
        np.testing.assert_allclose(film.heat_generated[1:], lost[1:], rtol=BALANCE)
        assert all(np.abs(part[-1]) > 0.0 for part in (film.heat_carried, film.heat_to_a, film.heat_to_b))
    assert still.heat_stored[-1] == pytest.approx(0.0, abs=BALANCE * still.heat_generated[-1])


def test_a_bearing_settles_in_time_where_its_equilibrium_is() -> None:
    """The oil of a bearing is exchanged in a few revolutions."""
    scene = journal(temperature=HEATED)
    rest = wf.equilibrium(scene, progress=False)
    moved = wf.simulate(scene, 0.02, step=2e-4, start=rest, progress=False).film("film")
    rest = rest.film("film")
    np.testing.assert_allclose(moved.temperature[-1], rest.temperature[-1], atol=0.05)  # K, of a rise of some 10
    assert rest.temperature.max() > SUPPLY + 5.0
    cold = at_rest(journal(oil=oil(0.03, film_bearing.VISCOSITY)))
    assert rest.friction_power[-1] < 0.95 * cold.friction_power[-1]
    assert rest.smallest_gap[-1] < cold.smallest_gap[-1] and cold.temperature is None


def test_a_run_continues_bit_for_bit() -> None:
    scene = journal(temperature=HEATED)
    whole = wf.simulate(scene, 2e-3, step=1e-4, progress=False)
    first = wf.simulate(scene, 1e-3, step=1e-4, progress=False)
    second = wf.simulate(scene, 1e-3, step=1e-4, start=first, progress=False)
    np.testing.assert_array_equal(second.film("film").temperature[-1], whole.film("film").temperature[-1])
    np.testing.assert_array_equal(second.film("film").pressure[-1], whole.film("film").pressure[-1])


def test_hot_oil_is_carried_from_pad_to_pad() -> None:
    """Without carry-over all pads have the supply's temperature at their leading edges; with it those after a loaded
    pad are hotter; nothing depends on the sense of rotation but the names."""
    found = {
        (part, sense): warm_pads.at_rest(
            3000, wf.films.FilmTemperature(SUPPLY, carry_over=part), sense=sense, nodes=(24, 7)
        )
        for part, sense in ((0.0, 1), (0.8, 1), (0.8, -1))
    }
    inlet = {case: np.array([film.inlet_temperature[-1] for film in films]) for case, films in found.items()}
    np.testing.assert_array_equal(inlet[0.0, 1], SUPPLY)
    # loaded pads are 1 and 4: from 4 the oil goes to 1, from there to 2
    assert inlet[0.8, 1][0] > inlet[0.8, 1][3] > SUPPLY and inlet[0.8, 1][1] > SUPPLY + 1.0
    np.testing.assert_allclose(inlet[0.8, 1], inlet[0.8, -1][::-1], atol=1e-3)
    for films in found.values():
        assert max(abs(f.heat_generated[-1] - f.heat_carried[-1]) / f.heat_generated[-1] for f in films) < BALANCE
        assert all(np.all(film.temperature[-1] >= SUPPLY - 1e-9) for film in films)


def test_the_hottest_pad_is_as_measured() -> None:
    """Within the scatter of computations with warm pads and shafts; all four speeds are on the verification page."""
    found, shaft = warm_pads.hottest_pad(3000)
    print(f"hottest pad {found:.1f}, measured {warm_pads.MEASURED[3000]} degC; shaft {shaft:.1f}")
    assert found == pytest.approx(warm_pads.MEASURED[3000], abs=MEASURED_WITHIN)
    assert SUPPLY < shaft < found


def test_a_film_that_runs_away_is_named() -> None:
    thick = oil(0.0, 0.5)
    scene = slider((30e-6, 20e-6), speed=100.0, breadth=0.05, cells=32, oil=thick, temperature=HEATED)
    for found in (wf.equilibrium(scene, progress=False), wf.simulate(scene, 0.01, step=1e-4, progress=False)):
        assert found.status == "too_hot"
        assert "film 'film' exceeds 300 degrees Celsius: no heat leaves through adiabatic walls" in found.message


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"oil": wf.oils.Newtonian(0.01)}, "film 'film': its oil, oils.Newtonian, has no heat capacity"),
        ({"feeds": [], "ambient_pressure": 1e5}, "film 'film': heat has no way to leave: both walls are adiabatic"),
        ({"cavitation": "reynolds"}, "does not conserve oil"),
        ({"quadrature": "reduced"}, "take quadrature='full'"),
        ({"temperature": 40.0}, "temperature must be films.FilmTemperature"),
    ],
)
def test_what_has_no_temperature_is_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        journal(**{"temperature": HEATED, **given})


def test_impossible_temperatures_are_refused() -> None:
    wrong: tuple[tuple[dict[str, Any], str], ...] = (
        ({"supply": 313.15}, "from kelvins subtract 273.15"),
        ({"supply": 40.0, "wall_a": -100.0}, "wall_a"),
        ({"supply": 40.0, "carry_over": 1.1}, "at most 1"),
    )
    for given, said in wrong:
        with pytest.raises(InputError, match=said):
            wf.films.FilmTemperature(**given)
    scene = journal(temperature=wf.films.FilmTemperature(SUPPLY, upstream="pad"))
    with pytest.raises(InputError, match="film 'film': no pad upstream, upstream='pad' is not another film"):
        wf.simulate(scene, 1e-4, step=1e-4, progress=False)
