r"""A spall on a raceway of a ball bearing: the envelope spectrum of the housing's acceleration shows on which one.

The bearing 6205 of the bearing data centre of Case Western Reserve University at 1,797 rpm, under 1 kN. Its outer ring
is in a housing on elastic feet, with an accelerometer; the inner ring, which carries the load, rotates. The spall is
1 mm long and 5 um deep over the whole width of the groove: in one run on the outer raceway, under the load, in another
on the inner one.

**Frequencies.** Rolling without slip, gamma = d/D (diameters of balls and pitch circle), a point of the outer and of
the inner raceway meets Z balls at

    BPFO = Z/2 (1 - gamma) f,        BPFI = Z/2 (1 + gamma) f,

f the rotation of the shaft: 3.585 and 5.415 times per revolution. Impacts excite housing and bearing at 1 to 7 kHz,
in a spectrum of many lines; their repetition is a line of the envelope there, the magnitude of the analytic signal in
a band of frequencies. A spall of the inner ring passes the load once per revolution and is not loaded on the other
side: BPFI has sidebands at the distance f, and f itself is a line.

**What is modelled.** A ball follows the hollow, which must be curved less than it. Balls and cage are driven by
friction, so that they lag behind rolling by some 0.05 %, the slip of the balls outside of the load zone. The damping of
the contacts lets these balls come to rest between the rings.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=206e9, poisson_ratio=0.3, density=7850, name="steel")
NAME, SIDES = "6205", ("outer", "inner")
COUNT, BALL, PITCH = 9, 7.94e-3, 39.04e-3  # balls; m: diameters
SPEED, LOAD = 1797.0 * np.pi / 30.0, 1000.0  # rad/s, N
DAMPING = 20.0  # s/m of the contacts
LENGTH, DEPTH = 1e-3, 5e-6  # m, of the spall
TRACTION = wf.laws.RegularisedCoulomb(0.06, 0.01)
HOUSING, FEET, FEET_DAMPING = 2.0, 1e8, 1e3  # kg, N/m, N s/m
BAND = (2e3, 10e3)  # Hz, of the envelope
SETTLED, HIGHEST = 0.01, 750.0  # s; Hz, of the picture


@dataclass(frozen=True)
class Size:
    """Duration and step [s]; steps per saved row."""

    duration: float = 0.4
    step: float = 2e-5
    save_every: int = 2


FULL, QUICK = Size(), Size(duration=0.25, step=4e-5, save_every=1)


def build(side: str) -> wf.Scene:
    """The scene, with the spall on the raceway "outer" or "inner": bearing `6205`, body `housing` with the sensor
    `accelerometer`, joint `plane`, drive `drive`, force `load`."""
    scene = wf.Scene(gravity=(0, 0, 0))
    housing = scene.add_rigid_body(HOUSING, np.eye(3) * 2e-3, name="housing")
    raceway = 0.5 * (PITCH + (BALL if side == "outer" else -BALL))
    spall = wf.films.WornForm(depth=DEPTH, theta=0.0, width=0.5 * LENGTH / raceway)
    bearing = scene.add_bearing(
        NAME,
        wf.bearings.BallGeometry(
            elements=COUNT, ball_diameter=BALL, pitch_diameter=PITCH, clearance=5e-6,
            outer_form=spall if side == "outer" else None, inner_form=spall if side == "inner" else None,
        ),
        first=(0, 0, -1), outer=housing, cage=wf.bearings.PocketCage(0.1e-3, friction=TRACTION),
        contact=wf.bearings.RollingContact(friction=TRACTION, law=wf.laws.HertzPoint(STEEL, STEEL, damping=DAMPING)),
        materials=STEEL,
    )  # fmt: skip
    shaft: Any = bearing.inner
    stiffness, damping = (FEET,) * 3 + (1e5,) * 3, (FEET_DAMPING,) * 3 + (1.0,) * 3
    scene.add(wf.forces.Bushing(scene.ground.at((0, 0, 0)), housing, stiffness, damping, name="feet"))
    plane = scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), shaft, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, SPEED, name="drive"))
    scene.add(wf.forces.PointForce(shaft, (0, 0, -LOAD), name="load"))
    scene.add(wf.sensors.Acceleration(housing, name="accelerometer"))
    bearing.roll(SPEED, angle=0.0)
    return scene


def envelope(result: wf.Result) -> Any:
    """Spectrum of the envelope of the vertical acceleration of the housing."""
    return result.since(SETTLED).spectrum("sensor_z[accelerometer]", envelope=BAND)


def expected(side: str) -> dict[str, np.ndarray]:
    """Frequencies [Hz] of lines of the envelope with the spall on the raceway `side`, by their names."""
    found, shaft = build(side).bearing(NAME).defect_frequencies(SPEED, angle=0.0), SPEED / (2.0 * np.pi)
    if side == "outer":
        return {"multiples of BPFO": np.arange(1, 7) * found.bpfo}
    multiples = np.arange(1, 5) * found.bpfi
    sidebands = multiples[:, None] + shaft * np.array([-1, 1, -2, 2])
    return {"multiples of BPFI": multiples, "sidebands at the speed of the shaft": sidebands.ravel(),
            "shaft": np.array([shaft])}  # fmt: skip


def line(spectrum: Any, frequency: float) -> tuple[float, float]:
    """Frequency [Hz] and amplitude [m/s2] of the line next to `frequency` [Hz]."""
    return min(spectrum.peaks(60), key=lambda peak: abs(peak[0] - frequency))


def panels(results: dict[str, wf.Result]) -> list[Panel]:
    """Acceleration, its spectrum and that of its envelope, of both runs."""
    found = []
    for side, result in results.items():
        part = result.since(SETTLED)
        t, a = part.time, part.sensor("accelerometer").values[:, 2]
        few, plain, of_envelope = t < SETTLED + 4.0 * np.pi / SPEED, part.spectrum(a), envelope(result)
        shown = plain.place < BAND[1]
        low = of_envelope.place < HIGHEST
        x, y = of_envelope.place[low], of_envelope.amplitude[low]
        marks = {name: (places, np.interp(places, x, y)) for name, places in expected(side).items()}
        found += [
            Panel(f"Spall of the {side} raceway: two revolutions", "time [ms]", "acceleration [m/s²]",
                  {"housing": (t[few] * 1e3, a[few])}),
            Panel("Its spectrum", "frequency [kHz]", "[m/s²]",
                  {"housing": (plain.place[shown] / 1e3, plain.amplitude[shown])}),
            Panel(f"Spectrum of its envelope from {BAND[0] / 1e3:g} to {BAND[1] / 1e3:g} kHz", "frequency [Hz]",
                  "[m/s²]", {"housing": (x, y)}, points=marks),
        ]  # fmt: skip
    return found


def main(out: str | Path = "out/raceway_defect", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write raceway_defect.h5, .rrd and .png, and the run with the inner raceway, .inner.h5, into the folder `out` and
    print the figures; quick: shorter, in longer steps."""
    stem, size, results = Path(out) / "raceway_defect", QUICK if quick else FULL, {}
    for side in SIDES:
        options = wf.RunOptions(save_every=size.save_every)
        result = wf.simulate(
            build(side), size.duration, step=size.step, start="equilibrium", options=options, progress=progress
        )
        result.save(f"{stem}{'' if side == 'outer' else '.inner'}.h5", overwrite=True)
        results[side], found = result, envelope(result)
        for name, places in expected(side).items():
            for frequency in places[:3]:
                place, amplitude = line(found, frequency)
                print(f"{side} raceway: line at {place:7.2f} Hz, {amplitude:6.3f} m/s2   {name}: {frequency:7.2f}")
    wf.record(results["outer"], f"{stem}.rrd", max_frames=60 if quick else 240, overwrite=True)
    save_panels(panels(results), f"{stem}.png", overwrite=True)
    return list(results.values())


if __name__ == "__main__":
    main()
