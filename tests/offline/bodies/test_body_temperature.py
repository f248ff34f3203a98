"""Temperature and thermal expansion of reduced bodies: scikit-fem, closed forms, invariants, refused input."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

import warpffrf as wf
from references.closed_forms.heat import disc, slab
from references.finite_elements.heat import HeatedBox
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.thermal import ReducedThermal

E, NU, RHO, K, C, ALPHA = 210e9, 0.3, 7850.0, 45.0, 460.0, 12e-6
STEEL = wf.Material(E, NU, RHO, conductivity=K, heat_capacity=C, expansion=ALPHA)
SIZE, COUNTS, H, AMBIENT = (0.06, 0.04, 0.02), (12, 8, 6), 400.0, 35.0
TOP = {"z_max": wf.surfaces.Plane()}
STEADY, STEP, FREE = 5e-3, 0.02, 1e-3  # of the largest temperature or displacement: what is promised
SAME_ELEMENTS = 1e-8  # steady states are those of the finite elements
SINGLE = 2e-6  # skin in single precision


@cache
def pad(modes: int = 12) -> wf.ReducedBody:
    """Cooled below, at which surroundings it has its dimensions."""
    heat = wf.films.BodyTemperature(convection={"z_min": (H, AMBIENT)}, reference=AMBIENT, modes=modes)
    mesh = wf.mesh.box(SIZE, COUNTS, center=(0, 0, 0.5 * SIZE[2]), order=1)
    return wf.reduce(
        mesh, STEEL, contact=TOP, interfaces={"x_min": "average", "x_max": "average"}, modes=4, thermal=heat,
        grid=wf.ContactGrid(contact_fixed=False), progress=False,
    )  # fmt: skip


def warm(body: wf.ReducedBody) -> ReducedThermal:
    assert body.thermal is not None
    return body.thermal


@cache
def reference() -> tuple[HeatedBox, np.ndarray]:
    """The same box, and the nodes of the reduced body's skin in it."""
    box = HeatedBox(
        SIZE, COUNTS, youngs_modulus=E, poisson_ratio=NU, density=RHO, conductivity=K, heat_capacity=C,
        expansion=ALPHA, h=H,
    )  # fmt: skip
    off = box.points - [0.5 * SIZE[0], 0.5 * SIZE[1], 0.0]
    skin = pad().surface.points
    apart = np.linalg.norm(skin[:, None] - off[None], axis=2)
    assert apart.min(axis=1).max() < 1e-9
    return box, apart.argmin(axis=1)


def hot_side() -> tuple[np.ndarray, Any]:
    """A flux that rises along the pad, at the grid's nodes [W/m2] and as a function of the place in the reference."""
    surface = pad().contact_surfaces["z_max"]
    grid = surface.grid
    theta, z = np.meshgrid(grid.theta, grid.z, indexing="ij")
    x, y = surface.shape.point(theta, z)[..., 0], surface.shape.point(theta, z)[..., 1]

    def at(x: Any, y: Any) -> Any:
        return 1e5 * (1.0 + 0.8 * np.sin(50.0 * x) + 0.3 * np.cos(70.0 * y))

    nodes = at(x, y)
    # the outermost columns have no function: the flux falls to zero there
    table = np.zeros((COUNTS[0] + 1, COUNTS[1] + 1))
    lines = [np.linspace(-0.5 * s, 0.5 * s, n + 1) for s, n in zip(SIZE[:2], COUNTS[:2], strict=True)]
    table[np.searchsorted(lines[0], x - 1e-6), np.searchsorted(lines[1], y - 1e-6)] = nodes
    interpolated = RegularGridInterpolator(lines, table, bounds_error=False, fill_value=0.0)

    def flux(X: Any, Y: Any) -> Any:
        return interpolated(np.stack([X - 0.5 * SIZE[0], Y - 0.5 * SIZE[1]], axis=-1))

    return nodes, flux


def test_steady_conduction_and_expansion_are_those_of_the_finite_elements() -> None:
    box, skin = reference()
    nodes, flux = hot_side()
    state = warm(pad()).steady({"z_max": nodes})
    theta = box.steady(box.load(flux))
    found = warm(pad()).skin_temperature(state) - AMBIENT
    largest = np.abs(theta).max()
    print(f"steady: {np.abs(found - theta[skin]).max() / largest:.1e} of {largest:.1f} K")
    np.testing.assert_allclose(found, theta[skin], atol=SINGLE * largest)
    assert warm(pad()).hottest(state) == pytest.approx(AMBIENT + largest, rel=SINGLE)
    mean = (box.C @ theta).sum() / box.C.sum()
    assert warm(pad()).mean_temperature(state) - AMBIENT == pytest.approx(mean, rel=SAME_ELEMENTS)
    u = box.expansion(theta)
    free = pad().expansion(state)
    print(f"expansion: {np.abs(free.skin - u[skin]).max() / np.abs(u).max():.1e} of {np.abs(u).max() * 1e6:.2f} um")
    np.testing.assert_allclose(free.skin, u[skin], atol=SINGLE * np.abs(u).max())


def test_a_step_of_flux_heats_and_bends_as_the_finite_elements_do() -> None:
    box, skin = reference()
    nodes, flux = hot_side()
    load, heat = box.load(flux), warm(pad())
    largest, thickest = np.abs(box.steady(load)).max(), np.abs(box.expansion(box.steady(load))).max()
    cold = heat.uniform(AMBIENT)
    for part in (1e-3, 1e-2, 0.1, 1.0):
        time = part * heat.time
        state = heat.advance(cold, time, flux={"z_max": nodes})
        theta = box.after(time, load)
        off = np.abs(heat.skin_temperature(state) - AMBIENT - theta[skin]).max() / largest
        u = np.abs(pad().expansion(state).skin - box.expansion(theta)[skin]).max() / thickest
        near = np.abs(heat.skin_temperature(state) - AMBIENT - theta[skin]).max() / np.abs(theta).max()
        print(f"{time:8.3f} s: temperature {off:.2e}, of its own largest {near:.2e}, displacement {u:.2e}")
        assert max(off, u) < STEP


def test_a_slab_under_a_step_of_flux_follows_the_closed_form() -> None:
    """The mean over the heated face is that of a slab under the same heat."""
    heat, surface = warm(pad()), pad().contact_surfaces["z_max"]
    part = surface.grid.columns / (surface.grid.columns + 1)  # the flux falls to zero in half a cell at two edges
    points = pad().surface.points
    face = np.flatnonzero(points[:, 2] > SIZE[2] - 1e-9)
    weight = np.ones(len(face))
    for i in range(2):
        weight *= np.where(np.abs(points[face, i]) > 0.5 * SIZE[i] - 1e-9, 0.5, 1.0)
    cold, q = heat.uniform(AMBIENT), 1e5
    last = slab(SIZE[2], 1e6, flux=q, length=SIZE[2], conductivity=K, diffusivity=K / (RHO * C), h=H)
    for time in (0.3, 1.0, 5.0, 30.0, 200.0):
        state = heat.advance(cold, time, flux={"z_max": q})
        found = (heat.skin_temperature(state)[face] @ weight / weight.sum() - AMBIENT) / part
        expected = slab(SIZE[2], time, flux=q, length=SIZE[2], conductivity=K, diffusivity=K / (RHO * C), h=H)
        print(f"{time:6.1f} s: {found:.4f} K, closed form {expected:.4f} K")
        assert abs(found - expected) < 5e-3 * last  # of the steady rise; six cells along the depth


def test_steps_follow_one_another_exactly_and_end_in_the_steady_state() -> None:
    heat = warm(pad())
    flux = {"z_max": 3e4}
    once = heat.advance(heat.uniform(50.0), 40.0, flux=flux)
    twice = heat.advance(heat.advance(heat.uniform(50.0), 25.0, flux=flux), 15.0, flux=flux)
    np.testing.assert_allclose(twice.amplitudes, once.amplitudes, rtol=1e-12)
    late = heat.advance(once, 40.0 * heat.time, flux=flux, surroundings={"z_min": 20.0})
    np.testing.assert_allclose(
        heat.temperature(late, "z_max"),
        heat.temperature(heat.steady(flux, surroundings={"z_min": 20.0}), "z_max"),
        rtol=1e-12,
    )


def test_a_body_in_warm_surroundings_takes_their_temperature_and_grows_evenly() -> None:
    body = pad()
    state = warm(body).steady(surroundings={"z_min": AMBIENT + 60.0})
    np.testing.assert_allclose(warm(body).skin_temperature(state), AMBIENT + 60.0, rtol=SINGLE)
    np.testing.assert_allclose(warm(body).temperature(state, "z_max"), AMBIENT + 60.0, rtol=SAME_ELEMENTS)
    assert warm(body).mean_temperature(state) == pytest.approx(AMBIENT + 60.0, rel=SAME_ELEMENTS)
    free = body.expansion(state)
    grown = ALPHA * 60.0 * (body.surface.points - body.center_of_mass)
    np.testing.assert_allclose(free.skin, grown, atol=SINGLE * np.abs(grown).max())
    # a rod of 60 mm: its ends move apart
    ends = free.interfaces["x_max"] - free.interfaces["x_min"]
    assert ends[0] == pytest.approx(ALPHA * 60.0 * SIZE[0], rel=FREE)
    np.testing.assert_allclose(ends[1:], 0.0, atol=1e-9 * ends[0])
    np.testing.assert_allclose(free.surfaces["z_max"], 0.5 * ALPHA * 60.0 * SIZE[2], rtol=1e-6)


@cache
def ring(fixed: bool = True) -> wf.ReducedBody:
    inner, outer = 0.02, 0.05
    mesh = wf.mesh.roller(outer, inner, 0.001, sectors=24, layers=10, axial=1, order=2)
    held: dict[str, Any] = {"fixed": {"rim": 40.0}} if fixed else {"convection": {"rim": (300.0, 40.0)}}
    return wf.reduce(
        mesh, STEEL, contact={"bore": wf.surfaces.Bore()}, modes=4,
        thermal=wf.films.BodyTemperature(reference=40.0, **held), grid=wf.ContactGrid(contact_fixed=False),
        progress=False,
    )  # fmt: skip


def test_a_ring_with_a_gradient_grows_as_in_closed_form() -> None:
    body, q = ring(), 5e4
    state = warm(body).steady({"bore": q})
    points = body.surface.points
    r = np.hypot(points[:, 0], points[:, 2])
    T, u = disc(r, inner=0.02, outer=0.05, flux=q, conductivity=K, rim=0.0, expansion=ALPHA, poisson_ratio=NU)
    off = np.abs(warm(body).skin_temperature(state) - 40.0 - T).max() / T.max()
    radial = np.sum((body.expansion(state).skin * points)[:, [0, 2]], axis=1) / r
    grown = np.abs(radial - u).max() / u.max()
    print(f"temperature {off:.1e} of {T.max():.1f} K, growth {grown:.1e} of {u.max() * 1e6:.3f} um")
    assert off < FREE and grown < FREE


def test_what_leaves_a_ring_by_convection_is_what_enters() -> None:
    body, q = ring(fixed=False), 5e4
    heat = warm(body)
    state = heat.steady({"bore": q})
    points = body.surface.points
    rim = np.hypot(points[:, 0], points[:, 2]) > 0.05 - 1e-6
    expected = 40.0 + q * 0.02 / (300.0 * 0.05)
    np.testing.assert_allclose(heat.skin_temperature(state)[rim], expected, rtol=1e-4)


def test_a_body_with_temperatures_is_stored(tmp_path: Any) -> None:
    body = pad()
    body.save(tmp_path / "pad.h5")
    again = wf.ReducedBody.load(tmp_path / "pad.h5")
    assert again.content_hash() == body.content_hash() and warm(again).surroundings == {"z_min": AMBIENT}
    state = warm(again).steady({"z_max": 1e4})
    assert warm(again).hottest(state) == warm(body).hottest(warm(body).steady({"z_max": 1e4}))
    assert (
        "thermal"
        not in wf.reduce(
            wf.mesh.box(SIZE, (2, 2, 2), order=1), STEEL, interfaces={"x_min": "rigid"}, progress=False
        ).provenance["settings"]
    )


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "heat has no way to leave the body"),
        ({"convection": {"back": (0.0, 20.0)}}, "h .* must be greater than zero"),
        ({"convection": {"back": 40.0}}, "convection of 'back'"),
        ({"fixed": {"back": 313.15}}, "from kelvins subtract 273.15"),
        ({"fixed": {"back": 40.0}, "convection": {"back": (10.0, 20.0)}}, "leave one of them out"),
        ({"fixed": 40.0}, "fixed must be {facet set: ...}"),
    ],
)
def test_surroundings_that_make_no_sense_are_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        wf.films.BodyTemperature(**given)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"material": replace(STEEL, conductivity=None)}, "has no conductivity, which thermal= needs"),
        ({"material": replace(STEEL, heat_capacity=None)}, "has no heat_capacity"),
        ({"material": replace(STEEL, expansion=None)}, "has no expansion"),
        ({"thermal": 40.0}, "thermal must be films.BodyTemperature"),
        ({"thermal": wf.films.BodyTemperature(fixed={"back": 40.0})}, "'back'"),
        ({"thermal": wf.films.BodyTemperature(fixed={"z_max": 40.0})}, "have a fixed temperature"),
    ],
)
def test_a_body_without_what_a_temperature_needs_is_refused(change: dict[str, Any], said: str) -> None:
    given: dict[str, Any] = {
        "material": STEEL, "thermal": wf.films.BodyTemperature(fixed={"z_min": 40.0}), **change
    }  # fmt: skip
    with pytest.raises(InputError, match=said):
        wf.reduce(
            wf.mesh.box(SIZE, (2, 2, 2), order=1), given["material"], contact=TOP, thermal=given["thermal"],
            progress=False,
        )  # fmt: skip


def test_states_name_what_they_do_not_know() -> None:
    heat = warm(pad())
    with pytest.raises(InputError, match="contact surface 'bottom'"):
        heat.steady({"bottom": 1.0})
    with pytest.raises(InputError, match="surroundings 'air'"):
        heat.steady(surroundings={"air": 1.0})
    with pytest.raises(InputError, match="flux into 'z_max'"):
        heat.steady({"z_max": np.ones(3)})
    with pytest.raises(InputError, match="expansion is per kelvin"):
        replace(STEEL, expansion=12.0)
    body = wf.reduce(wf.mesh.box(SIZE, (2, 2, 2), order=1), STEEL, interfaces={"x_min": "rigid"}, progress=False)
    with pytest.raises(InputError, match="reduced without temperatures"):
        body.expansion(heat.uniform(40.0))


def test_orthotropic_bodies_have_no_temperature_yet() -> None:
    ply = wf.Material.orthotropic((135e9, 10e9, 10e9), (0.3, 0.3, 0.45), (5e9, 5e9, 3.4e9), 1600.0, name="ply")
    with pytest.raises(InputError, match="material 'ply' is orthotropic, and thermal= needs isotropic"):
        wf.reduce(
            wf.mesh.box(SIZE, (2, 2, 2), order=1), ply, interfaces={"x_min": "rigid"},
            thermal=wf.films.BodyTemperature(fixed={"z_min": 40.0}), progress=False,
        )  # fmt: skip
