r"""A two-stage gearbox under torque, whole: three flexible shafts, six ball bearings, four gears, a flexible housing.

One scene file, data/gearbox.toml, describes it: two pairs of spur gears, 20 to 40 and 20 to 60 teeth, in a housing of
cast iron (data/make_gearbox_housing.py). Each shaft runs in two deep groove ball bearings: their rings are mounted on
interfaces of shaft and housing, each ball is in contact with both. The flanks are elastic half-spaces with tip relief,
so that pressures, and their centre across the width, follow from how shafts, bearings and housing yield.

**Torque.** The load T acts on the output shaft, a coupling holds the input shaft. Where one pair of teeth carries on
the involute, the normal stays on the path of contact and T_in = T z_1 z_3/(z_2 z_4).

**Statics.** The normal forces are F_1 = T_in/r_b1 and F_2 = T_in z_2/(z_1 r_b3), along d = (sin alpha, 0, +-cos alpha).
With their places y_i along the shafts, bearings at +-l/2 and forces f_i on a shaft, the bearings carry

    R_front = - sum f_i (1/2 - y_i/l),      R_back = - sum f_i (1/2 + y_i/l).

Bent shafts tilt the gears: y_i is the centre of pressure, 1 to 2 mm from the middle of the teeth, and a bearing of
balls resists the tilt with a small moment, which is left out.

**At speed** a motor drives the input shaft through the coupling, and the same torque loads the output shaft; balls and
cages begin as they roll. Teeth come into mesh and leave it: each stage excites shafts and housing at its tooth
frequency.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, Polar, save_panels

FILE = Path(__file__).parent / "data" / "gearbox.toml"
SHAFTS, ENDS = ("input", "middle", "output"), ("front", "back")
BETWEEN = 0.1  # m, between the bearings of a shaft
STAGES = {"stage_1": ("pinion_1", 1.0), "stage_2": ("pinion_2", -1.0)}  # pinion; 1 where its right flank pushes
RATIO = 40.0 / 20.0 * 60.0 / 20.0
OF_INPUT = {"input": -1.0, "middle": 0.5, "output": -1.0 / 6.0}  # speeds about y over that of the input shaft
SPEED = 4.0 * np.pi  # rad/s of the input shaft: 120 rpm
STEP = 1e-4  # s


@dataclass(frozen=True)
class Size:
    """Strips and rows of cells of a patch, None: chosen by `cell_error`; duration [s] of the run at speed."""

    cells: tuple[int, int] | None = None
    duration: float = 0.05


FULL, QUICK = Size(), Size((7, 9), 2e-3)


def build(size: Size = FULL, speed: float = 0.0) -> wf.Scene:
    """The scene of the file: bodies, bearings `input_front` to `output_back`, gear pairs `stage_1` and `stage_2`; the
    input shaft rotates at `speed` [rad/s] about -y."""
    cells = [f"gear_pairs.{stage}.cells={list(size.cells)}" for stage in STAGES] if size.cells else []
    scene = wf.load_scene(FILE, settings=[f"speed={speed}", f"turn={speed * size.duration}", *cells]).scene
    for bearing in scene.bearings:
        bearing.roll(inner=speed * OF_INPUT[bearing.name.split("_")[0]])
    return scene


def torque_of(result: wf.Result, force: str) -> float:
    """About the shafts [N m]: T of the force `load`, T_in of `coupling`."""
    return float(abs(result.force(force).torque[-1, 1]))


def line_load(result: wf.Result, stage: str) -> tuple[np.ndarray, np.ndarray, float]:
    """Places along the shafts [m] of the rows of cells, the largest pressures [Pa] there, centre of pressure [m]."""
    gear = result.gear(stage)
    contact = result.contact(gear.contacts[int(np.argmax(gear.load[-1]))])
    middle = result.body(STAGES[stage][0]).position[-1, 1]
    center = contact.center_of_pressure[-1, 1]
    return middle + contact.z[-1], contact.mean_pressure[-1].max(axis=0), middle + center


def statics(result: wf.Result, torque: float) -> dict[str, float]:
    """Loads [N] of the bearings by hand, the tooth forces at their centres of pressure."""
    pairs = [result.gear(stage).pair for stage in STAGES]
    normal = torque / RATIO / pairs[0].gear_1.base_radius, torque / 3.0 / pairs[1].gear_1.base_radius
    on_wheel, places = [], []
    for (stage, (_, side)), pair, force in zip(STAGES.items(), pairs, normal, strict=True):
        alpha = pair.working_pressure_angle
        on_wheel.append(force * np.array([np.sin(alpha), side * np.cos(alpha)]))
        places.append(line_load(result, stage)[2])
    (one, two), (y_1, y_2) = on_wheel, places
    loads = {"input": [(-one, y_1)], "middle": [(one, y_1), (-two, y_2)], "output": [(two, y_2)]}
    return {
        f"{shaft}_{end}": float(np.linalg.norm(sum(f * (0.5 + sign * y / BETWEEN) for f, y in of)))
        for shaft, of in loads.items()
        for end, sign in zip(ENDS, (-1.0, 1.0), strict=True)
    }


def bearing_loads(result: wf.Result) -> dict[str, float]:
    """Radial loads [N] of the bearings."""
    names = [f"{shaft}_{end}" for shaft in SHAFTS for end in ENDS]
    return {name: float(np.hypot(*result.joint(f"{name} inner seat").force[-1, ::2])) for name in names}


def panels(result: wf.Result, torque: float) -> list[Panel]:
    """Load zones, pressures along the teeth, loads of the bearings, displacements of the bores."""
    drawn: list[Panel] = []
    for shaft in SHAFTS:
        zones = {}
        for end in ENDS:
            found = result.bearing(f"{shaft}_{end}")
            zones[end] = np.append(found.angle[-1], found.angle[-1, 0]), found.outer_load[-1, [*range(9), 0]] / 1e3
        drawn.append(Polar(f"Load zones, {shaft} shaft", "angle from x", "[kN]", zones))
    rows = {stage: line_load(result, stage) for stage in STAGES}
    found, known, number = bearing_loads(result), statics(result, torque), np.arange(1, 7)
    rings = [result.body(f"{name} outer ring") for name in found]
    moved = np.array([ring.position[-1] for ring in rings]) - [
        (x, y, 0.0) for x in (0.0, 0.075, 0.195) for y in (-0.05, 0.05)
    ]
    label = "bearing: 1 input_front to 6 output_back"
    return [
        *drawn,
        Panel("Largest pressure along the teeth", "y [mm]", "[MPa]",
              {stage: (1e3 * y, 1e-6 * p) for stage, (y, p, _) in rows.items()}),
        Panel("Loads of the bearings", label, "[kN]", {},
              points={name: (number, np.array(list(of.values())) / 1e3)
                      for name, of in (("found", found), ("statics", known))}),
        Panel("Displacement of the bores of the housing", label, "[um]", {},
              points={f"along {c}": (number, 1e6 * moved[:, i]) for i, c in enumerate("xyz")}),
    ]  # fmt: skip


def moving_panels(result: wf.Result) -> list[Panel]:
    """Transmission error and loads of the teeth of both stages, loads of the bearings."""
    t, label = 1e3 * result.time, "time [ms]"
    gears = {stage: result.gear(stage) for stage in STAGES}
    loads = {f"{s}_{e}": result.joint(f"{s}_{e} inner seat").force for s in SHAFTS for e in ENDS}
    return [
        Panel("Transmission error", label, "[um]",
              {stage: (t, 1e6 * gear.transmission_error) for stage, gear in gears.items()}),
        *(Panel(f"Loads of the pairs of teeth, {stage}", label, "[kN]",
                {f"{k} on {m}": (t, load / 1e3)
                 for (_, k, m), load in zip(gear.teeth, gear.load.T, strict=True) if load.any()})
          for stage, gear in gears.items()),
        Panel("Radial loads of the bearings", label, "[kN]",
              {name: (t, np.hypot(force[:, 0], force[:, 2]) / 1e3) for name, force in loads.items()}),
    ]  # fmt: skip


def run(size: Size, progress: bool) -> wf.Result:
    """From equilibrium under torque, at speed."""
    options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(0.8))
    scene = build(size, SPEED)
    return wf.simulate(scene, size.duration, step=STEP, start="equilibrium", options=options, progress=progress)


def main(out: str | Path = "out/gearbox", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write gearbox.h5, .rrd and .png, and gearbox.at_speed.h5, into the folder `out` and print the figures; the
    recording is that at speed; quick: fewer cells, a shorter run."""
    stem, size = Path(out) / "gearbox", QUICK if quick else FULL
    result = wf.equilibrium(build(size), progress=progress)
    torque = torque_of(result, "load")
    result.save(f"{stem}.h5", overwrite=True)
    taken = torque_of(result, "coupling")
    print(f"torque {torque:g} N m out, {taken:.4f} in: ratio {torque / taken:.5f}, of the teeth {RATIO:g}")
    known = statics(result, torque)
    for name, load in bearing_loads(result).items():
        print(f"{name:13} {load:7.1f} N, statics {known[name]:7.1f} N")

    moving = run(size, progress)
    moving.save(f"{stem}.at_speed.h5", overwrite=True)
    wf.record(moving, f"{stem}.rrd", overwrite=True)
    save_panels([*panels(result, torque), *moving_panels(moving)], f"{stem}.png", overwrite=True)
    for stage in STAGES:
        error = 1e6 * moving.gear(stage).transmission_error
        print(f"at speed, {stage}: transmission error {error.min():.2f} to {error.max():.2f} um")
    taken = np.abs(moving.force("coupling").torque[:, 1])
    print(f"at speed: input torque {taken.min():.2f} to {taken.max():.2f} N m; energy balance closed to "
          f"{np.abs(moving.energy_residual).max():.1e} of the largest energy")  # fmt: skip
    return [result, moving]


if __name__ == "__main__":
    main()
