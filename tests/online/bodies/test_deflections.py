"""What the report says of large deflections: membrane energy, angles, inertia left out, thickness, strains."""

from __future__ import annotations

import functools
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from references.membrane import membrane_energy
from warpffrf.model import joints
from warpffrf.model.forces import PointForce
from warpffrf.model.integrators import RungeKutta4
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh, box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import interface_motion, membrane_forms
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online.diagnosis.inertia_indicator import (
    STRAINED,
    THICK,
    TURNED,
    Deflection,
    deflection_lines,
    deflections,
    percent,
)
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import equilibrium, simulate

MATERIAL = Material(210e9, 0.0, 7850.0)  # as a beam: sections are not stiffened by their width
LENGTH, WIDTH, THICKNESS = 1.0, 0.03, 0.01  # m
BENDING = MATERIAL.youngs_modulus * WIDTH * THICKNESS**3 / 12.0 / LENGTH**2  # N, P L^2/(E I) = 1
SIDE, THIN = 0.4, 4e-3  # m


@functools.cache
def beam(stiffening: Any) -> ReducedBody:
    return reduce(
        box((LENGTH, WIDTH, THICKNESS), (12, 1, 1)), MATERIAL, interfaces={"x_min": "rigid", "x_max": "rigid"}, modes=4,
        options=ReductionOptions(stiffening=stiffening), progress=False,
    )  # fmt: skip


@functools.cache
def plate(membrane_modes: int | None = None) -> ReducedBody:
    plain = box((SIDE, SIDE, THIN), (4, 4, 1))
    sides = [plain.facets(name) for name in ("x_min", "x_max", "y_min", "y_max")]
    rim = FacetSet({kind: np.concatenate([s.blocks[kind] for s in sides]) for kind in sides[0].blocks})
    mesh = Mesh(plain.points, plain.cells, {"rim": rim})
    return reduce(
        mesh,
        MATERIAL,
        interfaces={"rim": "rigid"},
        modes=6,
        options=ReductionOptions(stiffening="membrane", membrane_modes=membrane_modes),
        progress=False,
    )


def cantilever(force, kind: bool | str = "membrane", stiffening: bool = True) -> Scene:
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(beam(kind), name="beam", stiffening=stiffening, inertia="constant")
    scene.add(joints.Fixed(scene.ground, body["x_min"], name="root"))
    scene.add(PointForce(body["x_max"], force, name="push"))
    return scene


def clamped(acceleration: float, stiffening: bool = True, membrane_modes: int | None = None) -> Scene:
    scene = Scene(gravity=(0.0, 0.0, -acceleration))
    body = scene.add_body(plate(membrane_modes), name="plate", stiffening=stiffening, inertia="constant")
    scene.add(joints.Fixed(scene.ground, body["rim"], name="rim"))
    return scene


def about(notes, *words) -> list[str]:
    return [note for note in notes if all(word in note for word in words)]


def test_membrane_energy_over_that_of_the_modes() -> None:
    """The largest ratio of a vibration, and the kinetic energy of second-order motion, which of a plate in a rim is
    little."""
    scene = clamped(5e3)
    result = simulate(scene, 0.02, step=2e-4, progress=False)
    assert result.status == "completed"
    (found,) = deflections(scene, result.history.bodies)
    forms = membrane_forms(scene.body("plate"))
    assert forms is not None
    q = result.history.bodies["plate"].modal[1:]
    ratio = [membrane_energy(forms, x) / (0.5 * np.sum((2 * np.pi * plate().frequencies * x) ** 2)) for x in q]
    assert max(ratio) > 0.1 and found.membrane == pytest.approx(max(ratio))
    assert found.inertia is not None and 0.0 < found.inertia < 0.01
    (line,) = about(result.history.notes, "membrane energy up to")
    assert f"{100 * max(ratio):.0f} % of the energy of its modes" in line
    assert "inertia of second-order motion, which is neglected, up to" in line
    assert "turns" not in line  # the rim of a plate does not
    assert set(deflection_lines(scene, [found])) <= set(result.history.notes)


def test_modes_without_membrane_energy_are_named() -> None:
    """With their part of the energy; of an equilibrium that stretches more than it bends, about w = 1.7 t, also that it
    may be on another branch."""
    for acceleration, stretches in ((5e3, False), (5e4, True)):
        result = equilibrium(clamped(acceleration, membrane_modes=3), progress=False)
        share = (plate(3).frequencies * result.history.bodies["plate"].modal[-1]) ** 2
        (line,) = about(result.history.notes, "those after the first 3 have no membrane energy")
        assert f"of its {len(share)} modes" in line and f"reduce it with membrane_modes={len(share)}" in line
        assert f"up to {percent(share[3:].sum() / share.sum())} of the energy of all" in line
        assert ("another branch" in line) == stretches
        assert not about(equilibrium(clamped(acceleration), progress=False).history.notes, "no membrane energy")


def test_interfaces_that_turn_far() -> None:
    """The angle is that of the interface's motion, and above 0.3 rad the advice is to split the body."""
    for load, far in ((0.5, False), (1.1, True)):
        scene = cantilever((0.0, 0.0, load * BENDING))
        result = equilibrium(scene)
        (line,) = about(result.history.notes, "from the mean axes")
        q = result.history.bodies["beam"].modal[-1]
        angles = [np.linalg.norm(interface_motion(scene.body("beam"), name, q)[3:]) for name in ("x_min", "x_max")]
        assert f"rotates by up to {max(angles):.2g} rad" in line
        assert (max(angles) > TURNED) == far
        assert (f"above {TURNED:g} rad: split it into several bodies" in line) == far
        assert not about(result.history.notes, "kinetic energy")  # at rest there is none
        assert not about(result.history.notes, "its pictures omit")
    assert not about(equilibrium(cantilever((0.0, 0.0, 1e-3 * BENDING))).history.notes, "mean axes")


def test_pictures_that_lack_the_way_of_interfaces() -> None:
    """Of stiffening=True, which has no second-order motion of the skin; the share of it is that of the body's that
    has it, but for places between interfaces."""
    notes = equilibrium(cantilever((0.0, 0.0, 0.5 * BENDING), kind=True)).history.notes
    (line,) = about(notes, "its pictures omit")
    shares = []
    for kind in (True, "membrane"):
        scene = cantilever((0.0, 0.0, 0.5 * BENDING), kind=kind)
        shares += [one.second for one in deflections(scene, equilibrium(scene).history.bodies)]
    assert shares[1] == pytest.approx(shares[0], rel=0.1) and shares[0] > 0.02
    assert "use ReductionOptions(stiffening='membrane') in reduce" in line
    assert not about(equilibrium(cantilever((0, 0, 0.01 * BENDING), kind=True)).history.notes, "its pictures omit")


@pytest.mark.parametrize(
    ("kind", "cure"),
    [
        ("membrane", "use stiffening=True in add_body"),
        (False, "use ReductionOptions(stiffening='membrane') in reduce and stiffening=True in add_body"),
    ],
)
def test_linear_bodies_that_deflect_by_their_thickness(kind, cure) -> None:
    """Relative to its mean axes a cantilever has next to a tenth of the deflection of its end."""
    notes = equilibrium(cantilever((0.0, 0.0, 0.5 * BENDING), kind=kind, stiffening=False)).history.notes
    (line,) = about(notes, "of its smallest extent")
    assert cure in line
    quiet = equilibrium(cantilever((0.0, 0.0, 0.05 * BENDING), kind=kind, stiffening=False))
    (found,) = deflections(quiet.history.scene, quiet.history.bodies)
    assert 0.1 < found.extents < THICK
    assert not about(quiet.history.notes, "smallest extent")


def test_deflection_is_measured_by_the_thickness() -> None:
    """The smallest edge of a box by its inertia: of a linear plate w relative to its mean axes over its thickness."""
    scene = clamped(1e3, stiffening=False)
    result = equilibrium(scene)
    (found,) = deflections(scene, result.history.bodies)
    u = result.skins()["plate"].displacement(-1)
    assert found.extents == pytest.approx(np.linalg.norm(u, axis=1).max() / THIN, rel=1e-9)


@pytest.mark.parametrize("kind", [False, "membrane"])
def test_strains_above_the_bound(kind) -> None:
    """A bar pulled by 1.5 % says so with size, body and place; at 0.5 % nothing is said."""
    for strain in (1.5 * STRAINED, 0.5 * STRAINED):
        pull = strain * MATERIAL.youngs_modulus * WIDTH * THICKNESS
        scene = cantilever((pull, 0.0, 0.0), kind=kind, stiffening=False)
        result = equilibrium(scene)
        (found,) = deflections(scene, result.history.bodies)
        assert found.strain == pytest.approx(strain, rel=0.01)
        lines = about(result.history.notes, "body 'beam': strains up to")
        assert len(lines) == (strain > STRAINED)
        for line in lines:
            assert "strains up to 1.5 % at (" in line and "m of its skin; above 1 %" in line
            assert "load it less, make it stiffer" in line


def test_bodies_that_do_not_deflect_say_nothing() -> None:
    scene = cantilever((0.0, 0.0, 0.0), stiffening=False)
    result = equilibrium(scene)
    assert deflection_lines(scene, deflections(scene, result.history.bodies)) == []
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    scene.add_rigid_body(1.0, np.eye(3), name="stone")
    result = simulate(scene, 0.01, step=1e-3, progress=False)
    assert deflections(scene, result.history.bodies) == []


def test_contact_surfaces_have_no_second_order_motion() -> None:
    """Said where it is more than 1 % of the deflection, of bodies that are touched."""
    found = Deflection("beam", None, 0.0, None, "", None, 1.0, 0.0, np.zeros(3), 0.05)
    scene = cantilever((0.0, 0.0, BENDING))
    assert not about(deflection_lines(scene, [found]), "contact surfaces")
    touching = SimpleNamespace(
        contacts=[SimpleNamespace(ports=[SimpleNamespace(body=scene.body("beam"))])], films=[], body=scene.body
    )
    (line,) = about(deflection_lines(cast(Scene, touching), [found]), "contact surfaces")
    assert "which is up to 5 % of the deflection; split it" in line


def test_integrators_for_checks_say_it() -> None:
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(beam("membrane"), name="beam", inertia="constant")
    for name, pull in (("x_min", -1.0), ("x_max", 1.0)):
        force = 1.5 * STRAINED * MATERIAL.youngs_modulus * WIDTH * THICKNESS
        scene.add(PointForce(body[name], (pull * force, 0.0, 0.0), name=f"pull {name}"))
    result = simulate(scene, 2e-4, step=5e-7, options=RunOptions(integrator=RungeKutta4()), progress=False)
    assert about(result.history.notes, "strains up to")
