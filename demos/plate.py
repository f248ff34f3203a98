r"""A clamped plate that deflects by twice its thickness: under pressure, then released, and its frequency by amplitude.

A square plate a hundred times as wide as thick is clamped in a rigid rim. Under pressure it bends, and from about half
of its thickness on it stretches as well: to third order in its deflection w

    q = c_1 w + c_3 w^3,

the second term from a membrane force in proportion to w^2. At w = 2 t a plate that only bends would deflect nearly
three times as much. The stretching is constrained by the plate itself and absent from loads at interfaces: the rim is
one rigid interface and does not move. So `stiffening=True` has no effect here, and `stiffening="membrane"` includes all
of it.

*Under pressure*, in load steps at the loads of S. Levy's table (NACA Report 740, 1942), whose series has an error of
2 %. *Released*: higher modes are damped soon, the first one slowly, so that the plate vibrates in its nonlinear first
mode with ever smaller amplitude A. Each cycle is a point of its frequency by A, which rises with A: by 17 % at A = t,
by one term and Duffing's equation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

LEVY = {17.79: 0.237, 38.3: 0.471, 63.4: 0.695, 95.0: 0.912, 134.9: 1.121, 184.0: 1.323, 245.0: 1.521, 318.0: 1.714,
        402.0: 1.902}  # q a^4/(E t^4) -> w/t of the middle  # fmt: skip
SIDE, THICKNESS = 0.4, 4e-3  # m
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.316, density=7850, name="steel")
UNIT = STEEL.youngs_modulus * (THICKNESS / SIDE) ** 4  # Pa, of q a^4/(E t^4) = 1
BENDING = STEEL.youngs_modulus * THICKNESS**3 / (12.0 * (1.0 - STEEL.poisson_ratio**2))  # N m
FREQUENCY = 35.985 / (2.0 * np.pi * SIDE**2) * np.sqrt(BENDING / (STEEL.density * THICKNESS))  # Hz, thin plate
GRADED = 1.5  # exponent by which cells become smaller towards the rim
MODES = 20
FIRST, HIGHER = 0.003, 0.05  # damping ratios
A_PERIOD = 60  # steps
STEP = float(1.0 / FREQUENCY / A_PERIOD)  # s; in the first one the pressure vanishes


@dataclass(frozen=True)
class Size:
    """Quadratic cells along half of a side, loads of the static run, periods of the motion."""

    cells: int = 8
    loads: tuple[float, ...] = tuple(LEVY)
    periods: int = 150


FULL, QUICK = Size(), Size(cells=6, loads=(17.79, 134.9, 402.0), periods=120)


def half_lines(size: Size) -> np.ndarray:
    """Boundaries of cells (cells + 1,) [m] from the middle to the rim."""
    return 0.5 * SIDE * (1.0 - (1.0 - np.linspace(0.0, 1.0, size.cells + 1)) ** GRADED)


def plate_mesh(x: np.ndarray, size: Size) -> wf.mesh.Mesh:
    """A plate with cells between `x` along both sides, and the facet sets `rim`, of all sides at a distance of a/2, and
    `face`, its upper side except the cells at the rim."""
    cells = wf.mesh.grid(x, x, [-0.5 * THICKNESS, 0.5 * THICKNESS])
    outer = cells.outer_facets()
    inner = half_lines(size)[-2]
    at = np.abs(outer.centers(cells.points))
    rim = outer.kept(at[:, :2].max(axis=1) > 0.5 * SIDE * (1.0 - 1e-9))
    plain = wf.mesh.Mesh(cells.points, cells.cells, {**cells.facet_sets, "rim": rim}, name="plate")
    return plain.select("face", "z_max", lambda y: np.abs(y[:, :2]).max(axis=1) < inner)


def pressed_area(size: Size) -> float:
    """m2 of `face`."""
    return float(2.0 * half_lines(size)[-2]) ** 2


def build(
    size: Size = FULL, *, loads: Sequence[float] | None = None, damped: bool = True, progress: bool = True
) -> wf.Scene:
    """The scene: body `plate` in its rim; pressure on its face takes the `loads` q a^4/(E t^4) in sequence, a second
    each, and then vanishes."""
    chosen = size.loads if loads is None else loads
    half = half_lines(size)
    reduced = wf.reduce(
        plate_mesh(np.concatenate([-half[:0:-1], half]), size), STEEL, interfaces={"rim": "rigid", "face": "average"},
        modes=MODES, options=wf.ReductionOptions(stiffening="membrane", membrane_modes=MODES), progress=progress,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    damping = np.r_[FIRST, np.full(len(reduced.frequencies) - 1, HIGHER)] if damped else 0.0
    plate = scene.add_body(reduced, name="plate", stiffening=True, damping=damping)
    scene.add(wf.joints.Fixed(scene.ground, plate["rim"], name="clamp"))
    n = float(len(chosen))
    forces = UNIT * pressed_area(size) * np.array([0.0, *chosen, 0.0, 0.0])
    push = wf.signals.Table([*np.arange(n + 1.0), n + STEP, n + 1e3], forces)
    scene.add(wf.forces.PointForce(plate["face"], (0.0, 0.0, push), name="pressure"))
    return scene


def press(scene: wf.Scene, loads: Sequence[float], *, progress: bool = True) -> wf.Result:
    """The load steps of a scene of `build`."""
    return wf.static(scene, float(len(loads)), step=1.0, progress=progress)


def release(pressed: wf.Result, periods: float, *, progress: bool = True) -> wf.Result:
    """The motion after the load steps, `periods` of the linear first mode long."""
    return wf.simulate(pressed.scene, round(periods * A_PERIOD) * STEP, step=STEP, start=pressed, progress=progress)


def deflection(result: wf.Result) -> np.ndarray:
    """w/t (T,) of the middle of the upper side."""
    body, motion = result.scene.body("plate").flexible, result.body("plate")
    middle = int(np.argmin(np.linalg.norm(body.surface.points - [0.0, 0.0, 0.5 * THICKNESS], axis=1)))
    shape = np.asarray(body.surface.modes[:, middle, 2], dtype=float)
    return (motion.position[:, 2] + motion.modal @ shape) / THICKNESS


def cycles(t: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes A/t (n,) and frequencies (n,) [Hz] of the cycles from one upward crossing of zero to the next."""
    i = np.flatnonzero((w[:-1] < 0.0) & (w[1:] >= 0.0))
    cross = t[i] - w[i] * (t[i + 1] - t[i]) / (w[i + 1] - w[i])
    heights = [np.ptp(w[a:b]) for a, b in zip(i[:-1], i[1:], strict=True)]
    return 0.5 * np.array(heights), 1.0 / np.diff(cross)


def main(out: str | Path = "out/plate", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write plate.h5, .rrd and .png of the motion, and plate.pressed.h5 of the load steps, into the folder `out` and
    print the figures; quick: larger cells, fewer loads."""
    stem, size = Path(out) / "plate", QUICK if quick else FULL
    scene = build(size, progress=progress)
    linear = float(wf.eigenmodes(scene, 1, about="initial").frequencies[0])
    pressed = press(scene, size.loads, progress=progress)
    motion = release(pressed, size.periods, progress=progress)
    motion.save(f"{stem}.h5", overwrite=True)
    pressed.save(f"{stem}.pressed.h5", overwrite=True)
    wf.record(motion, f"{stem}.rrd", overwrite=True)

    q, w, t = np.array([0.0, *size.loads]), deflection(pressed), motion.time - pressed.time[-1]
    A, f = cycles(t, deflection(motion))
    save_panels([
        Panel("Middle under pressure", "qa⁴/Et⁴ [-]", "w/t [-]",
              {"plate": (q, w), "bending alone": (q, 0.00126 * UNIT * SIDE**4 / BENDING / THICKNESS * q)},
              limits=(0.0, 2.5), points={"Levy": (np.array(list(LEVY)), np.array(list(LEVY.values())))}),
        Panel("Released", "time [ms]", "w/t [-]", {"plate": (1e3 * t, deflection(motion))}),
        Panel("Frequency of a cycle by its amplitude", "A/t [-]", "f/f0 [-]", {"plate": (A, f / linear)}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    for load, found in zip(size.loads, w[1:], strict=True):
        print(f"qa4/Et4 = {load:6g}: w/t {found:.4f}, Levy {LEVY[load]:.3f}")
    print(f"first frequency {linear:.2f} Hz, thin plate {FREQUENCY:.2f} Hz")
    print(f"frequency at A = t over it {np.interp(1.0, A[::-1], f[::-1]) / linear:.4f}, one term and Duffing 1.1716")
    return [motion, pressed]


if __name__ == "__main__":
    main()
