"""The connecting rod, whole; its mesh, its mechanism by differences and energy, its reference by a wider clearance."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from demo_files import left_behind

import warpffrf as wf
from demos import connecting_rod as demo

THETA = np.linspace(0.0, 4.0 * np.pi, 7201)
SOME_ROD: Any = SimpleNamespace(mass=0.7, center_of_mass=np.array([0.05, 0.0, 0.0]), inertia=np.diag([1.0, 3e-3, 1.0]))


@pytest.fixture(scope="module")
def mesh() -> wf.mesh.Mesh:
    return demo.rod_mesh().check()


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "connecting_rod", "stiff", "halved")
    assert len(checks) == 14
    for what, least in (("smallest film while firing", 0.05), ("peak pressure", 0.02)):
        steel, stiff = (checks[f"{rod}: {what}"]["computed"] for rod in ("steel", "stiff"))
        assert steel < (1.0 - least) * stiff
    checked = np.array([check["error"] for name, check in checks.items() if "smallest film" in name])
    assert np.abs(checked).max() < 0.02


def test_the_mesh_has_the_volume_of_its_parts(mesh: wf.mesh.Mesh) -> None:
    rings = sum(np.pi * (outer**2 - inner**2) for inner, outer in (
        (demo.BIG, demo.BIG_OUTER), (demo.SMALL, demo.SMALL_OUTER)
    ))  # fmt: skip
    half, end = demo.BIG_OUTER * np.sin(np.pi / 8.0), demo.SMALL_OUTER * np.sin(np.pi / 4.0)
    length = demo.ROD - demo.BIG_OUTER * np.cos(np.pi / 8.0) - demo.SMALL_OUTER * np.cos(np.pi / 4.0)
    caps = sum(0.5 * r**2 * (a - np.sin(a)) for r, a in (
        (demo.BIG_OUTER, np.pi / 4.0), (demo.SMALL_OUTER, np.pi / 2.0)
    ))  # fmt: skip
    exact = demo.WIDTH * rings + 0.5 * demo.WIDTH * ((half + end) * length - caps)
    assert mesh.volume() == pytest.approx(exact, rel=1e-3)


def test_the_tetrahedra_of_neighbouring_lattices_share_their_faces(mesh: wf.mesh.Mesh) -> None:
    """Where the shank grows out of the eyes there is no outside."""
    middle = mesh.outer_facets().centers(mesh.points)
    inside = np.abs(middle[:, 1]) < 0.2 * demo.WIDTH
    for x, radius, half in ((0.0, demo.BIG_OUTER, np.pi / 8.0), (demo.ROD, demo.SMALL_OUTER, np.pi / 4.0)):
        off = np.hypot(middle[:, 0] - x, middle[:, 2]) - radius
        angle = np.arctan2(middle[:, 2], np.abs(middle[:, 0] - x))
        towards = (middle[:, 0] - x) * (0.5 * demo.ROD - x) > 0.0
        assert not np.any(inside & towards & (np.abs(off) < 0.02 * radius) & (np.abs(angle) < 0.9 * half))
        assert np.any(inside & ~towards & (np.abs(off) < 0.02 * radius))


def test_the_bores_are_round(mesh: wf.mesh.Mesh) -> None:
    for name, x, radius in (("bore", 0.0, demo.BIG), ("eye", demo.ROD, demo.SMALL)):
        points = mesh.points[mesh.facets(name).node_set]
        assert np.hypot(points[:, 0] - x, points[:, 2]) == pytest.approx(radius, rel=1e-12)
        assert mesh.sets[name] == 2 * demo.WIDE * demo.SECTORS // (1 if name == "bore" else 2)


def test_the_mechanism_is_its_own_derivatives() -> None:
    at, h = demo.Mechanism.at(THETA), (THETA[1] - THETA[0]) / demo.SPEED
    for place, second in ((at.piston, at.piston_acceleration), (at.lean, at.turning), (at.pin, at.pin_acceleration)):
        found = (place[2:] - 2.0 * place[1:-1] + place[:-2]) / h**2
        assert found == pytest.approx(second[1:-1], abs=1e-5 * np.abs(second).max())
    assert np.gradient(at.lean, h)[1:-1] == pytest.approx(at.rate[1:-1], abs=1e-5 * np.abs(at.rate).max())
    small_end = at.pin + demo.ROD * at.along
    assert small_end == pytest.approx(np.stack([at.piston, 0.0 * THETA], axis=1), abs=1e-15)


def test_film_and_gas_put_in_what_the_mechanism_gains() -> None:
    at, h = demo.Mechanism.at(THETA), (THETA[1] - THETA[0]) / demo.SPEED
    forces = demo.Forces.at(SOME_ROD, THETA)
    pin, centre, piston = (np.gradient(x, h, axis=0) for x in (
        at.pin, at.pin + SOME_ROD.center_of_mass[0] * at.along, at.piston
    ))  # fmt: skip
    moving = SOME_ROD.mass * np.sum(centre**2, axis=1) + SOME_ROD.inertia[1, 1] * at.rate**2
    energy = 0.5 * (moving + demo.PISTON_MASS * piston**2)
    power = np.sum(forces.film * pin, axis=1) - demo.gas_force(THETA) * piston
    inner = slice(2, -2)
    assert np.gradient(energy, h)[inner] == pytest.approx(power[inner], abs=1e-4 * np.abs(power).max())


def test_the_gas_repeats_after_two_turns_and_burns_behind_the_dead_centre() -> None:
    force = demo.gas_force(THETA)
    assert force == pytest.approx(demo.gas_force(THETA + 4.0 * np.pi), abs=1e-6)
    degrees = np.degrees(THETA)
    assert 365.0 < degrees[np.argmax(force)] < 400.0
    assert not np.any(force[(degrees < demo.INLET_SHUTS[0]) | (degrees > demo.OUTLET_OPENS[1] + 1e-6)])
    assert np.abs(np.diff(force, 2)).max() < 1e-3 * force.max()


def test_a_bore_widened_everywhere_is_a_wider_bore() -> None:
    theta, z = 2.0 * np.pi * np.arange(16) / 16, np.linspace(-0.5, 0.5, 5) * demo.WIDTH
    none, held, wider = np.zeros((80, 80)), np.arange(16) == 8, 0.2 * demo.CLEARANCE
    films = [
        demo.LoadedBore(demo.BIG, clearance, demo.OIL, demo.SPEED, theta, z, none, held)
        for clearance in (demo.CLEARANCE, demo.CLEARANCE + wider)
    ]
    films[0].widened = np.full(80, wider)
    ends = []
    for film in films:
        film.turns(0.5 * demo.SPEED)
        state = film.kept(film.start(np.array([0.1 * demo.CLEARANCE, 0.0])))
        for _ in range(3):
            new, _ = film.stepped(state, np.array([100.0, 20.0]), 1e-4)
            assert new is not None
            state = film.kept(new)
        ends.append(state)
    assert ends[0].place == pytest.approx(ends[1].place, rel=1e-6)
    assert ends[0].pressure == pytest.approx(ends[1].pressure, rel=1e-6, abs=1e-3)
    assert films[0].gap_at_hats(ends[0]) == pytest.approx(films[1].gap_at_hats(ends[1]), rel=1e-6)


def test_the_run_begins_with_velocities_that_agree_and_a_film_that_comes_to_carry() -> None:
    body = demo.rod_body(progress=False)
    assert body.report["warnings"] == []
    result = demo.run(body, 2.0, turns=0.25, progress=False)
    assert result.status == "completed", result.message
    film, last = result.film(demo.FILM), result.time > 0.1 * 2.0 * np.pi / demo.SPEED
    exact = demo.Forces.at(body, demo.SPEED * result.time).film
    mean = (film.force[:, [0, 2]] - exact)[last].mean(axis=0)
    assert film.smallest_gap.min() > 0.1 * demo.CLEARANCE
    assert np.abs(mean).max() < 0.1 * np.abs(exact).max()
