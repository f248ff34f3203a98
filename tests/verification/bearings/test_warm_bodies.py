"""Bodies with temperatures under films: conduction in closed form, heat, growth of gaps, transients, refused input."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes import film_bearing, warm_sleeve
from scenes.warm_slider import SUPPLY, slider
from scenes.warm_slider import oil as slider_oil
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.thermal import ReducedThermal
from warpffrf.study import WarmRun

CLOSED_FORM = 2e-3  # of the rise: straight facets, 32 around
BALANCE = 1e-6  # of the heat
WALLS = 0.1  # K, to which walls settle
GROWN = 0.01  # of the growth: the pressure's own deformation
LATE = 0.2  # K


def thermal(body: wf.ReducedBody) -> ReducedThermal:
    assert body.thermal is not None
    return body.thermal


@cache
def warm() -> WarmRun:
    found = wf.study.warm_equilibrium(warm_sleeve.bearing())
    assert found.status == "completed", found.message
    return found


def test_a_sleeve_has_the_temperature_at_which_its_heat_leaves() -> None:
    """The mean of the bore is that of a ring under the mean flux, whatever its distribution."""
    found, film = warm(), warm().result.film("film")
    heat = found.heat["film"][-1, 0]
    inside = warm_sleeve.bore_rise(heat)
    bore = thermal(warm_sleeve.sleeve()).temperature(found.states["sleeve"][-1], "bore")
    weight = np.array([0.5, *[1.0] * (bore.shape[1] - 2), 0.5])
    rise = np.average(bore.mean(axis=0), weights=weight) - warm_sleeve.AMBIENT
    print(f"bore {rise:.3f} K above the surroundings, closed form {inside:.3f} K; {bore.min():.1f} to {bore.max():.1f}")
    assert rise == pytest.approx(inside, rel=CLOSED_FORM)
    # the film had these walls, its heat is balanced, and heat flows from hot to cold
    temperature = found.scene.films[0].temperature
    assert temperature is not None
    np.testing.assert_allclose(bore, np.asarray(temperature.wall_a), atol=WALLS)
    assert heat == film.heat_to_a[-1] > 0.3 * film.heat_generated[-1]
    left = film.heat_generated[-1] - film.heat_carried[-1] - film.heat_to_a[-1]
    assert abs(left) < BALANCE * film.heat_generated[-1]
    assert SUPPLY < found.hottest("sleeve")[-1] < film.temperature.max()
    assert found.walls["film"].shape == (1, 2) and np.isnan(found.walls["film"][0, 1])


def test_a_cooled_sleeve_cools_its_film() -> None:
    alone = wf.equilibrium(warm_sleeve.bearing(), progress=False)
    adiabatic = alone.film("film")
    assert any("is adiabatic here, although its body conducts heat" in note for note in alone.history.notes)
    assert not any("is adiabatic here" in note for note in warm().result.history.notes)
    film = warm().result.film("film")
    assert film.temperature.max() < adiabatic.temperature.max()
    assert film.friction_power[-1] > adiabatic.friction_power[-1]


def test_a_gap_grows_with_its_sleeve() -> None:
    """A sleeve that is free outside, evenly warmer by 60 K: its bore grows by alpha R 60 K; the mean of the gap around
    is the clearance, wherever the shaft is."""
    body = warm_sleeve.sleeve()
    hot = warm_sleeve.AMBIENT + 60.0
    warmer = replace(body, thermal=replace(thermal(body), surroundings={"outside": hot}))
    scene = warm_sleeve.bearing(
        body=warmer, load=(1.0, 0.0), speed=1.0, slope=0.0, temperature=wf.films.FilmTemperature(hot, wall_a=hot)
    )
    found = wf.study.warm_equilibrium(scene)
    assert found.status == "completed", found.message
    gap = found.result.film("film").gap[-1].mean(axis=0)
    growth = gap - film_bearing.CLEARANCE
    expected = 12e-6 * 60.0 * warm_sleeve.RADIUS
    print(f"growth {growth * 1e6} um, closed form {expected * 1e6:.3f} um")
    np.testing.assert_allclose(growth, expected, rtol=GROWN)
    assert found.mean_temperature("sleeve")[-1] == pytest.approx(hot, abs=0.1)
    # an interface grows with it, in runs that start from there
    again = wf.equilibrium(found.scene, progress=False)
    np.testing.assert_allclose(again.film("film").gap[-1], found.result.film("film").gap[-1], rtol=1e-6)


def test_a_machine_warms_up_to_its_equilibrium() -> None:
    scene = warm_sleeve.bearing()
    slow = thermal(warm_sleeve.sleeve()).time
    run = wf.study.warm_up(scene, 8.0 * slow, step=2.0 * slow, start=warm_sleeve.AMBIENT)
    assert run.status == "completed", run.message
    mean = run.mean_temperature("sleeve")
    print("mean temperatures", mean.round(2), "of the equilibrium", warm().mean_temperature("sleeve"))
    assert mean[0] == pytest.approx(warm_sleeve.AMBIENT, abs=1e-4) and np.all(np.diff(mean) > -WALLS)
    assert mean[-1] == pytest.approx(warm().mean_temperature("sleeve")[-1], abs=LATE)
    np.testing.assert_allclose(run.time, np.arange(5) * 2.0 * slow)


@pytest.mark.slow
def test_steps_of_a_transient_converge_and_continue() -> None:
    """Energy: what films conduct into the body less what leaves outside is stored; of first order in the step."""
    scene, slow = warm_sleeve.bearing(), thermal(warm_sleeve.sleeve()).time
    ends = []
    for n in (1, 2, 4):
        run = wf.study.warm_up(scene, 0.4 * slow, step=0.4 * slow / n, start=warm_sleeve.AMBIENT)
        assert run.status == "completed", run.message
        ends.append(run.mean_temperature("sleeve")[-1])
    first, second = np.diff(ends)
    print("ends", ends)
    assert abs(second) < 0.75 * abs(first) and abs(first) < 2.0
    half = wf.study.warm_up(scene, 0.2 * slow, step=0.2 * slow, start=warm_sleeve.AMBIENT)
    rest = wf.study.warm_up(scene, 0.2 * slow, step=0.2 * slow, start=half)
    assert rest.time[0] == half.time[-1]
    assert rest.mean_temperature("sleeve")[-1] == pytest.approx(ends[1], abs=LATE)


@pytest.mark.slow
def test_the_heat_of_a_motion_is_that_of_its_rows() -> None:
    """A shaft that has settled: the motion generates what the equilibrium does."""
    found = wf.study.warm_equilibrium(
        warm_sleeve.bearing(temperature=wf.films.FilmTemperature(SUPPLY, wall_a=warm().walls["film"][0, 0])),
        run=lambda scene: wf.simulate(scene, 4e-3, step=2e-4, start="equilibrium", progress=False),
    )
    assert found.status == "completed", found.message
    assert found.heat["film"][0, 0] == pytest.approx(warm().heat["film"][0, 0], rel=0.02)


def test_a_wall_of_even_temperature_is_one_number() -> None:
    """Nodes of one temperature give the film of a number; of two halves, the film is colder and warmer there."""
    gaps = (30e-6, 20e-6)
    films = []
    for wall in (50.0, np.full((65, 9), 50.0), np.repeat([[45.0], [55.0]], [33, 32], axis=0) * np.ones(9)):
        heated = wf.films.FilmTemperature(SUPPLY, wall_a=wall)
        made = slider(gaps, oil=slider_oil(0.02), temperature=heated, cells=64)
        films.append(wf.equilibrium(made, progress=False).film("film"))
    np.testing.assert_allclose(films[1].temperature, films[0].temperature, rtol=1e-12)
    np.testing.assert_allclose(films[1].heat_to_a, films[0].heat_to_a, rtol=1e-9)
    halves = films[2].temperature[-1][:, 4] - films[0].temperature[-1][:, 4]
    assert halves[20] < -1.0 and halves[-2] > 1.0
    left = films[2].heat_generated - films[2].heat_carried - films[2].heat_to_a
    assert abs(left[-1]) < BALANCE * films[2].heat_generated[-1]


def test_temperatures_that_run_away_are_named() -> None:
    scene = warm_sleeve.bearing(body=warm_sleeve.sleeve(0.1), speed=6000.0, slope=0.0, load=None, viscosity=0.2)
    found = wf.study.warm_equilibrium(scene)
    assert found.status == "too_hot", found.status
    assert "film" in found.message and "300 degrees Celsius" in found.message


def test_what_has_no_temperatures_is_refused() -> None:
    plain: Any = film_bearing.bearing(film_bearing.bore((32, 7)), (1e3, 0.0), feeds=[film_bearing.GROOVE])
    with pytest.raises(InputError, match="no film with a temperature is on a body with temperatures"):
        wf.study.warm_equilibrium(plain)
    with pytest.raises(InputError, match="a Scene is needed first"):
        wf.study.warm_equilibrium("scene")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="subtract 273.15"):
        wf.study.warm_up(warm_sleeve.bearing(), 10.0, step=10.0, start=350.0)
    scene = warm_sleeve.bearing(temperature=wf.films.FilmTemperature(SUPPLY, wall_a=np.full((3, 3), 50.0)))
    with pytest.raises(InputError, match="those of the contact grid"):
        wf.equilibrium(scene, progress=False)
    state = thermal(warm_sleeve.sleeve()).uniform(50.0)
    with pytest.raises(InputError, match="thermal load: a body of the scene and a state"):
        wf.forces.ThermalLoad(scene.bodies[0], 50.0)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="is rigid"):
        wf.forces.ThermalLoad(scene.bodies[1], state)


def test_an_interrupted_transient_keeps_its_rows() -> None:
    """The run that is interrupted is the last one, and what was there before is kept."""
    scene, slow = warm_sleeve.bearing(), thermal(warm_sleeve.sleeve()).time
    calls: list[float] = []

    def run(scene: wf.Scene) -> wf.Result:
        found = wf.equilibrium(scene, progress=False)
        calls.append(slow)
        if len(calls) == 3:  # of the first row one, of the second the second of several rounds
            found.history.status = wf.Status.INTERRUPTED
        return found

    ended = wf.study.warm_up(scene, 0.5 * slow, step=0.1 * slow, start=60.0, run=run, progress=False)
    assert ended.status == "interrupted" and len(calls) == 3
    assert len(ended.time) == 2 and ended.mean_temperature("sleeve")[0] == pytest.approx(60.0)


def test_stress_of_a_body_that_expands_is_not_given() -> None:
    """Strains of free expansion are none of stresses: taken for such, 60 K would be 400 MPa in each direction."""
    body = wf.reduce(
        wf.mesh.box((0.04, 0.02, 0.01), (4, 2, 2), order=1), warm_sleeve.STEEL, interfaces={"x_min": "average"},
        contact={"z_max": None}, modes=4, stress={"skin": "skin"}, progress=False,
        thermal=wf.films.BodyTemperature(convection={"x_max": (100.0, 20.0)}),
    )  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, 0))
    block = scene.add_body(body, name="block")
    scene.add(wf.joints.Fixed(scene.ground, block["x_min"]))
    cold = wf.equilibrium(scene, progress=False)
    assert np.all(cold.stress("block", "skin").von_mises < 1.0) and "von_mises" in cold.skins()["block"].fields
    scene.add(wf.forces.ThermalLoad(block, thermal(body).uniform(80.0), name="warm"))
    hot = wf.equilibrium(scene, progress=False)
    with pytest.raises(InputError, match="body 'block' has a thermal load: its stress is not known"):
        hot.stress("block", "skin")
    skin = hot.skins()["block"]
    assert "von_mises" not in skin.fields and "has a thermal load" in skin.stress.note
