"""Two commits compared: time of a step, and whether the results are the same.

    python bench/compare_commits.py --base COMMIT [--rounds N] [--processes N] [--scenes NAME ...] [--json FILE]

The working tree runs against a checkout of COMMIT, each in a process of its own; both are asked in turn for the same
scene, with the same reduced bodies, so that whatever else the machine does meets both. Where arrays happen to lie in
memory makes one process up to a third slower than another of the same commit, so there are several pairs of them. Of
each commit the fastest run counts, since all this only slows down. Results are compared array by array: "same bits", or
the largest difference over the largest entry of its array. The exit status is 1 where a step has become slower by more
than --slower, or a result differs by more than --different.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve()
RADIUS, BORE, WIDTH = 0.05, 0.015, 0.01  # m
WARM_UP = 1  # rounds that do not count: kernels are compiled, memory is met for the first time
SLOWER, DIFFERENT = 0.03, 0.0


# --- bodies, reduced once by the working tree


def _roller(modes: int, grid: dict[str, Any] | None = None, options: dict[str, Any] | None = None) -> Any:
    import warpffrf as wf

    mesh = wf.mesh.roller(RADIUS, BORE, WIDTH, sectors=720, layers=8, axial=3, grading=1.6, order=1)
    return wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=modes, grid=wf.ContactGrid(**grid or {}), options=wf.ReductionOptions(**options or {}), progress=False,
    )  # fmt: skip


BODIES: dict[str, Callable[[], Any]] = {
    "roller": lambda: _roller(modes=0, grid={"tangential": True, "contact_fixed": False}),
    "flexible": lambda: _roller(modes=6),
    "dynamic": lambda: _roller(modes=2, options={"local_dynamics": True}),
}


# --- scenes: public names only, so that they run on any commit whose public names are these


ASPERITIES = ("ExponentialAsperities", {"pressure_at_zero": 2e8, "decay_length": 5e-7})
DAMPED = ("HuntCrossley", {"stiffness": 1e14, "exponent": 1.2, "damping": 0.5})


def _with_law(options: dict[str, Any]) -> dict[str, Any]:
    """Options of a contact, the law made from its name and numbers."""
    import warpffrf as wf

    if "law" not in options:
        return options
    name, numbers = options["law"]
    return {**options, "law": getattr(wf.laws, name)(**numbers)}


def _pressed(bodies: dict[str, Any], kinds: tuple[str, ...], approach: float, **contact: Any) -> Any:
    """Rollers on top of each other, axles held, each pair closer by `approach` [m] than at first touch, all turning."""
    import warpffrf as wf

    scene = wf.Scene(gravity=(0, 0, 0))
    placed = []
    for i, kind in enumerate(kinds):
        spin = 10.0 * (-1.0) ** i * (1.0 if i == 0 else 1.0 - 0.5 * contact.get("friction", 0.0) * 0.06)
        at = (0.0, 0.0, i * (2.0 * RADIUS - approach))
        placed.append(
            scene.add_body(bodies[kind], name=f"roller {i}", position=at, angular_velocity=(0, spin, 0))
        )  # fmt: skip
        axle = scene.add(wf.joints.Revolute(scene.ground, placed[-1]["bore"], axis=(0, 1, 0)))
        scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    for a, b in zip(placed[:-1], placed[1:], strict=True):
        scene.add(wf.Contact(a["rim"], b["rim"], **_with_law(contact)))
    return scene


def _ball(bodies: dict[str, Any], **options: Any) -> Any:
    """A rigid ball falls on a roller: gaps at points, a damped law."""
    import warpffrf as wf

    scene = wf.Scene(gravity=(0, 0, -9.81))
    roller = scene.add_body(bodies[options.pop("kind", "flexible")], name="roller")
    scene.add(wf.joints.Fixed(scene.ground, roller["bore"]))
    R = 0.02
    ball = scene.add_rigid_body(
        0.3, (5e-5,) * 3, name="ball", position=(0, 0, RADIUS + R + 2e-6), velocity=(0.1, 0, -0.2)
    )
    face = ball.surface(wf.surfaces.Sphere(radius=R, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), name="face")
    scene.add(wf.Contact(roller["rim"], face, **_with_law(options)))
    return scene


def _chain() -> Any:
    """20 rigid links, joints spherical and revolute in turn."""
    import warpffrf as wf

    scene, length, last = wf.Scene(gravity=(0, 0, -9.81)), 0.1, None
    for i in range(20):
        link = scene.add_rigid_body(0.2, (2e-5, 1.7e-4, 1.7e-4), name=f"link {i}", position=((i + 0.5) * length, 0, 0))
        before = scene.ground if last is None else last.at((0.5 * length, 0, 0))
        joint = wf.joints.Revolute if i % 2 else wf.joints.Spherical
        axis: dict = {"axis": (0.0, np.cos(0.3 * i), np.sin(0.3 * i))} if i % 2 else {}
        scene.add(joint(before, link.at((-0.5 * length, 0, 0)), **axis))
        last = link
    return scene


@dataclass(frozen=True)
class Case:
    """A scene, its step [s] and how many, and how it begins."""

    build: Callable[[dict[str, Any]], Any]
    step: float
    steps: int
    options: dict[str, Any]


CASES = {
    "rollers": Case(lambda b: _pressed(b, ("flexible", "roller"), 1.2e-5), 1e-4, 400, {"start": "equilibrium"}),
    "wide patch": Case(lambda b: _pressed(b, ("roller", "roller"), 4e-5), 1e-4, 400, {"start": "equilibrium"}),
    "friction": Case(
        lambda b: _pressed(b, ("roller", "roller"), 1.2e-5, friction=0.2), 1e-4, 200, {"start": "equilibrium"}
    ),
    "20 rigid bodies": Case(lambda b: _chain(), 1e-3, 400, {}),
    "shared surface": Case(
        lambda b: _pressed(b, ("roller", "flexible", "roller"), 8e-6), 1e-4, 200, {"start": "equilibrium"}
    ),
    "layer": Case(
        lambda b: _pressed(b, ("roller", "roller"), 1.2e-5, law=ASPERITIES),
        1e-4, 200, {"start": "equilibrium"},
    ),
    "ball, damped": Case(
        lambda b: _ball(b, law=DAMPED), 2e-6, 200, {}
    ),
    "ball, friction": Case(lambda b: _ball(b, kind="roller", friction=0.1), 2e-6, 200, {}),
    "ball, impulsive": Case(lambda b: _ball(b, kind="dynamic"), 2e-6, 100, {"local": "hht"}),
}  # fmt: skip


# --- one process a tree: reads names of scenes, answers with a time, leaves the arrays of the first round


def arrays_of(thing: Any, path: str = "") -> Iterator[tuple[str, np.ndarray]]:
    """All arrays below a dataclass, with the way to each."""
    if isinstance(thing, np.ndarray) and thing.dtype.kind in "fiub":
        yield path, thing
    elif isinstance(thing, dict):
        for name, value in thing.items():
            yield from arrays_of(value, f"{path}/{name}")
    elif is_dataclass(thing) and not isinstance(thing, type):
        for field in fields(thing):
            if field.name != "scene":
                yield from arrays_of(getattr(thing, field.name), f"{path}/{field.name}")


def serve(folder: Path, own: Path) -> None:
    """Answer requests on the standard input until it ends."""
    import warpffrf as wf

    bodies = {name: wf.ReducedBody.load(folder / f"{name}.h5") for name in BODIES}
    known: set[str] = set()
    for line in sys.stdin:
        name = line.strip()
        case = CASES[name]
        options = {"save_every": 20, **case.options}
        if hasattr(wf, "RunOptions"):  # trees before have these as arguments of their own
            chosen = {"save_every": options.pop("save_every"), "local_modes": options.pop("local", "quasi_static")}
            options["options"] = wf.RunOptions(**chosen)
        result = wf.simulate(case.build(bodies), case.steps * case.step, step=case.step, progress=False, **options)
        history = result.history
        if name not in known:
            np.savez(own / f"{name}.npz", **dict(arrays_of(history)))  # type: ignore[arg-type]
            known.add(name)
        counters = history.counters
        print(json.dumps([counters["seconds_in_graph"] / max(counters["steps"], 1), result.status]), flush=True)


def start(tree: Path, folder: Path, own: Path) -> subprocess.Popen:
    """A server with the package of `tree`."""
    own.mkdir()
    paths = os.pathsep.join(map(str, (tree, tree / "kernels")))
    return subprocess.Popen(
        [sys.executable, str(HERE), "--serve", str(folder), str(own)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        text=True, env={**os.environ, "PYTHONPATH": paths}, cwd=own,
    )  # fmt: skip


def ask(server: subprocess.Popen, name: str) -> tuple[float, str]:
    assert server.stdin is not None and server.stdout is not None
    server.stdin.write(name + "\n")
    server.stdin.flush()
    for line in server.stdout:
        if line.startswith("["):  # the rest is what libraries print
            seconds, status = json.loads(line)
            return seconds, status
    raise SystemExit(f"{name}: a run ended without an answer; see its message above")


def difference(ours: Path, theirs: Path) -> tuple[float, str, list[str]]:
    """Largest difference of two results over the largest entry of its array, where, and what only one of them has."""
    a, b = np.load(ours), np.load(theirs)
    alone = sorted(set(a.files) ^ set(b.files))
    worst = (0.0, "")
    for name in sorted(set(a.files) & set(b.files)):
        if a[name].shape != b[name].shape:
            return float("inf"), name, alone
        if not np.array_equal(a[name], b[name], equal_nan=a[name].dtype.kind == "f"):
            x, y = a[name].astype(float), b[name].astype(float)
            worst = max(worst, (float(np.nanmax(np.abs(x - y)) / max(np.nanmax(np.abs(y)), 1e-300)), name))
    return *worst, alone


@dataclass
class Measured:
    """Times of a scene [s a step] by tree, one list for each pair of processes, and how its runs ended."""

    times: list[dict[str, list[float]]]
    status: str = ""


def compare(base: Path, rounds: int, processes: int, names: list[str], folder: Path, bodies: Path) -> list[dict]:
    """Rows of the table; both trees run here, in turn."""
    head = HERE.parent.parent
    for name, make in BODIES.items():
        if not (bodies / f"{name}.h5").exists():
            make().save(bodies / f"{name}.h5")
    found = {name: Measured([]) for name in names}
    for p in range(processes):
        servers = {
            label: start(tree, bodies, folder / f"{label}{p}") for label, tree in (("base", base), ("head", head))
        }
        try:
            for name, measured in found.items():
                measured.times.append(times_of(name, servers, rounds, measured))
        finally:
            for server in servers.values():
                server.communicate()
    return [row_of(name, measured, folder) for name, measured in found.items()]


def times_of(
    name: str, servers: dict[str, subprocess.Popen], rounds: int, measured: Measured
) -> dict[str, list[float]]:
    """Of one pair of processes, asked in turn."""
    times: dict[str, list[float]] = {label: [] for label in servers}
    for i in range(WARM_UP + rounds):
        for label in sorted(times, reverse=bool(i % 2)):
            seconds, measured.status = ask(servers[label], name)
            if i >= WARM_UP:
                times[label].append(seconds)
    return times


def row_of(name: str, measured: Measured, folder: Path) -> dict:
    """The row of one scene, printed."""
    fastest = [{label: min(found) for label, found in times.items()} for times in measured.times]
    far, where, alone = difference(folder / "head0" / f"{name}.npz", folder / "base0" / f"{name}.npz")
    best = {label: min(times[label] for times in fastest) for label in fastest[0]}
    ratios = [times["head"] / times["base"] for times in fastest]
    row = {
        "scene": name, **best, "ratio": best["head"] / best["base"], "range": [min(ratios), max(ratios)],
        "difference": far, "where": where, "alone": alone, "status": measured.status,
    }  # fmt: skip
    print(line_of(row), flush=True)
    return row


def line_of(row: dict) -> str:
    """A row as it is printed."""
    result = "same bits" if row["difference"] == 0.0 else f"{row['difference']:.1e} in {row['where']}"
    times = f"{1e6 * row['base']:9.1f} {1e6 * row['head']:9.1f} {row['ratio']:7.3f}"
    low, high = row["range"]
    alone = f"; in one only: {', '.join(row['alone'])}" if row["alone"] else ""
    return f"{row['scene']:18s}{times} ({low:.3f} to {high:.3f})  {result}{alone}; {row['status']}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", default="HEAD", help="commit to compare the working tree with (default: the last)")
    parser.add_argument("--rounds", type=int, default=5, help="runs of a scene in a process")
    parser.add_argument("--processes", type=int, default=5, help="pairs of processes")
    parser.add_argument("--scenes", nargs="*", default=list(CASES), choices=list(CASES), metavar="NAME")
    parser.add_argument("--slower", type=float, default=SLOWER, help="tolerated fraction of the time of a step")
    parser.add_argument("--different", type=float, default=DIFFERENT, help="tolerated difference of results")
    parser.add_argument("--bodies", type=Path, help="keep the reduced bodies in this folder, for the next comparison")
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--serve", nargs=2, type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.serve:
        serve(*given.serve)
        return 0
    git = ["git", "-C", str(HERE.parent)]
    commit = subprocess.run([*git, "rev-parse", "--short", given.base], capture_output=True, text=True)
    if commit.returncode:
        raise SystemExit(f"--base {given.base}: git knows no such commit; give one of `git log --oneline`")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run([*git, "worktree", "add", "--quiet", "--detach", str(folder / "tree"), given.base], check=True)
        try:
            print(f"base: {commit.stdout.strip()}, head: the working tree; us a step, head over base (by process)")
            bodies = (given.bodies or folder).resolve()
            bodies.mkdir(parents=True, exist_ok=True)
            rows = compare(folder / "tree", given.rounds, given.processes, given.scenes, folder, bodies)
        finally:
            subprocess.run([*git, "worktree", "remove", "--force", str(folder / "tree")], check=True)
    if given.json:
        from warpffrf.study.machine import machine

        given.json.write_text(json.dumps({**machine(), "base": commit.stdout.strip(), "rows": rows}, indent=1) + "\n")
    bad = [r for r in rows if r["ratio"] > 1.0 + given.slower or not r["difference"] <= given.different]
    for row in bad:
        print(f"not as before: {row['scene']}")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
