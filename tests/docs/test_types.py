"""Types of the public signatures: a type checker finds wrong arguments in a user's script, and lets right ones pass."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
RIGHT = """\
import numpy as np
import warpffrf as wf

steel = wf.Material(210e9, 0.3, 7850)
mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=2, order=1)
roller = wf.reduce(
    mesh, steel, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder(), "ends": None},
    max_frequency=20e3, stress={"below": [(0, 0, -1e-3 * i) for i in range(3)], "skin": "skin", "x": np.zeros((2, 3))},
)
scene = wf.Scene(gravity=(0, 0, -9.81))
lower = scene.add_body(roller, name="lower", damping=0.01)
upper = scene.add_body(roller, name="upper", position=np.array([0, 0, 0.1]), rotation=[0, 1, 0, 0])
box = scene.add_rigid_body(1.0, (1, 1, 1), name="box", surfaces={"tread": wf.surfaces.Cylinder(radius=0.1)})
contact = scene.add(wf.Contact(lower["rim"], upper["rim"], friction=0.3, law=wf.laws.LinearLayer(1e13)))
scene.close_gap(contact, along=[0, 0, 1])
axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0)))
scene.add(wf.joints.Fixed(scene.ground, box.at([0, 0, 0]), point=(0, 0, 0)))
scene.add(wf.joints.Drive(axle, wf.signals.SmoothStep(0, 100, duration=0.01), quantity="velocity"))
scene.add(wf.forces.TorsionalSpringDamper(axle, stiffness=1e6, damping=2e3))
scene.add(wf.forces.PointForce(upper["bore"], (0, wf.signals.Constant(3), 0), frame="body"))
scene.add(wf.forces.PointForce(upper["bore"], (wf.signals.Table([0, 1], [0, 2]), (0, 0, 1))))
scene.add(wf.forces.PointTorque(box, np.ones(3)))
scene.add(wf.forces.Bushing(upper["bore"], box.at((0, 0, 0)), [1e6, 1e6, 1e6, 0, 0, 0], np.zeros((6, 6))))
scene.add(wf.sensors.Acceleration(lower["bore"], frame="body"))
result = wf.simulate(scene, 0.02, step=1e-4, start="equilibrium", options=wf.RunOptions(save_every=2))
pair = result.contact("lower-upper")
print(pair.half_width[-1] + pair.force[-1, 2], result.joint(axle.name or "").force.shape)
result.summary().savefig("summary.png")
result.plot("patch").set_title("patch")
again = wf.simulate(scene, [wf.Stage("press", 0.02, 1e-3)], start=result)
path = wf.static(scene, 1.0, step=0.1, options=wf.RunOptions(local_modes="quasi_static"))
print(wf.eigenmodes(scene, 4, about=again).report(), wf.equilibrium(scene).time)
"""
WRONG = """\
wf.Material("steel", 0.3, 7850)
wf.Scene(gravity="down")
wf.Contact(1, "a")
wf.Contact(lower["rim"], upper["rim"], friction="b")
wf.Contact(lower["rim"], upper["rim"], quadrature="all")
wf.Contact(lower["rim"], upper["rim"], law=0.3)
wf.simulate(3, 0.01, step=1e-3)
wf.simulate(scene, 0.01, step="1 ms")
wf.simulate(scene, 0.01, stepp=1e-3)
wf.RunOptions(integrator="hht")
wf.RunOptions(save_every="second")
wf.equilibrium(mesh)
wf.eigenmodes(result)
wf.forces.PointForce(lower["bore"], 5)
wf.forces.PointForce(lower["bore"], (0, 0, 1), frame="user")
wf.forces.PointTorque("bore", (0, 0, 1))
wf.forces.SpringDamper(lower["bore"], upper["bore"], stiffness="soft")
wf.forces.JointSpringDamper(contact, 1e6)
wf.joints.Revolute(scene.ground, lower["bore"], axis="y")
wf.joints.Revolute(scene.ground, "lower", axis=(0, 1, 0))
wf.joints.Prismatic(scene.ground, lower["bore"], axs=(0, 0, 1))
wf.joints.Drive(lower, 100.0)
wf.joints.Drive(axle, lambda t: t)
wf.joints.Drive(axle, 100.0, quantity="speed")
wf.reduce(roller, steel)
wf.reduce(mesh, 210e9)
wf.reduce(mesh, steel, grid=1e-4)
wf.reduce(mesh, steel, max_freqency=20e3)
wf.reduce(mesh, steel, contact={"rim": "cylinder"})
wf.reduce(mesh, steel, interfaces=["bore"])
wf.mesh.read("roller.msh", length_unit=1e-3)
wf.mesh.roller("0.05", 0.015, 0.02, sectors=24, layers=2, axial=2)
wf.signals.SmoothStep(0, 100, 0.01)
wf.signals.Table("0, 1", [0, 1])
wf.integrators.GeneralizedAlpha(rho_inf="a")
wf.sensors.Velocity(lower["bore"], frame="user")
scene.add_body(mesh, name="mesh")
scene.add_body(roller, name="roller", position=0.1)
scene.add_rigid_body("1 kg", (1, 1, 1), name="box")
scene.add_rigid_body(1.0, (1, 1, 1), name="box", surfaces={"tread": "cylinder"})
scene.close_gap("lower-upper")
result.contact(0)
result.plot(7)
result.save(["a.h5"])
wf.Stage("press", "0.02", 1e-3)
"""


def checked(script: Path) -> set[int]:
    """Lines, from 0, of the errors that pyright finds in a script."""
    config = {"extraPaths": [str(ROOT), str(ROOT / "kernels")], "typeCheckingMode": "basic", "include": [script.name]}
    (script.parent / "pyrightconfig.json").write_text(json.dumps(config))
    command = [
        sys.executable,
        "-m",
        "pyright",
        "--outputjson",
        "--pythonpath",
        sys.executable,
        "-p",
        str(script.parent),
    ]
    found = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)
    return {one["range"]["start"]["line"] for one in found["generalDiagnostics"] if one["severity"] == "error"}


@pytest.mark.slow
def test_wrong_arguments_are_found_before_a_run(tmp_path: Path) -> None:
    pytest.importorskip("pyright")
    script = tmp_path / "machine.py"
    script.write_text(RIGHT + WRONG)
    right, wrong = RIGHT.count("\n"), WRONG.splitlines()
    lines = checked(script)
    said = [RIGHT.splitlines()[line] for line in sorted(lines) if line < right]
    missed = [text for number, text in enumerate(wrong, start=right) if number not in lines]
    assert not said and missed == [], (said, missed)


def test_both_packages_say_that_they_are_typed() -> None:
    for package in ("warpffrf", "kernels/warpffrf_kernels"):
        assert (ROOT / package / "py.typed").is_file()
