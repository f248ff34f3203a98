"""Friction on cells that travel with the patch: the displacements of cells under random tractions and pressures against
a dense NumPy reference, and what must hold of compliance and history."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from rolling_reference import Cells, Side, near
from warpffrf_kernels.core import control as k
from warpffrf_kernels.friction.cell_blocks import COUNT

import warpffrf as wf
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.online import Engine
from warpffrf.online.compile.patch_plan import PatchPlan

RADIUS, WIDTH, BALL = 0.05, 0.02, 0.03
STEEL, ALUMINIUM = wf.Material(210e9, 0.3, 7800.0), wf.Material(70e9, 0.34, 2700.0)
APPROACH, SKEW = 20e-6, 0.01  # m; rad, of the second roller about the line of centres
COLUMNS, ROWS = 9, 11  # rows that do not fill their lines
STRIPS_AROUND = 3  # whose displacements are kept on either side
MU = 0.3
# of the largest displacement: near fields of fixed rows lie between levels of W, by cubics
SAME = {"plane": 2e-5, "rollers": 2e-5, "ball": 1e-10}
SEEN = 0.02  # of the largest displacement, that each part of it has at least
TURNED = 1e-7  # of modes: places opposite, along the line of centres and the normal of the second body
ROUND_OFF = 1e-12  # of the largest entry: sums of some hundred terms
EPSILON = 4e-15  # the same of one sum of a few numbers, shares of cubics among them
READ = 1e-13  # of the largest displacement: round-off of places in strips
DIFFERENCES = 1e-11  # of the largest entry: what is left of differences of displacements


@pytest.fixture(scope="module")
def bodies() -> dict[str, ReducedBody]:
    """Elements of 8 mm on the rim."""
    mesh = wf.mesh.roller(RADIUS, 0.015, WIDTH, sectors=40, layers=4, axial=3, order=1)
    return {
        name: wf.reduce(
            mesh, material, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, max_frequency=12e3,
            patch_grid=True, tangential=True, cache=False, progress=False,
        )
        for name, material in (("steel", STEEL), ("aluminium", ALUMINIUM))
    }  # fmt: skip


def scene_of(kind: str, bodies: dict[str, ReducedBody]) -> wf.Scene:
    """A steel roller on a rigid plane, on a skewed roller of aluminium, or on a rigid ball, bores held."""
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(bodies["steel"], name="lower")
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    if kind == "rollers":
        turn = (0.0, 0.0, np.sin(0.5 * SKEW), np.cos(0.5 * SKEW))
        upper = scene.add_body(
            bodies["aluminium"], name="upper", position=(0, 0, 2 * RADIUS - APPROACH), rotation=turn
        )  # fmt: skip
        scene.add(wf.joints.Fixed(scene.ground, upper["bore"]))
        partner = upper["rim"]
    elif kind == "plane":
        shape: Any = wf.surfaces.Plane(origin=(0, 0, RADIUS - APPROACH), outward=(0, 0, -1), direction=(0, 1, 0))
        partner = scene.ground.surface(shape, name="partner")
    else:
        at = (0.0, 1e-3, RADIUS + BALL - APPROACH)
        shape = wf.surfaces.Sphere(radius=BALL, axis_point=at, axis_direction=(0, 1, 0))
        partner = scene.ground.surface(shape, name="partner")
    scene.add(wf.Contact(lower["rim"], partner, friction=MU, grid="patch", cells=(COLUMNS, ROWS), name="pair"))
    return scene


@dataclass
class Held:
    """A pair at rest, and what its kernels make of numbers put on its cells."""

    kind: str
    engine: Engine
    bodies: dict[str, ReducedBody]

    @property
    def count(self) -> int:
        return COLUMNS * ROWS

    def read(self, name: str, parts: int = 1) -> np.ndarray:
        """Numbers of cells (parts, n), of arrays with two directions `parts` 2."""
        x, s = self.engine.scratch, self.engine.state
        values = (getattr(x, name) if hasattr(x, name) else getattr(s, name)).numpy().ravel()
        return values[: parts * self.count].reshape(COLUMNS, parts, ROWS).transpose(1, 0, 2).reshape(parts, -1).copy()

    def put(self, pressure: np.ndarray, traction: np.ndarray) -> None:
        """p (n,) and tau (2, n) [Pa] on the cells; tractions within mu p."""
        s = self.engine.state
        ordered = traction.reshape(2, COLUMNS, ROWS).transpose(1, 0, 2).ravel()
        for array, values in ((s.pressure, pressure), (s.traction, ordered), (s.active, pressure > 0.0)):
            filled = np.zeros(array.shape)
            filled.reshape(-1)[: len(values)] = values
            array.assign(filled.astype(array.numpy().dtype))

    def evaluate(self) -> None:
        """Displacements of what is on the cells, friction acting, the bodies where they are."""
        self.engine.control(mode=int(k.DYNAMIC), run=1, moved=1, changes=0, iteration=0)
        self.engine.graph.program.run(("shift", "cells", "displace", "slide"))

    def displaced(self, pressure: np.ndarray, traction: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """e of local modes, of all (2, n), and gaps (n,) opened by them, at the cells [m]."""
        self.put(pressure, traction)
        self.evaluate()
        area = self.read("cell_area")[0]
        return self.read("elastic_local", 2), self.read("elastic", 2), self.read("first_local")[0] / area

    def places(self) -> tuple[Cells, np.ndarray, np.ndarray]:
        """Cells, theta and z (n,) of their centres on the first surface."""
        column, middle, half_width, _ = self.engine.scratch.patch_place.numpy()[0, 0]
        plan = PatchPlan.of(self.engine.scene.contacts[0])
        scale = half_width if plan.follows else 1.0
        rows = scale * plan.z + (middle if plan.follows else 0.0)
        strip = 2.0 * half_width / COLUMNS
        x = np.repeat(strip * (np.arange(COLUMNS) - 0.5 * (COLUMNS - 1)), ROWS)
        cells = Cells(x, np.tile(rows, COLUMNS), strip, np.tile(scale * plan.length, COLUMNS))
        grid = self.bodies["steel"].contact_surfaces["rim"].grid
        return cells, grid.theta_start + grid.pitch * column + x / RADIUS, cells.z


@pytest.fixture(scope="module", params=list(SAME))
def held(request, bodies) -> Held:
    engine = Engine(scene_of(request.param, bodies))
    engine.static_step(1.0)
    assert engine.word("status")[0] == 0
    engine.control(run=1, moved=1)
    return Held(request.param, engine, bodies)


def loads(held: Held, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Pressures and tractions within their bounds, of no order."""
    rng = np.random.default_rng(seed)
    pressure = rng.uniform(5e8, 1e9, held.count)
    return pressure, 0.7 * MU * 5e8 * rng.uniform(-1.0, 1.0, (2, held.count))


# --- displacements


def sides(held: Held) -> tuple[Cells, Side, Side | None, np.ndarray]:
    """The cells, what both bodies have under them, and tangents Q (2 n, 2 n) of the second in those of the first."""
    cells, theta, z = held.places()
    bodies, n = held.bodies, len(z)
    first = Side(bodies["steel"], "rim", theta, z)
    if held.kind != "rollers":
        return cells, first, None, np.zeros((2 * n, 2 * n))
    one, two = (bodies[name].contact_surfaces["rim"].shape for name in ("steel", "aluminium"))
    turn, at = held.engine.scratch.axes.numpy()[0], held.engine.scratch.r1.numpy()[0]
    place = at[0] + one.point(theta, z) @ turn[0].T
    theta_b, z_b, _ = two.chart((place - at[1]) @ turn[1])
    c = np.array([0.0, 0.0, 1.0])
    u_1 = one.around(theta) @ turn[0].T
    u_1 -= np.outer(u_1 @ c, c)
    u_1 /= np.linalg.norm(u_1, axis=1)[:, None]
    v_1 = two.around(theta_b) @ turn[1].T
    v_2 = np.cross(two.normal(theta_b, z_b) @ turn[1].T, v_1)
    Q = [[np.diag(np.sum(u * v, axis=1)) for v in (v_1, v_2)] for u in (u_1, np.cross(c, u_1))]
    return cells, first, Side(bodies["aluminium"], "rim", theta_b, z_b), np.block(Q)


def test_displacements_are_those_of_the_reference(held: Held) -> None:
    cells, first, second, Q = sides(held)
    pressure, traction = loads(held)
    q1 = held.engine.scratch.q1
    kept = q1.numpy().copy()
    amplitude = 1e-5 * np.random.default_rng(1).uniform(-1.0, 1.0, kept.shape)
    q1.assign(amplitude)
    local, everything, _ = held.displaced(pressure, traction)
    q1.assign(kept)
    T, P = near(cells, held.bodies["steel"], "rim", 1.0, ends=held.kind != "ball")
    area = np.tile(cells.area, 2)
    far, pressed = first.by_forces * area, -first.outward.T * cells.area
    modes = first.modes @ amplitude[0, : first.modes.shape[1]]
    if second is not None:
        more = near(cells, held.bodies["aluminium"], "rim", -1.0, ends=True)
        T, P = T + more[0], P + more[1]
        far = far + Q @ second.by_forces @ Q.T * area
        pressed = pressed + Q @ second.outward.T * cells.area
        modes = modes - Q @ second.modes @ amplitude[0, first.modes.shape[1] :]
    tau = traction.ravel()
    parts = [T @ tau, P @ pressure, far @ tau, pressed @ pressure]
    expected = np.sum(parts, axis=0)
    largest = np.abs(expected).max()
    assert min(np.abs(part).max() for part in parts) > SEEN * largest
    assert np.allclose(cells.area, held.read("cell_area")[0], rtol=1e-9)
    assert np.abs(local.ravel() - expected).max() < SAME[held.kind] * largest
    assert np.abs((everything - local).ravel() - modes).max() < TURNED * np.abs(modes).max()


def test_material_grows_with_its_radius(held: Held) -> None:
    """Outward displacements of far fields and modes times the curvatures of both bodies, first less second."""
    cells, first, second, _ = sides(held)
    pressure, traction = loads(held)
    q1 = held.engine.scratch.q1
    kept = q1.numpy().copy()
    amplitude = 1e-5 * np.random.default_rng(2).uniform(-1.0, 1.0, kept.shape)
    q1.assign(amplitude)
    held.displaced(pressure, traction)
    q1.assign(kept)
    split = first.modes.shape[1]
    force = pressure * cells.area
    grown = (first.modes_outward @ amplitude[0, :split] - first.pressed_outward @ force) / RADIUS
    if second is not None:
        outward = second.modes_outward @ amplitude[0, split:] - second.pressed_outward @ force
        grown -= outward * np.cos(SKEW) ** 2 / RADIUS
    found = held.read("weak_grown")[0] / cells.area
    assert np.abs(found - grown).max() < TURNED * np.abs(grown).max()


def test_tractions_open_gaps_as_pressures_move_cells(held: Held) -> None:
    """Weak gaps by unit tractions are the transpose of weak slips by unit pressures, entry by entry."""
    n, none = held.count, np.zeros((2, held.count))
    area = held.read("cell_area")[0]
    pressure = np.full(n, 1e9)
    gaps, slips = np.zeros((n, 2 * n)), np.zeros((2 * n, n))
    still_slip, _, still_gap = held.displaced(pressure, none)
    for i in range(n):
        more = pressure.copy()
        more[i] += 1e9
        slips[:, i] = np.tile(area, 2) * (held.displaced(more, none)[0] - still_slip).ravel() / 1e9
        for d in range(2):
            unit = none.copy()
            unit[d, i] = 1e8
            gaps[:, d * n + i] = area * (held.displaced(pressure, unit)[2] - still_gap) / 1e8
    assert np.abs(gaps - slips.T).max() < DIFFERENCES * np.abs(slips).max()
    assert np.abs(slips).max() > 0.0


# --- compliance


@pytest.fixture(scope="module", params=list(SAME))
def solved(request, bodies) -> Held:
    """Inside an iteration of a dynamic step, with all cells that are under pressure in play and assembled anew."""
    engine = Engine(scene_of(request.param, bodies))
    engine.static_step(1.0)
    engine.initial_rates()
    engine.control(every=1)
    engine.enter(k.DYNAMIC, 1e-5)
    engine.replay(4)
    assert engine.word("status")[0] == 0 and engine.word("step")[0] == 1
    engine.control(run=1, moved=1, reassemble=1, refresh=1, recenter=0, iteration=0, failure=0, stale=1)
    for _ in range(10):  # until the cells under pressure are those of the width that they ask for
        engine.graph.iterate()
        if engine.word("changes")[0] == 0:
            break
        engine.control(run=1, moved=1, stale=1)
    assert engine.word("failure")[0] == 0 and engine.word("changes")[0] == 0
    assert engine.scratch.cell_block.numpy()[0, 0, COUNT] > 20
    return Held(request.param, engine, bodies)


def test_the_compliance_of_cells_is_what_tractions_displace(solved: Held) -> None:
    x = solved.engine.scratch
    count = int(x.cell_block.numpy()[0, 0, COUNT])
    slots = x.cell_slot.numpy()[0, 0, :count].copy()
    G = x.cell_G.numpy()[0, 0, : 2 * count, : 2 * count].copy()
    J = x.cell_J.numpy().reshape(-1, solved.engine.compiled.model.pairs.most_modes)[: 2 * count].copy()
    receptance, area = x.receptance.numpy()[0].copy(), solved.read("cell_area")[0]
    assert np.array_equal(x.cell_JT.numpy()[0, 0, :, : 2 * count], J.T)
    assert np.abs(G - G.T).max() < ROUND_OFF * np.abs(G).max()
    pressure = np.full(solved.count, 1e9)

    def weak(e: np.ndarray) -> np.ndarray:
        return (area * e)[:, slots].T.ravel()

    none = np.zeros((2, solved.count))
    still = weak(solved.displaced(pressure, none)[0])
    found = np.zeros_like(G)
    for line, (m, d) in enumerate((m, d) for m in slots for d in range(2)):
        unit = none.copy()
        unit[d, m] = 1e8
        found[:, line] = (weak(solved.displaced(pressure, unit)[0]) - still) / 1e8
    found += (J * receptance) @ J.T
    assert np.abs(G - found).max() < DIFFERENCES * np.abs(G).max()
    kept = x.q1.numpy().copy()
    for mode in range(kept.shape[1]):
        unit = np.zeros_like(kept)
        unit[0, mode] = 1.0
        x.q1.assign(unit)
        local, everything, _ = solved.displaced(pressure, none)
        assert np.abs(weak(everything - local) - J[:, mode]).max() < DIFFERENCES * np.abs(J).max()
    x.q1.assign(kept)


# --- history


def kept(held: Held) -> None:
    """The history as an accepted step leaves it, from what was evaluated last."""
    held.engine.control(attempt=1, accept=1)
    held.engine.graph.program.run(("keep",))
    held.engine.control(attempt=0, accept=0, run=1, moved=1)


def test_material_that_stands_slips_by_the_change_of_its_displacement(held: Held) -> None:
    """Not at all under tractions that stay, bit for bit where rows are where they are; to round-off where their places
    follow from W."""
    pressure, traction = loads(held)
    before = held.displaced(pressure, traction)[1]
    kept(held)
    held.evaluate()
    still = held.read("slip", 2) - held.read("rigid_slip", 2)
    assert np.abs(still).max() <= (EPSILON * np.abs(before).max() if held.kind == "ball" else 0.0)
    now = held.displaced(pressure, -0.3 * traction)[1]
    moved = held.read("rigid_slip", 2) + (now - before)
    assert np.abs(held.read("slip", 2) - moved).max() < EPSILON * np.abs(now).max()


@pytest.mark.parametrize("strips", [-1.0, 0.1, 0.37, 2.0])
def test_material_that_has_moved_is_read_by_cubics(held: Held, strips: float) -> None:
    """A cubic of the place on the first body, exactly; rows that follow are wider by 3 %, too, and have moved."""
    state, x = held.engine.state, held.engine.scratch
    held.displaced(np.full(held.count, 1e9), np.zeros((2, held.count)))
    kept(held)
    place = x.patch_place.numpy()[0, 0].copy()
    cells, _, _ = held.places()
    follows = held.kind == "ball"
    rings = STRIPS_AROUND if follows else 0
    wider = 1.03 if follows else 1.0
    old = place.copy()
    old[0] -= strips * cells.width / (RADIUS * held.bodies["steel"].contact_surfaces["rim"].grid.pitch)
    old[1] -= 0.4 * cells.length[0] if follows else 0.0
    old[2] *= wider
    z = cells.z[:ROWS]
    more = cells.length[0] * np.arange(1, rings + 1)
    rows = np.concatenate([z[0] - more[::-1], z, z[-1] + more])
    if follows:
        rows = old[1] + wider * (rows - place[1])
    columns = wider * cells.width * (np.arange(COLUMNS + 2 * STRIPS_AROUND) - 0.5 * (COLUMNS - 1) - STRIPS_AROUND)
    columns = columns - strips * cells.width

    def field(x: np.ndarray, z: np.ndarray) -> np.ndarray:
        a, b = x / (5.0 * cells.width), (z - place[1]) / (5.0 * cells.length[0] if follows else 0.5 * WIDTH)
        return 1e-6 * np.array([1.0 + a - 0.7 * a**3 + a * b + 0.2 * b**3, 0.5 * b - a * a * b + 0.3 * a**3 * b * b])

    ring = np.concatenate([part.ravel() for part in field(columns[:, None], rows[None, :])])
    filled = np.zeros(state.ring_slip.shape[-1])
    filled[: len(ring)] = ring
    state.ring_slip.assign(filled.reshape(state.ring_slip.shape))
    state.ring_place.assign(old.reshape(1, 1, 4))
    held.engine.graph.program.run(("slide",))
    kept(held)
    grown = held.read("weak_grown")[0] / held.read("cell_area")[0]
    way = -strips * cells.width, -(place[1] - old[1])
    expected = held.read("rigid_slip", 2) + held.read("elastic", 2) - field(cells.x, cells.z)
    expected += np.outer(way, grown)
    assert np.abs(held.read("slip", 2) - expected).max() < READ * np.abs(ring).max()
