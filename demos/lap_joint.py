r"""A lap joint: two strips, two bolts, a vibration that dies out by friction, and a load cycle of the same amplitude.

Two steel strips of 160 x 30 x 8 mm lie on each other over 60 mm, and two bolts through both draw them together. The
lower strip is held at its end, that of the upper one is fixed to a carriage of 25 kg which a guide leaves free along
x alone. A bolt is a spring between the middles of its two heads, shorter than the clamped length. So it follows the
heads where strips bend, and tilts where they slide. Only friction holds the strips on each other.

**Ring-down.** Pulled to 80 % of the force at which the strips slide and released, the carriage vibrates. From peak to
peak friction dissipates as much as in a **loop** of load steps at the amplitude of that cycle, D = oint F dx: within 1
to 2 %, since the carriage oscillates about a position slightly off that at rest. The loop has the equivalent damping 2
zeta = D/(2 pi U), U = F a/2, which falls with the amplitude.

At small amplitudes all cells stick, and the frequency is that of the first eigenmode, 386 Hz; at larger amplitudes the
frequency falls with the secant stiffness of the loops. `modes.equivalent_damping` returns both over the amplitude.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import warpffrf as wf

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
FREE, OVERLAP, WIDTH, THICKNESS = 0.1, 0.06, 0.03, 0.008  # m, of a strip: free, on the other one
BOLTS, HOLE, HEAD = (0.015, 0.045), 0.004, 0.008  # m: positions along the overlap, half of hole and washer, square
TIGHTENED, SHANK = 8e3, 3.5e8  # N, N/m: of an M8 bolt, preload before the strips are compressed
FRICTION, CARRIAGE = 0.2, 25.0  # -, kg
PULL = 2300.0  # N: force from which the carriage is released
RHO_INF = 0.5  # damps faces that open and close in steps that do not resolve it
CYCLE, HALF = 2, 16  # of the vibration, at whose amplitude the loop is made; load steps of half a loop
JOINT = "joint"
END = OVERLAP + FREE  # m, where the carriage is
Strips = tuple[wf.ReducedBody, wf.ReducedBody]


@dataclass(frozen=True)
class Size:
    """Edges (k,) [m] of cells along half of the overlap and across half of the width, cells along the rest of a strip;
    steps of a cycle, cycles; load steps of the eigenmode's cycle."""

    along: tuple[float, ...] = (0.0, 0.004, 0.007, 0.009, 0.011, 0.015, 0.019, 0.021, 0.023, 0.026, 0.03)
    across: tuple[float, ...] = (0.0, 0.004, 0.006, 0.008, 0.011, 0.015)
    beside: int = 5
    steps: int = 100
    cycles: int = 9
    mode_steps: int = 32


FULL = Size()
QUICK = Size((0.0, 0.007, 0.011, 0.019, 0.023, 0.03), (0.0, 0.004, 0.008, 0.015), 3, steps=60, mode_steps=16)


def strip(size: Size = FULL, *, upper: bool = False) -> wf.mesh.Mesh:
    """The lower strip in z < 0, its end at x = -FREE, or the upper one above it, its end at x = OVERLAP + FREE; facet
    sets `overlap`, `head0`, `head1`."""
    half = np.array(size.across)
    y = np.concatenate([-half[:0:-1], half])
    lap = np.concatenate([size.along, 0.5 * OVERLAP + np.array(size.along[1:])])
    x, z = np.concatenate([np.linspace(-FREE, 0.0, size.beside + 1)[:-1], lap]), np.array([-THICKNESS, 0.0])
    if upper:
        x, z = (OVERLAP - x)[::-1], -z[::-1]
    middle, side = 0.5 * (x[1:] + x[:-1]), np.abs(0.5 * (y[1:] + y[:-1]))
    hole = (np.abs(middle[:, None] - BOLTS).min(axis=1) < HOLE)[:, None] & (side < HOLE)
    name, touching, outer = ("upper", "z_min", "z_max") if upper else ("lower", "z_max", "z_min")
    mesh = wf.mesh.grid(x, y, z, filled=~hole[:, :, None], name=name)
    mesh = mesh.select("overlap", touching, lambda c: (c[:, 0] > 0.0) & (c[:, 0] < OVERLAP))
    for i, place in enumerate(BOLTS):
        mesh = mesh.select(f"head{i}", outer, lambda c, x=place: np.abs(c[:, :2] - (x, 0.0)).max(axis=1) < HEAD)
    return mesh


def bodies(size: Size = FULL, *, progress: bool = True) -> Strips:
    """The lower strip and the upper one, reduced; cells of the contact are facets."""
    lower, upper = (
        wf.reduce(
            strip(size, upper=over), STEEL, interfaces={end: "rigid", "head0": "average", "head1": "average"},
            contact={"overlap": wf.surfaces.Matched(first="overlap")}, modes=10, cache=False, progress=progress,
        )
        for over, end in ((False, "x_min"), (True, "x_max"))
    )  # fmt: skip
    return lower, upper


def machine(strips: Strips, *, pull: wf.signals.Table | None = None, place: wf.signals.Table | None = None) -> wf.Scene:
    """The scene around strips that are already reduced: bodies `lower`, `upper`, `carriage`, joint `guide`, springs
    `bolt0`, `bolt1`, small-sliding contact `joint`; with a force `pull` [N] along the guide, or driven to `place`
    [m]."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    lower, upper = (scene.add_body(body, name=name) for body, name in zip(strips, ("lower", "upper"), strict=True))
    middle, inertia = (END, 0.0, 0.5 * THICKNESS), (0.05, 0.05, 0.05)
    carriage = scene.add_rigid_body(CARRIAGE, inertia, name="carriage", position=middle)
    scene.add(wf.joints.Fixed(scene.ground, lower["x_min"], name="clamp"))
    scene.add(wf.joints.Fixed(carriage, upper["x_max"], name="grip"))
    guide = scene.add(wf.joints.Prismatic(scene.ground, carriage, axis=(1, 0, 0), name="guide"))
    for name in ("0", "1"):
        heads = lower[f"head{name}"], upper[f"head{name}"]
        length = 2.0 * THICKNESS - TIGHTENED / SHANK
        scene.add(wf.forces.SpringDamper(*heads, SHANK, free_length=length, name=f"bolt{name}"))
    scene.add(wf.Contact(lower["overlap"], upper["overlap"], sliding="small", friction=FRICTION, name=JOINT))
    if pull is not None:
        scene.add(wf.forces.PointForce(carriage, (pull, 0.0, 0.0), name="pull"))
    if place is not None:
        scene.add(wf.joints.Drive(guide, place, quantity="position", name="drive"))
    return scene


def let_go(force: float) -> wf.signals.Table:
    """Pulled to `force` [N] in a second of load steps, and released."""
    return wf.signals.Table([0.0, 1.0, 1.0 + 1e-9, 10.0], [0.0, force, 0.0, 0.0])


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene that is pulled and released."""
    return machine(bodies(size, progress=progress), pull=let_go(PULL))


def ring_down(
    strips: Strips, force: float, frequency: float, size: Size, *, progress: bool = True
) -> tuple[wf.Result, float]:
    """Load steps up to `force` [N], and the cycles after the release, about those of `frequency` [Hz]; the position of
    the carriage at rest [m]."""
    scene = machine(strips, pull=let_go(force))
    pulled = wf.static(scene, 1.0, step=0.1, progress=progress)
    result = wf.simulate(
        scene, (size.cycles + 0.6) / frequency, step=1.0 / (size.steps * frequency), start=pulled,
        options=wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(RHO_INF)), progress=progress,
    )  # fmt: skip
    return result, float(pulled.body("carriage").position[0, 0])


def loaded(strips: Strips, places: np.ndarray, *, progress: bool = True) -> wf.Result:
    """Load steps in which the carriage is driven to `places` (n,) [m], a second each."""
    times = np.arange(len(places), dtype=float)
    scene = machine(strips, place=wf.signals.Table(times, places))
    return wf.static(scene, times[-1], step=1.0, progress=progress)


def main(out: str | Path = "out/lap_joint", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write lap_joint.h5, .rrd and .png of the vibration, and lap_joint.loop.h5 of the load steps, into the folder
    `out` and print the figures; quick: larger cells and steps."""
    stem, size = Path(out) / "lap_joint", QUICK if quick else FULL
    strips = bodies(size, progress=progress)
    frequency = float(wf.eigenmodes(machine(strips)).frequencies[0])
    result, rest = ring_down(strips, PULL, frequency, size, progress=progress)
    x, loss, t = result.body("carriage").position[:, 0] - rest, result.contact(JOINT).loss, result.time - result.time[0]
    tops = np.append(0, 1 + np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]) & (x[1:-1] > 0.0)))
    first, last = tops[CYCLE - 1], tops[CYCLE]
    a = 0.5 * (0.5 * (x[first] + x[last]) - x[first:last].min())
    places = np.concatenate([np.linspace(0.0, a, HALF + 1), np.linspace(a, -a, HALF + 1)[1:],
                             np.linspace(-a, a, HALF + 1)[1:]])  # fmt: skip
    load_steps = loaded(strips, rest - END + places, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    load_steps.save(f"{stem}.loop.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 220, overwrite=True)

    force = load_steps.joint("guide").force[:, 0]
    loop = load_steps.hysteresis(force, places).loop(float(HALF), float(3 * HALF))
    taken = load_steps.contact(JOINT).loss_between(float(HALF), float(3 * HALF))
    figure, (motion, cycle, cells) = plt.subplots(1, 3, figsize=(15.0, 4.0), layout="constrained")
    motion.plot(t * 1e3, x * 1e6)
    motion.set(xlabel="time [ms]", ylabel="place of the carriage [µm]", title="Released")
    cycle.plot(places * 1e6, force * 1e-3)
    cycle.set(xlabel="place of the carriage [µm]", ylabel="force [kN]", title="Load steps")
    load_steps.plot("stick_slip", cells, row=HALF)
    figure.savefig(f"{stem}.png")
    plt.close(figure)

    print(f"cycle {CYCLE}, amplitude {a * 1e6:.2f} um: friction takes {(loss[last] - loss[first]) * 1e3:.4f} mJ, "
          f"in the loop {taken * 1e3:.4f} mJ, area of the loop {loop.loss * 1e3:.4f} mJ")  # fmt: skip
    print(f"damping of the loop, D/(2 pi U): 2 zeta = {taken / (np.pi * loop.force_amplitude * a):.5f}")
    print(f"frequency of cycle {CYCLE} {1.0 / (t[last] - t[first]):.1f} Hz, of the eigenmode {frequency:.1f} Hz")
    return [result, load_steps]


if __name__ == "__main__":
    main()
