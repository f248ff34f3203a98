"""The piston in its liner, whole; its mesh, its rigid mechanism, its full model of the liner, its start."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from checks import Check, both_sizes, left_behind, missed
from engine import Mechanism, make
from scipy.sparse.linalg import spsolve

import warpffrf as wf
from demos import piston as demo
from demos.connecting_rod import crank_degrees, within
from demos.piston import (
    ANTI,
    BORE,
    CLEARANCE,
    COUNTED,
    IRON,
    LINER,
    LINER_CELLS,
    OIL,
    ROD,
    ROD_CENTRE,
    ROD_INERTIA,
    ROD_MASS,
    SPEED,
    THRUST,
    TURNS,
    liner_mesh,
    place,
    skirt_form,
)
from warpffrf.offline.fe import assemble, assign

FIRING = (340.0, 420.0)  # deg
SIDE, SIDE_MEAN = 0.02, 0.01  # of the peak force: the peak, root of the mean square
TURNS_ROUND, REPEATS = 15.0, 0.01  # deg; of the way of the pin across the bore
GIVES, FOLLOWS = 0.03, 0.3  # of what the liner gives
SHEAR = 0.1  # of the friction power
STEP = 0.02  # of smallest film and peak pressure, by half a step
WORK, BALANCE = 2e-3, 0.03  # of the gas; of the losses


def side_force(theta: np.ndarray, mass: float) -> np.ndarray:
    """z component [N] of what the liner does to a piston of `mass` [kg] in the rigid mechanism at crank angles (T,)
    [rad].

    A rod of mass m and inertia I, its centre at g from the crank pin, leans by phi, r sin(theta) + l sin(phi) = 0. With
    u along it, the acceleration a_G of its centre, x'' of the piston of mass m_p and the gas force A p, the rod pushes
    the piston, and the piston the films, to the side by W_z,

        W_x = -A p - m_p x'',     u x W = (I phi'' + g m u x a_G)/l,

    the mechanism without clearance, where W pushes the small end. Films carry the same, but for the piston's mass
    across the bore and what their drag along it adds to W_x.
    """
    at = Mechanism.at(theta)
    u, across = at.along, np.stack([-at.along[:, 1], at.along[:, 0]], axis=1)
    a_G = at.pin_acceleration + ROD_CENTRE * (at.turning[:, None] * across - at.rate[:, None] ** 2 * u)
    W_x = -make.gas_force(theta) - mass * at.piston_acceleration
    turned = ROD_INERTIA[1] * at.turning + ROD_CENTRE * ROD_MASS * (u[:, 0] * a_G[:, 1] - u[:, 1] * a_G[:, 0])
    return (turned / ROD + u[:, 1] * W_x) / u[:, 0]


@dataclass(frozen=True)
class Given:
    """What liner and skirt give at the nodes of the thrust film (columns, rows) [m], and the liner's full model at rest
    under the same pressures."""

    liner: np.ndarray
    skirt: np.ndarray
    exact: np.ndarray


def given(result: wf.Result, piston_is: wf.ReducedBody, row: int) -> Given:
    """In the saved step `row`: the skirt by its modes and compliance, the liner what is left of the gap."""
    surface, film, piston = piston_is.contact_surfaces[THRUST], result.film(THRUST), result.body("piston")
    theta, z = np.meshgrid(film.theta, film.z, indexing="ij")
    pressure = film.pressure[row] + film.asperity[row]
    forces = np.ravel(surface.grid.along_theta(pressure @ surface.gram_z))
    moved = surface.mode_normal @ piston.modal[row] - surface.compliance(np.arange(surface.grid.columns)) @ forces
    world = _in_world(result, row, surface.shape.point(theta, z))
    straight = BORE - np.hypot(world[..., 1], world[..., 2]) + skirt_form()(theta, z)
    skirt = -moved.reshape(theta.shape)
    places, loads = zip(*(_pushes(result, piston_is, name, row) for name in (THRUST, ANTI)), strict=True)
    exact = liner_at_rest(np.concatenate(places), np.concatenate(loads), world.reshape(-1, 3))
    return Given(film.gap[row] - straight - skirt, skirt, exact.reshape(theta.shape))


def _in_world(result: wf.Result, row: int, points: np.ndarray) -> np.ndarray:
    """Places (..., 3) of the piston's frame."""
    piston, tilt = result.body("piston"), place(result)[1][row]
    c, s = np.cos(tilt), np.sin(tilt)
    return piston.position[row] + points @ np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def _pushes(result: wf.Result, piston_is: wf.ReducedBody, name: str, row: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (n, 3) and forces (n,) [N] of a film's pressure on the bore, at Gauss points between its nodes."""
    shape, film = piston_is.contact_surfaces[name].shape, result.film(name)
    pressure = film.pressure[row] + film.asperity[row]
    x, w = np.polynomial.legendre.leggauss(3)
    part, weight = 0.5 * (x + 1.0), 0.5 * w
    grid_nodes = np.stack([1.0 - part, part])  # (2, points)
    corners = np.stack([[pressure[:-1, :-1], pressure[:-1, 1:]], [pressure[1:, :-1], pressure[1:, 1:]]])
    at = np.einsum("abij,ap,bq->ipjq", corners, grid_nodes, grid_nodes)
    steps, lengths = np.diff(film.theta), np.diff(film.z)
    theta = film.theta[:-1, None] + steps[:, None] * part
    z = film.z[:-1, None] + lengths[:, None] * part
    area = np.multiply.outer(steps[:, None] * weight, lengths[:, None] * weight) * float(shape.radius_at(0.0))
    there = shape.point(*np.meshgrid(theta.ravel(), z.ravel(), indexing="ij"))
    return _in_world(result, row, there.reshape(-1, 3)), np.ravel(at * area)


def liner_at_rest(places: np.ndarray, forces: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """How far (n,) [m] the bore of the full model gives at the places `asked` (n, 3) [m], world, its seats held, under
    radial `forces` (m,) [N] at `places` (m, 3)."""
    mesh = liner_mesh()
    K, _ = assemble(mesh.points, mesh.cells, assign(mesh, IRON))
    columns, rows = 2 * LINER_CELLS[0], 2 * LINER_CELLS[1] + 1
    nodes = mesh.facets("bore").node_set
    x = mesh.points[nodes]
    pitch, length = 2.0 * np.pi / columns, (LINER[1] - LINER[0]) / (rows - 1)
    around = np.rint(np.arctan2(x[:, 2], x[:, 0]) / pitch).astype(int) % columns
    along = np.rint(x[:, 1] / length + 0.5 * (rows - 1)).astype(int)
    number = np.zeros((columns, rows), dtype=int)
    number[around, along] = nodes
    radial = np.zeros((len(mesh.points), 3))
    radial[nodes] = x * (1.0, 0.0, 1.0) / np.hypot(x[:, 0], x[:, 2])[:, None]

    def around_nodes(world: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The nine nodes (n, 9) of the facets at places, and the values of their functions there."""
        u = np.arctan2(world[:, 2], -world[:, 1]) / pitch
        v = (world[:, 0] - LINER[0]) / length
        i, k = 2 * np.floor(0.5 * u).astype(int), 2 * np.floor(0.5 * v).astype(int)
        nine = [number[(i + a) % columns, k + b] for a in range(3) for b in range(3)]
        values = [_quadratic(u - i, a) * _quadratic(v - k, b) for a in range(3) for b in range(3)]
        return np.stack(nine, axis=1), np.stack(values, axis=1)

    nine, values = around_nodes(places)
    load = np.zeros(len(mesh.points))
    np.add.at(load, nine, values * forces[:, None])
    held = mesh.facets("seats").node_set
    free = np.ravel(3 * np.setdiff1d(np.arange(len(mesh.points)), held)[:, None] + np.arange(3))
    u = np.zeros(3 * len(mesh.points))
    f = np.ravel(load[:, None] * radial)[free]
    u[free] = np.asarray(spsolve(sp.csc_matrix(K)[free][:, free], f))
    gives = np.sum(u.reshape(-1, 3) * radial, axis=1)
    nine, values = around_nodes(asked)
    return np.sum(values * gives[nine], axis=1)


def _quadratic(x: np.ndarray, node: int) -> np.ndarray:
    """One at `node` of 0, 1, 2, zero at the others."""
    a, b = (other for other in range(3) if other != node)
    return (x - a) * (x - b) / ((node - a) * (node - b))


def shear_power(result: wf.Result, piston_is: wf.ReducedBody) -> np.ndarray:
    """(T,) W that the oil of both films takes where it only slides, mu U^2/h."""
    speed, total = result.body("piston").velocity[:, 0], np.zeros(len(result.time))
    for name in (THRUST, ANTI):
        surface, film = piston_is.contact_surfaces[name], result.film(name)
        area = surface.grid.along_theta(np.ones((surface.grid.columns, surface.grid.rows)) @ surface.gram_z)
        total += OIL.viscosity * speed**2 * np.sum(area * film.fill / film.gap, axis=(1, 2))
    return total


def thinnest(result: wf.Result, begin: float = 360.0 * COUNTED, end: float = 360.0 * TURNS) -> int:
    """The saved step of the smallest film on the thrust side in a window of crank angles [deg]."""
    there = np.flatnonzero(within(crank_degrees(result), begin, end))
    return int(there[np.argmin(result.film(THRUST).smallest_gap[there])])


def loaded(result: wf.Result) -> int:
    """The saved step of the largest force of both films across the bore in the cycle that counts."""
    force = np.abs(np.sum([result.film(name).force[:, 2] for name in (THRUST, ANTI)], axis=0))
    return int(np.argmax(np.where(within(crank_degrees(result)), force, 0.0)))


def crossing(degrees: np.ndarray, values: np.ndarray) -> float:
    """The crank angle [deg] in `FIRING` where values (T,) change their sign first."""
    there = np.flatnonzero(within(degrees, *FIRING))
    change = there[:-1][np.diff(np.sign(values[there])) != 0.0]
    if not len(change):
        return float("nan")
    i = int(change[0])
    return float(degrees[i] + values[i] / (values[i] - values[i + 1]) * (degrees[i + 1] - degrees[i]))


def force_checks(result: wf.Result, mass: float) -> list[Check]:
    """What both films do across the bore compared with the rigid mechanism, and when the piston follows."""
    degrees = crank_degrees(result)
    counts, exact = within(degrees), side_force(np.radians(degrees), mass)
    found = np.sum([result.film(name).force[:, 2] for name in (THRUST, ANTI)], axis=0)
    apart, peak = (found - exact)[counts], float(np.abs(exact[counts]).max())
    off = place(result)[0][counts]
    source = "rigid mechanism"
    return [
        Check("side force: peak", float(np.abs(found[counts]).max()), peak, source, SIDE, "kN", 1e-3),
        Check("side force differs by, r.m.s.", float(np.sqrt(np.mean(apart**2))), 0.0, f"{source}, over the peak",
              SIDE_MEAN, "N", scale=peak),
        Check("the piston changes sides at crank angle", crossing(degrees, place(result)[0]), crossing(degrees, exact),
              "the force does, over a turn", TURNS_ROUND / 360.0, "deg", scale=360.0),
        Check("a cycle later the pin is off by", float(off[-1] - off[0]), 0.0, "repeats, over its way", REPEATS, "um",
              1e6, scale=float(np.ptp(off))),
    ]  # fmt: skip


def liner_checks(result: wf.Result, rigid: wf.Result, gives: Given, row: int) -> list[Check]:
    """What the liner gives compared with its full model, in the saved step `row`, and what a rigid bore changes."""
    most = np.unravel_index(int(np.argmax(gives.exact)), gives.exact.shape)
    apart = float(np.abs(gives.liner - gives.exact).max())
    film = result.film(THRUST)
    pushes = film.pressure[row] * np.sin(np.abs(film.theta))[:, None]
    return [
        Check("liner gives at most", float(gives.liner[most]), float(gives.exact[most]), "full FE model", GIVES, "um",
              1e6),
        Check("liner: largest difference", apart, 0.0, "full FE model, over the most", GIVES, "um", 1e6,
              scale=float(gives.exact[most])),
        Check("the pin goes further than in a rigid bore by", float(-place(result)[0][row] + place(rigid)[0][row]),
              float(np.average(gives.exact, weights=pushes)), "full FE model, mean under the pressure", FOLLOWS, "um",
              1e6),
    ]  # fmt: skip


def step_checks(result: wf.Result, halved: wf.Result) -> list[Check]:
    """Compared with half the step."""
    film, finer, counts = result.film(THRUST), halved.film(THRUST), within(crank_degrees(halved))
    source, off = "half the step", [np.ptp(place(r)[0][within(crank_degrees(r))]) for r in (result, halved)]
    return [
        Check("halved: smallest film", float(film.smallest_gap[thinnest(result)]),
              float(finer.smallest_gap[thinnest(halved)]), source, STEP, "um", 1e6),
        Check("halved: peak pressure", float(film.largest_pressure[within(crank_degrees(result))].max()),
              float(finer.largest_pressure[counts].max()), source, STEP, "MPa", 1e-6),
        Check("halved: way of the pin across the bore", float(off[0]), float(off[1]), source, STEP, "um", 1e6),
    ]  # fmt: skip


def energy_checks(result: wf.Result, piston_is: wf.ReducedBody, balance: float) -> list[Check]:
    """Friction, works and losses of a cycle; balance: what of the losses may be missing."""
    counts = within(crank_degrees(result))
    time, films = result.time[counts], [result.film(name) for name in (THRUST, ANTI)]
    theta = SPEED * time
    change = {line: float(values[counts][-1] - values[counts][0]) for line, values in result.energy.items()}
    rubbed = np.sum([film.friction_power[counts] for film in films], axis=0)
    lost = float(np.trapezoid(rubbed + np.sum([film.pressure_loss[counts] for film in films], axis=0), time))
    fine = np.linspace(theta[0], theta[-1], 20_001)
    gas = -float(np.trapezoid(make.gas_force(fine), Mechanism.at(fine).piston))
    put_in, stored = change["force_work"] + change["drive_work"], change["kinetic"] + change["strain"]
    return [
        Check("friction power, mean of a cycle", float(np.mean(rubbed)),
              float(np.mean(shear_power(result, piston_is)[counts])), "mu U^2/h", SHEAR, "W"),
        Check("work of the gas in a cycle", change["force_work"], gas, "rigid mechanism", WORK, "J"),
        Check("work of gas and drive in a cycle", put_in, lost + stored, "losses of the films, stored", balance, "J"),
        Check("the ledger leaves open", change["numerical"], 0.0, "over the losses", balance, "J", scale=lost),
    ]  # fmt: skip


MASS = 0.25  # kg, of some piston


@pytest.fixture(scope="module")
def mesh() -> wf.mesh.Mesh:
    return wf.mesh.read(demo.DATA / "piston.msh", length_unit="m").check()


@pytest.fixture(scope="module")
def body() -> wf.ReducedBody:
    return demo.piston_body(progress=False)


def test_the_mesh_of_the_demo_is_that_of_its_script(mesh: wf.mesh.Mesh) -> None:
    made = make.piston_mesh()
    np.testing.assert_array_equal(mesh.points, made.points)
    np.testing.assert_array_equal(mesh.single[1], made.single[1])
    for name in (THRUST, ANTI, "crown", "pin"):
        np.testing.assert_array_equal(mesh.facets(name).single[1], made.facets(name).single[1])
    assert BORE - CLEARANCE - demo.OVAL == make.SKIRT_RADIUS and demo.SKIRT == make.SKIRT


@both_sizes
def test_the_whole_demo(tmp_path: Path, body: wf.ReducedBody, quick: bool) -> None:
    size, balance = (demo.QUICK, 4.0 * BALANCE) if quick else (demo.FULL, BALANCE)
    both, rigid, stiff = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "piston", "rigid", "stiff")
    scene = demo.machine(body, demo.liner_body(progress=False))
    halved, row = demo.run(scene, 0.5 * size.degrees, progress=False), loaded(both)
    found = [
        *force_checks(both, float(body.mass)),
        *liner_checks(both, rigid, given(both, body, row), row),
        *step_checks(both, halved),
        *energy_checks(both, body, balance),
    ]
    assert len(found) == 14 and not missed(found)
    films = [r.film(THRUST).smallest_gap[thinnest(r, 390.0, 420.0)] for r in (both, rigid, stiff)]
    assert films[0] > 1.05 * films[1] and films[2] < 0.4 * films[1]
    assert stiff.film(THRUST).largest_pressure.max() > 4.0 * rigid.film(THRUST).largest_pressure.max()
    off = demo.place(stiff)[0]
    assert np.abs(off).max() < 1.3 * CLEARANCE  # a stiff skirt gives by a tenth of what the true one does


def test_the_mesh_has_the_volume_of_its_parts(mesh: wf.mesh.Mesh) -> None:
    outer = demo.BORE - demo.CLEARANCE - demo.OVAL
    inner = outer - make.WALL
    ring = np.pi * (outer**2 - inner**2)
    around = (0.5 + 1.0 / make.ACROSS) * ring  # of the skirt: half of the turn, and a cell at each of four ends
    crown, belt, skirt = (end - begin for begin, end in (make.CROWN, make.BELT, make.SKIRT))
    round_parts = np.pi * outer**2 * crown + ring * belt + around * skirt
    u = np.linspace(-1.0, 1.0, 20_001)
    core = make.CORE**2 * np.trapezoid(2.0 * np.sqrt(1.0 - make.BULGE * u**2), u)  # at least: its sides bulge
    walls = mesh.volume() - round_parts
    between = 0.5 * (np.pi * inner**2 - core)  # both sides of the pin, as thick as the walls with the bosses at most
    assert 0.3 * between * (make.WALLS[1] - make.WALLS[0]) < walls < between * (make.WALLS[1] - make.WALLS[0])


def test_skirt_bosses_and_crown_are_where_they_should_be(mesh: wf.mesh.Mesh) -> None:
    outer = demo.BORE - demo.CLEARANCE - demo.OVAL
    for name, side in ((demo.THRUST, -1.0), (demo.ANTI, 1.0)):
        points = mesh.points[mesh.facets(name).node_set]
        assert np.hypot(points[:, 1], points[:, 2]) == pytest.approx(outer, rel=1e-9)
        assert np.ptp(points[:, 0]) == pytest.approx(make.SKIRT[1] - make.SKIRT[0])
        arc = 0.25 * np.pi * (1.0 + 2.0 * make.BESIDE / make.ACROSS)
        assert np.arctan2(np.abs(points[:, 1]), side * points[:, 2]).max() == pytest.approx(arc)
    assert mesh.points[mesh.facets("crown").node_set][:, 0] == pytest.approx(make.CROWN[1])
    pin = mesh.points[mesh.facets("pin").node_set]
    assert pin.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.abs(pin[:, 1]).min() > 0.9 * make.CORE


def test_the_mesh_is_alike_on_both_sides(mesh: wf.mesh.Mesh) -> None:
    for axis in (1, 2):
        mirrored = mesh.points * np.where(np.arange(3) == axis, -1.0, 1.0)
        order = [np.lexsort(np.round(points, 9).T) for points in (mesh.points, mirrored)]
        assert mesh.points[order[0]] == pytest.approx(mirrored[order[1]], abs=1e-8)


def test_the_rod_carries_what_the_mechanism_gains() -> None:
    """Power of gas and of the crank on rod and piston is their gain of energy; the side force does no work."""
    theta = np.linspace(0.0, 4.0 * np.pi, 7201)
    at, h = Mechanism.at(theta), (theta[1] - theta[0]) / demo.SPEED
    side = side_force(theta, MASS)
    on_piston = make.gas_force(theta) + MASS * at.piston_acceleration  # x, by the rod
    centre = at.pin + demo.ROD_CENTRE * at.along
    acceleration = np.gradient(np.gradient(centre, h, axis=0), h, axis=0)
    on_big_end = demo.ROD_MASS * acceleration + np.stack([on_piston, -side], axis=1)
    velocity, rate = np.gradient(centre, h, axis=0), at.rate
    energy = 0.5 * (demo.ROD_MASS * np.sum(velocity**2, axis=1) + demo.ROD_INERTIA[1] * rate**2)
    energy = energy + 0.5 * MASS * np.gradient(at.piston, h) ** 2
    power = np.sum(on_big_end * np.gradient(at.pin, h, axis=0), axis=1)
    power = power - make.gas_force(theta) * np.gradient(at.piston, h)
    inner = slice(4, -4)
    assert np.gradient(energy, h)[inner] == pytest.approx(power[inner], abs=2e-3 * np.abs(power).max())


def test_without_inertia_the_side_force_is_that_of_the_lean(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(globals(), "ROD_MASS", 0.0)
    monkeypatch.setitem(globals(), "ROD_INERTIA", (0.0, 0.0, 0.0))
    theta = np.linspace(0.0, 4.0 * np.pi, 721)
    at = Mechanism.at(theta)
    along = -make.gas_force(theta) - MASS * at.piston_acceleration
    assert side_force(theta, MASS) == pytest.approx(along * np.tan(at.lean), abs=1e-9 * np.abs(along).max())


@pytest.mark.slow
def test_the_full_model_of_the_liner_gives_where_it_is_pushed() -> None:
    """A line of force around the middle widens it evenly, as it does a long thin tube: P lambda R^2/(2 E t), lambda^4 =
    3 (1 - nu^2)/(R t)^2. A place that is pushed gives most there, and under a push elsewhere what that one gives under
    its own."""
    middle, count = 0.5 * sum(demo.LINER), 4800
    angle = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    around = np.stack([np.full(count, middle), demo.BORE * np.cos(angle), demo.BORE * np.sin(angle)], axis=1)
    ring = liner_at_rest(around, np.ones(count), around)
    R, t, E, nu = demo.BORE + 0.5 * demo.LINER_WALL, demo.LINER_WALL, demo.IRON.youngs_modulus, demo.IRON.poisson_ratio
    tube = count / (2.0 * np.pi * R) * (3.0 * (1.0 - nu**2)) ** 0.25 * R**2 / (2.0 * E * t * np.sqrt(R * t))
    assert np.ptp(ring) < 1e-3 * ring.max()
    assert ring.mean() == pytest.approx(tube, rel=0.15)
    places = around[[300, 1700]] + [[0.02, 0.0, 0.0], [-0.01, 0.0, 0.0]]
    first = liner_at_rest(places[:1], np.array([1.0]), np.vstack([places, around]))
    second = liner_at_rest(places[1:], np.array([1.0]), places)
    assert first[0] == first.max()
    assert first[1] == pytest.approx(second[0], rel=1e-6)


def test_the_run_begins_with_velocities_that_agree_and_films_that_carry(body: wf.ReducedBody) -> None:
    assert body.report["warnings"] == []
    liner = demo.liner_body(progress=False)
    assert liner.report["warnings"] == []
    result = demo.run(demo.machine(body, liner), 2.0, turns=0.1, progress=False)
    assert result.status == "completed", result.message
    alone = [note for note in result.history.notes if "by its global modes alone" in note]
    assert len(alone) == 2  # of the skirt's two sides, and of both films on the liner
    found = np.sum([result.film(name).force[:, 2] for name in (demo.THRUST, demo.ANTI)], axis=0)
    exact = side_force(demo.SPEED * result.time, body.mass)
    assert np.abs(found - exact)[2:].max() < 0.3 * np.abs(exact).max()
    assert np.abs(result.body("rod").velocity[0, 2] - demo.CRANK * demo.SPEED).max() < 1e-3 * demo.CRANK * demo.SPEED
    gives = given(result, body, len(result.time) - 1)
    assert gives.liner == pytest.approx(gives.exact, abs=0.2 * np.abs(gives.exact).max())
