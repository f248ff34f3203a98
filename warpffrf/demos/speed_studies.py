"""Makes docs/speed_error.md: `python -m warpffrf.demos.speed_studies [FOLDER] [--quick]`, some minutes.

The two-roller demo and the slider-crank run through grids of settings beside references that the studies compute; every
figure of the page, its tables and its pictures, is of the runs made here. --quick: coarser machines and fewer steps.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.demos import slider_crank as crank
from warpffrf.demos import two_rollers as rollers
from warpffrf.model.integrators import HHT, GeneralizedAlpha
from warpffrf.study.speed_against_error.study import SpeedError

FOLDER, PAGE, STEM = "docs", "speed_error.md", "speed_error"
MADE = "Made by `python -m warpffrf.demos.speed_studies`; do not edit.\n"
ROUNDS = 2
STEPS = [4e-4, 2e-4, 1e-4, 5e-5]  # s, about that of the demos
FINE_STEPS = [4e-5, 2e-5, 1e-5, 5e-6]  # s, that resolve the vibration of the rollers on their contact
FEWER = 2  # of them with --quick
ROLLER_RUN, ROLLER_LOAD_STEP = 0.024, 0.008  # s: the load step falls into the spin-up, and both are over at the end
SURFACE_SPEED = rollers.SPEED * rollers.OUTER_RADIUS  # m/s
PITCH = 2.0 * np.pi * rollers.OUTER_RADIUS / rollers.QUICK.sectors  # m, of the hats
CRANK_RUN = 0.12  # s: the spin-up and half a turn at speed
QUICK_SECTORS = 600  # an element wider than half the patch: only to see that the study runs


@cache
def _roller(quick: bool) -> wf.ReducedBody:
    size = rollers.Size(QUICK_SECTORS, layers=10, axial=2) if quick else rollers.QUICK
    return rollers.roller_body(size, patch_grid=True, progress=False)


def two_rollers(quick: bool, *, progress: bool = True) -> SpeedError:
    """Grid of the contact x inertia level x step."""
    body = _roller(quick)

    def two_rollers() -> wf.Scene:
        return rollers.machine(body, load_step_at=ROLLER_LOAD_STEP)

    return wf.study.speed_error(
        two_rollers, ROLLER_RUN, step=rollers.STEP, start="equilibrium", progress=progress, rounds=ROUNDS,
        choices={"grid": ["material", "patch"], "inertia": ["constant", "full"], "step": _steps(quick)},
    )  # fmt: skip


def pressed_rollers(quick: bool, *, progress: bool = True) -> SpeedError:
    """Step alone, of rollers that do not turn."""
    body = _roller(quick)

    def pressed_rollers() -> wf.Scene:
        return rollers.machine(body, load_step_at=ROLLER_LOAD_STEP, speed=0.0)

    return wf.study.speed_error(
        pressed_rollers, ROLLER_RUN, step=FINE_STEPS[0], start="equilibrium", progress=progress, rounds=1,
        choices={"grid": ["material"], "step": FINE_STEPS[:-1] if quick else FINE_STEPS},
        measures=["force", "displacement", "energy"],
    )  # fmt: skip


def slider_crank(quick: bool, *, progress: bool = True) -> SpeedError:
    """Integrator x inertia level of the rod x step."""
    size = crank.QUICK if quick else crank.FULL
    integrators = [HHT(alpha=-0.3), GeneralizedAlpha(rho_inf=0.5), GeneralizedAlpha(rho_inf=crank.RHO_INF)]
    rod = crank.rod_body(size, progress=progress)

    def slider_crank() -> wf.Scene:
        return crank.machine(rod)

    return wf.study.speed_error(
        slider_crank, CRANK_RUN, step=crank.STEP, progress=progress, rounds=ROUNDS,
        points={"rod": [(0.0, 0.0, 0.5 * crank.SECTION)]},
        choices={"integrator": integrators, "inertia": ["constant", "full"], "step": _steps(quick)},
    )  # fmt: skip


def _steps(quick: bool) -> list[float]:
    return STEPS[:-FEWER] if quick else STEPS


# name -> heading, what was done, the study
STUDIES: dict[str, tuple[str, str, Callable[..., SpeedError]]] = {
    "two_rollers": (
        "Two rollers",
        f"The machine of [the two-roller demo](two_rollers.md), started from its equilibrium under "
        f"{rollers.LOAD / 1e3:g} kN, over {ROLLER_RUN * 1e3:g} ms: spun up in {rollers.SPIN_UP * 1e3:g} ms, and loaded "
        f"to {rollers.LOAD_AFTER / 1e3:g} kN between {ROLLER_LOAD_STEP * 1e3:g} and "
        f"{(ROLLER_LOAD_STEP + rollers.LOAD_STEP_TAKES) * 1e3:g} ms. `grid=material` puts pressures on hats of the FE "
        "mesh, whose compliance they have, `grid=patch` on cells that travel with the patch and have that of a "
        "half-space near the load; the reference has cells. Local modes are quasi-static: cells need that.\n\n"
        f"The rim runs at {SURFACE_SPEED:g} m/s, so that hats pass the contact at {SURFACE_SPEED / PITCH * 1e-3:.0f} "
        "kHz, which no step of this study resolves: forces on hats do not converge with these steps. Without rolling "
        "they do, see below. Curves of the two inertia levels lie on each other where the level does not matter, and "
        "which of the two is on a front is then round-off.",
        two_rollers,
    ),
    "pressed_rollers": (
        "The two rollers without rolling",
        "The same machine on hats with its axles held: no hat passes the contact. What the step must resolve is the "
        "vibration of the rollers on their contact that the load step leaves.",
        pressed_rollers,
    ),
    "slider_crank": (
        "Slider-crank with an elastic rod",
        f"The machine of the slider-crank demo over {CRANK_RUN * 1e3:g} ms: the spin-up, {crank.SPIN_UP * 1e3:g} ms, "
        "and half a turn at speed. Deformation is that of the rod at midspan. The rod has its geometric stiffening in "
        "all runs; `inertia` is the level of its inertia terms.",
        slider_crank,
    ),
}


def section(name: str, found: SpeedError, seconds: float) -> str:
    """What the page says of a study, its pictures beside it."""
    heading, text, _ = STUDIES[name]
    return (
        f"## {heading}\n\n{text}\n\n![Error against time]({STEM}_{name}.png)\n\n"
        f"![Error against step]({STEM}_{name}_steps.png)\n\n{found.report()}\nThe study took {seconds:.0f} s.\n"
    )


def write_page(folder: str | Path, names: list[str], *, quick: bool, progress: bool = True) -> Path:
    """Make the studies `names`, and write the page and its pictures into `folder`; returns the path of the page."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    sections = []
    for name in names:
        begin = time.perf_counter()
        found = STUDIES[name][2](quick, progress=progress)
        found.draw(folder / f"{STEM}_{name}", overwrite=True)
        sections.append(section(name, found, time.perf_counter() - begin))
    page = folder / PAGE
    coarse = "Made with --quick: machines are coarse, and figures only show that it runs.\n\n" if quick else ""
    page.write_text(
        f"""# Speed against error

{MADE}
{coarse}Each machine runs with all combinations of some choices, up to {ROUNDS} times in changing order in one process,
and is held against a reference that the study computes itself, of a step four times finer than the finest. Errors are
fractions of the whole history (`warpffrf.study.speed_against_error.errors`); times are wall time of the time loop per
simulated second, the fastest run of each, and `step U` is the same for one step in units of U. What a run costs once
stands beside: `set-up`, `checks` when it ends (cells that travel are held against finer ones, for the error that the
run states), and the reduction, `offline`. A setting is on the front where none is both faster and at least as right.
Where rounds differ by more than fronts do (`fastest` beside `median`), the order of neighbours on a front is chance.
Bodies are the same in all runs of a study: what their meshes and modes leave out in the reference too is not in these
errors.

{chr(10).join(sections)}""",
        encoding="utf-8",
    )
    return page


def main() -> None:
    arguments = sys.argv[1:]
    folders = [a for a in arguments if a != "--quick"]
    print(write_page(folders[0] if folders else FOLDER, list(STUDIES), quick="--quick" in arguments))


if __name__ == "__main__":
    main()
