r"""A piston's skirt in its liner: secondary motion on two oil films, both walls elastic.

The engine is that of `connecting_rod`: its crank turns at constant speed, its gas burns behind theta = 360 degrees. The
piston is reduced from a mesh of its crown, its skirt and the bosses of the pin; the liner is a tube held by bands
at both ends. Pins are joints. Across the bore nothing holds the piston but the films between the two arcs of its skirt
and the bore, in which it moves to and fro and tilts about its pin. The films stand on the skirt, go with it and are
flooded at their ends; the bore's grid is as long as the way of the skirt. The run begins where the gas is exchanged,
about as a cycle before would leave the piston, and lasts two and a half turns, of which the last two count.

**Side force.** A rod of mass m and inertia I, its centre at g from the crank pin, leans by phi, r sin(theta) + l
sin(phi) = 0. With u along it, the acceleration a_G of its centre, x'' of the piston of mass m_p and the gas force A p,
the rod pushes the piston, and the piston the films, to the side by W_z,

    W_x = -A p - m_p x'',     u x W = (I phi'' + g m u x a_G)/l,

the mechanism without clearance, where W pushes the small end. Without inertia of the rod W_z = W_x tan(phi). Films
carry the same, but for the piston's mass across the bore and what their drag along it adds to W_x.

**Slap.** W_z turns round behind theta = 360 degrees, just where the gas burns. The piston crosses from the side that
it was compressed on to the thrust side, z < 0, and squeezes the oil there; what it squeezes takes some degrees.

**Elasticity.** At the peak the skirt gives by about the clearance, which keeps its film thick and its pressure low: a
skirt ten times as stiff, in a rigid bore, has six times the peak pressure and a quarter of the film. The liner gives
under it like a tube, most in the middle of the arc, and film is left where a rigid bore has less. What it gives is what
is left of the gap without the piston's place and what the skirt gives; it is held against the full finite-element model
of the liner, at rest under the pressures of both films. The pin goes further by about its mean under the pressure.

**Friction.** Oil sheared over the gap h takes mu U^2/h, and pressures that drive it along add what they do not take
over the whole film but at one wall: a small part, since they rise and fall. In voids there is less oil to shear.

**Energy.** What gas and crank put in over the cycle, the films take, by shear and by flow. These are small figures
beside the work to and fro, so that errors of a step show in what the ledger leaves open.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from demos.connecting_rod import (
    COUNTED,
    CRANK,
    ROD,
    SPEED,
    TURNS,
    Mechanism,
    crank_degrees,
    gas_force,
    within,
)
from demos.connecting_rod import PISTON_RADIUS as BORE
from warpffrf.model.mesh.shapes.disc import assembled, refined
from warpffrf.offline.fe import assemble, assign
from warpffrf.output.plots import films as film_plots
from warpffrf.output.plots.panels import Panel

log = logging.getLogger("warpffrf")

ALLOY = wf.Material(youngs_modulus=75e9, poisson_ratio=0.33, density=2700, name="aluminium")
STIFF = wf.Material(youngs_modulus=750e9, poisson_ratio=0.33, density=2700, name="ten times as stiff")
IRON = wf.Material(youngs_modulus=120e9, poisson_ratio=0.26, density=7200, name="cast iron")
SKIRT, WALLS, BOSSES = (-0.022, 0.012), (-0.012, 0.022), (-0.012, 0.012)  # m, along the bore, from the pin
BELT, CROWN = (0.012, 0.022), (0.022, 0.030)  # m: the rings' belt (without its grooves)
ROWS = (-0.022, -0.017, -0.012, -0.006, 0.0, 0.006, 0.012, 0.017, 0.022, 0.026, 0.030)  # m: rows of cells end there
CORE, BULGE, WALL = 0.025, 0.225, 0.004  # m: the bulging square within; of the skirt
ACROSS, BESIDE = 8, 1  # cells in a quarter of the turn; of the skirt beyond it
CLEARANCE, BARREL = 40e-6, 60e-6  # m: of the radius; missing at the skirt's ends
OVAL = 60e-6  # m: half of what is missing where the pin's axis meets the circle of the skirt
SPACING = 4.2e-3  # m, of each film's grid, 17 x 9 hats
LINER, LINER_WALL, LINER_CELLS = (0.068, 0.212), 0.006, (24, 12)  # m from the crank's axis; around and along
OIL, AMBIENT = wf.oils.iso_vg(68, temperature=100), 1e5  # Pa
ROUGH, FRICTION = wf.laws.ExponentialAsperities(pressure_at_zero=40e6, decay_length=0.5e-6), 0.1
ROD_MASS, ROD_CENTRE, ROD_INERTIA = 0.6, 0.045, (1e-4, 1.8e-3, 1.8e-3)  # kg, m from the crank pin, kg m2
CRANK_MASS, CRANK_INERTIA = 5.0, (0.01, 0.01, 0.01)  # kg, kg m2: balanced, its centre on its axis
BEGIN = (-22e-6, -0.6e-3)  # m, rad: place across the bore and tilt at the start
RHO_INF = 0.5  # as in `connecting_rod`
THRUST, ANTI = "thrust", "anti-thrust"
FIRING = (340.0, 420.0)  # deg
SIDE, SIDE_MEAN = 0.02, 0.01  # of the peak force: the peak, root of the mean square
TURNS_ROUND, REPEATS = 15.0, 0.01  # deg; of the way of the pin across the bore
GIVES, FOLLOWS = 0.03, 0.3  # of what the liner gives
SHEAR = 0.1  # of the friction power
STEP = 0.02  # of smallest film and peak pressure, by half a step
WORK, BALANCE = 2e-3, 0.03  # of the gas; of the losses


@dataclass(frozen=True)
class Size:
    """Degrees of a step; frames of the recording; what of the losses the energy balance may miss, as the step
    squared."""

    degrees: float = 1.0
    frames: int = 225
    balance: float = BALANCE


FULL, QUICK = Size(), Size(degrees=2.0, frames=60, balance=4.0 * BALANCE)


# --- piston and liner


def piston_mesh() -> wf.mesh.Mesh:
    """Crown, belt of the rings, two arcs of a skirt and the walls between them with the bosses of the pin, of quadratic
    hexahedra: axis of the bore along x, that of the pin along y, both through the origin. Facet sets `thrust` (z < 0)
    and `anti-thrust` (z > 0) on the skirt, `crown`, and `pin`, the inner faces of the bosses."""
    outer = BORE - CLEARANCE - OVAL
    part = np.linspace(-1.0, 1.0, 2 * ACROSS + 1)
    core = CORE * np.stack(_bulging(*np.meshgrid(part, part, indexing="ij")), axis=-1)
    around = np.array([np.sin(0.25 * np.pi * part), np.cos(0.25 * np.pi * part)]).T
    inside = _between(core[:, -1], (outer - WALL) * around, 2)
    ring = _between((outer - WALL) * around, outer * around, 1)
    lattices, sets = [], {"thrust": [], "anti-thrust": [], "crown": [], "pin": []}

    def add(section: np.ndarray, rows: tuple[float, float], face: str = "", *, axis: int = 0, end: int = 0) -> None:
        if face:
            sets[face].append((len(lattices), axis, end))
        lattices.append(_standing(section, rows))

    add(core, CROWN, "crown", axis=2, end=1)
    for quarter in range(4):  # of the turn, from z over y
        turn = np.array([[0.0, -1.0], [1.0, 0.0]])
        turn = np.linalg.matrix_power(turn, quarter)
        blend, shell = inside @ turn, ring @ turn
        add(blend, CROWN, "crown", axis=2, end=1)
        add(shell, CROWN, "crown", axis=2, end=1)
        add(shell, BELT)
        if quarter % 2 == 0:
            add(shell, SKIRT, _side(shell), end=1)
            continue
        for cells in (slice(None, 2 * BESIDE + 1), slice(-2 * BESIDE - 1, None)):
            add(shell[:, cells], SKIRT, _side(shell[:, cells]), end=1)
        add(blend[2:], WALLS)
        add(blend[:3, ACROSS // 2 : -(ACROSS // 2)], BOSSES, "pin", end=0)
    return assembled(lattices, 2, sets, "piston")


def _bulging(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A square with bulging sides, -1 <= u, v <= 1, the middles of its sides at 1."""
    return u * np.sqrt(1.0 - BULGE * v**2), v * np.sqrt(1.0 - BULGE * u**2)


def _between(low: np.ndarray, high: np.ndarray, cells: int) -> np.ndarray:
    """The lattice (2 cells + 1, n, 2) between two lines (n, 2)."""
    part = np.linspace(0.0, 1.0, 2 * cells + 1)[:, None, None]
    return (1.0 - part) * low + part * high


def _standing(section: np.ndarray, ends: tuple[float, float]) -> np.ndarray:
    """The lattice (a, b, c, 3) over places (a, b, 2) y, z of a cross section, on the rows between two x [m]."""
    rows = refined(np.array([x for x in ROWS if ends[0] <= x <= ends[1]]), 2)
    lattice = np.empty((*section.shape[:2], len(rows), 3))
    lattice[..., 1:], lattice[..., 0] = section[:, :, None, :], rows
    return lattice


def _side(shell: np.ndarray) -> str:
    return "thrust" if shell[..., 1].mean() < 0.0 else "anti-thrust"


def piston_body(material: wf.Material = ALLOY, *, progress: bool = True) -> wf.ReducedBody:
    """The reduced piston: contact surfaces `thrust` and `anti-thrust`, interfaces `pin` (rigid) and `crown` (its mean
    motion)."""
    skirt = wf.surfaces.Cylinder(radius=BORE - CLEARANCE - OVAL, axis_point=(0, 0, 0), axis_direction=(1, 0, 0))
    return wf.reduce(
        piston_mesh(), material, interfaces={"pin": "rigid", "crown": "average"},
        contact={THRUST: skirt, ANTI: skirt}, traction_spacing=SPACING, modes=20, contact_fixed=False, cache=False,
        progress=progress,
    )  # fmt: skip


def liner_mesh() -> wf.mesh.Mesh:
    """A tube with axis y about the origin; facet sets `bore` and `seats`, a row of cells at each end of its outside."""
    around, along = LINER_CELLS
    mesh = wf.mesh.sleeve(BORE, BORE + LINER_WALL, LINER[1] - LINER[0], sectors=around, axial=along, layers=1, order=2)
    outside = mesh.facets("outside")
    off = np.abs(outside.centers(mesh.points)[:, 1])
    seats = outside.kept(off > off.max() - 1e-6)
    return replace(mesh, facet_sets={**mesh.facet_sets, "seats": seats}, name="liner")


def liner_body(*, progress: bool = True) -> wf.ReducedBody:
    """The reduced liner: contact surface `bore`, rigid interface `seats`."""
    return wf.reduce(
        liner_mesh(), IRON, interfaces={"seats": "rigid"}, contact={"bore": wf.surfaces.Bore()}, modes=20,
        contact_fixed=False, cache=False, progress=progress,
    )  # fmt: skip


# --- the engine


def side_force(theta: np.ndarray, mass: float) -> np.ndarray:
    """z component [N] of what the liner does to a piston of `mass` [kg] in the rigid mechanism at crank angles (T,)
    [rad]: W_z of the module."""
    at = Mechanism.at(theta)
    u, across = at.along, np.stack([-at.along[:, 1], at.along[:, 0]], axis=1)
    a_G = at.pin_acceleration + ROD_CENTRE * (at.turning[:, None] * across - at.rate[:, None] ** 2 * u)
    W_x = -gas_force(theta) - mass * at.piston_acceleration
    turned = ROD_INERTIA[1] * at.turning + ROD_CENTRE * ROD_MASS * (u[:, 0] * a_G[:, 1] - u[:, 1] * a_G[:, 0])
    return (turned / ROD + u[:, 1] * W_x) / u[:, 0]


def skirt_form() -> wf.films.Form:
    """Barrel and oval of the skirt: nothing is missing in its middle across the pin."""
    return wf.films.BarrelForm(BARREL, SKIRT[1] - SKIRT[0], 0.5 * sum(SKIRT)) + wf.films.LobedForm(OVAL, 2)


def build(*, progress: bool = True) -> wf.Scene:
    """The scene with both walls elastic."""
    return machine(piston_body(progress=progress), liner_body(progress=progress))


def machine(piston_is: wf.ReducedBody, liner_is: wf.ReducedBody | None) -> wf.Scene:
    """The scene around bodies that are reduced already; without a liner its bore is rigid. Bodies `crank`, `rod`,
    `piston`, `liner`, joints `axle`, `big end`, `wrist`, `plane`, `block`, films `thrust`, `anti-thrust`."""
    scene, (off, tilt) = wf.Scene(), BEGIN
    lean = off / ROD  # the pin is off the axis of the bore, and the rod goes there
    rate = CRANK * SPEED / (ROD * np.cos(np.arcsin(lean)))
    crank = scene.add_rigid_body(CRANK_MASS, CRANK_INERTIA, name="crank", angular_velocity=(0, -SPEED, 0))
    rod = scene.add_rigid_body(
        ROD_MASS, ROD_INERTIA, name="rod", center_of_mass=(ROD_CENTRE, 0, 0), position=(CRANK, 0, 0),
        rotation=_about_y(-np.arcsin(lean)), velocity=(0, 0, CRANK * SPEED), angular_velocity=(0, rate, 0),
    )  # fmt: skip
    piston = scene.add_body(
        piston_is, name="piston", position=(CRANK + ROD * np.cos(np.arcsin(lean)), 0, off), rotation=_about_y(tilt),
        velocity=(rate * off, 0, 0),
    )  # fmt: skip
    axle = scene.add(wf.joints.Revolute(scene.ground, crank.at((0, 0, 0)), axis=(0, -1, 0), name="axle"))
    scene.add(wf.joints.Drive(axle, wf.signals.Constant(SPEED), quantity="velocity"))
    scene.add(wf.joints.Revolute(crank.at((CRANK, 0, 0)), rod.at((0, 0, 0)), axis=(0, -1, 0), name="big end"))
    scene.add(wf.joints.PointOnLine(rod.at((ROD, 0, 0)), piston["pin"], axis=(0, -1, 0), name="wrist"))
    scene.add(wf.joints.Planar(scene.ground.at((CRANK + ROD, 0, 0)), piston["pin"], axis=(0, -1, 0), name="plane"))
    theta = np.radians(np.arange(0.0, 360.0 * TURNS + 2.0))
    gas = wf.signals.Table(theta / SPEED, -gas_force(theta), cubic=True)
    scene.add(wf.forces.PointForce(piston["crown"], (gas, (1, 0, 0)), name="gas"))
    middle, half = (0.5 * sum(LINER), 0, 0), np.sqrt(0.5)
    if liner_is is None:
        shape = wf.surfaces.Bore(radius=BORE, axis_point=middle, axis_direction=(1, 0, 0))
        bore: Any = scene.ground.surface(shape, name="bore")
    else:
        liner = scene.add_body(liner_is, name="liner", position=middle, rotation=(0, 0, -half, half))  # y along x
        scene.add(wf.joints.Fixed(scene.ground, liner["seats"], axis=(1, 0, 0), name="block"))
        bore = liner["bore"]
    for name in (THRUST, ANTI):
        scene.add(wf.Film(
            piston[name], bore, oil=OIL, ambient_pressure=AMBIENT, form_a=skirt_form(), asperities=ROUGH,
                boundary_friction=FRICTION,
            name=name,
        ))  # fmt: skip
    return scene


def _about_y(angle: float) -> tuple[float, float, float, float]:
    return 0.0, float(np.sin(0.5 * angle)), 0.0, float(np.cos(0.5 * angle))


def run(scene: wf.Scene, degrees: float, *, turns: float = TURNS, progress: bool = True) -> wf.Result:
    """From the start, in steps of so many degrees of the crank."""
    step = np.radians(degrees) / SPEED
    duration = round(360.0 * turns / degrees) * step
    return wf.simulate(scene, duration, step=step, integrator=wf.GeneralizedAlpha(RHO_INF), progress=progress)


def place(result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """Of the pin across the bore (T,) [m], towards z, and tilt about it (T,) [rad], about y."""
    piston = result.body("piston")
    return piston.position[:, 2], 2.0 * np.arcsin(piston.rotation[:, 1])


# --- what the walls give


@dataclass(frozen=True)
class Given:
    """What liner and skirt give at the hats of the thrust film (columns, rows) [m], and the liner's full model at rest
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
    """Places (n, 3) and forces (n,) [N] of a film's pressure on the bore, at Gauss points between its hats."""
    shape, film = piston_is.contact_surfaces[name].shape, result.film(name)
    pressure = film.pressure[row] + film.asperity[row]
    x, w = np.polynomial.legendre.leggauss(3)
    part, weight = 0.5 * (x + 1.0), 0.5 * w
    hats = np.stack([1.0 - part, part])  # (2, points)
    corners = np.stack([[pressure[:-1, :-1], pressure[:-1, 1:]], [pressure[1:, :-1], pressure[1:, 1:]]])
    at = np.einsum("abij,ap,bq->ipjq", corners, hats, hats)
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


# --- what is checked


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
    """What both films do across the bore beside the rigid mechanism, and when the piston follows."""
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
    """What the liner gives beside its full model, in the saved step `row`, and what a rigid bore changes."""
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
    """Beside half the step."""
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
    gas = -float(np.trapezoid(gas_force(fine), Mechanism.at(fine).piston))
    put_in, stored = change["force_work"] + change["drive_work"], change["kinetic"] + change["strain"]
    return [
        Check("friction power, mean of a cycle", float(np.mean(rubbed)),
              float(np.mean(shear_power(result, piston_is)[counts])), "mu U^2/h", SHEAR, "W"),
        Check("work of the gas in a cycle", change["force_work"], gas, "rigid mechanism", WORK, "J"),
        Check("work of gas and drive in a cycle", put_in, lost + stored, "losses of the films, stored", balance, "J"),
        Check("the ledger leaves open", change["numerical"], 0.0, "over the losses", balance, "J", scale=lost),
    ]  # fmt: skip


# --- what is drawn


@dataclass(frozen=True)
class Map:
    """The "pressure" or the "gap" on the thrust side of the skirt, unwrapped, in the saved step `row`."""

    result: wf.Result
    row: int
    what: str = "pressure"

    def draw(self, ax: object) -> None:
        """Draw on matplotlib axes."""
        axes: Any = ax
        draw = film_plots.pressure if self.what == "pressure" else film_plots.gap
        draw(self.result.film(THRUST), axes, self.row)
        angle = crank_degrees(self.result)[self.row]
        axes.set_title(f"{self.what.capitalize()} on the thrust side at {angle:.0f} degrees", fontsize=10)


def panels(results: dict[str, wf.Result], mass: float, gives: Given, row: int) -> list:
    """Side force, place and tilt, smallest films, peak pressure and friction over the crank angle; what the walls give
    pressure and gap in the saved step `row`."""
    shown = {"elastic": "both", "rigid bore": "rigid", "stiff skirt, rigid bore": "stiff"}
    both = results["both"]
    curves: dict[str, dict] = {name: {} for name in ("off", "tilt", "thin", "peak", "rubs")}
    for label, name in shown.items():
        result = results[name]
        degrees = crank_degrees(result)
        counts, (off, tilt) = within(degrees), place(result)
        angle, films = degrees[counts], [result.film(side) for side in (THRUST, ANTI)]
        curves["off"][label] = angle, off[counts] * 1e6
        curves["tilt"][label] = angle, tilt[counts] * 1e3
        curves["thin"][label] = angle, np.min([film.smallest_gap[counts] for film in films], axis=0) * 1e6
        curves["peak"][label] = angle, np.max([film.largest_pressure[counts] for film in films], axis=0) / 1e6
        curves["rubs"][label] = angle, np.sum([film.friction_power[counts] for film in films], axis=0)
    degrees = crank_degrees(both)
    counts = within(degrees)
    side = np.sum([both.film(name).force[:, 2] for name in (THRUST, ANTI)], axis=0)
    exact = side_force(np.radians(degrees), mass)
    along, middle = both.film(THRUST).z * 1e3, len(gives.liner) // 2
    walls = {"liner": (along, gives.liner[middle] * 1e6), "skirt": (along, gives.skirt[middle] * 1e6)}
    ends, limit = [*degrees[counts][[0, -1]], np.nan], 1e6 * CLEARANCE
    clearance = {"clearance": (np.array(2 * ends), np.array([limit, limit, np.nan, -limit, -limit, np.nan]))}
    crank = "crank angle [deg]"
    return [
        Panel("Force of both films across the bore", crank, "[kN]", {"run": (degrees[counts], side[counts] * 1e-3)},
              {"rigid mechanism": (degrees[counts], exact[counts] * 1e-3)}),
        Panel("Pin across the bore", crank, "[um]", curves["off"], clearance),
        Panel("Tilt about the pin", crank, "[mrad]", curves["tilt"]),
        Panel("Smallest film of both sides", crank, "[um]", curves["thin"]),
        Panel("Peak pressure of both films", crank, "[MPa]", curves["peak"]),
        Panel("Friction of both films", crank, "[W]", curves["rubs"]),
        Panel(f"What the walls give along the thrust line at {degrees[row]:.0f} degrees", "along the skirt [mm]",
              "[um]", walls, {"liner, full FE model at rest": (along, gives.exact[middle] * 1e6)}),
        Map(both, row),
        Map(both, row, "gap"),
    ]  # fmt: skip


def main(out: str | Path = "out/piston", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write piston.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    Those are of elastic walls; the runs in a rigid bore, with a skirt ten times as stiff there and with half the step
    are in piston.rigid.h5, .stiff.h5 and .halved.h5. quick: steps twice as long. Raises `InputError` for a folder that
    cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    piston_is, liner_is = piston_body(progress=progress), liner_body(progress=progress)
    stiff = piston_body(STIFF, progress=progress)
    log.info(
        "piston: %g turns between elastic walls, in a rigid bore, with a stiff skirt, and in half the steps", TURNS
    )
    scenes = {"both": (piston_is, liner_is), "rigid": (piston_is, None), "stiff": (stiff, None)}
    results = {name: run(machine(*of), size.degrees, progress=progress) for name, of in scenes.items()}
    results["halved"] = run(machine(piston_is, liner_is), 0.5 * size.degrees, progress=progress)
    for name, result in results.items():
        if result.status != "completed":
            log.error("the run '%s' ended early, %s: %s", name, result.status, result.message)
            return 1
    both, mass = results["both"], float(piston_is.mass)
    row = loaded(both)
    gives = given(both, piston_is, row)
    checks = [
        *force_checks(both, mass),
        *liner_checks(both, results["rigid"], gives, row),
        *step_checks(both, results["halved"]),
        *energy_checks(both, piston_is, size.balance),
    ]
    return finish(folder / "piston", results, checks, panels(results, mass, gives, row), frames=size.frames)
