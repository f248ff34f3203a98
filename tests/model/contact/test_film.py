"""Oil films as they are described: what is refused and with which cure, given pressures, forms, hashes, scene files."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model import films, laws, oils, surfaces
from warpffrf.model.bodies import SurfacePort
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.files.object_arrays import from_arrays, to_arrays
from warpffrf.model.films import Film
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.scene import Scene
from warpffrf.scene_file import load_scene
from warpffrf.scene_file.forms import flat

OIL = oils.Newtonian(0.04)
FILM = flat(Film, mixed=films.MixedLubrication)  # as of scene files
R, CLEARANCE, WIDTH = 0.05, 50e-6, 0.02
AXIS: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
SHAFT, BORE = surfaces.Cylinder(radius=R - CLEARANCE, **AXIS), surfaces.Bore(radius=R, **AXIS)
FLOOR = surfaces.Plane(origin=(0, 0, 0), outward=(0, 1, 0), direction=(0, 0, 1))
CUBE = (1.0, 1.0, 1.0)
ASPERITIES = laws.ExponentialAsperities(1e8, 1e-6)
ROUND_OFF = 1e-14

Pair = tuple[Scene, SurfacePort, SurfacePort]


def flexible(scene: Scene, body_maker: Callable, shape: Any, grid: SurfaceGrid | None = None, **sizes: Any) -> Any:
    """The surface of a made-up body with a contact grid; of 16 columns and 7 rows on the full turn."""
    body = body_maker(**{"columns": 16, "rows": 7, "width": WIDTH} | sizes)
    surface = body.contact_surfaces["rim"]
    surface = replace(surface, shape=shape, grid=surface.grid if grid is None else grid)
    name = f"housing {len(scene.bodies)}" if scene.bodies else "housing"
    return scene.add_body(replace(body, contact_surfaces={"rim": surface}), name=name)["rim"]


def rigid(scene: Scene, shape: Any, name: str = "shaft") -> Any:
    return scene.add_rigid_body(1.0, CUBE, name=name, surfaces={"skin": shape})["skin"]


@pytest.fixture
def pair(body_maker) -> Pair:
    """A rigid shaft in a flexible bore."""
    scene = Scene()
    return scene, flexible(scene, body_maker, BORE), rigid(scene, SHAFT)


@pytest.fixture
def pad(body_maker) -> Pair:
    """A flexible pad of 11 x 7 nodes on the ground: theta from -10 to 10 mm, z likewise."""
    scene = Scene()
    shape = surfaces.Plane(origin=(0, 0, 0), outward=(0, -1, 0), direction=(0, 0, 1))
    grid = SurfaceGrid(shape.e_0, -0.01, 0.002, 11, False, np.linspace(-0.01, 0.01, 7), 1)
    return scene, flexible(scene, body_maker, shape, grid), scene.ground.surface(FLOOR, name="floor")


def refused(words: str, a: Any, b: Any, **options: Any) -> None:
    with pytest.raises(InputError, match=words):
        FILM(a, b, **{"oil": OIL, "ambient_pressure": 1e5, "name": "bearing"} | options)


# --- what is refused


def test_ports_and_bodies_are_named(pair: Pair, body_maker) -> None:
    scene, bore, shaft = pair
    refused(r"film: the first surface must be a contact surface, body\['bore'\].*got housing", bore.body["bore"], shaft)
    refused(r"film: the second surface must be a contact surface", bore, "shaft")
    refused(r"film 'bearing': housing\['rim'\] and housing\['rim'\] are on one body", bore, bore)
    refused(r"first surface, which must be flexible.*Film\(housing\['rim'\], shaft\['skin'\]", shaft, bore)
    refused(r"both rigid.*scene.add_body\(reduce", rigid(scene, BORE, "third"), shaft)


def test_what_is_no_option_is_named(pair: Pair) -> None:
    _, bore, shaft = pair
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"oil": 0.04}, "film 'bearing': oil must be one of oils.Newtonian"),
        ({"cavitation": "gumbel"}, "film 'bearing': cavitation 'gumbel' does not exist; known: 'jfo'"),
        ({"quadrature": "whole"}, "film 'bearing': quadrature 'whole' does not exist; known: 'full', 'reduced'"),
        (
            {"boundary_friction": 0.1},
            "films.MixedLubrication: boundary_friction is that of asperities.*asperities=laws.ExponentialAsperities",
        ),
        (
            {"boundary_friction": -0.1, "asperities": ASPERITIES},
            "films.MixedLubrication: boundary_friction must not be negative",
        ),
        ({"ambient_pressure": -1.0}, r"film 'bearing': ambient_pressure \[Pa\] must not be negative"),
        ({"ambient_pressure": "1e5"}, "ambient_pressure.*must be a number"),
        ({"ambient_pressure": 0.0}, r"the film has no supply.*feeds=\[films.AxialGroove.*ambient_pressure above 0"),
        (
            {"feeds": films.AxialGroove(0.0, 0.01, 1e5)},
            "feeds must be a list of films.AxialGroove, films.CircumferentialGroove, films.SupplyHole",
        ),
        ({"feeds": [1e5]}, "feeds must be a list of films.AxialGroove.*number 1 is 100000"),
        ({"form_a": 1e-6}, "film 'bearing': form_a must be one of films.LobedForm, films.BarrelForm"),
        ({"form_b": 1e-6}, "film 'bearing': form_b must be one of films.LobedForm"),
        ({"asperities": 1e12}, "films.MixedLubrication: asperities must be one of"),
        ({"roughness_b": 1e-6}, "films.MixedLubrication: roughness_b must be films.Roughness"),
        ({"asperities": laws.Unilateral()}, "unilateral has no pressure to a gap.*laws.ExponentialAsperities"),
        (
            {"asperities": laws.LinearLayer(1e12)},
            "linear_layer begins where the surfaces touch.*laws.ExponentialAsperities",
        ),
        ({"asperities": laws.HuntCrossley(1e12, 1.5, damping=1.0)}, "hunt_crossley begins where the surfaces touch"),
    ]
    for options, words in wrong:
        refused(words, bore, shaft, **options)


def test_what_profiles_cannot_be_is_named(pair: Pair) -> None:
    _, bore, shaft = pair
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"ambient_pressure": 1e5}, "end without pressure, and ambient_pressure is 100000 Pa; take quadrature='full'"),
        (
            {"cavitation": "half_sommerfeld"},
            "cavitation 'half_sommerfeld' cuts pressures at zero.*take quadrature='full'",
        ),
        ({"asperities": ASPERITIES}, "asperities stand at nodes.*take quadrature='full'"),
        ({"feeds": [films.CircumferentialGroove(0.0, 0.001, 1e5)]}, "must be a Groove over the whole length"),
        ({"axial_degrees": (1, 2)}, r"axial_degrees must rise from 0 to 8 at most, as \(0, 2\).*got \(1, 2\)"),
        ({"axial_degrees": 2}, "axial_degrees must rise from 0 to 8 at most.*got 2"),
        ({"axial_degrees": (0, 2, 2)}, "axial_degrees must rise"),
        ({"axial_degrees": (0, 10)}, "axial_degrees must rise"),
    ]
    for options, words in wrong:
        feeds = [films.AxialGroove(0.0, 0.01, 1e5)]
        given = {"quadrature": "reduced", "ambient_pressure": 0.0, "feeds": feeds} | options
        refused(words, bore, shaft, **given)


def test_laws_that_reach_out_are_taken(pair: Pair) -> None:
    _, bore, shaft = pair
    for law in (ASPERITIES, laws.TabulatedLayer((-1e-6, 2e-6), (1e8, 0.0))):
        film = Film(bore, shaft, oil=OIL, ambient_pressure=1e5, mixed=films.MixedLubrication(law))
        assert film.mixed.asperities is law


def test_a_film_that_nothing_keeps_wet_is_taken_where_oil_is_not_counted(pair: Pair) -> None:
    _, bore, shaft = pair
    for cavitation in films.CAVITATIONS:
        feeds = [films.AxialGroove(0.0, 0.01, 0.0)] if cavitation == "jfo" else []
        assert Film(bore, shaft, oil=OIL, cavitation=cavitation, feeds=feeds).cavitation == cavitation


def test_surfaces_without_a_gap_name_both_radii(body_maker) -> None:
    scene = Scene()
    bore = flexible(scene, body_maker, BORE)
    shaft = flexible(scene, body_maker, SHAFT)
    for number, (first, second, words) in enumerate(
        [
            (bore, surfaces.Cylinder(radius=R, **AXIS), r"radius 0.05 m and .*radius 0.05 m leave no gap.*housing\["),
            (bore, surfaces.Cylinder(radius=0.051, **AXIS), "clearance is -0.001 m"),
            (bore, surfaces.Cylinder(radius=0.03, **AXIS), "are not conformal.*0.67 of the radius.*between rollers"),
            (bore, surfaces.Bore(radius=0.03, **AXIS), "both inner surfaces.*must be a shaft"),
            (bore, FLOOR, "one is a plane and one an inner surface"),
            (shaft, surfaces.Cylinder(radius=R, **AXIS), "both outer surfaces, and films between rollers"),
            (shaft, surfaces.Bore(radius=0.04, **AXIS), r"leave no gap.*opposite 5\['skin'\] lies around the other"),
        ]
    ):
        refused(words, first, rigid(scene, second, f"opposite {number - 1}"))


def test_clearances(body_maker, pad: Pair) -> None:
    scene = Scene()
    bore, shaft = flexible(scene, body_maker, BORE), flexible(scene, body_maker, SHAFT)
    for number, (first, second) in enumerate(((bore, SHAFT), (shaft, BORE))):
        film = Film(first, rigid(scene, second, f"{number}"), oil=OIL, ambient_pressure=1e5)
        assert film.clearance() == pytest.approx(CLEARANCE, rel=1e-10)
        np.testing.assert_allclose(film.initial_gap(), np.full((16, 7), CLEARANCE), rtol=1e-10)
    on_floor = Film(*pad[1:], oil=OIL, ambient_pressure=1e5)
    assert on_floor.clearance() is None and np.all(np.abs(on_floor.initial_gap()) < ROUND_OFF)
    roller = Film(shaft, scene.ground.surface(FLOOR, name="floor"), oil=OIL, ambient_pressure=1e5)
    assert roller.clearance() is None
    cones = [kind(radius=R, half_angle=0.1, **AXIS) for kind in (surfaces.ConicalBore, surfaces.Cone)]
    seat = Film(flexible(scene, body_maker, cones[0]), rigid(scene, cones[1], "plug"), oil=OIL, ambient_pressure=1e5)
    assert seat.clearance() is None


def test_grids_too_coarse_for_a_film(body_maker) -> None:
    scene = Scene()
    shaft = rigid(scene, SHAFT)
    coarse: list[tuple[dict[str, Any], str]] = [
        ({"rows": 4}, "16 columns and 2 rows"),
        ({"columns": 7}, "7 columns and 5 rows"),
    ]
    for sizes, words in coarse:
        refused(f"{words} between its ends, and a film needs 8 columns and 3 rows at least; reduce .*spacing of the",
                flexible(scene, body_maker, BORE, **sizes), shaft)  # fmt: skip
    cells = SurfaceGrid(BORE.e_0, 0.0, np.pi / 8, 16, True, np.linspace(-0.01, 0.01, 7), 1, "cells")
    on_cells = flexible(scene, body_maker, BORE, cells)
    refused("the first surface.*traction='cells'.*reduce the body with traction='nodes'", on_cells, shaft)
    on_cells, bore = flexible(scene, body_maker, SHAFT, cells), flexible(scene, body_maker, BORE)
    refused("the second surface.*traction='cells'.*reduce the body with traction='nodes'", bore, on_cells)


# --- given pressures


def test_ends_hold_the_ambient_pressure(pair: Pair, pad: Pair) -> None:
    held, pressure = Film(*pair[1:], oil=OIL, ambient_pressure=2e5).held()
    assert held.shape == pressure.shape == (16, 7)
    assert held[:, [0, -1]].all() and not held[:, 1:-1].any()
    np.testing.assert_array_equal(pressure, np.where(held, 2e5, 0.0))
    held, pressure = Film(*pad[1:], oil=OIL, ambient_pressure=2e5).held()
    assert held[[0, -1]].all() and held[:, [0, -1]].all() and not held[1:-1, 1:-1].any()
    np.testing.assert_array_equal(pressure, np.where(held, 2e5, 0.0))


def given(pair: Pair, *feeds: Any) -> tuple[np.ndarray, list[str]]:
    """Pressures (columns, rows) [Pa], -1 where they are not given; notes."""
    film = Film(*pair[1:], oil=OIL, ambient_pressure=1e5, feeds=feeds)
    held, pressure = film.held()
    return np.where(held, pressure, -1.0), film.notes


def test_a_groove_holds_columns_but_not_the_ends(pair: Pair) -> None:
    pitch = 2.0 * np.pi / 16 * R
    found, notes = given(pair, films.AxialGroove(-np.pi / 8, 2.1 * pitch, 3e5))  # columns 14, 15 and 0
    assert (found[[14, 15, 0], 1:-1] == 3e5).all() and (found[1:14, 1:-1] == -1.0).all()
    assert (found[:, [0, -1]] == 1e5).all() and not notes
    found, _ = given(pair, films.AxialGroove(0.0, 0.5 * pitch, 3e5, z=(-0.0034, 1.0)))
    assert (found[0, 2:] == 3e5).all() and found[0, 1] == -1.0


def test_a_ring_holds_rows_and_a_hole_nodes(pair: Pair) -> None:
    found, notes = given(
        pair, films.CircumferentialGroove(0.0, 0.007, 3e5), films.SupplyHole(np.pi, 0.02 / 3.0, 0.002, 3e5)
    )
    assert (found[:, 2:5] == 3e5).all() and found[8, 5] == 3e5 and np.sum(found == 3e5) == 3 * 16 + 1
    assert not notes
    flooded, _ = given(pair, films.CircumferentialGroove(-0.01, 1e-3, 4e5))
    assert (flooded[:, 0] == 4e5).all() and (flooded[:, -1] == 1e5).all() and (flooded[:, 1:-1] == -1.0).all()


def test_what_lies_between_nodes_takes_the_nearest_and_says_so(pair: Pair) -> None:
    between = 0.4 * 2.0 * np.pi / 16
    found, notes = given(pair, films.AxialGroove(between, 1e-3, 3e5))
    assert (found[0, 1:-1] == 3e5).all() and np.sum(found == 3e5) == 5
    assert len(notes) == 1 and "film 'housing-shaft': feed 1, the groove at theta = 0.1571, lies between" in notes[0]
    found, notes = given(
        pair, films.AxialGroove(between, 1e-3, 3e5, z=(0.001, 0.002)), films.CircumferentialGroove(0.0098, 1e-4, 2e5)
    )
    assert found[0, 3] == 3e5 and (found[:, 5] == 2e5).all() and len(notes) == 2
    found, notes = given(pair, films.SupplyHole(np.pi + between, -0.0099, 1e-5, 3e5))
    assert found[8, 1] == 3e5 and np.sum(found == 3e5) == 1 and "nearest one has" in notes[0]


def test_theta_counts_from_the_shape_not_from_the_grid(body_maker) -> None:
    scene = Scene()
    turned = np.cos(np.pi / 8) * BORE.e_0 + np.sin(np.pi / 8) * BORE.e_1  # by a column
    grid = SurfaceGrid(turned, 0.0, np.pi / 8, 16, True, np.linspace(-0.01, 0.01, 7), 1)
    bore = flexible(scene, body_maker, BORE, grid)
    film = Film(bore, rigid(scene, SHAFT), oil=OIL, feeds=[films.AxialGroove(np.pi / 2, 0.01, 1e5)])
    assert film.theta[3] == pytest.approx(np.pi / 2, abs=ROUND_OFF)
    assert film.held()[0][3].all() and np.sum(film.held()[0][:, 1:-1]) == 5


def test_feeds_of_an_arc(body_maker) -> None:
    scene = Scene()
    grid = SurfaceGrid(BORE.e_0, np.pi - 0.5, 0.1, 11, False, np.linspace(-0.01, 0.01, 7), 1)
    arc = scene, flexible(scene, body_maker, BORE, grid), rigid(scene, SHAFT)
    found, _ = given(arc, films.AxialGroove(0.5 - np.pi, 0.001, 3e5))  # the last column, past the seam
    assert (found[-1, 1:-1] == 3e5).all() and (found[0] == 1e5).all() and (found[1:-1, 1:-1] == -1.0).all()
    refused("feed 1, the groove at theta = 0, lies outside the grid of housing.*from theta = 2.642 to 3.642",
            *arc[1:], feeds=[films.AxialGroove(0.0, 0.01, 1e5)])  # fmt: skip
    refused(
        r"the ring at z = 0.02, lies outside .*from z = -0.01 to 0.01 m",
        *arc[1:],
        feeds=[films.CircumferentialGroove(0.02, 1e-3, 1e5)],
    )


def test_feeds_of_a_pad(pad: Pair) -> None:
    found, _ = given(pad, films.AxialGroove(-0.01, 1e-3, 3e5), films.SupplyHole(0.004, 0.0, 1e-3, 2e5))
    assert (found[0, 1:-1] == 3e5).all() and (found[0, [0, -1]] == 1e5).all() and found[7, 3] == 2e5


def test_feeds_that_share_nodes(pair: Pair) -> None:
    groove, ring = films.AxialGroove(0.0, 0.01, 2e5), films.CircumferentialGroove(0.0, 0.001, 3e5)
    words = re.escape("feed 1, the groove at theta = 0, and feed 2, the ring at z = 0, share nodes")
    refused(f"{words}.*200000 and 300000 Pa; move them apart", *pair[1:], feeds=[groove, ring])
    found, _ = given(pair, groove, replace(ring, pressure=2e5))
    assert np.sum(found == 2e5) == 5 + 15
    refused("hold all nodes of the grid", *pair[1:], feeds=[films.CircumferentialGroove(0.0, 1.0, 2e5)])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: films.AxialGroove(0.0, 0.0, 1e5), "films.AxialGroove: width must be greater than zero"),
        (lambda: films.AxialGroove(0.0, 0.01, -1.0), "films.AxialGroove: pressure must not be negative"),
        (lambda: films.AxialGroove(0.0, 0.01, 1e5, z=(0.01, 0.0)),
        r"films.AxialGroove: z must be \(low, high\) with low < high"),
        (lambda: films.AxialGroove(0.0, 0.01, 1e5, z=0.01), "films.AxialGroove: z .*shape"),  # pyright: ignore[reportArgumentType]
        (lambda: films.CircumferentialGroove(np.nan, 0.01, 1e5), "films.CircumferentialGroove: z must be finite"),
        (lambda: films.SupplyHole(0.0, 0.0, -0.01, 1e5), "films.SupplyHole: diameter must be greater than zero"),
        (lambda: films.LobedForm(np.inf, 2), "films.LobedForm: amplitude .* must be finite"),
        (lambda: films.LobedForm(1e-6, 0), "films.LobedForm: count must be a whole number of at least 1"),
        (lambda: films.LobedForm(1e-6, 2.5), "films.LobedForm: count must be a whole number"),  # pyright: ignore[reportArgumentType]
        (lambda: films.BarrelForm(1e-6, 0.0), "films.BarrelForm: length .* must be greater than zero"),
        (lambda: films.WornForm(1e-6, 0.0, 4.0), "films.WornForm: width must be at most pi"),
        (lambda: films.MeasuredForm([0.0, 0.0], [0.0], [[0.0], [0.0]]),
        "films.MeasuredForm: theta must rise.*points 0 and 1"),
        (lambda: films.MeasuredForm([0.0], [0.1, 0.0], [[0.0, 0.0]]), "films.MeasuredForm: z must rise"),
        (lambda: films.MeasuredForm([0.0], [0.0], [[0.0, 0.0]]), r"values must have shape \(1, 1\)"),
        (lambda: films.MeasuredForm([0.0], [0.0], [[np.nan]]), "values .*NaN"),
        (lambda: films.MeasuredForm([], [0.0], [[0.0]]), "theta is empty"),
        (lambda: films.MeasuredForm([0.0, 2.0 * np.pi], [0.0], [[0.0], [0.0]]),
        "full revolution or more; leave out the last"),
        (lambda: films.CompositeForm((films.LobedForm(1e-6, 2), 1e-6)), "parts must be forms"),  # pyright: ignore[reportArgumentType]
        (lambda: films.CompositeForm(()), "parts is empty"),
    ],
)  # fmt: skip
def test_what_is_no_feed_or_form_is_named(make: Callable[[], Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()


# --- forms


def test_forms_have_their_closed_values() -> None:
    theta, z = np.linspace(-4.0, 4.0, 41)[:, None], np.linspace(-0.02, 0.02, 9)[None, :]
    lobes, barrel, worn = (
        films.LobedForm(5e-6, 2, 0.3),
        films.BarrelForm(3e-6, 0.04, 0.002),
        films.WornForm(8e-6, 3.0, 0.5),
    )
    np.testing.assert_allclose(lobes(theta, z), 5e-6 * np.cos(2.0 * (theta - 0.3)) + 0.0 * z, atol=1e-20)
    assert barrel(0.0, 0.022) == pytest.approx(3e-6) and barrel(1.0, 0.002) == 0.0
    assert barrel(0.0, -0.008) == pytest.approx(3e-6 / 4.0) and barrel(theta, z).shape == (41, 9)
    assert worn(3.0, 0.0) == 8e-6 and worn(3.25 - 2.0 * np.pi, 0.0) == pytest.approx(4e-6)
    assert worn(3.5, 0.0) == worn(0.0, 0.0) == 0.0
    both = lobes + barrel + worn
    assert isinstance(both, films.CompositeForm) and both.parts == (lobes, barrel, worn)
    np.testing.assert_allclose(both(theta, z), lobes(theta, z) + barrel(theta, z) + worn(theta, z), atol=1e-20)
    with pytest.raises(TypeError):
        _ = lobes + 1e-6


def test_measured_forms_are_straight_between_their_places() -> None:
    theta, z = np.array([0.0, 1.0, 2.0]), np.array([-0.01, 0.02])
    values = np.array([[1.0, 4.0], [2.0, 8.0], [0.0, 0.0]]) * 1e-6
    turning, lying = (films.MeasuredForm(theta, z, values, periodic) for periodic in (True, False))
    for form in (turning, lying):
        for i, k in np.ndindex(3, 2):
            assert form(theta[i], z[k]) == values[i, k]
        assert form(0.5, 0.005) == pytest.approx(3.75e-6, rel=1e-12)
        assert form(1.0, 0.5) == values[1, 1] and form(1.0, -0.5) == values[1, 0]
    assert lying(-1.0, -0.01) == values[0, 0] and lying(3.0, 0.02) == values[2, 1]
    assert turning(1.0 - 2.0 * np.pi, 0.02) == pytest.approx(8e-6)
    assert turning(1.0 + np.pi, -0.01) == pytest.approx(0.5e-6)  # half way from the last place to the first
    single = films.MeasuredForm([0.0], z, values[:1])
    assert single(2.0, 0.005) == pytest.approx(2.5e-6)


def test_forms_add_to_the_gap_of_their_surface(pair: Pair) -> None:
    _, bore, shaft = pair
    oval, barrel = films.LobedForm(5e-6, 2), films.BarrelForm(4e-6, WIDTH)
    plain = Film(bore, shaft, oil=OIL, ambient_pressure=1e5)
    film = Film(bore, shaft, oil=OIL, ambient_pressure=1e5, form_a=oval, form_b=barrel)
    theta, z = film.theta[:, None], film.grid.z[None, :]
    assert not plain.gap_form(theta, z).any() and plain.second_form(theta, z).shape == (16, 7)
    np.testing.assert_array_equal(film.gap_form(theta, z), oval(theta, z))
    np.testing.assert_array_equal(film.second_form(theta, z), barrel(theta, z))
    np.testing.assert_allclose(film.initial_gap(), CLEARANCE + oval(theta, z) + barrel(theta, z), rtol=1e-9)
    shaft.body.position = (0.0, 0.003, 10e-6)  # the shaft's barrel moves with it
    off = np.array([0.0, 0.0, 10e-6]) @ BORE.normal(theta, z)[..., None]
    moved = CLEARANCE + off[..., 0] + oval(theta, z) + barrel(theta, z - 0.003)
    np.testing.assert_allclose(film.initial_gap(), moved, atol=2e-9)  # e^2/2R of a shifted circle


def test_forms_that_turn_have_no_place_on_a_plane(pad: Pair) -> None:
    for form in (films.LobedForm(1e-6, 2), films.BarrelForm(1e-6, 0.02) + films.WornForm(1e-6, 0.0, 0.1)):
        refused(
            r"form_a is periodic around the axis, but housing\['rim'\] is a plane; take films", *pad[1:], form_a=form
        )
        refused(r"form_b is periodic around the axis, but ground\['floor'\]", *pad[1:], form_b=form)
    flat = films.MeasuredForm([-0.01, 0.01], [0.0], [[0.0], [1e-6]], periodic=False)
    assert Film(*pad[1:], oil=OIL, ambient_pressure=1e5, form_a=flat).form_a is flat


# --- scenes


def test_every_parameter_is_part_of_the_hash(pair: Pair) -> None:
    scene, bore, shaft = pair
    feeds = [films.AxialGroove(0.0, 0.01, 1e5)]
    variants: list[dict[str, Any]] = [
        {}, {"oil": oils.Newtonian(0.05)}, {"oil": oils.Barus(0.04, coefficient=1e-8)}, {"feeds": feeds},
        {"feeds": [replace(feeds[0], pressure=2e5)]}, {"feeds": [replace(feeds[0], z=(-0.005, 0.005))]},
        {"cavitation": "reynolds"}, {"ambient_pressure": 2e5}, {"asperities": ASPERITIES},
            {"form_a": films.LobedForm(1e-6, 2)},
        {"form_a": films.LobedForm(1e-6, 3)}, {"form_b": films.LobedForm(1e-6, 2)},
        {"form_a": films.MeasuredForm([0.0], [0.0], [[1e-6]])}, {"form_a": films.MeasuredForm([0.0], [0.0], [[2e-6]])},
        {"form_a": films.LobedForm(1e-6, 2) + films.BarrelForm(1e-6, 0.02)}, {"name": "other"},
        {"asperities": ASPERITIES, "boundary_friction": 0.1}, {"quadrature": "reduced", "feeds": feeds,
            "ambient_pressure": 0.0},
        {"quadrature": "reduced", "feeds": feeds, "ambient_pressure": 0.0, "axial_degrees": (0, 2)},
    ]  # fmt: skip
    without, hashes = scene.content_hash(), set()
    for options in variants:
        film = scene.add(FILM(bore, shaft, **{"oil": OIL, "ambient_pressure": 1e5} | options))
        hashes.add(scene.content_hash())
        scene.films.remove(film)
    assert len(hashes) == len(variants) and scene.content_hash() == without and without not in hashes


def test_a_scene_takes_films_by_name(pair: Pair) -> None:
    scene, bore, shaft = pair
    film = scene.add(Film(bore, shaft, oil=OIL, feeds=[films.AxialGroove(0.1, 1e-3, 1e5)]))
    assert scene.films == [film] and film.name == "housing-shaft" and scene.film("housing-shaft") is film
    with pytest.raises(InputError, match="film 'housing-shaft' is in the scene already"):
        scene.add(film)
    with pytest.raises(InputError, match="film 'bearing' does not exist; known: 'housing-shaft'"):
        scene.film("bearing")
    with pytest.raises(InputError, match="film 'x': body 'housing' belongs to another scene"):
        Scene().add(Film(bore, shaft, oil=OIL, ambient_pressure=1e5, name="x"))
    check = scene.check()
    assert check.films["housing-shaft"] == pytest.approx((CLEARANCE, CLEARANCE)) and check.film_notes == (*film.notes,)
    assert "clearance [m]" in str(check) and "feed 1, the groove" in str(check)
    assert check.unsupported == ("housing", "shaft")


def test_a_film_holds_its_bodies_to_the_ground(pad: Pair) -> None:
    scene, *surfaces_ = pad
    assert scene.check().unsupported == ("housing",)
    scene.add(Film(*surfaces_, oil=OIL, ambient_pressure=1e5))
    assert scene.check().unsupported == () and re.search(r"housing-ground +- ", str(scene.check()))


def test_a_film_has_its_surfaces_alone(pair: Pair, body_maker) -> None:
    scene, bore, shaft = pair
    words = r"contact 'dry' and film 'wet' act on the same two surfaces.*Film\(..., mixed=films.MixedLubrication\("
    film, contact = Film(bore, shaft, oil=OIL, ambient_pressure=1e5, name="wet"), Contact(bore, shaft, name="dry")
    for first, second in ((film, contact), (contact, film)):
        scene.add(first)
        with pytest.raises(InputError, match=words):
            scene.add(second)
        getattr(scene, first.scene_list).clear()
    scene.films.append(film)
    scene.contacts.append(contact)
    with pytest.raises(InputError, match=words):
        scene.check()
    scene.contacts.clear()
    with pytest.raises(InputError, match=r"film 'again': on the grid of housing\['rim'\] there is film 'wet' already"):
        scene.add(Film(bore, rigid(scene, SHAFT, "other"), oil=OIL, ambient_pressure=1e5, name="again"))
    other = rigid(scene, SHAFT, "third")
    scene.add(Film(flexible(scene, body_maker, BORE), shaft, oil=OIL, ambient_pressure=1e5, name="second"))
    scene.add(Contact(bore, other, name="beside"))
    ball = rigid(scene, surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0)), "ball")
    scene.add(
        LumpedContact(ball, shaft, law=laws.HertzPoint(wf.Material(2e11, 0.3, 7800.0), wf.Material(2e11, 0.3, 7800.0)))
    )
    assert len(scene.films) == 2


def test_a_film_comes_back_from_arrays(pair: Pair) -> None:
    scene, bore, shaft = pair
    form = films.LobedForm(1e-6, 2) + films.MeasuredForm([0.0, 1.0], [0.0], [[0.0], [1e-6]])
    oil = oils.Barus(0.04, coefficient=1e-8, density=oils.DowsonHigginson())
    feeds = [films.AxialGroove(0.0, 0.01, 1e5, z=(-0.005, 0.005)), films.SupplyHole(2.0, 0.0, 0.004, 1e5)]
    scene.add(Film(bore, shaft, oil=oil, feeds=feeds, mixed=films.MixedLubrication(ASPERITIES), form_a=form))
    found: Any = from_arrays(*to_arrays(scene))
    assert found.content_hash() == scene.content_hash() and found.films[0].a.body is found.bodies[0]
    np.testing.assert_array_equal(found.films[0].held()[1], scene.films[0].held()[1])


def test_public_names() -> None:
    assert (
        wf.Film is Film is wf.films.Film
        and wf.films.AxialGroove is films.AxialGroove
        and wf.oils.Newtonian is oils.Newtonian
    )


# --- scene files

MACHINE = """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7800

[meshes.block]
kind = "box"
size = [0.04, 0.03, 0.01]
counts = [8, 5, 1]

[reduced_bodies.block]
mesh = "block"
material = "steel"
interfaces = { z_max = "rigid" }
contact = { z_min = "plane" }

[ground.floor]
kind = "plane"
origin = [0, 0, -20e-6]
outward = [0, 0, 1]

[bodies.pad]
body = "block"
position = [0, 0, 0.005]

[films.film]
a = "pad.z_min"
b = "ground.floor"
oil = { kind = "barus", viscosity = 0.04, coefficient = 1e-8, density = { kind = "dowson_higginson" } }
asperities = { kind = "exponential_asperities", pressure_at_zero = 1e8, decay_length = 1e-6 }
feeds = [{ kind = "supply_hole", theta = 0.0, z = 0.0, diameter = 0.006, pressure = 2e5 }]
form_a = { kind = "barrel_form", drop = 1e-6, length = 0.03 }
roughness_a = { kind = "roughness", deviation = 4e-7, pattern = 3.0 }
cavitation = "reynolds"
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "scene.toml"
    file.write_text(text)
    return file


def test_a_film_of_a_scene_file_is_that_of_python(tmp_path: Path) -> None:
    scene = load_scene(written(tmp_path, MACHINE)).scene
    from_file, (film,) = scene.content_hash(), scene.films
    scene.films.clear()
    oil = oils.Barus(0.04, coefficient=1e-8, density=oils.DowsonHigginson())
    hole, barrel = films.SupplyHole(0.0, 0.0, 0.006, 2e5), films.BarrelForm(1e-6, 0.03)
    mixed = films.MixedLubrication(ASPERITIES, roughness_a=films.Roughness(4e-7, 3.0))
    options: dict[str, Any] = {"oil": oil, "mixed": mixed, "feeds": [hole], "form_a": barrel}
    scene.add(Film(film.a, film.b, **options, cavitation="reynolds", name="film"))
    assert scene.content_hash() == from_file


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('kind = "barus"', 'kind = "linear_layer"', "linear_layer.*known: .*'barus'.*'iso_vg'"),
        ('kind = "barrel_form"', 'kind = "circumferential_groove"', "circumferential_groove.*known: 'lobed_form'"),
        ('kind = "exponential_asperities"', 'kind = "hertz_point"', "hertz_point"),
        ('kind = "roughness"', 'kind = "circumferential_groove"', "circumferential_groove.*known: 'roughness'"),
        ("pattern = 3.0", "pattern = 30.0", "pattern must lie from 1/9 to 9, where flow factors are known, got 30"),
        ('kind = "supply_hole", theta = 0.0', 'kind = "supply_hole", theta = 1.0',
        "hole at theta = 1, z = 0, lies outside"),
        ("diameter = 0.006", "diametre = 0.006", "diametre"),
        ('cavitation = "reynolds"', 'cavitation = "gumbel"', "gumbel"),
    ],
)  # fmt: skip
def test_errors_of_a_scene_file_name_the_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    text = MACHINE.replace(old, new)
    line = next(n for n, row in enumerate(text.splitlines(), start=1) if new in row)
    with pytest.raises(InputError, match=said) as caught:
        load_scene(written(tmp_path, text))
    assert f"scene.toml:{line}: " in str(caught.value)
