r"""Two gears of the FZG test in mesh: transmission error, load shares and pressures over a pitch, at three loads.

The flanks are half-spaces on rigid gears with tip relief: the deflection is that of the contacts alone, the pressures
are those of real gears. The wheel is rotated slowly by a pitch while the torque of an FZG load stage presses the pinion
against it. One pair of teeth carries about the pitch point, two outside, and the wheel lags. With r_b the base radii
and F = T_1/r_b1 the normal force, the transmission error and the secant stiffness of the mesh are

    TE = r_b2 theta_2 - r_b1 theta_1 (below zero),      c = F/|TE|.

Where one pair of teeth carries at the pitch point C, the peak pressure is Hertz's of the line load F/b, raised in the
middle by the free ends. Involutes touch on the line of action, reliefs off it. The films between the flanks, by formula
at the speed of the test, are thinner than the roughness. One tip relief suits one load: below it fewer teeth share the
load, above it tips meet early.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Drawn, Panel, save_panels

STEEL = wf.Material(youngs_modulus=206e9, poisson_ratio=0.3, density=7850, name="steel")
MODULE, WIDTH, DISTANCE = 4.5e-3, 14e-3, 91.5e-3  # m
TIPS: Any = {"tip_rounding": 0.2e-3, "tip_relief": 25e-6, "tip_relief_length": 3e-3, "thickness_allowance": -50e-6}  # m
PINION = wf.gears.Gear(MODULE, 16, profile_shift=0.1817, tip_diameter=82.45e-3, **TIPS)
WHEEL = wf.gears.Gear(MODULE, 24, profile_shift=0.1715, tip_diameter=118.35e-3, **TIPS)
PAIR = wf.gears.GearPair(PINION, WHEEL, DISTANCE)
STAGES = {"stage 3": 35.3, "stage 5": 94.1, "stage 7": 183.4}  # N m on the pinion
OIL = wf.oils.Roelands(0.012, coefficient=1.8e-8)  # Pa s, 1/Pa: a mineral oil of ISO VG 100 at 90 degrees
SPEED, ROUGHNESS, THINNING = 235.6, (0.4e-6, 0.4e-6), 0.03  # rad/s of the pinion, m, 1/K
PITCH = 2.0 * np.pi / 16  # rad, of the pinion
START = 0.05  # rad: the flank of its tooth 1 is about the pitch point


@dataclass(frozen=True)
class Size:
    """Steps of a pitch, number of loads."""

    steps: int = 32
    loads: int = 3


FULL, QUICK = Size(), Size(steps=8, loads=1)


def body(gear: wf.gears.Gear) -> wf.ReducedBody:
    """A gear whose right flanks are half-spaces."""
    flanks, half = gear.surfaces(("right",)), 0.5 * WIDTH
    return wf.half_space_body(1.0, (1e-3, 2e-3, 1e-3), STEEL, contact=flanks, extent=(-half, half))


def build(torque: float) -> wf.Scene:
    """The scene: bodies `pinion` and `wheel`, gear pair `mesh`; the wheel rotates by a pitch in 1 s."""
    scene, y = wf.Scene(gravity=(0, 0, 0)), (0, 1, 0)
    pinion = scene.add_body(body(PINION), name="pinion", rotation={"axis": y, "angle": START})["center"]
    wheel = scene.add_body(body(WHEEL), name="wheel")["center"]
    scene.add_gear_pair(pinion, wheel, PAIR, name="mesh", direction=(1, 0, 0), rotation=(-1.1 * PITCH, 0.0))
    scene.add(wf.joints.Revolute(scene.ground, pinion, axis=y, name="pinion shaft"))
    shaft = scene.add(wf.joints.Revolute(scene.ground, wheel, axis=y, name="wheel shaft"))
    rotation = wf.signals.Table([0.0, 1.0], [0.0, PITCH * 16 / 24])
    scene.add(wf.joints.Drive(shaft, rotation, quantity="position"))
    scene.add(wf.forces.PointTorque(pinion, (0.0, -torque, 0.0), name="torque"))
    return scene


def single(result: wf.Result) -> tuple[int, int]:
    """Row and pair of teeth where one carries alone, nearest to the pitch point."""
    gear = result.gear("mesh")
    alone = np.where(gear.load_share > 0.999, np.abs(gear.place), np.inf)
    row, pair = np.unravel_index(np.argmin(alone), alone.shape)
    return int(row), int(pair)


@dataclass(frozen=True)
class Kind:
    """A kind of plot of a result, as a panel."""

    result: wf.Result
    kind: str

    def draw(self, ax: Any) -> None:
        self.result.plot(self.kind, ax)


def panels(results: dict[str, wf.Result]) -> list[Drawn]:
    """Transmission error, its orders, stiffness and peak pressures over a pitch; of the largest load the shares of the
    pairs of teeth, pressure on the flank, path of contact, and films at the speed of the test."""
    found = {name: result.gear("mesh") for name, result in results.items()}
    first, last, heaviest = next(iter(found.values())), list(results)[-1], list(results.values())[-1]
    label, turned = "rotation of the pinion [pitches]", (first.angle[0] - first.angle) / PITCH
    orders = {name: gear.orders() for name, gear in found.items()}
    film = found[last].film_thickness(OIL, speed=SPEED, roughness=ROUGHNESS, thinning=THINNING)
    return [
        Panel("Transmission error", label, "[um]",
              {name: (turned, 1e6 * gear.transmission_error) for name, gear in found.items()}),
        Panel("Its orders of the tooth frequency", "order [-]", "amplitude [um]",
              {name: (known.order, 1e6 * known.amplitude) for name, known in orders.items()}),
        Panel("Stiffness of the mesh", label, "[N/um]",
              {name: (turned, 1e-6 * gear.stiffness) for name, gear in found.items()}),
        Panel("Peak pressure", label, "[MPa]",
              {name: (turned, 1e-6 * gear.peak_pressure.max(axis=1)) for name, gear in found.items()}),
        *(Kind(heaviest, kind) for kind in ("load_share", "flank_pressure", "contact_path")), film,
    ]  # fmt: skip


def main(out: str | Path = "out/gear_pair", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write gear_pair.h5, .rrd and .png of the largest load into the folder `out` and print the figures; quick: fewer
    steps, the largest load only."""
    stem, size = Path(out) / "gear_pair", QUICK if quick else FULL
    results = {
        f"{name}, {torque:g} N m": wf.static(build(torque), 1.0, step=1.0 / size.steps, progress=progress)
        for name, torque in list(STAGES.items())[-size.loads :]
    }
    last = list(results.values())[-1]
    last.save(f"{stem}.h5", overwrite=True)
    wf.record(last, f"{stem}.rrd", overwrite=True)
    save_panels(panels(results), f"{stem}.png", overwrite=True)

    for (name, result), torque in zip(results.items(), list(STAGES.values())[-size.loads :], strict=True):
        gear, (row, pair) = result.gear("mesh"), single(result)
        hertz, _ = PAIR.hertz(torque, WIDTH, gear.place[row, pair])
        contact = result.contact(gear.contacts[pair])
        print(f"{name}: transmission error {1e6 * gear.transmission_error.min():6.2f} to "
              f"{1e6 * gear.transmission_error.max():6.2f} um, first order {1e6 * gear.orders().amplitude[0]:5.2f} um; "
              f"one pair {1e-6 * gear.stiffness[row]:4.0f} N/um, pressure {1e-6 * contact.mid_peak_pressure[row]:5.0f} "
              f"MPa, Hertz {1e-6 * hertz:5.0f} MPa")  # fmt: skip
    return list(results.values())


if __name__ == "__main__":
    main()
