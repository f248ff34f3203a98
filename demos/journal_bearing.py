r"""A shaft in a steel sleeve with an oil film between them: rest, unbalance, and whirl above the critical mass.

The shaft rotates in the bore of a sleeve that is held outside. It moves in the plane across its axis (joint `plane`), a
drive rotates it, a force presses it, and only the film carries it. Everything is in the frame of the bore: angles from
the direction of the load, in the sense of rotation.

**Rest.** Under 20 kN, at 56 MPa, the sleeve deforms by 2.2 um, and the film is 2.4 um thick at its thinnest.

**Unbalance.** The shaft's centre of mass is off its axis, so that m u omega^2 rotates about a steady load. From rest,
the orbit closes within two revolutions.

**Whirl.** About the equilibrium the film of a rigid bore is -K e - C e', with K and C (2, 2), both unsymmetric: it
pushes a shaft that is off to one side forward around the bore. A shaft of mass m without any other support is stable up
to the critical mass m_c = k/w^2 with, by Routh and Hurwitz,

    Cxx (Kyy - k) + Cyy (Kxx - k) - Kxy Cyx - Kyx Cxy = 0,
    (Kxx - k)(Kyy - k) - Kxy Kyx - w^2 (Cxx Cyy - Cxy Cyx) = 0,

here 141.9 kg. A lighter shaft comes to rest, a heavier one whirls, at w, close to half of omega, the mean speed of the
oil. Both begin at rest with a small sideways velocity; the sleeve has ten times the modulus of steel, which is rigid
here. The groove is just behind the widest gap, and the film begins there: with cavities between groove and film K and C
do not hold, and a shaft whirls from 0.88 of that mass on.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RIGID = wf.Material(youngs_modulus=210e10, poisson_ratio=0.3, density=7850, name="ten times as stiff")
RADIUS, WALL, LENGTH, CLEARANCE = 0.025, 0.0125, 0.025, 25e-6  # m: the bore; of the radius
COLUMNS, ROWS = 64, 9  # nodes of the film around and along
SPEED, VISCOSITY = 300.0, 0.01  # rad/s, Pa s
HEAVY = 20e3  # N, at rest
LOAD, MASS, OFF = 5e3, 5.0, 5e-3  # N, kg, m: with unbalance, 2.25 kN
WHIRL_SPEED, WHIRL_VISCOSITY, WHIRL_LOAD = 1500.0, 2.5e-3, 1250.0  # rad/s, Pa s, N: fast, in thin oil, lightly loaded
CRITICAL, WHIRL = 141.934646, 0.500078426 * WHIRL_SPEED  # kg, rad/s, of the linear film
MASSES = {"light": 0.85, "heavy": 1.15}  # of the critical mass
GROOVE, WHIRL_GROOVE = 0.5 * COLUMNS, 0.6875 * COLUMNS  # columns: opposite the load, 10 degrees behind the widest gap
PUSH = 0.02  # of the clearance, the amplitude due to the sideways velocity
FILM = "sleeve-shaft"


@dataclass(frozen=True)
class Size:
    """Degrees per step and revolutions with unbalance, and of whirl."""

    degrees: float = 5.0
    turns: int = 3
    whirl_degrees: float = 4.0
    whirl_turns: int = 5


FULL, QUICK = Size(), Size(degrees=6.0, whirl_degrees=6.0, whirl_turns=4)


@dataclass(frozen=True)
class Running:
    """How the shaft runs: force [N], speed [rad/s], viscosity [Pa s], the column of the groove, mass [kg],
    distance of its centre of mass from the axis [m], velocity at the start across the load [m/s]."""

    load: float
    speed: float = SPEED
    viscosity: float = VISCOSITY
    groove: float = GROOVE
    mass: float = MASS
    off: float = 0.0
    sideways: float = 0.0


UNBALANCED = Running(LOAD, off=OFF)


def sleeve(material: wf.Material = STEEL, *, progress: bool = True) -> wf.ReducedBody:
    """The sleeve, its cells as wide as those of the film."""
    mesh = wf.mesh.sleeve(RADIUS, RADIUS + WALL, LENGTH, sectors=COLUMNS, order=1, axial=ROWS - 1)
    return wf.reduce(
        mesh, material, interfaces={"outside": "rigid"}, contact={"bore": wf.surfaces.Bore()}, modes=10, cache=False,
        progress=progress,
    )  # fmt: skip


def build(running: Running = UNBALANCED, *, progress: bool = True) -> wf.Scene:
    """The scene of a steel sleeve, by default with unbalance."""
    return machine(sleeve(progress=progress), running)


def machine(reduced: wf.ReducedBody, running: Running) -> wf.Scene:
    """The scene around a sleeve that is already reduced: bodies `sleeve`, `shaft`, joint `plane`, film
    `sleeve-shaft`."""
    scene = wf.Scene()
    outer = scene.add_body(reduced, name="sleeve")
    inertia = 0.5 * running.mass * RADIUS**2
    shaft = scene.add_rigid_body(
        running.mass, (inertia, inertia, inertia), name="shaft", center_of_mass=(running.off, 0, 0),
        position=(0.3 * CLEARANCE, 0, 0), velocity=(0, 0, -running.sideways), angular_velocity=(0, running.speed, 0),
        surfaces={"journal": wf.surfaces.Cylinder(
            radius=RADIUS - CLEARANCE, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)
        )},
    )  # fmt: skip
    scene.add(wf.joints.Fixed(scene.ground, outer["outside"], axis=(0, 1, 0), name="held"))
    plane = scene.add(wf.joints.Planar(scene.ground, shaft, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, wf.signals.Constant(running.speed), quantity="velocity"))
    scene.add(wf.forces.PointForce(shaft, (running.load, 0, 0), name="load"))
    groove = wf.films.AxialGroove(2.0 * np.pi * running.groove / COLUMNS, 1e-4, 0.0)  # narrower than a column
    oil = wf.oils.Newtonian(running.viscosity)
    scene.add(wf.Film(outer["bore"], shaft["journal"], oil=oil, feeds=[groove], name=FILM))
    return scene


def turn(reduced: wf.ReducedBody, running: Running, *, degrees: float, turns: int, progress: bool = True) -> wf.Result:
    """Whole revolutions from rest under the load."""
    step = np.radians(degrees) / running.speed
    steps = round(360.0 * turns / degrees)
    return wf.simulate(machine(reduced, running), steps * step, step=step, start="equilibrium", progress=progress)


def whirling(share: float) -> Running:
    """A shaft of a share of the critical mass, with a sideways velocity."""
    sideways = PUSH * CLEARANCE * WHIRL
    return Running(WHIRL_LOAD, WHIRL_SPEED, WHIRL_VISCOSITY, WHIRL_GROOVE, share * CRITICAL, sideways=sideways)


def place(result: wf.Result) -> np.ndarray:
    """Position of the shaft's axis (T, 2) over the clearance, along the load and in the sense of rotation."""
    return result.body("shaft").position[:, [0, 2]] * np.array([1.0, -1.0]) / CLEARANCE


def main(out: str | Path = "out/journal_bearing", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write journal_bearing.h5, .rrd and .png of the unbalance, and journal_bearing.steady.h5, .light.h5 and .heavy.h5,
    into the folder `out` and print the figures; quick: longer steps, fewer revolutions."""
    stem, size = Path(out) / "journal_bearing", QUICK if quick else FULL
    steel, rigid = sleeve(progress=progress), sleeve(RIGID, progress=progress)
    unbalance = turn(steel, UNBALANCED, degrees=size.degrees, turns=size.turns, progress=progress)
    steady = wf.equilibrium(machine(steel, Running(HEAVY)))
    whirls = {
        name: turn(rigid, whirling(m), degrees=size.whirl_degrees, turns=size.whirl_turns, progress=progress)
        for name, m in MASSES.items()
    }
    unbalance.save(f"{stem}.h5", overwrite=True)
    for name, result in {"steady": steady, **whirls}.items():
        result.save(f"{stem}.{name}.h5", overwrite=True)
    wf.record(unbalance, f"{stem}.rrd", max_frames=60 if quick else 220, overwrite=True)

    film, e, rest = steady.film(FILM), place(unbalance), place(steady)[0]
    turns, circle = unbalance.time * SPEED / (2.0 * np.pi), np.linspace(0.0, 2.0 * np.pi, 121)
    order = np.argsort(np.mod(film.theta + np.pi, 2.0 * np.pi))
    around = np.degrees(np.mod(film.theta + np.pi, 2.0 * np.pi) - np.pi)[order]
    moving = {f"{MASSES[name] * CRITICAL:.0f} kg": (result.time * WHIRL_SPEED / (2.0 * np.pi),
                                                   place(result)[:, 0] - place(result)[0, 0])
              for name, result in whirls.items()}  # fmt: skip
    save_panels([
        Panel("Pressure in the middle at rest, 20 kN", "angle from the load [deg]", "[MPa]",
              {"run": (around, film.pressure[0, order, ROWS // 2] / 1e6)}),
        Panel("Unbalance: the shaft in the clearance circle", "along the load, over clearance", "across it",
              {"run": (e[:, 0], e[:, 1])}, {"clearance": (np.cos(circle), np.sin(circle))}, equal=True),
        Panel("Unbalance: smallest film", "revolutions", "[µm]",
              {"run": (turns, unbalance.film(FILM).smallest_gap * 1e6)}),
        Panel("Whirl after a push: off rest along the load", "revolutions", "over clearance", moving),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    print(f"at rest: eccentricity {np.hypot(*rest):.5f} of the clearance, smallest film "
          f"{film.smallest_gap[0] * 1e6:.4f} um, peak {film.largest_pressure[0] / 1e6:.3f} MPa")  # fmt: skip
    n = round(360.0 / size.degrees)
    change = np.abs(e[-n:] - e[-2 * n : -n]).max()
    print(f"unbalance: the last revolution differs from the one before by {change:.1e} of the clearance")
    for name, result in whirls.items():
        off = np.abs(place(result) - place(result)[0]).max(axis=1)
        first, last = off[: len(off) // 3].max(), off[-len(off) // 3 :].max()
        print(f"whirl, {MASSES[name]:.2f} of the critical mass: from {first:.4f} to {last:.4f} of the clearance")
    return [unbalance, steady, *whirls.values()]


if __name__ == "__main__":
    main()
