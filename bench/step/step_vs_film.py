"""Step time against nodes of an oil film: `python bench/step/step_vs_film.py [--json FILE] [--steps N]`.

The big end of the connecting rod of the demo, in the cycle of a four-stroke engine, and a shaft in a steel sleeve
under a load that turns, of which film and bore have so many nodes, once with a temperature of the film (warm). Both
bores deform by a part of their films. Times are those of the graph, after a start that does not count; *full* are
nodes that are no cavities, on average.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from demos import connecting_rod
from scenes import film_bearing
from scenes.film_bearing import GROOVE, SPEED, TURN, Load
from warpffrf.model import films, oils
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.scene import Scene
from warpffrf.online import run
from warpffrf.study.machine import machine

GRIDS = ((32, 7), (64, 9), (128, 17))
LOAD, STEADY = 8e3, 2e3  # N: that turns with half the shaft, and along e_0
PER_TURN = 180  # steps
START = 20  # steps that do not count, of a sleeve; of the rod up to the ignition
START_OF_ROD = 300
INTEGRATOR = GeneralizedAlpha(connecting_rod.RHO_INF)


def sleeve(grid_nodes: tuple[int, int], turns: float, warm: bool = False) -> Scene:
    """A shaft in a sleeve with so many nodes, for so many turns; warm: with a temperature of its film."""
    t = np.linspace(0.0, (turns + 1.0) * TURN, round(72 * (turns + 1)) + 1)
    load = (
        Load(t, LOAD * np.cos(0.5 * SPEED * t) + STEADY, cubic=True),
        Load(t, LOAD * np.sin(0.5 * SPEED * t), cubic=True),
    )
    thermal = oils.Thermal(oils.ExponentialLaw(0.03), 40.0, 2000.0)
    given: dict[str, Any] = {"feeds": [GROOVE]}
    if warm:
        given |= {
            "oil": oils.Newtonian(film_bearing.VISCOSITY, thermal=thermal),
            "temperature": films.FilmTemperature(40.0, wall_a=45.0),
        }
    return film_bearing.bearing(film_bearing.bore(grid_nodes), load, **given)


def timed(scene: Scene, step: float, first: int, steps: int) -> dict[str, Any]:
    """A run of `first` steps, and one of `steps` that continues it."""
    start = run(scene, first * step, step=step, integrator=INTEGRATOR, progress=False)
    found = run(scene, steps * step, step=step, start=start, integrator=INTEGRATOR, progress=False)
    grid, film = scene.films[0].grid, next(iter(found.films.values()))
    return {
        "grid_nodes": (grid.columns, grid.rows), "full": float(np.mean(np.sum(film.pressure > 0.0, axis=(1, 2)))),
        "iterations": float(found.iterations[1:].mean()), "status": found.status,
        "seconds_per_step": float(found.counters["seconds_in_graph"]) / steps,
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=120)
    given = parser.parse_args()
    about = machine()
    rod = connecting_rod.machine(connecting_rod.rod_body(progress=False))
    degree = np.radians(1.0) / connecting_rod.SPEED
    cases = [("rod", rod, degree, START_OF_ROD)]
    turns, step = given.steps / PER_TURN, TURN / PER_TURN
    cases += [("sleeve", sleeve(grid, turns), step, START) for grid in GRIDS]
    cases.append(("warm", sleeve(GRIDS[1], turns, warm=True), step, START))
    print(" body    nodes      full  iterations    us/step     U/step  status")
    rows = []
    for name, scene, step, first in cases:
        unit = machine()["unit_seconds"]
        found = timed(scene, step, first, given.steps)
        rows.append({"table": "film", "name": name, "unit_seconds": unit, **found})
        columns, along = found["grid_nodes"]
        seconds = found["seconds_per_step"]
        print(
            f"{name:>7} {columns:4d} x {along:2d} {found['full']:7.1f} {found['iterations']:9.2f}"
            f" {seconds * 1e6:12.1f} {seconds / unit:10.2f}  {found['status']}"
        )
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
