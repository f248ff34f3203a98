"""Bearings of flexible and rigid elements: which are flexible, and that the others are as stiff and as pressed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf

STEEL = wf.Material(206e9, 0.3, 7850.0)
D, LENGTH = 0.01, 9.6e-3  # m
STIFFNESS, PEAK = 0.01, 0.02
NAME = "r"


def reduced(mesh: wf.Mesh, surface: str, shape: Any, interface: str = "average") -> wf.ReducedBody:
    places = {"ends": interface} if interface == "average" else {"outside": interface}
    return wf.reduce(
        mesh, STEEL, interfaces=places, contact={surface: shape}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip


def roller_of(sectors: int, layers: int, axial: int) -> wf.ReducedBody:
    mesh = wf.mesh.roller(0.5 * D, 0.0, LENGTH, sectors=sectors, layers=layers, axial=axial)
    return reduced(mesh, "rim", wf.surfaces.Cylinder())


def ball_of(sectors: int, layers: int, axial: int) -> wf.ReducedBody:
    size = {"sectors": sectors, "layers": layers, "axial": axial}
    mesh = wf.mesh.roller(0.5 * D, 0.0, 0.9 * D, crown_radius=0.5 * D, tread=0.47 * D, **size)
    return reduced(mesh, "tread", wf.surfaces.Sphere(axis_direction=(0, 1, 0)))


@pytest.fixture(scope="module")
def roller() -> wf.ReducedBody:
    """As coarse as it gets: for what its stiffness does not matter."""
    return roller_of(8, 1, 1)


@pytest.fixture(scope="module")
def ball() -> wf.ReducedBody:
    return ball_of(8, 1, 2)


def rollers(count: int, pitch: float = 0.064, **more: Any) -> wf.bearings.RollerGeometry:
    return wf.bearings.RollerGeometry(
        elements=count, roller_diameter=D, roller_length=LENGTH, pitch_diameter=pitch, **more
    )


def balls(count: int, **more: Any) -> wf.bearings.BallGeometry:
    return wf.bearings.BallGeometry(elements=count, ball_diameter=D, pitch_diameter=0.064, **more)


def bearing(geometry: Any, body: wf.ReducedBody | None, *, outer: Any = None, **contact: Any) -> wf.bearings.Bearing:
    scene = wf.Scene()
    cage = contact.pop("cage", wf.bearings.PrescribedCage())
    return scene.add_bearing(
        NAME, geometry, outer=scene.ground, first=(0, 0, -1), cage=cage,
        contact=wf.bearings.RollingContact(**contact), materials=wf.bearings.Materials(STEEL, element_body=body),
    )  # fmt: skip


def test_a_load_chooses_those_with_half_of_the_largest(roller: wf.ReducedBody, ball: wf.ReducedBody) -> None:
    """Without clearance Q = Q_max cos(psi)^n, n = 10/9 and 3/2, in rings that move in parallel (Sjoevall)."""
    down: dict[str, Any] = {"distributed": "auto", "load": (0, 0, -1000.0)}
    assert bearing(rollers(14), roller, **down).distributed == (1, 2, 3, 13, 14)  # to 51 deg, 0.59; 77 deg has 0.19
    assert bearing(balls(16), ball, **down).distributed == (1, 2, 3, 15, 16)  # to 45 deg, 0.59; 67.5 deg has 0.24
    assert bearing(rollers(14, clearance=4e-4), roller, **down).distributed == (1,)
    across = down | {"load": (-1000.0, 5e3, 0)}  # rollers carry nothing along the axis; first is down, then -x
    assert bearing(rollers(4), roller, **across).distributed == (2,)
    assert bearing(balls(8, clearance=2e-5), ball, **down | {"load": (0, 1e3, 0)}).distributed == tuple(range(1, 9))
    rows = balls(8, contact_angle=0.5, rows=2, row_spacing=0.012)
    found = bearing(rows, ball, **down | {"load": (0, 1e3, 0)}).distributed
    assert found in (tuple(range(1, 9)), tuple(range(9, 17)))  # thrust is on one row alone
    named = bearing(rollers(14), roller, distributed=np.array([3, 1]))
    assert named.distributed == (1, 3) and named.load is None
    assert [element.reduced is not None for element in named.elements[:4]] == [True, False, True, False]
    assert named.elements[1].mass == pytest.approx(roller.mass)


def test_what_cannot_be_chosen_is_refused(roller: wf.ReducedBody) -> None:
    down: dict[str, Any] = {"distributed": "auto", "load": (0, 0, -1000.0)}
    cases: list[tuple[Any, Any, dict[str, Any], str]] = [
        (rollers(14), None, {"distributed": (1,)}, "the elements are rigid; give the body"),
        (rollers(14), roller, {"distributed": (0, 1)}, "numbers of elements from 1 to 14"),
        (rollers(14), roller, {"distributed": "some"}, 'must be "all", "auto" or numbers'),
        (rollers(14), roller, {"distributed": ()}, 'must be "all", "auto" or numbers'),
        (rollers(14), roller, {"distributed": "auto"}, "requires load="),
        (rollers(14), roller, {"distributed": (1,), "load": (0, 0, -1.0)}, 'load is of distributed="auto"'),
        (rollers(14), roller, {"load": (0, 0, -1.0)}, 'load is of distributed="auto"'),
        (rollers(14), roller, down | {"load": (0, 1000.0, 0)}, "no part that the elements carry"),
        (rollers(14), roller, down | {"cage": wf.bearings.PrescribedCage(speed=50.0)}, "pass through the load zone"),
        (rollers(14), roller, down | {"cage": wf.bearings.PocketCage(1e-4)}, "pass through the load zone"),
        (rollers(8, contact_angle=0.5, taper=0.0), roller, down, "have no equilibrium under load="),
    ]
    for geometry, body, contact, message in cases:
        with pytest.raises(wf.InputError, match=message):
            bearing(geometry, body, **contact)


def pressed(geometry: Any, body: wf.ReducedBody, load: float, outer: wf.ReducedBody | None, **contact: Any) -> Any:
    """The bearing of a result, with the load on element 1."""
    scene = wf.Scene()
    ring: Any = scene.ground
    if outer is not None:
        ring = scene.add_body(outer, name="outer")
        scene.add(wf.joints.Fixed(scene.ground, ring["outside"], name="housing"))
        ring = ring["bore"]
    made = scene.add_bearing(
        NAME, geometry, outer=ring, first=(0, 0, -1), contact=wf.bearings.RollingContact(**contact),
        materials=wf.bearings.Materials(STEEL, element_body=body),
    )  # fmt: skip
    inner = made.inner.at((0, 0, 0))
    scene.add(wf.joints.Prismatic(scene.ground.at((0, 0, 0)), inner, axis=(0, 0, 1), name="guide"))
    scene.add(wf.forces.PointForce(inner, (0, 0, -load), name="load"))
    result = wf.equilibrium(scene, progress=False)
    assert result.status == "completed", result.message
    return result.bearing(NAME), result.history.notes


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["roller", "ball"])
def test_rigid_elements_are_as_stiff_as_flexible_ones(kind: str) -> None:
    """Element 1 carries all, once flexible and once rigid; balls whose patch extends to a third of their radius differ
    by more, as Hertz's surfaces are parabolas."""
    body = roller_of(16, 2, 2) if kind == "roller" else ball_of(16, 3, 2)
    geometry: Any = rollers(3) if kind == "roller" else balls(3, osculation=0.52)
    for load in (300.0, 1500.0) if kind == "roller" else (100.0, 500.0):
        flexible, _ = pressed(geometry, body, load, None)
        rigid, notes = pressed(geometry, body, load, None, distributed=(2,))
        np.testing.assert_allclose(rigid.outer_load[0], (load, 0.0, 0.0), atol=1e-6 * load)
        assert rigid.displacement[0, 0] == pytest.approx(flexible.displacement[0, 0], rel=STIFFNESS)
        for side in ("inner", "outer"):
            assert rigid.peak_pressure[side][0, 0] == pytest.approx(flexible.peak_pressure[side][0, 0], rel=PEAK)
        assert any("the other 2 are rigid, with lumped contact of the same stiffness" in note for note in notes)
        assert any(f"rigid {kind}s 1 carry up to {load:.5g} N" in note for note in notes)


@pytest.mark.slow
def test_a_rigid_roller_on_a_flexible_ring_has_the_rest_on_the_rigid_one() -> None:
    roller = roller_of(16, 2, 2)
    mesh = wf.mesh.sleeve(0.022, 0.028, LENGTH, sectors=48, axial=2, layers=2)
    ring = reduced(mesh, "bore", wf.surfaces.Bore(), "rigid")
    flexible, _ = pressed(rollers(3, 0.034), roller, 1500.0, ring)
    rigid, _ = pressed(rollers(3, 0.034), roller, 1500.0, ring, distributed=(2,))
    assert rigid.displacement[0, 0] == pytest.approx(flexible.displacement[0, 0], rel=STIFFNESS)


@pytest.mark.slow
def test_one_flexible_roller_travels_among_rigid_ones() -> None:
    """Loads of all and pressures of the flexible one are those in a bearing of flexible rollers."""
    roller = roller_of(16, 2, 2)

    def rolled(**contact: Any) -> Any:
        scene = wf.Scene()
        made = scene.add_bearing(
            NAME, rollers(6, 0.034, clearance=-6e-6), outer=scene.ground, first=(0, 0, -1),
            contact=wf.bearings.RollingContact(**contact),
            materials=wf.bearings.Materials(STEEL, element_body=roller),
        )  # fmt: skip
        scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), made.inner, axis=(0, 1, 0), name="plane"))
        scene.add(wf.forces.PointForce(made.inner.at((0, 0, 0)), (0, 0, -1500.0), name="load"))
        made.roll(inner=200.0)
        result = wf.simulate(scene, 2e-3, step=1e-4, start="equilibrium", progress=False)
        assert result.status == "completed", result.message
        return result.bearing(NAME)

    every, one = rolled(), rolled(distributed=(1,))
    assert every.angle[-1, 0] == pytest.approx(one.angle[-1, 0], abs=1e-6) and every.angle[-1, 0] > 0.1
    assert np.abs(one.outer_load - every.outer_load).max() < STIFFNESS * every.outer_load.max()
    for side in ("inner", "outer"):
        np.testing.assert_allclose(one.peak_pressure[side][:, 0], every.peak_pressure[side][:, 0], rtol=STIFFNESS)
        np.testing.assert_allclose(one.peak_pressure[side], every.peak_pressure[side], rtol=0.05)


def test_two_flexible_rings_are_refused(roller: wf.ReducedBody) -> None:
    sizes = {"sectors": 8, "axial": 1, "layers": 1}
    ring = reduced(wf.mesh.sleeve(0.022, 0.028, LENGTH, **sizes), "bore", wf.surfaces.Bore(), "rigid")
    shaft = reduced(wf.mesh.roller(0.012, 0.0, LENGTH, **sizes), "rim", wf.surfaces.Cylinder())
    scene = wf.Scene()
    outer, inner = (scene.add_body(body, name=name) for body, name in ((ring, "outer"), (shaft, "inner")))
    with pytest.raises(wf.InputError, match="both rings are flexible"):
        scene.add_bearing(
            NAME, rollers(3, 0.034), inner=inner["rim"], outer=outer["bore"],
            contact=wf.bearings.RollingContact(distributed=(1,)),
            materials=wf.bearings.Materials(STEEL, element_body=roller),
        )  # fmt: skip
