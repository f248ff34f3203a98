r"""A flexible shaft on two tilting-pad bearings runs up through its critical speed, on warm oil.

A disc is in the middle of a slender shaft, and rigid journals at its ends run in four tilting pads each, whose oil
heats up: what leaves a pad enters the next one. The films are stiffer than the shaft and damp its bending, so that the
unbalance of the disc has a resonance near the critical speed in rigid bearings. Equilibria at held speeds give the
temperatures and the coefficients of a bearing; the test of this demo compares the run-up with a rotor on these
coefficients, integrated by hand.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RADIUS, SPAN = 0.02, 0.4  # m: of the shaft and the journals, between the bearings
DISC, JOURNAL = 40.0, 0.2  # kg
OFF = 4e-6  # m: centre of mass of the disc off the axis
CLEARANCE, WIDTH, THICKNESS, ARC, PRELOAD = 50e-6, 0.02, 0.012, np.radians(72.0), 0.5  # m, m, m, rad, -
SUPPLY, SHAFT = 45.0, 55.0  # degrees Celsius
OIL = wf.oils.iso_vg(32, temperature=SUPPLY, heat_capacity=2000.0)
BEARINGS = ("left", "right")
RPM = np.pi / 30.0  # rad/s


@dataclass(frozen=True)
class Size:
    """Speeds of the run-up [rpm], its duration [s], steps per revolution at its end, nodes of a pad, held speeds."""

    speeds: tuple[float, float] = (4000.0, 8500.0)
    duration: float = 0.6
    steps: int = 30
    nodes: tuple[int, int] = (12, 9)
    places: int = 5


FULL, QUICK = Size(), Size(duration=0.3, places=3)


def flexible_shaft(*, progress: bool = True) -> wf.ReducedBody:
    """The shaft, with the interfaces `end_low`, `end_high` and, in the middle, `seat`."""
    y = np.linspace(0.01, 0.5 * SPAN, 7)
    mesh = wf.mesh.roller(RADIUS, 0.0, SPAN, sectors=8, layers=1, axial=np.concatenate([-y[::-1], y]))
    mesh = mesh.select("seat", "rim", lambda x: abs(x[:, 1]) < 0.01)
    return wf.reduce(
        mesh, STEEL, interfaces={"end_low": "rigid", "end_high": "rigid", "seat": "average"}, modes=6, cache=False,
        progress=progress,
    )  # fmt: skip


def round_shape(radius: float) -> wf.surfaces.Cylinder:
    return wf.surfaces.Cylinder(radius=radius, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))


def build(shaft: wf.ReducedBody, speed: float, *, off: float = OFF, size: Size = FULL, run_up: Any = None) -> wf.Scene:
    """The scene at `speed` [rad/s], run_up: speed over time."""
    scene, spin = wf.Scene(gravity=(0, 0, -9.81)), (0, speed, 0)
    bent = scene.add_body(shaft, name="shaft", angular_velocity=spin)
    disc = scene.add_rigid_body(
        DISC, (0.15, 0.25, 0.15), name="disc", center_of_mass=(off, 0, 0), angular_velocity=spin,
        surfaces={"rim": round_shape(0.1)},
    )  # fmt: skip
    scene.add(wf.joints.Fixed(bent["seat"], disc, name="hub"))
    for name, end, place in zip(BEARINGS, ("end_low", "end_high"), (-0.5 * SPAN, 0.5 * SPAN), strict=True):
        journal = scene.add_rigid_body(
            JOURNAL, (0.5 * JOURNAL * RADIUS**2,) * 3, name=name, position=(0, place, 0),
            angular_velocity=spin, surfaces={"journal": round_shape(RADIUS)},
        )  # fmt: skip
        scene.add(wf.joints.Fixed(bent[end], journal, name=f"{name} seat"))
        scene.add_journal_bearing(
            f"{name} bearing", journal["journal"], wf.films.pads(4, ARC, first=0.25 * np.pi, preload=PRELOAD),
            clearance=CLEARANCE, length=WIDTH, oil=OIL, position=(0, place, 0),
            tilting=wf.films.TiltingPads(THICKNESS, pivot="point"), first=(0, 0, -1),
            nodes=size.nodes, temperature=wf.films.FilmTemperature(SUPPLY, wall_b=SHAFT),
        )  # fmt: skip
    start: dict[str, Any] = {"position": (0, -0.5 * SPAN, 0), "angular_velocity": spin}
    motor = scene.add_rigid_body(0.02, (1e-4, 1e-4, 1e-4), name="motor", **start)
    plane = scene.add(wf.joints.Planar(scene.ground, motor, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, speed if run_up is None else run_up, quantity="velocity", name="drive"))
    scene.add(wf.joints.Universal(motor, scene.body("left"), axis=(1, 0, 0), second_axis=(0, 0, 1), name="coupling"))
    return scene


def speed_at(time: np.ndarray, size: Size) -> np.ndarray:
    """[rad/s] at times [s] of the run-up."""
    low, high = (RPM * n for n in size.speeds)
    return low + (high - low) * np.asarray(time) / size.duration


def run_up(shaft: wf.ReducedBody, size: Size = FULL, *, progress: bool = True) -> wf.Result:
    low, high = (RPM * n for n in size.speeds)
    scene = build(shaft, low, size=size, run_up=wf.signals.Ramp(low, high, duration=size.duration))
    step = 2.0 * np.pi / (high * size.steps)
    return wf.simulate(scene, size.duration, step=step, start="equilibrium", progress=progress)


@dataclass(frozen=True)
class Held:
    """At `speeds` (n,) [rad/s] that are held: stiffness [N/m] and damping [N s/m] (n, 2, 2) of a bearing for
    synchronous motion, hottest oil (n, 4) [degrees Celsius] of its pads."""

    speeds: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    hottest: np.ndarray


def rigid_bearings() -> float:
    """Critical speed [rad/s] in rigid bearings: a bar with shear, 17/35 of whose mass swing with the disc."""
    E, nu, area = STEEL.youngs_modulus, STEEL.poisson_ratio, np.pi * RADIUS**2
    flexibility = SPAN**3 / (12.0 * np.pi * E * RADIUS**4) + SPAN / (4.0 * 0.9 * E / (2.0 * (1.0 + nu)) * area)
    return float((flexibility * (DISC + 17.0 / 35.0 * STEEL.density * area * SPAN)) ** -0.5)


def angle(time: Any, size: Size) -> Any:
    """Of the unbalance from e_0 [rad]: it begins along +x, which is -e_1."""
    low = speed_at(np.zeros(1), size)[0]
    return 0.5 * (low + speed_at(time, size)) * time - 0.5 * np.pi


def held_speeds(shaft: wf.ReducedBody, size: Size = FULL) -> Held:
    """Coefficients of a bearing about the equilibria at `places` speeds of the run-up."""
    speeds, found, hottest = speed_at(np.linspace(0.0, size.duration, size.places), size), [], []
    for speed in speeds:
        rest = wf.equilibrium(build(shaft, speed, size=size), progress=False, check=True)
        found.append(rest.bearing_coefficients(f"{BEARINGS[0]} bearing"))
        hottest.append(pad_temperatures(rest)[-1])
    stiffness, damping = (np.array([getattr(each, name) for each in found]) for name in ("stiffness", "damping"))
    return Held(speeds, stiffness, damping, np.array(hottest))


def pad_temperatures(result: wf.Result) -> np.ndarray:
    """Hottest oil (T, 4) [degrees Celsius] of the pads on the left."""
    films = (result.film(f"{BEARINGS[0]} bearing pad {i}") for i in (1, 2, 3, 4))
    return np.stack([film.temperature.max(axis=(1, 2)) for film in films], axis=1)


def motion(result: wf.Result) -> np.ndarray:
    """Places (T, 2) [m] of the left journal and of the disc, e_0 + i e_1."""
    places = [result.body(name).position for name in (BEARINGS[0], "disc")]
    return np.stack([-at[:, 2] - 1j * at[:, 0] for at in places], axis=1)


def whirl(time: np.ndarray, places: np.ndarray, size: Size) -> tuple[np.ndarray, np.ndarray]:
    """Forward whirl of motions (T, 2), means over each revolution: speeds (n,) [rad/s], amplitudes (n, 2) [m]."""
    turned = angle(time, size)
    ends = np.arange(turned[0] + 2.0 * np.pi, turned[-1], 2.0 * np.pi)
    middle = np.interp(ends - np.pi, turned, time)
    against = places * np.exp(-1j * turned)[:, None]
    steps = np.diff(turned)[:, None]  # mean over the angle, by trapezia
    whole = np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * steps * (against[1:] + against[:-1]), axis=0)])
    up_to = [np.stack([np.interp(end, turned, c) for c in whole.T], axis=1) for end in (ends, ends - 2.0 * np.pi)]
    return speed_at(middle, size), (up_to[0] - up_to[1]) / (2.0 * np.pi)


def main(out: str | Path = "out/tilting_pads", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write tilting_pads.h5, .rrd and .png into the folder `out` and print the figures; quick: a shorter run-up."""
    stem, size = Path(out) / "tilting_pads", QUICK if quick else FULL
    shaft = flexible_shaft(progress=progress)
    held, result = held_speeds(shaft, size), run_up(shaft, size, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=24 if quick else 60, max_points=1000, overwrite=True)

    time, places, heat, um = result.time, motion(result), pad_temperatures(result), 1e6
    speeds, found = whirl(time, places, size)
    peak = int(np.abs(found[:, 1]).argmax())
    turned = angle(time, size)
    near = np.abs(turned - np.interp(speeds[peak], speed_at(time, size), turned)) < 1.07 * np.pi
    orbits = {name: places[near, i] - places[near, i].mean() for i, name in enumerate(("journal", "disc"))}
    rpm, at, K = speeds / RPM / 1e3, held.speeds / RPM / 1e3, held.stiffness / 1e6
    wC = held.damping * held.speeds[:, None, None] / 1e6
    save_panels([
        Panel("Whirl with the unbalance", "speed [1000 rpm]", "amplitude [µm]",
              {"disc": (rpm, um * np.abs(found[:, 1])), "journal": (rpm, um * np.abs(found[:, 0]))}),
        Panel(f"Orbits at {speeds[peak] / RPM:.0f} rpm", "down [µm]", "with the rotation [µm]",
              {name: (um * each.real, um * each.imag) for name, each in orbits.items()}, equal=True),
        Panel("Hottest oil of the pads on the left", "speed [1000 rpm]", "[°C]",
              {f"pad {i + 1}": (speed_at(time, size) / RPM / 1e3, heat[:, i]) for i in range(4)},
              points={"each speed held": (np.repeat(at, 4), held.hottest.ravel())},
              limits=(float(np.floor(heat.min())), float(np.ceil(heat.max())))),
        Panel("A bearing: coefficients of synchronous motion", "speed [1000 rpm]", "[MN/m]",
              {"stiffness, down": (at, K[:, 0, 0]), "speed x damping, down": (at, wC[:, 0, 0])}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    journal, disc = um * np.abs(found).max(axis=0)
    print(f"critical speed {speeds[peak] / RPM:.0f} rpm, in rigid bearings {rigid_bearings() / RPM:.0f} rpm")
    print(f"whirl up to {disc:.2f} um of the disc, {journal:.2f} um of the journals")
    print(f"hottest oil {heat[0].max():.2f} to {heat[-1].max():.2f} degC, "
          f"each speed held {held.hottest[0].max():.2f} to {held.hottest[-1].max():.2f} degC")  # fmt: skip
    return [result]


if __name__ == "__main__":
    main()
