r"""The big end of a connecting rod on its crank pin: an oil film under the load of a four-stroke engine.

A crank turns at constant speed Omega; all that holds the rod to its pin is the oil film between the rod's bore and the
pin. The rod is elastic, reduced from quadratic tetrahedra; its small end is a joint on the piston, on which the gas
presses. Everything moves in the plane x-z, crank angles theta count from the dead centre where the gas is exchanged;
the gas burns behind theta = 360 degrees. The run begins at theta = 0 with the pin in the middle of the bore and lasts
two and a half turns, of which the last two, one cycle, count.

**Force.** The rod of mass m and inertia I, its centre of mass at g from the pin, leans by phi, r sin(theta) + l
sin(phi) = 0. With u along the rod, the acceleration a_G of its centre, x_p'' of the piston and the gas force A p on it,
the piston pushes the small end by W, and the film the big end by F:

    W_x = -A p - m_p x_p'',     u x W = (I phi'' + g m u x a_G)/l,     F = m a_G - W.

This is the mechanism without clearance and elasticity. What the film carries differs from it where the force turns
round and the pin crosses the clearance, before the combustion, and by the vibrations of the rod.

**Film.** `verification.films.elastic` solves film and deformation by itself, by Newton's method with full finite
elements, for a shaft without mass under F: in the frame of the rod, in which the pin turns by Omega - phi'. From the
reduced rod it takes what displaces the hats: the compliance of the free body under the pressures, and the displacement
by W, both with the inertia of the rod's rigid motion against them. (With the small end held instead, and no inertia,
the film is an eighth thicker under the combustion and two thirds as thick while gas is compressed: the eye weighs 400
times as much as at rest.) It begins as the run does.

**Elasticity.** The same rod, ten times as stiff, beside its reference. Under the combustion the steel eye gives by
nearly its clearance, in the middle more than at the ends, where the film is thinnest. Before the gas is exchanged the
rod is pulled: its eye grows long, and its sides close on the pin, 60 degrees beside the load. There is the smallest
film of all, where that of the stiff rod is nearly three times as thick.

**Energy.** What gas and crank put in over the cycle, the film takes, by shear and by flow. Kinetic and strain energy
are what they were a cycle ago. The work of the gas is that of its pressure on the rigid mechanism.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from demos.journal_bearing import Round
from references.films.elastic import ElasticJournal, State
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.output.plots import films as film_plots
from warpffrf.output.plots.panels import Panel

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
STIFF = wf.Material(youngs_modulus=2100e9, poisson_ratio=0.3, density=7850, name="ten times as stiff")
CRANK, ROD = 0.040, 0.140  # m: radius of the crank, between the axes of both eyes
BIG, BIG_OUTER, SMALL, SMALL_OUTER, WIDTH = 0.024, 0.033, 0.011, 0.018, 0.024  # m: radii of the eyes, along their axes
SECTORS, WIDE, LONG = 32, 4, 8  # cells around the big eye (half as many around the small one), along it, along the rod
SPACING = 2.69e-3  # m, of the film's grid, 56 x 9 hats
CLEARANCE, OIL = 25e-6, wf.oils.Barus(0.008, coefficient=1.5e-8)  # m, of the radius; Pa s, 1/Pa
GROOVES = (0.5 * np.pi, -0.5 * np.pi)  # rad from the rod's axis: in the split of a rod with a cap
CRANK_MASS, CRANK_INERTIA = 5.0, (0.01, 0.01, 0.01)  # kg, kg m2: balanced, its centre on its axis
PISTON_MASS, PISTON_INERTIA, PISTON_RADIUS = 0.5, (3e-4, 3e-4, 3e-4), 0.040  # kg, kg m2, m
SPEED = 300.0  # rad/s
TURNS, COUNTED = 2.5, 0.5  # of the run; where the cycle that counts begins
AMBIENT, RATIO, EXPONENT, BURNED = 1e5, 10.5, 1.32, 5.0  # Pa; volumes; p V^n; times the pressure by burning
BURNING, INLET_SHUTS, OUTLET_OPENS = (340.0, 400.0), (180.0, 200.0), (500.0, 560.0)  # deg
FIRING, REFERENCE_STEP = (355.0, 460.0), 2.0  # deg: of the crank; a step of the dense film
RHO_INF = 0.5  # a thin film damps so strongly that with 0.8 its force alternates from step to step after the start
FILM = "rod-crank"
FORCE, FORCE_MEAN = 0.02, 0.003  # of the peak force: largest difference, root of the mean square
REFERENCE = 0.015  # of smallest film and peak pressure
STEP = 0.01  # of the same, by half a step
WORK = 2e-3  # of the gas, on the rigid mechanism
BALANCE = 0.01  # of the losses


@dataclass(frozen=True)
class Size:
    """Degrees of a step; frames of the recording; what of the losses the energy balance may miss, as the step
    squared."""

    degrees: float = 1.0
    frames: int = 225
    balance: float = BALANCE


FULL, QUICK = Size(), Size(degrees=2.0, frames=60, balance=4.0 * BALANCE)


# --- the rod


def rod_mesh() -> wf.mesh.Mesh:
    """Both eyes and a shank of half their width between them; axes of the bores along y, that of the big end through
    the origin, the small end at x > 0. Facet sets `bore` and `eye`."""
    around, y = np.pi / SECTORS, np.linspace(-0.5, 0.5, 2 * WIDE + 1) * WIDTH  # nodes, in the middle of cells too
    part = np.arange(2 * SECTORS + 1)
    big = _ring(BIG, BIG_OUTER, around * part, 0.0, y)
    small = _ring(SMALL, SMALL_OUTER, -2.0 * around * part[: SECTORS + 1], ROD, y)
    across, along = around * np.arange(-4, 5), np.linspace(0.0, 1.0, 2 * LONG + 1)[:, None, None]
    begin = BIG_OUTER * np.stack([np.cos(across), np.sin(across)], axis=1)
    end = SMALL_OUTER * np.stack([-np.cos(2.0 * across), np.sin(2.0 * across)], axis=1) + (ROD, 0.0)
    shank = _standing((1.0 - along) * begin + along * end, y[WIDE // 2 : -(WIDE // 2)])
    mesh, axis = tetrahedra([big, small, shank], "rod"), (0, 1, 0)
    mesh = mesh.select_cylinder("bore", axis_point=(0, 0, 0), axis_direction=axis, radius=BIG)
    return mesh.select_cylinder("eye", axis_point=(ROD, 0, 0), axis_direction=axis, radius=SMALL)


def _ring(inner: float, outer: float, theta: np.ndarray, x: float, y: np.ndarray) -> np.ndarray:
    """Lattice of a ring of two layers."""
    radius = np.linspace(inner, outer, 5)[:, None]
    return _standing(np.stack([x + radius * np.cos(theta), radius * np.sin(theta)], axis=-1), y)


def _standing(section: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The lattice (a, b, c, 3) over places (a, b, 2) x, z of a cross section, at y (c,)."""
    lattice = np.empty((*section.shape[:2], len(y), 3))
    lattice[..., [0, 2]], lattice[..., 1] = section[:, :, None, :], y
    return lattice


def tetrahedra(lattices: Sequence[np.ndarray], name: str) -> wf.mesh.Mesh:
    """Quadratic tetrahedra on `lattices` (a, b, c, 3) [m] of nodes, odd numbers of them: six to each cube of 3 x 3 x 3.

    They share the cube's diagonal from its first to its last corner, one to every order in which the axes are walked
    on the way there. So each face is cut from its first to its last corner, and lattices fit together that count along
    a common face in the same direction, or both backwards. Nodes in equal places are one.
    """
    from scipy.spatial import KDTree

    kind, cells, start = cell_kind("tet10"), [], 0
    for lattice in lattices:
        shape = lattice.shape[:3]
        cubes = np.stack(np.meshgrid(*[np.arange(0, n - 1, 2) for n in shape], indexing="ij"), axis=-1).reshape(
            -1, 1, 3
        )
        for way in permutations(range(3)):
            corners = np.vstack([np.zeros(3, dtype=int), np.cumsum(2 * np.eye(3, dtype=int)[list(way)], axis=0)])
            sides = np.diff(lattice[tuple(corners.T)], axis=0)
            if np.linalg.det(sides) < 0.0:
                corners = corners[[0, 2, 1, 3]]
            nodes = np.rint(kind.nodes @ (corners[1:] - corners[0])).astype(int)
            cells.append(start + np.ravel_multi_index(tuple(np.moveaxis(cubes + nodes, -1, 0)), shape))
        start += int(np.prod(shape))
    points = np.concatenate([lattice.reshape(-1, 3) for lattice in lattices])
    near = KDTree(points).query_ball_point(points, 1e-9 * float(np.ptp(points, axis=0).max()))
    kept, number = np.unique([min(same) for same in near], return_inverse=True)
    return wf.mesh.Mesh(points[kept], {"tet10": number[np.concatenate(cells)]}, name=name)


def rod_body(material: wf.Material = STEEL, *, progress: bool = True) -> wf.ReducedBody:
    """The reduced rod, contact surface `bore`, rigid interface `eye`. Angles of the film count from the rod's axis, in
    the sense in which the crank turns."""
    bore = wf.surfaces.Bore(radius=BIG, axis_point=(0, 0, 0), axis_direction=(0, -1, 0))
    return wf.reduce(
        rod_mesh(), material, interfaces={"eye": "rigid"}, contact={"bore": bore}, traction_spacing=SPACING, modes=12,
        contact_fixed=False, cache=False, progress=progress,
    )  # fmt: skip


# --- the engine


@dataclass(frozen=True)
class Mechanism:
    """Rigid motion at crank angles (T,) [rad]: pin (T, 2) [m], its acceleration; along (T, 2), lean [rad], rate
    [rad/s] and acceleration of the rod; piston (T,) [m] and its acceleration. Components x, z."""

    pin: np.ndarray
    pin_acceleration: np.ndarray
    along: np.ndarray
    lean: np.ndarray
    rate: np.ndarray
    turning: np.ndarray
    piston: np.ndarray
    piston_acceleration: np.ndarray

    @classmethod
    def at(cls, theta: Any) -> Mechanism:
        """Of r sin(theta) + l sin(phi) = 0, differentiated twice."""
        c, s, k = np.cos(theta), np.sin(theta), CRANK / ROD
        S = -k * s
        C = np.sqrt(1.0 - S**2)
        rate = -k * c * SPEED / C
        turning = (k * s * SPEED**2 + S * rate**2) / C
        pin = CRANK * np.stack([c, s], axis=-1)
        return cls(
            pin, -(SPEED**2) * pin, np.stack([C, S], axis=-1), np.arcsin(S), rate, turning, CRANK * c + ROD * C,
            -(SPEED**2) * CRANK * c - ROD * (S * turning + C * rate**2),
        )  # fmt: skip

    def in_rod(self, vectors: np.ndarray) -> np.ndarray:
        """World components (T, 2) as those along the rod and across it."""
        u = self.along
        return np.stack([np.sum(u * vectors, axis=1), _cross(u, vectors)], axis=1)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def gas_force(theta: Any) -> np.ndarray:
    """A p [N] above the ambient pressure at crank angles [rad], the same after two turns: compressed and expanded gas
    between the valves, its pressure raised by burning."""
    degrees, area = np.mod(np.degrees(theta), 720.0), np.pi * PISTON_RADIUS**2
    swept = 2.0 * CRANK * area
    least = swept / (RATIO - 1.0)
    volume = least + area * (CRANK + ROD - Mechanism.at(theta).piston)
    closed = ((least + swept) / volume) ** EXPONENT * (1.0 + (BURNED - 1.0) * _rise(degrees, *BURNING))
    shut = _rise(degrees, *INLET_SHUTS) * (1.0 - _rise(degrees, *OUTLET_OPENS))
    return area * AMBIENT * (closed - 1.0) * shut


def _rise(x: np.ndarray, begin: float, end: float) -> np.ndarray:
    """From 0 to 1, twice differentiable."""
    s = np.clip((x - begin) / (end - begin), 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


@dataclass(frozen=True)
class Forces:
    """Of the module on a rigid rod, (T, 2) [N], x and z: by the film on the big end and by the piston on the small
    one."""

    film: np.ndarray
    piston: np.ndarray

    @classmethod
    def at(cls, reduced: wf.ReducedBody, theta: np.ndarray) -> Forces:
        """At crank angles (T,) [rad]."""
        m, g, inertia = reduced.mass, float(reduced.center_of_mass[0]), float(reduced.inertia[1, 1])
        at = Mechanism.at(theta)
        u, across = at.along, np.stack([-at.along[:, 1], at.along[:, 0]], axis=1)
        a_G = at.pin_acceleration + g * (at.turning[:, None] * across - at.rate[:, None] ** 2 * u)
        W_x = -gas_force(theta) - PISTON_MASS * at.piston_acceleration
        moment = (inertia * at.turning + g * m * _cross(u, a_G)) / ROD
        W = np.stack([W_x, (moment + u[:, 1] * W_x) / u[:, 0]], axis=1)
        return cls(m * a_G - W, W)


def build(*, progress: bool = True) -> wf.Scene:
    """The scene with the steel rod."""
    return machine(rod_body(progress=progress))


def machine(reduced: wf.ReducedBody) -> wf.Scene:
    """The scene around a rod that is reduced already: bodies `crank`, `rod`, `piston`, joints `axle`, `wrist`, `liner`,
    film `rod-crank`."""
    scene, begin = wf.Scene(), Mechanism.at(0.0)
    pin = wf.surfaces.Cylinder(radius=BIG - CLEARANCE, axis_point=(CRANK, 0, 0), axis_direction=(0, -1, 0))
    crank = scene.add_rigid_body(
        CRANK_MASS, CRANK_INERTIA, name="crank", angular_velocity=(0, -SPEED, 0), surfaces={"pin": pin}
    )
    rod = scene.add_body(
        reduced, name="rod", position=(CRANK, 0, 0), velocity=(0, 0, CRANK * SPEED),
        angular_velocity=(0, -float(begin.rate), 0),
    )  # fmt: skip
    piston = scene.add_rigid_body(PISTON_MASS, PISTON_INERTIA, name="piston", position=(CRANK + ROD, 0, 0))
    axle = scene.add(wf.joints.Revolute(scene.ground, crank.at((0, 0, 0)), axis=(0, -1, 0), name="axle"))
    scene.add(wf.joints.Revolute(rod["eye"], piston.at((0, 0, 0)), axis=(0, -1, 0), name="wrist"))
    scene.add(wf.joints.Prismatic(scene.ground, piston.at((0, 0, 0)), axis=(1, 0, 0), name="liner"))
    scene.add(wf.joints.Drive(axle, wf.signals.Constant(SPEED), quantity="velocity"))
    theta = np.radians(np.arange(0.0, 360.0 * TURNS + 2.0))
    gas = wf.signals.Table(theta / SPEED, -gas_force(theta), cubic=True)
    scene.add(wf.forces.PointForce(piston.at((0, 0, 0)), (gas, (1, 0, 0)), name="gas"))
    grooves = [wf.films.AxialGroove(at, 1e-3, 0.0) for at in GROOVES]  # narrower than a column
    scene.add(wf.Film(rod["bore"], crank["pin"], oil=OIL, feeds=grooves, name=FILM))
    return scene


def run(reduced: wf.ReducedBody, degrees: float, *, turns: float = TURNS, progress: bool = True) -> wf.Result:
    """From the start, in steps of so many degrees of the crank."""
    step = np.radians(degrees) / SPEED
    duration = round(360.0 * turns / degrees) * step
    integrator = wf.GeneralizedAlpha(RHO_INF)
    return wf.simulate(machine(reduced), duration, step=step, integrator=integrator, progress=progress)


# --- the film by itself


@dataclass(frozen=True)
class Kept(State):
    """The state of an earlier step, with what widened the gap at the hats then beside the pressures."""

    widened: np.ndarray = field(default_factory=lambda: np.zeros(0))


@dataclass
class LoadedBore(ElasticJournal):
    """A bore that is also displaced by other loads: by `widened` (hats,) [m] in the step that is being solved."""

    widened: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.widened = np.zeros(self.grid.count)

    def gap(self, state: State) -> np.ndarray:
        return super().gap(state) + self.basis.between @ self._widened(state)

    def gap_at_hats(self, state: State) -> np.ndarray:
        return super().gap_at_hats(state) + self._widened(state)

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
    at the hats."""

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
    pressure = np.array([(film.basis.to_hats @ s.pressure).reshape(grid.columns, grid.rows) for s in states])
    return Dense(degrees, np.array([film.gap(s).min() for s in states]), pressure.max(axis=(1, 2)), pressure)


# --- what is checked


def crank_degrees(result: wf.Result) -> np.ndarray:
    """(T,) deg."""
    return np.degrees(SPEED * result.time)


def within(degrees: np.ndarray, begin: float = 360.0 * COUNTED, end: float = 360.0 * TURNS) -> np.ndarray:
    """Which angles (T,) [deg] are in a window, its ends included; in the cycle that counts if nothing else is said."""
    return (degrees > begin - 1e-6) & (degrees < end + 1e-6)


def force_checks(result: wf.Result, reduced: wf.ReducedBody) -> list[Check]:
    """The force of the film over a cycle beside that of the rigid mechanism."""
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
    """Smallest film of the cycle and under the combustion, and peak pressure, beside the reference."""
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
    """Beside half the step."""
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
    gas = -float(np.trapezoid(gas_force(fine), Mechanism.at(fine).piston))
    stored = change["kinetic"] + change["strain"]
    return [
        Check("work of the gas in a cycle", change["force_work"], gas, "rigid mechanism", WORK, "J"),
        Check("work of gas and drive in a cycle", change["force_work"] + change["drive_work"], lost + stored,
              "losses of the film, stored", balance, "J"),
        Check("the ledger leaves open", change["numerical"], 0.0, "over the losses", balance, "J", scale=lost),
    ]  # fmt: skip


# --- what is drawn


@dataclass(frozen=True)
class PressureMap:
    """The pressure on the bore, unwrapped, in the saved step `row`."""

    result: wf.Result
    row: int

    def draw(self, ax: object) -> None:
        """Draw on matplotlib axes."""
        axes: Any = ax
        film_plots.pressure(self.result.film(FILM), axes, self.row)
        angle = crank_degrees(self.result)[self.row]
        axes.set_title(f"Pressure on the bore at {angle:.0f} degrees of the crank", fontsize=10)


def panels(results: dict[str, wf.Result], references: dict[str, Dense], reduced: wf.ReducedBody) -> list:
    """Load, orbit, smallest film and pressure over the crank angle, pressure around and on the bore at the peak."""
    steel, circle = results["steel"], np.linspace(0.0, 2.0 * np.pi, 121)
    counts, theta = within(crank_degrees(steel)), SPEED * steel.time
    at = Mechanism.at(theta)
    load = at.in_rod(steel.film(FILM).force[:, [0, 2]])[counts] * 1e-3
    exact = at.in_rod(Forces.at(reduced, theta).film)[counts] * 1e-3
    orbits, thin, peaks, around = {}, {}, {}, {}
    exactly: dict[str, dict] = {"thin": {}, "peaks": {}, "around": {}}
    for name, label in (("steel", "steel"), ("stiff", STIFF.name)):
        film, degrees, dense_film = results[name].film(FILM), crank_degrees(results[name]), references[name]
        shown, there = within(degrees), within(dense_film.degrees)
        e = film.eccentricity[shown] / CLEARANCE
        orbits[label] = e[:, 0], e[:, 1]
        thin[label] = degrees[shown], film.smallest_gap[shown] * 1e6
        peaks[label] = degrees[shown], film.largest_pressure[shown] / 1e6
        exactly["thin"][f"dense, {label}"] = dense_film.degrees[there], dense_film.thinnest[there] * 1e6
        exactly["peaks"][f"dense, {label}"] = dense_film.degrees[there], dense_film.peak[there] / 1e6
        order = np.argsort(np.mod(film.theta + np.pi, 2.0 * np.pi))
        angle = np.degrees(np.mod(film.theta + np.pi, 2.0 * np.pi) - np.pi)[order]
        row, middle = int(np.argmax(film.largest_pressure)), len(film.z) // 2
        other = int(np.argmax(dense_film.peak))
        around[label] = angle, film.pressure[row, order, middle] / 1e6
        exactly["around"][f"dense, {label}"] = angle, dense_film.pressure[other, order, middle] / 1e6
    orbits["clearance"] = np.cos(circle), np.sin(circle)
    return [
        Panel("Force of the film on the rod, in its axes", "along the rod [kN]", "across [kN]",
              {"run": (load[:, 0], load[:, 1])}, {"rigid mechanism": (exact[:, 0], exact[:, 1])}),
        Round("The pin in the clearance circle of the undeformed bore", "along the rod, over clearance", "across",
              orbits),
        Panel("Smallest film", "crank angle [deg]", "[um]", thin, exactly["thin"]),
        Panel("Peak pressure", "crank angle [deg]", "[MPa]", peaks, exactly["peaks"]),
        Panel("Around the middle of the bore at the peak", "angle from the rod [deg]", "[MPa]", around,
              exactly["around"]),
        PressureMap(steel, int(np.argmax(steel.film(FILM).largest_pressure))),
    ]  # fmt: skip


def main(out: str | Path = "out/connecting_rod", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write connecting_rod.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went
    well.

    Those are of the steel rod; the stiff one and the run with half the step are in connecting_rod.stiff.h5 and
    .halved.h5. quick: steps twice as long. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    rods = {"steel": rod_body(progress=progress), "stiff": rod_body(STIFF, progress=progress)}
    log.info("connecting rod: %g turns in steel, ten times as stiff, and in half the steps", TURNS)
    results = {name: run(rod, size.degrees, progress=progress) for name, rod in rods.items()}
    results["halved"] = run(rods["steel"], 0.5 * size.degrees, progress=progress)
    for name, result in results.items():
        if result.status != "completed":
            log.error("the run '%s' ended early, %s: %s", name, result.status, result.message)
            return 1
    log.info("connecting rod: the reference, for both rods")
    references = {name: dense(rod, REFERENCE_STEP) for name, rod in rods.items()}
    checks = [
        *force_checks(results["steel"], rods["steel"]),
        *film_checks(results["steel"], references["steel"], "steel"),
        *film_checks(results["stiff"], references["stiff"], "stiff"),
        *step_checks(results["steel"], results["halved"]),
        *energy_checks(results["steel"], size.balance),
    ]
    drawn = panels(results, references, rods["steel"])
    return finish(folder / "connecting_rod", results, checks, drawn, frames=size.frames)
