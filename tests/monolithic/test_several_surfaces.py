"""Several contact surfaces of one body: they feel each other through its local modes, too."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from references import monolithic
from references.monolithic.core import local_coordinates
from references.monolithic.core.local_coordinates import Loaded, static_coordinates
from references.monolithic.local_systems import local_systems
from warpffrf.model import forces, joints, laws, signals
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import box, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.local_modes import leant
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Bore, Cylinder, Plane
from warpffrf.offline import ContactGrid, ReductionOptions, reduce
from warpffrf.online import GeneralizedAlpha, Settings, run

STEEL = Material(210e9, 0.3, 7850.0)
THICKNESS, LOAD = 0.004, 1e4  # m, N
TIGHT = 1e-12  # tolerance of the forces
MODES_AGREE = 1e-8  # static states are exact for any number of modes; at four sheets 1e-12 was seen
ROUND_OFF = 1e-12
PARTS_AGREE = 1e-9  # modes of an arc are projected on its own nodes; 1e-11 was seen, and 0.01 for arcs that are apart
SOLVERS_AGREE = 1e-10  # of the largest force: round-off of some ten steps
STEP, STEPS = 1e-5, 10


# --- the coordinates themselves ---


@pytest.fixture(scope="module")
def ring() -> ReducedBody:
    mesh = roller(0.05, 0.03, 0.02, sectors=14, layers=2, axial=2, order=1)
    return reduce(
        mesh, STEEL, contact={"rim": Cylinder(), "bore": Bore()}, modes=6,
        grid=ContactGrid(tangential=True, contact_fixed=False), options=ReductionOptions(local_dynamics=True),
        cache=False, progress=False,
    )  # fmt: skip


@pytest.mark.parametrize("rough", [(), ("rim",), ("bore",), ("rim", "bore")])
def test_coordinates_in_common_have_all_compliances(ring: ReducedBody, rough: tuple[str, ...]) -> None:
    """Tr Tr^T, as all stiffnesses are 1, of traces along normal and tangents, on each surface and between them."""
    names = ("bore", "rim")
    found = static_coordinates(ring, [Loaded(name, name in rough) for name in names], "ring")
    assert found[0].count == found[1].count <= 14 * 3 * (2 + 2 * len(rough))
    for one, other in ((0, 0), (0, 1), (1, 0), (1, 1)):
        a, b = found[one], found[other]
        assert np.all(a.stiffness == 1.0) and not a.mass.any()
        target, source = names[one], names[other]
        surface, cross = ring.contact_surfaces[target], None
        assert surface.tangential is not None
        columns = np.arange(surface.grid.columns)
        if one == other:
            expected = {
                "lags": surface.compliance(columns),
                "lags_tt": surface.tangential.compliance(columns),
                "lags_nt": surface.tangential.coupling(columns, columns),
            }
        else:
            cross = ring.cross_compliance(target, source)
            assert cross is not None
            expected = {key: cross.whole(key) for key in cross.arrays()}
        rows = {"n": (a.trace, b.trace), "t": tuple(x.shear.reshape(-1, x.count) for x in (a, b))}
        for key, D in expected.items():
            on, by = key[-2:] if key != "lags" else "nn"
            got = rows[on][0] @ rows[by][1].T
            if got.size:  # tangents of surfaces with friction only
                assert np.abs(got - D).max() < ROUND_OFF * np.abs(D).max()


def test_normals_that_lean_keep_the_compliance() -> None:
    """It can be negative in some direction; traces and stiffnesses still make it what it is."""
    mesh = roller(0.05, 0.03, 0.02, sectors=24, layers=2, axial=1, order=1)
    rubber = Material(5e6, 0.49, 1100.0)
    body = reduce(
        mesh,
        rubber,
        contact={"rim": Cylinder(), "bore": Bore()},
        modes=6,
        cache=False,
        progress=False,
        grid=ContactGrid(contact_fixed=False),
    )
    found = static_coordinates(body, [Loaded("rim", False, 1.0), Loaded("bore", False)], "ring")
    rim, cross = body.contact_surfaces["rim"], body.cross_compliance("rim", "bore")
    assert cross is not None and found[0].stiffness.min() == -1.0
    own = leant(rim, 1.0).compliance(np.arange(rim.grid.columns))
    for other, D in ((found[0], own), (found[1], cross.whole())):
        assert np.abs((found[0].trace / found[0].stiffness) @ other.trace.T - D).max() < ROUND_OFF * np.abs(D).max()


# --- a stack of sheets ---


def sheet(modes: int, width: float) -> ReducedBody:
    mesh = box((width, width - 0.01, THICKNESS), (6, 4, 2), order=1)
    mesh = mesh.select("spot", "z_max", lambda c: np.hypot(c[:, 0], c[:, 1]) < 0.008)
    return reduce(
        mesh, STEEL, contact={"z_min": None, "z_max": None}, interfaces={"x_min": "average", "spot": "average"},
        modes=modes, cache=False, progress=False, grid=ContactGrid(contact_fixed=False),
    )  # fmt: skip


def stack(bodies: list[ReducedBody]) -> Scene:
    """Sheets of falling width on a floor, pressed in the middle of the uppermost one."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    floor = Plane(origin=(0.0, 0.0, -0.5 * THICKNESS), outward=(0.0, 0.0, 1.0))
    below: Any = scene.ground.surface(floor, name="floor")
    for i, reduced in enumerate(bodies):
        body = scene.add_body(reduced, name=f"sheet {i}", position=(0.0, 0.0, i * THICKNESS))
        scene.add(joints.Prismatic(scene.ground, body["x_min"], axis=(0, 0, 1), name=f"guide {i}"))
        law = laws.LinearLayer(1e12)
        scene.add(Contact(body["z_min"], below, law=law, name=f"below {i}"))
        below = body["z_max"]
        if i + 1 == len(bodies):
            scene.add(forces.PointForce(body["spot"], (-LOAD, (0.0, 0.0, 1.0))))
    return scene


def pressed(modes: int, *, crossed: bool = True, variant: str = "full") -> list[np.ndarray]:
    """Pressures in equilibrium between four sheets and on the floor."""
    bodies = [sheet(modes, 0.04 - 0.005 * i) for i in range(4)]
    scene = stack(bodies if crossed else [replace(body, cross=()) for body in bodies])
    history = monolithic.run(
        scene, STEP, step=STEP, start="equilibrium", tolerance=TIGHT, variant=variant, at_nodes=True, progress=False
    )
    assert history.status == "completed", history.message
    assert len([note for note in history.notes if "global modes only" in note]) == (0 if crossed else 3)
    for contact in history.contacts.values():
        assert contact.force[0, 2] == pytest.approx(LOAD, rel=1e-9)
    return [contact.pressure[0] for contact in history.contacts.values()]


@pytest.mark.slow
@pytest.mark.parametrize("variant", ["full", "low_rank"])
def test_pressures_do_not_depend_on_the_number_of_global_modes(variant: str) -> None:
    """Every load is taken by all of a sheet, whatever its modes hold: not so without the compliance between faces."""
    expected = pressed(0, variant=variant)
    for modes in (4, 40):
        for p, q in zip(pressed(modes, variant=variant), expected, strict=True):
            assert np.abs(p - q).max() < MODES_AGREE * q.max()
    apart = pressed(0, crossed=False, variant=variant)
    assert max(np.abs(p - q).max() / q.max() for p, q in zip(apart, expected, strict=True)) > 0.01


# --- one surface as two ---


@pytest.fixture(scope="module")
def rollers() -> dict[str, ReducedBody]:
    """One with its rim in one piece, and the same with two arcs of it."""
    mesh = roller(0.05, 0.015, 0.02, sectors=48, layers=2, axial=2, grading=1.4, order=1)
    for name, sign in (("upper", 1.0), ("lower", -1.0)):
        mesh = mesh.select(name, "rim", lambda c, sign=sign: sign * c[:, 2] > 0.1 * np.hypot(c[:, 0], c[:, 2]))
    return {
        what: reduce(
            mesh, STEEL, interfaces={"bore": "rigid"}, contact=dict.fromkeys(names, Cylinder()), max_frequency=15e3,
            grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
        )
        for what, names in (("whole", ("rim",)), ("parts", ("upper", "lower")))
    }  # fmt: skip


def between(middle: ReducedBody, beside: ReducedBody, **options: Any) -> Scene:
    """A roller between two others, the lowest clamped, the others pressed on it from above."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    below, roller, above = (
        scene.add_body(body, name=name, position=(0.0, 0.0, z))
        for body, name, z in ((beside, "below", 0.0), (middle, "middle", 0.1), (beside, "above", 0.2))
    )
    scene.add(joints.Fixed(scene.ground, below["bore"], name="clamp"))
    for body in (roller, above):
        scene.add(joints.Prismatic(scene.ground, body["bore"], axis=(0, 0, 1), name=f"{body.name} guide"))
    load = signals.SmoothStep(0.5e6, 1e6, duration=STEPS * STEP)
    scene.add(forces.PointForce(above["bore"], (load, (0.0, 0.0, -1.0))))
    names = ("lower", "upper") if "upper" in middle.contact_surfaces else ("rim", "rim")
    scene.add(Contact(below["rim"], roller[names[0]], name="low", **options))
    scene.add(Contact(roller[names[1]], above["rim"], name="high", **options))
    return scene


def forces_of(scene: Scene, **options: Any) -> np.ndarray:
    history = monolithic.run(
        scene, STEPS * STEP, step=STEP, start="equilibrium", tolerance=TIGHT, progress=False, **options
    )
    assert history.status == "completed", history.message
    return np.array([contact.force for contact in history.contacts.values()])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("how", "pair", "variant"),
    [
        ({"law": "hats"}, {}, "full"),
        ({"law": "nodes"}, {}, "low_rank"),
        ({"at_nodes": True}, {"law": laws.LinearLayer(3e14), "friction": laws.Coulomb(0.2)}, "low_rank"),
    ],
    ids=["hats", "nodes", "nodes with friction"],
)  # fmt: skip
def test_two_surfaces_are_as_good_as_one(
    rollers: dict[str, ReducedBody], how: dict[str, Any], pair: dict[str, Any], variant: str
) -> None:
    """A rim with a pair above and one below, or two arcs of it with a pair each."""
    one, two = (forces_of(between(rollers[x], rollers["whole"], **pair), variant=variant, **how) for x in rollers)
    assert np.abs(one).max() > 0.5e6
    assert np.abs(two - one).max() < PARTS_AGREE * np.abs(one).max()


def test_both_solvers_agree(rollers: dict[str, ReducedBody]) -> None:
    """Two arcs with a pair each, in solvers that were written apart."""
    scene = between(rollers["parts"], rollers["whole"])
    options: dict[str, Any] = {
        "step": STEP, "integrator": GeneralizedAlpha(0.8), "start": "equilibrium", "progress": False
    }  # fmt: skip
    separated = run(scene, STEPS * STEP, settings=Settings(residual_tolerance=TIGHT), **options)
    reference = monolithic.run(scene, STEPS * STEP, tolerance=TIGHT, **options)
    assert separated.status == reference.status == "completed", (separated.message, reference.message)
    for name, contact in separated.contacts.items():
        size = np.abs(contact.force).max()
        assert size > 0.5e6
        assert np.abs(contact.force - reference.contacts[name].force).max() < SOLVERS_AGREE * size


# --- what cannot be had is said ---


def test_coordinates_in_common_only_where_they_can_be(rollers: dict[str, ReducedBody]) -> None:
    scene = between(rollers["parts"], rollers["whole"])
    found = local_systems(scene, "quasi_static", {}, 0.0)
    assert found.surfaces == [(0, 1), (2, 3)] and found.system_of == [0, 1, 1, 2] and not found.notes
    old = between(replace(rollers["parts"], cross=()), rollers["whole"])
    found = local_systems(old, "quasi_static", {}, 0.0)
    assert sorted(found.system_of) == [0, 1, 2, 3]
    (note,) = found.notes
    assert "lower, upper of body 'middle' feel each other" in note and "reduce it again" in note


def test_masses_of_local_modes_are_those_of_each_surface(ring: ReducedBody) -> None:
    scene = Scene()
    body = scene.add_body(ring, name="ring")
    axle = Cylinder(radius=0.029, axis_point=(0.0, 0.0, 0.0), axis_direction=(0.0, 1.0, 0.0))
    pin = scene.ground.surface(axle, name="pin")
    wall = scene.ground.surface(Plane(origin=(0.0, 0.0, -0.051), outward=(0.0, 0.0, 1.0)), name="wall")
    scene.add(Contact(body["bore"], pin, name="inside"))
    scene.add(Contact(body["rim"], wall, name="outside"))
    found = local_systems(scene, "hht", {}, 0.0)
    assert found.system_of == [0, 1]
    (note,) = found.notes
    assert "local='hht' has the mass of local modes of each surface alone" in note
    assert local_systems(scene, "quasi_static", {}, 0.0).system_of == [0, 0]


def test_too_many_coordinates_of_one_body_are_refused(
    rollers: dict[str, ReducedBody], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of all its surfaces together, each of which alone would do."""
    body, both = rollers["parts"], [Loaded("upper", False), Loaded("lower", False)]
    counts = [body.contact_surfaces[one.name].local_modes for one in both]
    monkeypatch.setattr(local_coordinates, "MOST_COORDINATES", max(counts))
    for one in both:
        static_coordinates(body, [one], "one surface")
    with pytest.raises(InputError, match=f"both surfaces: .* would need {sum(counts)} local coordinates"):
        static_coordinates(body, both, "both surfaces")
