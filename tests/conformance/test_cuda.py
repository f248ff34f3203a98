"""CUDA without a GPU: every kernel module compiles for sm_90, and 64 lanes on the CPU agree with one."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import cuda_modules
import numpy as np
import pytest
import warp as wp

from warpffrf_kernels.core.scalars import BLOCK

LANES = 1e-12  # relative: the lanes add in another order
SOLVED = 1e-9  # of the largest traction, or moment of them: their iteration ends at 1e-10 of the largest bound


def test_kernel_modules_are_found() -> None:
    some = {"bodies.motion", "constraints.rows", "films.system", "kinematics.line_of_centres", "step.step_control"}
    assert some <= set(cuda_modules.MODULES)


def test_modules_that_changed_compile_for_sm_90(tmp_path: Path) -> None:
    """Since all compiled last; see `cuda_modules`."""
    for name in cuda_modules.changed():
        folder = tmp_path / name
        folder.mkdir()
        assert "sm_90" in cuda_modules.compile_to_ptx(name, folder), name


@pytest.mark.slow
@pytest.mark.parametrize("name", cuda_modules.MODULES)
def test_module_compiles_for_sm_90(name: str, tmp_path: Path) -> None:
    assert "sm_90" in cuda_modules.compile_to_ptx(name, tmp_path)


def test_a_stamp_is_of_what_a_module_uses(monkeypatch: pytest.MonkeyPatch) -> None:
    """Equal as long as nothing changes, another one for another version of Warp; each module has its own."""
    stamps = [cuda_modules.stamp(name) for name in cuda_modules.MODULES]
    assert len(set(stamps)) == len(stamps)
    first = cuda_modules.MODULES[0]
    assert cuda_modules.stamp(first) == stamps[0]
    monkeypatch.setattr(wp.config, "version", "another")
    assert cuda_modules.stamp(first) != stamps[0]


# kernels need a source file, so this is run as one
RUN = """
import sys
import numpy as np
import warp as wp

wp.config.enable_cpu_blocks = sys.argv[1] == "blocks"
from warpffrf.online import run
from scenes.rollers import PAIR, guided_pair, roller_body

@wp.kernel
def count_lanes(lanes: wp.array(dtype=int)):
    i, lane = wp.tid()
    wp.atomic_add(lanes, 0, 1)

lanes = wp.zeros(1, dtype=int, device="cpu")
wp.launch_tiled(count_lanes, dim=(1,), inputs=[lanes], block_dim=64, device="cpu")
made = dict(layers=3, axial=2, order=2, grading=1.6, max_frequency=15e3, tangential=True, contact_fixed=False,
    cache=False)
first, second = roller_body(90, **made), roller_body(84, outer_radius=0.0497, **made)  # at equal speeds: 0.6 % of creep
scene = guided_pair(first, second, load=200e3, speed=50.0, ramp=0.002, friction=FRICTION)
history = run(scene, 0.004, step=1e-4, start="equilibrium", progress=False)
c = history.contacts[PAIR]
made = {"traction": c.friction.traction, "state": c.friction.state, "torque": c.torque_second} if FRICTION else {}
np.savez(sys.argv[2], force=c.force, pressure=c.pressure,
         modal=history.bodies["upper"].modal, rotation=history.bodies["lower"].rotation,
         kinetic=history.energy["kinetic"], status=history.status, lanes=lanes.numpy()[0], **made)
"""


# three pairs on one surface, with a coefficient that falls with the slip speed
PLANETS = """
import sys
import numpy as np
import warp as wp

wp.config.enable_cpu_blocks = sys.argv[1] == "blocks"
import warpffrf as wf
from warpffrf.online import run
from scenes.planets import planets
from scenes.rollers import roller_body

body = roller_body(90, layers=3, axial=2, order=2, grading=1.6, max_frequency=15e3,
                   tangential=True, contact_fixed=False, cache=False)
scene = planets(body, 3, 100e3, friction=0.3, creepage=2e-2)
for contact in scene.contacts:
    contact.friction = wf.laws.Stribeck(0.3, 0.2, 0.05)
history = run(scene, 0.003, step=1e-4, start="equilibrium", progress=False)
made = {"status": history.status}
for name, c in history.contacts.items():
    made |= {f"{name} force": c.force, f"{name} traction": c.friction.traction, f"{name} state": c.friction.state}
np.savez(sys.argv[2], **made)
"""


# cells that travel with the patch, of unlike bodies
ROLLING = """
import sys
import numpy as np
import warp as wp

wp.config.enable_cpu_blocks = sys.argv[1] == "blocks"
import warpffrf as wf
from warpffrf.online import run

@wp.kernel
def count_lanes(lanes: wp.array(dtype=int)):
    i, lane = wp.tid()
    wp.atomic_add(lanes, 0, 1)

lanes = wp.zeros(1, dtype=int, device="cpu")
wp.launch_tiled(count_lanes, dim=(1,), inputs=[lanes], block_dim=64, device="cpu")
bodies = [
    wf.reduce(
        wf.mesh.roller(0.05, 0.015, 0.02, sectors=36, layers=2, axial=2, order=1), wf.Material(modulus, nu, 7850.0),
        interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, max_frequency=12e3,
        grid=wf.ContactGrid(tangential=True, contact_fixed=True), cache=False, progress=False,
    )
    for modulus, nu in ((210e9, 0.3), (70e9, 0.34))
]
made = {}
for partner in ("roller", "ball"):
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(bodies[0], name="lower", angular_velocity=(0, 10.0, 0), inertia="constant")
    turning = [(lower, 10.0)]
    if partner == "roller":
        other = scene.add_body(
            bodies[1], name="upper", position=(0, 0, 0.1 - 2e-5), angular_velocity=(0, -10.05, 0), inertia="constant"
        )
        turning.append((other, -10.05))
        face = other["rim"]
    else:
        shape = wf.surfaces.Sphere(radius=0.03, axis_point=(0, 1e-3, 0.08 - 2e-5), axis_direction=(0, 1, 0))
        face = scene.ground.surface(shape, name="ball")
    for body, speed in turning:
        axle = scene.add(wf.joints.Revolute(scene.ground, body["bore"], axis=(0, 1, 0)))
        scene.add(wf.joints.Drive(axle, wf.signals.Table([0, 1], [speed, speed]), quantity="velocity"))
    scene.add(wf.Contact(lower["rim"], face, friction=0.3, grid="contact_fixed", cells=(9, 7), name="pair"))
    history = run(scene, 20 * 2e-4, step=2e-4, start="equilibrium", progress=False)
    assert history.status == "completed"
    c = history.contacts["pair"]
    made |= {f"{partner} force": c.force, f"{partner} traction": c.friction.traction,
             f"{partner} state": c.friction.state, f"{partner} modal": history.bodies["lower"].modal,
             f"{partner} friction": history.energy["friction"]}
np.savez(sys.argv[2], lanes=lanes.numpy()[0], **made)
"""


# a bearing of rollers by laminae with friction and rolling resistance, in which the cage slips and rollers are unloaded
LUMPED = """
import sys
import numpy as np
import warp as wp

wp.config.enable_cpu_blocks = sys.argv[1] == "blocks"
import warpffrf as wf
from warpffrf.online import run

scene = wf.Scene(gravity=(0, 0, 0))
rollers = wf.bearings.RollerGeometry(
    elements=12, roller_diameter=0.01, roller_length=0.012, pitch_diameter=0.07, clearance=20e-6
)
rolling = wf.bearings.RollingContact(
    law=wf.laws.PalmgrenLine(0.012, 5), friction=wf.laws.RegularisedCoulomb(0.05, 1.0),
    rolling_resistance=wf.laws.RollingResistanceArm(1e-5, 1.0),
)
bearing = scene.add_bearing(
    "b", rollers, first=(0, 0, 1), outer=scene.ground, contact=rolling, cage=wf.bearings.PocketCage(1e-4)
)
ring = bearing.inner
bearing.roll(100.0)
ring.position = at = np.array([5e-6, 0.0, 20e-6])
axle = scene.add(wf.joints.Revolute(scene.ground.at(at), ring.at((0, 0, 0)), axis=(0, 1, 0)))
scene.add(wf.joints.Drive(axle, 100.0))
history = run(scene, 40 * 5e-5, step=5e-5, start="initial", progress=False)
assert history.status == "completed", history.message
made = {f"{name} force": c.force for name, c in history.lumped_contacts.items()}
made |= {f"{name} motion": b.position for name, b in history.bodies.items()}
np.savez(sys.argv[2], friction=history.energy["friction"], **made)
"""


# an oil film, and one with asperities that touch
FILMS = """
import sys
import numpy as np
import warp as wp

wp.config.enable_cpu_blocks = sys.argv[1] == "blocks"
import warpffrf as wf
from warpffrf.online import run
from scenes.film_bearing import GROOVE, bearing, bore

made = {}
mixed = wf.films.MixedLubrication(wf.laws.ExponentialAsperities(1e9, 1e-6), 0.1)
for name, load, more in (("smooth", 8e3, {}), ("rough", 30e3, {"mixed": mixed, "speed": 30.0, "at": (0.7, 0.0)})):
    scene = bearing(bore((32, 7)), (load, 1e3), feeds=[GROOVE], **more)
    history = run(scene, 20 * 1e-4, step=1e-4, progress=False)
    assert history.status == "completed", history.message
    film = history.films["film"]
    made |= {f"{name} pressure": film.pressure, f"{name} gap": film.gap, f"{name} force": film.force,
             f"{name} friction": history.energy["friction"]}
    if more:
        made["asperities"] = film.asperity
np.savez(sys.argv[2], **made)
"""


@pytest.mark.slow
def test_one_lane_and_64_lanes_agree_on_films(tmp_path: Path) -> None:
    one, blocks = both(FILMS, tmp_path)
    assert np.any(one["asperities"] > 0.0) and np.any(one["smooth pressure"] > 1e6)
    compare(one, blocks)


@pytest.mark.slow
def test_one_lane_and_64_lanes_agree_on_lumped_contacts(tmp_path: Path) -> None:
    one, blocks = both(LUMPED, tmp_path)
    assert np.abs(one["friction"]).max() > 1e-6
    compare(one, blocks)


@pytest.mark.slow
def test_one_lane_and_64_lanes_agree_on_cells_that_travel(tmp_path: Path) -> None:
    one, blocks = both(ROLLING, tmp_path)
    assert (int(one["lanes"]), int(blocks["lanes"])) == (1, BLOCK)
    assert {1, 2} <= set(np.unique(one["roller state"])) and 2 in one["ball state"]
    compare(one, blocks)


@pytest.mark.slow
def test_one_lane_and_64_lanes_agree_on_several_pairs(tmp_path: Path) -> None:
    one, blocks = both(PLANETS, tmp_path)
    assert str(one["status"]) == "completed" and {1, 2} <= set(np.unique(one["pair 1 state"]))
    compare(one, blocks)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_one_lane_and_64_lanes_agree(friction: float, tmp_path: Path) -> None:
    one, blocks = both(RUN.replace("FRICTION", str(friction)), tmp_path)
    assert (int(one["lanes"]), int(blocks["lanes"])) == (1, BLOCK)
    assert str(one["status"]) == "completed" and len(one["force"]) == 41
    assert one["force"][-1, 2] < -1e5  # the lower one is pressed down
    assert friction == 0.0 or {1, 2} <= set(np.unique(one["state"]))  # some cells stick, some slide
    compare(one, blocks)


def both(source: str, tmp_path: Path) -> tuple[Any, Any]:
    """The same run in two processes, with and without `wp.config.enable_cpu_blocks`."""
    script = tmp_path / "run_once.py"
    script.write_text(source)
    found = {}
    for mode in ("one", "blocks"):
        out = tmp_path / f"{mode}.npz"
        cache = Path(os.environ["WARP_CACHE_PATH"])  # one lane: the kernels are there already
        if mode == "blocks":
            cache = cache.with_name(cache.name + "_blocks")
        done = subprocess.run(
            [sys.executable, str(script), mode, str(out)],
            env={**os.environ, "WARP_CACHE_PATH": str(cache)},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr[-2000:]
        found[mode] = np.load(out)
    return found["one"], found["blocks"]


def compare(one: Any, blocks: Any) -> None:
    for name in one.files:
        if name not in ("status", "lanes"):
            largest, apart = np.abs(one[name]).max(), np.abs(one[name] - blocks[name]).max()
            print(f"{name}: {apart:.1e} of {largest:.1e}")
            assert apart <= (SOLVED if name.endswith(("traction", "torque")) else LANES) * largest, name
