"""Numbers and step time on a device against the CPU: `python bench/on_device.py [--device cuda:0] [--worlds 1 16 256]`.

Each scene runs on the CPU, in one world, and on the device, in so many equal worlds at once. *Apart*: the largest
difference of what both have saved (positions, deformations, contact forces, ...) over the largest value of that
quantity. Sums over the lanes of a block come in another order, so round-off is what it should be. *us*: wall time of a
step over the number of worlds, graph replay alone, best of the rounds. Needs a device, see `wp.get_devices()`; without
one it says so and ends.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import warp as wp

from scenes.planets import planets
from scenes.rollers import guided_pair, roller_body
from warpffrf.model import joints
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online import Engine
from warpffrf.online.device import chosen_device
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.warp_start import start_warp
from warpffrf.study.machine import machine
from warpffrf_kernels.core import control as k

STEP, STEPS = 1e-4, 100
ROUNDS = 2  # the first finds the device cold
ROUND_OFF = 1e-12  # in SI units: what is below is zero


def pendulums() -> Scene:
    """Twenty rigid bodies on hinges, one below the other: rows of constraints, no contact."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    above = scene.ground.at((0.0, 0.0, 0.0))
    for i in range(20):
        rod = scene.add_rigid_body(1.0, (1e-2, 1e-2, 1e-2), name=f"rod {i}", position=(0.1 + 0.2 * i, 0.0, 0.0))
        scene.add(joints.Revolute(above, rod.at((-0.1, 0.0, 0.0)), axis=(0, 1, 0)))
        above = rod.at((0.1, 0.0, 0.0))
    return scene


def scenes() -> dict[str, Callable[[], Scene]]:
    """What is timed, by name."""
    made: dict[str, Any] = {"layers": 3, "axial": 2, "order": 2, "grading": 1.6, "max_frequency": 15e3}
    made |= {"tangential": True, "contact_fixed": False}
    first, second = roller_body(90, **made), roller_body(84, outer_radius=0.0497, **made)
    return {
        "20 hinged rods": pendulums,
        "two rollers": lambda: guided_pair(first, second, load=200e3, speed=50.0, ramp=0.002),
        "two rollers, friction": lambda: guided_pair(first, second, load=200e3, speed=50.0, ramp=0.002, friction=0.3),
        "nine rollers, friction": lambda: planets(first, 8, 100e3, friction=0.3, creepage=2e-3),
    }


def stepped(scene: Scene, device: str, worlds: int, static: bool) -> tuple[float, list[Any]]:
    """Seconds of the replay, and what each world saved."""
    engine = Engine(scene, worlds=worlds, device=device)
    if static and not settle(engine):
        raise RuntimeError("no equilibrium")
    engine.initial_rates()
    start_consistently(engine, STEP)
    engine.control(every=STEPS)
    engine.enter(k.DYNAMIC, STEP, target=STEPS)
    seconds = engine.replay(8 * STEPS)
    status, steps = engine.word("status"), engine.word("step")
    if status.any() or (steps != STEPS).any():
        raise RuntimeError(f"status {status[0]}, {steps.min()} of {STEPS} steps")
    return seconds, [engine.saved(w) for w in (0, worlds - 1)]


def apart(found: Any, reference: Any) -> tuple[float, str]:
    """The largest difference of any saved quantity, relative to its largest value, and which it is."""
    worst = (0.0, "")
    for name, values in reference.items():
        if values.dtype.kind != "f" or not values.size or not np.any(values):
            continue
        scale = np.nanmax(np.abs(values))
        if scale < ROUND_OFF:
            continue
        worst = max(worst, (float(np.nanmax(np.abs(found[name] - values)) / scale), name))
    return worst


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cuda:0")
    parser.add_argument("--worlds", type=int, nargs="+", default=[1, 16, 256])
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    given = parser.parse_args()
    start_warp()
    try:
        device = chosen_device(given.device)
    except InputError as error:
        print(f"nothing measured: {error}")
        return
    card = wp.get_device(device)
    print(f"CPU and {card.name}")
    print("scene                     device    worlds  us a step and world   CPU over it   apart    of")
    rows = []
    for name, make in scenes().items():
        static = bool(make().contacts)
        reference: list[Any] = []
        alone = 0.0
        for where, worlds in (("cpu", 1), *((device, n) for n in given.worlds)):
            try:
                found = [stepped(make(), where, worlds, static) for _ in range(ROUNDS)]
            except RuntimeError as error:
                print(f"{name:24}  {where:8}  {worlds:6}  failed: {error}", flush=True)
                rows.append({"scene": name, "device": where, "worlds": worlds, "failed": str(error)})
                continue
            each = min(seconds for seconds, _ in found) / STEPS / worlds
            saved = found[-1][1]
            reference, alone = reference or saved, alone or each
            error, of = max(apart(one, reference[0]) for one in saved)
            rows.append(
                {"scene": name, "device": where, "worlds": worlds, "seconds_per_step": each, "apart": error, "of": of}
            )
            print(f"{name:24}  {where:8}  {worlds:6}  {1e6 * each:19.1f}   {alone / each:11.2f}   {error:.1e}  {of}",
                  flush=True)  # fmt: skip
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps({"machine": {**machine(), "device": card.name}, "rows": rows}, indent=1))


if __name__ == "__main__":
    main()
