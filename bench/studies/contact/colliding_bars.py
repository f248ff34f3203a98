r"""Impact of two bars: treatments of the local modes compared with St Venant; half a minute.

Two equal free bars meet end to end, flat face on flat face: St Venant's impact (`closed_forms.BarImpact`, case C8).
With quasi-static local modes the contact boundary carries no mass, and the highest retained modes ring against its
compliance after the step of load; with dynamic ones it carries mass and has hardly any compliance left, so that the
faces would bounce (`warpffrf_kernels.impulsive.impulsive_means`).

The bars are made from the closed form of a rod without lateral inertia, length L, so that nothing but the number N of
modes and the treatment of the rest differs from St Venant: with x from the left end and the mass m

    phi_n = sqrt(2/m) cos(n pi x/L),    omega_n = n pi c/L,    n = 1 to N,
    residual of n > N at an end, per force:    d = (2/m) (L/(pi c))^2 sum 1/n^2,
    its mass Gram matrix, for dynamic local modes:    (2/m) (L/(pi c))^4 sum 1/n^4,    no overlap with the first N.

A face is plane and moves as one: the displacement coefficients of its nodes are those of a uniform displacement,
M^-1 int psi, which the weak gap takes back exactly. FACE_COMPLIANCE of d is added to each node, so that pressures are
determined.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import zeta

from references.closed_forms import BarImpact
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery
from warpffrf.model.reduced.data import DisplaySurface
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Plane
from warpffrf.online.local_modes import EXACT_DAMPING, LocalModes
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate
from warpffrf.study.markdown import table

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
LENGTH, SIDE, SPEED = 1.0, 0.02, 0.1  # m, m, m/s
EXACT = BarImpact(STEEL, LENGTH, SIDE**2, SPEED)  # case C8
GAP = 1e-9  # m
FACE_COMPLIANCE = 1e-3  # of the residual compliance: stiffer than anything that the run resolves
PLATEAU = (0.2, 0.8)  # of the contact time, where force and exact force are compared
STEPS = 25.0  # in a period of the highest mode
AFTER = 1.15  # contact times that are run
MODES = (20, 50)
KEYS = ("duration", "impulse", "mean", "rms", "gained")
ALONG = np.array([0.0, 1.0, 0.0])


def bar(modes: int) -> ReducedBody:
    """A bar from (0, 0, 0) to (L, 0, 0), with `modes` longitudinal modes and contact surfaces "left" and "right"."""
    m = STEEL.density * LENGTH * SIDE**2
    n = np.arange(1, modes + 1)
    amplitude, scale = np.sqrt(2.0 / m), LENGTH / (np.pi * EXACT.wave_speed)
    rest = amplitude**2 * scale**2 * float(zeta(2.0, modes + 1.0))
    mass = amplitude**2 * scale**4 * float(zeta(4.0, modes + 1.0))
    ends = {"left": (0.0, -1.0, -amplitude * np.ones(modes)), "right": (LENGTH, 1.0, amplitude * (-1.0) ** n)}
    surfaces = {name: _face(name, x, sense, outward, rest, mass) for name, (x, sense, outward) in ends.items()}
    J = m / 12.0 * np.array([2.0 * SIDE**2, LENGTH**2 + SIDE**2, LENGTH**2 + SIDE**2])
    corners = np.array([[0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0], [LENGTH, SIDE, 0.0]])
    skin = DisplaySurface(corners, np.array([[0, 1, 2]]), np.zeros((modes, 3, 3)))
    center = np.array([0.5 * LENGTH, 0.0, 0.0])
    return ReducedBody(m, center, np.diag(J), n / (2.0 * np.pi * scale), {}, surfaces, skin)


def _face(name: str, x: float, sense: float, outward: np.ndarray, rest: float, mass: float) -> ContactSurface:
    """One column of two nodes; `outward` (modes,) displacement of the face per unit mode."""
    plane = Plane(origin=(x, 0.0, 0.0), outward=(sense, 0.0, 0.0), direction=ALONG)
    grid = SurfaceGrid(np.asarray(plane.e_0), 0.0, 0.5 * SIDE, 1, False, 0.5 * SIDE * np.array([-1.0, 1.0]), 1)
    M = np.kron(grid.gram_theta(), grid.gram_z(plane))
    # int psi, the nodes are half as wide as the face: pressures are twice what they would be, forces are not
    area = np.full(2, 0.5 * SIDE * 0.5 * SIDE)
    uniform = np.linalg.solve(M, area)
    whole = np.outer(uniform, uniform)
    D = rest * (whole + FACE_COMPLIANCE * np.diag(uniform**2))
    local = LocalMass(mass * whole[None], np.zeros((2, len(outward))))
    recovery = Recovery(np.zeros((1, 3, 2), np.float32), 1, np.eye(3))
    return ContactSurface(name, plane, grid, D[None], np.outer(uniform, outward), recovery, local_mass=local)


@dataclass(frozen=True)
class Collision:
    """What came of two bars that collide, relative to the exact values less 1, and the rms of the plateau."""

    duration: float
    impulse: float
    mean: float
    rms: float  # of force over exact force less 1
    gained: float  # largest energy over that at the start, less 1
    momentum: float  # largest change over the momentum
    status: str


def meeting(body: ReducedBody, *, speed: float = SPEED, gap: float = GAP, damping: Any = None) -> Scene:
    """Two bars "first", which comes at `speed` [m/s], and "second", at rest behind a `gap` [m]; contact "pair".
    damping: of the modes, None for the default of a body."""
    scene = Scene()
    first = scene.add_body(body, name="first", velocity=(speed, 0.0, 0.0), damping=damping)
    second = scene.add_body(body, name="second", position=(LENGTH + gap, 0.0, 0.0), damping=damping)
    scene.add(Contact(first["right"], second["left"], name="pair"))
    return scene


def collide(modes: int, *, damping: Any = None, local: Any = "quasi_static", phase: float = 0.0) -> Result:
    """Bars with `modes` modes meet at SPEED. damping: of the modes, None for the default; phase: of the touch in a
    step."""
    body = bar(modes)
    h = 1.0 / (STEPS * body.frequencies[-1])
    scene = meeting(body, gap=GAP + phase * SPEED * h, damping=damping)
    steps = int(np.ceil(AFTER * EXACT.duration / h))
    return simulate(scene, steps * h, step=h, options=RunOptions(local_modes=local), progress=False)


def measured(result: Result) -> Collision:
    """Time, impulse and plateau of a run."""
    history = result.history
    F = -history.contacts["pair"].force[:, 0]
    t = history.time
    on = np.flatnonzero(F > 0.0)
    begin, end = (t[max(on[0] - 1, 0)], t[on[-1]]) if len(on) else (0.0, 0.0)  # bounced between two saved steps
    plateau = (t > begin + PLATEAU[0] * EXACT.duration) & (t < begin + PLATEAU[1] * EXACT.duration)
    flat = F[plateau] / EXACT.force - 1.0
    scene: Any = history.scene
    mass = scene.body("first").mass
    energy = history.energy["kinetic"] + history.energy["strain"] + history.energy["contact"]
    v = history.bodies["first"].velocity[:, 0] + history.bodies["second"].velocity[:, 0]
    return Collision(
        float((end - begin) / EXACT.duration - 1.0),
        float(mass * history.bodies["second"].velocity[-1, 0] / EXACT.impulse - 1.0),
        float(flat.mean()), float(np.sqrt(np.mean(flat**2))), float(energy.max() / energy[0] - 1.0),
        float(np.ptp(v) / SPEED), history.status,
    )  # fmt: skip


TREATMENTS: dict[str, dict[str, Any]] = {
    "quasi_static, 10 % above half the highest frequency": {},
    "quasi_static, no damping": {"damping": 0.0},
    "hht, 10 % above half the highest frequency": {"local": LocalModes("hht")},
    "hht, no damping": {"local": LocalModes("hht"), "damping": 0.0},
    "exponential, 10 % above half the highest frequency": {"local": LocalModes("exponential")},
    "exponential, no damping": {"local": LocalModes("exponential"), "damping": 0.0},
}


def compute() -> list[list[str]]:
    """One row per treatment and number of modes."""
    rows = []
    for name, options in TREATMENTS.items():
        for modes in MODES:
            found = [measured(collide(modes, phase=phase, **options)) for phase in (0.0, 0.37, 0.71)]
            worst = [max((getattr(f, key) for f in found), key=abs) for key in KEYS]
            rows.append([name, str(modes), *(f"{value:+.2%}" for value in worst[:3]), *(f"{v:.2%}" for v in worst[3:])])
    return rows


def page(rows: list[list[str]]) -> str:
    """The whole page."""
    head = ["local modes, damping", "modes", "contact time", "impulse", "plateau mean", "plateau rms", "energy gained"]
    low, high = PLATEAU
    return f"""# Two bars collide

Two equal steel bars of {LENGTH:g} m, end to end, at {SPEED:g} m/s: St Venant's contact time
{EXACT.duration * 1e6:.2f} us and pressure {EXACT.stress / 1e6:.3f} MPa. Bars of the closed form of a rod, so that
nothing but the number of modes and the treatment of the rest differs from the exact solution. *Impulse*: momentum of
the bar that was struck. *Plateau*: from {low:g} to {high:g} of the contact time. *Energy gained*: its largest value
over that at the start. Worst of three phases of the touch in a step, {STEPS:g} steps in a period of the highest mode.
"10 % above half the highest frequency" is the default damping of a body.

{table(head, rows)}
*No damping* is that of the global modes. Without it the highest of them ring: with quasi-static local modes against the
compliance of the contact, which carries no mass, with dynamic ones against a face that is held. With dynamic local
modes the face has mass and meets next to no compliance; it loses its own kinetic energy in the steps in which it
closes, instead of bouncing. `exponential` integrates by HHT those modes that a step resolves, as here; it differs from
`hht` by its damping of {EXACT_DAMPING:.0%}.
"""
