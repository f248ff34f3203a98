"""Step time with membrane energy: `python bench/step/step_vs_membrane.py [--json FILE] [--steps N] [--rounds N]`.

A plate in a rigid rim that vibrates, with the same modes: linear, stiffened by loads on its rim, and with the membrane
energy of 20 modes besides, at w/t 1.9. By steps a period of small amplitudes: iterations, microseconds in the graph,
and times as many as without. All in turn, the fastest of the rounds.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model import joints
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh, box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online.run import run
from warpffrf.study.machine import machine

SIDE, THICK, CELLS, MODES = 0.4, 4e-3, 6, 20  # m
MATERIAL = Material(210e9, 0.316, 7850.0)
UNIT = MATERIAL.youngs_modulus * THICK**3 / (SIDE**4 * MATERIAL.density)  # m/s^2 of q a^4/(E t^4) = 1
LOAD = 250.0  # in these units, sudden: to w/t 1.9 and back
LINEAR_LOAD = 70.0  # the same of a linear plate
PERIOD = 1.0 / 240.0  # s
STEPS = (30, 100)  # a period
WAYS: dict[str, Any] = {"linear": False, "stiffened": True, "membrane": "membrane"}


def plate(stiffening: Any) -> ReducedBody:
    """The body; its mode of the highest frequency is one of the rim alone."""
    plain = box((SIDE, SIDE, THICK), (CELLS, CELLS, 1))
    sides = [plain.facets(name) for name in ("x_min", "x_max", "y_min", "y_max")]
    rim = FacetSet({kind: np.concatenate([s.blocks[kind] for s in sides]) for kind in sides[0].blocks})
    return reduce(
        Mesh(plain.points, plain.cells, {"rim": rim}), MATERIAL, interfaces={"rim": "rigid"}, modes=14,
        options=ReductionOptions(stiffening=stiffening, membrane_modes=MODES if stiffening == "membrane" else None),
        progress=False,
    )  # fmt: skip


def vibrating(body: ReducedBody, stiffening: Any) -> Scene:
    """The plate under a sudden load; linear bodies keep the inertia terms that make their modes retained unknowns."""
    scene = Scene(gravity=(0.0, 0.0, -(LOAD if stiffening == "membrane" else LINEAR_LOAD) * UNIT))
    held = scene.add_body(
        body, name="plate", damping=0.0, stiffening=bool(stiffening), inertia="constant" if stiffening else "deformed"
    )
    scene.add(joints.Fixed(scene.ground, held["rim"], name="rim"))
    return scene


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=3000)
    parser.add_argument("--rounds", type=int, default=4, help="the fastest counts")
    given = parser.parse_args()
    about = machine()
    bodies = {way: plate(stiffening) for way, stiffening in WAYS.items()}
    best: dict[tuple[int, str], dict] = {}
    for _ in range(given.rounds):
        for steps in STEPS:
            for way, stiffening in WAYS.items():
                history = run(
                    vibrating(bodies[way], stiffening), given.steps * PERIOD / steps, step=PERIOD / steps,
                    save_every=100, integrator=GeneralizedAlpha(0.95), progress=False,
                )  # fmt: skip
                count = history.counters
                seconds = float(count["seconds_in_graph"]) / given.steps
                if (steps, way) not in best or seconds < best[steps, way]["seconds_per_step"]:
                    iterations = float(count["mean_iterations"])
                    best[steps, way] = {
                        "steps_per_period": steps, "way": way, "iterations": iterations,
                        "seconds_per_step": seconds, "status": history.status,
                    }  # fmt: skip
    squares = bodies["membrane"].inertia_terms
    assert squares is not None and squares.stiffening is not None and squares.stiffening.membrane is not None
    print(f"{len(squares.stiffening.membrane)} squares of {MODES} modes, U = {about['unit_seconds'] * 1e6:.1f} us")
    print("steps/period  way        iterations  us/step  of linear  of stiffened  status")
    for (steps, way), row in best.items():
        of = [row["seconds_per_step"] / best[steps, other]["seconds_per_step"] for other in ("linear", "stiffened")]
        row["of_linear"], row["of_stiffened"] = of
        print(f"{steps:12d}  {way:10s} {row['iterations']:10.2f} {row['seconds_per_step'] * 1e6:8.1f} "
              f"{of[0]:10.2f} {of[1]:13.2f}  {row['status']}")  # fmt: skip
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": list(best.values())}, indent=1) + "\n")


if __name__ == "__main__":
    main()
