"""Times and numbers on a device compared with one core of the CPU: `python bench/on_device.py [--device cuda:0]`.

From a checkout, with what the wheel depends on and nothing else; five minutes (`--seconds`). Each scene runs on the CPU
in one world, and on the device in so many equal worlds at once. *us*: wall time of a step over the number of worlds,
graph replay alone, best of the rounds. *times*: the CPU's over it. *apart*: the largest difference of what both have
saved (positions, deformations, contact forces, ...) over the largest value of that quantity. *launches*: kernels of an
attempt of a step with one iteration. *target*: what is required, and whether it is met.

`--demos` runs the demos instead, `--quick`, on the CPU and on the device, and compares their results files. `--small`
runs small versions of all scenes, and `--device cpu --small` shows without a GPU that the script works; the times of
that mean nothing. Where there is no such device it says so and ends.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PATHS = [str(ROOT / folder) for folder in ("", "kernels", "tests", "bench")]
sys.path[:0] = PATHS

import numpy as np  # noqa: E402
import warp as wp  # noqa: E402

from warpffrf.model.errors import InputError  # noqa: E402
from warpffrf.model.scene import Scene  # noqa: E402
from warpffrf.online import Engine, Settings  # noqa: E402
from warpffrf.online.compile.scene import compile_scene  # noqa: E402
from warpffrf.online.device import chosen_device  # noqa: E402
from warpffrf.online.room_for_worlds import bytes_of_a_world, worlds_that_fit  # noqa: E402
from warpffrf.online.start.consistent import start_consistently  # noqa: E402
from warpffrf.online.start.static_equilibrium import settle  # noqa: E402
from warpffrf.online.warp_start import start_warp  # noqa: E402
from warpffrf.study.machine import machine  # noqa: E402
from warpffrf_kernels.core import control as k  # noqa: E402

ROUNDS = 2  # the first finds the device cold
ROUND_OFF = 1e-12  # in SI units: what is below is zero
ALIKE = 1e-9  # of the largest value of a quantity: required of all scenes and demos
MICRO, TIMES = "us per step", "times one core"
FEW = 4  # worlds of small versions
Target = tuple[float, str]


def pendulums(small: bool) -> Scene:
    """Twenty rigid bodies on hinges, one below the other: rows of constraints, no contact."""
    from warpffrf.model import joints

    scene = Scene(gravity=(0.0, 0.0, -9.81))
    above = scene.ground.at((0.0, 0.0, 0.0))
    for i in range(4 if small else 20):
        rod = scene.add_rigid_body(1.0, (1e-2, 1e-2, 1e-2), name=f"rod {i}", position=(0.1 + 0.2 * i, 0.0, 0.0))
        scene.add(joints.Revolute(above, rod.at((-0.1, 0.0, 0.0)), axis=(0, 1, 0)))
        above = rod.at((0.1, 0.0, 0.0))
    return scene


@cache
def rollers() -> tuple[Any, Any]:
    """Two small rollers, of different numbers of cells around."""
    from scenes.rollers import roller_body

    made: dict[str, Any] = {"layers": 3, "axial": 2, "order": 2, "grading": 1.6, "max_frequency": 15e3}
    made |= {"tangential": True, "contact_fixed": False}
    return roller_body(90, **made), roller_body(84, outer_radius=0.0497, **made)


def pair(friction: float) -> Scene:
    """The two small rollers in contact."""
    from scenes.rollers import guided_pair

    return guided_pair(*rollers(), load=200e3, speed=50.0, ramp=0.002, friction=friction)


def demo_rollers(small: bool) -> Scene:
    """Those of the demo: 16,800 local modes each."""
    from demos import two_rollers

    return two_rollers.build(two_rollers.Size(480, 4, 2) if small else two_rollers.FULL, progress=False)


def many_pairs(small: bool) -> Scene:
    """18 rollers between flexible rings, 36 frictional pairs."""
    from step.step_vs_pairs import FRICTION, rings

    return rings()[8 if small else 36][0](FRICTION)


def film(small: bool) -> Scene:
    """A shaft in an elastic sleeve under a load that rotates."""
    from step.step_vs_film import PER_TURN, sleeve

    return sleeve((32, 7) if small else (128, 17), 50.0 / PER_TURN)


def patch(small: bool) -> Scene:
    """Two rollers on contact-fixed cells, partly sticking."""
    from step.friction_step import FRICTION
    from studies.rolling.driven_pair import Rollers, body, scene

    mesh = {"sectors": 78, "layers": 8, "axial": 5, "order": 1}
    chosen = Rollers("patch", 0.02, 0.4e-3, mesh, (13, 10) if small else (100, 100), 20)
    return scene(chosen, body(chosen), FRICTION, 0.5)


@dataclass(frozen=True)
class Case:
    """A scene, made small or not, its step [s], number of steps, and the worlds on the device with their targets; rest:
    it starts from its equilibrium."""

    make: Callable[[bool], Scene]
    step: float
    steps: int
    worlds: dict[int, Target | None]
    rest: bool = True


CASES = {
    "20 hinged rods": Case(pendulums, 1e-4, 100, {1: (300.0, MICRO), 4096: None}, rest=False),
    "two small rollers": Case(lambda _: pair(0.0), 1e-4, 100, {1: (400.0, MICRO), 256: None, 4096: (200.0, TIMES)}),
    "two small rollers, friction": Case(lambda _: pair(0.3), 1e-4, 100, {1: None, 256: None}),
    "36 frictional pairs": Case(many_pairs, 1e-4, 20, {1: (5.0, TIMES)}),
    "film 128 x 17": Case(film, 2e-4, 20, {1: (10.0, TIMES)}, rest=False),
    "patch 100 x 100, friction": Case(patch, 8e-5, 10, {1: (10.0, TIMES)}),
    "the demo's rollers": Case(demo_rollers, 1e-4, 20, {256: (50.0, TIMES)}),
}


def stepped(case: Case, scene: Scene, device: str, worlds: int) -> tuple[float, list[Any], int]:
    """Seconds of the replay, what the first and the last world saved, and launches of an attempt."""
    engine = Engine(scene, worlds=worlds, device=device, settings=Settings().for_rows(1))
    if case.rest and not settle(engine):
        raise RuntimeError("no equilibrium")
    engine.initial_rates()
    start_consistently(engine, case.step)
    engine.control(every=case.steps)
    engine.enter(k.DYNAMIC, case.step, target=case.steps)
    seconds = engine.replay(8 * case.steps)
    status, steps = engine.word("status"), engine.word("step")
    if status.any() or (steps != case.steps).any():
        raise RuntimeError(f"status {status[0]}, {steps.min()} of {case.steps} steps")
    return seconds, [engine.saved(w) for w in (0, worlds - 1)], len(engine.graph.program.launches())


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


def room(scene: Scene, device: str, worlds: int) -> int:
    """How many of these worlds fit."""
    settings = Settings().for_rows(1)
    compiled = compile_scene(scene, settings, device)
    fit = worlds_that_fit(compiled, settings, None, None, worlds)
    if fit < worlds:
        size, _ = bytes_of_a_world(compiled, settings, None, None)
        print(f"    {worlds} worlds of {size / 1e6:.3g} MB do not fit, {fit} are run", flush=True)
    return fit


def verdict(target: Target | None, seconds: float, alone: float) -> str:
    """The target of a row and whether it is met."""
    if target is None:
        return ""
    wanted, kind = target
    met = 1e6 * seconds <= wanted if kind == MICRO else alone / seconds >= wanted
    return f"{wanted:g} {kind}: {'met' if met else 'missed'}"


def measured(names: Sequence[str], device: str, small: bool, end: float) -> list[dict[str, Any]]:
    """All rows, printed as they are found; what would begin after `end` is named."""
    rows: list[dict[str, Any]] = []
    print("scene                        device    worlds  us per step, world     times   apart  launches  target")
    for name in names:
        case = CASES[name]
        if time.monotonic() > end:
            print(f"{name:27}  not run: no time is left", flush=True)
            rows.append({"scene": name, "failed": "no time is left"})
            continue
        scene = case.make(small)
        reference: list[Any] = []
        alone = np.inf
        for where, worlds, target in (("cpu", 1, None), *((device, n, t) for n, t in case.worlds.items())):
            count = min(worlds, FEW) if small else worlds
            row: dict[str, Any] = {"scene": name, "device": where, "worlds": count, "small": small}
            rows.append(row)
            try:
                if time.monotonic() > end:
                    raise RuntimeError("no time is left")
                row["worlds"] = count = room(scene, where, count)
                found = [stepped(case, scene, where, count) for _ in range(ROUNDS)]
            except (RuntimeError, InputError) as error:
                print(f"{name:27}  {where:8}  {count:6}  failed: {error}", flush=True)
                row["failed"] = str(error)
                continue
            each = min(seconds for seconds, _, _ in found) / case.steps / count
            saved, launches = found[-1][1:]
            reference, alone = reference or saved, each if where == "cpu" and not reference else alone
            error, of = max(apart(one, reference[0]) for one in saved)
            said = verdict(None if small else target, each, alone)
            row |= {"seconds_per_step": each, "apart": error, "of": of, "launches": launches, "target": said}
            wrong = f"  {of} is more than {ALIKE:g} apart" if error > ALIKE else ""
            print(f"{name:27}  {where:8}  {count:6}  {1e6 * each:18.1f}  {alone / each:8.2f}  {error:.0e}  {launches:8}"
                  f"  {said}{wrong}", flush=True)  # fmt: skip
    return rows


def demos(names: Sequence[str], device: str, end: float) -> list[dict[str, Any]]:
    """The results of each demo, `--quick`, on the device compared with those on the CPU."""
    rows: list[dict[str, Any]] = []
    print("demo                      CPU s  device s   apart  of")
    with tempfile.TemporaryDirectory() as kept:
        for name in names:
            row: dict[str, Any] = {"demo": name}
            rows.append(row)
            try:
                seconds = [run_demo(name, where, Path(kept) / side / name, end) for side, where in
                           (("cpu", "cpu"), ("device", device))]  # fmt: skip
                error, of = of_files(*(Path(kept) / side / name for side in ("device", "cpu")))
            except RuntimeError as failed:
                row["failed"] = str(failed)
                print(f"{name:20}  {failed}", flush=True)
                continue
            row |= {"cpu_seconds": seconds[0], "device_seconds": seconds[1], "apart": error, "of": of}
            print(f"{name:20}  {seconds[0]:8.1f}  {seconds[1]:8.1f}  {error:.0e}  {of}", flush=True)
    return rows


def run_demo(name: str, device: str, out: Path, end: float) -> float:
    """Seconds of a demo on a device. Raises RuntimeError where it fails or takes longer than there is time."""
    begin = time.monotonic()
    if begin > end:
        raise RuntimeError("no time is left")
    words = [sys.executable, "-m", "warpffrf", "demo", name.replace("_", "-"), "--quick", "--out", str(out)]
    environment = {**os.environ, "WARPFFRF_DEVICE": device, "PYTHONPATH": os.pathsep.join(PATHS)}
    try:
        done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=end - begin, cwd=ROOT)
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"not finished on {device} in the time that was left") from None
    if done.returncode:
        raise RuntimeError(f"failed on {device}: {done.stderr.strip().splitlines()[-1]}")
    return time.monotonic() - begin


def of_files(found: Path, reference: Path) -> tuple[float, str]:
    """The largest difference in all results files, over the largest value of that quantity of all bodies, joints and so
    on in a file."""
    import h5py

    worst = (0.0, "")
    for path in sorted(reference.glob("*.h5")):
        largest: dict[str, float] = {}
        off: dict[str, tuple[float, str]] = {}
        with h5py.File(path) as right, h5py.File(found / path.name) as own:

            def look(name: str, data: Any, own: Any = own, largest: Any = largest, off: Any = off) -> None:
                if not isinstance(data, h5py.Dataset) or data.dtype.kind != "f" or not data.size:
                    return
                kind, values = name.rsplit("/", 1)[-1], np.asarray(data)
                there = np.asarray(own[name]) if name in own else np.full(values.shape, np.inf)
                apart = np.nanmax(np.abs(there - values), initial=0.0) if there.shape == values.shape else np.inf
                largest[kind] = max(largest.get(kind, 0.0), float(np.nanmax(np.abs(values), initial=0.0)))
                off[kind] = max(off.get(kind, (0.0, "")), (float(apart), name))

            right.visititems(look)
        for kind, (apart, name) in off.items():
            if largest[kind] > ROUND_OFF:
                worst = max(worst, (apart / largest[kind], f"{path.name}: {name}"))
    return worst


def main() -> None:
    of_demos = sorted(path.stem for path in (ROOT / "demos").glob("*.py") if path.stem != "__init__")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cuda:0")
    parser.add_argument("--only", nargs="+", default=list(CASES), choices=list(CASES), metavar="SCENE")
    parser.add_argument("--small", action="store_true", help="small versions of the scenes, at most 4 worlds")
    parser.add_argument("--demos", nargs="*", choices=of_demos, metavar="NAME", help="compare these demos, or all")
    parser.add_argument("--seconds", type=float, default=300.0, help="nothing begins later than this")
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    given = parser.parse_args()
    end = time.monotonic() + given.seconds
    start_warp()
    try:
        device = chosen_device(given.device)
    except InputError as error:
        print(f"nothing measured: {error}")
        return
    card = wp.get_device(device)
    print(f"CPU and {card.name}")
    if given.demos is None:
        rows = measured(given.only, device, given.small, end)
    else:
        rows = demos(given.demos or of_demos, device, end)
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps({"machine": {**machine(), "device": card.name}, "rows": rows}, indent=1))


if __name__ == "__main__":
    main()
