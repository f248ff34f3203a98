"""How the files beside this one were made: run with the package of an older commit on the path.

    PYTHONPATH=OLD:OLD/kernels python make.py KIND COMMIT

writes KIND_COMMIT.h5, and KIND_COMMIT.json with what that package itself read out of the run: numbers that today's
package must find in the file. Scenes are as small as they can be, and said in words that every version knows.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850.0)
Y, Z = (0, 1, 0), (0, 0, 1)


def rollers(**contact: Any) -> tuple[wf.Scene, dict[str, Any]]:
    """Two alike rollers pressed together by a spring, with a grid that is coarse for its patch."""
    mesh = wf.mesh.roller(0.01, 0.005, 0.004, sectors=60, layers=2, axial=1, order=1)
    rough: dict[str, Any] = {"tangential": True} if contact else {}
    roller = wf.reduce(mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
                       cache=False, progress=False, **rough)  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 0.02))
    scene.close_gap(scene.add(wf.Contact(lower["rim"], upper["rim"], name="pair", **contact)))
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=Y, name="axle"))
    scene.add(wf.joints.Drive(axle, wf.signals.Constant(10.0), quantity="velocity", name="drive"))
    guide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=Z, name="guide"))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=1e6, damping=1e3, preload=-4e4, name="spring"))
    return scene, {"duration": 4e-4, "step": 1e-4, "start": "equilibrium"}


def rubbing() -> tuple[wf.Scene, dict[str, Any]]:
    """The same with friction."""
    return rollers(friction=0.3)


def lumped() -> tuple[wf.Scene, dict[str, Any]]:
    """A rigid ball dropped into a plane, with friction in a joint beside it."""
    scene = wf.Scene(gravity=(0, 0, -9.81))
    plane = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=Z), name="floor")
    sphere = wf.surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0), axis_direction=Z)
    ball = scene.add_rigid_body(0.03, (1e-6,) * 3, name="ball", position=(0, 0, 0.01), velocity=(0, 0, -0.1),
                                surfaces={"skin": sphere})  # fmt: skip
    scene.add(wf.LumpedContact(ball["skin"], plane, law=wf.laws.HertzPoint(STEEL, STEEL), name="rest"))
    return scene, {"duration": 1e-4, "step": 1e-5}


def film() -> tuple[wf.Scene, dict[str, Any]]:
    """A rigid shaft on an oil film in a sleeve that yields."""
    mesh = wf.mesh.sleeve(0.025, 0.0375, 0.025, sectors=16, order=1, axial=4)
    bore = wf.reduce(mesh, STEEL, interfaces={"outside": "rigid"}, contact={"bore": wf.surfaces.Bore()}, modes=0,
                     cache=False, progress=False)  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, 0))
    held = scene.add_body(bore, name="sleeve")
    scene.add(wf.joints.Fixed(scene.ground, held["outside"], axis=Y, name="held"))
    journal = wf.surfaces.Cylinder(radius=0.025 - 25e-6, axis_point=(0, 0, 0), axis_direction=Y)
    shaft = scene.add_rigid_body(1.0, (1e-3,) * 3, name="shaft", position=(7.5e-6, 0, 0),
                                 angular_velocity=(0, 300.0, 0), surfaces={"rim": journal})  # fmt: skip
    turn = scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), shaft.at((0, 0, 0)), axis=Y, name="plane"))
    scene.add(wf.joints.Drive(turn, wf.signals.Constant(300.0), quantity="velocity", name="speed"))
    scene.add(wf.forces.PointForce(shaft.at((0, 0, 0)), (2e3, 0.0, 0.0), name="load"))
    groove = wf.films.AxialGroove(np.pi, 1e-4, 0.0)
    scene.add(wf.Film(held["bore"], shaft["rim"], oil=wf.oils.Newtonian(0.01), feeds=[groove], name="film"))
    return scene, {"duration": 4e-5, "step": 1e-5}


def lap() -> tuple[wf.Scene, dict[str, Any]]:
    """Two blocks that a lap with friction joins, pulled."""

    def block(ends: tuple[str, str]) -> Any:
        return wf.reduce(wf.mesh.box((0.06, 0.02, 0.02), (3, 1, 2), order=1), STEEL, interfaces={ends[0]: "rigid"},
                         laps={"face": wf.LapCells(ends[1], by="facets")}, max_frequency=1.2e5, cache=False,
                         progress=False)  # fmt: skip

    scene = wf.Scene(gravity=(0, 0, 0))
    base = scene.add_body(block(("z_min", "z_max")), name="base", position=(0, 0, 0.01))
    top = scene.add_body(block(("z_max", "z_min")), name="top", position=(0, 0, 0.03))
    scene.add(wf.joints.Fixed(scene.ground, base["z_min"], name="held"))
    scene.add(wf.Lap(top["face"], base["face"], friction=0.3, name="lap"))
    scene.add(wf.forces.PointForce(top["z_max"], (wf.signals.Ramp(0.0, 400.0, duration=4e-5), 0.0, -2e3), name="pull"))
    return scene, {"duration": 4e-5, "step": 1e-5, "start": "equilibrium"}


def numbers(result: Any) -> dict[str, Any]:
    """What the package that made the run read out of it."""
    history = result.history
    found: dict[str, Any] = {"status": result.status, "time": history.time.tolist()}
    for kind in ("contacts", "lumped_contacts", "films", "laps", "joints", "forces"):
        for name, owner in getattr(history, kind, {}).items():
            found[f"{kind}/{name}/force"] = np.asarray(owner.force).tolist()
    for name, body in history.bodies.items():
        found[f"bodies/{name}/position"] = np.asarray(body.position).tolist()
    return found


if __name__ == "__main__":
    kind, commit = sys.argv[1:]
    scene, options = globals()[kind]()
    duration = options.pop("duration")
    here = Path(__file__).parent
    file = here / f"{kind}_{commit}.h5"
    result = wf.simulate(scene, duration, results=file, progress=False, **options)
    file.with_suffix(".json").write_text(json.dumps(numbers(result), indent=1) + "\n", encoding="utf-8")
    print(file.stat().st_size, result.status, result.message)
