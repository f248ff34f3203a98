r"""How far do the tolerances of a roller bearing move its loads, its pressures and its life? A cloud of bearings.

An NU 2210 cylindrical roller bearing carries 12 kN. What is made and mounted scatters: the clearance as mounted
(20 um, standard deviation 5 um), the ovality of the outer raceway (an amplitude of 1 um, positive where its long axis
is the direction of the load), and the misalignment of the rings (0.5 mrad). A Latin hypercube draws 64 bearings, or
4,096 on a GPU. Each is brought to its equilibrium and keeps the largest load of a roller, the largest pressure on a
lamina, the displacement of the shaft, and the reference life of ISO/TS 16281.

What to expect. Rigid rings approach each other at the angle psi from the load by

    delta = d cos(psi) - c/2 - a cos(2 psi),

d the displacement of the shaft, c the clearance, a the ovality. More clearance leaves fewer rollers in the loaded zone,
and larger loads; a raceway that is long along the load widens the zone and relieves them. The shaft sinks by d, which
is linear over the scatter: the Sobol index of a tolerance x, of first order and total, is then

    S_x = (b_x sigma_x)^2 / sum (b sigma)^2,      b_x the derivative of d by x.

Misalignment leaves the loads alone but presses the ends of the rollers, which costs life, whatever its sign: this is
of second order, and no straight line through the cloud shows it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.online.device import chosen_device
from warpffrf.output.plots.panels import Panel, save_panels

NAME, LOAD = "NU 2210", 12e3  # N
PLAY = 2e-4  # m, of the rollers between their flanges
SCATTER = {
    "clearance": "normal(20e-6, 5e-6)",  # m
    "ovality": "normal(0, 1e-6)",  # m, amplitude
    "tilt": "normal(0, 5e-4)",  # rad
}
WORKERS = 2


@dataclass(frozen=True)
class Size:
    """So many bearings, of which `worlds` run at once as worlds of one graph."""

    bearings: int = 64
    worlds: int = 1


FULL, QUICK, ON_A_GPU = Size(), Size(16), Size(4096, worlds=1024)


def build(clearance: float, ovality: float, tilt: float) -> wf.Scene:
    """The scene of a row: bearing `NU 2210` on the ground, force `load` on its inner ring. Diametral clearance [m];
    amplitude of the ovality [m], positive: the outer raceway is wider along the load; tilt [rad] of the inner ring
    about the horizontal axis."""
    scene = wf.Scene()
    geometry = wf.bearings.catalogue(
        NAME, clearance=clearance, outer_form=wf.films.LobedForm(amplitude=ovality, count=2)
    )
    bearing = scene.add_bearing(
        NAME, geometry, first=(0, 0, -1), outer=scene.ground, flanges=wf.bearings.Flanges(PLAY),
        contact=wf.bearings.RollingContact(law=wf.laws.IsoLamina(geometry.roller_length)),
    )  # fmt: skip
    inner: Any = bearing.inner
    inner.rotation = np.array([np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt)])
    # along its own axis: about another one it would rotate to where it tilts the rollers under the load least
    axis = (0.0, np.cos(tilt), np.sin(tilt))
    scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), inner, axis=axis, name="plane"))
    scene.add(wf.forces.PointForce(inner, (0, 0, -LOAD), name="load"))
    return scene


def largest_load(run: wf.Result) -> float:
    """kN, of a roller on the inner ring."""
    return float(run.bearing(NAME).inner_load[-1].max()) / 1e3


def largest_pressure(run: wf.Result) -> float:
    """MPa, on a lamina of the inner ring."""
    return float(run.bearing(NAME).lamina_pressure["inner"][-1].max()) / 1e6


def reference_life(run: wf.Result) -> float:
    """10^6 revolutions, of ISO/TS 16281."""
    return float(run.bearing(NAME).reference_life().revolutions)


FORCE, PRESSURE, LIFE = "largest load [kN]", "largest pressure [MPa]", "life [10^6 revolutions]"
SHOWN = {FORCE: largest_load, PRESSURE: largest_pressure, LIFE: reference_life}
SINKS = "displacement"  # of the shaft


def cloud(store: str | Path, size: Size = FULL, *, workers: int = WORKERS, seed: int = 0, progress: bool = True) -> Any:
    """The sweep: its rows are computed by `workers` processes and kept in the folder `store`."""
    outputs = {**SHOWN, SINKS: f"last(body_position_z[{NAME} inner ring])"}
    return wf.study.sweep(
        build, SCATTER, sample=f"latin:{size.bearings}:{seed}", outputs=outputs, run=wf.equilibrium, store=store,
        workers=workers, worlds=size.worlds, overwrite=True, progress=progress,
    )  # fmt: skip


def main(out: str | Path = "out/tolerance_cloud", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write the sweep tolerance_cloud.sweep, its page tolerance_cloud.html and picture, and tolerance_cloud.h5 and .rrd
    of the bearing with the shortest life, into the folder `out`, and print the figures; quick: 16 bearings instead of
    64, which are 4,096 if the default device (`WARPFFRF_DEVICE`) is a GPU."""
    stem = Path(out) / "tolerance_cloud"
    gpu = chosen_device(None) != "cpu"
    size = QUICK if quick else ON_A_GPU if gpu else FULL
    found = cloud(f"{stem}.sweep", size, workers=1 if gpu else WORKERS, progress=progress)
    found.page(f"{stem}.html", overwrite=True)
    ran = found["status"] == "completed"
    for row in found.failed():
        print(f"bearing {row['run']}: {row['message']}")
    worst = int(np.flatnonzero(ran)[np.argmin(found[LIFE][ran])])
    result = wf.equilibrium(build(**{name: float(found[name][worst]) for name in SCATTER}), progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", overwrite=True)

    drawn: list[Any] = []
    for name in SHOWN:
        values = np.sort(found[name][ran])
        share = (np.arange(len(values)) + 0.5) / len(values) * 100.0
        drawn.append(Panel("Share of bearings below", name, "[%]", {"bearings": (values, share)}))
    indices = {name: found.sensitivities(name) for name in SHOWN}
    save_panels([*drawn, *indices.values()], f"{stem}.png", overwrite=True)

    for name, of in indices.items():
        low, high = np.quantile(found[name][ran], [0.1, 0.9])
        shares = ", ".join(f"{p} {total:.2f}" for p, total in zip(SCATTER, of.total, strict=True))
        print(f"{name:24} mean {found[name][ran].mean():6.4g}, 10 % below {low:6.4g}, 10 % above {high:6.4g}; "
              f"total indices: {shares}")  # fmt: skip
    seconds = found["wall_seconds"][ran]
    print(f"{len(seconds)} bearings on {found['device'][worst]}, {np.median(seconds):.2f} s each with set-up")
    return [result]


if __name__ == "__main__":
    main()
