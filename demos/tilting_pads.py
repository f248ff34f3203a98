r"""A flexible shaft on two tilting-pad bearings runs up through its critical speed, on warm oil.

A disc is in the middle of a slender shaft, and rigid journals at its ends run in four tilting pads each, whose oil
heats up: what leaves a pad enters the next one. The films are stiffer than the shaft and damp its bending, so that the
unbalance of the disc has a resonance somewhat below the critical speed in rigid bearings.

**By hand.** Both bearings and halves of the shaft move alike. With the displacement u of the journals and the bending b
of the middle against them, the shaft in between moves by u + phi b, phi = 3 s - 4 s^3 with s from 0 at an end to 1/2,
and the disc by u + b. The means of phi and phi^2 are 5/8 and 17/35; so, with the masses m_d of the disc, m_s of the
shaft and 2 m_j of the journals, the stiffness k of the shaft and K + i w C of each bearing, an unbalance m_d e at the
speed w causes

    [ 2 (K + i w C) - w^2 (m_d + m_s + 2 m_j)     -w^2 (m_d + 5/8 m_s)   ] [u]
    [ -w^2 (m_d + 5/8 m_s)                    k - w^2 (m_d + 17/35 m_s)  ] [b]  =  m_d e w^2 [1; 1] (1, i)^T,

in two directions each; K and C are those of synchronous motion, of pads that follow it, at the temperatures of each
speed. During the run-up, w = w_0 + a t, the same masses and stiffnesses are integrated in time.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

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
    """Speeds of the run-up [rpm], its duration [s], steps per revolution at its end, nodes of the film of a pad, speeds
    with coefficients."""

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


def build(shaft: wf.ReducedBody, speed: float, *, off: float = OFF, size: Size = FULL, run_up: Any = None) -> wf.Scene:
    """The scene at `speed` [rad/s], run_up: speed over time; bodies `shaft`, `disc`, `left`, `right`, bearings
    `left bearing` and `right bearing`."""
    scene, spin = wf.Scene(gravity=(0, 0, -9.81)), (0, speed, 0)
    bent = scene.add_body(shaft, name="shaft", angular_velocity=spin)
    disc = scene.add_rigid_body(
        DISC, (0.15, 0.25, 0.15), name="disc", center_of_mass=(off, 0, 0), angular_velocity=spin,
        surfaces={"rim": wf.surfaces.Cylinder(radius=0.1, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))},
    )  # fmt: skip
    scene.add(wf.joints.Fixed(bent["seat"], disc, name="hub"))
    for name, end, place in zip(BEARINGS, ("end_low", "end_high"), (-0.5 * SPAN, 0.5 * SPAN), strict=True):
        inertia = JOURNAL * RADIUS**2
        journal = scene.add_rigid_body(
            JOURNAL, (0.5 * inertia, 0.5 * inertia, 0.5 * inertia), name=name, position=(0, place, 0),
            angular_velocity=spin,
            surfaces={"journal": wf.surfaces.Cylinder(
                radius=RADIUS, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)
            )},
        )  # fmt: skip
        scene.add(wf.joints.Fixed(bent[end], journal, name=f"{name} seat"))
        scene.add_journal_bearing(
            f"{name} bearing", journal["journal"], wf.films.pads(4, ARC, first=0.25 * np.pi, preload=PRELOAD),
            clearance=CLEARANCE, length=WIDTH, oil=OIL, position=(0, place, 0),
            tilting=wf.films.TiltingPads(THICKNESS, pivot="point"),
            first=(0, 0, -1), nodes=size.nodes, temperature=wf.films.FilmTemperature(SUPPLY, wall_b=SHAFT),
        )  # fmt: skip
    motor = scene.add_rigid_body(
        0.02, (1e-4, 1e-4, 1e-4), name="motor", position=(0, -0.5 * SPAN, 0), angular_velocity=spin
    )
    plane = scene.add(wf.joints.Planar(scene.ground, motor, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, speed if run_up is None else run_up, quantity="velocity", name="drive"))
    scene.add(wf.joints.Universal(
        motor, scene.body("left"), axis=(1, 0, 0), second_axis=(0, 0, 1), name="coupling"
    ))  # fmt: skip
    return scene


def speed_at(time: np.ndarray, size: Size) -> np.ndarray:
    """[rad/s] at times [s] of the run-up."""
    low, high = (RPM * n for n in size.speeds)
    return low + (high - low) * np.asarray(time) / size.duration


def run_up(shaft: wf.ReducedBody, size: Size = FULL, *, progress: bool = True) -> wf.Result:
    """From the equilibrium at the lowest speed to the highest."""
    low, high = speed_at(np.array([0.0, size.duration]), size)
    scene = build(shaft, low, size=size, run_up=wf.signals.Ramp(low, high, duration=size.duration))
    step = 2.0 * np.pi / (high * size.steps)
    return wf.simulate(scene, size.duration, step=step, start="equilibrium", progress=progress)


@dataclass(frozen=True)
class Linear:
    """The rotor by hand at `speeds` (n,) [rad/s]: stiffness [N/m] and damping [N s/m] (n, 2, 2) of a bearing, hottest
    oil (n, 4) [degrees Celsius] of its pads at rest."""

    speeds: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    hottest: np.ndarray

    @property
    def shaft(self) -> tuple[float, float]:
        """Stiffness [N/m], with shear, and mass [kg]."""
        E, nu, area = STEEL.youngs_modulus, STEEL.poisson_ratio, np.pi * RADIUS**2
        shear = SPAN / (4.0 * 0.9 * E / (2.0 * (1.0 + nu)) * area)
        return 1.0 / (SPAN**3 / (12.0 * np.pi * E * RADIUS**4) + shear), STEEL.density * area * SPAN

    @property
    def rigid_bearings(self) -> float:
        """Critical speed [rad/s]."""
        k, m = self.shaft
        return float(np.sqrt(k / (DISC + 17.0 / 35.0 * m)))

    def matrices(self, speed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Mass [kg], damping [N s/m] and stiffness [N/m] (4, 4) of u and b, each along e_0 and e_1."""
        k, m = self.shaft
        coupled = DISC + 0.625 * m
        mass = np.array([[DISC + m + 2.0 * JOURNAL, coupled], [coupled, DISC + 17.0 / 35.0 * m]])
        C, K = np.zeros((4, 4)), np.diag([0.0, 0.0, k, k])
        for matrix, given in ((C, self.damping), (K, self.stiffness)):
            flat = given.reshape(len(self.speeds), 4)
            matrix[:2, :2] += 2.0 * np.array([np.interp(speed, self.speeds, f) for f in flat.T]).reshape(2, 2)
        return np.kron(mass, np.eye(2)), C, K

    def steady(self, speeds: np.ndarray) -> np.ndarray:
        """Forward whirl (n, 2) [m] of the journals and of the disc, complex, in the directions of the unbalance."""
        found = []
        for w in speeds:
            M, C, K = self.matrices(w)
            x = np.linalg.solve(K + 1j * w * C - w**2 * M, DISC * OFF * w**2 * np.array([1.0, -1j, 1.0, -1j]))
            u, b = (0.5 * (x[i] + 1j * x[i + 1]) for i in (0, 2))
            found.append((u, u + b))
        return np.array(found)

    def passing(self, time: np.ndarray, size: Size) -> np.ndarray:
        """Motion (T, 2) [m] of the journals and of the disc during the run-up, e_0 + i e_1."""
        acceleration = float(np.diff(speed_at(np.array([0.0, 1.0]), size))[0])

        def rates(t: float, state: np.ndarray) -> np.ndarray:
            w = float(speed_at(np.array(t), size))
            M, C, K = self.matrices(w)
            thrown = DISC * OFF * (w**2 - 1j * acceleration) * np.exp(1j * angle(t, size))
            force = np.array([thrown.real, thrown.imag] * 2)
            return np.concatenate([state[4:], np.linalg.solve(M, force - C @ state[4:] - K @ state[:4])])

        x = solve_ivp(rates, (0.0, time[-1]), np.zeros(8), "LSODA", time, rtol=1e-6, atol=1e-10).y
        u, b = x[0] + 1j * x[1], x[2] + 1j * x[3]
        return np.stack([u, u + b], axis=1)


def angle(time: Any, size: Size) -> Any:
    """Of the unbalance from e_0 [rad]: it begins along +x, which is -e_1."""
    low = speed_at(np.zeros(1), size)[0]
    return 0.5 * (low + speed_at(time, size)) * time - 0.5 * np.pi


def linear(shaft: wf.ReducedBody, size: Size = FULL) -> Linear:
    """Coefficients of a bearing about the equilibria at `places` speeds of the run-up. Raises RuntimeError where there
    is none."""
    speeds, found, hottest = speed_at(np.linspace(0.0, size.duration, size.places), size), [], []
    for speed in speeds:
        rest = wf.equilibrium(build(shaft, speed, size=size), progress=False)
        if rest.status != wf.Status.COMPLETED:
            raise RuntimeError(f"no equilibrium at {speed:g} rad/s: {rest.message}")
        found.append(rest.bearing_coefficients(f"{BEARINGS[0]} bearing"))
        hottest.append(pad_temperatures(rest)[-1])
    stiffness, damping = (np.array([getattr(each, name) for each in found]) for name in ("stiffness", "damping"))
    return Linear(speeds, stiffness, damping, np.array(hottest))


def pad_temperatures(result: wf.Result) -> np.ndarray:
    """Hottest oil (T, 4) [degrees Celsius] of the pads on the left."""
    films = [result.film(f"{BEARINGS[0]} bearing pad {i}") for i in (1, 2, 3, 4)]
    return np.stack([film.temperature.max(axis=(1, 2)) for film in films], axis=1)


def motion(result: wf.Result) -> np.ndarray:
    """Places (T, 2) [m] of the left journal and of the disc, e_0 + i e_1."""
    places = [result.body(name).position for name in (BEARINGS[0], "disc")]
    return np.stack([-at[:, 2] - 1j * at[:, 0] for at in places], axis=1)


def whirl(time: np.ndarray, places: np.ndarray, size: Size) -> tuple[np.ndarray, np.ndarray]:
    """Forward whirl of motions (T, 2) at even times, a mean over each revolution in turn: speeds (n,) [rad/s] and
    amplitudes (n, 2) [m], complex."""
    turned = angle(time, size)
    ends = np.arange(turned[0] + 2.0 * np.pi, turned[-1], 2.0 * np.pi)
    middle = np.interp(ends - np.pi, turned, time)
    against = places * np.exp(-1j * turned)[:, None]
    steps = np.diff(turned)[:, None]  # mean over the angle, by trapezia
    whole = np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * steps * (against[1:] + against[:-1]), axis=0)])

    def up_to(end: np.ndarray) -> np.ndarray:
        return np.stack([np.interp(end, turned, column) for column in whole.T], axis=1)

    return speed_at(middle, size), (up_to(ends) - up_to(ends - 2.0 * np.pi)) / (2.0 * np.pi)


def main(out: str | Path = "out/tilting_pads", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write tilting_pads.h5, .rrd and .png into the folder `out` and print the figures; quick: a shorter run-up."""
    stem, size = Path(out) / "tilting_pads", QUICK if quick else FULL
    shaft = flexible_shaft(progress=progress)
    film, result = linear(shaft, size), run_up(shaft, size, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=24 if quick else 60, max_points=1000, overwrite=True)

    time, places = result.time, motion(result)
    by_hand = film.passing(time, size)
    (speeds, found), (_, passing) = whirl(time, places, size), whirl(time, by_hand, size)
    steady, heat = film.steady(speeds), pad_temperatures(result)
    peak = int(np.abs(found[:, 1]).argmax())
    turned = angle(time, size)
    near = np.abs(turned - np.interp(speeds[peak], speed_at(time, size), turned)) < np.pi
    orbits = {name: each[near, 1] - each[near, 1].mean() for name, each in (("run", places), ("by hand", by_hand))}
    rpm, um = speeds / RPM / 1e3, 1e6
    closed = {name: np.append(orbit, orbit[0]) for name, orbit in orbits.items()}
    orbits = {name: (um * np.real(orbit), um * np.imag(orbit)) for name, orbit in closed.items()}
    K, wC = film.stiffness / 1e6, film.damping * film.speeds[:, None, None] / 1e6
    save_panels([
        Panel("Whirl with the unbalance", "speed [1000 rpm]", "amplitude [µm]",
              {"disc": (rpm, um * np.abs(found[:, 1])), "journal": (rpm, um * np.abs(found[:, 0]))},
              {"disc, by hand": (rpm, um * np.abs(passing[:, 1])),
               "disc, by hand, each speed held": (rpm, um * np.abs(steady[:, 1])),
               "journal, by hand": (rpm, um * np.abs(passing[:, 0]))}),
        Panel(f"Orbit of the disc at {speeds[peak] / RPM:.0f} rpm", "down [µm]", "with the rotation [µm]",
              {"run": orbits["run"]}, {"by hand": orbits["by hand"]}, equal=True),
        Panel("Hottest oil of the pads on the left", "speed [1000 rpm]", "[°C]",
              {f"pad {i + 1}": (speed_at(time, size) / RPM / 1e3, heat[:, i]) for i in range(4)},
              points={"each speed held": (np.repeat(film.speeds / RPM / 1e3, 4), film.hottest.ravel())},
              limits=(float(np.floor(heat.min())), float(np.ceil(heat.max())))),
        Panel("A bearing: coefficients of synchronous motion", "speed [1000 rpm]", "[MN/m]",
              {"stiffness, down": (film.speeds / RPM / 1e3, K[:, 0, 0]),
               "speed x damping, down": (film.speeds / RPM / 1e3, wC[:, 0, 0]),
               "stiffness, across by down": (film.speeds / RPM / 1e3, K[:, 1, 0])}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    worst = np.abs(np.abs(found) - np.abs(passing)).max(axis=0) / np.abs(passing).max(axis=0)
    passed, held = (speeds[np.abs(each[:, 1]).argmax()] / RPM for each in (passing, steady))
    print(f"critical speed {speeds[peak] / RPM:.0f} rpm, by hand {passed:.0f} rpm, each speed held {held:.0f} rpm, "
          f"rigid bearings {film.rigid_bearings / RPM:.0f} rpm")  # fmt: skip
    for i, name in enumerate(("journal", "disc")):
        print(f"{name:7s} whirls with up to {um * np.abs(found[:, i]).max():.2f} um, by hand "
              f"{um * np.abs(passing[:, i]).max():.2f} um, at most {worst[i]:.1%} of it apart")  # fmt: skip
    print(f"hottest oil {heat[0].max():.2f} to {heat[-1].max():.2f} degC, "
          f"each speed held {film.hottest[0].max():.2f} to {film.hottest[-1].max():.2f} degC")  # fmt: skip
    return [result]


if __name__ == "__main__":
    main()
