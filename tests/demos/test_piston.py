"""The piston in its liner, whole; its mesh, its rigid mechanism, its full model of the liner, its start."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

import warpffrf as wf
from demos import piston as demo

MASS = 0.25  # kg, of some piston


@pytest.fixture(scope="module")
def mesh() -> wf.mesh.Mesh:
    return demo.piston_mesh().check()


@pytest.fixture(scope="module")
def body() -> wf.ReducedBody:
    return demo.piston_body(progress=False)


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "piston", "rigid", "stiff", "halved")
    assert len(checks) == 14
    runs = {name: wf.Result.load(tmp_path / "out" / f"piston{name}.h5") for name in ("", ".rigid", ".stiff")}
    firing = {name: demo.thinnest(result, 390.0, 420.0) for name, result in runs.items()}
    films = {name: result.film(demo.THRUST).smallest_gap[firing[name]] for name, result in runs.items()}
    assert films[""] > 1.05 * films[".rigid"]
    assert films[".stiff"] < 0.4 * films[".rigid"]
    peaks = {name: result.film(demo.THRUST).largest_pressure.max() for name, result in runs.items()}
    assert peaks[".stiff"] > 4.0 * peaks[".rigid"]
    off = demo.place(runs[".stiff"])[0]
    assert np.abs(off).max() < 1.3 * demo.CLEARANCE  # a stiff skirt gives by a tenth of what the true one does


def test_the_mesh_has_the_volume_of_its_parts(mesh: wf.mesh.Mesh) -> None:
    outer = demo.BORE - demo.CLEARANCE - demo.OVAL
    inner = outer - demo.WALL
    ring = np.pi * (outer**2 - inner**2)
    around = (0.5 + 1.0 / demo.ACROSS) * ring  # of the skirt: half of the turn, and a cell at each of four ends
    crown, belt, skirt = (end - begin for begin, end in (demo.CROWN, demo.BELT, demo.SKIRT))
    round_parts = np.pi * outer**2 * crown + ring * belt + around * skirt
    u = np.linspace(-1.0, 1.0, 20_001)
    core = demo.CORE**2 * np.trapezoid(2.0 * np.sqrt(1.0 - demo.BULGE * u**2), u)  # at least: its sides bulge
    walls = mesh.volume() - round_parts
    between = 0.5 * (np.pi * inner**2 - core)  # both sides of the pin, as thick as the walls with the bosses at most
    assert 0.3 * between * (demo.WALLS[1] - demo.WALLS[0]) < walls < between * (demo.WALLS[1] - demo.WALLS[0])


def test_skirt_bosses_and_crown_are_where_they_should_be(mesh: wf.mesh.Mesh) -> None:
    outer = demo.BORE - demo.CLEARANCE - demo.OVAL
    for name, side in ((demo.THRUST, -1.0), (demo.ANTI, 1.0)):
        points = mesh.points[mesh.facets(name).node_set]
        assert np.hypot(points[:, 1], points[:, 2]) == pytest.approx(outer, rel=1e-9)
        assert np.ptp(points[:, 0]) == pytest.approx(demo.SKIRT[1] - demo.SKIRT[0])
        arc = 0.25 * np.pi * (1.0 + 2.0 * demo.BESIDE / demo.ACROSS)
        assert np.arctan2(np.abs(points[:, 1]), side * points[:, 2]).max() == pytest.approx(arc)
    assert mesh.points[mesh.facets("crown").node_set][:, 0] == pytest.approx(demo.CROWN[1])
    pin = mesh.points[mesh.facets("pin").node_set]
    assert pin.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.abs(pin[:, 1]).min() > 0.9 * demo.CORE


def test_the_mesh_is_alike_on_both_sides(mesh: wf.mesh.Mesh) -> None:
    for axis in (1, 2):
        mirrored = mesh.points * np.where(np.arange(3) == axis, -1.0, 1.0)
        order = [np.lexsort(np.round(points, 9).T) for points in (mesh.points, mirrored)]
        assert mesh.points[order[0]] == pytest.approx(mirrored[order[1]], abs=1e-8)


def test_the_rod_carries_what_the_mechanism_gains() -> None:
    """Power of gas and of the crank on rod and piston is their gain of energy; the side force does no work."""
    theta = np.linspace(0.0, 4.0 * np.pi, 7201)
    at, h = demo.Mechanism.at(theta), (theta[1] - theta[0]) / demo.SPEED
    side = demo.side_force(theta, MASS)
    on_piston = demo.gas_force(theta) + MASS * at.piston_acceleration  # x, by the rod
    centre = at.pin + demo.ROD_CENTRE * at.along
    acceleration = np.gradient(np.gradient(centre, h, axis=0), h, axis=0)
    on_big_end = demo.ROD_MASS * acceleration + np.stack([on_piston, -side], axis=1)
    velocity, rate = np.gradient(centre, h, axis=0), at.rate
    energy = 0.5 * (demo.ROD_MASS * np.sum(velocity**2, axis=1) + demo.ROD_INERTIA[1] * rate**2)
    energy = energy + 0.5 * MASS * np.gradient(at.piston, h) ** 2
    power = np.sum(on_big_end * np.gradient(at.pin, h, axis=0), axis=1)
    power = power - demo.gas_force(theta) * np.gradient(at.piston, h)
    inner = slice(4, -4)
    assert np.gradient(energy, h)[inner] == pytest.approx(power[inner], abs=2e-3 * np.abs(power).max())


def test_without_inertia_the_side_force_is_that_of_the_lean(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(demo, "ROD_MASS", 0.0)
    monkeypatch.setattr(demo, "ROD_INERTIA", (0.0, 0.0, 0.0))
    theta = np.linspace(0.0, 4.0 * np.pi, 721)
    at = demo.Mechanism.at(theta)
    along = -demo.gas_force(theta) - MASS * at.piston_acceleration
    assert demo.side_force(theta, MASS) == pytest.approx(along * np.tan(at.lean), abs=1e-9 * np.abs(along).max())


def test_the_full_model_of_the_liner_gives_where_it_is_pushed() -> None:
    """A line of force around the middle widens it evenly, as it does a long thin tube: P lambda R^2/(2 E t), lambda^4 =
    3 (1 - nu^2)/(R t)^2. A place that is pushed gives most there, and under a push elsewhere what that one gives under
    its own."""
    middle, count = 0.5 * sum(demo.LINER), 4800
    angle = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    around = np.stack([np.full(count, middle), demo.BORE * np.cos(angle), demo.BORE * np.sin(angle)], axis=1)
    ring = demo.liner_at_rest(around, np.ones(count), around)
    R, t, E, nu = demo.BORE + 0.5 * demo.LINER_WALL, demo.LINER_WALL, demo.IRON.youngs_modulus, demo.IRON.poisson_ratio
    tube = count / (2.0 * np.pi * R) * (3.0 * (1.0 - nu**2)) ** 0.25 * R**2 / (2.0 * E * t * np.sqrt(R * t))
    assert np.ptp(ring) < 1e-3 * ring.max()
    assert ring.mean() == pytest.approx(tube, rel=0.15)
    places = around[[300, 1700]] + [[0.02, 0.0, 0.0], [-0.01, 0.0, 0.0]]
    first = demo.liner_at_rest(places[:1], np.array([1.0]), np.vstack([places, around]))
    second = demo.liner_at_rest(places[1:], np.array([1.0]), places)
    assert first[0] == first.max()
    assert first[1] == pytest.approx(second[0], rel=1e-6)


def test_the_run_begins_with_velocities_that_agree_and_films_that_carry(body: wf.ReducedBody) -> None:
    assert body.report["warnings"] == []
    liner = demo.liner_body(progress=False)
    assert liner.report["warnings"] == []
    result = demo.run(demo.machine(body, liner), 2.0, turns=0.1, progress=False)
    assert result.status == "completed", result.message
    alone = [note for note in result.history.notes if "through its global modes alone" in note]
    assert len(alone) == 2  # of the skirt's two sides, and of both films on the liner
    found = np.sum([result.film(name).force[:, 2] for name in (demo.THRUST, demo.ANTI)], axis=0)
    exact = demo.side_force(demo.SPEED * result.time, body.mass)
    assert np.abs(found - exact)[2:].max() < 0.3 * np.abs(exact).max()
    assert np.abs(result.body("rod").velocity[0, 2] - demo.CRANK * demo.SPEED).max() < 1e-3 * demo.CRANK * demo.SPEED
    gives = demo.given(result, body, len(result.time) - 1)
    assert gives.liner == pytest.approx(gives.exact, abs=0.2 * np.abs(gives.exact).max())
