r"""A leaf spring of four leaves, clamped in its middle: friction between leaves, hysteresis, loss of a load cycle.

The leaves are straight and lie flat on each other. A dowel in the middle holds them together; there they are one body,
and the spring is cut along the leaves elsewhere (`Mesh.cut`). U-bolts, a spring with preload between the axle below and
the uppermost leaf, press 8 cm of the middle together; the axle holds the lowest leaf there and is the ground. The frame
of the car presses the ends of the longest leaf down, between a fifth and all of the load.

What to expect: bent, the leaves touch only at the tips of the shorter ones, and open in between. Pressures at the tips
grow with the load, and with them friction, so that load against deflection is a loop: one straight line through the
origin while the load grows, one below it while it falls. At a reversal the tips stick at first, and the spring is five
times as stiff. Four beams that touch at the tips and are held rigidly at the edge of the clamp (derived in
tests/references/closed_forms/leaf_spring.py) have 14.66 mm of deflection and 205, 194 and 1002 N/mm. Here the leaves
slip at the rim of the clamp: the spring is 3 to 4 % softer, and the loss is 29 % larger than that of the tips.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import warpffrf as wf

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7850, name="steel, bent as beams are")
HALF = np.array([0.40, 0.31, 0.22, 0.13])  # m, of the leaves from the middle, from the uppermost down
THICK, WIDE, CLAMP, DOWEL = 0.01, 0.06, 0.04, 0.01  # m; the last two from the middle to either side
FRICTION = 0.3
BOLTS, PRELOAD, FEET = 1e9, 160e3, 0.2  # N/m, N; m below the top
LOAD, LEAST = 3e3, 0.2  # N at either end; of it
NUDGE = 0.999  # of the load, just after its reversal
MODES = 24  # only pictures depend on their number
JOINTS = [f"joint{i}" for i in range(1, len(HALF))]
ENDS = ("x_min", "x_max")


@dataclass(frozen=True)
class Size:
    """Length of the cells along the leaves [m], load steps from one load to the other."""

    cell: float = 0.005
    steps: int = 16


FULL, QUICK = Size(), Size(cell=0.01, steps=8)


def path(size: Size) -> np.ndarray:
    """The loads of the load steps [N]: up, a cycle, and once more down and up."""
    up = np.linspace(LEAST, 1.0, size.steps + 1)[1:]
    down = up[::-1] - (1.0 - LEAST) / size.steps
    nudged = np.concatenate([[NUDGE], down])
    return LOAD * np.concatenate([np.linspace(0.0, 1.0, size.steps + 1), down, up, nudged, up])


def spring_mesh(cell: float) -> wf.mesh.Mesh:
    """The leaves below z = 0: facet sets `jointN_high` and `jointN_low` of the cuts, `seat` under the bolts and `base`
    on the axle, `x_min` and `x_max` the ends of the longest leaf."""
    x = np.linspace(-HALF[0], HALF[0], 2 * round(HALF[0] / cell) + 1)
    filled = np.abs(0.5 * (x[1:] + x[:-1]))[:, None, None] < HALF[::-1]
    z = THICK * np.arange(-len(HALF), 1.0)
    mesh = wf.mesh.grid(x, (-0.5 * WIDE, 0.5 * WIDE), z, filled=filled, name="leaf spring")
    along = mesh.points[mesh.single[1]].mean(axis=1)[:, 0]
    mesh = replace(mesh, cell_sets={"arms": np.flatnonzero(np.abs(along) > DOWEL)})
    for i, name in enumerate(JOINTS):
        mesh = mesh.cut(name, point=(0.0, 0.0, -THICK * (i + 1)), normal=(0.0, 0.0, 1.0), cells="arms")

    def clamped(centers: np.ndarray) -> np.ndarray:
        return np.abs(centers[:, 0]) < CLAMP

    return mesh.select("seat", "z_max", clamped).select("base", "z_min", clamped)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: body `spring` on the joint `axle`, spring `bolts`, small-sliding contacts `joint1` (uppermost) to
    `joint3`, loads `x_min` and `x_max`; a second per load step."""
    faces = {name: wf.surfaces.Matched(f"{name}_low", first=f"{name}_high") for name in JOINTS}
    interfaces = {"base": "rigid", **dict.fromkeys(("seat", *ENDS), "average")}
    body = wf.reduce(
        spring_mesh(size.cell), STEEL, interfaces=interfaces, contact=faces, modes=MODES, progress=progress
    )
    loads = path(size)
    by_step = wf.signals.Table(np.arange(len(loads), dtype=float), -loads)
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    spring = scene.add_body(body, name="spring")
    scene.add(wf.joints.Fixed(scene.ground, spring["base"], name="axle"))
    feet = scene.ground.at((0.0, 0.0, -FEET))
    scene.add(wf.forces.SpringDamper(feet, spring["seat"], BOLTS, free_length=FEET - PRELOAD / BOLTS, name="bolts"))
    for end in ENDS:
        scene.add(wf.forces.PointForce(spring[end], (0.0, 0.0, by_step), name=end))
        scene.add(wf.sensors.Position(spring[end], name=end))
    for name in JOINTS:
        scene.add(wf.Contact(spring[name], sliding="small", friction=FRICTION, name=name))
    return scene


def run(scene: wf.Scene, size: Size = FULL, *, progress: bool = True) -> wf.Result:
    """All load steps, from the clamped spring without load."""
    return wf.static(scene, float(len(path(size)) - 1), step=1.0, progress=progress)


def main(out: str | Path = "out/leaf_spring", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write leaf_spring.h5, .rrd and .png into the folder `out` and print the figures; quick: larger cells and load
    steps."""
    stem, size = Path(out) / "leaf_spring", QUICK if quick else FULL
    result = run(build(size, progress=progress), size, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=40 if quick else 120, overwrite=True)

    load, n = path(size), size.steps
    z = np.mean([result.sensor(end).values[:, 2] for end in ENDS], axis=0)
    w = z[0] - z
    stiffness = np.diff(load) / np.diff(w) * 1e-3  # N/mm, of each load step
    figure, (loop, slope, rubbing) = plt.subplots(1, 3, figsize=(15.0, 4.0), layout="constrained")
    loop.plot(w * 1e3, load * 2e-3)
    loop.set(xlabel="deflection [mm]", ylabel="load [kN]", title="Load on both ends")
    slope.step(np.arange(1, len(load)), 2.0 * stiffness)
    slope.set(xlabel="load step", ylabel="[N/mm]", title="Stiffness of both ends")
    result.plot("friction_loss", rubbing, contact=JOINTS[0])
    rubbing.set(title="Leaves 1 and 2: where energy is lost", aspect="auto")
    figure.savefig(f"{stem}.png")
    plt.close(figure)

    begin, end = float(3 * n), float(len(load) - 1)
    loss = sum(result.contact(name).loss_between(begin, end) for name in JOINTS)
    work = result.hysteresis(2.0 * load, w).loop(begin, end).loss
    print(f"deflection under all of the load {w[n] * 1e3:8.3f} mm     beams 14.655")
    print(f"stiffness, load grows            {stiffness[n - 1]:8.2f} N/mm   beams 204.70")
    print(f"stiffness, load falls            {stiffness[2 * n - 1]:8.2f} N/mm   beams 193.85")
    print(f"stiffness, all stuck             {stiffness[3 * n]:8.2f} N/mm   beams 1001.86")
    print(f"loss of a cycle                  {loss:8.4f} J      work of the loads {work:.4f}")
    return [result]


if __name__ == "__main__":
    main()
