r"""The big end of a connecting rod on its crank pin: an oil film under the load of a four-stroke engine.

A crank rotates at a constant speed; only the oil film between the bore and the pin connects the rod to its pin. The rod
is elastic, reduced from quadratic tetrahedra; its small end is a joint on the piston, on which the gas presses. All
motion is in the plane x-z, crank angles count from the dead centre where the gas is exchanged; the gas burns after 360
degrees. The run begins at 0 with the pin in the middle of the bore and lasts two and a half revolutions, of which the
last two, one cycle, count.

What to expect. The film carries the force of the mechanism without clearance and elasticity, 26.6 kN at its peak,
except where the force reverses and the pin crosses the clearance, and for the vibrations of the rod. The same rod, ten
times as stiff, shows the effect of elasticity: under the combustion the steel eye deforms by nearly its clearance, in
the middle more than at the ends, where the film is thinnest. Before the gas is exchanged the rod is pulled: its eye
elongates, and its sides close on the pin, 60 degrees from the load. The smallest film of the cycle is there; that of
the stiff rod at this place is nearly three times as thick. Over a cycle the film dissipates the work of gas and
crank, by shear and by flow.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

DATA = Path(__file__).with_name("data")
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
STIFF = wf.Material(youngs_modulus=2100e9, poisson_ratio=0.3, density=7850, name="ten times as stiff")
CRANK, ROD, BIG = 0.040, 0.140, 0.024  # m: radius of the crank, between the axes of both eyes, of the big end's bore
SPACING = 2.69e-3  # m, of the film's grid, 56 x 9 nodes
CLEARANCE, OIL = 25e-6, wf.oils.Barus(0.008, coefficient=1.5e-8)  # m, of the radius; Pa s, 1/Pa
GROOVES = (0.5 * np.pi, -0.5 * np.pi)  # rad from the rod's axis: in the split of a rod with a cap
CRANK_MASS, CRANK_INERTIA = 5.0, (0.01, 0.01, 0.01)  # kg, kg m2: balanced, its centre on its axis
PISTON_MASS, PISTON_INERTIA = 0.5, (3e-4, 3e-4, 3e-4)  # kg, kg m2
SPEED = 300.0  # rad/s
TURNS, COUNTED = 2.5, 0.5  # of the run; where the cycle that counts begins
FIRING = (355.0, 460.0)  # deg, of the crank
RHO_INF = 0.5  # a thin film damps so strongly that with 0.8 its force alternates from step to step after the start
FILM = "rod-crank"


@dataclass(frozen=True)
class Size:
    """Degrees of the crank per step."""

    degrees: float = 1.0


FULL, QUICK = Size(), Size(degrees=2.0)


def rod_body(material: wf.Material = STEEL, *, progress: bool = True) -> wf.ReducedBody:
    """The reduced rod, contact surface `bore`, rigid interface `eye`. Angles of the film count from the rod's axis, in
    the sense of the crank's rotation."""
    bore = wf.surfaces.Bore(radius=BIG, axis_point=(0, 0, 0), axis_direction=(0, -1, 0))
    return wf.reduce(
        wf.mesh.read(DATA / "connecting_rod.msh", length_unit="m"), material, interfaces={"eye": "rigid"},
        contact={"bore": bore}, grid=wf.ContactGrid(spacing=SPACING, contact_fixed=False), modes=12, cache=False,
        progress=progress,
    )  # fmt: skip


def gas() -> wf.signals.Table:
    """The force of the gas on the piston along +x over time [N]."""
    force = np.loadtxt(DATA / "gas_force.csv", delimiter=",", skiprows=1)[:, 1]
    angles = np.arange(0.0, 360.0 * TURNS + 2.0)
    return wf.signals.Table(np.radians(angles) / SPEED, -force[angles.astype(int) % 720], cubic=True)


def build(*, progress: bool = True) -> wf.Scene:
    """The scene with the steel rod."""
    return machine(rod_body(progress=progress))


def machine(reduced: wf.ReducedBody) -> wf.Scene:
    """The scene around a rod that is already reduced: bodies `crank`, `rod`, `piston`, joints `axle`, `wrist`, `liner`,
    film `rod-crank`."""
    scene = wf.Scene()
    pin = wf.surfaces.Cylinder(radius=BIG - CLEARANCE, axis_point=(CRANK, 0, 0), axis_direction=(0, -1, 0))
    crank = scene.add_rigid_body(
        CRANK_MASS, CRANK_INERTIA, name="crank", angular_velocity=(0, -SPEED, 0), surfaces={"pin": pin}
    )
    rod = scene.add_body(
        reduced, name="rod", position=(CRANK, 0, 0), velocity=(0, 0, CRANK * SPEED),
        angular_velocity=(0, CRANK / ROD * SPEED, 0),
    )  # fmt: skip
    piston = scene.add_rigid_body(PISTON_MASS, PISTON_INERTIA, name="piston", position=(CRANK + ROD, 0, 0))
    axle = scene.add(wf.joints.Revolute(scene.ground, crank, axis=(0, -1, 0), name="axle"))
    scene.add(wf.joints.Revolute(rod["eye"], piston, axis=(0, -1, 0), name="wrist"))
    scene.add(wf.joints.Prismatic(scene.ground, piston, axis=(1, 0, 0), name="liner"))
    scene.add(wf.joints.Drive(axle, wf.signals.Constant(SPEED), quantity="velocity"))
    scene.add(wf.forces.PointForce(piston, (gas(), (1, 0, 0)), name="gas"))
    grooves = [wf.films.AxialGroove(at, 1e-3, 0.0) for at in GROOVES]  # narrower than a column of the grid
    scene.add(wf.Film(rod["bore"], crank["pin"], oil=OIL, feeds=grooves, name=FILM))
    return scene


def run(reduced: wf.ReducedBody, degrees: float, *, turns: float = TURNS, progress: bool = True) -> wf.Result:
    """From the start, in steps of so many degrees of the crank."""
    step = np.radians(degrees) / SPEED
    duration = round(360.0 * turns / degrees) * step
    integrator = wf.integrators.GeneralizedAlpha(RHO_INF)
    return wf.simulate(
        machine(reduced), duration, step=step, options=wf.RunOptions(integrator=integrator), progress=progress
    )


def crank_degrees(result: wf.Result) -> np.ndarray:
    """(T,) deg."""
    return np.degrees(SPEED * result.time)


def within(degrees: np.ndarray, begin: float = 360.0 * COUNTED, end: float = 360.0 * TURNS) -> np.ndarray:
    """Which angles (T,) [deg] are in a window, its ends included; by default in the cycle that counts."""
    return (degrees > begin - 1e-6) & (degrees < end + 1e-6)


def main(out: str | Path = "out/connecting_rod", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write connecting_rod.h5, .rrd and .png, and connecting_rod.stiff.h5 of the stiff rod, into the folder `out` and
    print the figures; quick: steps twice as long."""
    stem, size = Path(out) / "connecting_rod", QUICK if quick else FULL
    steel, stiff = (run(rod_body(material, progress=progress), size.degrees, progress=progress)
                    for material in (STEEL, STIFF))  # fmt: skip
    steel.save(f"{stem}.h5", overwrite=True)
    stiff.save(f"{stem}.stiff.h5", overwrite=True)
    wf.record(steel, f"{stem}.rrd", max_frames=60 if quick else 225, overwrite=True)

    degrees = crank_degrees(steel)
    counts, fires = within(degrees), within(degrees, *FIRING)
    films = {"steel": steel.film(FILM), STIFF.name: stiff.film(FILM)}
    shown, circle = degrees[counts], np.linspace(0.0, 2.0 * np.pi, 121)
    save_panels([
        Panel("The pin in the clearance circle", "along the rod, over the clearance", "across",
              {name: tuple(film.eccentricity[counts].T / CLEARANCE) for name, film in films.items()},
              {"clearance": (np.cos(circle), np.sin(circle))}, equal=True),
        Panel("Smallest film", "crank angle [deg]", "[µm]",
              {name: (shown, film.smallest_gap[counts] * 1e6) for name, film in films.items()}),
        Panel("Peak pressure", "crank angle [deg]", "[MPa]",
              {name: (shown, film.largest_pressure[counts] / 1e6) for name, film in films.items()}),
        Panel("Force of the film", "crank angle [deg]", "[kN]",
              {name: (shown, np.linalg.norm(film.force[counts], axis=1) / 1e3) for name, film in films.items()}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    for name, film in films.items():
        smallest, firing = film.smallest_gap[counts].min(), film.smallest_gap[fires].min()
        force, peak = np.linalg.norm(film.force[counts], axis=1).max(), film.largest_pressure[counts].max()
        print(f"{name:18} smallest film {smallest * 1e6:.3f} um, under the combustion {firing * 1e6:.3f} um; "
              f"peak pressure {peak / 1e6:.2f} MPa, peak force {force / 1e3:.3f} kN")  # fmt: skip
    print("                   (rigid mechanism: 26.615 kN)")
    return [steel, stiff]


if __name__ == "__main__":
    main()
