"""The connecting rod, whole; its mesh, its mechanism by differences and energy, its reference by a wider clearance."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed
from engine import Mechanism, cross, make

import warpffrf as wf
from demos import connecting_rod as demo
from demos.connecting_rod import (
    BIG,
    CLEARANCE,
    FILM,
    FIRING,
    GROOVES,
    OIL,
    PISTON_MASS,
    ROD,
    SPEED,
    TURNS,
    crank_degrees,
    within,
)
from references.films.elastic import ElasticJournal, State

FORCE, FORCE_MEAN = 0.02, 0.003  # of the peak force: largest difference, root of the mean square
REFERENCE = 0.015  # of smallest film and peak pressure
STEP = 0.01  # of the same, by half a step
WORK = 2e-3  # of the gas, on the rigid mechanism
BALANCE = 0.01  # of the losses: what the ledger may miss with steps of a degree, as the step squared
REFERENCE_STEP = 2.0  # deg of the crank: a step of the dense film


@dataclass(frozen=True)
class Forces:
    """On a rigid rod, (T, 2) [N], x and z: by the film on the big end and by the piston on the small one.

    The rod of mass m and inertia I, its centre of mass at g from the pin, leans by phi, r sin(theta) + l sin(phi) = 0.
    With u along the rod, the acceleration a_G of its centre, x_p'' of the piston and the gas force A p on it, the
    piston pushes the small end by W, and the film the big end by F:

        W_x = -A p - m_p x_p'',     u x W = (I phi'' + g m u x a_G)/l,     F = m a_G - W.
    """

    film: np.ndarray
    piston: np.ndarray

    @classmethod
    def at(cls, reduced: wf.ReducedBody, theta: np.ndarray) -> Forces:
        """At crank angles (T,) [rad]."""
        m, g, inertia = reduced.mass, float(reduced.center_of_mass[0]), float(reduced.inertia[1, 1])
        at = Mechanism.at(theta)
        u, across = at.along, np.stack([-at.along[:, 1], at.along[:, 0]], axis=1)
        a_G = at.pin_acceleration + g * (at.turning[:, None] * across - at.rate[:, None] ** 2 * u)
        W_x = -make.gas_force(theta) - PISTON_MASS * at.piston_acceleration
        moment = (inertia * at.turning + g * m * cross(u, a_G)) / ROD
        W = np.stack([W_x, (moment + u[:, 1] * W_x) / u[:, 0]], axis=1)
        return cls(m * a_G - W, W)


@dataclass(frozen=True)
class Kept(State):
    """The state of an earlier step, with what widened the gap at the nodes then next to the pressures."""

    widened: np.ndarray = field(default_factory=lambda: np.zeros(0))


@dataclass
class LoadedBore(ElasticJournal):
    """A bore that is also displaced by other loads: by `widened` (nodes,) [m] in the step that is being solved."""

    widened: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.widened = np.zeros(self.grid.count)

    def gap(self, state: State) -> np.ndarray:
        return super().gap(state) + self.basis.between @ self._widened(state)

    def gap_at_nodes(self, state: State) -> np.ndarray:
        return super().gap_at_nodes(state) + self._widened(state)

    def turns(self, speed: float) -> None:
        """The pin's speed in the bore [rad/s]."""
        self.carried_with = 0.5 * speed * self.radius
        self.outflow = self.basis.outflow(self.carried_with)

    def kept(self, state: State) -> Kept:
        """A state that has just been solved, for the steps to come."""
        return Kept(state.place, state.pressure, state.asperity, state.void, state.full, self.widened)

    def _widened(self, state: State) -> np.ndarray:
        return state.widened if isinstance(state, Kept) else self.widened


@dataclass(frozen=True)
class Dense:
    """By the reference at crank angles (T,) [deg]: smallest film [m], peak pressure [Pa], pressure (T, columns, rows)
    at the nodes."""

    degrees: np.ndarray
    thinnest: np.ndarray
    peak: np.ndarray
    pressure: np.ndarray


def dense(reduced: wf.ReducedBody, step: float, *, last: float = 360.0 * TURNS) -> Dense:
    """The film of the rod's bore by the reference from the start of the run, in steps of so many degrees. Raises
    RuntimeError where it fails."""
    surface, eye = reduced.contact_surfaces["bore"], reduced.interfaces["eye"].modes
    grid, soft = surface.grid, surface.mode_normal / (2.0 * np.pi * reduced.frequencies) ** 2
    theta = grid.theta_start + grid.pitch * np.arange(grid.columns)
    held = np.zeros(grid.columns, dtype=bool)
    held[[int(np.argmax(np.cos(theta - groove))) for groove in GROOVES]] = True
    compliance = surface.compliance(np.arange(grid.columns)) + soft @ surface.mode_normal.T
    film = LoadedBore(BIG, CLEARANCE, OIL, SPEED, theta, grid.z, compliance, held)
    degrees = step * np.arange(1, round(last / step) + 1)
    at, forces = Mechanism.at(np.radians(degrees)), Forces.at(reduced, np.radians(degrees))
    load, on_eye = at.in_rod(forces.film), at.in_rod(forces.piston)
    widened = -on_eye @ eye[:, [0, 2]].T @ soft.T  # normals point into the bore
    state, earlier, seconds, states = film.kept(film.start(np.zeros(2))), None, np.radians(step) / SPEED, []
    for k, angle in enumerate(degrees):
        film.turns(SPEED - float(at.rate[k]))
        film.widened = widened[k]
        new, _ = film.stepped(state, load[k], seconds, earlier=earlier)
        if new is None:
            raise RuntimeError(f"the reference of the demo did not converge at {angle:g} degrees")
        earlier, state = (state, seconds), film.kept(new)
        states.append(state)
    pressure = np.array([(film.basis.to_nodes @ s.pressure).reshape(grid.columns, grid.rows) for s in states])
    return Dense(degrees, np.array([film.gap(s).min() for s in states]), pressure.max(axis=(1, 2)), pressure)


def force_checks(result: wf.Result, reduced: wf.ReducedBody) -> list[Check]:
    """The force of the film over a cycle compared with that of the rigid mechanism."""
    counts = within(crank_degrees(result))
    found = result.film(FILM).force[counts]
    exact = Forces.at(reduced, SPEED * result.time[counts]).film
    apart, peak = np.hypot(*(found[:, [0, 2]] - exact).T), float(np.hypot(*exact.T).max())
    source = "rigid mechanism"
    return [
        Check("force of the film: peak", float(np.linalg.norm(found, axis=1).max()), peak, source, FORCE, "kN", 1e-3),
        Check("force of the film differs by at most", float(apart.max()), 0.0, f"{source}, over the peak", FORCE, "N",
              scale=peak),
        Check("force of the film differs by, r.m.s.", float(np.sqrt(np.mean(apart**2))), 0.0,
              f"{source}, over the peak", FORCE_MEAN, "N", scale=peak),
    ]  # fmt: skip


def film_checks(result: wf.Result, reference: Dense, label: str) -> list[Check]:
    """Smallest film of the cycle and under the combustion, and peak pressure, compared with the reference."""
    film, degrees = result.film(FILM), crank_degrees(result)
    counts, fires = within(degrees), within(degrees, *FIRING)
    there, firing = within(reference.degrees), within(reference.degrees, *FIRING)
    source = "dense reference"
    return [
        Check(f"{label}: smallest film", float(film.smallest_gap[counts].min()),
              float(reference.thinnest[there].min()), source, REFERENCE, "um", 1e6),
        Check(f"{label}: smallest film while firing", float(film.smallest_gap[fires].min()),
              float(reference.thinnest[firing].min()), source, REFERENCE, "um", 1e6),
        Check(f"{label}: peak pressure", float(film.largest_pressure[counts].max()),
              float(reference.peak[there].max()), source, REFERENCE, "MPa", 1e-6),
    ]  # fmt: skip


def step_checks(result: wf.Result, halved: wf.Result) -> list[Check]:
    """Compared with half the step."""
    film, finer = result.film(FILM), halved.film(FILM)
    counts, there = within(crank_degrees(result)), within(crank_degrees(halved))
    source = "half the step"
    return [
        Check("halved: smallest film", float(film.smallest_gap[counts].min()), float(finer.smallest_gap[there].min()),
              source, STEP, "um", 1e6),
        Check("halved: peak pressure", float(film.largest_pressure[counts].max()),
              float(finer.largest_pressure[there].max()), source, STEP, "MPa", 1e-6),
    ]  # fmt: skip


def energy_checks(result: wf.Result, balance: float) -> list[Check]:
    """Works and losses of a cycle; balance: what of the losses may be missing."""
    counts = within(crank_degrees(result))
    theta, film = SPEED * result.time[counts], result.film(FILM)
    change = {line: float(values[counts][-1] - values[counts][0]) for line, values in result.energy.items()}
    power = (film.pressure_loss + film.friction_power)[counts]
    lost = float(np.trapezoid(power, result.time[counts]))
    fine = np.linspace(theta[0], theta[-1], 20_001)
    gas = -float(np.trapezoid(make.gas_force(fine), Mechanism.at(fine).piston))
    stored = change["kinetic"] + change["strain"]
    return [
        Check("work of the gas in a cycle", change["force_work"], gas, "rigid mechanism", WORK, "J"),
        Check("work of gas and drive in a cycle", change["force_work"] + change["drive_work"], lost + stored,
              "losses of the film, stored", balance, "J"),
        Check("the ledger leaves open", change["numerical"], 0.0, "over the losses", balance, "J", scale=lost),
    ]  # fmt: skip


THETA = np.linspace(0.0, 4.0 * np.pi, 7201)
SOME_ROD: Any = SimpleNamespace(mass=0.7, center_of_mass=np.array([0.05, 0.0, 0.0]), inertia=np.diag([1.0, 3e-3, 1.0]))


@pytest.fixture(scope="module")
def mesh() -> wf.mesh.Mesh:
    return wf.mesh.read(demo.DATA / "connecting_rod.msh", length_unit="m").check()


def test_the_data_of_the_demo_are_those_of_their_script(mesh: wf.mesh.Mesh) -> None:
    made = make.rod_mesh()
    np.testing.assert_array_equal(mesh.points, made.points)
    np.testing.assert_array_equal(mesh.single[1], made.single[1])
    for name in ("bore", "eye"):
        np.testing.assert_array_equal(mesh.facets(name).single[1], made.facets(name).single[1])
    times = THETA[::40] / SPEED
    assert -np.asarray(demo.gas()(times)) == pytest.approx(make.gas_force(THETA[::40]), abs=30.0)  # a spline, 31 kN


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    size, balance = (demo.QUICK, 4.0 * BALANCE) if quick else (demo.FULL, BALANCE)
    steel, stiff = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "connecting_rod", "stiff")
    rods = {"steel": demo.rod_body(progress=False), "stiff": demo.rod_body(demo.STIFF, progress=False)}
    halved = demo.run(rods["steel"], 0.5 * size.degrees, progress=False)
    found = [
        *force_checks(steel, rods["steel"]),
        *film_checks(steel, dense(rods["steel"], REFERENCE_STEP), "steel"),
        *film_checks(stiff, dense(rods["stiff"], REFERENCE_STEP), "stiff"),
        *step_checks(steel, halved),
        *energy_checks(steel, balance),
    ]
    assert len(found) == 14 and not missed(found)
    computed = {check.name: check.computed for check in found}
    for what, least in (("smallest film while firing", 0.05), ("peak pressure", 0.02)):
        assert computed[f"steel: {what}"] < (1.0 - least) * computed[f"stiff: {what}"]


def test_the_mesh_has_the_volume_of_its_parts(mesh: wf.mesh.Mesh) -> None:
    rings = sum(np.pi * (outer**2 - inner**2) for inner, outer in (
        (demo.BIG, make.BIG_OUTER), (make.SMALL, make.SMALL_OUTER)
    ))  # fmt: skip
    half, end = make.BIG_OUTER * np.sin(np.pi / 8.0), make.SMALL_OUTER * np.sin(np.pi / 4.0)
    length = demo.ROD - make.BIG_OUTER * np.cos(np.pi / 8.0) - make.SMALL_OUTER * np.cos(np.pi / 4.0)
    caps = sum(0.5 * r**2 * (a - np.sin(a)) for r, a in (
        (make.BIG_OUTER, np.pi / 4.0), (make.SMALL_OUTER, np.pi / 2.0)
    ))  # fmt: skip
    exact = make.WIDTH * rings + 0.5 * make.WIDTH * ((half + end) * length - caps)
    assert mesh.volume() == pytest.approx(exact, rel=1e-3)


def test_the_tetrahedra_of_neighbouring_lattices_share_their_faces(mesh: wf.mesh.Mesh) -> None:
    """Where the shank grows out of the eyes there is no outside."""
    middle = mesh.outer_facets().centers(mesh.points)
    inside = np.abs(middle[:, 1]) < 0.2 * make.WIDTH
    for x, radius, half in ((0.0, make.BIG_OUTER, np.pi / 8.0), (demo.ROD, make.SMALL_OUTER, np.pi / 4.0)):
        off = np.hypot(middle[:, 0] - x, middle[:, 2]) - radius
        angle = np.arctan2(middle[:, 2], np.abs(middle[:, 0] - x))
        towards = (middle[:, 0] - x) * (0.5 * demo.ROD - x) > 0.0
        assert not np.any(inside & towards & (np.abs(off) < 0.02 * radius) & (np.abs(angle) < 0.9 * half))
        assert np.any(inside & ~towards & (np.abs(off) < 0.02 * radius))


def test_the_bores_are_round(mesh: wf.mesh.Mesh) -> None:
    for name, x, radius in (("bore", 0.0, demo.BIG), ("eye", demo.ROD, make.SMALL)):
        points = mesh.points[mesh.facets(name).node_set]
        assert np.hypot(points[:, 0] - x, points[:, 2]) == pytest.approx(radius, rel=1e-12)
        assert mesh.sets[name] == 2 * make.WIDE * make.SECTORS // (1 if name == "bore" else 2)


def test_the_mechanism_is_its_own_derivatives() -> None:
    at, h = Mechanism.at(THETA), (THETA[1] - THETA[0]) / demo.SPEED
    for place, second in ((at.piston, at.piston_acceleration), (at.lean, at.turning), (at.pin, at.pin_acceleration)):
        found = (place[2:] - 2.0 * place[1:-1] + place[:-2]) / h**2
        assert found == pytest.approx(second[1:-1], abs=1e-5 * np.abs(second).max())
    assert np.gradient(at.lean, h)[1:-1] == pytest.approx(at.rate[1:-1], abs=1e-5 * np.abs(at.rate).max())
    small_end = at.pin + demo.ROD * at.along
    assert small_end == pytest.approx(np.stack([at.piston, 0.0 * THETA], axis=1), abs=1e-15)


def test_film_and_gas_put_in_what_the_mechanism_gains() -> None:
    at, h = Mechanism.at(THETA), (THETA[1] - THETA[0]) / demo.SPEED
    forces = Forces.at(SOME_ROD, THETA)
    pin, centre, piston = (np.gradient(x, h, axis=0) for x in (
        at.pin, at.pin + SOME_ROD.center_of_mass[0] * at.along, at.piston
    ))  # fmt: skip
    moving = SOME_ROD.mass * np.sum(centre**2, axis=1) + SOME_ROD.inertia[1, 1] * at.rate**2
    energy = 0.5 * (moving + demo.PISTON_MASS * piston**2)
    power = np.sum(forces.film * pin, axis=1) - make.gas_force(THETA) * piston
    inner = slice(2, -2)
    assert np.gradient(energy, h)[inner] == pytest.approx(power[inner], abs=1e-4 * np.abs(power).max())


def test_the_gas_repeats_after_two_turns_and_burns_behind_the_dead_centre() -> None:
    force = make.gas_force(THETA)
    assert force == pytest.approx(make.gas_force(THETA + 4.0 * np.pi), abs=1e-6)
    degrees = np.degrees(THETA)
    assert 365.0 < degrees[np.argmax(force)] < 400.0
    assert not np.any(force[(degrees < make.INLET_SHUTS[0]) | (degrees > make.OUTLET_OPENS[1] + 1e-6)])
    assert np.abs(np.diff(force, 2)).max() < 1e-3 * force.max()


def test_a_bore_widened_everywhere_is_a_wider_bore() -> None:
    theta, z = 2.0 * np.pi * np.arange(16) / 16, np.linspace(-0.5, 0.5, 5) * make.WIDTH
    none, held, wider = np.zeros((80, 80)), np.arange(16) == 8, 0.2 * demo.CLEARANCE
    films = [
        LoadedBore(demo.BIG, clearance, demo.OIL, demo.SPEED, theta, z, none, held)
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
    assert films[0].gap_at_nodes(ends[0]) == pytest.approx(films[1].gap_at_nodes(ends[1]), rel=1e-6)


@pytest.mark.slow
def test_the_run_begins_with_velocities_that_agree_and_a_film_that_comes_to_carry() -> None:
    body = demo.rod_body(progress=False)
    assert body.report["warnings"] == []
    result = demo.run(body, 2.0, turns=0.25, progress=False)
    assert result.status == "completed", result.message
    film, last = result.film(demo.FILM), result.time > 0.1 * 2.0 * np.pi / demo.SPEED
    exact = Forces.at(body, demo.SPEED * result.time).film
    mean = (film.force[:, [0, 2]] - exact)[last].mean(axis=0)
    assert film.smallest_gap.min() > 0.1 * demo.CLEARANCE
    assert np.abs(mean).max() < 0.1 * np.abs(exact).max()
