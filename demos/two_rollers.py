"""Two hollow steel rollers, pressed together and rolling under a load step.

The lower roller turns on a fixed axle. The upper one turns in a carriage that slides on a sprung vertical guide and is
pressed down by a force. The run starts from the static equilibrium under that force; both axles are driven smoothly to
equal and opposite speeds; then, while they roll, the force rises smoothly to its second value. Contact is
frictionless: nothing but the drives keeps the surface speeds equal.

What to expect: the contact carries the force on the carriage and the weight above it, less what the spring of the guide
takes; across the patch at mid-width the pressure is close to Hertz's line contact at the line load found there,

    a^2 = 4 P' R / (pi E*),   p0 = 2 P' / (pi a),   1/R = 1/R1 + 1/R2,   E* = E / (2 (1 - nu^2))

(K. L. Johnson, Contact Mechanics, 1985, section 4.2); the ends of the rollers carry less than the middle.
"""

from __future__ import annotations

import json
import logging
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import writable_folder

log = logging.getLogger("warpffrf")

OUTER_RADIUS, BORE_RADIUS, WIDTH = 0.05, 0.015, 0.02  # m
GRADING = (
    1.3  # thickness of a layer over that of its neighbour towards the rim; 17 layers make the cells at the rim square
)
MAX_FREQUENCY = 20e3  # Hz, of the vibration modes
GRAVITY = 9.81  # m/s2
CARRIAGE_MASS, CARRIAGE_INERTIA = 5.0, (0.01, 0.01, 0.01)  # kg, kg m2; it slides and never turns
GUIDE_STIFFNESS, GUIDE_DAMPING = 1e6, 2e3  # N/m, N s/m: soft beside the contact (about 1e9 N/m)
LOAD, LOAD_AFTER = 20e3, 26e3  # N, on the carriage, before and after the load step
LOAD_STEP_AT, LOAD_STEP_TAKES = 0.055, 0.010  # s
SPEED, SPIN_UP = 100.0, 0.02  # rad/s reached within s
DURATION, STEP = 0.1, 1e-4  # s
SETTLED = 0.01  # s at the end of the run over which the summary averages
PAIR, GUIDE = "lower-upper", "guide"


@dataclass(frozen=True)
class Size:
    """How fine a roller is meshed, in linear hexahedra, and how many frames the recording shows at most."""

    sectors: int
    layers: int
    axial: int
    frames: int = 300


FULL = Size(sectors=2400, layers=17, axial=6)  # four elements a half-width
QUICK = Size(sectors=2400, layers=17, axial=4, frames=60)


def build(size: Size = FULL, *, load: float = LOAD, load_after: float = LOAD_AFTER, progress: bool = True) -> wf.Scene:
    """The scene, with its roller meshed and reduced; `load` and `load_after` [N] press the carriage down.

    Bodies `lower`, `upper`, `carriage`; joints `axle`, `guide`, `upper_axle`; contact pair `lower-upper`. The cache of
    reduced bodies is not used, because the demo reports what the reduction costs.
    """
    return machine(roller_body(size, progress=progress), load=load, load_after=load_after, load_step_at=LOAD_STEP_AT)


def roller_body(
    size: Size = FULL, *, contact_fixed: bool | None = None, local_dynamics: bool = False, progress: bool = True
) -> wf.ReducedBody:
    """The reduced roller, with interface `bore` and contact surface `rim`; the options as of `reduce`."""
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
    mesh = wf.mesh.roller(
        OUTER_RADIUS,
        BORE_RADIUS,
        WIDTH,
        sectors=size.sectors,
        layers=size.layers,
        axial=size.axial,
        grading=GRADING,
        order=1,
    )
    return wf.reduce(
        mesh,
        steel,
        interfaces={"bore": "rigid"},
        contact={"rim": wf.surfaces.Cylinder()},
        max_frequency=MAX_FREQUENCY,
        contact_fixed=contact_fixed,
        local_dynamics=local_dynamics,
        cache=False,
        progress=progress,
    )


def machine(
    roller: wf.ReducedBody,
    *,
    load: float = LOAD,
    load_after: float = LOAD_AFTER,
    load_step_at: float,
    speed: float = SPEED,
) -> wf.Scene:
    """The scene of `build` around a roller that is reduced already, with interface `bore` and contact surface `rim`;
    the force changes from `load_step_at` [s] on, and the axles are driven to `speed` [rad/s]."""
    scene = wf.Scene(gravity=(0, 0, -GRAVITY))
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * OUTER_RADIUS))
    contact = scene.add(wf.Contact(lower["rim"], upper["rim"], name=PAIR))
    scene.close_gap(contact)
    carriage = scene.add_rigid_body(
        CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=upper["bore"].world_point()
    )
    center = carriage.at((0, 0, 0))
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    guide = scene.add(wf.joints.Prismatic(scene.ground, center, axis=(0, 0, 1), name=GUIDE))
    upper_axle = scene.add(wf.joints.Revolute(center, upper["bore"], axis=(0, 1, 0), name="upper_axle"))
    scene.add(wf.forces.JointSpringDamper(guide, GUIDE_STIFFNESS, GUIDE_DAMPING))
    for joint, end in ((axle, speed), (upper_axle, -speed)):
        spin = wf.signals.SmoothStep(0.0, end, duration=SPIN_UP)
        scene.add(wf.joints.Drive(joint, spin, quantity="velocity"))
    press = wf.signals.SmoothStep(load, load_after, duration=LOAD_STEP_TAKES, delay=load_step_at)
    scene.add(wf.forces.PointForce(center, (press, (0, 0, -1))))
    return scene


def static_force(scene: wf.Scene, result: wf.Result, load: float) -> float:
    """What the contact must carry at the end by statics [N]: load and weight above it, less the spring of the guide."""
    above = scene.body("upper").mass + scene.body("carriage").mass
    return load + above * GRAVITY + GUIDE_STIFFNESS * float(_mean(result, result.joint(GUIDE).coordinate))


def _mean(result: wf.Result, values: np.ndarray) -> float:
    """Mean over the last `SETTLED` seconds of a run."""
    return float(np.mean(values[result.time >= result.time[-1] - SETTLED]))


def summary(scene: wf.Scene, result: wf.Result, seconds: dict[str, float], unit: float) -> dict[str, Any]:
    """Figures of the run as plain numbers in SI units; contact figures are means over the last `SETTLED` seconds.

    seconds: wall time of each part, with the parts `offline`, `set-up` and `run` among them; unit: U [s].
    """
    contact = result.contact(PAIR)
    rows = np.flatnonzero(result.time >= result.time[-1] - SETTLED)
    hertz = [contact.hertz(int(i)) for i in rows]
    counters = result.history.counters
    roller: Any = scene.body("lower").reduced
    steps = int(counters["steps"])
    iterations = result.history.iterations[1:]
    width = _mean(result, contact.half_width)
    step_seconds = counters["seconds_in_graph"] / max(steps, 1)
    return {
        "status": result.status,
        "message": result.message,
        "contact_force": _mean(result, contact.force_magnitude),
        "static_force": static_force(scene, result, LOAD_AFTER),
        "half_width": width,
        "peak_pressure": _mean(result, contact.mid_peak_pressure),
        "hertz_half_width": float(np.mean([h.half_width for h in hertz])),
        "hertz_peak_pressure": float(np.mean([h.peak_pressure for h in hertz])),
        "averaged_from": float(result.time[rows[0]]),
        "averaged_to": float(result.time[rows[-1]]),
        "elements_per_half_width": width / float(np.mean(contact.spacing)),
        "local_modes_per_body": roller.local_modes,
        "global_modes_per_body": len(roller.frequencies),
        "fe_dofs_per_body": int(roller.report["dofs"]),
        "active_hats": _mean(result, contact.active_hats),
        "outer_columns": int(counters["outer_columns"]),
        "steps": steps,
        "rejected_steps": int(counters["rejected_steps"]),
        "newton_iterations_mean": float(iterations.mean()) if len(iterations) else 0.0,
        "newton_iterations_max": int(iterations.max(initial=0)),
        "energy_residual": float(np.ptp(result.energy_residual)),
        "offline_seconds": seconds["offline"],
        "online_seconds": seconds["set-up"] + seconds["run"],
        "seconds": seconds,
        "step_seconds": step_seconds,
        "unit_seconds": unit,
        "step_units": step_seconds / unit,
    }


def table(s: dict[str, Any]) -> str:
    """The summary as text."""
    rows = [
        ("contact force [kN]", s["contact_force"] / 1e3, s["static_force"] / 1e3, "statics"),
        ("half-width [um]", s["half_width"] * 1e6, s["hertz_half_width"] * 1e6, "Hertz"),
        ("peak pressure [MPa]", s["peak_pressure"] / 1e6, s["hertz_peak_pressure"] / 1e6, "Hertz"),
    ]
    lines = [f"{'':<24}{'computed':>12}{'expected':>12}{'difference':>12}"]
    lines += [f"{name:<24}{a:>12.5g}{b:>12.5g}{a / b - 1:>+12.2%}  {who}" for name, a, b, who in rows]
    lines += [
        f"  means over {s['averaged_from'] * 1e3:.4g} to {s['averaged_to'] * 1e3:.4g} ms, at mid-width; "
        f"{s['elements_per_half_width']:.2f} elements a half-width",
        "",
        f"each roller             {s['fe_dofs_per_body']} FE dofs, {s['local_modes_per_body']} local modes, "
        f"{s['global_modes_per_body']} global modes",
        f"wall time per step      {s['step_seconds'] * 1e6:.4g} us = {s['step_units']:.3g} U "
        f"(U = {s['unit_seconds'] * 1e6:.4g} us: Cholesky factor-and-solve of size 128)",
        f"a step                  {s['active_hats']:.3g} active hats, {s['outer_columns']} outer columns, "
        f"{s['newton_iterations_mean']:.2f} Newton iterations (largest {s['newton_iterations_max']}), "
        f"{s['rejected_steps']} of {s['steps']} steps halved",
        f"energy residual         {s['energy_residual']:.2e} of the energy at hand",
    ]
    total = sum(s["seconds"].values())
    shares = ", ".join(f"{name} {value:.1f} s ({value / total:.0%})" for name, value in s["seconds"].items())
    return "\n".join([*lines, f"wall time {total:>8.1f} s    {shares}"])


def main(out: str | Path = "out/two_rollers", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write two_rollers.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: fewer cells along the axis and fewer frames. Raises `InputError` for a folder that cannot be written.
    """
    from warpffrf.output.plots.figure import write_figure
    from warpffrf.output.recording.recorder import record
    from warpffrf.study.machine import unit_seconds

    folder = writable_folder(out)
    size = QUICK if quick else FULL
    seconds: dict[str, float] = {}

    log.info("1/3 meshing and reducing the roller")
    begin = time.perf_counter()
    scene = build(size, progress=progress)
    seconds["offline"] = time.perf_counter() - begin
    log.info("%s", scene.check())

    log.info("2/3 equilibrium and %g ms of rolling; the first time, the kernels are compiled", DURATION * 1e3)
    begin = time.perf_counter()
    result = wf.simulate(scene, DURATION, step=STEP, start="equilibrium", progress=progress)
    seconds["set-up"] = float(result.history.counters["build_seconds"])
    seconds["run"] = time.perf_counter() - begin - seconds["set-up"]
    if result.status != "completed":
        log.error("the run ended early, %s: %s", result.status, result.message)
    if not len(result.time):
        return 1

    log.info("3/3 writing results, recording and figure")
    begin = time.perf_counter()
    stem = folder / "two_rollers"
    result.save(stem.with_suffix(".h5"), overwrite=True)
    info = record(result, stem.with_suffix(".rrd"), max_frames=size.frames, overwrite=True)
    write_figure(result, stem.with_suffix(".png"), overwrite=True)
    seconds["files"] = time.perf_counter() - begin
    figures = summary(scene, result, seconds, unit_seconds())
    (folder / "summary.json").write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    print(table(figures))
    print(f"written to {folder}: two_rollers.h5, .png, summary.json and .rrd ({info.frames} frames); see it with")
    print(f"  rerun {stem.with_suffix('.rrd')}")
    return 0 if result.status == "completed" else 1
