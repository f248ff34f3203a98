r"""A piston in its liner: secondary motion on two oil films under the load of a four-stroke engine, both walls elastic.

The skirt of an aluminium piston is two arcs, on the thrust and the anti-thrust side, each with an oil film to the bore
of a cast-iron liner. Piston and liner are flexible bodies; crank and rod are rigid. The skirt is oval and has a barrel
profile. The pin moves across the bore and the piston tilts about it, within the clearance; the run lasts two and a half
revolutions, of which the last two, one cycle, count. The gas burns after 360 degrees of the crank.

What to expect. The films carry the side force of the mechanism without clearance and elasticity, 3.23 kN at its peak.
Near the dead centre of firing this force reverses, and the piston crosses the bore. The work of the gas is that of its
force in the rigid mechanism, 560 J in a cycle, and the films dissipate the work of crank and gas by shear and flow. The
same piston in a rigid bore, and one ten times as stiff there, show the effect of the elastic walls: without them the
film under the combustion is thinner and the pressure higher.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

DATA = Path(__file__).with_name("data")
ALLOY = wf.Material(youngs_modulus=75e9, poisson_ratio=0.33, density=2700, name="aluminium")
STIFF = wf.Material(youngs_modulus=750e9, poisson_ratio=0.33, density=2700, name="ten times as stiff")
IRON = wf.Material(youngs_modulus=120e9, poisson_ratio=0.26, density=7200, name="cast iron")
CRANK, ROD, BORE = 0.040, 0.140, 0.040  # m: radius of the crank, length of the rod, radius of the bore
SKIRT = (-0.022, 0.012)  # m, along the bore, from the pin
CLEARANCE, BARREL = 40e-6, 60e-6  # m: of the radius; removed at the skirt's ends
OVAL = 60e-6  # m: half of what is removed where the pin's axis meets the circle of the skirt
SPACING = 4.2e-3  # m, of each film's grid, 17 x 9 nodes
LINER, LINER_WALL, LINER_CELLS = (0.068, 0.212), 0.006, (24, 12)  # m from the crank's axis; around and along
OIL, AMBIENT = wf.oils.iso_vg(68, temperature=100), 1e5  # Pa
ROUGH, FRICTION = wf.laws.ExponentialAsperities(pressure_at_zero=40e6, decay_length=0.5e-6), 0.1
ROD_MASS, ROD_CENTRE, ROD_INERTIA = 0.6, 0.045, (1e-4, 1.8e-3, 1.8e-3)  # kg, m from the crank pin, kg m2
CRANK_MASS, CRANK_INERTIA = 5.0, (0.01, 0.01, 0.01)  # kg, kg m2: balanced, its centre on its axis
BEGIN = (-22e-6, -0.6e-3)  # m, rad: position across the bore and tilt at the start
SPEED = 300.0  # rad/s
TURNS, COUNTED = 2.5, 0.5  # of the run; where the cycle that counts begins
RHO_INF = 0.5  # a thin film damps strongly
THRUST, ANTI = "thrust", "anti-thrust"


@dataclass(frozen=True)
class Size:
    """Degrees of the crank per step."""

    degrees: float = 1.0


FULL, QUICK = Size(), Size(degrees=2.0)


def piston_body(material: wf.Material = ALLOY, *, progress: bool = True) -> wf.ReducedBody:
    """The reduced piston: contact surfaces `thrust` and `anti-thrust`, interfaces `pin` (rigid) and `crown` (its mean
    motion)."""
    skirt = wf.surfaces.Cylinder(radius=BORE - CLEARANCE - OVAL, axis_point=(0, 0, 0), axis_direction=(1, 0, 0))
    return wf.reduce(
        wf.mesh.read(DATA / "piston.msh", length_unit="m"), material, interfaces={"pin": "rigid", "crown": "average"},
        contact={THRUST: skirt, ANTI: skirt}, grid=wf.ContactGrid(spacing=SPACING, contact_fixed=False), modes=20,
        cache=False, progress=progress,
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
        grid=wf.ContactGrid(contact_fixed=False), cache=False, progress=progress,
    )  # fmt: skip


def gas() -> wf.signals.Table:
    """The force of the gas on the piston along +x over time [N]."""
    force = np.loadtxt(DATA / "gas_force.csv", delimiter=",", skiprows=1)[:, 1]
    angles = np.arange(0.0, 360.0 * TURNS + 2.0)
    return wf.signals.Table(np.radians(angles) / SPEED, -force[angles.astype(int) % 720], cubic=True)


def skirt_form() -> wf.films.Form:
    """Barrel and oval of the skirt; no material is removed in its middle across the pin."""
    return wf.films.BarrelForm(BARREL, SKIRT[1] - SKIRT[0], 0.5 * sum(SKIRT)) + wf.films.LobedForm(OVAL, 2)


def build(*, progress: bool = True) -> wf.Scene:
    """The scene with both walls elastic."""
    return machine(piston_body(progress=progress), liner_body(progress=progress))


def machine(piston_is: wf.ReducedBody, liner_is: wf.ReducedBody | None) -> wf.Scene:
    """The scene around bodies that are already reduced; without a liner its bore is rigid. Bodies `crank`, `rod`,
    `piston`, `liner`, joints `axle`, `big end`, `wrist`, `plane`, `block`, films `thrust`, `anti-thrust`."""
    scene, (off, tilt) = wf.Scene(), BEGIN
    lean = off / ROD  # inclination of the rod; the pin is off the axis of the bore
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
    axle = scene.add(wf.joints.Revolute(scene.ground, crank, axis=(0, -1, 0), name="axle"))
    scene.add(wf.joints.Drive(axle, wf.signals.Constant(SPEED), quantity="velocity"))
    scene.add(wf.joints.Revolute(crank.at((CRANK, 0, 0)), rod, axis=(0, -1, 0), name="big end"))
    scene.add(wf.joints.PointOnLine(rod.at((ROD, 0, 0)), piston["pin"], axis=(0, -1, 0), name="wrist"))
    scene.add(wf.joints.Planar(scene.ground.at((CRANK + ROD, 0, 0)), piston["pin"], axis=(0, -1, 0), name="plane"))
    scene.add(wf.forces.PointForce(piston["crown"], (gas(), (1, 0, 0)), name="gas"))
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
            piston[name], bore, oil=OIL, ambient_pressure=AMBIENT, form_a=skirt_form(),
            mixed=wf.films.MixedLubrication(ROUGH, FRICTION), name=name,
        ))  # fmt: skip
    return scene


def _about_y(angle: float) -> tuple[float, float, float, float]:
    return 0.0, float(np.sin(0.5 * angle)), 0.0, float(np.cos(0.5 * angle))


def run(scene: wf.Scene, degrees: float, *, turns: float = TURNS, progress: bool = True) -> wf.Result:
    """From the start, in steps of so many degrees of the crank."""
    step = np.radians(degrees) / SPEED
    duration = round(360.0 * turns / degrees) * step
    options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(RHO_INF))
    return wf.simulate(scene, duration, step=step, options=options, progress=progress)


def place(result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """Position of the pin across the bore (T,) [m], towards z, and tilt about it (T,) [rad], about y."""
    piston = result.body("piston")
    return piston.position[:, 2], 2.0 * np.arcsin(piston.rotation[:, 1])


def main(out: str | Path = "out/piston", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write piston.h5, .rrd and .png, and the results in a rigid bore, piston.rigid.h5, and of a stiff piston there,
    piston.stiff.h5, into the folder `out` and print the figures; quick: steps twice as long."""
    stem, size = Path(out) / "piston", QUICK if quick else FULL
    piston_is = piston_body(progress=progress)
    scenes = {
        "elastic walls": machine(piston_is, liner_body(progress=progress)),
        "rigid bore": machine(piston_is, None),
        "stiff piston, rigid bore": machine(piston_body(STIFF, progress=progress), None),
    }
    results = {name: run(scene, size.degrees, progress=progress) for name, scene in scenes.items()}
    for result, ending in zip(results.values(), ("", ".rigid", ".stiff"), strict=True):
        result.save(f"{stem}{ending}.h5", overwrite=True)
    wf.record(results["elastic walls"], f"{stem}.rrd", max_frames=60 if quick else 225, overwrite=True)

    curves: dict[str, dict] = {name: {} for name in ("across", "tilt", "film", "peak")}
    for name, result in results.items():
        degrees = np.degrees(SPEED * result.time)
        counts, films = degrees > 360.0 * COUNTED - 1e-6, [result.film(side) for side in (THRUST, ANTI)]
        shown, (across, tilt) = degrees[counts], place(result)
        smallest = np.min([film.smallest_gap[counts] for film in films], axis=0) * 1e6
        peak = np.max([film.largest_pressure[counts] for film in films], axis=0) / 1e6
        side = np.sum([film.force[counts, 2] for film in films], axis=0) / 1e3
        for key, values in zip(curves, (across[counts] * 1e6, tilt[counts] * 1e3, smallest, peak), strict=True):
            curves[key][name] = shown, values
        work = {line: result.energy[line][counts][-1] - result.energy[line][counts][0] for line in result.energy}
        print(f"{name:25} smallest film {smallest.min():.3f} um, peak pressure {peak.max():.3f} MPa, "
              f"peak side force {np.abs(side).max():.3f} kN, work of the gas {work['force_work']:.2f} J")  # fmt: skip
    print("                          (rigid mechanism: 3.225 kN, 560.30 J)")
    angle = "crank angle [deg]"
    save_panels([
        Panel("Pin across the bore", angle, "[µm]", curves["across"]),
        Panel("Tilt about the pin", angle, "[mrad]", curves["tilt"]),
        Panel("Smallest film of both sides", angle, "[µm]", curves["film"]),
        Panel("Peak pressure of both films", angle, "[MPa]", curves["peak"]),
    ], f"{stem}.png", overwrite=True)  # fmt: skip
    return list(results.values())


if __name__ == "__main__":
    main()
