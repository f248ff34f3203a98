r"""Creep curves of two crowned rollers on a mesh far coarser than their contact: along, across, and by spin.

Two equal rollers, crowned so that their patch is an ellipse, are pressed together and rolled with prescribed creepages:
the lower one rotates on a fixed axle, the upper one in a fork which is pressed down and rotated by a drive about the
vertical. A second drive moves the upper roller along its axle, a third rotates it. With the mean rolling speed V,
the longitudinal and lateral creepages xi and eta and the spin phi [rad/m], the patch rolls along +x:

    lower surface       -V (1 - xi/2, 0)
    upper surface       -V (1 + xi/2, eta),    the fork rotates at -phi V.

A fork at the angle theta skews its roller, which alone would be a lateral creepage theta. So the drives of the upper
roller prescribe the velocity above in the roller's directions along and across, minus that of the fork at the patch:
with the displacement s of the roller along its axle, the patch is s/2 off the fork's axis.

What to expect. The scene is the wheel on a rail of the program CONTACT (E. A. H. Vollebregt) at a twenty-fifth of its
size: relative radii of 25 and 71.08 mm, 170.7 N, equal materials, friction 0.33. Forces over mu N depend on the ratio
of the radii and on Poisson's ratio only, so that the nine published values hold here. The force is never above mu N;
spin causes a lateral force as well. Creepages increase in stairs. On each stair the material passes `HELD` times
through the patch, after which tractions are steady. Spin changes its sign from stair to stair, so that the fork remains
nearly straight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.friction import StickSlipMap
from warpffrf.output.plots.panels import Panel, save_panels

CONTACT = {1e-5: 0.007015, 4e-4: 0.2588, 8e-4: 0.4742, 1.2e-3: 0.6482, 1.6e-3: 0.7831, 2e-3: 0.8816, 2.4e-3: 0.9467,
           2.8e-3: 0.9832, 3.2e-3: 0.9976}  # longitudinal creepage -> force over mu N  # fmt: skip
POISSON, SHEAR, FRICTION, LOAD = 0.28, 82e9, 0.33, 170.72  # -, Pa, -, N
STEEL = wf.Material(youngs_modulus=2.0 * SHEAR * (1.0 + POISSON), poisson_ratio=POISSON, density=7850, name="steel")
OUTER_RADIUS, CROWN, BORE_RADIUS, WIDTH = 0.05, 0.14216, 0.03, 0.014  # m
SECTORS, LAYERS, AXIAL = 78, 5, 4  # cells of 4 mm
SEMI_ALONG, SEMI_ACROSS = 0.252136388e-3, 0.504324855e-3  # m, of Hertz's ellipse
SPAN = 1.3  # half-axes of the cells over those of the patch
FORK_MASS, FORK_INERTIA = 1.0, (1e-3, 1e-3, 1e-3)  # kg, kg m2
SPEED = 0.5  # m/s
TURN = SPEED / OUTER_RADIUS  # rad/s
CROSSING = 2.0 * SEMI_ALONG / SPEED  # s, in which the material runs through the patch
RISE, HELD = 0.5, 4.0  # crossings: from stair to stair, on each
RHO_INF = 0.5
SAMPLES, PASSES = 8, 3  # of the drives' tables in a crossing; for the small offset of the patch
PAIR = "lower-upper"
SPINS = (0.1, 1.0, 2.0, 4.0, 6.0, 9.0, 13.0, 18.0)  # rad/m
SIGNS = tuple((-1) ** n for n in range(len(CONTACT)))  # of the spin from stair to stair
Stair = tuple[float, float, float]  # longitudinal and lateral creepage [-], spin [rad/m]


@dataclass(frozen=True)
class Size:
    """Cells across the patch in both directions, and which stairs (for example every third)."""

    cells: int
    every: int

    @property
    def step(self) -> float:
        """s: the patch advances by one cell."""
        return 2.0 * SPAN * SEMI_ALONG / self.cells / SPEED


FULL, QUICK = Size(21, 1), Size(15, 3)


def stairs(size: Size) -> dict[str, list[Stair]]:
    """The stairs of every run."""
    creepages, spins = list(CONTACT)[:: size.every], SPINS[:: size.every]
    return {
        "longitudinal": [(c, 0.0, 0.0) for c in creepages],
        "lateral": [(0.0, c, 0.0) for c in creepages],
        "spin": [(0.0, 0.0, phi * sign) for phi, sign in zip(spins, SIGNS, strict=False)],
    }


def ends(run: Sequence[Stair]) -> np.ndarray:
    """Times [s] at which the stairs end."""
    return (RISE + HELD) * CROSSING * np.arange(1, len(run) + 1)


def _integral(rate: np.ndarray, t: np.ndarray) -> np.ndarray:
    """From the first of the times t (n,) on, by trapezoids."""
    return np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t)))


def drives(run: Sequence[Stair]) -> dict[str, wf.signals.Table]:
    """Velocities over time: `axle` and `roller` [rad/s], `slide` [m/s] along the upper axle, `fork` [rad/s]."""
    starts = np.append(0.0, ends(run))
    t = np.linspace(0.0, starts[-1], round(starts[-1] / CROSSING) * SAMPLES + 1)
    values = np.zeros((3, len(t)))
    for start, before, after in zip(starts, ((0.0, 0.0, 0.0), *run), run, strict=False):
        x = np.clip((t - start) / (RISE * CROSSING), 0.0, 1.0)
        values += np.outer(np.subtract(after, before), x * x * (3.0 - 2.0 * x))
    xi, eta, phi = values
    fork = -phi * SPEED
    theta = _integral(fork, t)
    along, offset, aside = np.zeros_like(t), np.zeros_like(t), -SPEED * eta
    for _ in range(PASSES):
        ahead = -SPEED * (1.0 + 0.5 * xi) + fork * offset
        along = aside * np.cos(theta) - ahead * np.sin(theta)
        offset = 0.5 * _integral(along, t)
    around = ahead * np.cos(theta) + aside * np.sin(theta)
    found = {"axle": -SPEED * (1.0 - 0.5 * xi) / OUTER_RADIUS, "roller": -around / OUTER_RADIUS, "slide": along,
             "fork": fork}  # fmt: skip
    return {name: wf.signals.Table(t, rate, hold=True) for name, rate in found.items()}


def reduced(*, progress: bool = True) -> wf.ReducedBody:
    """One roller, in cells of 4 mm."""
    mesh = wf.mesh.roller(
        OUTER_RADIUS, BORE_RADIUS, WIDTH, sectors=SECTORS, layers=LAYERS, axial=AXIAL, crown_radius=CROWN, order=2
    )
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.CrownedCylinder(crown_radius=CROWN)},
        modes=0, grid=wf.ContactGrid(tangential=True, contact_fixed=True), progress=progress,
    )  # fmt: skip


def build(
    run: Sequence[Stair], size: Size = FULL, *, body: wf.ReducedBody | None = None, progress: bool = True
) -> wf.Scene:
    """The scene with the drives of `run`: bodies `lower`, `upper`, `fork`, contact `lower-upper`.

    body: the reduced roller, made here unless given. The press is a force on the fork; there is no gravity.
    """
    roller, rates = reduced(progress=progress) if body is None else body, drives(run)
    scene = wf.Scene()
    lower = scene.add_body(roller, name="lower", angular_velocity=(0, -TURN, 0))
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * OUTER_RADIUS), angular_velocity=(0, TURN, 0))
    cells = (size.cells, size.cells)
    contact = wf.Contact(lower["rim"], upper["rim"], friction=FRICTION, grid="contact_fixed", cells=cells, name=PAIR)
    scene.close_gap(scene.add(contact))
    fork = scene.add_rigid_body(FORK_MASS, FORK_INERTIA, name="fork", position=upper["bore"].world_point())
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    swivel = scene.add(wf.joints.Cylindrical(scene.ground, fork, axis=(0, 0, 1), name="swivel"))
    above = scene.add(wf.joints.Cylindrical(fork, upper["bore"], axis=(0, 1, 0), name="upper_axle"))
    scene.add(wf.joints.Drive(axle, rates["axle"]))
    scene.add(wf.joints.Drive(swivel, rates["fork"], coordinate="rotation"))
    scene.add(wf.joints.Drive(above, rates["roller"], coordinate="rotation"))
    scene.add(wf.joints.Drive(above, rates["slide"], coordinate="translation"))
    scene.add(wf.forces.PointForce(fork, (0, 0, -LOAD), name="press"))
    return scene


def roll(scene: wf.Scene, run: Sequence[Stair], size: Size, *, progress: bool = True) -> wf.Result:
    """All stairs, from the static state under the press."""
    options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(RHO_INF))
    end = float(ends(run)[-1])
    return wf.simulate(scene, end, step=size.step, start="equilibrium", options=options, progress=progress)


def rows(result: wf.Result, run: Sequence[Stair]) -> list[int]:
    """The saved steps at the ends of the stairs."""
    return [int(np.flatnonzero(result.time <= end + 1e-9)[-1]) for end in ends(run)]


def forces(result: wf.Result, run: Sequence[Stair]) -> np.ndarray:
    """(n, 2) over mu N on the upper body at the ends of the stairs, with the signs of the creepages."""
    contact, at = result.contact(PAIR), rows(result, run)
    return -contact.friction.tangential_force[at] / (FRICTION * contact.normal_load[at, None])


def main(out: str | Path = "out/creep_curves", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write creep_curves.h5 and .rrd of longitudinal creepage, creep_curves.lateral.h5, .spin.h5 and .png into the
    folder `out` and print the figures; quick: fewer cells, a third of the stairs."""
    stem, size, body = Path(out) / "creep_curves", QUICK if quick else FULL, reduced(progress=progress)
    runs = stairs(size)
    results = {name: roll(build(run, size, body=body), run, size, progress=progress) for name, run in runs.items()}
    for name, result in results.items():
        result.save(f"{stem}.h5" if name == "longitudinal" else f"{stem}.{name}.h5", overwrite=True)
    wf.record(results["longitudinal"], f"{stem}.rrd", max_frames=60 if quick else 200, overwrite=True)

    found = {name: forces(result, runs[name]) for name, result in results.items()}
    creepages, spins = np.array(list(CONTACT)[:: size.every]), np.array(SPINS[:: size.every])
    published = {"CONTACT": (np.array(list(CONTACT)) * 1e3, np.array(list(CONTACT.values())))}
    save_panels([
        Panel("Creepage in one direction", "creepage [1e-3]", "force over mu N",
              {"longitudinal": (creepages * 1e3, found["longitudinal"][:, 0]),
               "lateral": (creepages * 1e3, found["lateral"][:, 1])}, points=published),
        Panel("Spin", "spin [rad/m]", "lateral force over mu N",
              {"run": (spins, found["spin"][:, 1] * np.array(SIGNS[: len(spins)]))}),
        StickSlipMap("Tractions on the lower roller at the last lateral creepage", results["lateral"], -1),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    for xi, share in zip(creepages, found["longitudinal"][:, 0], strict=True):
        print(f"longitudinal creepage {xi * 1e3:5.3g}e-3: Fx/(mu N) {share:.5f}, CONTACT {CONTACT[xi]:.5f}")
    print(f"lateral creepage      {creepages[-1] * 1e3:5.3g}e-3: Fy/(mu N) {found['lateral'][-1, 1]:.5f}")
    return list(results.values())


if __name__ == "__main__":
    main()
