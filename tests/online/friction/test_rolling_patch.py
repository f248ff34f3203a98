"""Friction on cells that travel with the patch: the displacements of cells under random tractions and pressures against
a dense NumPy reference, and what must hold of compliance and history."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from rolling_reference import Cells, Side, near
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import Engine, run
from warpffrf.online.compile.patches.plan import PatchPlan
from warpffrf.online.engine import KEPT_MARK
from warpffrf_kernels.core import control as k
from warpffrf_kernels.friction.cell_blocks import COUNT

RADIUS, WIDTH, BALL = 0.05, 0.02, 0.03
STEEL, ALUMINIUM = wf.Material(210e9, 0.3, 7800.0), wf.Material(70e9, 0.34, 2700.0)
APPROACH, SKEW = 20e-6, 0.01  # m; rad, of the second roller about the line of centres
COLUMNS, ROWS = 9, 11  # rows that do not fill their lines
STRIPS_MANY = 19  # of a patch that a traction is carried through
STRIPS_AROUND = 3  # whose displacements are kept on either side
MU = 0.3
SPEED = 10.0  # rad/s
# of the largest displacement: near fields of fixed rows lie between levels of W, by cubics
SAME = {"plane": 2e-5, "rollers": 2e-5, "ball": 1e-10}
SEEN = 0.02  # of the largest displacement, that each part of it has at least
TURNED = 1e-7  # of modes: places opposite, along the line of centres and the normal of the second body
ROUND_OFF = 1e-12  # of the largest entry: sums of some hundred terms
EPSILON = 4e-15  # the same of one sum of a few numbers, shares of cubics among them
READ = 1e-13  # of the largest displacement: round-off of places in strips
FORCE, DIRECTION = 1e-3, 0.05  # relative, and degrees: what vibrations of the bodies leave
LOST = 0.01  # of the elastic energy that passes through a patch
ONCE = 1.2  # iterations of a steady step: 1 where bodies follow the couple of the pressures in the first, 1.93 else
DIFFERENCES = 1e-11  # of the largest entry: what is left of differences of displacements


@pytest.fixture(scope="module")
def bodies() -> dict[str, ReducedBody]:
    """Elements of 8 mm on the rim."""
    mesh = wf.mesh.roller(RADIUS, 0.015, WIDTH, sectors=40, layers=4, axial=3, order=1)
    return {
        name: wf.reduce(
            mesh, material, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, max_frequency=12e3,
            grid=wf.ContactGrid(contact_fixed=True, tangential=True), cache=False, progress=False,
        )
        for name, material in (("steel", STEEL), ("aluminium", ALUMINIUM))
    }  # fmt: skip


def scene_of(kind: str, bodies: dict[str, ReducedBody]) -> wf.Scene:
    """A steel roller on a rigid plane, on a skewed roller of aluminium, or of steel ("like"), or on a rigid ball, bores
    held."""
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(bodies["steel"], name="lower")
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    if kind in ("rollers", "like"):
        turn = (0.0, 0.0, np.sin(0.5 * SKEW), np.cos(0.5 * SKEW))
        material = "steel" if kind == "like" else "aluminium"
        upper = scene.add_body(
            bodies[material], name="upper", position=(0, 0, 2 * RADIUS - APPROACH), rotation=turn
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
    scene.add(wf.Contact(lower["rim"], partner, friction=MU, grid="contact_fixed", cells=(COLUMNS, ROWS), name="pair"))
    return scene


@dataclass
class Held:
    """A pair at rest, and what its kernels make of numbers put on its cells."""

    kind: str
    engine: Engine
    bodies: dict[str, ReducedBody]
    columns: int = COLUMNS
    rows: int = ROWS

    @property
    def count(self) -> int:
        return self.columns * self.rows

    def read(self, name: str, parts: int = 1) -> np.ndarray:
        """Numbers of cells (parts, n), of arrays with two directions `parts` 2."""
        x, s = self.engine.scratch, self.engine.state
        values = (getattr(x, name) if hasattr(x, name) else getattr(s, name)).numpy().ravel()
        return (
            values[: parts * self.count]
            .reshape(self.columns, parts, self.rows)
            .transpose(1, 0, 2)
            .reshape(parts, -1)
            .copy()
        )

    def put(self, pressure: np.ndarray, traction: np.ndarray) -> None:
        """p (n,) and tau (2, n) [Pa] on the cells; tractions within mu p."""
        s = self.engine.state
        ordered = traction.reshape(2, self.columns, self.rows).transpose(1, 0, 2).ravel()
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
        column, middle, half_width = self.engine.scratch.patch_place.numpy()[0, 0, :3]
        plan = PatchPlan.of(self.engine.scene.contacts[0])
        scale = half_width if plan.follows else 1.0
        rows = scale * plan.z + (middle if plan.follows else 0.0)
        strip = 2.0 * half_width / self.columns
        x = np.repeat(strip * (np.arange(self.columns) - 0.5 * (self.columns - 1)), self.rows)
        cells = Cells(x, np.tile(rows, self.columns), strip, np.tile(scale * plan.length, self.columns))
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
    moved = strips * cells.width / (RADIUS * held.bodies["steel"].contact_surfaces["rim"].grid.pitch)
    old[[0, *range(4, len(old))]] -= moved  # the patch and its rows
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
    state.ring_place.assign(old[None, None])
    held.engine.graph.program.run(("slide",))
    kept(held)
    grown = held.read("weak_grown")[0] / held.read("cell_area")[0]
    way = -strips * cells.width, -(place[1] - old[1])
    expected = held.read("rigid_slip", 2) + held.read("elastic", 2) - field(cells.x, cells.z)
    expected += np.outer(way, grown)
    assert np.abs(held.read("slip", 2) - expected).max() < READ * np.abs(ring).max()


# --- energy


def bump(x: np.ndarray, z: np.ndarray, width: float) -> np.ndarray:
    """A smooth pattern (2, n), not zero within `width` of x = 0 and over the inner half of the rows."""
    around = np.where(np.abs(x) < width, np.cos(0.5 * np.pi * x / width) ** 2, 0.0)
    along = np.where(np.abs(z) < 0.25 * WIDTH, np.cos(2.0 * np.pi * z / WIDTH) ** 2, 0.0)
    return np.array([around * along, 0.5 * around * along])


@pytest.mark.parametrize("advance", [0.1, 0.37, 1.0, -1.7])
def test_a_locked_in_traction_keeps_its_energy(bodies, advance: float) -> None:
    """A traction that its material carries through the patch, over five strips: the slips that are read with the
    history do next to no work compared with the energy that passes."""
    scene = scene_of("like", bodies)
    scene.contacts[0].cells = (STRIPS_MANY, 7)
    engine = Engine(scene)
    engine.static_step(1.0)
    held = Held("like", engine, bodies, STRIPS_MANY, 7)
    cells, _, _ = held.places()
    area, pitch = cells.area, RADIUS * bodies["steel"].contact_surfaces["rim"].grid.pitch
    work, straight, energy, before = [], [], [], np.zeros((2, held.count))
    columns = np.arange(STRIPS_MANY)

    def read_straight(values: np.ndarray) -> np.ndarray:
        return np.interp(columns + advance, columns, values)

    for n in range(round(5.0 / abs(advance)) + 1):
        at = np.sign(advance) * (2.5 - abs(advance) * n) * cells.width
        traction = 1e8 * bump(cells.x - at, cells.z, 5.0 * cells.width)
        elastic = held.displaced(np.full(held.count, 1e9), traction)[1]
        slip = held.read("slip", 2) - held.read("rigid_slip", 2)
        if n:
            work.append(float(np.sum(area * traction * slip)))
            read = np.apply_along_axis(read_straight, 1, before.reshape(2, STRIPS_MANY, -1)).reshape(2, -1)
            straight.append(float(np.sum(area * traction * (elastic - read))))
        before = elastic
        energy.append(0.5 * float(np.sum(area * traction * elastic)))
        kept(held)
        place = engine.state.ring_place.numpy()
        place[0, 0, [0, *range(4, place.shape[2])]] -= advance * cells.width / pitch  # the patch and its rows
        engine.state.ring_place.assign(place)
    assert abs(np.sum(work)) < LOST * max(energy)
    if abs(advance) < 1.0:  # the control, of many steps: read in straight lines
        assert abs(np.sum(straight)) > 3.0 * LOST * max(energy)


def moved(bodies: dict[str, ReducedBody], angle: float, turning: float) -> tuple[Any, np.ndarray]:
    """A roller that is pressed on a rigid plane, moved along it at 0.2 m/s and rotated at `turning` [rad/s]: the
    contact, and the velocity (2,) at which it slides in the end."""
    speed, long, step = 0.2, 1e-3, 5e-5  # the speeds come slowly compared with the bodies' vibrations
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(bodies["steel"], name="lower")
    carriage = scene.add_rigid_body(1.0, (1e-2,) * 3, name="carriage")
    way = np.array([np.cos(angle), np.sin(angle), 0.0])
    slide = scene.add(wf.joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=way))
    axle = scene.add(wf.joints.Revolute(carriage.at((0, 0, 0)), lower["bore"], axis=(0, 1, 0)))
    for joint, final in ((slide, speed), (axle, turning)):
        scene.add(wf.joints.Drive(joint, wf.signals.SmoothStep(0.0, final, duration=long), quantity="velocity"))
    shape = wf.surfaces.Plane(origin=(0, 0, RADIUS - APPROACH), outward=(0, 0, -1), direction=(0, 1, 0))
    floor = scene.ground.surface(shape, name="floor")
    scene.add(wf.Contact(lower["rim"], floor, friction=MU, grid="contact_fixed", cells=(7, 7), name="pair"))
    history = run(scene, 60 * step, step=step, start="equilibrium", progress=False)
    assert history.status == "completed"
    assert np.diff(history.energy["friction"]).max() <= 0.0
    return history.contacts["pair"], speed * way[:2] + [turning * RADIUS, 0.0]


@pytest.mark.parametrize(("angle", "turning"), [(0.0, 0.0), (0.5 * np.pi, 0.0), (-2.0, 0.0), (0.6, 10.0)])
def test_what_slides_is_held_back_by_all_of_the_friction(bodies, angle: float, turning: float) -> None:
    """mu N against the sliding: around, along, obliquely, and while the roller rolls as well."""
    contact, velocity = moved(bodies, angle, turning)
    force = contact.force[-1]
    assert set(np.unique(contact.friction.state[-1])) == {0, 2}  # open, slips
    assert np.hypot(force[0], force[1]) == pytest.approx(MU * abs(force[2]), rel=FORCE)
    off = np.angle(-(force[0] + 1j * force[1]) / (velocity[0] + 1j * velocity[1]), deg=True)
    assert abs(off) < DIRECTION


def driven(bodies: dict[str, ReducedBody], creepage: float, friction: Any, strips: int) -> wf.Scene:
    """Two steel rollers that are rotated against each other, bores held; SPEED on the lower one."""
    scene = wf.Scene(gravity=(0, 0, 0))
    speeds = {"lower": SPEED, "upper": -SPEED * (1.0 + creepage)}
    for name, speed in speeds.items():
        at = (0, 0, 2 * RADIUS - APPROACH if name == "upper" else 0.0)
        body = scene.add_body(
            bodies["steel"], name=name, position=at, angular_velocity=(0, speed, 0), inertia="constant"
        )  # fmt: skip
        axle = scene.add(wf.joints.Revolute(scene.ground, body["bore"], axis=(0, 1, 0)))
        scene.add(wf.joints.Drive(axle, wf.signals.Table([0, 100], [speed, speed]), quantity="velocity"))
    lower, upper = scene.bodies
    scene.add(
        wf.Contact(lower["rim"], upper["rim"], friction=friction, grid="contact_fixed", cells=(strips, 7), name="pair")
    )
    return scene


@pytest.mark.parametrize("law", [MU, wf.laws.Stribeck(0.3, 0.2, 5e-3)], ids=["Coulomb", "Stribeck"])
def test_a_run_is_continued_bit_for_bit(bodies, law: Any) -> None:
    """With compliances and factors that serve for many steps."""
    scene, step = driven(bodies, 2e-3, law, COLUMNS), 0.7 * 1.1e-3 / COLUMNS / (SPEED * RADIUS)
    whole = run(scene, 40 * step, step=step, start="equilibrium", progress=False)
    part = run(scene, 13 * step, step=step, start="equilibrium", progress=False)
    found = run(scene, 27 * step, step=step, start=part, progress=False).checkpoint
    assert {n for n in found if n.startswith(KEPT_MARK)} >= {f"{KEPT_MARK}cell_G", f"{KEPT_MARK}cell_U"}
    assert [name for name, array in whole.checkpoint.items() if array.tobytes() != found[name].tobytes()] == []


def test_rolling_without_slip_gives_its_energy_to_friction(bodies) -> None:
    """A creepage that moves no cell by slip, with a coefficient that none comes near: what it takes from the bodies is
    lost by the material that leaves the patch, and is booked as friction, not as made by the cells."""
    advance, strips = 0.3, 21
    scene, step = driven(bodies, 3e-4, 5.0, strips), advance * 1.1e-3 / strips / (SPEED * RADIUS)
    history = run(scene, 400 * step, step=step, start="equilibrium", progress=False)
    assert history.status == "completed"
    friction = history.contacts["pair"].friction
    assert friction is not None and set(np.unique(friction.state[-1])) == {0, 1}  # open, sticks
    taken = -np.sum(history.contacts["pair"].force[1:, 0] * friction.creep_velocity[1:, 0]) * step
    booked = {name: history.energy[name] - history.energy[name][0] for name in ("friction", "contact_grid", "contact")}
    assert np.diff(history.energy["friction"]).max() <= 0.0
    assert -booked["friction"][-1] > 0.5 * taken
    assert np.abs(booked["contact_grid"]).max() < LOST * taken
    assert history.iterations[-200:].mean() < ONCE


def rolled(bodies: dict[str, ReducedBody], approaches: tuple[float, ...]) -> Any:
    """Rollers that roll along a rigid plane, each pressed on by its approach: up to 0.75 mm a step."""
    step, speed = 3e-4, 2.5
    scene = wf.Scene(gravity=(0, 0, 0))
    for i, approach in enumerate(approaches):
        at = (0.0, 0.1 * i, 0.0)
        roller = scene.add_body(bodies["steel"], name=f"roller {i}", position=at)
        carriage = scene.add_rigid_body(1.0, (1e-2,) * 3, name=f"carriage {i}", position=at)
        slide = scene.add(wf.joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=(1, 0, 0)))
        axle = scene.add(wf.joints.Revolute(carriage.at((0, 0, 0)), roller["bore"], axis=(0, 1, 0)))
        for joint, final in ((slide, speed), (axle, -speed / RADIUS)):
            signal = wf.signals.SmoothStep(0.0, final, duration=5.0 * step)
            scene.add(wf.joints.Drive(joint, signal, quantity="velocity"))
        shape = wf.surfaces.Plane(origin=(0, 0, RADIUS - approach), outward=(0, 0, -1), direction=(0, 1, 0))
        floor = scene.ground.surface(shape, name=f"floor {i}")
        scene.add(wf.Contact(roller["rim"], floor, friction=MU, grid="contact_fixed", cells=(7, 5), name=f"pair {i}"))
    return run(scene, 10 * step, step=step, start="equilibrium", progress=False)


def test_a_patch_is_passed_where_another_pair_carries(bodies) -> None:
    """A step of 0.75 mm passes the patch of a roller under 1 % of the load of another: that halves none."""
    both = rolled(bodies, (APPROACH, 0.01 * APPROACH))
    forces = [np.linalg.norm(both.contacts[f"pair {i}"].force[-1]) for i in range(2)]
    assert both.status == "completed" and 0.0 < forces[1] < 0.02 * forces[0]
    assert not any("passed" in note for note in both.notes)  # but for the impact of the start, which is energy's
    alone = rolled(bodies, (0.01 * APPROACH,))
    assert any("passed" in note for note in alone.notes)
