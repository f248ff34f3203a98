"""Inertia levels compared with closed forms: a bar, a disc, a ring; under a minute.

What each inertia level gives in three cases with closed forms (a bar that rotates about its end, a disc, a spinning
ring), what the indicator says of the terms left out, and what it costs.
"""

from __future__ import annotations

import textwrap
import time
from typing import Any

import numpy as np

from scenes import rotating_bar, rotating_disc, spinning_ring
from scenes.rollers import guided_pair, roller_body
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import LEVELS
from warpffrf.model.scene import Scene
from warpffrf.online import History, run
from warpffrf.online.compile.inertia_plan import BOUNDS, InertiaPlan
from warpffrf.online.diagnosis.inertia_indicator import FLAG, MOST_STEPS, percent, recommended, term_sizes
from warpffrf.study.markdown import table

BAR_CELLS = (15, 30, 60)
BAR_STEPS = (2e-5, 1e-5, 5e-6, 2.5e-6)  # s
BAR_FREQUENCIES = (3e3, 6e3, 12e3, 24e3)  # Hz
DISC_MESHES = ((12, 4), (24, 8), (48, 16))  # sectors, layers
RING_SECTORS = (48, 96, 192)
RING_STEPS = (2e-5, 1e-5, 5e-6, 2.5e-6)  # s
ROLLER_LOAD, ROLLER_SPEED, ROLLER_TIME, ROLLER_STEP = 20e3, 100.0, 0.04, 2e-4  # N, rad/s, s, s


def extrapolated(values: Any) -> float:
    """The limit of a sequence of order 2 that halves its step, from the last two."""
    return float((4.0 * values[-1] - values[-2]) / 3.0)


def bar_tables() -> tuple[str, str, str]:
    """The limit of the reduced bar in cells, in modes, and that of the run in steps."""
    bodies = [rotating_bar.bar(cells) for cells in BAR_CELLS]
    middle = bodies[1]
    meshes, steps, modes = [], [], []
    for level in LEVELS:
        exact = rotating_bar.closed_form(level)
        e = [rotating_bar.elongation(b, rotating_bar.stationary(b, level).q) for b in bodies]
        meshes.append([level, f"{exact:.6e}", *(f"{x / exact - 1.0:.1e}" for x in [*e, extrapolated(e)])])
        limit = e[1]
        found = rotating_bar.settled_sequence(middle, level, BAR_STEPS)
        steps.append([level, *(f"{x / limit - 1.0:.2e}" for x in found), f"{extrapolated(found) / limit - 1.0:.0e}"])
    limit = rotating_bar.elongation(middle, rotating_bar.stationary(middle, "full").q)
    for frequency in BAR_FREQUENCIES:
        body = rotating_bar.bar(terms=None, max_frequency=frequency)
        value = rotating_bar.elongation(body, rotating_bar.stationary(body, "full").q)
        modes.append([f"{1e-3 * frequency:g}", str(len(body.frequencies)), f"{value / limit - 1.0:.1e}"])
    cells = [f"{n} cells" for n in BAR_CELLS]
    return (
        table(["level", "closed form [m]", *cells, "extrapolated"], meshes),
        table(["modes up to [kHz]", "modes", "against all polynomials"], modes),
        table(["level", *(f"h = {1e6 * h:g} us" for h in BAR_STEPS), "extrapolated"], steps),
    )


def disc_table() -> str:
    """Errors of the disc's displacement and stress under refinement."""
    rows = []
    for mesh in DISC_MESHES:
        body = rotating_disc.disc(*mesh)
        for level in ("gyroscopic", "deformed"):
            s = rotating_disc.spin(body, level)
            stress = [f"{np.abs(x).max():.1e}" for x in (s.radial_stress, s.hoop_stress)]
            rows.append([f"{mesh[0]} x {mesh[1]}", level, f"{s.rim:.1e}", f"{s.bore:.1e}", *stress])
    return table(["sectors x layers", "level", "u(a)", "u(b)", "radial stress", "hoop stress"], rows)


def ring_tables(bodies: list[ReducedBody]) -> tuple[str, str]:
    """Frequencies of the ring under refinement, and the lag of its patterns on a sequence of steps."""
    frequencies, lags = [], []
    for n in (2, 3, 4):
        thin = spinning_ring.thin_ring(n)
        found = [float(b.frequencies[spinning_ring.pair(b, n)].mean()) for b in bodies]
        frequencies.append([str(n), f"{thin:.3f}", *(f"{f:.3f} ({f / thin - 1.0:+.2%})" for f in found)])
    body = bodies[1]
    for level in LEVELS:
        for n in (2, 3, 4):
            exact = spinning_ring.exact_lag(body, n, level)
            histories = [spinning_ring.spinning(body, n, level, h) for h in RING_STEPS]
            rates = np.array([spinning_ring.measured_lag(body, n, h) for h in histories])
            shown = [f"{r:.0e} rad/s" for r in rates] + [""]  # where the model has none
            if level in ("gyroscopic", "full"):
                shown = [f"{r / exact - 1.0:.1e}" for r in [*rates, extrapolated(rates)]]
            value = f"{exact:.6f}" if level in ("gyroscopic", "full") else "0"
            lags.append([level, str(n), f"{spinning_ring.thin_lag(n):.6f}", value, *shown])
    head = ["level", "waves", "thin ring [rad/s]", "reduced body [rad/s]", *(f"h = {1e6 * h:g} us" for h in RING_STEPS)]
    return (
        table(["waves", "thin ring [Hz]", *(f"{s} sectors" for s in RING_SECTORS)], frequencies),
        table([*head, "extrapolated"], lags),
    )


def indicator_rows(name: str, history: History, body: str) -> list[str]:
    """One line of the table of the indicator: a run, its level, and sizes."""
    scene: Any = history.scene
    levels = {b.name: plan.level for b, plan in zip(scene.bodies, InertiaPlan.of(scene).bodies, strict=True)}
    own = [s for s in term_sizes(scene, history.bodies, levels) if s.body == body]
    asked = scene.body(body).level
    used = f"auto: {levels[body]}" if asked == "auto" else asked
    shown = [percent(s.size) for s in own]
    return [
        name,
        used,
        *(f"**{x}**" if s.size > FLAG else x for x, s in zip(shown, own, strict=True)),
        recommended(own),
    ]


def rolling(level: str) -> History:
    """Two pressed rollers, as in the demo, on a coarse mesh."""
    body = roller_body(180, layers=5, axial=2, grading=1.6, order=2, cache=False)
    scene = guided_pair(body, body, load=ROLLER_LOAD, speed=ROLLER_SPEED, ramp=0.5 * ROLLER_TIME)
    for handle in scene.bodies:
        handle.level = level
    return run(scene, ROLLER_TIME, step=ROLLER_STEP, start="equilibrium", progress=False)


def indicator_table(ring: ReducedBody) -> tuple[str, str]:
    """Sizes of all terms in all cases; and the cost of the indicator."""
    rows: list[list[str]] = []
    bar, disc = rotating_bar.bar(), rotating_disc.disc(12, 4)
    for level in ("constant", "gyroscopic", "deformed", "auto"):
        rows.append(indicator_rows("bar", _spun_up(bar, level), "bar"))
    rows.append(indicator_rows("bar at 1 rad/s", _spun_up(bar, "auto", 1.0), "bar"))
    for level in ("constant", "deformed", "auto"):
        rows.append(indicator_rows("disc", rotating_disc.spin(disc, level).result.history, "disc"))
    for spin in (2.0, 20.0, spinning_ring.SPIN):
        for level in ("constant", "auto"):
            history = spinning_ring.spinning(ring, 2, level, 2e-5, spin=spin)
            rows.append(indicator_rows(f"ring at {spin:g} rad/s, two waves", history, "ring"))
    pressed = rolling("auto")
    rows.append(indicator_rows("two rollers", pressed, "lower"))
    scene: Any = pressed.scene
    levels = {b.name: "constant" for b in scene.bodies}
    begin = time.perf_counter()
    term_sizes(scene, pressed.bodies, levels)
    seconds = time.perf_counter() - begin
    modes = len(scene.body("lower").reduced.frequencies)
    stepping = pressed.counters["loop_seconds"]
    cost = (
        f"{1e3 * seconds:.1f} ms for {len(pressed.time)} saved steps of two bodies with {modes} modes each, "
        f"compared with "
        f"{1e3 * stepping:.0f} ms of stepping; at most {MOST_STEPS} steps of a run are looked at"
    )
    return table(["case", "level", "centrifugal", "deformed inertia", "gyroscopic", "recommended"], rows), cost


def _spun_up(body: ReducedBody, level: str, speed: float = rotating_bar.SPEED) -> History:
    scene: Scene = rotating_bar.bar_scene(body, level, speed=speed)
    duration = rotating_bar.SPIN_UP + rotating_bar.SETTLING
    return run(scene, duration, step=1e-4, save_every=10, progress=False)


def compute() -> dict[str, str]:
    """The tables of the page, and what the indicator costs."""
    meshes, modes, steps = bar_tables()
    rings = [spinning_ring.ring(sectors) for sectors in RING_SECTORS]
    frequencies, lags = ring_tables(rings)
    indicated, cost = indicator_table(rings[1])
    return {
        "meshes": meshes, "modes": modes, "steps": steps, "disc": disc_table(), "frequencies": frequencies,
        "lags": lags, "indicated": indicated, "cost": cost,
    }  # fmt: skip


def page(found: dict[str, str]) -> str:
    """The page of the study, its paragraphs filled."""
    return "\n\n".join(
        text if text.lstrip().startswith(("|", "#")) else textwrap.fill(text, 120)
        for text in (part.strip("\n") for part in _page(found).split("\n\n"))
    ) + "\n"  # fmt: skip


def _page(found: dict[str, str]) -> str:
    exact, gyroscopic, constant, linear = map(
        rotating_bar.closed_form, ("full", "gyroscopic", "constant", "linear")
    )  # fmt: skip
    solid = (1.0 - rotating_disc.STEEL.poisson_ratio) * rotating_disc.STEEL.density * rotating_disc.SPEED**2
    solid *= rotating_disc.OUTER**3 / (4.0 * rotating_disc.STEEL.youngs_modulus)
    bounds = ", ".join(f"{name} {bound:g}" for name, bound in BOUNDS.items())
    return f"""# Inertia levels against closed forms


Levels: "constant" (rotation and deformation do not interact), "gyroscopic" (centrifugal load J1 and Coriolis, Euler
forces G), "deformed" (J1, and J2: what the deformed shape adds), "full". The derivations are in
`tests/scenes/rotating_bar.py`, `rotating_disc.py`, `spinning_ring.py`.

## D1, a bar that rotates about its end

{rotating_bar.SPEED:g} rad/s, L = {rotating_bar.LENGTH:g} m, {rotating_bar.THICK:g} m thick. The frame moves with the
centre of mass, whose outward motion is therefore exact at every level: "constant" gives {constant:.6e} m, J1 makes it
{gyroscopic:.6e} m, and J2 the rest, {exact / gyroscopic - 1.0:.2%}, to tan(kL)/k - L = {exact:.6e} m. The value
{linear:.6e} m of a frame fixed at the axis, {exact / linear - 1.0:.2%} below the exact one, is that of no level: most
of that difference is the outward motion of the centre of mass.

Stationary state of the reduced model (six axial polynomials and the attachment modes of the ends) compared with the
closed form of each level, for linear cells; extrapolated from the last two meshes:

{found["meshes"]}

The same with vibration modes instead of polynomials, level "full", 30 cells:

{found["modes"]}

The run, spun up from rest and settled, compared with the stationary state of the same model (30 cells),
generalized-alpha
0.8; extrapolated from the last two steps:

{found["steps"]}

A slender bar ({rotating_bar.SLENDER:g} m) buckles in the plane of rotation at this speed unless it is given geometric
stiffening; the thick one does not.

## D2, a disc

Annulus, radii {rotating_disc.INNER:g} and {rotating_disc.OUTER:g} m, {rotating_disc.SPEED:g} rad/s, plane stress;
a solid disc of this radius grows by {solid:.3e} m. Errors of displacement at rim and bore, largest errors of stress at
radii of {", ".join(f"{x:g}" for x in rotating_disc.PLACES)} m over the largest hoop stress. The closed form does not
include the deformed shape: "deformed" lies above it by w^2 over the square of the lowest radial frequency, 1e-4.

{found["disc"]}

## D3, a thin ring

Curved quadratic cells, one through the wall. Frequencies of n waves in its plane:

{found["frequencies"]}

Spinning with {spinning_ring.SPIN:g} rad/s, one mode of the pair released: the rate at which the pattern rotates
relative to the material, of the thin ring (-2 Omega/(n^2 + 1)), of the reduced body ({RING_SECTORS[1]} sectors) by its
eigenvalues, and the error of the run compared with that; where there is no gyroscopic term, the rate itself.

{found["lags"]}

## The indicator

Sizes of the terms on the motion that a run found, bold above {FLAG:.0%}, and the level that it recommends. "auto" may
keep more than the indicator asks for afterwards, and in none of these cases keeps less; its estimates' bounds:
{bounds}.

{found["indicated"]}

On the bar the indicator's J2 is that of the closed forms ({exact / gyroscopic - 1.0:.2%} at the tip). "all": without
the load the disc does not deform at all. A centrifugal load that would deform a body by less than
{BOUNDS["centrifugal"]:g} of its size counts as none. Only what the modes can show is judged: the rollers have no
mode that a rotation about their axis excites. Cost: {found["cost"]}.
"""
